//! `pt`, `lt`, `bdpt` and every other set of strategies that can make all paths of a scene show the same image:
//! the weights of the strategies that run sum to one, whichever they are.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    name_of,
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{
    transport::coverage,
    transport::{Connections, Guiding, Options, Strategies},
};

/// What decides which strategies can make all paths of a scene.
#[derive(Clone, Copy, Default)]
struct Kind {
    /// There are point, spot or directional emitters, which no camera subpath can meet.
    points: bool,
    /// An emitter is in view, which next-event estimation cannot show.
    emitter_in_view: bool,
    /// Smooth surfaces stand between eye and emitters.
    smooth: bool,
}

/// Every set of strategies that covers all paths of such a scene.
fn covering(kind: Kind) -> Vec<Strategies> {
    let bit = |set: u32, i: u32| set >> i & 1 == 1;
    let sets = (1..16).map(|set| Strategies {
        emitter_hit: bit(set, 0),
        next_event: bit(set, 1),
        connection: bit(set, 2),
        lens: bit(set, 3),
        ..Strategies::NONE
    });
    sets.filter(|s| covers(*s, kind)).collect()
}

fn covers(s: Strategies, kind: Kind) -> bool {
    if kind.smooth {
        // Over smooth surfaces alone only a walk that meets the emitter gets from one to the other.
        return s.emitter_hit;
    }
    let emitters_seen = s.emitter_hit || s.lens || !kind.emitter_in_view;
    let light_of_points = s.next_event || s.lens || !kind.points;
    let any_light = s.emitter_hit || s.next_event || s.lens;
    emitters_seen && light_of_points && any_light
}

const SEEDS: u64 = 12;

/// All covering sets against bidirectional path tracing, each with seeds of its own.
fn all_agree(name: &str, scene: &Value, kind: Kind, samples_per_pixel: u64) {
    let stage = Stage::new(scene);
    let mut measured = covering(kind).into_iter().enumerate().map(|(i, set)| {
        let first = 1000 * i as u64;
        (set, Sample::of(&stage.renders(set, samples_per_pixel, first..first + SEEDS), stage.width()))
    });
    let sets: Vec<(Strategies, Sample)> = measured.by_ref().collect();
    let (_, all) = sets.iter().find(|(set, _)| *set == Strategies::BDPT).expect("covers everything");
    let mut claims = Claims::new();
    let mut paired = stage;
    paired.setup.integrator.options.connections = Connections::All;
    let pairs = Sample::of(
        &paired.renders(Strategies::BDPT, samples_per_pixel, 50_000..50_000 + SEEDS),
        paired.width(),
    );
    claims.equal(&format!("{name}: pairs of walks against all strategies"), &pairs, all);
    let mut guided = paired;
    guided.setup.integrator.options.connections = Connections::Cached;
    guided.setup.integrator.options.effort.guide = Guiding::Always;
    let led = Sample::of(
        &guided.renders(Strategies::BDPT, samples_per_pixel, 60_000..60_000 + SEEDS),
        guided.width(),
    );
    claims.equal(&format!("{name}: guided walks against others"), &led, all);
    for (set, sample) in sets.iter().filter(|(set, _)| *set != Strategies::BDPT) {
        claims.equal(&format!("{name}: {} against all strategies", name_of(*set)), sample, all);
    }
    claims.settle();
}

/// Fog in a room whose camera looks past a lamp.
fn foggy_room(fog: Value) -> Vec<(&'static str, Value)> {
    // What is scattered next to the lens would give light subpaths an infinite variance.
    let near_clip = [("near_clip", json!(0.3))];
    vec![
        ("sensor", with(camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8), &near_clip)),
        ("fog", fog),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
    ]
}

const LAMP_IN_VIEW: Kind = Kind { points: false, emitter_in_view: true, smooth: false };

