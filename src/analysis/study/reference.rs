//! The reference image: made in independent batches, so that its own error is known, or read.

use super::{
    contender::{Enter, Entry, How, Renderer},
    plan::{self, Batches},
    question::{Effort, Question, ReferenceFile},
    store::Store,
    unit,
};
use crate::{
    analysis::{
        interval::Mean,
        picture::{self, Picture},
    },
    error::{Error, Result},
    inputs::{self, Reader},
    math::{DVec3, relative::Relative},
    medium::DistanceMethod,
    scene::Scene,
    transport::coverage,
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
    /// What its own relMSE is known by.
    pub known_by: Option<String>,
    /// Standard errors between the means of the renderers that made it together; none of one.
    pub apart: Option<f64>,
    /// What the reader should know.
    pub notes: Vec<String>,
}

/// Times the effort of a contender, all its seeds together, that a reference takes.
pub const EFFORT: u64 = 4;
/// Independent parts of a reference, of each renderer that makes it.
const BATCHES: u64 = 16;
/// Seeds of batches begin here, far from those of any contender.
const FIRST_SEED: u64 = 1 << 63;
/// Another integrator makes the reference unless its variance is this many times that of the best contender: with
/// [`EFFORT`] and eight seeds the reference's error is then a tenth of a contender's.
const MOST_VARIANCE: f64 = 3.0;
/// So many standard errors may the image means of two renderers be apart before one is mistrusted.
const APART: f64 = 4.0;

/// Where a batch lies.
fn file(scene: &str, batch: u64) -> PathBuf {
    PathBuf::from(format!("runs/{scene}/reference/{batch}.exr"))
}

/// How the reference of `scene` is made. By default, by the first of `others` that no contender is, whose paths are as
/// long as those of the deepest contender, and that covers the scene. If there is none, or it is hopelessly noisy, by a
/// contender as deep with other seeds. Besides, by the first other renderer that takes part, with the same effort.
/// Where `others` are given, by all of them.
pub fn plan(
    question: &Question,
    scene: usize,
    (others, is_given, effort): (&[How], bool, Option<Effort>),
    contenders: &[Option<&Entry>],
    enter: &mut Enter<'_>,
) -> Result<Vec<Batches>> {
    let mut makers = Vec::new();
    if is_given {
        for how in others {
            let entry = enter(scene, how)?;
            check_depth(&entry, contenders)?;
            makers.push((how.clone(), entry));
        }
    } else {
        let is_external = |entry: &Entry| matches!(entry.renderer, Renderer::External(_));
        makers.push(choose(question, scene, others, contenders, enter)?);
        let able = question.contenders.iter().zip(contenders);
        let mut able = able.filter_map(|(contender, entry)| Some((contender.how.clone(), (*entry)?.clone())));
        makers.extend(able.find(|(_, entry)| is_external(entry)).filter(|(how, _)| *how != makers[0].0));
    }
    let effort = effort.unwrap_or(question.effort.times(EFFORT * question.seeds)).over(makers.len() as u64);
    let batches = |(how, entry): (How, Entry)| {
        let same = |other: &Entry| other.strategies().is_some() && other.strategies() == entry.strategies();
        let like = question
            .contenders
            .iter()
            .zip(contenders)
            .find(|(contender, other)| contender.how == how || other.is_some_and(same));
        let all = plan::samples(&entry, each(effort), question.first_seed)?;
        let (count, samples) = match effort {
            Effort::Samples(all) => (all.clamp(2, BATCHES), all.div_ceil(BATCHES)),
            Effort::Seconds(_) => (BATCHES, all),
        };
        Ok(Batches { how, like: like.map(|(contender, _)| contender.name.clone()), count, samples })
    };
    makers.into_iter().map(batches).collect()
}

/// The effort of one batch where it is a time.
fn each(effort: Effort) -> Effort {
    match effort {
        Effort::Seconds(seconds) => Effort::Seconds(seconds / BATCHES as f64),
        samples => samples,
    }
}

/// Edges of the longest paths of `entry`; none of other renderers, of which that is not known.
fn depth(entry: &Entry) -> Option<u32> {
    entry.estimator().map(|(_, options)| options.max_depth.unwrap_or(u32::MAX))
}

/// Edges of the shortest.
fn least_depth(entry: &Entry) -> Option<u32> {
    entry.estimator().map(|(_, options)| options.min_depth.max(1))
}

