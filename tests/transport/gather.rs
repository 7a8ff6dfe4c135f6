//! The previews `gather` and `first-pass`: blurred, but of the right energy.

use crate::common::{Stage, pieces::*};
use serde_json::{Value, json};
use tyndall::{
    math::SpectrumExt,
    transport::{Algorithm, FirstPass, Guiding, Options},
};

/// A hollow ball around the camera whose wall reflects a half and shines, and a thing in it.
fn furnace(fog: Option<Value>, thing: Option<Value>) -> Stage {
    hollow(diffuse(0.5), fog, thing)
}

/// The same with any wall.
fn hollow(bsdf: Value, fog: Option<Value>, thing: Option<Value>) -> Stage {
    let shell = json!({
        "type": "sphere", "radius": 1, "flip_normals": true, "bsdf": bsdf,
        "emitter": {"type": "area", "radiance": 1.5},
    });
    let view = camera([0.0, 0.0, 0.2], [0.0, 0.0, -1.0], 8);
    let mut parts = match fog {
        None => vec![("sensor", view), ("shell", shell)],
        Some(fog) => vec![
            ("fog", fog),
            ("sensor", with(view, &[("medium", named("fog"))])),
            ("shell", with(shell, &[("exterior", named("fog"))])),
        ],
    };
    parts.extend(thing.map(|thing| ("thing", thing)));
    Stage::new(&scene(&parts))
}

/// The mean radiance of the previews of first passes that are solved in elements.
fn in_elements(stage: &mut Stage) -> Vec<(String, f64)> {
    let mut found = Vec::new();
    for first_pass in [FirstPass::Particles, FirstPass::Links] {
        for algorithm in [Algorithm::Gather, Algorithm::FirstPass] {
            let options = &mut stage.setup.integrator.options;
            *options = Options { first_pass, algorithm, ..*options };
            options.effort.guide = Guiding::Never;
            let image = stage.render(algorithm.strategies(), 64, 0);
            let mean =
                image.iter().map(|pixel| f64::from(pixel.luminance())).sum::<f64>() / image.len() as f64;
            found.push((format!("{} by {}", algorithm.name(), first_pass.name()), mean));
        }
    }
    stage.setup.integrator.options.first_pass = FirstPass::Usual;
    found
}

/// The mean radiance of some images, one half with a guide and one half without.
fn mean(stage: &mut Stage, algorithm: Algorithm) -> f64 {
    stage.setup.integrator.options.algorithm = algorithm;
    let mut all = Vec::new();
    for guide in [Guiding::Never, Guiding::Always] {
        stage.setup.integrator.options.effort.guide = guide;
        all.extend(stage.renders(algorithm.strategies(), 64, 0..4).concat());
    }
    all.iter().map(|pixel| f64::from(pixel.luminance())).sum::<f64>() / all.len() as f64
}

fn assert_close(what: &str, found: f64, expected: f64, within: f64) {
    assert!((found / expected - 1.0).abs() < within, "{what}: {found} instead of {expected}");
}

/// What is learnt is uniform, and so no worse for being blurred.
#[test]
fn furnaces_are_in_balance() {
    let ball = |bsdf: Value| {
        Some(json!({"type": "sphere", "center": [0.2, 0.1, -0.5], "radius": 0.3, "bsdf": bsdf}))
    };
    for (name, mut stage) in [
        ("empty", furnace(None, None)),
        ("mirror", furnace(None, ball(json!({"type": "conductor", "material": "none"})))),
        ("glass", furnace(None, ball(json!({"type": "dielectric"})))),
        ("fog", furnace(Some(medium(0.7, 1.0, 0.4)), None)),
        ("coloured fog", furnace(Some(medium(rgb(0.3, 0.6, 1.2), 1.0, 0.0)), None)),
    ] {
        assert_close(name, mean(&mut stage, Algorithm::Gather), 3.0, 0.01);
        for (preview, found) in in_elements(&mut stage) {
            // Links see no mirrors.
            let loses = preview.contains("links") && matches!(name, "mirror" | "glass");
            assert_close(&format!("{name}, {preview}"), found, 3.0, if loses { 0.25 } else { 0.02 });
        }
    }
}

