//! Media whose boundaries overlap: their coefficients add, whichever boundary a ray crosses first.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::transport::Strategies;

const METHODS: [(&str, Strategies); 3] =
    [("pt", Strategies::PT), ("lt", Strategies::LT), ("bdpt", Strategies::BDPT)];

/// Lamps of two kinds, one of them among the media, and a floor; seen from outside of the media.
fn around(media: &[(&str, Value)]) -> Value {
    let mut parts = vec![
        ("sensor", camera([0.3, 0.5, 5.0], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-1.5, 4.0, 0.5)),
        ("lamp", lamp_ball([0.5, 2.5, 1.0], 0.5, 20.0)),
        ("ember", lamp_ball([0.0, 0.2, 0.1], 0.2, 6.0)),
        ("depth", depth(5)),
    ];
    parts.extend_from_slice(media);
    scene(&parts)
}

/// Every method shows of one scene what `bdpt` shows of another, which says the same without boundaries that overlap.
fn same(claims: &mut Claims, what: &str, overlapping: &Value, apart: &Value) {
    let (overlapping, apart) = (Stage::new(overlapping), Stage::new(apart));
    assert!(overlapping.setup.scene.media_map.overlaps.is_some(), "{what}: nothing overlaps");
    assert!(apart.setup.scene.media_map.overlaps.is_none(), "{what}: the other overlaps too");
    assert!(apart.setup.warnings.is_empty(), "{what}: {:?}", apart.setup.warnings);
    let warnings = &overlapping.setup.warnings;
    assert!(warnings.iter().all(|warning| warning.contains("flat lids")), "{what}: {warnings:?}");
    let sample =
        |stage: &Stage, set, first| Sample::of(&stage.renders(set, 64, first..first + 8), stage.width());
    let expected = sample(&apart, Strategies::BDPT, 0);
    for (first, (name, set)) in (1..).zip(METHODS) {
        claims.equal(&format!("{what}: {name}"), &sample(&overlapping, set, 100 * first), &expected);
    }
}

fn red(id: &str) -> Value {
    json!({"type": "homogeneous", "id": id, "sigma_t": 0.8, "albedo": rgb(0.9, 0.4, 0.2),
        "phase": {"type": "hg", "g": 0.6}})
}

/// Of half the albedo in every channel: a phase function that is the same in all of them says what both do together.
fn pale(id: &str) -> Value {
    json!({"type": "homogeneous", "id": id, "sigma_t": 0.5, "albedo": rgb(0.45, 0.2, 0.1)})
}

const LEFT: [[f64; 3]; 2] = [[-1.6, -1.0, -1.0], [0.4, 1.0, 1.0]];
const RIGHT: [[f64; 3]; 2] = [[-0.4, -1.0, -1.0], [1.6, 1.0, 1.0]];

fn in_box([low, high]: [[f64; 3]; 2], interior: Value) -> Value {
    null_box(low, high, Some(interior))
}

#[test]
fn media_that_overlap_add_up() {
    let phases = json!({"type": "blendphase", "weight": 0.25 / 1.05, "a": {"type": "hg", "g": 0.6},
        "b": {"type": "isotropic"}});
    let [r, g, b] = [0.9, 0.4, 0.2].map(|albedo: f64| (0.8 * albedo + 0.25 * albedo) / 1.3);
    let both = json!({"type": "homogeneous", "sigma_t": 1.3, "albedo": rgb(r, g, b), "phase": phases});
    let overlapping = around(&[("first", in_box(LEFT, red("a"))), ("second", in_box(RIGHT, pale("b")))]);
    let apart = around(&[
        ("first", in_box([LEFT[0], [RIGHT[0][0], 1.0, 1.0]], red("a"))),
        ("middle", in_box([RIGHT[0], LEFT[1]], both)),
        ("second", in_box([[LEFT[1][0], -1.0, -1.0], RIGHT[1]], pale("b"))),
    ]);
    let mut claims = Claims::new();
    same(&mut claims, "red and pale", &overlapping, &apart);
    claims.settle();
}