/// Refuses a reference without the light of longer or shorter paths that a contender has.
fn check_depth(entry: &Entry, contenders: &[Option<&Entry>]) -> Result<()> {
    let deepest = contenders.iter().flatten().filter_map(|entry| depth(entry)).max();
    let least = contenders.iter().flatten().filter_map(|entry| least_depth(entry)).min();
    if let (Some(found), Some(least)) = (least_depth(entry), least)
        && found > least
    {
        let expected = format!("paths as short as those of all contenders, --min-depth {least}");
        let remedy = format!("add --min-depth {least} to the options of the reference");
        return Err(Error::new("--reference-by", expected, format!("--min-depth {found}"), remedy));
    }
    match (depth(entry), deepest) {
        (Some(found), Some(deepest)) if found < deepest => {
            let shown = if deepest == u32::MAX { "-1".to_owned() } else { deepest.to_string() };
            let expected = format!("paths as long as those of the deepest contender, --max-depth {shown}");
            let remedy = format!("add --max-depth {shown} to the options of the reference");
            Err(Error::new("--reference-by", expected, format!("--max-depth {found}"), remedy))
        }
        _ => Ok(()),
    }
}

/// True if some medium is marched through, with bias.
fn marches(scene: &Scene) -> bool {
    let mut media = scene.media.iter().filter_map(|medium| medium.heterogeneous());
    media.any(|varying| varying.tracker().choice() == DistanceMethod::RayMarching)
}

fn choose(
    question: &Question,
    scene: usize,
    others: &[How],
    contenders: &[Option<&Entry>],
    enter: &mut Enter<'_>,
) -> Result<(How, Entry)> {
    let is_good = |entry: &Entry| {
        entry.estimator().is_some_and(|(scene, options)| coverage::is_trustworthy(scene, options))
    };
    let able = question.contenders.iter().zip(contenders);
    let own: Vec<(&How, &Entry)> =
        able.filter_map(|(contender, entry)| Some((&contender.how, (*entry)?))).collect();
    let deepest = own.iter().filter_map(|(_, entry)| depth(entry)).max();
    let least = own.iter().filter_map(|(_, entry)| least_depth(entry)).min();
    let is_deep =
        |entry: &Entry| depth(entry).is_none() || depth(entry) == deepest && least_depth(entry) == least;
    let deep: Vec<_> = own.iter().filter(|(_, entry)| is_deep(entry)).collect();
    let good: Vec<_> = deep.iter().filter(|(_, entry)| is_good(entry)).collect();
    let variance = |entry: &Entry| plan::variance(entry, question.first_seed);
    let best = good.iter().map(|(_, entry)| variance(entry)).fold(f64::INFINITY, f64::min);
    for how in others {
        let Ok(entry) = enter(scene, how) else { continue };
        let is_other = own.iter().all(|(_, other)| other.strategies() != entry.strategies());
        let is_covering = is_good(&entry) || good.is_empty();
        if is_other && is_deep(&entry) && is_covering && variance(&entry) <= MOST_VARIANCE * best {
            return Ok((how.clone(), entry));
        }
    }
    // Rather noise than bias, which would be taken for the truth.
    let marched = |entry: &Entry| marches(&entry.setup.scene);
    for how in others.iter().filter(|_| good.iter().all(|(_, entry)| marched(entry))) {
        match enter(scene, how) {
            Ok(entry) if is_deep(&entry) && is_good(&entry) && !marched(&entry) => {
                return Ok((how.clone(), entry));
            }
            _ => {}
        }
    }
    let exact = good.iter().find(|(_, entry)| !marched(entry));
    match exact.or(good.first()).copied().or(deep.first()) {
        Some((how, entry)) => Ok(((*how).clone(), (*entry).clone())),
        None => {
            let how = others.first().cloned().unwrap_or(How::Options(String::new()));
            let entry = enter(scene, &how)?;
            Ok((how, entry))
        }
    }
}

