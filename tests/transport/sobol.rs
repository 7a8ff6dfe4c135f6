//! Sobol sampling shows the same image as independent sampling, on any number of threads, and with less noise.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{math::Spectrum, sampling::Sampler, transport::Strategies};

/// A scene rendered with points of Sobol's sequence.
fn even(scene: &Value) -> Stage {
    let mut stage = Stage::new(scene);
    stage.setup.sampler = Sampler::Sobol;
    stage
}

fn room_of(fog: Option<Value>, size: u32) -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], size)),
        ("room", room(0.6, fog)),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
        ("point", point([-0.5, 0.5, 0.0], 0.3)),
    ])
}

fn scenes(size: u32) -> Vec<(&'static str, Value)> {
    let smoke = json!({"type": "heterogeneous", "tracker": "null_collision", "scale": 2, "albedo": 0.8,
        "sigma_t": {"type": "exponential", "height": -0.8, "scale_height": 0.8}});
    let lens = [("type", json!("thinlens")), ("aperture_radius", json!(0.1)), ("focus_distance", json!(3))];
    let lens = with(camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], size), &lens);
    let cloud = scene(&[
        ("sensor", lens),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(smoke))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
    ]);
    vec![
        ("vacuum", room_of(None, size)),
        ("fog", room_of(Some(medium(1.0, 0.8, 0.3)), size)),
        ("chromatic fog", room_of(Some(medium(rgb(0.3, 1.0, 2.0), 0.8, 0.3)), size)),
        ("smoke", cloud),
    ]
}

const SETS: [Strategies; 3] = [Strategies::PT, Strategies::LT, Strategies::BDPT];

#[test]
fn the_image_is_that_of_independent_numbers() {
    let mut claims = Claims::new();
    for (name, scene) in scenes(8) {
        let (plain, even) = (Stage::new(&scene), even(&scene));
        for (i, set) in SETS.into_iter().enumerate() {
            let first = 1000 * i as u64;
            let measure = |stage: &Stage, first, samples| {
                Sample::of(&stage.renders(set, samples, first..first + 24), stage.width())
            };
            let independent = measure(&plain, first, 64);
            // Any number of passes will do, powers of two or not.
            for (shift, samples) in [(300, 64), (600, 7)] {
                let what = format!("{name}, {}, {samples} passes", common::name_of(set));
                claims.equal(&what, &measure(&even, first + shift, samples), &independent);
            }
        }
    }
    claims.settle();
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for (name, scene) in scenes(40) {
        let stage = even(&scene);
        let image = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pixels = pool.expect("threads").install(|| stage.render(Strategies::BDPT, 4, 11));
            pixels.iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>()
        };
        let one = image(1);
        assert!(one == image(3), "{name}");
        let plain = Stage::new(&scene).render(Strategies::BDPT, 4, 11);
        assert!(one != plain.iter().map(|v| v.to_array().map(f32::to_bits)).collect::<Vec<_>>(), "{name}");
    }
}

#[test]
fn a_scene_says_which_sampler() {
    for (name, sampler) in [
        ("independent", Sampler::Independent),
        ("sobol", Sampler::Sobol),
        ("ldsampler", Sampler::Sobol),
        ("multijitter", Sampler::Sobol),
        ("orthogonal", Sampler::Sobol),
        ("stratified", Sampler::Sobol),
    ] {
        let requested = json!({"type": name, "sample_count": 9});
        let view = with(camera([0.0, 1.0, 3.0], [0.0; 3], 8), &[("sampler", requested)]);
        let setup = Stage::new(&scene(&[("sensor", view), ("sky", sky(1.0))])).setup;
        assert_eq!((setup.sampler, setup.samples_per_pixel), (sampler, 9), "{name}");
    }
}

/// Mean over pixels of the variance of an image.
fn variance(stage: &Stage, set: Strategies, samples: u64) -> f64 {
    let seeds = 24u64;
    let images: Vec<Vec<Spectrum>> = stage.renders(set, samples, 0..seeds);
    let pixel = |i: usize| {
        let values: Vec<f64> = images.iter().map(|image| f64::from(image[i].y)).collect();
        let mean = values.iter().sum::<f64>() / seeds as f64;
        values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (seeds - 1) as f64
    };
    (0..images[0].len()).map(pixel).sum::<f64>() / images[0].len() as f64
}

#[test]
fn images_are_less_noisy() {
    // Light that reaches the eye by one reflection: few dimensions, all of them spread evenly.
    let parts = [
        ("sensor", camera([0.0, 1.0, 3.0], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-0.6, 4.0, 0.5)),
        ("lamp", lamp_panel([0.0, 1.5, 0.0], 0.5, 3.0)),
        ("integrator", depth(2)),
    ];
    let scene = scene(&parts);
    for (set, factor) in [(strategies("next-event"), 8.0), (Strategies::PT, 1.5), (Strategies::BDPT, 1.2)] {
        let (plain, even) = (variance(&Stage::new(&scene), set, 64), variance(&even(&scene), set, 64));
        assert!(factor * even < plain, "{}: {plain} {even}", common::name_of(set));
    }
}