/// Rough metal keeps about as much light as `pt` finds. Metal of alpha 0.4 counts as diffuse, and its ball was 3.9 % too dark.
#[test]
fn rough_walls_keep_their_light() {
    for alpha in [0.15, 0.4] {
        let metal = json!({"type": "roughconductor", "material": "none", "alpha": alpha, "specular_reflectance": 0.8});
        let mut stage = hollow(metal, None, None);
        let expected = mean(&mut stage, Algorithm::Pt);
        for (preview, found) in in_elements(&mut stage) {
            assert_close(&format!("alpha {alpha}, {preview}"), found, expected, 0.06);
        }
    }
}

/// Light of so many segments and no more, a part of it learnt.
#[test]
fn depth_counts_what_was_learnt() {
    let mut stage = furnace(None, None);
    let mut expected = 0.0;
    for depth in 1..=5 {
        expected += 1.5 * 0.5f64.powi(depth - 1);
        stage.setup.integrator.options.max_depth = Some(depth as u32);
        assert_close(&format!("depth {depth}"), mean(&mut stage, Algorithm::Gather), expected, 0.01);
        for (preview, found) in in_elements(&mut stage) {
            assert_close(&format!("depth {depth}, {preview}"), found, expected, 0.02);
        }
    }
}

/// Light that comes round a wall, to fog and to a mirror, ends at the wall in the preview too.
#[test]
fn light_behind_a_wall_stays_there() {
    let parts = |fog| {
        scene(&[
            ("sensor", camera([0.0, -0.5, 0.8], [0.0, -0.6, -1.0], 8)),
            ("room", room(0.6, fog)),
            ("wall", floor(0.0, 0.85, 0.5)),
            ("lamp", lamp_ball([0.2, 0.6, -0.3], 0.15, rgb(2.0, 3.0, 1.0))),
        ])
    };
    for (name, fog) in [("vacuum", None), ("fog", Some(medium(0.7, 0.8, 0.3)))] {
        let mut stage = Stage::new(&parts(fog));
        let expected = mean(&mut stage, Algorithm::Bdpt);
        assert_close(name, mean(&mut stage, Algorithm::Gather), expected, 0.1);
    }
}

/// In clouds light is scattered many times over short distances.
#[test]
fn dense_clouds_are_as_bright() {
    let phase = json!({"type": "hg", "g": 0.85});
    let dense = [("scale", json!(30)), ("albedo", json!(0.99)), ("phase", phase)];
    let mut stage = Stage::new(&cloud_under_sky(&dense));
    let expected = mean(&mut stage, Algorithm::Bdpt);
    assert_close("cloud", mean(&mut stage, Algorithm::Gather), expected, 0.03);
}

/// What a glossy surface shows depends on where it is seen from: walks go on there, and cells of what lies beside it do not hold it.
#[test]
fn glossy_surfaces_are_no_places_to_end() {
    let text = include_str!("../../scenes/gallery/reflector.json");
    let mut reflector: Value = serde_json::from_str(text).unwrap();
    for (side, pixels) in [("width", 48), ("height", 36)] {
        reflector["camera"]["film"][side] = json!(pixels);
    }
    let mut stage = Stage::new(&reflector);
    // Of the dim parts: few paths make the bright ones.
    let mut median = |algorithm: Algorithm, guide: Guiding| {
        let options = &mut stage.setup.integrator.options;
        (options.algorithm, options.effort.guide) = (algorithm, guide);
        let image = stage.render(algorithm.strategies(), 256, 0);
        let mut all: Vec<f64> = image.iter().map(|pixel| f64::from(pixel.luminance())).collect();
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    let expected = median(Algorithm::Bdpt, Guiding::Never);
    assert_close("reflector", median(Algorithm::Gather, Guiding::Always), expected, 0.25);
}
