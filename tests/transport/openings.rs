//! Which medium camera, emitters and infinity lie in where a file does not say so: rooms whose only boundaries are small
//! openings, nested boxes, lanterns, fog without end.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::{
    math::{Spectrum, Vec3},
    medium::MediumIndex,
    sampling::{Stream, stream::Purpose},
    scene::media::Infinity,
    transport::Strategies,
};

const METHODS: [(&str, Strategies); 3] =
    [("pt", Strategies::PT), ("lt", Strategies::LT), ("bdpt", Strategies::BDPT)];

/// A rectangle of half sides `half`, turned by `degrees` about `axis`, its centre at `at`.
fn panel(half: [f64; 2], axis: [f64; 3], degrees: f64, at: [f64; 3]) -> Value {
    json!({"type": "rectangle", "to_world": [
        {"type": "scale", "value": [half[0], half[1], 1.0]},
        {"type": "rotate", "axis": axis, "angle": degrees},
        {"type": "translate", "value": at},
    ]})
}

/// A closed room [-1, 1]^3 of opaque walls that say nothing of media, with a square hole of half side `hole` in its roof,
/// closed by a null surface in front of the medium `inside`; outside of it is vacuum, which is left unstated.
fn room_with_a_hole(hole: f64, inside: &str) -> Vec<(&'static str, Value)> {
    let wall = |panel: Value| with(panel, &[("bsdf", diffuse(0.5))]);
    let (across, wide) = (0.5 * (1.0 + hole), 0.5 * (1.0 - hole));
    let roof = |half: [f64; 2], x: f64, z: f64| wall(panel(half, [1.0, 0.0, 0.0], 90.0, [x, 1.0, z]));
    let window = panel([hole, hole], [1.0, 0.0, 0.0], -90.0, [0.0, 1.0, 0.0]);
    vec![
        ("roof_right", roof([wide, 1.0], across, 0.0)),
        ("roof_left", roof([wide, 1.0], -across, 0.0)),
        ("roof_front", roof([hole, wide], 0.0, across)),
        ("roof_back", roof([hole, wide], 0.0, -across)),
        ("floor", wall(panel([1.0, 1.0], [1.0, 0.0, 0.0], -90.0, [0.0, -1.0, 0.0]))),
        ("left", wall(panel([1.0, 1.0], [0.0, 1.0, 0.0], 90.0, [-1.0, 0.0, 0.0]))),
        ("right", wall(panel([1.0, 1.0], [0.0, 1.0, 0.0], -90.0, [1.0, 0.0, 0.0]))),
        ("back", wall(panel([1.0, 1.0], [0.0, 1.0, 0.0], 0.0, [0.0, 0.0, -1.0]))),
        ("front", wall(panel([1.0, 1.0], [0.0, 1.0, 0.0], 180.0, [0.0, 0.0, 1.0]))),
        ("window", with(window, &[("bsdf", json!({"type": "null"})), ("interior", named(inside))])),
    ]
}

fn in_the_room(medium: &str) -> Value {
    with(camera([0.0, -0.2, 0.9], [0.0, -0.2, -1.0], 6), &[("medium", named(medium))])
}

/// Lamps of every kind above the roof.
fn lamps_outside() -> Vec<(&'static str, Value)> {
    vec![
        ("point", point([0.3, 2.5, 0.2], 30.0)),
        ("spot", spot([-0.2, 2.5, 0.1], [0.0, 0.0, 0.0], 30.0)),
        ("ball", lamp_ball([0.2, 3.0, 0.0], 0.4, 40.0)),
        ("panel", lamp_panel([0.0, 2.5, 0.0], 0.5, 20.0)),
        ("sky", sky(5.0)),
        ("sun", sun([0.1, -1.0, 0.15], 10.0)),
    ]
}

fn dusty_room(hole: f64, lamp: Value) -> Value {
    let mut parts = vec![("dust", medium(0.6, 0.8, 0.3)), ("sensor", in_the_room("dust")), ("lamp", lamp)];
    parts.extend(room_with_a_hole(hole, "dust"));
    scene(&parts)
}

