//! Pixels that share their samples show the same image as pixels with samples of their own, and with less noise.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{film::sharing::FilmSamples, math::Spectrum, transport::Strategies};

const SEEDS: u64 = 24;

/// A room of fog, whose lamp and walls end within pixels, by this filter.
fn foggy_room(filter: &str) -> Value {
    let mut sensor = camera([0.0, 0.0, 0.9], [0.1, 0.0, -1.0], 8);
    sensor["film"]["rfilter"] = json!({ "type": filter });
    scene(&[
        ("sensor", sensor),
        ("fog", medium(0.7, 0.8, 0.3)),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
    ])
}

fn stage(filter: &str, film_samples: FilmSamples) -> Stage {
    Stage { film_samples, ..Stage::new(&foggy_room(filter)) }
}

/// Of each image, the pixels of its frame alone, whose filters are cut off, in two rows.
fn frames(images: &[Vec<Spectrum>], width: usize) -> Vec<Vec<Spectrum>> {
    let is_frame = |i: usize| [i % width, i / width].iter().any(|at| *at == 0 || *at + 1 == width);
    let frame = |image: &Vec<Spectrum>| {
        image.iter().enumerate().filter(|(i, _)| is_frame(*i)).map(|(_, value)| *value).collect()
    };
    images.iter().map(frame).collect()
}

#[test]
fn all_kinds_of_film_samples_show_the_same() {
    let sets = [Strategies::PT, Strategies::BDPT, strategies("hit+lens")];
    let mut claims = Claims::new();
    for filter in ["gaussian", "tent", "catmullrom", "lanczos"] {
        let [shared, own, apart] = FilmSamples::NAMES.map(|(_, samples)| stage(filter, samples));
        let width = own.width();
        let truth = own.renders(Strategies::PT, 64, 5000..5000 + SEEDS);
        let light = strategies("hit+lens");
        let kinds = sets.map(|set| (&shared, set)).into_iter().chain([(&apart, light)]);
        for (i, (stage, set)) in kinds.enumerate() {
            let first = 100 * i as u64;
            let images = stage.renders(set, 16, first..first + SEEDS);
            let what = format!("{filter}, {}, {}", stage.film_samples.name(), crate::common::name_of(set));
            claims.equal(&what, &Sample::of(&images, width), &Sample::of(&truth, width));
            let [images, truth] = [&images, &truth].map(|images| frames(images, width));
            let width = images[0].len() / 2;
            claims.equal(&format!("{what}, frame"), &Sample::of(&images, width), &Sample::of(&truth, width));
        }
    }
    claims.settle();
}

/// Mean variance of a pixel over seeds.
fn variance(stage: &Stage) -> f64 {
    let images = stage.renders(Strategies::PT, 4, 0..4 * SEEDS);
    let n = images.len() as f64;
    let of_pixel = |pixel: usize| {
        let values = || images.iter().map(|image| f64::from(image[pixel].y));
        let mean = values().sum::<f64>() / n;
        values().map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0)
    };
    (0..images[0].len()).map(of_pixel).sum::<f64>() / images[0].len() as f64
}

/// The film says which part is left where samples are independent and neighbours alike. Here it is at most half.
#[test]
fn sharing_leaves_less_than_half_of_the_variance() {
    let [own, shared] =
        [FilmSamples::Own, FilmSamples::Shared].map(|samples| variance(&stage("gaussian", samples)));
    assert!(shared < 0.5 * own, "{shared} of {own}");
}

/// Of light subpaths that each reach one place on the film, the images of neighbours are alike unless they are apart.
#[test]
fn noise_of_light_subpaths_is_independent_only_apart() {
    let correlation = |samples| {
        let stage = stage("gaussian", samples);
        let images = stage.renders(strategies("lens"), 1, 0..20 * SEEDS);
        let (n, width) = (images.len() as f64, stage.width());
        let mean: Vec<f64> = (0..images[0].len())
            .map(|pixel| images.iter().map(|image| f64::from(image[pixel].y)).sum::<f64>() / n)
            .collect();
        let (mut products, mut squares) = (0.0, 0.0);
        for image in &images {
            let off = |pixel: usize| (f64::from(image[pixel].y) - mean[pixel]) / mean[pixel];
            for pixel in (0..mean.len()).filter(|pixel| pixel % width + 1 < width) {
                products += off(pixel) * off(pixel + 1);
                squares += off(pixel) * off(pixel);
            }
        }
        products / squares
    };
    let [own, apart] = [FilmSamples::Own, FilmSamples::Apart].map(correlation);
    assert!(own > 0.2 && apart.abs() < 0.05, "{own}, {apart}");
}
