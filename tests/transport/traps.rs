//! Known traps of bidirectional transport through media, one test each, named for its cause.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{math::Spectrum, transport::Strategies};

const SEEDS: u64 = 12;
const METHODS: [(&str, Strategies); 3] =
    [("pt", Strategies::PT), ("lt", Strategies::LT), ("bdpt", Strategies::BDPT)];

/// Figures of a scene over [`SEEDS`] seeds from `first` on.
fn measure(stage: &Stage, set: Strategies, samples_per_pixel: u64, first: u64) -> Sample {
    Sample::of(&stage.renders(set, samples_per_pixel, first..first + SEEDS), stage.width())
}

/// Two scenes show the same image by every method.
fn same_image(what: &str, a: &Value, b: &Value, samples_per_pixel: u64) {
    let (a, b) = (Stage::new(a), Stage::new(b));
    let mut claims = Claims::new();
    for (i, (name, set)) in METHODS.into_iter().enumerate() {
        let first = 1000 * i as u64;
        let (a, b) =
            (measure(&a, set, samples_per_pixel, first), measure(&b, set, samples_per_pixel, first + 500));
        claims.equal(&format!("{what}, {name}"), &a, &b);
    }
    claims.settle();
}

/// `pt` and `lt` show the same image of a scene, and so does `bdpt`.
fn methods_agree(what: &str, stage: &Stage, samples_per_pixel: u64) {
    let [pt, lt, bdpt] = [0, 1, 2].map(|i| measure(stage, METHODS[i].1, samples_per_pixel, 1000 * i as u64));
    let mut claims = Claims::new();
    claims.equal(&format!("{what}: lt against pt"), &lt, &pt);
    claims.equal(&format!("{what}: bdpt against pt"), &bdpt, &pt);
    claims.equal(&format!("{what}: bdpt against lt"), &bdpt, &lt);
    claims.settle();
}

/// Pixel by pixel, `found` is `expected` up to rounding.
fn assert_close(what: &str, found: &[Spectrum], expected: impl Fn(usize) -> Spectrum, relative: f32) {
    for (i, found) in found.iter().enumerate() {
        let expected = expected(i);
        let error = (*found - expected).abs().max_element();
        assert!(error <= relative * expected.max_element(), "{what}, pixel {i}: {found} against {expected}");
    }
}

fn in_the_room() -> (&'static str, Value) {
    ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8))
}

/// Light subpaths of lamps without a surface start in the fog around them: a tracer that takes them to start in
/// vacuum is too bright.
#[test]
fn light_walks_start_in_the_fog_around_their_lamp() {
    let fog = medium(0.8, 0.9, 0.4);
    let lamps = [
        ("point", point([0.4, 0.5, -0.2], 0.5)),
        ("spotlight", spot([-0.6, 0.6, 0.2], [0.2, -0.5, -0.6], 2.0)),
    ];
    for (name, lamp) in lamps {
        let parts = [in_the_room(), ("room", room(0.5, Some(fog.clone()))), ("lamp", lamp.clone())];
        methods_agree(&format!("{name} in a room of fog"), &Stage::new(&scene(&parts)), 128);
        let parts = [
            ("sensor", camera([0.0, 0.0, 3.5], [0.0, 0.0, 0.0], 8)),
            ("floor", floor(-1.0, 2.0, 0.5)),
            ("cloud", null_box([-0.9; 3], [0.9; 3], Some(fog.clone()))),
            ("lamp", lamp),
        ];
        methods_agree(&format!("{name} in a cloud"), &Stage::new(&scene(&parts)), 128);
    }
}

/// A lamp that reaches out of its fog: the light of either half starts in a medium of its own.
#[test]
fn a_lamp_across_a_boundary_starts_in_both_media() {
    let fog = medium(3.0, 0.8, 0.0);
    for x in [0.3, 0.5] {
        let parts = [
            ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
            ("floor", floor(-1.0, 2.0, 0.5)),
            ("cloud", null_box([-0.5; 3], [0.5; 3], Some(fog.clone()))),
            ("lamp", lamp_panel([x, 0.3, 0.0], 0.4, 2.0)),
        ];
        methods_agree(&format!("lamp at {x}"), &Stage::new(&scene(&parts)), 128);
    }
}