/// `pt`, `lt` and `bdpt` show one image of `scene`; light tracing not where the camera is in a medium, for there its
/// variance is infinite (light scattered next to the lens), nor where there is a sky: of its light subpaths
/// too few find the opening for a test of means. `bdpt` starts the same ones.
fn agree(claims: &mut Claims, what: &str, stage: &Stage, samples_per_pixel: u64, seeds: u64) {
    let around = &stage.setup.scene.media[stage.setup.scene.media_map.sensor.0 as usize];
    let sky = stage.setup.scene.lights.environment.is_some();
    let methods = if around.bound().sigma_t == Spectrum::ZERO && !sky {
        &METHODS[..]
    } else {
        &[METHODS[0], METHODS[2]]
    };
    let samples: Vec<(&str, Sample)> = (0..)
        .zip(methods)
        .map(|(i, (name, set))| {
            let images = stage.renders(*set, samples_per_pixel, 1000 * i..1000 * i + seeds);
            (*name, Sample::of(&images, stage.width()))
        })
        .collect();
    for (name, sample) in &samples[1..] {
        claims.equal(&format!("{what}: {name} against pt"), sample, &samples[0].1);
    }
}

/// The lamp's 32 directions of old all missed the window, and six rays missed the hole that the sky shines through: the
/// first was taken to lie in the camera's dust, the second was black.
#[test]
fn light_comes_through_the_only_opening_of_a_room() {
    let mut claims = Claims::new();
    for (name, lamp) in lamps_outside() {
        let stage = Stage::new(&dusty_room(0.3, lamp));
        assert!(stage.setup.warnings.is_empty(), "{name}: {:?}", stage.setup.warnings);
        agree(&mut claims, name, &stage, 64, 8);
        let lit: f32 = stage.render(Strategies::BDPT, 16, 1).iter().map(|v| v.y).sum();
        assert!(lit > 0.0, "{name}: black");
    }
    claims.settle();
}

/// A sky is a dome that is far enough away, through an opening too. (Mitsuba 3.9.1 agrees on the dome; its next-event
/// estimates of a `constant` sky pass closed walls: a room without any opening is not black there.)
#[test]
fn a_sky_shines_through_an_opening_as_a_dome_does() {
    let dome = json!({
        "type": "sphere", "radius": 50.0, "flip_normals": true,
        "emitter": {"type": "area", "radiance": 5.0},
    });
    let mut claims = Claims::new();
    for (name, set, first) in [("pt", Strategies::PT, 0), ("bdpt", Strategies::BDPT, 1000)] {
        let [sky, dome] = [(sky(5.0), first), (dome.clone(), first + 500)].map(|(light, first)| {
            let stage = Stage::new(&dusty_room(0.4, light));
            Sample::of(&stage.renders(set, 128, first..first + 8), stage.width())
        });
        claims.equal(name, &sky, &dome);
    }
    claims.settle();
    let closed = Stage::new(&scene(&[
        ("sensor", camera([0.0, -0.2, 0.9], [0.0, -0.2, -1.0], 6)),
        ("room", room(0.6, None)),
        ("sky", sky(5.0)),
    ]));
    assert!(closed.render(Strategies::BDPT, 64, 1).iter().all(|v| *v == Spectrum::ZERO), "not black");
}

/// The parts of the sphere that the opening takes, seen from the middle of the room: 1e-2 to 1e-5.
#[test]
fn however_small_the_opening_the_lamp_outside_is_not_in_the_dust() {
    for part in [1e-2, 1e-3, 1e-4, 1e-5f64] {
        let hole = 0.5 * (part * 4.0 * std::f64::consts::PI).sqrt();
        for (name, lamp) in lamps_outside() {
            let setup = Stage::new(&dusty_room(hole, lamp)).setup;
            let (light, outside) = (&setup.scene.lights.all[0], setup.scene.media_map.outside);
            assert_eq!((light.medium, outside), (MediumIndex::VACUUM, MediumIndex::VACUUM), "{name}, {part}");
            assert!(!light.straddles && setup.warnings.is_empty(), "{name}, {part}: {:?}", setup.warnings);
        }
    }
}

