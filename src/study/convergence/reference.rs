//! The image that stands for the truth: made in independent batches, so that its own error is known, or read.

use super::{
    contender::{Enter, Entry},
    plan::{self, Batches},
    question::{Effort, Question, ReferenceFile},
    store::Store,
    unit,
};
use crate::study::{
    coverage,
    interval::Mean,
    metrics::FLOOR,
    picture::{self, Picture},
};
use crate::{
    error::{Error, Result},
    math::{DVec3, Spectrum},
};
use std::path::PathBuf;

/// A reference and what is known of it.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The image.
    pub picture: Picture,
    /// How it was made.
    pub how: String,
    /// Expected value of relMSE between it and the truth.
    pub own_relmse: Option<f64>,
    /// Standard error of its mean over pixels and channels, relative to that mean.
    pub mean_error: Option<f64>,
}

/// Times the effort of a contender, all its seeds together, that a reference takes.
pub const EFFORT: u64 = 4;
/// Independent parts of a reference.
const BATCHES: u64 = 16;
/// Seeds of batches begin here, far from those of any contender.
const FIRST_SEED: u64 = 1 << 63;
/// Another integrator makes the reference unless its variance is this many times that of the best contender: with
/// [`EFFORT`] and eight seeds the reference's error is then a tenth of a contender's.
const MOST_VARIANCE: f64 = 3.0;

/// Where a batch lies.
fn file(scene: &str, batch: u64) -> PathBuf {
    PathBuf::from(format!("runs/{scene}/reference/{batch}.exr"))
}

/// How the reference of `scene` is made: by the first of `others` that the contenders are not and that covers the scene;
/// where there is none, or it is hopelessly noisy, by a contender with other seeds.
pub fn plan(
    question: &Question,
    scene: usize,
    (others, is_given, effort): (&[String], bool, Option<Effort>),
    contenders: &[Result<Entry>],
    enter: &mut Enter<'_>,
) -> Result<Batches> {
    let (words, entry) = match is_given {
        true => (others[0].clone(), enter(scene, &others[0])?),
        false => choose(question, scene, others, contenders, enter)?,
    };
    let same = |other: &Entry| other.settings.options.strategies == entry.settings.options.strategies;
    let like = contenders.iter().position(|other| other.as_ref().is_ok_and(same));
    let effort = effort.unwrap_or(question.effort.times(EFFORT * question.seeds));
    let all = plan::samples(&entry, each(effort), question.first_seed);
    let (count, samples) = match effort {
        Effort::Samples(all) => (all.clamp(2, BATCHES), all.div_ceil(BATCHES)),
        Effort::Seconds(_) => (BATCHES, all),
    };
    Ok(Batches { words, like: like.map(|index| question.contenders[index].name.clone()), count, samples })
}

/// The effort of one batch where it is a time.
fn each(effort: Effort) -> Effort {
    match effort {
        Effort::Seconds(seconds) => Effort::Seconds(seconds / BATCHES as f64),
        samples => samples,
    }
}

fn choose(
    question: &Question,
    scene: usize,
    others: &[String],
    contenders: &[Result<Entry>],
    enter: &mut Enter<'_>,
) -> Result<(String, Entry)> {
    let is_good = |entry: &Entry| coverage::is_trustworthy(&entry.setup.scene, &entry.settings.options);
    let own: Vec<(&str, &Entry)> = question
        .contenders
        .iter()
        .zip(contenders)
        .filter_map(|(contender, entry)| Some((contender.words.as_str(), entry.as_ref().ok()?)))
        .collect();
    let good: Vec<_> = own.iter().filter(|(_, entry)| is_good(entry)).collect();
    let variance = |entry: &Entry| plan::variance(entry, question.first_seed);
    let best = good.iter().map(|(_, entry)| variance(entry)).fold(f64::INFINITY, f64::min);
    for words in others {
        let Ok(entry) = enter(scene, words) else { continue };
        let strategies = entry.settings.options.strategies;
        let is_other = own.iter().all(|(_, other)| other.settings.options.strategies != strategies);
        let is_covering = is_good(&entry) || good.is_empty();
        if is_other && is_covering && variance(&entry) <= MOST_VARIANCE * best {
            return Ok((words.clone(), entry));
        }
    }
    match good.first().copied().or(own.first()) {
        Some((words, entry)) => Ok(((*words).to_owned(), (*entry).clone())),
        None => {
            let words = others.first().map_or("", String::as_str);
            Ok((words.to_owned(), enter(scene, words)?))
        }
    }
}

/// Makes what is missing of a reference and puts it together. `tell` hears of every batch what share of all is done, and
/// whether it was there before.
pub fn make(
    store: &Store,
    name: &str,
    batches: &Batches,
    first_seed: u64,
    entry: &mut dyn FnMut() -> Result<Entry>,
    tell: &mut dyn FnMut(f64, bool),
) -> Result<Truth> {
    let missing: Vec<u64> = (0..batches.count).filter(|batch| !store.has(file(name, *batch))).collect();
    tell((batches.count - missing.len() as u64) as f64 / batches.count as f64, true);
    let maker = if missing.is_empty() { None } else { Some(entry()?) };
    for (maker, batch) in maker.iter().flat_map(|maker| missing.iter().map(move |batch| (maker, *batch))) {
        let seed = first_seed.wrapping_add(FIRST_SEED).wrapping_add(batch);
        let mut image = None;
        let share = &mut |share: f64| tell((batch as f64 + share) / batches.count as f64, false);
        unit::shoot(maker, seed, &[batches.samples], share, &mut |snapshot| image = Some(snapshot.pixels));
        let film = &maker.setup.film;
        let (width, height) = (film.width as usize, film.height as usize);
        store.write_image(file(name, batch), &Picture::new(width, height, image.unwrap_or_default()))?;
    }
    let image = |batch| {
        let image = store.read_image(file(name, batch))?;
        image.check_finite(&store.root().join(file(name, batch)))?;
        Ok(image)
    };
    let images = (0..batches.count).map(image);
    Ok(together(&images.collect::<Result<Vec<_>>>()?, describe(batches)))
}