#[test]
fn fog_without_bounds_is_fog_in_a_large_box() {
    let parts = vec![
        ("fog", medium(1.0, 0.8, 0.3)),
        ("floor", floor(-0.7, 1.0, 0.5)),
        ("ball", lamp_ball([0.5, 0.2, 0.0], 0.3, rgb(2.0, 1.0, 1.0))),
        ("point", point([-0.6, 0.6, 0.2], 0.5)),
    ];
    let view = camera([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], 8);
    let mut unbounded = parts.clone();
    unbounded.push(("sensor", with(view.clone(), &[("medium", named("fog"))])));
    let mut boxed = parts;
    boxed.push(("sensor", view));
    // At its walls, 40 optical depths away, nothing is left of the light.
    boxed.push(("box", null_box([-40.0; 3], [40.0; 3], Some(named("fog")))));
    same_image("unbounded against boxed", &scene(&unbounded), &scene(&boxed), 128);
}

#[test]
fn null_boundaries_are_no_path_vertices() {
    let cloud = |high: f64| null_box([-0.9; 3], [0.9, high, 0.9], Some(named("fog")));
    let plain = vec![
        ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
        ("fog", medium(1.0, 0.9, 0.3)),
        ("floor", floor(-1.0, 2.0, 0.5)),
        ("cloud", cloud(0.7)),
        ("lamp", lamp_panel([0.0, 1.2, 0.0], 0.8, 2.0)),
        ("point", point([1.5, 1.0, 1.0], 1.0)),
    ];
    let same = null_box([-0.6, -0.5, -0.7], [0.3, 0.2, 0.4], Some(named("fog")));
    let inner = with(same, &[("exterior", named("fog"))]);
    let ball = with(null_ball([0.2, 0.1, 0.2], 0.3, named("fog")), &[("exterior", named("fog"))]);
    let empty = null_box([-1.5, -0.95, -1.5], [1.5, 1.1, 1.5], None);
    for max_depth in [2, 3] {
        let mut plain = plain.clone();
        plain.push(("integrator", depth(max_depth)));
        let mut crossed = plain.clone();
        crossed.extend([("inner", inner.clone()), ("ball", ball.clone()), ("empty", empty.clone())]);
        same_image(&format!("max_depth {max_depth}"), &scene(&plain), &scene(&crossed), 128);
    }
}

/// A corner of floor and wall lit by a lamp, and, around `centre`, a ball that only absorbs. No way from one
/// point of the corner to another leads through it.
fn corner_with_ball(lamp: &Value, eye: [f64; 3], ball: Option<([f64; 3], f64)>) -> Value {
    let wall = json!({
        "type": "rectangle", "bsdf": diffuse(0.6),
        "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 90},
                     {"type": "translate", "value": [-1.0, 0.0, 0.0]}],
    });
    let view = with(camera(eye, [-0.5, -0.5, 0.0], 8), &[("near_clip", json!(0.0))]);
    let mut parts =
        vec![("sensor", view), ("floor", floor(-1.0, 1.0, 0.6)), ("wall", wall), ("lamp", lamp.clone())];
    if let Some((centre, radius)) = ball {
        parts.push(("ball", null_ball(centre, radius, medium(2.0, 0.0, 0.0))));
    }
    scene(&parts)
}

/// Every way from the lamp (or to the eye) leads radially through a ball of optical thickness 1: the image is
/// that without the ball times exp(-1), exactly where transmittances are computed, in mean where they are drawn.
#[test]
fn absorption_counts_on_every_connection() {
    let bulb = point([1.6, 1.6, 0.0], rgb(3.0, 2.0, 1.0));
    let panel = lamp_panel([0.3, 1.5, 0.0], 0.7, 2.0);
    let eye = [1.5, 0.3, 1.5];
    let cases = [
        (
            "around the bulb",
            &bulb,
            [1.6, 1.6, 0.0],
            "next-event lens next-event+join join+lens hit+next-event+join+lens",
        ),
        (
            "around the eye",
            &panel,
            eye,
            "hit hit+next-event hit+join lens join+lens hit+next-event+join+lens",
        ),
    ];
    let mut claims = Claims::new();
    for (place, lamp, centre, sets) in cases {
        let clear = Stage::new(&corner_with_ball(lamp, eye, None));
        let veiled = Stage::new(&corner_with_ball(lamp, eye, Some((centre, 0.5))));
        for set in sets.split(' ') {
            let clear = measure(&clear, strategies(set), 128, 0).scaled((-1f64).exp());
            let veiled = measure(&veiled, strategies(set), 128, 500);
            claims.equal(&format!("{set}, ball {place}"), &veiled, &clear);
        }
    }
    claims.settle();
}