/// The other way round: lamps within, the camera outside and the medium stated by the window alone.
#[test]
fn lamps_behind_a_small_opening_are_in_the_dust() {
    for part in [1e-2, 1e-3, 1e-4, 1e-5f64] {
        let hole = 0.5 * (part * 4.0 * std::f64::consts::PI).sqrt();
        let lamps = [
            ("point", point([0.3, -0.5, 0.2], 1.0)),
            ("ball", lamp_ball([0.4, -0.4, 0.1], 0.2, 4.0)),
            ("spot", spot([0.0, 0.5, 0.0], [0.0, -1.0, 0.1], 1.0)),
        ];
        for (name, lamp) in lamps {
            let mut parts = vec![
                ("dust", medium(0.6, 0.8, 0.3)),
                ("sensor", camera([0.0, 4.0, 0.2], [0.0, 0.0, 0.0], 6)),
                ("lamp", lamp),
            ];
            parts.extend(room_with_a_hole(hole, "dust"));
            let setup = Stage::new(&scene(&parts)).setup;
            assert_eq!(setup.scene.lights.all[0].medium, MediumIndex(1), "{name}, {part}");
            assert_eq!(setup.scene.media_map.sensor, MediumIndex::VACUUM, "{name}, {part}");
            assert!(setup.warnings.is_empty(), "{name}, {part}: {:?}", setup.warnings);
        }
    }
}

#[test]
fn a_lamp_shines_out_of_a_dusty_room() {
    let mut claims = Claims::new();
    let mut parts = vec![
        ("dust", medium(0.6, 0.8, 0.3)),
        ("sensor", camera([0.0, 4.0, 0.2], [0.0, 0.0, 0.0], 6)),
        ("lamp", point([0.3, -0.5, 0.2], 10.0)),
        ("ball", lamp_ball([-0.4, -0.4, 0.1], 0.3, 4.0)),
    ];
    parts.extend(room_with_a_hole(0.5, "dust"));
    agree(&mut claims, "out of the roof", &Stage::new(&scene(&parts)), 64, 8);
    claims.settle();
}

/// Fog without end, and in it closed rooms of vacuum with a window: an opaque room says nothing of its inside but by its
/// window, whose interior is left unstated.
#[test]
fn rooms_of_vacuum_stand_in_fog_without_end() {
    let fog = ("fog", medium(0.3, 0.9, 0.2));
    let mut room = room_with_a_hole(0.4, "fog");
    let (_, window) = room.pop().unwrap();
    let mut window = window.as_object().unwrap().clone();
    let stated = window.remove("interior").unwrap();
    window.insert("exterior".into(), stated);
    room.push(("window", Value::Object(window)));
    for (what, view, inside) in [
        (
            "from outside",
            with(camera([0.0, 3.0, 0.5], [0.0, 0.0, 0.0], 6), &[("medium", named("fog"))]),
            false,
        ),
        ("from inside", camera([0.0, -0.5, 0.9], [0.0, 0.2, -1.0], 6), true),
    ] {
        let mut parts = vec![
            fog.clone(),
            ("sensor", view),
            ("inside", point([0.3, -0.5, 0.2], 3.0)),
            ("outside", lamp_ball([0.2, 2.2, 0.0], 0.3, 10.0)),
        ];
        parts.extend(room.iter().cloned());
        let stage = Stage::new(&scene(&parts));
        assert!(stage.setup.warnings.is_empty(), "{what}: {:?}", stage.setup.warnings);
        let media: Vec<u32> = stage.setup.scene.lights.all.iter().map(|light| light.medium.0).collect();
        assert_eq!(media.iter().filter(|medium| **medium == 0).count(), 1, "{what}");
        assert_eq!(stage.setup.scene.media_map.sensor == MediumIndex::VACUUM, inside, "{what}");
        let mut claims = Claims::new();
        agree(&mut claims, what, &stage, 64, 8);
        claims.settle();
    }
}