/// Where fog holds smoke that does not state it as its exterior, both are there: chromatic ones by every tracker.
#[test]
fn smoke_in_fog_adds_to_it() {
    let wave = json!({"type": "cosine", "constant": 0.6, "w": {"type": "wave", "vector": [1.0, 2.0, 0.5], "amplitude": 0.5}});
    let even = |value: f64| json!({"type": "constvolume", "value": value});
    let smoke = |sigma_t: Value, tracker: &str| json!({"type": "heterogeneous", "sigma_t": sigma_t, "albedo": even(0.7), "tracker": tracker});
    let fog = || json!({"type": "homogeneous", "id": "fog", "sigma_t": 0.4, "albedo": 0.7});
    let inner = [[-1.3, -0.7, -0.6], [0.2, 0.8, 0.9]];
    let apart = around(&[
        ("outer", in_box(LEFT, fog())),
        (
            "inner",
            with(
                in_box(inner, smoke(json!({"type": "sum", "a": wave, "b": even(0.4)}), "closed_form")),
                &[("exterior", named("fog"))],
            ),
        ),
    ]);
    let mut claims = Claims::new();
    for tracker in ["closed_form", "residual_ratio"] {
        let inner = in_box(inner, smoke(wave.clone(), tracker));
        same(&mut claims, tracker, &around(&[("outer", in_box(LEFT, fog())), ("inner", inner)]), &apart);
    }
    claims.settle();
}

/// Particles of two kinds, whose shares vary: by the phase function, and as two media in one place.
#[test]
fn a_blend_that_varies_is_two_media_that_overlap() {
    let wave = |constant: f64, amplitude: f64| {
        json!({"type": "cosine", "constant": constant,
        "w": {"type": "wave", "vector": [3.0, 1.0, 0.5], "amplitude": amplitude}})
    };
    let hg = |g: f64| json!({"type": "hg", "g": g});
    let part = |id: &str, amplitude: f64, g: f64| json!({"type": "heterogeneous", "id": id, "sigma_t": wave(0.6, amplitude), "albedo": 0.8, "phase": hg(g)});
    let overlapping = around(&[
        ("first", in_box(LEFT, part("forward", -0.6, 0.8))),
        ("second", in_box(LEFT, part("back", 0.6, -0.8))),
    ]);
    let phase = json!({"type": "blendphase", "weight": wave(0.5, 0.5), "a": hg(0.8), "b": hg(-0.8)});
    let blend = with(medium(1.2, 0.8, 0.0), &[("phase", phase)]);
    let mut claims = Claims::new();
    same(&mut claims, "blend", &overlapping, &around(&[("first", in_box(LEFT, blend))]));
    claims.settle();
}

/// Each medium glows for itself.
#[test]
fn media_that_overlap_both_glow() {
    let glow = |id: &str, sigma_t: f64, emission: Value| json!({"type": "homogeneous", "id": id, "sigma_t": sigma_t, "albedo": 0.5, "emission": emission});
    let a = || glow("a", 0.4, rgb(0.4, 0.1, 0.0));
    let b = || glow("b", 0.6, rgb(0.0, 0.2, 0.3));
    let overlapping = [("first", in_box(LEFT, a())), ("second", in_box(RIGHT, b()))];
    let apart = [
        ("first", in_box([LEFT[0], [RIGHT[0][0], 1.0, 1.0]], a())),
        ("middle", in_box([RIGHT[0], LEFT[1]], glow("both", 1.0, rgb(0.4, 0.3, 0.3)))),
        ("second", in_box([[LEFT[1][0], -1.0, -1.0], RIGHT[1]], b())),
    ];
    let walls = json!({"type": "cube", "flip_normals": true, "to_world": place([6.0, 6.0, 6.0], [0.0; 3]), "bsdf": diffuse(0.4)});
    let mut claims = Claims::new();
    // Without other light, which would hide what is wrong; also behind walls, where no ray finds what surrounds the media.
    for (what, parts) in [("glowing", &[][..]), ("glowing in a room", &[("walls", walls)])] {
        let eye = ("sensor", camera([0.3, 0.5, 5.0], [0.0, 0.0, 0.0], 8));
        let [overlapping, apart] = [&overlapping[..], &apart]
            .map(|media| scene(&[std::slice::from_ref(&eye), media, parts].concat()));
        same(&mut claims, what, &overlapping, &apart);
    }
    claims.settle();
}

