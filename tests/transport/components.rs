//! Layers of the components of radiance (P03 eq. 17): they add up to the image, which is the same without them, they are
//! what closed forms say, and every integrator finds the same.

use crate::{
    common::{Stage, claims::Claims, claims::Sample, name_of, pieces::*, strategies},
    groups::{SETS, assert_close, fogs, layer_named, room_with},
};
use serde_json::{Value, json};
use std::f64::consts::PI;
use tyndall::{math::Spectrum, transport::Strategies};

const COMPONENTS: [&str; 4] = ["unscattered", "emitted", "scattered.single", "scattered.multiple"];

#[test]
fn components_add_up_to_the_image_that_there_is_without_them() {
    for (name, fog) in fogs() {
        let scene = room_with(fog, "", &[]);
        let (plain, split) = (Stage::new(&scene), Stage::with_components(&scene));
        let both = Stage::with_groups_and_components(&scene);
        for set in SETS.map(strategies) {
            let image = split.render_layers(set, 6, 3);
            let what = format!("{name}, {}", name_of(set));
            assert_eq!(image.pixels, plain.render(set, 6, 3), "{what}");
            let layers = COMPONENTS.map(|component| layer_named(&image, component));
            assert_close(&what, &image.pixels, |pixel| layers.iter().map(|layer| layer[pixel]).sum());
            let image = both.render_layers(set, 6, 3);
            for (component, layer) in COMPONENTS.iter().zip(&layers) {
                let end = format!(".{component}.R");
                let groups = image.layers.iter().filter_map(|channel| channel.name.strip_suffix(&end));
                let groups: Vec<_> =
                    groups.map(|group| layer_named(&image, &format!("{group}.{component}"))).collect();
                assert!(groups.len() >= 3);
                assert_close(&what, layer, |pixel| groups.iter().map(|layer| layer[pixel]).sum());
            }
        }
    }
}

/// Down through a slab of `medium`, 1 m thick, to what is behind, and paths of so many segments.
fn slab(medium: Value, behind: &[(&str, Value)], max_depth: i64) -> Value {
    let view = json!([{"type": "scale", "value": [0.45, 0.45, 1]},
        {"type": "lookat", "origin": [0, 0, 3], "target": [0, 0, 0], "up": [0, 1, 0]}]);
    let sensor = json!({
        "type": "orthographic", "to_world": view,
        "film": {"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}},
    });
    let slab = null_box([-0.5; 3], [0.5; 3], Some(medium));
    scene(&[&[("integrator", depth(max_depth)), ("sensor", sensor), ("slab", slab)], behind].concat())
}

fn wall(more: &[(&str, Value)]) -> Value {
    with(json!({"type": "rectangle", "to_world": [{"type": "translate", "value": [0, 0, -2]}]}), more)
}

/// The claim that every pixel of every component is what `expected` says, by path tracing, light tracing and both. Of light
/// subpaths from a sun few collide in a thin slab, and only those that do are seen: for a mean to be normal there must be more.
fn shows(claims: &mut Claims, what: &str, scene: &Value, expected: [f64; 4]) {
    let stage = Stage::with_components(scene);
    for (set, samples) in [(Strategies::PT, 400), (Strategies::LT, 4000), (Strategies::BDPT, 400)] {
        let images: Vec<_> = (0..16).map(|seed| stage.render_layers(set, samples, seed)).collect();
        for (component, expected) in COMPONENTS.iter().zip(expected) {
            let layers: Vec<_> = images.iter().map(|image| layer_named(image, component)).collect();
            claims.every_pixel(&format!("{what}, {component} by {}", name_of(set)), &layers, expected);
        }
    }
}

/// exp(-tau) of a lamp behind a slab, and what the slab emits; then single scattering of the sun, which shines the way
/// that one looks: P03 eq. 18-19 are an integral of sigma_s p exp(-2 sigma_t s) there.
#[test]
fn a_slab_has_closed_forms() {
    let mut claims = Claims::new();
    for tau in [0.1, 1.0, 3.0] {
        let (albedo, g) = (0.6, 0.3);
        let fog = medium(tau, albedo, g);
        let lamp = wall(&[("emitter", json!({"type": "area", "radiance": 2}))]);
        let glowing = slab(with(fog.clone(), &[("radiance", json!(1))]), &[("lamp", lamp)], 1);
        let through = f64::exp(-tau);
        let emitted = (1.0 - albedo) * (1.0 - through);
        shows(&mut claims, &format!("glow of {tau}"), &glowing, [2.0 * through, emitted, 0.0, 0.0]);
        let lit = [("sun", sun([0.0, 0.0, -1.0], 3.0)), ("wall", wall(&[("bsdf", diffuse(0.5))]))];
        let back = (1.0 - g * g) / (4.0 * PI * (1.0 + g).powi(3));
        let single = 3.0 * albedo * back * 0.5 * (1.0 - through * through);
        let seen = 3.0 * 0.5 / PI * through * through;
        shows(&mut claims, &format!("sun on {tau}"), &slab(fog, &lit, 2), [seen, 0.0, single, 0.0]);
    }
    claims.settle();
}

/// With as many vertices as there are, in fog that glows among lamps of all kinds.
#[test]
fn every_integrator_finds_the_same_components() {
    let mut claims = Claims::new();
    for (name, fog) in fogs().into_iter().skip(1) {
        let room = room_with(fog, "", &[]);
        let forced =
            with(room.clone(), &[("integrator", json!({"type": "bdpt", "forced_interaction": true}))]);
        let stages = [Stage::with_components(&room), Stage::with_components(&forced)];
        let samples = |stage: &Stage, set: Strategies, first: u64| -> Vec<Sample> {
            let images: Vec<_> = (first..first + 12).map(|seed| stage.render_layers(set, 32, seed)).collect();
            let layers = |component| -> Vec<Vec<Spectrum>> {
                images.iter().map(|image| layer_named(image, component)).collect()
            };
            COMPONENTS.map(|component| Sample::of(&layers(component), stage.width())).into()
        };
        let reference = samples(&stages[0], strategies("hit+next-event"), 0);
        let others = [
            (&stages[0], "lens"),
            (&stages[0], "hit+next-event+join+lens"),
            (&stages[0], "hit+next-event+join+lens+equiangular"),
            (&stages[1], "hit+next-event+join+lens"),
        ];
        for (k, (stage, set)) in (1..).zip(others) {
            let found = samples(stage, strategies(set), 100 * k);
            for (component, (found, reference)) in COMPONENTS.iter().zip(found.iter().zip(&reference)) {
                claims.equal(&format!("{name}, {component} by {set}, {k}"), found, reference);
            }
        }
    }
    claims.settle();
}