/// Makes what is missing of a reference and puts it together. `notify` hears of every batch what share of all
/// is done, and whether it was there before.
pub fn make(
    store: &Store,
    name: &str,
    parts: &[Batches],
    first_seed: u64,
    enter: &mut dyn FnMut(&How) -> Result<Entry>,
    notify: &mut dyn FnMut(f64, bool),
) -> Result<Truth> {
    let all: u64 = parts.iter().map(|part| part.count).sum();
    let mut made = Vec::new();
    let mut first = 0;
    for part in parts {
        let numbers = first..first + part.count;
        first = numbers.end;
        let missing: Vec<u64> = numbers.clone().filter(|batch| !store.has(file(name, *batch))).collect();
        notify((numbers.end - missing.len() as u64) as f64 / all as f64, true);
        let maker = if missing.is_empty() { None } else { Some(enter(&part.how)?) };
        for (maker, batch) in maker.iter().flat_map(|maker| missing.iter().map(move |batch| (maker, *batch)))
        {
            let seed = first_seed.wrapping_add(FIRST_SEED).wrapping_add(batch);
            let mut image = None;
            let share = &mut |share: f64| notify((batch as f64 + share) / all as f64, false);
            unit::shoot(maker, seed, &[part.samples], share, &mut |seen| image = Some(seen.snapshot.pixels))?;
            let (width, height) = maker.size();
            store.write_image(file(name, batch), &Picture::new(width, height, image.unwrap_or_default()))?;
        }
        let image = |batch| {
            let image = store.read_image(file(name, batch))?;
            image.check_finite(&store.root().join(file(name, batch)))?;
            Ok(image)
        };
        made.push(Made::of(&numbers.map(image).collect::<Result<Vec<_>>>()?, describe(part)));
    }
    Ok(pooled(made))
}

fn describe(Batches { how, like, count, samples }: &Batches) -> String {
    let who = match (how, like) {
        (How::Options(words), _) if words.is_empty() => "tyndall by the scene's integrator".to_owned(),
        (How::Options(words), _) => format!("tyndall {words}"),
        (How::Command(_), Some(name)) => name.clone(),
        (How::Command(command), None) => command.clone(),
    };
    let whose = match (how, like) {
        (How::Options(_), Some(name)) => {
            format!("with other seeds, by the strategies of the contender {name}")
        }
        (How::Command(_), Some(_)) => "with other seeds".to_owned(),
        (_, None) => "by an integrator that is not among the contenders".to_owned(),
    };
    let all = count * samples;
    format!("{who}: {all} samples per pixel in {count} independent batches, {whose}")
}

/// What one renderer computed of a reference.
struct Made {
    how: String,
    batches: usize,
    mean: Vec<DVec3>,
    /// Of the mean.
    variance: Vec<DVec3>,
    /// Over pixels and channels.
    whole: Mean,
    size: (usize, usize),
}

impl Made {
    /// The mean of independent images of one size, and its error.
    fn of(images: &[Picture], how: String) -> Self {
        let means: Vec<f64> = images.iter().map(|image| unit::mean(&image.pixels)).collect();
        let (mean, variance) = (0..images[0].pixels.len())
            .map(|pixel| {
                let (mean, variance) = moments(images.iter().map(|image| image.pixels[pixel].as_dvec3()));
                (mean, variance / images.len() as f64)
            })
            .unzip();
        let size = (images[0].width, images[0].height);
        Self { how, batches: images.len(), mean, variance, whole: Mean::of(&means), size }
    }

    fn picture(&self) -> Picture {
        Picture::new(self.size.0, self.size.1, self.mean.iter().map(|mean| mean.as_vec3()).collect())
    }

    /// Its expected relMSE.
    fn relmse(&self) -> f64 {
        let to = Relative::to(&self.picture().pixels, 3);
        let relative = self
            .variance
            .iter()
            .zip(&self.mean)
            .map(|(variance, mean)| (0..3).map(|c| to.square(variance[c], mean[c])).sum::<f64>() / 3.0);
        relative.sum::<f64>() / self.mean.len() as f64
    }

    fn truth(self, apart: Option<f64>, notes: Vec<String>) -> Truth {
        Truth {
            own_relmse: Some(self.relmse()),
            known_by: Some(format!("how far its {} independent batches are apart", self.batches)),
            apart,
            mean_error: Some(if self.whole.error == 0.0 {
                0.0
            } else {
                self.whole.error / self.whole.value.abs()
            }),
            picture: self.picture(),
            how: self.how,
            notes,
        }
    }
}