/// One medium in several shapes is there once; a bubble takes it away, and nothing where it sticks out.
#[test]
fn shapes_of_one_medium_join_and_bubbles_are_cut_out() {
    let mut claims = Claims::new();
    let second = json!({"type": "cube", "to_world": place([1.0, 1.0, 1.0], [0.6, 0.0, 0.0]),
        "bsdf": {"type": "null"}, "interior": named("fog")});
    let joined = around(&[("first", in_box(LEFT, red("fog"))), ("second", second)]);
    let one = around(&[("first", in_box([LEFT[0], RIGHT[1]], red("fog")))]);
    same(&mut claims, "one medium", &joined, &one);
    let bubble = with(null_box(RIGHT[0], RIGHT[1], None), &[("exterior", named("fog"))]);
    let cut = around(&[("first", in_box(LEFT, red("fog"))), ("second", bubble)]);
    let left = around(&[("first", in_box([LEFT[0], [RIGHT[0][0], 1.0, 1.0]], red("fog")))]);
    same(&mut claims, "a bubble", &cut, &left);
    claims.settle();
}

/// A camera and a lamp that lie where media overlap are found there, whether they state one of them or none.
#[test]
fn cameras_and_lamps_may_lie_where_media_overlap() {
    let inside = |medium: &[(&str, Value)]| {
        let eye = with(camera([0.0, 0.1, 0.5], [0.3, -0.2, -4.0], 8), medium);
        scene(&[
            ("sensor", eye),
            ("floor", floor(-1.5, 4.0, 0.5)),
            ("lamp", point([0.2, 0.6, -0.5], 4.0)),
            ("depth", depth(4)),
            ("first", in_box(LEFT, red("a"))),
            ("second", in_box(RIGHT, pale("b"))),
        ])
    };
    let [unstated, stated] = [Stage::new(&inside(&[])), Stage::new(&inside(&[("medium", named("a"))]))];
    for stage in [&unstated, &stated] {
        let setup = &stage.setup;
        assert_eq!(setup.medium_name(setup.scene.media_map.sensor), "a + b");
        assert_eq!(setup.medium_name(setup.scene.lights.all[0].medium), "a + b");
    }
    let mut claims = Claims::new();
    let sample =
        |stage: &Stage, set, first| Sample::of(&stage.renders(set, 64, first..first + 8), stage.width());
    let expected = sample(&unstated, Strategies::PT, 0);
    claims.equal("bdpt", &sample(&unstated, Strategies::BDPT, 100), &expected);
    claims.equal("stated", &sample(&stated, Strategies::BDPT, 200), &expected);
    claims.settle();
}

/// An open cylinder and a box without a lid hold what they hold where they are closed, and a warning names them.
#[test]
fn openings_are_closed_by_flat_lids() {
    let tube = || {
        let open = json!({"type": "cylinder", "p0": [0.0, -1.2, 0.0], "p1": [0.0, 1.0, 0.0], "radius": 0.9,
            "bsdf": {"type": "null"}});
        with(open, &[("interior", named("fog"))])
    };
    let end = |y: f64, degrees: f64| {
        json!({"type": "disk", "bsdf": {"type": "null"}, "interior": named("fog"), "to_world": [
            {"type": "scale", "value": 0.9}, {"type": "rotate", "axis": [1, 0, 0], "angle": degrees},
            {"type": "translate", "value": [0.0, y, 0.0]},
        ]})
    };
    let fog = ("fog", red("fog"));
    let open = around(&[fog.clone(), ("tube", tube())]);
    let closed = around(&[fog, ("tube", tube()), ("top", end(1.0, -90.0)), ("bottom", end(-1.2, 90.0))]);
    let mut claims = Claims::new();
    same(&mut claims, "a cylinder", &open, &closed);
    claims.settle();
    let warnings = Stage::new(&open).setup.warnings;
    assert!(warnings.iter().any(|w| w.contains("\"tube\"") && w.contains("flat lids")), "{warnings:?}");
}