#[test]
fn covering_sets_are_as_worked_out_by_hand() {
    let names = |kind| covering(kind).into_iter().map(name_of).collect::<Vec<_>>();
    let smooth = Kind { smooth: true, ..LAMP_IN_VIEW };
    assert_eq!(names(smooth).len(), 8);
    assert!(names(smooth).iter().all(|name| name.starts_with("hit")));
    // Whatever contains hit or lens.
    assert_eq!(names(LAMP_IN_VIEW).len(), 12);
    assert_eq!(covering(Kind { points: true, ..Kind::default() }).len(), 12);
    // Whatever contains lens, and hit with next-event estimation.
    let mixed = names(Kind { points: true, ..LAMP_IN_VIEW });
    assert_eq!(mixed.len(), 10);
    assert!(mixed.contains(&"hit+next-event+join".to_owned()) && !mixed.contains(&"hit+join".to_owned()));
    // Any but the joins alone: they lack the shortest paths.
    assert_eq!(covering(Kind::default()).len(), 14);
    assert_eq!(covering(Kind::default()).iter().filter(|s| **s == strategies("join")).count(), 0);
}

#[test]
fn in_a_closed_box_of_fog() {
    let fog = medium(1.0, 0.8, 0.3);
    all_agree("box of fog", &scene(&foggy_room(fog)), LAMP_IN_VIEW, 64);
}

#[test]
fn with_a_hidden_lamp() {
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts.push(("integrator", json!({"type": "bdpt", "hide_emitters": true})));
    all_agree("hidden lamp", &scene(&parts), Kind::default(), 64);
}

/// A hidden lamp hides nothing: what lies behind it is seen, through the fog before and behind.
#[test]
fn with_a_wall_behind_a_hidden_lamp() {
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts[3] = ("lamp", lamp_ball([0.0, 0.0, -0.3], 0.4, rgb(2.0, 3.0, 1.0)));
    parts.push(("integrator", json!({"type": "bdpt", "hide_emitters": true})));
    all_agree("seen through a lamp", &scene(&parts), Kind::default(), 96);
}

#[test]
fn with_single_scattering_only() {
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts.push(("integrator", depth(2)));
    all_agree("two segments", &scene(&parts), LAMP_IN_VIEW, 96);
}

#[test]
fn with_paths_of_three_segments() {
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts.push(("integrator", depth(3)));
    all_agree("three segments", &scene(&parts), LAMP_IN_VIEW, 96);
}

#[test]
fn in_fog_of_three_extinctions() {
    let fog = medium(rgb(0.2, 1.0, 3.0), rgb(0.9, 0.7, 0.8), -0.2);
    all_agree("chromatic fog", &scene(&foggy_room(fog)), LAMP_IN_VIEW, 96);
}

#[test]
fn around_a_chromatic_cloud_in_a_room() {
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, None)),
        ("lamp", lamp_panel([0.0, 0.95, 0.0], 0.5, 3.0)),
        ("cloud", null_ball([0.0, -0.1, -0.3], 0.6, medium(rgb(4.0, 1.0, 0.2), rgb(0.9, 0.9, 0.5), 0.5))),
    ];
    all_agree("chromatic cloud", &scene(&parts), LAMP_IN_VIEW, 96);
}

#[test]
fn under_sky_and_sun() {
    let parts = [
        ("sensor", camera([0.0, 1.0, 3.5], [0.0, 0.3, 0.0], 8)),
        ("floor", floor(-0.5, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.3, -0.8], [0.8, 1.0, 0.8], Some(medium(1.5, 0.9, 0.6)))),
        ("sky", sky(0.6)),
        ("sun", sun([0.3, -1.0, -0.2], rgb(2.0, 1.5, 1.0))),
    ];
    all_agree("sky and sun", &scene(&parts), Kind { points: true, ..LAMP_IN_VIEW }, 128);
}

#[test]
fn under_a_sky_in_vacuum() {
    let parts = [
        ("sensor", camera([0.0, 1.0, 3.5], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-0.5, 2.0, 0.5)),
        ("stone", json!({"type": "cube", "to_world": place([0.4; 3], [0.0; 3])})),
        ("sky", sky(rgb(0.5, 0.7, 1.0))),
    ];
    all_agree("sky in vacuum", &scene(&parts), LAMP_IN_VIEW, 128);
}

