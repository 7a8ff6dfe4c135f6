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
fn shared_and_own_samples_show_the_same() {
    let sets = [Strategies::PT, Strategies::BDPT, strategies("hit+lens")];
    let mut claims = Claims::new();
    for filter in ["gaussian", "tent", "catmullrom", "lanczos"] {
        let [own, shared] = [FilmSamples::Own, FilmSamples::Shared].map(|samples| stage(filter, samples));
        let width = own.width();
        let truth = own.renders(Strategies::PT, 64, 5000..5000 + SEEDS);
        for (i, set) in sets.into_iter().enumerate() {
            let first = 100 * i as u64;
            let images = shared.renders(set, 16, first..first + SEEDS);
            let what = format!("{filter}, {}", crate::common::name_of(set));
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