/// The same where nothing is drawn but the first segment, which lies in vacuum.
#[test]
fn absorption_on_next_event_estimation_is_exact() {
    let bulb = point([1.6, 1.6, 0.0], rgb(3.0, 2.0, 1.0));
    let eye = [1.5, 0.3, 1.5];
    let image = |ball| {
        let corner = with(corner_with_ball(&bulb, eye, ball), &[("integrator", depth(2))]);
        Stage::new(&corner).with_everything().render(strategies("next-event"), 16, 7)
    };
    let (clear, veiled) = (image(None), image(Some(([1.6, 1.6, 0.0], 0.5))));
    assert!(clear.iter().filter(|v| v.min_element() > 0.0).count() > clear.len() / 2);
    assert_close("bulb in a ball", &veiled, |i| clear[i] * (-1f32).exp(), 1e-5);
}

/// An octahedron whose vertex normals make it a ball.
const GEM: &str = "\
v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1
vn 1 0 0\nvn -1 0 0\nvn 0 1 0\nvn 0 -1 0\nvn 0 0 1\nvn 0 0 -1
f 1//1 3//3 5//5\nf 3//3 2//2 5//5\nf 2//2 4//4 5//5\nf 4//4 1//1 5//5
f 3//3 1//1 6//6\nf 2//2 3//3 6//6\nf 4//4 2//2 6//6\nf 1//1 4//4 6//6
";

/// Shading normals make light subpaths differ from camera subpaths at surfaces, and only there.
#[test]
fn shading_normals_stop_at_the_surface() {
    let gem = json!({
        "type": "obj", "filename": "gem.obj", "to_world": place([0.5; 3], [-0.2, -0.2, -0.2]),
        "bsdf": diffuse(0.8),
    });
    for (name, sigma_t) in [("vacuum", 0.0), ("fog", 0.8)] {
        let parts = [
            in_the_room(),
            ("room", room(0.5, Some(medium(sigma_t, 0.9, 0.3)))),
            ("gem", gem.clone()),
            ("lamp", lamp_panel([0.0, 0.95, 0.0], 0.4, 3.0)),
            ("point", point([0.7, 0.2, 0.3], 0.3)),
        ];
        let stage = Stage::with_files(&scene(&parts), &[("gem.obj", GEM)]);
        methods_agree(&format!("smooth gem in {name}"), &stage, 192);
    }
}