/// The mean over all renderers, each weighted by its precision in the whole image. Where two disagree, the brighter is
/// taken alone: while rare, bright paths are not found yet, a render is darker, and looks less noisy than it is.
fn pooled(mut parts: Vec<Made>) -> Truth {
    parts.sort_by(|a, b| b.whole.value.total_cmp(&a.whole.value));
    let (brightest, darkest) = (&parts[0].whole, &parts[parts.len() - 1].whole);
    let apart = (brightest.value - darkest.value) / brightest.error.hypot(darkest.error);
    if parts.len() > 1 && apart > APART {
        let names: Vec<&str> = parts.iter().map(|part| part.how.as_str()).collect();
        let who = names.join("; and ");
        let note = format!(
            "the image means of its reference's renderers are {apart:.1} standard errors apart, one of \
                            them misses light, and the brightest alone is the reference: {who}"
        );
        return parts.swap_remove(0).truth(None, vec![note]);
    }
    if parts.len() == 1 {
        return parts.swap_remove(0).truth(None, Vec::new());
    }
    let precisions: Vec<f64> = parts.iter().map(|part| 1.0 / part.relmse().max(f64::MIN_POSITIVE)).collect();
    let all: f64 = precisions.iter().sum();
    let sum = |of: &dyn Fn(&Made, f64) -> DVec3| -> DVec3 {
        parts.iter().zip(&precisions).map(|(part, precision)| of(part, precision / all)).sum()
    };
    let pixels = 0..parts[0].mean.len();
    let whole = parts.iter().zip(&precisions).map(|(part, precision)| (part.whole, precision / all));
    let whole = whole.fold(Mean { value: 0.0, error: 0.0, freedom: f64::INFINITY }, |sum, (part, w)| Mean {
        value: sum.value + w * part.value,
        error: sum.error.hypot(w * part.error),
        freedom: sum.freedom.min(part.freedom),
    });
    let how: Vec<&str> = parts.iter().map(|part| part.how.as_str()).collect();
    let made = Made {
        how: format!("pooled by precision: {}", how.join("; ")),
        batches: parts.iter().map(|part| part.batches).sum(),
        mean: pixels.clone().map(|pixel| sum(&|part, w| w * part.mean[pixel])).collect(),
        variance: pixels.map(|pixel| sum(&|part, w| w * w * part.variance[pixel])).collect(),
        whole,
        size: parts[0].size,
    };
    made.truth(Some(apart).filter(|apart| apart.is_finite()), Vec::new())
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
    inputs::note(&path, Reader::Command);
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
        known_by: wanted.own_relmse.map(|_| "what --reference-error says".to_owned()),
        apart: None,
        mean_error: None,
        notes: Vec::new(),
    })
}

#[cfg(test)]
mod tests {
    use super::{super::question::tests::question, *};
    use crate::math::Spectrum;

    #[test]
    fn a_reference_knows_its_error() {
        let image = |value: f32| Picture::new(1, 1, vec![Spectrum::splat(value)]);
        let made =
            |values: &[f32]| Made::of(&values.iter().map(|v| image(*v)).collect::<Vec<_>>(), "a".into());
        let truth = pooled(vec![made(&[1.0, 2.0, 3.0])]);
        assert_eq!(truth.picture, image(2.0));
        // The mean's variance is 1/3; relative to 2^2 + 0.01 2^2, and to the mean.
        assert!((truth.own_relmse.unwrap() - 1.0 / 3.0 / 4.04).abs() < 1e-6);
        assert!((truth.mean_error.unwrap() - (1.0f64 / 3.0).sqrt() / 2.0).abs() < 1e-12);
        assert!(truth.known_by.unwrap().contains("its 3 independent batches") && truth.apart.is_none());
        assert_eq!(pooled(vec![made(&[0.0, 0.0])]).mean_error, Some(0.0));
        // Of two, the one of a ninth of the variance counts nine times.
        let both = pooled(vec![made(&[1.0, 2.0, 3.0]), made(&[-1.0, 2.0, 5.0])]);
        assert!(both.how.starts_with("pooled") && both.notes.is_empty());
        assert_eq!(both.apart, Some(0.0));
        assert!((both.own_relmse.unwrap() - (0.81 / 3.0 + 0.01 * 3.0) / 4.04).abs() < 1e-6, "{both:?}");
        assert!((both.mean_error.unwrap() - (0.81f64 / 3.0 + 0.01 * 3.0).sqrt() / 2.0).abs() < 1e-12);
        // Two that disagree are not mixed.
        let alone = pooled(vec![made(&[1.0, 1.01, 1.02]), made(&[2.0, 2.1, 2.2])]);
        assert!(alone.picture == image(2.1) && alone.notes[0].contains("standard errors apart"), "{alone:?}");
    }

    #[test]
    fn a_made_reference_without_a_number_somewhere_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let (store, _) = Store::open(folder.path(), &question(), false).unwrap();
        let batches = Batches { how: How::Options(String::new()), like: None, count: 2, samples: 1 };
        for (batch, last) in [1.0, f32::NAN].into_iter().enumerate() {
            let image = Picture::new(2, 1, vec![Spectrum::ONE, Spectrum::splat(last)]);
            store.write_image(file("fog", batch as u64), &image).unwrap();
        }
        let entry = &mut |_: &How| Err(Error::new("", "no batch to be missing", "", ""));
        let error = make(&store, "fog", &[batches], 0, entry, &mut |_, _| ()).unwrap_err();
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