#[test]
fn around_a_lamp_in_a_ball_of_fog() {
    let parts = [
        ("sensor", camera([0.0, 0.5, 3.5], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-1.0, 2.0, 0.5)),
        ("ball", null_ball([0.0; 3], 0.9, named("fog"))),
        ("fog", medium(1.5, 0.9, 0.4)),
        ("lamp", lamp_ball([0.1, 0.1, 0.1], 0.4, 2.0)),
    ];
    all_agree("lamp in a ball of fog", &scene(&parts), LAMP_IN_VIEW, 128);
}

/// A square that emits towards the camera, which sees what is behind it too.
fn null_lamp(at: [f64; 3], half: f64, radiance: f64) -> Value {
    json!({
        "type": "rectangle", "to_world": place([half, half, 1.0], at), "bsdf": {"type": "null"},
        "emitter": {"type": "area", "radiance": radiance},
    })
}

#[test]
fn with_lamps_that_light_passes() {
    let masked = json!({"type": "mask", "opacity": 0.5, "nested": diffuse(0.6)});
    let parts = [
        ("sensor", camera([0.0, 0.3, 3.5], [0.0, 0.0, 0.0], 8)),
        ("floor", floor(-1.0, 2.0, 0.5)),
        ("box", null_box([-0.8; 3], [0.8; 3], Some(medium(1.5, 0.9, 0.4)))),
        ("before", null_lamp([-0.4, 0.2, 1.0], 0.4, 1.0)),
        ("within", with(null_lamp([0.3, -0.2, 0.2], 0.3, 4.0), &[("bsdf", masked)])),
        ("around", with(lamp_ball([0.0, 0.3, -0.2], 0.3, 2.0), &[("bsdf", json!({"type": "null"}))])),
    ];
    all_agree("lamps that light passes", &scene(&parts), LAMP_IN_VIEW, 128);
    let mut parts = parts.to_vec();
    parts.push(("integrator", json!({"type": "bdpt", "hide_emitters": true})));
    all_agree("hidden lamps that light passes", &scene(&parts), Kind::default(), 128);
}

/// Without media and without chance: a pane of light adds its own radiance to that of the sky behind it.
#[test]
fn a_pane_of_light_adds_to_what_is_behind_it() {
    let parts = [
        ("sensor", camera([0.0, 0.0, 3.0], [0.0, 0.0, 0.0], 4)),
        ("pane", null_lamp([0.0, 0.0, 1.0], 2.0, 0.25)),
        ("sky", sky(0.5)),
    ];
    let stage = Stage::new(&scene(&parts));
    for image in stage.renders(strategies("hit"), 4, 0..2) {
        assert!(image.iter().all(|pixel| (pixel.x - 0.75).abs() < 1e-6), "{image:?}");
    }
}

#[test]
fn through_a_slab_that_only_absorbs() {
    let parts = [
        ("sensor", camera([1.8, 0.3, 3.0], [0.0, -0.4, 0.0], 8)),
        ("floor", floor(-1.0, 2.0, 0.7)),
        ("slab", null_box([-2.0, -0.2, -2.0], [2.0, 0.2, 2.0], Some(medium(rgb(2.0, 1.0, 0.5), 0.0, 0.0)))),
        ("lamp", lamp_panel([0.0, 0.9, 0.0], 0.9, 3.0)),
    ];
    all_agree("absorbing slab", &scene(&parts), LAMP_IN_VIEW, 192);
}

#[test]
fn around_a_glass_ball_of_fog() {
    let glass = json!({
        "type": "sphere", "center": [0, -0.2, -0.2], "radius": 0.6,
        "bsdf": {"type": "dielectric", "int_ior": 1.5}, "interior": medium(2.0, 0.95, 0.3),
    });
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.5, None)),
        ("lamp", lamp_panel([0.0, 0.9, 0.0], 0.7, 2.0)),
        ("glass", glass),
    ];
    all_agree("glass ball of fog", &scene(&parts), Kind { smooth: true, ..LAMP_IN_VIEW }, 128);
}

