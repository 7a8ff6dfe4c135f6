//! Faces in one place: the picture is that of a small gap between them in the order that common sense gives, whatever the
//! order of shapes in the file and however the scene is turned.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::{
    sampling::{Stream, stream::Purpose},
    shape::Ray,
    transport::Strategies,
};

const METHODS: [(&str, Strategies); 3] =
    [("pt", Strategies::PT), ("lt", Strategies::LT), ("bdpt", Strategies::BDPT)];
const ANGLES: [f64; 3] = [0.0, 10.0, 33.0];
/// Of the scenes that faces in one place are compared with (m).
const GAP: f64 = 1e-4;

/// Every part with a place turned about an axis through the origin.
fn turned(scene: &Value, degrees: f64) -> Value {
    let Value::Object(mut parts) = scene.clone() else { panic!("no scene") };
    let turn = json!({"type": "rotate", "axis": [0.3, 0.5, 1.0], "angle": degrees});
    for part in parts.values_mut().filter_map(Value::as_object_mut) {
        let is_placed =
            ["cube", "rectangle", "sphere", "disk", "cylinder", "obj", "perspective", "orthographic"]
                .contains(&part["type"].as_str().unwrap_or_default());
        if is_placed && degrees != 0.0 {
            let mut steps = part.get("to_world").and_then(Value::as_array).cloned().unwrap_or_default();
            steps.push(turn.clone());
            part.insert("to_world".to_owned(), steps.into());
        }
    }
    Value::Object(parts)
}

/// The same parts with two of them in the other order.
fn swapped(scene: &Value, a: &str, b: &str) -> Value {
    let Value::Object(parts) = scene else { panic!("no scene") };
    let swap = |name: &String| {
        if name == a {
            b.to_owned()
        } else if name == b {
            a.to_owned()
        } else {
            name.clone()
        }
    };
    Value::Object(parts.keys().map(|name| (swap(name), parts[&swap(name)].clone())).collect())
}

fn sample(stage: &Stage, set: Strategies, samples_per_pixel: u64, first: u64) -> Sample {
    Sample::of(&stage.renders(set, samples_per_pixel, first..first + 6), stage.width())
}

/// A camera of parallel rays that looks down the z axis.
fn looking_down(half: f64, from: f64) -> Value {
    let [x, y] = [0.3 * half, 0.2 * half];
    json!({
        "type": "orthographic", "near_clip": 1e-3 * from, "far_clip": 1e3 * from,
        "to_world": [{"type": "scale", "value": [half, half, 1.0]},
            {"type": "lookat", "origin": [x, y, from], "target": [x, y, 0.0], "up": [0, 1, 0]}],
        "film": {"type": "hdrfilm", "width": 2, "height": 2, "rfilter": {"type": "box"}},
    })
}

fn slab(low: f64, high: f64, bsdf: Value, sigma_t: f64) -> Value {
    let place = place([20.0, 20.0, 0.5 * (high - low)], [0.0, 0.0, 0.5 * (high + low)]);
    json!({"type": "cube", "to_world": place, "bsdf": bsdf, "interior": medium(sigma_t, 0.0, 0.0)})
}

fn square(half: f64, z: f64, more: &[(&str, Value)]) -> Value {
    with(json!({"type": "rectangle", "to_world": place([half, half, 1.0], [0.0, 0.0, z])}), more)
}

fn glass(index: f64) -> Value {
    json!({"type": "dielectric", "int_ior": index, "ext_ior": 1.0})
}

/// What is seen of a sky of radiance 1 by way of a stack of plane-parallel interfaces and absorbers at normal incidence: the
/// part that comes through, and what is reflected. Layers are added one by one by the series of what goes back and forth
/// between them.
fn stack(layers: &[(f64, f64)]) -> f64 {
    // (transmittance, reflectance from above, from below) of all so far, which start as nothing at all.
    let mut all = (1.0, 0.0, 0.0);
    for &(t, r) in layers {
        let bounce = 1.0 / (1.0 - all.2 * r);
        all = (all.0 * t * bounce, all.1 + all.0 * all.0 * r * bounce, r + t * t * all.2 * bounce);
    }
    all.0 + all.1
}

