//! Paths of at least so many segments: lengths add up to the image of all, whichever strategies make them, and what does not
//! count is black.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    name_of,
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{
    math::Spectrum,
    transport::{Connections, Guiding, LightStarts, Strategies},
};

const SEEDS: u64 = 12;
const SAMPLES: u64 = 48;
const DEEPEST: u32 = 6;

fn sensor() -> Value {
    // What is scattered next to the lens would give light subpaths an infinite variance.
    with(camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8), &[("near_clip", json!(0.3))])
}

/// Surfaces, fog, fire, and lamps that are passed or met.
fn scenes() -> Vec<(&'static str, Value)> {
    let lamp = lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0));
    let in_room =
        |fog: Option<Value>| scene(&[("sensor", sensor()), ("room", room(0.6, fog)), ("lamp", lamp.clone())]);
    let fog = medium(1.0, 0.8, 0.3);
    let cloud = null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(medium(rgb(0.5, 1.0, 2.0), 0.9, 0.0)));
    let passed = with(lamp.clone(), &[("bsdf", json!({"type": "null"}))]);
    vec![
        ("vacuum", in_room(None)),
        ("fog", in_room(Some(fog.clone()))),
        ("fire", in_room(Some(with(fog, &[("radiance", json!(0.5))])))),
        (
            "cloud",
            scene(&[
                ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
                ("floor", floor(-0.6, 2.0, 0.5)),
                ("cloud", cloud),
                ("lamp", passed),
                ("sky", sky(0.5)),
            ]),
        ),
    ]
}

/// `scene` with paths of `least` to `most` segments alone.
fn of_lengths(scene: &Value, least: u32, most: u32, more: &[(&str, Value)]) -> Stage {
    let lengths = [("type", json!("bdpt")), ("min_depth", json!(least)), ("max_depth", json!(most))];
    let integrator = with(json!({}), &[&lengths, more].concat());
    Stage::new(&with(scene.clone(), &[("integrator", integrator)]))
}

fn sample(stage: &Stage, set: Strategies, first: u64) -> Sample {
    Sample::of(&stage.renders(set, SAMPLES, first..first + SEEDS), stage.width())
}

#[test]
fn lengths_add_up_to_all_paths() {
    let forced: &[(&str, Value)] = &[("forced_interaction", json!(true))];
    for (name, scene) in scenes() {
        let mut claims = Claims::new();
        for (set, more) in [
            (Strategies::BDPT, &[][..]),
            (strategies("hit"), &[]),
            (Strategies::PT, forced),
            (strategies("hit+next-event+join+lens+equiangular"), &[]),
        ] {
            let all = sample(&of_lengths(&scene, 0, DEEPEST, more), set, 0);
            let parts = (1..=DEEPEST).map(|length| {
                let part = of_lengths(&scene, length, length, more);
                sample(&part, set, 1000 * u64::from(length))
            });
            let sum = parts.reduce(|sum, part| sum.plus(&part)).unwrap();
            claims.equal(&format!("{name}: {} of all lengths", name_of(set)), &sum, &all);
        }
        claims.settle();
    }
}

#[test]
fn all_strategies_agree_on_long_paths() {
    for (name, scene) in scenes() {
        let mut claims = Claims::new();
        let stage = of_lengths(&scene, 3, DEEPEST, &[]);
        let all = sample(&stage, Strategies::BDPT, 0);
        let mut others = vec![(Strategies::PT, 1000), (strategies("hit"), 2000)];
        // Light subpaths leave an environment everywhere: alone they are too noisy for so few.
        if name != "cloud" {
            others.push((Strategies::LT, 3000));
        }
        for (set, first) in others {
            claims.equal(&format!("{name}: {}", name_of(set)), &sample(&stage, set, first), &all);
        }
        let mut guided = of_lengths(&scene, 3, DEEPEST, &[]);
        guided.setup.integrator.options.effort.guide = Guiding::Always;
        guided.setup.integrator.options.effort.starts = LightStarts::Learnt;
        claims.equal(&format!("{name}: guided"), &sample(&guided, Strategies::BDPT, 4000), &all);
        let mut paired = of_lengths(&scene, 3, DEEPEST, &[]);
        paired.setup.integrator.options.connections = Connections::All;
        claims.equal(&format!("{name}: pairs of walks"), &sample(&paired, Strategies::BDPT, 5000), &all);
        claims.settle();
    }
}

#[test]
fn no_limit_is_none() {
    for (name, scene) in scenes() {
        for set in [Strategies::BDPT, Strategies::LT] {
            let [none, one] = [0, 1].map(|least| of_lengths(&scene, least, 8, &[]).render(set, 4, 3));
            assert_eq!(none, one, "{name}");
        }
    }
}

/// There is no light on paths of more segments than there are, nor where no path counts.
#[test]
fn what_does_not_count_is_black() {
    let open = scene(&[
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("lamp", lamp_panel([0.0, 1.5, 0.0], 0.3, 5.0)),
    ]);
    let is_black = |image: &[Spectrum]| image.iter().all(|pixel| *pixel == Spectrum::ZERO);
    for set in [Strategies::BDPT, Strategies::PT, Strategies::LT] {
        // The floor sees the lamp, and nothing else.
        assert!(!is_black(&of_lengths(&open, 2, 2, &[]).render(set, 16, 1)), "{}", name_of(set));
        assert!(is_black(&of_lengths(&open, 4, 40, &[]).render(set, 16, 1)), "{}", name_of(set));
        let mut none = of_lengths(&open, 0, 3, &[]);
        none.setup.integrator.options.min_depth = 9;
        assert!(is_black(&none.render(set, 16, 1)), "{}", name_of(set));
    }
    // Through the camera's view of the lamp itself come paths of one segment.
    let [all, scattered] =
        [1, 2].map(|least| of_lengths(&open, least, 1.max(least), &[]).render(Strategies::LT, 64, 1));
    assert!(!is_black(&all) && all != scattered);
}
