//! What goes wrong inside a render costs little, and is said. Nothing goes wrong in the scenes of other tests: theirs fail
//! where it does.

use crate::common::{
    Stage,
    pieces::{camera, depth, diffuse, floor, lamp_ball, named, scene, with},
};
use serde_json::json;
use tyndall::{
    bsdf::{Bsdf, Diffuse},
    passes::faults::{Cause, Faults},
    render::{self, Image},
    transport::Strategies,
};

const SAMPLES: u64 = 2;

/// A floor below a lamp, and a small tile on it: the last shape, with the last bsdf.
fn stage() -> Stage {
    let tile = with(floor(-0.99, 0.08, 0.5), &[("bsdf", named("black"))]);
    Stage::new(&scene(&[
        ("integrator", depth(4)),
        ("sensor", camera([0.0, 0.5, 4.0], [0.0, -0.9, 0.0], 64)),
        ("floor", floor(-1.0, 3.0, 0.5)),
        ("lamp", lamp_ball([0.0, 2.0, 0.0], 0.4, 5.0)),
        ("black", with(diffuse(0.25), &[("id", json!("black"))])),
        ("tile", tile),
    ]))
}

fn image(stage: &Stage, strategies: Strategies) -> Image {
    let settings = stage.settings(strategies, SAMPLES, 3);
    render::render(&stage.setup, &stage.setup.film, &settings, &mut |_| {}).unwrap()
}

#[test]
fn what_is_not_finite_is_left_out_and_named() {
    for strategies in [Strategies::PT, Strategies::BDPT, Strategies::LT] {
        let mut stage = stage();
        let sound = image(&stage, strategies);
        assert_eq!(sound.faults, Faults::default());
        let last = stage.setup.scene.bsdfs.len() - 1;
        stage.setup.scene.bsdfs[last] = Bsdf::Diffuse(Diffuse::grey(f32::NAN));
        let Image { pixels, faults, .. } = image(&stage, strategies);
        assert!(faults.count > 0 && !faults.first.is_empty(), "{faults:?}");
        assert!(
            faults.first.iter().all(|fault| matches!(fault.cause, Cause::NotFinite { .. })),
            "{faults:?}"
        );
        assert!(pixels.iter().all(|pixel| pixel.is_finite()));
        let touched = pixels.iter().zip(&sound.pixels).filter(|(a, b)| a != b).count();
        assert!(touched < pixels.len() / 2, "{touched} of {}", pixels.len());
    }
}

#[test]
fn a_panic_costs_the_samples_that_it_hits() {
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let mut stage = stage();
    let sound = image(&stage, Strategies::PT);
    let tile = stage.setup.scene.surfaces.len() - 1;
    stage.setup.scene.surfaces[tile].bsdf = 999;
    let broken = image(&stage, Strategies::PT);
    std::panic::set_hook(hook);
    let faults = &broken.faults;
    assert!(faults.count > 0 && matches!(faults.first[0].cause, Cause::Panic(_)), "{faults:?}");
    let changed: Vec<usize> =
        (0..sound.pixels.len()).filter(|i| sound.pixels[*i] != broken.pixels[*i]).collect();
    assert!(changed.len() as u64 <= faults.count && !changed.is_empty());
    // A sample that was black is not missed.
    let is_seen = |pixel: Option<u32>| changed.contains(&(pixel.unwrap() as usize));
    assert!(faults.first.iter().all(|fault| fault.sample < SAMPLES), "{faults:?}");
    assert!(faults.first.iter().any(|fault| is_seen(fault.pixel)), "{faults:?}");
}