#[test]
fn behind_a_thin_pane_in_fog() {
    let pane = json!({
        "type": "rectangle", "to_world": place([0.8, 0.8, 1.0], [0.0, 0.0, 0.2]),
        "bsdf": {"type": "thindielectric"},
    });
    let mut parts = foggy_room(medium(0.7, 0.8, 0.3));
    parts.push(("pane", pane));
    all_agree("thin pane", &scene(&parts), Kind { smooth: true, ..LAMP_IN_VIEW }, 128);
}

#[test]
fn with_rough_metal_in_fog() {
    let ball = json!({
        "type": "sphere", "center": [-0.3, -0.4, -0.3], "radius": 0.5,
        "bsdf": {"type": "roughconductor", "material": "Au", "alpha": 0.3},
    });
    let mut parts = foggy_room(medium(0.5, 0.8, 0.0));
    parts.push(("ball", ball));
    all_agree("rough metal", &scene(&parts), LAMP_IN_VIEW, 128);
}

#[test]
fn under_emitters_of_every_kind() {
    let parts = [
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(medium(1.2, 0.9, 0.3)))),
        ("sky", sky(0.1)),
        ("sun", sun([0.3, -1.0, -0.2], 0.6)),
        ("point", point([1.2, 0.8, 0.5], rgb(1.0, 0.5, 0.5))),
        ("spot", spot([-1.2, 1.4, 0.8], [0.0, 0.0, 0.0], rgb(2.0, 4.0, 2.0))),
        ("lamp", lamp_panel([0.0, 1.2, 0.0], 0.4, rgb(1.0, 1.0, 2.0))),
    ];
    all_agree("every kind", &scene(&parts), Kind { points: true, ..LAMP_IN_VIEW }, 128);
}

#[test]
fn with_points_alone_in_fog() {
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.5, Some(medium(0.8, 0.9, 0.5)))),
        ("point", point([0.4, 0.5, -0.2], 0.5)),
        ("spot", spot([-0.6, 0.6, 0.2], [0.2, -0.5, -0.6], 2.0)),
    ];
    all_agree("points in fog", &scene(&parts), Kind { points: true, ..Kind::default() }, 128);
}

/// Each lights its surroundings most.
#[test]
fn under_a_hundred_lamps() {
    let names: Vec<String> = (0..100).map(|i| format!("lamp{i}")).collect();
    let lamp = |i: usize| {
        let [x, z] = [i % 10, i / 10].map(|n| 0.2 * n as f64 - 0.9);
        lamp_ball([x, 0.8, z], 0.02, rgb(30.0, 20.0, 10.0 * (i % 3) as f64))
    };
    let mut parts = vec![
        ("sensor", camera([0.0, -0.2, 0.9], [0.0, -0.3, -1.0], 8)),
        ("room", room(0.6, Some(medium(0.8, 0.9, 0.3)))),
        ("point", point([0.4, 0.5, -0.2], 0.5)),
    ];
    parts.extend(names.iter().enumerate().map(|(i, name)| (name.as_str(), lamp(i))));
    all_agree("a hundred lamps", &scene(&parts), Kind { points: true, ..Kind::default() }, 96);
}

/// The same view by another sensor.
fn through(sensor: &str, more: &[(&str, Value)], view: Value) -> Value {
    with(with(view, &[("type", json!(sensor))]), more)
}

#[test]
fn through_a_lens() {
    let view = camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8);
    let lens = through("thinlens", &[("aperture_radius", json!(0.1)), ("focus_distance", json!(1.2))], view);
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts[0].1 = lens;
    all_agree("thin lens", &scene(&parts), LAMP_IN_VIEW, 96);
}