#[test]
fn an_open_mesh_is_closed() {
    let corners = "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n";
    // All faces but the upper one.
    let faces = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 1 5 8 4\nf 2 3 7 6\n";
    let mesh =
        json!({"type": "obj", "filename": "box.obj", "bsdf": {"type": "null"}, "interior": red("fog")});
    let open = Stage::with_files(&around(&[("box", mesh)]), &[("box.obj", &format!("{corners}{faces}"))]);
    let closed = Stage::new(&around(&[("box", in_box([[-1.0; 3], [1.0; 3]], red("fog")))]));
    let mut claims = Claims::new();
    let sample =
        |stage: &Stage, set, first| Sample::of(&stage.renders(set, 64, first..first + 8), stage.width());
    let expected = sample(&closed, Strategies::BDPT, 0);
    for (first, (name, set)) in (1..).zip(METHODS) {
        claims.equal(name, &sample(&open, set, 100 * first), &expected);
    }
    claims.settle();
}

/// Light that gets around an open boundary of no volume is left out, whichever end it is followed from.
#[test]
fn light_around_a_flat_boundary_is_left_out_by_all() {
    let turned = |half: f64, degrees: f64, at: [f64; 3]| {
        json!({"type": "rectangle", "to_world": [
            {"type": "scale", "value": half}, {"type": "rotate", "axis": [1, 0, 0], "angle": degrees},
            {"type": "translate", "value": at},
        ]})
    };
    let wall =
        |half: f64, degrees: f64, at: [f64; 3]| with(turned(half, degrees, at), &[("bsdf", diffuse(0.6))]);
    let window = with(turned(0.7, 0.0, [0.0, 0.0, 0.9]), &[("bsdf", json!({"type": "null"}))]);
    // Around the window there is a gap.
    let parts = [
        ("sensor", camera([0.2, 0.3, 5.0], [0.0, -0.1, 0.0], 8)),
        ("window", with(window, &[("exterior", medium(0.0, 0.0, 0.0)), ("interior", medium(0.7, 0.8, 0.3))])),
        ("back", wall(1.0, 0.0, [0.0, 0.0, -1.0])),
        ("floor", wall(1.0, -90.0, [0.0, -1.0, 0.0])),
        ("ceiling", wall(1.0, 90.0, [0.0, 1.0, 0.0])),
        ("lamp", lamp_ball([0.3, 0.2, 2.5], 0.4, 20.0)),
        ("depth", depth(5)),
    ];
    let stage = Stage::new(&scene(&parts));
    assert!(stage.setup.warnings.iter().any(|w| w.contains("left out")), "{:?}", stage.setup.warnings);
    let sample = |set, first| Sample::of(&stage.renders(set, 256, first..first + 8), stage.width());
    let expected = sample(Strategies::BDPT, 0);
    let mut claims = Claims::new();
    for (first, (name, set)) in (1..).zip(METHODS) {
        claims.equal(name, &sample(set, 100 * first), &expected);
    }
    claims.settle();
    let lit: f32 = stage.render(Strategies::BDPT, 16, 1).iter().map(|v| v.y).sum();
    assert!(lit > 0.0, "black");
}

/// Of very many that overlap, the sets that hold points are looked for: twenty clouds of fog, each a boundary of its own.
#[test]
fn many_media_overlap() {
    let clouds: Vec<(String, Value)> = (0..20)
        .map(|i| {
            let fog = json!({"type": "homogeneous", "sigma_t": 0.05 + 0.001 * f64::from(i), "albedo": 0.0});
            let shift = 0.01 * f64::from(i);
            (format!("cloud_{i}"), in_box([[-1.0 + shift, -1.0, -1.0], [1.0, 1.0, 1.0 + shift]], fog))
        })
        .collect();
    let mut parts =
        vec![("sensor", camera([0.5, 0.0, 5.0], [0.5, 0.0, 0.0], 1)), ("sky", sky(1.0)), ("depth", depth(3))];
    parts.extend(clouds.iter().map(|(name, cloud)| (name.as_str(), cloud.clone())));
    let view =
        json!({"type": "perspective", "fov": 0.01, "film": {"type": "hdrfilm", "width": 1, "height": 1}});
    parts[0].1 = with(view, &[("to_world", parts[0].1["to_world"].clone())]);
    let stage = Stage::new(&scene(&parts));
    let depth: f64 = (0..20).map(f64::from).map(|i| (0.05 + 0.001 * i) * (2.0 + 0.01 * i)).sum();
    let values: Vec<f64> =
        (0..16).map(|seed| f64::from(stage.render(Strategies::PT, 4096, seed)[0].y)).collect();
    let mut claims = Claims::new();
    claims.mean("transmittance", &values, (-depth).exp());
    claims.settle();
}
