//! Motion blur shows the mean of what the scene shows while the shutter is open: by every integrator, whatever was learnt.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use std::sync::LazyLock;
use tyndall::{
    math::Spectrum,
    passes::{Settings, budget::Budget},
    render::{self, Precision},
    settings::options::Guiding,
    transport::{Effort, LightStarts, Strategies},
};

fn keyed(first: Value, last: Value) -> Value {
    json!({"type": "keyframes", "value": [[0.0, first], [1.0, last]]})
}

fn moved(from: [f64; 3], to: [f64; 3]) -> Value {
    let at = |value: [f64; 3]| json!([{"type": "translate", "value": value}]);
    keyed(at(from), at(to))
}

/// A room full of fog where all there is moves: the camera, a lamp that grows brighter beside one that goes out, a ball.
fn scene_open(opens: f64, closes: f64) -> Value {
    let look =
        |x: f64| json!([{"type": "lookat", "origin": [x, 0.0, 0.9], "target": [0, 0, -1], "up": [0, 1, 0]}]);
    let view = [
        ("to_world", keyed(look(-0.3), look(0.3))),
        ("shutter_open", opens.into()),
        ("shutter_close", closes.into()),
    ];
    let lamp = |first: f64, last: f64| json!({"type": "area", "radiance": keyed(first.into(), last.into())});
    let ball = |radius: f64, way: Value, more: &[(&str, Value)]| {
        with(json!({"type": "sphere", "radius": radius, "to_world": way}), more)
    };
    scene(&[
        ("sensor", with(camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8), &view)),
        ("room", room(0.6, Some(medium(0.7, 0.8, 0.3)))),
        ("grows", ball(0.2, moved([-0.6, 0.6, 0.0], [-0.2, 0.7, -0.5]), &[("emitter", lamp(0.5, 8.0))])),
        ("fades", ball(0.1, moved([0.5, -0.3, -0.4], [0.5, 0.5, -0.4]), &[("emitter", lamp(20.0, 1.0))])),
        ("dark", ball(0.3, moved([-0.6, -0.5, -0.5], [0.4, -0.5, 0.0]), &[("bsdf", diffuse(0.2))])),
    ])
}

const SEEDS: u64 = 16;
const TIMES: usize = 16;

/// The mean of images of scenes that stand still, at times that lie evenly.
static STILL: LazyLock<Sample> = LazyLock::new(|| {
    let at = |k: usize| (k as f64 + 0.5) / TIMES as f64;
    let stages: Vec<Stage> = (0..TIMES).map(|k| Stage::new(&scene_open(at(k), at(k)))).collect();
    let image = |seed: u64| -> Vec<Spectrum> {
        let images = stages.iter().map(|stage| stage.render(Strategies::BDPT, 4, seed));
        let sum = images.reduce(|a, b| a.iter().zip(&b).map(|(a, b)| *a + *b).collect()).unwrap();
        sum.iter().map(|sum| *sum / TIMES as f32).collect()
    };
    Sample::of(&(0..SEEDS).map(image).collect::<Vec<_>>(), 8)
});

#[test]
fn the_image_is_the_mean_over_the_exposure() {
    let mut claims = Claims::new();
    let mut stage = Stage::new(&scene_open(0.0, 1.0));
    let learnt = Effort { starts: LightStarts::Learnt, ..Effort::default() };
    let guided = Effort { guide: Guiding::Always, ..learnt };
    let all = [
        ("pt", Strategies::PT, Effort::default()),
        ("lt", Strategies::LT, Effort::default()),
        ("bdpt", Strategies::BDPT, Effort::default()),
        ("lt, learnt starts", Strategies::LT, learnt),
        ("bdpt, learnt starts", Strategies::BDPT, learnt),
        ("bdpt, guided", Strategies::BDPT, guided),
    ];
    for (number, (name, strategies, effort)) in all.into_iter().enumerate() {
        stage.setup.integrator.options.effort = effort;
        let first = 1000 * (number as u64 + 1);
        let images = stage.renders(strategies, 64, first..first + SEEDS);
        claims.equal(name, &Sample::of(&images, stage.width()), &STILL);
    }
    claims.settle();
}

#[test]
fn pixels_that_end_sooner_see_all_of_the_exposure() {
    let mut claims = Claims::new();
    let stage = Stage::new(&scene_open(0.0, 1.0));
    let image = |seed: u64| {
        let settings = Settings { budget: Budget::samples(400), ..stage.settings(Strategies::BDPT, 1, seed) };
        let precision = Precision { error: 0.4, confidence: 0.9 };
        let film = &stage.setup.film;
        render::render_to_precision(&stage.setup, film, &settings, precision, &[], &mut |_| {})
            .unwrap()
            .pixels
    };
    let images: Vec<_> = (0..SEEDS).map(image).collect();
    claims.equal("to a precision", &Sample::of(&images, stage.width()), &STILL);
    claims.settle();
}