/// Five opaque walls and a window around a lamp, all in fog: what is seen through the walls must not outvote the window.
#[test]
fn a_lantern_holds_vacuum() {
    let mut room = room_with_a_hole(0.8, "fog");
    let (_, window) = room.pop().unwrap();
    let mut window = window.as_object().unwrap().clone();
    let fog = window.remove("interior").unwrap();
    window.insert("exterior".into(), fog);
    let parts = [
        vec![
            ("fog", medium(0.3, 0.9, 0.0)),
            ("sensor", with(camera([0.0, 3.0, 3.0], [0.0, 1.0, 0.0], 6), &[("medium", named("fog"))])),
            ("floor_of_the_world", floor(-3.0, 9.0, 0.5)),
            ("flame", point([0.0, 0.0, 0.0], 10.0)),
        ],
        room,
        vec![("window", Value::Object(window))],
    ]
    .concat();
    let stage = Stage::new(&scene(&parts));
    assert_eq!(stage.setup.scene.lights.all[0].medium, MediumIndex::VACUUM);
    assert!(stage.setup.warnings.is_empty(), "{:?}", stage.setup.warnings);
    let mut claims = Claims::new();
    agree(&mut claims, "lantern", &stage, 128, 8);
    claims.settle();
}

/// An opaque lamp with an interior and no exterior stands in the fog around it: a side that is not stated says nothing.
#[test]
fn an_unstated_side_of_an_opaque_shape_is_what_lies_around_it() {
    let fog = medium(1.0, 0.8, 0.0);
    let mut claims = Claims::new();
    for (what, shape) in [
        ("lamp", with(lamp_ball([0.3, 0.2, 0.0], 0.25, 4.0), &[("interior", named("ink"))])),
        (
            "ball",
            json!({
                "type": "sphere", "center": [0.3, 0.2, 0.0], "radius": 0.25,
                "bsdf": diffuse(0.8), "interior": named("ink"),
            }),
        ),
    ] {
        let parts = [
            ("ink", medium(5.0, 0.1, 0.0)),
            ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 6)),
            ("cloud", null_box([-0.9; 3], [0.9; 3], Some(fog.clone()))),
            ("floor", floor(-1.0, 2.0, 0.5)),
            ("shape", shape),
            ("panel", lamp_panel([-0.3, 1.5, 0.0], 0.4, 3.0)),
        ];
        agree(&mut claims, what, &Stage::new(&scene(&parts)), 128, 8);
    }
    claims.settle();
}

/// A fog box made a hair larger than the room in it, whose walls say nothing: camera and lamp are taken to lie in the fog
/// that is seen behind the walls, with a warning.
#[test]
fn a_fog_box_a_hair_larger_than_the_room_fills_it() {
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 6)),
        ("room", room(0.6, None)),
        ("fog", null_box([-1.001; 3], [1.001; 3], Some(medium(1.0, 0.8, 0.3)))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, 2.0)),
        ("panel", lamp_panel([-0.3, 0.99, 0.0], 0.3, 2.0)),
    ];
    let stage = Stage::new(&scene(&parts));
    assert_eq!(stage.setup.scene.media_map.sensor, MediumIndex(1));
    let warned = stage.setup.warnings.iter().any(|w| w.contains("the camera") && w.contains("seen behind"));
    assert!(warned, "{:?}", stage.setup.warnings);
    let mut claims = Claims::new();
    agree(&mut claims, "fog behind the walls", &stage, 256, 12);
    claims.settle();
}

#[test]
fn a_camera_found_in_fog_is_told_how_to_say_so() {
    let parts = [
        ("fog", medium(1.0, 0.8, 0.3)),
        ("sensor", camera([0.0, 0.0, 0.5], [0.0, 0.0, -1.0], 6)),
        ("cloud", null_box([-0.9; 3], [0.9; 3], Some(named("fog")))),
        ("lamp", point([0.3, 0.3, -0.2], 1.0)),
    ];
    let warnings = Stage::new(&scene(&parts)).setup.warnings;
    let line = r#""medium": {"type": "ref", "id": "fog"}"#;
    assert!(matches!(warnings.as_slice(), [one] if one.contains(line)), "{warnings:?}");
}