fn interface(index: f64) -> (f64, f64) {
    let r = ((index - 1.0) / (index + 1.0)).powi(2);
    (1.0 - r, r)
}

fn absorber(depth: f64) -> (f64, f64) {
    ((-depth).exp(), 0.0)
}

/// Scenes that have a closed form: name, the two shapes that touch, everything else, radiance.
fn closed_forms() -> Vec<(&'static str, Value, f64)> {
    let null = || json!({"type": "null"});
    let glow = || ("emitter", json!({"type": "area", "radiance": 1.0}));
    let fog = |low: f64, high: f64| {
        with(
            slab(low, high, null(), 0.5),
            &[("to_world", place([1.0, 1.0, 0.5 * (high - low)], [0.0, 0.0, 0.5 * (high + low)]))],
        )
    };
    let two = |a: Value, b: Value| {
        scene(&[("sensor", looking_down(0.3, 9.0)), ("a", a), ("b", b), ("sky", sky(1.0))])
    };
    let lit = |a: Value, b: Value| scene(&[("sensor", looking_down(0.3, 5.0)), ("a", a), ("b", b)]);
    let thin = {
        let (_, r) = interface(1.5);
        let r = 2.0 * r / (1.0 + r);
        (1.0 - r, r)
    };
    vec![
        ("a floor under fog", lit(fog(0.0, 2.0), square(3.0, 0.0, &[glow()])), (-1.0f64).exp()),
        ("a floor a micron lower", lit(fog(0.0, 2.0), square(3.0, -1e-6, &[glow()])), (-1.0f64).exp()),
        (
            "a disk under fog",
            lit(fog(0.0, 2.0), json!({"type": "disk", "emitter": glow().1})),
            (-1.0f64).exp(),
        ),
        ("fog on fog", two(slab(0.0, 1.0, null(), 1.0), slab(1.0, 2.0, null(), 0.5)), (-1.5f64).exp()),
        (
            "fog on glass",
            two(slab(1.0, 2.0, null(), 0.5), slab(0.0, 1.0, glass(1.5), 1.0)),
            stack(&[absorber(0.5), interface(1.5), absorber(1.0), interface(1.5)]),
        ),
        (
            "glass on water",
            two(slab(0.0, 1.0, glass(1.33), 1.0), slab(1.0, 2.0, glass(1.5), 0.0)),
            stack(&[interface(1.5), interface(1.5), interface(1.33), absorber(1.0), interface(1.33)]),
        ),
        (
            "a pane on fog",
            two(
                slab(0.0, 1.0, null(), 1.0),
                square(
                    20.0,
                    1.0,
                    &[("bsdf", json!({"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1.0}))],
                ),
            ),
            stack(&[thin, absorber(1.0)]),
        ),
    ]
}

#[test]
fn layers_that_touch_have_their_closed_forms() {
    let mut claims = Claims::new();
    for (name, scene, expected) in closed_forms() {
        for scene in [scene.clone(), swapped(&scene, "a", "b")] {
            for degrees in ANGLES {
                let stage = Stage::new(&turned(&scene, degrees));
                assert!(!stage.setup.apart.contacts.is_empty(), "{name}: nothing touches");
                claims.equal_to(
                    &format!("{name}, {degrees}"),
                    &sample(&stage, Strategies::PT, 512, 0),
                    expected,
                );
            }
        }
    }
    claims.settle();
}

/// The same at other scales: one thing, a thousandth as large and ten thousand times.
#[test]
fn faces_touch_at_every_scale() {
    let mut claims = Claims::new();
    for scale in [1e-3, 1.0, 1e4] {
        let fog = json!({"type": "cube", "to_world": place([scale; 3], [0.0, 0.0, scale]), "bsdf": {"type": "null"},
            "interior": medium(0.5 / scale, 0.0, 0.0)});
        let floor = square(3.0 * scale, 0.0, &[("emitter", json!({"type": "area", "radiance": 1.0}))]);
        let camera = looking_down(0.3 * scale, 5.0 * scale);
        for degrees in ANGLES {
            let scene = scene(&[("sensor", camera.clone()), ("fog", fog.clone()), ("floor", floor.clone())]);
            let stage = Stage::new(&turned(&scene, degrees));
            let found = sample(&stage, Strategies::PT, 512, 0);
            claims.equal_to(&format!("{scale}, {degrees}"), &found, (-1.0f64).exp());
        }
    }
    claims.settle();
}

const BOX: &str = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n\
    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 4 8 7 3\nf 2 3 7 6\nf 1 5 8 4\n";

/// A thing with this `bsdf` whose top is the plane y = 0.
fn support(shape: &str, bsdf: &Value) -> Value {
    let below = place([1.5, 0.25, 1.5], [0.0, -0.25, 0.0]);
    let thing = match shape {
        "rectangle" => floor(0.0, 1.5, 0.5),
        "mesh" => json!({"type": "obj", "filename": "box.obj", "face_normals": true, "to_world": below}),
        _ => json!({"type": "cube", "to_world": below}),
    };
    with(thing, &[("bsdf", bsdf.clone())])
}

/// What stands on it, `gap` above.
fn body(bsdf: Value, gap: f64) -> Value {
    let place = place([0.6, 0.5, 0.6], [0.0, 0.5 + gap, 0.0]);
    json!({"type": "cube", "to_world": place, "bsdf": bsdf, "interior": medium(1.0, 0.8, 0.3)})
}

fn bsdfs() -> Vec<(&'static str, Value)> {
    let matt = diffuse(0.6);
    vec![
        ("diffuse", matt.clone()),
        ("twosided", json!({"type": "twosided", "bsdf": matt})),
        ("conductor", json!({"type": "conductor", "material": "Al"})),
        ("roughconductor", json!({"type": "roughconductor", "material": "Al", "alpha": 0.3})),
        ("plastic", json!({"type": "plastic"})),
        ("roughplastic", json!({"type": "roughplastic", "alpha": 0.2})),
        ("dielectric", glass(1.5)),
        ("roughdielectric", json!({"type": "roughdielectric", "alpha": 0.2})),
        ("thindielectric", json!({"type": "thindielectric"})),
        ("difftrans", json!({"type": "difftrans", "transmittance": 0.4})),
        ("mask", json!({"type": "mask", "opacity": 0.5, "bsdf": matt})),
        ("null", json!({"type": "null"})),
    ]
}

/// Fog, and glass with fog in it, on things of every surface and shape.
#[test]
fn what_stands_on_a_thing_looks_as_a_hair_above_it() {
    let mut claims = Claims::new();
    for (name, bsdf) in bsdfs() {
        for (what, on_top) in [("fog", json!({"type": "null"})), ("glass", glass(1.3))] {
            for (shape, degrees) in ["rectangle", "cube", "mesh"].into_iter().zip(ANGLES) {
                let with_gap = |gap: f64| {
                    let scene = scene(&[
                        ("sensor", camera([0.3, 1.2, 4.0], [0.0, 0.3, 0.0], 6)),
                        ("a", support(shape, &bsdf)),
                        ("b", body(on_top.clone(), gap)),
                        ("sky", sky(1.0)),
                        ("depth", depth(8)),
                    ]);
                    turned(&scene, degrees)
                };
                let render = |scene: &Value, seed| {
                    sample(&Stage::with_files(scene, &[("box.obj", BOX)]), Strategies::PT, 24, seed)
                };
                let expected = render(&with_gap(GAP), 0);
                for (seed, scene) in [(100, with_gap(0.0)), (200, swapped(&with_gap(0.0), "a", "b"))] {
                    claims.equal(&format!("{what} on a {name} {shape}"), &render(&scene, seed), &expected);
                }
            }
        }
    }
    claims.settle();
}

/// A ball of fog in a ball of the same size, as it should be: a hair smaller, or larger than an opaque one.
#[test]
fn balls_of_one_size_are_one_in_the_other() {
    let mut claims = Claims::new();
    for (name, bsdf) in bsdfs().into_iter().filter(|(name, _)| *name != "null") {
        let with_radius = |radius: f64| {
            scene(&[
                ("sensor", camera([0.3, 1.2, 4.0], [0.0, 0.0, 0.0], 6)),
                ("a", with(null_ball([0.0; 3], 1.0, medium(0.0, 0.0, 0.0)), &[("bsdf", bsdf.clone())])),
                ("b", null_ball([0.0; 3], radius, medium(1.0, 0.8, 0.3))),
                ("sky", sky(1.0)),
                ("depth", depth(8)),
            ])
        };
        let render = |scene: &Value, seed| sample(&Stage::new(scene), Strategies::PT, 24, seed);
        let expected = render(&with_radius(1.0 - GAP), 0);
        for (seed, scene) in [(100, with_radius(1.0)), (200, swapped(&with_radius(1.0), "a", "b"))] {
            claims.equal(name, &render(&scene, seed), &expected);
        }
    }
    claims.settle();
}

/// Cells of a lattice, each of fog, of other fog, matt, of glass if `glassy`, or empty; all smaller by `gap` on each side.
fn lattice(stream: &mut Stream, glassy: bool, degrees: f64) -> [Value; 2] {
    let mut parts = vec![
        ("sensor".to_owned(), camera([0.4, 0.7, 7.0], [0.0, 0.0, 0.0], 4)),
        ("lamp".to_owned(), lamp_ball([1.5, 3.5, 2.5], 0.7, 10.0)),
        ("depth".to_owned(), depth(6)),
    ];
    if glassy {
        parts.push(("sky".to_owned(), sky(0.5)));
    }
    let mut shrunk = parts.clone();
    for cell in 0..27 {
        let at = [cell % 3, cell / 3 % 3, cell / 9].map(|i| f64::from(i) - 1.0);
        let (bsdf, sigma_t) = match stream.below(20) {
            0..=3 => (json!({"type": "null"}), 0.5),
            4..=6 => (json!({"type": "null"}), 1.5),
            7 => (diffuse(0.6), 0.0),
            8 if glassy => (glass(1.4), 0.3),
            _ => continue,
        };
        for (parts, half) in [(&mut parts, 0.5), (&mut shrunk, 0.5 - GAP)] {
            let mut thing = json!({"type": "cube", "to_world": place([half; 3], at), "bsdf": bsdf});
            if sigma_t > 0.0 {
                thing = with(thing, &[("interior", medium(sigma_t, 0.8, 0.2))]);
            }
            parts.push((format!("cell{cell}"), thing));
        }
    }
    [parts, shrunk].map(|parts| {
        let named: Vec<(&str, Value)> =
            parts.iter().map(|(name, part)| (name.as_str(), part.clone())).collect();
        turned(&scene(&named), degrees)
    })
}

/// Faces, edges and corners of cells that touch, against the same cells a hair smaller.
#[test]
fn two_hundred_arrangements_of_cells_look_as_a_hair_apart() {
    let mut claims = Claims::new();
    for index in 0..200 {
        let mut stream = Stream::new(42, index, 0, Purpose::Study);
        let glassy = index % 2 == 1;
        let [touching, apart] = lattice(&mut stream, glassy, ANGLES[index as usize % 3]);
        let [touching, apart] = [touching, apart].map(|scene| Stage::new(&scene));
        assert!(touching.setup.warnings.is_empty(), "{index}: {:?}", touching.setup.warnings);
        // Light subpaths do not find what is seen through smooth glass alone.
        for (name, set) in METHODS.into_iter().filter(|(name, _)| !glassy || *name != "lt") {
            let [found, expected] =
                [(&touching, 0), (&apart, 100)].map(|(stage, first)| sample(stage, set, 16, first));
            claims.equal(&format!("arrangement {index}: {name}"), &found, &expected);
        }
    }
    claims.settle();
}

/// Rays from all around, some from three times as far away as the camera, meet two boxes that touch one after the other.
#[test]
fn rays_meet_faces_in_order() {
    let inner =
        json!({"type": "cube", "bsdf": {"type": "null"}, "to_world": place([1.0; 3], [0.0, 1.0, 0.0])});
    let outer = json!({"type": "cube", "bsdf": {"type": "null"}, "to_world": place([1.5, 1.0, 1.5], [0.0, -1.0, 0.0])});
    for degrees in ANGLES {
        let view = camera([3.0, 1.0, 4.0], [0.0; 3], 4);
        let parts = [("sensor", view), ("upper", inner.clone()), ("lower", outer.clone()), ("sky", sky(1.0))];
        let setup = Stage::new(&turned(&scene(&parts), degrees)).setup;
        let geometry = &setup.scene.geometry;
        let mut wrong = 0;
        for index in 0..200_000 {
            let mut stream = Stream::new(3, index, 0, Purpose::Study);
            let [from, to] = [0, 1].map(|shape| geometry.sample_area(shape, &mut stream).position);
            let direction = (to - from).normalize();
            let origin = from - direction * (15.0 * stream.uniform());
            let met = geometry.march(Ray { origin, direction, t_max: f32::INFINITY });
            let met: Vec<u32> = met.map(|point| point.shape).collect();
            let ends: Vec<u32> = met.iter().rev().take(4).rev().copied().collect();
            // In and out of the upper box, in and out of the lower one; in its own middle where the ray starts within.
            wrong += u32::from(!ends.ends_with(&[1, 1]) || ends.len() == 4 && ends[..2] != [0, 0]);
        }
        assert!(wrong <= 2, "{degrees}: {wrong} rays of 200,000");
    }
}

/// A plate between a floor and a lamp, a null face in its plane before it in the file, and the camera at that height: shadow rays
/// passed the plate, as faces were set apart by what is near the camera's height, which is nothing.
#[test]
fn a_plate_at_the_height_of_the_camera_casts_its_shadow() {
    let with_pane = |pane: f64| {
        scene(&[
            ("sensor", camera([0.0, 1.2, 3.0], [0.0, 0.4, 0.0], 6)),
            ("floor", floor(0.0, 3.0, 0.6)),
            ("pane", with(floor(pane, 0.8, 0.5), &[("bsdf", json!({"type": "null"}))])),
            ("plate", floor(1.2, 0.6, 0.5)),
            ("lamp", point([0.2, 2.5, 0.1], 5.0)),
        ])
    };
    let mut claims = Claims::new();
    let [found, expected] = [(1.2, 0), (1.2 + GAP, 100)]
        .map(|(pane, first)| sample(&Stage::new(&with_pane(pane)), Strategies::PT, 64, first));
    claims.equal("a plate", &found, &expected);
    claims.settle();
}

/// Ends of connections to a panel may lie on the fog's face before it, to the last digit: such segments crossed it to and fro
/// without end.
#[test]
fn connections_to_a_panel_behind_a_face_come_to_an_end() {
    let stage = Stage::new(&scene(&[
        ("sensor", camera([0.3, 1.1, 1.2], [-0.3, 0.9, -1.0], 6)),
        ("floor", floor(0.0, 1.5, 0.6)),
        ("ceiling", with(lamp_panel([0.0, 2.0, 0.0], 1.5, 0.0), &[("bsdf", diffuse(0.7))])),
        ("panel", lamp_panel([0.0, 2.0, 0.0], 0.3, 6.0)),
        ("fog", null_box([-1.5, 0.0, -1.5], [1.5, 2.0, 1.5], Some(medium(0.25, 0.9, 0.0)))),
        ("depth", depth(12)),
    ]));
    let mut claims = Claims::new();
    let [pt, bdpt] =
        [(Strategies::PT, 0), (Strategies::BDPT, 100)].map(|(set, first)| sample(&stage, set, 1024, first));
    claims.equal("bdpt", &bdpt, &pt);
    claims.settle();
}