#[test]
fn by_parallel_rays() {
    let view = json!([{"type": "scale", "value": [0.7, 0.7, 1]},
        {"type": "lookat", "origin": [0.1, 0.4, 3.5], "target": [0, 0, 0], "up": [0, 1, 0]}]);
    let sensor =
        with(camera([0.0, 0.5, 3.5], [0.0; 3], 8), &[("type", json!("orthographic")), ("to_world", view)]);
    let Value::Object(mut sensor) = sensor else { unreachable!() };
    sensor.remove("fov");
    let smoke = medium(1.5, 0.9, 0.4);
    let mut parts = vec![
        ("sensor", Value::Object(sensor)),
        ("smoke", null_box([-0.5; 3], [0.5; 3], Some(smoke))),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("lamp", lamp_ball([0.5, 0.7, 0.2], 0.15, rgb(9.0, 7.0, 5.0))),
    ];
    all_agree("orthographic", &scene(&parts), LAMP_IN_VIEW, 128);
    // What is seen of the sky lies in one direction, as if in a mirror.
    parts.push(("sky", sky(0.3)));
    all_agree("orthographic, sky", &scene(&parts), Kind { smooth: true, ..LAMP_IN_VIEW }, 128);
}

#[test]
fn under_lights_of_special_kinds() {
    let panel = with(
        lamp_panel([0.0, 0.9, -0.2], 0.3, 1.0),
        &[(
            "emitter",
            json!({"type": "area", "profile": "0:1 40:0.6 70:0",
               "radiance": {"type": "checkerboard", "color0": 8, "color1": 2}}),
        )],
    );
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts[3] = ("lamp", panel);
    parts.push(("bulb", json!({"type": "point", "intensity": 0.5, "profile": "0:1 90:0.2 150:0",
        "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 60}, {"type": "translate", "value": [-0.5, 0.2, 0]}]})));
    parts.push(("slides", json!({"type": "projector", "fov": 50, "scale": 0.3,
        "irradiance": {"type": "checkerboard", "color0": 3, "color1": {"type": "rgb", "value": [1, 0, 0]}},
        "to_world": [{"type": "lookat", "origin": [0.6, 0.3, 0.5], "target": [0, -0.5, -0.5], "up": [0, 1, 0]}]})));
    all_agree("profiles, projector", &scene(&parts), Kind { points: true, ..LAMP_IN_VIEW }, 128);
}

/// Smoke that varies, in a box with a ball inside, seen from outside or (`inside`) from within.
fn smoky(sigma_t: Value, albedo: Value, tracker: &str, inside: bool) -> Value {
    let smoke = json!({"type": "heterogeneous", "tracker": tracker, "scale": 2, "sigma_t": sigma_t,
                       "albedo": albedo, "phase": {"type": "hg", "g": 0.3}});
    let eye = if inside { [0.3, 0.1, 0.6] } else { [0.0, 0.6, 3.2] };
    let ball = lamp_ball([0.2, -0.1, 0.1], 0.2, rgb(0.5, 0.3, 0.1));
    scene(&[
        ("sensor", camera(eye, [0.0, 0.0, -0.3], 8)),
        ("floor", floor(-0.9, 2.0, 0.5)),
        ("smoke", null_box([-0.8, -0.8, -0.8], [0.8, 0.8, 0.8], Some(smoke))),
        ("ball", ball),
        ("lamp", lamp_panel([-1.0, 1.6, 0.5], 0.6, 4.0)),
        ("sky", sky(rgb(0.3, 0.4, 0.6))),
    ])
}

/// A density with an integral in closed form, and one without.
fn fogs() -> [(&'static str, Value); 2] {
    let waves = json!({"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [4, 2, 1]}});
    let height = json!({"type": "exponential", "height": -0.8, "scale_height": 0.8, "value": 1.5});
    [("waves", waves.clone()), ("waves below", json!({"type": "product", "a": waves, "b": height}))]
}

#[test]
fn in_smoke_that_varies_by_every_tracker() {
    for (name, fog) in fogs() {
        for tracker in ["closed_form", "march", "null_collision", "residual_ratio"] {
            if tracker == "closed_form" && name != "waves" {
                continue;
            }
            let scene = smoky(fog.clone(), json!(0.8), tracker, false);
            all_agree(&format!("{name} by {tracker}"), &scene, LAMP_IN_VIEW, 48);
        }
    }
}

/// Forward where it is dense of drops, backward elsewhere, and a blend in that which varies too.
#[test]
fn in_fog_whose_phase_function_varies() {
    let wave = |x: f64, y: f64| {
        json!({"type": "cosine", "constant": 0.5,
        "a": {"type": "wave", "amplitude": 0.5, "vector": [x, y, 2]}})
    };
    let hg = |g: f64| json!({"type": "hg", "g": g});
    let inner =
        json!({"type": "blendphase", "weight": wave(0.0, 4.0), "a": hg(-0.7), "b": {"type": "rayleigh"}});
    let phase = json!({"type": "blendphase", "weight": wave(5.0, 1.0), "a": hg(0.7), "b": inner});
    let fog = with(medium(1.0, 0.8, 0.0), &[("phase", phase)]);
    all_agree("blend that varies", &scene(&foggy_room(fog)), LAMP_IN_VIEW, 64);
}

#[test]
fn within_chromatic_smoke_that_varies() {
    let [(_, waves), _] = fogs();
    let colours =
        json!({"type": "product", "a": {"type": "constvolume", "value": rgb(0.3, 1.0, 2.5)}, "b": waves});
    let albedo = json!({"type": "cosine", "constant": 0.6, "a": {"type": "wave", "amplitude": 0.3, "vector": [0, 5, 3]}});
    for tracker in ["closed_form", "null_collision", "residual_ratio"] {
        for inside in [false, true] {
            let scene = smoky(colours.clone(), albedo.clone(), tracker, inside);
            // From within, a vertex next to the lens counts 1/d^2: without the camera subpaths that meet the same
            // light, a dozen images do not show their own error.
            let kind = Kind { smooth: inside, ..LAMP_IN_VIEW };
            all_agree(&format!("colours by {tracker}, inside {inside}"), &scene, kind, 64);
        }
    }
}

/// The fog is all there is around the scene, as far as its box reaches.
#[test]
fn in_fog_around_everything_under_a_sky() {
    let mist = json!({"type": "heterogeneous", "albedo": 0.9, "scale": 0.5, "id": "mist",
        "sigma_t": {"type": "exponential", "scale_height": 0.7, "min": [-2, -1, -2], "max": [2, 3, 2]}});
    let parts = [
        ("sensor", with(camera([0.0, 0.2, 1.5], [0.0, 0.0, 0.0], 8), &[("medium", named("mist"))])),
        ("mist", mist),
        ("floor", floor(-0.6, 1.0, 0.5)),
        ("sky", sky(rgb(0.3, 0.4, 0.6))),
        ("sun", sun([0.3, -1.0, 0.2], 2.0)),
    ];
    all_agree("mist", &scene(&parts), Kind { points: true, ..LAMP_IN_VIEW }, 96);
}

/// A medium that also shines.
fn glowing(medium: Value, radiance: Value) -> Value {
    with(medium, &[("radiance", radiance)])
}

#[test]
fn in_fog_that_glows() {
    let fog = glowing(medium(1.0, 0.6, 0.3), rgb(1.0, 0.5, 0.2));
    all_agree("glowing fog", &scene(&foggy_room(fog)), LAMP_IN_VIEW, 64);
}

#[test]
fn before_a_fire_beside_a_lamp() {
    let fire = json!({"type": "heterogeneous", "scale": 3, "albedo": 0.6,
        "sigma_t": {"type": "exponential", "height": -0.8, "scale_height": 0.5},
        "emission": {"type": "exponential", "height": -0.8, "scale_height": 0.2, "value": 20}});
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, None)),
        ("lamp", lamp_panel([0.0, 0.95, 0.0], 0.3, 3.0)),
        ("fire", null_ball([0.0, -0.4, -0.3], 0.5, fire)),
    ];
    all_agree("fire", &scene(&parts), LAMP_IN_VIEW, 96);
}

#[test]
fn around_a_chromatic_fire_by_null_collisions() {
    let fire = json!({"type": "heterogeneous", "tracker": "null_collision", "scale": 2, "albedo": 0.7,
        "sigma_t": {"type": "product", "a": {"type": "constvolume", "value": rgb(0.5, 1.0, 2.0)},
                    "b": {"type": "exponential", "height": -0.5, "scale_height": 0.5}},
        "radiance": {"type": "exponential", "height": -0.5, "scale_height": 0.3}});
    let parts = [
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 8)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("fire", null_box([-0.5, -0.5, -0.5], [0.5, 0.7, 0.5], Some(fire))),
        ("point", point([1.2, 0.8, 0.5], 0.3)),
    ];
    all_agree("chromatic fire", &scene(&parts), Kind { points: true, ..LAMP_IN_VIEW }, 128);
}

#[test]
fn around_a_glass_ball_that_glows() {
    let glass = json!({
        "type": "sphere", "center": [0, -0.2, -0.2], "radius": 0.6,
        "bsdf": {"type": "dielectric", "int_ior": 1.5}, "interior": glowing(medium(2.0, 0.8, 0.3), json!(3)),
    });
    let parts = [
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.5, None)),
        ("glass", glass),
    ];
    all_agree("glowing glass ball", &scene(&parts), Kind { smooth: true, ..LAMP_IN_VIEW }, 128);
}

/// Light that leaves along a normal only: what no camera subpath can find, light subpaths bring, by either strategy.
#[test]
fn under_a_beam() {
    let mut parts = foggy_room(medium(1.0, 0.8, 0.3));
    parts[3] = (
        "lamp",
        with(
            lamp_panel([0.0, 0.9, -0.2], 0.2, 1.0),
            &[("emitter", json!({"type": "directionalarea", "radiance": 5}))],
        ),
    );
    let stage = Stage::new(&scene(&parts));
    let render = |names: &str, first: u64| {
        Sample::of(&stage.renders(strategies(names), 128, first..first + SEEDS), stage.width())
    };
    let all = render("hit+next-event+join+lens", 0);
    let mut claims = Claims::new();
    claims.equal("beam: lens alone", &render("lens", 1000), &all);
    claims.equal("beam: hit, next event, lens", &render("hit+next-event+lens", 2000), &all);
    claims.settle();
}

/// What a study says of sets of strategies is what these tests know of them.
#[test]
fn paths_out_of_reach_are_told_of_every_set_that_does_not_cover() {
    let room = || foggy_room(medium(1.0, 0.8, 0.3));
    let with_part = |name, part| [&room()[..], &[(name, part)]].concat();
    let smooth = Kind { smooth: true, ..LAMP_IN_VIEW };
    let mirror = with(floor(-0.6, 0.5, 0.5), &[("bsdf", json!({"type": "conductor"}))]);
    let view = json!([{"type": "lookat", "origin": [0, 1, 3], "target": [0, 0, 0], "up": [0, 1, 0]}]);
    let sky_alone = [
        ("sensor", json!({"type": "orthographic", "to_world": view})),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("sky", sky(0.5)),
    ];
    let points = [
        ("sensor", room()[0].1.clone()),
        ("room", common::pieces::room(0.6, None)),
        ("p", point([0.0; 3], 1.0)),
    ];
    for (scene, kind) in [
        (scene(&room()), LAMP_IN_VIEW),
        (scene(&with_part("integrator", json!({"type": "bdpt", "hide_emitters": true}))), Kind::default()),
        (scene(&with_part("p", point([0.0; 3], 1.0))), Kind { points: true, ..LAMP_IN_VIEW }),
        (scene(&points), Kind { points: true, ..Kind::default() }),
        (scene(&with_part("mirror", mirror)), smooth),
        (scene(&sky_alone), smooth),
    ] {
        let stage = Stage::new(&scene);
        let reach = |set: Strategies| {
            let options = Options { strategies: set, ..stage.setup.integrator.options };
            coverage::unreached(&stage.setup.scene, &options)
        };
        for set in (1..16).map(|set: u32| [1, 2, 4, 8].map(|bit| set & bit > 0)) {
            let [emitter_hit, next_event, connection, lens] = set;
            let set = Strategies { emitter_hit, next_event, connection, lens, ..Strategies::NONE };
            let missing = reach(set);
            assert_eq!(missing.is_empty(), covers(set, kind), "{}: {missing:?} {scene}", name_of(set));
        }
    }
}
