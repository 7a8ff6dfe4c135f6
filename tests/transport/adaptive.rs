//! Renders that stop by precision: unbiased, within what they promise, and not fooled by pixels that are black so far.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use std::time::Duration;
use tyndall::{
    film::sharing::FilmSamples,
    math::Spectrum,
    passes::{Settings, budget::Budget},
    render::{self, Image, Precision},
    sampling::Sampler,
    scene::build::Setup,
    transport::{Options, Strategies},
};

/// Renders to a relative error, and to no more than some samples.
fn to_precision(stage: &Stage, strategies: Strategies, error: f64, most: Option<u64>, seed: u64) -> Image {
    let Setup { film, integrator, .. } = &stage.setup;
    let options = Options { strategies, max_depth: integrator.options.max_depth, ..Options::default() };
    let budget =
        Budget { samples_per_pixel: most, time: most.map(|_| Duration::from_secs(600)), ..Budget::ENDLESS };
    let settings = Settings {
        options,
        sampler: Sampler::Independent,
        film_samples: FilmSamples::Own,
        budget,
        seed,
        profile: stage.profile,
    };
    let precision = Precision { error, confidence: 0.95 };
    render::render_to_precision(&stage.setup, film, &settings, precision, &[], &mut |_| {}).unwrap()
}

/// A room full of fog with a small lamp: samples are many small ones and few great ones.
fn foggy_room(size: u32) -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], size)),
        ("room", room(0.6, Some(medium(1.0, 0.8, 0.3)))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.15, 4.0)),
    ])
}

#[test]
fn stopping_makes_no_bias() {
    const SEEDS: u64 = 160;
    let stage = Stage::new(&foggy_room(6));
    let mut claims = Claims::new();
    for (name, strategies) in [("pt", Strategies::PT), ("bdpt", Strategies::BDPT)] {
        // A loose error, so that pixels stop where luck would have them: a mean that ended by its own samples is 4 % too
        // dark here.
        let images: Vec<Image> =
            (0..SEEDS).map(|seed| to_precision(&stage, strategies, 0.5, None, seed)).collect();
        assert!(images.iter().all(|image| image.reached.as_ref().unwrap().share == 1.0));
        let pixels: Vec<_> = images.into_iter().map(|image| image.pixels).collect();
        let plain = stage.renders(Strategies::BDPT, 1024, 5000..5032);
        claims.equal(name, &Sample::of(&pixels, 6), &Sample::of(&plain, 6));
    }
    claims.settle();
}

/// The part of all channels of all pixels that are within `error` of the truth.
fn covered(images: &[Image], truth: &[Spectrum], error: f32) -> f64 {
    let floor = 0.01 * truth.iter().map(|t| t.element_sum() / 3.0).sum::<f32>() / truth.len() as f32;
    let within = |value: &Spectrum, truth: &Spectrum| {
        let allowed = (truth.abs() + floor) * error;
        (*value - *truth).abs().cmple(allowed).all()
    };
    let pairs = images.iter().flat_map(|image| image.pixels.iter().zip(truth));
    let hits = pairs.filter(|(value, truth)| within(value, truth)).count();
    hits as f64 / (images.len() * truth.len()) as f64
}

#[test]
fn pixels_are_within_the_error_as_often_as_promised() {
    const SEEDS: u64 = 12;
    let stage = Stage::new(&foggy_room(8));
    // 930 samples reach the smaller error: that of the truth is a fifth of it, and lowers the part by 0.005.
    let truth = stage.render(Strategies::BDPT, 20_000, 77);
    for (strategies, error) in [(Strategies::PT, 0.1), (Strategies::BDPT, 0.05)] {
        let images: Vec<Image> =
            (0..SEEDS).map(|seed| to_precision(&stage, strategies, error, None, seed)).collect();
        let part = covered(&images, &truth, error as f32);
        // Pixels of one render share light subpaths, so their number says little about how sure this is: by 64 pixels
        // that were one, 12 renders.
        assert!(part > 0.95 - 0.03, "{part} of the pixels are within {error}");
    }
}

#[test]
fn black_so_far_is_not_black() {
    // Camera subpaths alone must find a lamp that fills a thousandth of what a point of the floor sees.
    let scene = scene(&[
        ("integrator", json!({ "type": "path", "max_depth": 2 })),
        ("sensor", camera([0.0, 1.0, 2.0], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(0.0, 20.0, 0.5)),
        ("lamp", lamp_ball([0.0, 3.0, 0.0], 0.1, 1000.0)),
    ]);
    let stage = Stage::new(&scene);
    let hits = Strategies { emitter_hit: true, ..Strategies::NONE };
    let start = to_precision(&stage, hits, 0.5, Some(40), 1);
    let black = start.pixels.iter().filter(|pixel| **pixel == Spectrum::ZERO).count();
    assert!(black > 32 && start.reached.unwrap().share < 0.5, "{black} of 64 pixels are black so far");
    let image = to_precision(&stage, hits, 0.5, None, 1);
    assert!(image.pixels.iter().all(|pixel| *pixel != Spectrum::ZERO), "a lit pixel was left black");
    // What is black for good ends all the same.
    let dark = Stage::new(&common::pieces::scene(&[
        ("sensor", camera([0.0, 1.0, 2.0], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(0.0, 20.0, 0.5)),
    ]));
    let reached = to_precision(&dark, Strategies::BDPT, 0.01, None, 1).reached.unwrap();
    assert_eq!(reached.share, 1.0);
}

#[test]
fn samples_go_where_they_are_needed() {
    // Above the floor there is only a constant sky.
    let scene = scene(&[
        ("sensor", camera([0.0, 1.0, 4.0], [0.0, 1.0, 0.0], 16)),
        ("floor", floor(0.0, 100.0, 0.5)),
        ("sky", sky(1.0)),
        ("ball", null_ball([0.0, 0.5, 0.0], 0.5, medium(4.0, 0.9, 0.0))),
    ]);
    let reached = to_precision(&Stage::new(&scene), Strategies::PT, 0.02, None, 3).reached.unwrap();
    let (sky, ball) = (reached.samples[0], reached.samples[9 * 16 + 8]);
    assert_eq!((reached.share, sky), (1.0, 32));
    assert!(ball > 10 * sky, "{sky} {ball}");
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let stage = Stage::new(&foggy_room(40));
    let image = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| to_precision(&stage, Strategies::BDPT, 0.3, Some(64), 5))
    };
    let (one, three) = (image(1), image(3));
    assert_eq!(one.reached, three.reached);
    assert!(one.pixels.iter().zip(&three.pixels).all(|(a, b)| a.to_array() == b.to_array()));
}