fn describe(Batches { words, like, count, samples }: &Batches) -> String {
    let words = if words.is_empty() { "the scene's integrator" } else { words };
    let whose = match like {
        None => "by an integrator that is not among the contenders".to_owned(),
        Some(name) => format!("with other seeds, by the strategies of the contender {name}"),
    };
    let all = count * samples;
    format!("tyndall {words}: {all} samples per pixel in {count} independent batches, {whose}")
}

/// The mean of independent images of one size, and its error.
fn together(images: &[Picture], how: String) -> Truth {
    let means: Vec<f64> = images.iter().map(|image| unit::mean(&image.pixels)).collect();
    let mean = Mean::of(&means);
    let (pixels, relative): (Vec<Spectrum>, Vec<f64>) = (0..images[0].pixels.len())
        .map(|pixel| {
            let (mean, variance) = moments(images.iter().map(|image| image.pixels[pixel].as_dvec3()));
            let relative = variance / images.len() as f64 / (mean * mean + DVec3::splat(FLOOR));
            (mean.as_vec3(), relative.element_sum() / 3.0)
        })
        .unzip();
    Truth {
        own_relmse: Some(relative.iter().sum::<f64>() / relative.len() as f64),
        mean_error: Some(if mean.error == 0.0 { 0.0 } else { mean.error / mean.value.abs() }),
        picture: Picture { pixels, ..images[0] },
        how,
    }
}

/// Mean and variance of values, two at least.
pub fn moments(values: impl Iterator<Item = DVec3> + Clone) -> (DVec3, DVec3) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<DVec3>() / count;
    (mean, values.map(|value| (value - mean) * (value - mean)).sum::<DVec3>() / (count - 1.0))
}

/// Reads a reference for a scene of `width` x `height` pixels.
pub fn read(wanted: &ReferenceFile, width: usize, height: usize) -> Result<Truth> {
    let path = PathBuf::from(&wanted.file);
    let picture = picture::read(&path)?;
    let found = (picture.width, picture.height);
    let expected = format!("an image of {width} x {height} pixels, as the scene's");
    if found != (width, height) {
        let remedy = format!("give one of that size, or --size {}x{}", found.0, found.1);
        return Err(Error::new(path.display(), expected, format!("{} x {}", found.0, found.1), remedy));
    }
    picture.check_finite(&path)?;
    Ok(Truth {
        picture,
        how: format!("read from {}", wanted.file),
        own_relmse: wanted.own_relmse,
        mean_error: None,
    })
}

#[cfg(test)]
mod tests {
    use super::{super::question::tests::question, *};

    #[test]
    fn a_reference_knows_its_error() {
        let image = |value: f32| Picture::new(1, 1, vec![Spectrum::splat(value)]);
        let truth = together(&[image(1.0), image(2.0), image(3.0)], String::new());
        assert_eq!(truth.picture, image(2.0));
        // The mean's variance is 1/3; relative to 2^2 + 0.01, and to the mean.
        assert!((truth.own_relmse.unwrap() - 1.0 / 3.0 / 4.01).abs() < 1e-12);
        assert!((truth.mean_error.unwrap() - (1.0f64 / 3.0).sqrt() / 2.0).abs() < 1e-12);
        assert_eq!(together(&[image(0.0), image(0.0)], String::new()).mean_error, Some(0.0));
    }

    #[test]
    fn a_made_reference_without_a_number_somewhere_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = Store::open(folder.path(), &question(), false).unwrap();
        let batches = Batches { words: String::new(), like: None, count: 2, samples: 1 };
        for (batch, last) in [1.0, f32::NAN].into_iter().enumerate() {
            let image = Picture::new(2, 1, vec![Spectrum::ONE, Spectrum::splat(last)]);
            store.write_image(file("fog", batch as u64), &image).unwrap();
        }
        let entry = &mut || Err(Error::new("", "no batch to be missing", "", ""));
        let error = make(&store, "fog", &batches, 0, entry, &mut |_, _| ()).unwrap_err();
        assert!(error.place.contains("1.exr") && error.found.contains("column 1, row 0"), "{error}");
    }

    #[test]
    fn a_reference_must_fit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.exr");
        let pixels = vec![Spectrum::ONE, Spectrum::splat(f32::NAN)];
        Picture::new(2, 1, pixels).write(&path).unwrap();
        let file = path.display().to_string();
        let wanted = ReferenceFile { file, fingerprint: String::new(), own_relmse: None };
        assert!(read(&wanted, 1, 2).unwrap_err().remedy.contains("--size 2x1"));
        assert!(read(&wanted, 2, 1).unwrap_err().found.contains("column 1, row 0"));
    }
}