#[test]
fn many_lights_are_the_sum_of_each() {
    let lights = [
        ("sun", sun([0.3, -1.0, -0.2], 0.4)),
        ("point", point([1.2, 0.8, 0.5], rgb(1.0, 0.5, 0.5))),
        ("weak", point([-0.2, 0.1, 0.3], 0.02)),
        ("spot", spot([-1.2, 1.4, 0.8], [0.0, 0.0, 0.0], rgb(2.0, 4.0, 2.0))),
        ("panel", lamp_panel([0.0, 1.2, 0.0], 0.4, rgb(1.0, 1.0, 2.0))),
        ("ball", lamp_ball([0.9, -0.3, 0.6], 0.15, 5.0)),
    ];
    let lit_by = |lights: &[(&'static str, Value)]| {
        let mut parts = vec![
            ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
            ("floor", floor(-0.6, 2.0, 0.5)),
            ("cloud", null_box([-0.8, -0.4, -0.8], [0.7, 0.8, 0.4], Some(medium(1.2, 0.9, 0.3)))),
        ];
        // The lamps' bodies stay when they do not shine.
        for (name, lamp) in lights.iter().cloned() {
            parts.push((name, lamp));
        }
        Stage::new(&scene(&parts))
    };
    let dark = |(name, light): &(&'static str, Value)| match *name {
        "panel" => (*name, lamp_panel([0.0, 1.2, 0.0], 0.4, 0.0)),
        "ball" => (*name, lamp_ball([0.9, -0.3, 0.6], 0.15, 0.0)),
        _ => (
            *name,
            with(light.clone(), &[(if *name == "sun" { "irradiance" } else { "intensity" }, json!(0.0))]),
        ),
    };
    let alone: Vec<Sample> = (0..lights.len())
        .map(|lit| {
            let only = |i: usize| if i == lit { lights[i].clone() } else { dark(&lights[i]) };
            let lights: Vec<_> = (0..lights.len()).map(only).collect();
            measure(&lit_by(&lights), Strategies::BDPT, 96, 100 * lit as u64)
        })
        .collect();
    let sum = alone.iter().skip(1).fold(alone[0].clone(), |sum, sample| sum.plus(sample));
    let all = lit_by(&lights);
    let mut claims = Claims::new();
    for (i, (name, set)) in METHODS.into_iter().enumerate() {
        let together = measure(&all, set, 256, 1000 * (i + 1) as u64);
        claims.equal(&format!("{name} of all lights against the sum of each alone"), &together, &sum);
    }
    claims.settle();
}

#[test]
fn no_light_arrives_from_infinity_through_fog_without_end() {
    for (name, fog) in [
        ("grey", medium(0.5, 0.9, 0.3)),
        ("thin", medium(1e-6, 1.0, 0.0)),
        ("chromatic", medium(rgb(0.1, 1.0, 5.0), 0.9, 0.3)),
    ] {
        let parts = [
            ("fog", fog),
            ("sensor", with(camera([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], 8), &[("medium", named("fog"))])),
            ("floor", floor(-0.7, 1.0, 0.5)),
            ("sky", sky(1.0)),
            ("sun", sun([0.3, -1.0, -0.2], 3.0)),
        ];
        for everything in [false, true] {
            let stage = Stage::new(&scene(&parts));
            let stage = if everything { stage.with_everything() } else { stage };
            for (method, set) in METHODS {
                // Few samples: light that came through would be in every one of them.
                let image = stage.render(set, 8, 1);
                assert!(image.iter().all(|v| *v == Spectrum::ZERO), "{name} fog, {method}: {image:?}");
            }
        }
    }
}

/// Fog that only dims red: light of the other colours arrives as through vacuum.
#[test]
fn fog_without_end_dims_only_the_colours_it_extinguishes() {
    let lit = |parts: &[(&str, Value)]| {
        let mut all =
            vec![("floor", floor(-0.7, 1.0, 0.5)), ("sky", sky(1.0)), ("sun", sun([0.3, -1.0, -0.2], 1.0))];
        all.extend(parts.iter().cloned());
        Stage::new(&scene(&all))
    };
    let view = camera([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], 8);
    let red = [
        ("fog", medium(rgb(0.5, 0.0, 0.0), 0.9, 0.3)),
        ("sensor", with(view.clone(), &[("medium", named("fog"))])),
    ];
    let (foggy, clear) = (lit(&red), lit(&[("sensor", view)]));
    let mut claims = Claims::new();
    for (i, (name, set)) in METHODS.into_iter().enumerate() {
        let without_red = |images: Vec<Vec<Spectrum>>| -> Vec<Vec<Spectrum>> {
            let keep =
                |image: Vec<Spectrum>| image.into_iter().map(|v| v * Spectrum::new(0.0, 1.0, 1.0)).collect();
            images.into_iter().map(keep).collect()
        };
        let images = foggy.renders(set, 128, 1000 * i as u64..1000 * i as u64 + SEEDS);
        assert!(images.iter().flatten().all(|v| v.x == 0.0 && v.is_finite()), "{name}: red has arrived");
        let clear = clear.renders(set, 128, 1000 * i as u64 + 500..1000 * i as u64 + 500 + SEEDS);
        claims.equal(name, &Sample::of(&without_red(images), 8), &Sample::of(&without_red(clear), 8));
    }
    claims.settle();
}

#[test]
fn the_media_of_camera_and_lamps_are_found() {
    let fogs = [
        ("fog", medium(1.0, 0.9, 0.3)),
        ("smoke", medium(rgb(3.0, 2.0, 1.0), 0.7, 0.0)),
        ("cloud", null_box([-0.9; 3], [0.9; 3], Some(named("fog")))),
        ("puff", with(null_ball([0.3, 0.2, -0.2], 0.4, named("smoke")), &[("exterior", named("fog"))])),
        ("floor", floor(-1.0, 2.0, 0.5)),
    ];
    let view = camera([0.0, 0.0, 0.8], [0.0, 0.0, -1.0], 8);
    let lamp = |medium: Option<&str>| match medium {
        Some(id) => with(point([0.3, 0.3, -0.2], 1.0), &[("medium", named(id))]),
        None => point([0.3, 0.3, -0.2], 1.0),
    };
    let image = |view: Value, lamp: Value, contradicts: bool| {
        let mut parts = fogs.to_vec();
        parts.extend([("sensor", view), ("lamp", lamp)]);
        let stage = Stage::new(&scene(&parts));
        let warned = stage.setup.warnings.iter().any(|w| w.contains("the image cannot be correct"));
        assert_eq!(warned, contradicts, "{:?}", stage.setup.warnings);
        stage.render(Strategies::BDPT, 16, 3)
    };
    let stated = image(with(view.clone(), &[("medium", named("fog"))]), lamp(Some("smoke")), false);
    assert_eq!(image(view.clone(), lamp(None), false), stated);
    // A wrong statement is believed, with a warning: the comparison can fail.
    assert_ne!(image(with(view.clone(), &[("medium", named("smoke"))]), lamp(None), true), stated);
    assert_ne!(image(view, lamp(Some("fog")), true), stated);
}

#[test]
fn contradicting_boundaries_are_told() {
    let half_open = json!({
        "type": "rectangle", "bsdf": {"type": "null"}, "interior": medium(1.0, 0.9, 0.0),
    });
    let facing_away = with(
        half_open.clone(),
        &[("to_world", place([1.0; 3], [0.0, 0.0, 1.0])), ("interior", medium(2.0, 0.9, 0.0))],
    );
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.5], [0.0, 0.0, 0.0], 8)),
        ("one", half_open),
        ("other", facing_away),
        ("lamp", point([0.2, 0.1, 0.6], 1.0)),
    ];
    let warnings = Stage::new(&scene(&parts)).setup.warnings;
    let reported = |of: &str| warnings.iter().any(|w| w.contains(of) && w.contains("different media"));
    assert!(reported("the camera") && reported("an emitter"), "{warnings:?}");
}