/// A sea under a sky: a null surface without end to speak of has other media at infinity below than above.
#[test]
fn infinity_differs_by_direction_where_a_surface_divides_the_world() {
    let parts = [
        ("water", medium(rgb(0.6, 0.4, 0.3), 0.5, 0.6)),
        ("sensor", camera([0.0, 1.0, 2.0], [0.0, 0.0, 0.0], 6)),
        (
            "surface",
            with(
                panel([30.0, 30.0], [1.0, 0.0, 0.0], -90.0, [0.0; 3]),
                &[("bsdf", json!({"type": "null"})), ("interior", named("water"))],
            ),
        ),
        ("ball", json!({"type": "sphere", "center": [0.0, -0.5, 0.0], "radius": 0.4, "bsdf": diffuse(0.7)})),
        ("sky", sky(1.0)),
        ("sun", sun([0.2, -1.0, 0.1], 2.0)),
    ];
    let stage = Stage::new(&scene(&parts));
    let infinity = &stage.setup.scene.media_map.known.infinity;
    assert!(matches!(infinity, Infinity::Directional(_)), "{infinity:?}");
    let [above, below] = [Vec3::Y, Vec3::NEG_Y].map(|direction| infinity.towards(direction));
    assert!(above == MediumIndex::VACUUM && below != above, "{above:?} {below:?}");
    // Of light subpaths alone too few come near the ball.
    let [pt, bdpt] = [(Strategies::PT, 0), (Strategies::BDPT, 1000)]
        .map(|(set, first)| Sample::of(&stage.renders(set, 128, first..first + 8), stage.width()));
    let mut claims = Claims::new();
    claims.equal("sea: bdpt against pt", &bdpt, &pt);
    claims.settle();
}

/// A random arrangement: a room with a hole in its roof or none of it, nested boxes and balls within and beside it, lamps
/// anywhere in between, and no medium stated but by boundaries.
fn arrangement(index: u64) -> Value {
    let mut stream = Stream::new(77, index, 0, Purpose::Study);
    let mut pick = |low: f64, high: f64| low + (high - low) * stream.uniform_precisely();
    let mut parts = vec![
        ("dust", medium(pick(0.1, 1.0), pick(0.3, 0.95), 0.3)),
        ("smoke", medium(pick(0.5, 4.0), pick(0.3, 0.9), 0.0)),
    ];
    let roofed = pick(0.0, 1.0) < 0.7;
    let around = if roofed { Some("dust") } else { None };
    if roofed {
        parts.extend(room_with_a_hole(10f64.powf(pick(-1.0, -0.1)), "dust"));
    } else {
        parts.push(("floor", floor(-1.0, 2.0, 0.5)));
    }
    let stated = |shape: Value, exterior: Option<&str>| match exterior {
        Some(id) => with(shape, &[("exterior", named(id))]),
        None => shape,
    };
    let size = pick(0.15, 0.4);
    let at = [pick(-0.5, 0.5), pick(-0.55, 0.3), pick(-0.6, 0.1)];
    let (low, high) = (at.map(|x| x - size), at.map(|x| x + size));
    parts.push(("box", stated(null_box(low, high, Some(named("smoke"))), around)));
    if pick(0.0, 1.0) < 0.5 {
        parts.push((
            "bubble",
            with(null_ball(at, 0.7 * size, named("dust")), &[("exterior", named("smoke"))]),
        ));
    }
    for (name, chance, aside) in [("one", 1.0, 0.3), ("other", 0.5, -0.3)] {
        if pick(0.0, 1.0) > chance {
            continue;
        }
        let (place, in_a_medium) = match (pick(0.0, 3.0) as u32, roofed) {
            (0, _) => (at.map(|x| x + aside * size), true),
            (1, true) => ([aside, pick(2.0, 3.0), pick(-0.2, 0.2)], false),
            _ => ([2.0 * aside, pick(0.45, 0.8), pick(-0.8, 0.8)], roofed),
        };
        // Path tracing of points of light in a medium has no finite variance: a vertex at distance r counts 1 / r^2.
        let lamp = match pick(0.0, 3.0) as u32 {
            0 if !in_a_medium => point(place, 3.0),
            1 if !in_a_medium => spot(place, [0.0, -1.0, 0.0], 3.0),
            _ => lamp_ball(place, 0.2 * size, 30.0),
        };
        parts.push((name, lamp));
    }
    if pick(0.0, 1.0) < 0.3 {
        parts.push(("sky", sky(0.5)));
    }
    let view = match (roofed, pick(0.0, 1.0) < 0.7) {
        (true, true) => camera([0.0, 3.5, 0.3], [0.0, 0.0, 0.0], 4),
        (true, false) => camera([0.0, 0.2, 0.9], [0.0, -0.3, -1.0], 4),
        _ => camera([0.0, 0.5, 3.0], [0.0, -0.2, 0.0], 4),
    };
    parts.push(("sensor", view));
    // Seen themselves, lamps a tenth of a pixel wide would be found by path tracing too rarely for a test of means.
    parts.push(("integrator", json!({"type": "volpath", "hide_emitters": true})));
    scene(&parts)
}

