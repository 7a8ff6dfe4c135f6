//! Sobol sampling shows the same image as independent sampling, on any number of threads, and with less noise.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{
    math::{Spectrum, SpectrumExt},
    render::Image,
    sampling::Sampler,
    transport::Strategies,
};

/// A scene rendered with points of Sobol's sequence.
fn even(scene: &Value) -> Stage {
    let mut stage = Stage::new(scene);
    stage.setup.sampler = Some(Sampler::Sobol);
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
        // The default of Mitsuba's scenes: no choice.
        ("independent", None),
        ("sobol", Some(Sampler::Sobol)),
        ("ldsampler", Some(Sampler::Sobol)),
        ("multijitter", Some(Sampler::Sobol)),
        ("orthogonal", Some(Sampler::Sobol)),
        ("stratified", Some(Sampler::Sobol)),
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

/// Light that reaches the eye by one reflection: few dimensions, all of them spread evenly. No pixel shows an edge.
fn one_reflection() -> Value {
    scene(&[
        ("sensor", camera([0.0, 3.0, 0.1], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-0.6, 4.0, 0.5)),
        ("lamp", lamp_panel([2.5, 1.5, 0.0], 0.5, 3.0)),
        ("integrator", depth(2)),
    ])
}

#[test]
fn images_are_less_noisy() {
    let scene = one_reflection();
    for (set, factor) in [(strategies("next-event"), 8.0), (Strategies::PT, 1.3), (Strategies::BDPT, 1.2)] {
        let (plain, even) = (variance(&Stage::new(&scene), set, 64), variance(&even(&scene), set, 64));
        assert!(factor * even < plain, "{}: {plain} {even}", common::name_of(set));
    }
}

/// The noise that a render shows is that of its image, squared and on average, however evenly its samples are spread. (Relative
/// to its own brightness, that is: where rare samples are bright, an image without them is darker, and shows less than its error.
/// So none are here.)
#[test]
fn the_noise_shown_is_that_of_the_image() {
    for (stage, set) in
        [(even(&one_reflection()), strategies("next-event")), (even(&room_of(None, 8)), Strategies::BDPT)]
    {
        let (seeds, samples) = (400u64, 16);
        let images: Vec<Image> =
            (0..seeds).map(|seed| stage.render_layers(set, samples, 900 + seed)).collect();
        let mean = |i: usize| images.iter().map(|image| luminance(image, i)).sum::<f64>() / seeds as f64;
        let means: Vec<f64> = (0..images[0].pixels.len()).map(mean).collect();
        let floor = 0.01 * (means.iter().sum::<f64>() / means.len() as f64).powi(2);
        let error = |image: &Image| {
            let of = |(i, mean): (usize, &f64)| (luminance(image, i) - mean).powi(2) / (mean * mean + floor);
            means.iter().enumerate().map(of).sum::<f64>() / means.len() as f64 * seeds as f64
                / (seeds - 1) as f64
        };
        let excess: Vec<f64> =
            images.iter().map(|image| image.noise.expect("noise").error.powi(2) - error(image)).collect();
        let average = excess.iter().sum::<f64>() / seeds as f64;
        let variance = excess.iter().map(|e| (e - average).powi(2)).sum::<f64>() / (seeds - 1) as f64;
        let z = average / (variance / seeds as f64).sqrt();
        assert!(z.abs() < 3.5, "{}: {z}, {average} more than {}", common::name_of(set), error(&images[0]));
    }
}

fn luminance(image: &Image, pixel: usize) -> f64 {
    f64::from(image.pixels[pixel].luminance())
}