/// Where nothing is absorbed, everything has the radiance around it.
#[test]
fn a_white_cloud_is_invisible_under_a_white_sky() {
    let mut claims = Claims::new();
    for thickness in [0.01, 1.0, 10.0] {
        let parts = [
            ("sensor", camera([0.0, 0.0, 3.5], [0.0, 0.0, 0.0], 8)),
            ("cloud", null_box([-0.5, -1.0, -1.0], [0.5, 1.0, 1.0], Some(medium(thickness, 1.0, 0.6)))),
            ("sky", sky(1.0)),
        ];
        let stage = Stage::new(&scene(&parts));
        assert_close("eye walks alone", &stage.render(strategies("hit"), 8, 1), |_| Spectrum::ONE, 1e-5);
        for (name, set) in METHODS {
            let images = stage.renders(set, 32, 0..16);
            claims.every_pixel(&format!("{name}, optical thickness {thickness}"), &images, 1.0);
            claims.equal_to(&format!("{name}, optical thickness {thickness}"), &Sample::of(&images, 8), 1.0);
        }
    }
    claims.settle();
}

/// The sun shines straight down through a slab on a floor that the camera sees from below the slab: nothing is
/// drawn at random, each pixel is exact.
#[test]
fn transmittance_through_a_slab_is_exact() {
    let slab = null_box([-9.0, 0.5, -9.0], [9.0, 1.25, 9.0], Some(medium(rgb(0.1, 1.0, 8.0), 0.0, 0.0)));
    let parts = [
        ("integrator", depth(2)),
        ("sensor", camera([0.0, 0.0, 2.0], [0.0, -1.0, 1.5], 8)),
        ("floor", floor(-1.0, 9.0, 0.5)),
        ("slab", slab),
        ("sun", sun([0.0, -1.0, 0.0], 2.0)),
    ];
    let image = render_once(&parts, "next-event");
    let expected =
        Spectrum::from_array([0.1f32, 1.0, 8.0].map(|s| std::f32::consts::FRAC_1_PI * (-s * 0.75).exp()));
    for (pixel, v) in image.iter().enumerate() {
        let error = ((*v - expected) / expected).abs().max_element();
        assert!(error < 1e-5, "pixel {pixel}: {v} against {expected}");
    }
}

fn render_once(parts: &[(&str, Value)], set: &str) -> Vec<Spectrum> {
    common::render(&scene(parts), strategies(set), 8, 1)
}