#[test]
fn random_rooms_openings_and_nested_boxes_agree() {
    let mut claims = Claims::new();
    for index in 0..200 {
        let stage = Stage::new(&arrangement(index));
        let expected = ["Mitsuba would take vacuum", "is not used"];
        let wrong = stage.setup.warnings.iter().find(|w| expected.iter().all(|text| !w.contains(text)));
        assert!(wrong.is_none(), "{index}: {wrong:?}");
        agree(&mut claims, &format!("arrangement {index}"), &stage, 64, 6);
    }
    claims.settle();
}

/// A camera that states its fog, in a box of it in a room: few rays from the box find the hole in the roof, and infinity was taken
/// to lie in the camera's fog, so that no light of the sky arrived.
#[test]
fn a_box_of_fog_in_a_room_does_not_reach_to_the_sky() {
    for hole in [0.04, 0.2, 0.4] {
        let mut parts = room_with_a_hole(hole, "fog");
        parts.retain(|(name, _)| *name != "window");
        parts.extend([
            ("fog", medium(0.5, 0.9, 0.0)),
            ("box", null_box([-0.85; 3], [0.85; 3], Some(named("fog")))),
            ("sensor", with(camera([0.0, 0.0, 0.7], [0.0, 0.1, -1.0], 6), &[("medium", named("fog"))])),
            ("sky", sky(10.0)),
        ]);
        let stage = Stage::new(&scene(&parts));
        assert_eq!(stage.setup.scene.media_map.outside, MediumIndex::VACUUM, "{hole}");
        assert!(stage.setup.warnings.is_empty(), "{hole}: {:?}", stage.setup.warnings);
    }
}

/// A bright wall behind a box of fog that fills the right half of the view and in which every ray of the right half starts;
/// `more` besides.
fn half_in_the_fog(sensor: &Value, albedo: f64, more: &[(&'static str, Value)]) -> Value {
    let film = json!({"type": "hdrfilm", "width": 6, "height": 6, "rfilter": {"type": "box"}});
    let placed = json!([{"type": "scale", "value": 9}, {"type": "translate", "value": [0, 0, -3]}]);
    let wall = with(lamp_panel([0.0; 3], 1.0, 1.0), &[("to_world", placed)]);
    let mut parts = vec![
        ("sensor", with(sensor.clone(), &[("film", film)])),
        ("fog", null_box([0.0, -3.0, -2.0], [3.0, 3.0, 2.0], Some(medium(0.4, albedo, 0.0)))),
        ("wall", wall),
    ];
    parts.extend_from_slice(more);
    scene(&parts)
}

fn look(z: f64) -> Value {
    json!({"type": "lookat", "origin": [0, 0, z], "target": [0, 0, 0], "up": [0, 1, 0]})
}

/// Its rays start at z = 0.5.
fn parallel() -> Value {
    json!({"type": "orthographic", "near_clip": 0.5,
        "to_world": [{"type": "scale", "value": [1.5, 1.5, 1]}, look(1.0)]})
}

/// What a pixel shows, image by image.
fn column(images: &[Vec<Spectrum>], index: usize) -> Vec<f64> {
    images.iter().map(|image| f64::from(image[index].x)).collect()
}

fn straddling(scene: &Value) -> Stage {
    let stage = Stage::new(scene);
    let said = &stage.setup.warnings;
    assert!(matches!(said.as_slice(), [one] if one.contains("its rays start in several")), "{said:?}");
    stage
}

/// By the sensor's one medium, the left half was as dark as the right one.
#[test]
fn rays_of_one_camera_start_in_several_media() {
    let near = json!({"type": "perspective", "fov": 40, "near_clip": 3.5, "to_world": [look(4.0)]});
    let lens = json!({"type": "thinlens", "fov": 40, "aperture_radius": 0.5, "focus_distance": 1.5,
        "to_world": [look(0.5)]});
    let mut claims = Claims::new();
    for (name, sensor) in [("parallel", parallel()), ("near plane", near), ("lens", lens)] {
        let [dark, bright] = [0.0, 0.8].map(|albedo| straddling(&half_in_the_fog(&sensor, albedo, &[])));
        let of = |images: &[Vec<Spectrum>]| Sample::of(images, dark.width());
        let pt = of(&dark.renders(Strategies::PT, 64, 0..12));
        for (first, (method, set)) in (1..).zip(METHODS) {
            let found = dark.renders(set, 64, 1000 * first..1000 * first + 12);
            claims.equal(&format!("{name}, {method}"), &of(&found), &pt);
            if name != "lens" {
                claims.mean(&format!("{name}, {method}, left"), &column(&found, 6 * 2), 1.0);
            }
        }
        let [pt, all] = [(Strategies::PT, 0), (Strategies::BDPT, 1000)]
            .map(|(set, first)| of(&bright.renders(set, 64, first..first + 12)));
        claims.equal(&format!("{name}, bdpt in white fog"), &all, &pt);
    }
    claims.settle();
}

/// The right half lies in one box of fog, or in two that overlap.
#[test]
fn rays_that_start_in_overlapping_fog_pass_through_all_of_it() {
    let smoke = null_box([-0.1, -3.0, -1.0], [3.0, 3.0, 1.0], Some(medium(0.3, 0.0, 0.0)));
    let mut claims = Claims::new();
    for (more, depth) in [(vec![], 0.4 * 2.5), (vec![("smoke", smoke)], 0.4 * 2.5 + 0.3 * 1.5f64)] {
        let stage = straddling(&half_in_the_fog(&parallel(), 0.0, &more));
        assert_eq!(stage.setup.scene.media_map.overlaps.is_some(), !more.is_empty());
        for (name, set) in METHODS {
            let found = stage.renders(set, 64, 0..12);
            claims.mean(&format!("{name} through {depth}"), &column(&found, 6 * 2 + 4), (-depth).exp());
            claims.mean(&format!("{name} beside {depth}"), &column(&found, 6 * 2), 1.0);
        }
    }
    claims.settle();
}

/// A plate that measures, half of it in fog.
#[test]
fn rays_of_an_irradiancemeter_start_on_either_side_of_a_boundary() {
    let plate = with(floor(0.0, 1.0, 0.5), &[("meter", json!({"type": "irradiancemeter"}))]);
    let fog = null_box([0.0, -1.0, -2.0], [2.0, 1.0, 2.0], Some(medium(1.0, 0.0, 0.0)));
    let stage =
        straddling(&scene(&[("plate", plate), ("fog", fog), ("lamp", lamp_ball([0.0, 3.0, 0.0], 0.5, 1.0))]));
    let mut claims = Claims::new();
    let [pt, lt, all] = METHODS.map(|(_, set)| column(&stage.renders(set, 4096, 0..12), 0));
    for (name, found) in [("lt", lt), ("bdpt", all)] {
        let ratio: Vec<f64> = found.iter().zip(&pt).map(|(found, pt)| found - pt).collect();
        claims.mean(name, &ratio, 0.0);
    }
    claims.settle();
}