/// A lamp seen straight through a slab, by walks that meet it and by light subpaths.
#[test]
fn a_lamp_behind_a_slab_is_dimmed_exactly() {
    let facing_camera = json!({
        "type": "rectangle", "to_world": place([9.0; 3], [0.0, 0.0, -1.0]),
        "emitter": {"type": "area", "radiance": 2.0},
    });
    let parts = [
        // So narrow a view that all rays are as good as straight.
        ("sensor", with(camera([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], 8), &[("fov", json!(0.1))])),
        ("slab", null_box([-9.0, -9.0, -0.25], [9.0, 9.0, 0.5], Some(medium(1.0, 0.0, 0.0)))),
        ("lamp", facing_camera),
    ];
    let stage = Stage::new(&scene(&parts));
    let mut claims = Claims::new();
    for set in ["hit", "hit+lens", "hit+next-event", "hit+next-event+join+lens"] {
        let sample = measure(&stage, strategies(set), 512, 0);
        claims.equal_to(set, &sample, 2.0 * (-0.75f64).exp());
    }
    claims.settle();
}

/// Boxes that touch have two faces in one place.
#[test]
fn touching_boxes_leave_no_gap_and_no_overlap() {
    let halves = |low: Value, high: Value| {
        [
            ("left", null_box([-0.8, -0.5, -0.5], [0.1, 0.5, 0.5], Some(low))),
            ("right", null_box([0.1, -0.5, -0.5], [0.8, 0.5, 0.5], Some(high))),
        ]
    };
    let whole = null_box([-0.8, -0.5, -0.5], [0.8, 0.5, 0.5], Some(named("fog")));
    let around = [
        ("sensor", camera([1.5, 0.4, 2.5], [0.0, 0.0, 0.0], 8)),
        ("fog", medium(2.0, 0.9, 0.5)),
        ("floor", floor(-0.8, 2.0, 0.5)),
        ("lamp", lamp_panel([0.8, 1.0, 0.3], 0.4, 3.0)),
        ("point", point([-1.2, 0.2, 0.1], 1.0)),
    ];
    let parts = |more: &[(&'static str, Value)]| scene(&[&around[..], more].concat());
    same_image(
        "two halves against the whole",
        &parts(&halves(named("fog"), named("fog"))),
        &parts(&[("whole", whole)]),
        128,
    );
}

/// From within a box, a face that it shares with another says only that one is outside of the other: to take that for
/// vacuum lost the fog on the way to a lamp beyond both.
#[test]
fn an_empty_neighbour_takes_no_fog_away() {
    let fog = null_box([0.0, -0.5, -0.5], [0.9, 0.5, 0.5], Some(medium(2.0, 0.5, 0.0)));
    let empty = null_box([-0.9, -0.5, -0.5], [0.0, 0.5, 0.5], Some(medium(0.0, 0.0, 0.0)));
    let parts = [
        ("sensor", camera([0.0, 0.7, 2.5], [0.0, -0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("lamp", lamp_panel([-1.2, 1.2, 0.6], 0.5, 4.0)),
        ("fog", fog),
    ];
    let both = scene(&[&parts[..], &[("empty", empty)]].concat());
    same_image("with an empty neighbour", &both, &scene(&parts), 256);
}

#[test]
fn touching_slabs_dim_exactly() {
    for order in [[0, 1], [1, 0]] {
        let slabs = [
            ("upper", null_box([-9.0, 0.3, -9.0], [9.0, 0.9, 9.0], Some(medium(1.0, 0.0, 0.0)))),
            ("lower", null_box([-9.0, -0.2, -9.0], [9.0, 0.3, 9.0], Some(medium(3.0, 0.0, 0.0)))),
        ];
        let parts = [
            ("integrator", depth(2)),
            ("sensor", camera([0.0, -0.4, 2.0], [0.0, -1.0, 1.5], 8)),
            ("floor", floor(-1.0, 9.0, 0.5)),
            slabs[order[0]].clone(),
            slabs[order[1]].clone(),
            ("sun", sun([0.0, -1.0, 0.0], 2.0)),
        ];
        let expected = Spectrum::splat(std::f32::consts::FRAC_1_PI * (-0.6f32 - 1.5).exp());
        assert_close("two slabs", &render_once(&parts, "next-event"), |_| expected, 1e-5);
    }
}

/// A scene of every kind of thing, moved by `shift` and scaled by `scale`, its light multiplied by `light`.
fn assorted(shift: [f64; 3], scale: f64, light: f64) -> Value {
    let at = |p: [f64; 3]| -> [f64; 3] { std::array::from_fn(|i| scale * p[i] + shift[i]) };
    let flat = json!([
        {"type": "scale", "value": 2.0 * scale}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90},
        {"type": "translate", "value": at([0.0, -0.6, 0.0])},
    ]);
    let view = camera(at([0.0, 0.6, 3.2]), at([0.0, 0.2, 0.0]), 8);
    let clips = [("near_clip", json!(1e-3 * scale)), ("far_clip", json!(1e3 * scale))];
    let glass = json!({
        "type": "sphere", "center": at([-0.4, 0.0, 0.9]), "radius": 0.3 * scale, "bsdf": {"type": "dielectric"},
    });
    let panel = json!([
        {"type": "scale", "value": 0.5 * scale}, {"type": "rotate", "axis": [1, 0, 0], "angle": 90},
        {"type": "translate", "value": at([0.0, 1.2, 0.0])},
    ]);
    scene(&[
        ("sensor", with(view, &clips)),
        ("floor", json!({"type": "rectangle", "to_world": flat, "bsdf": diffuse(0.5)})),
        ("cloud", null_box(at([-0.8, -0.4, -0.8]), at([0.7, 0.8, 0.4]), Some(medium(1.2 / scale, 0.9, 0.3)))),
        ("glass", glass),
        ("sky", sky(0.3 * light)),
        ("sun", sun([0.3, -1.0, -0.2], 0.4 * light)),
        ("point", point(at([1.2, 0.8, 0.5]), 0.7 * light * scale * scale)),
        (
            "lamp",
            json!({"type": "rectangle", "to_world": panel, "emitter": {"type": "area", "radiance": 2.0 * light}}),
        ),
    ])
}

/// Both scenes use the same random numbers, so that little but rounding tells their images apart.
fn same_but_for(what: &str, changed: &Value, factor: f64) {
    let (plain, changed) = (Stage::new(&assorted([0.0; 3], 1.0, 1.0)), Stage::new(changed));
    let mut claims = Claims::new();
    for (name, set) in METHODS {
        let plain = measure(&plain, set, 64, 0);
        claims.equal_in_pairs(
            &format!("{what}, {name}"),
            &measure(&changed, set, 64, 0).scaled(1.0 / factor),
            &plain,
        );
    }
    claims.settle();
}

#[test]
fn far_from_the_origin_is_as_good_as_near() {
    same_but_for("1e5 away", &assorted([1e5, -1e5, 1e5], 1.0, 1.0), 1.0);
}

#[test]
fn units_do_not_matter() {
    // Mitsuba goes wrong from 1e-4 m on down; beyond 1e-10 and 1e10 m densities per volume leave single precision.
    for scale in [1e-10, 1e-4, 1e-1, 1e4, 1e10] {
        same_but_for(&format!("scale {scale}"), &assorted([0.0; 3], scale, 1.0), 1.0);
    }
}

#[test]
fn brightness_does_not_matter() {
    for light in [1e-20, 1e20] {
        same_but_for(&format!("light {light}"), &assorted([0.0; 3], 1.0, light), light);
    }
}

/// A lamp exactly at the camera's height once shadowed its own points: rounding there is relative to nothing.
#[test]
fn a_lamp_does_not_stand_in_its_own_light() {
    for (name, fog) in [("vacuum", None), ("fog", Some(medium(0.5, 0.9, 0.0)))] {
        let parts = [
            ("sensor", camera([0.0, 0.4, 0.9], [0.0, -0.6, -1.0], 8)),
            ("room", room(0.5, fog)),
            ("lamp", lamp_panel([0.0, 0.4, -0.3], 0.4, 3.0)),
        ];
        methods_agree(&format!("lamp at eye level in {name}"), &Stage::new(&scene(&parts)), 128);
    }
    let parts = [
        in_the_room(),
        ("room", room(0.5, None)),
        ("ball", null_ball([0.0, -0.1, -0.3], 0.6, medium(1.0, 0.9, 0.0))),
        ("lamp", lamp_panel([0.0, 0.95, 0.0], 0.5, 3.0)),
    ];
    methods_agree("lamp seen across a sphere", &Stage::new(&scene(&parts)), 128);
}
