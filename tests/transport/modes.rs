//! Integrators that do less: the preview `fog` against BMA02 eq. 5 by hand, `single_scattering` against quadrature
//! (P03 eq. 18-19), `non_scattering` against Beer and Lambert (P03T eq. 2.9); and scenes at other times.

use crate::common::{self, Stage, pieces::*};
use serde_json::{Value, json};
use std::f64::consts::PI;
use tyndall::{
    math::{RaySegment, Spectrum, Vec3},
    passes::{Settings, budget::Budget},
    render,
    sampling::Sampler,
    transport::{Heuristic, Options, Strategies},
};

/// The near clip distance of `view`.
const NEAR: f64 = 1e-3;

/// Parallel rays down from z = 5 through the middle of the scene, all but the same ray.
fn view() -> Value {
    json!({
        "type": "orthographic", "near_clip": NEAR,
        "to_world": [
            {"type": "scale", "value": [1e-3, 1e-3, 1.0]},
            {"type": "lookat", "origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]},
        ],
        "film": {"type": "hdrfilm", "width": 8, "height": 8, "rfilter": {"type": "box"}},
    })
}

/// The box [-1, 1]^3 of `medium`, behind which nothing is refracted.
fn cloud(medium: Value) -> Value {
    null_box([-1.0; 3], [1.0; 3], Some(medium))
}

fn heterogeneous(sigma_t: Value, albedo: Value) -> Value {
    json!({"type": "heterogeneous", "sigma_t": sigma_t, "albedo": albedo})
}

/// One value in the box of `cloud`.
fn even(value: impl Into<Value>) -> Value {
    let place = json!([{"type": "scale", "value": 2}, {"type": "translate", "value": [-1, -1, -1]}]);
    json!({"type": "constvolume", "value": value.into(), "to_world": place})
}

/// 1 + 0.5 cos(2 z).
fn wave() -> Value {
    json!({"type": "cosine", "wave": {"type": "wave", "amplitude": 0.5, "vector": [0, 0, 2]}})
}

fn wave_at(z: f64) -> f64 {
    1.0 + 0.5 * (2.0 * z).cos()
}

/// The integral of `of` from `low` to `high` by the midpoint rule.
fn integral(low: f64, high: f64, of: impl Fn(f64) -> f64) -> f64 {
    let n = 4000;
    let step = (high - low) / f64::from(n);
    (0..n).map(|i| of(low + (f64::from(i) + 0.5) * step)).sum::<f64>() * step
}

/// A wall at z = -2 that faces the camera.
fn wall(more: &[(&str, Value)]) -> Value {
    let at = json!([{"type": "translate", "value": [0, 0, -2]}]);
    with(json!({"type": "rectangle", "to_world": at}), more)
}

fn fog(more: &[(&str, Value)]) -> Value {
    with(json!({"type": "fog", "fog_color": rgb(0.1, 0.4, 0.9)}), more)
}

const FOG: Spectrum = Spectrum::new(0.1, 0.4, 0.9);

/// The preview of a scene, as its integrator describes it.
fn preview(scene: &Value) -> Vec<Spectrum> {
    let Stage { setup, profile, film_samples } = Stage::new(scene);
    let options = Options { heuristic: Heuristic::Balance, max_depth: None, ..setup.integrator.options };
    let budget = Budget::samples(2);
    let settings = Settings { options, sampler: Sampler::default(), film_samples, budget, seed: 1, profile };
    render::preview(&setup, &setup.film, &settings, &setup.integrator.fog, &[], &mut |_| {}).unwrap().pixels
}

/// Every pixel of the preview is `expected`, within a relative `error`.
fn shows(parts: &[(&str, Value)], expected: Spectrum, error: f32) {
    for pixel in preview(&scene(&[&[("sensor", view())], parts].concat())) {
        let off = ((pixel - expected) / expected).abs().max_element();
        assert!(off < error, "{pixel} where {expected} is right: {parts:?}");
    }
}

fn blend(depth: Spectrum, behind: Spectrum) -> Spectrum {
    let through = Spectrum::new((-depth.x).exp(), (-depth.y).exp(), (-depth.z).exp());
    through * behind + (Spectrum::ONE - through) * FOG
}

#[test]
fn a_lit_wall_fades_into_the_fog() {
    let reflectance = Spectrum::new(0.2, 0.5, 0.8);
    // The sun stands at a cosine of 0.8.
    let behind = reflectance * (Spectrum::new(3.0, 2.0, 1.0) * (0.8 / PI as f32) + 0.25);
    let lit = [
        ("sun", sun([0.0, 0.6, -0.8], rgb(3.0, 2.0, 1.0))),
        ("wall", wall(&[("bsdf", diffuse(rgb(0.2, 0.5, 0.8)))])),
        ("integrator", fog(&[("ambient", json!(0.25))])),
    ];
    let through = |medium: Value| [&[("cloud", cloud(medium))], &lit[..]].concat();
    let sigma_t = rgb(0.1, 0.5, 1.2);
    let depth = Spectrum::new(0.2, 1.0, 2.4);
    shows(&lit, behind, 1e-4);
    shows(&through(medium(sigma_t.clone(), 0.9, 0.3)), blend(depth, behind), 1e-4);
    shows(&through(heterogeneous(even(sigma_t), json!(0.9))), blend(depth, behind), 1e-4);
    let depth = integral(-1.0, 1.0, wave_at);
    shows(&through(heterogeneous(wave(), json!(0.9))), blend(Spectrum::splat(depth as f32), behind), 1e-4);
    // No closed form is known of this one: its stand-in is as good as its cells are small.
    let squared = json!({"type": "product", "a": wave(), "b": wave()});
    let depth = integral(-1.0, 1.0, |z| wave_at(z).powi(2));
    shows(&through(heterogeneous(squared, json!(0.9))), blend(Spectrum::splat(depth as f32), behind), 1e-2);
}

#[test]
fn lamps_and_skies_fade_too_and_are_hidden_where_asked() {
    let medium = cloud(medium(0.6, 0.9, 0.0));
    let depth = Spectrum::splat(1.2);
    let lamp = wall(&[("emitter", json!({"type": "area", "radiance": 5}))]);
    let sky = sky(rgb(1.0, 2.0, 3.0));
    let (shown, hidden) = (fog(&[]), fog(&[("hide_emitters", json!(true))]));
    let lamp_and = |integrator: &Value| {
        [("c", medium.clone()), ("lamp", lamp.clone()), ("integrator", integrator.clone())]
    };
    let sky_and = |integrator: &Value| {
        [("c", medium.clone()), ("sky", sky.clone()), ("integrator", integrator.clone())]
    };
    shows(&lamp_and(&shown), blend(depth, Spectrum::splat(5.0)), 1e-4);
    shows(&lamp_and(&hidden), blend(depth, Spectrum::ZERO), 1e-4);
    shows(&sky_and(&shown), blend(depth, Spectrum::new(1.0, 2.0, 3.0)), 1e-4);
    shows(&sky_and(&hidden), blend(depth, Spectrum::ZERO), 1e-4);
    // Without a colour of its own the fog has the sky's, and so has the picture.
    let own = [("c", medium.clone()), ("sky", sky.clone()), ("integrator", json!({"type": "fog"}))];
    shows(&own, Spectrum::new(1.0, 2.0, 3.0), 1e-4);
    // A white wall under the sky is as bright as it; it needs no samples for that.
    let white = wall(&[("bsdf", diffuse(1.0))]);
    let own = [("wall", white), ("sky", sky.clone()), ("integrator", json!({"type": "fog"}))];
    shows(&own, Spectrum::new(1.0, 2.0, 3.0), 1e-4);
}

/// A small cube of glow, three metres before the wall, lights it as its power does from a point; so does the other lamp.
#[test]
fn every_lamp_counts_once_whatever_its_kind() {
    let glow = json!({"type": "homogeneous", "sigma_t": 0, "emission": 62500});
    let ember = null_box([-0.01, -0.01, 0.99], [0.01, 0.01, 1.01], Some(glow));
    let parts = [
        ("ember", ember),
        ("lamp", point([0.0, 0.0, 1.0], 0.5)),
        ("wall", wall(&[("bsdf", diffuse(0.6))])),
        ("i", fog(&[("ambient", json!(0)), ("threshold", json!(50))])),
    ];
    // Intensities add up: gain times volume, [W/sr]; the ember itself is no surface.
    let expected = 0.6 / PI * (0.5 + 62500.0 * 0.02f64.powi(3)) / 9.0;
    shows(&parts, Spectrum::splat(expected as f32), 2e-2);
}

#[test]
fn beyond_the_threshold_there_is_fog_alone() {
    let lamp = wall(&[("emitter", json!({"type": "area", "radiance": 5}))]);
    let far = |threshold: f64| fog(&[("threshold", json!(threshold))]);
    let medium = cloud(medium(0.6, 0.9, 0.0));
    let depth = Spectrum::splat(1.2);
    for (threshold, expected) in [
        (6.0 + 1.0 - NEAR + 0.01, blend(depth, Spectrum::splat(5.0))),
        (6.0 + 1.0 - NEAR - 0.01, FOG),
        // Its end is before, within, and just behind the cloud.
        (3.0, FOG),
        (4.5, FOG),
        (6.2, FOG),
    ] {
        shows(&[("c", medium.clone()), ("lamp", lamp.clone()), ("i", far(threshold))], expected, 1e-4);
    }
    shows(&[("sky", sky(2.0)), ("i", far(100.0))], FOG, 1e-6);
}

#[test]
fn a_preview_sees_through_glass_and_in_mirrors() {
    let lamp = wall(&[("emitter", json!({"type": "area", "radiance": 5}))]);
    let pane = |bsdf: Value| {
        let at = json!([{"type": "translate", "value": [0, 0, 2]}]);
        json!({"type": "rectangle", "to_world": at, "bsdf": bsdf})
    };
    let glass = json!({"type": "mask", "opacity": 0.0, "b": diffuse(0.5)});
    shows(&[("lamp", lamp.clone()), ("pane", pane(glass)), ("i", fog(&[]))], Spectrum::splat(5.0), 1e-4);
    // A perfect mirror shows the sky behind the camera.
    let mirror = json!({"type": "conductor", "material": "none"});
    let parts = [("lamp", lamp), ("sky", sky(0.5)), ("pane", pane(mirror)), ("i", fog(&[]))];
    shows(&parts, Spectrum::splat(0.5), 1e-4);
}

/// The mean of several renders is `expected`, channel by channel, within 4 standard errors.
fn estimates(scene: &Value, strategies: Strategies, samples: u64, expected: [f64; 3]) {
    let stage = Stage::new(scene);
    let images: Vec<Vec<Spectrum>> = stage.renders(strategies, samples, 0..16);
    for channel in 0..3 {
        let mean = |image: &Vec<Spectrum>| {
            image.iter().map(|pixel| f64::from(pixel[channel])).sum::<f64>() / image.len() as f64
        };
        let means: Vec<f64> = images.iter().map(mean).collect();
        let n = means.len() as f64;
        let all = means.iter().sum::<f64>() / n;
        let error = (means.iter().map(|m| (m - all).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt();
        let z = (all - expected[channel]) / (error + 1e-6 * all);
        assert!(z.abs() < 4.0 && error < 0.02 * all, "{all} +- {error}, right is {}", expected[channel]);
    }
}

/// Light of a point of `intensity` at (x, 0, 0), scattered once on the z axis from `low` to `high` by a medium of
/// extinction `sigma_t` along z, which ends at `high` towards the camera; it is even where light comes from.
fn scattered_once(
    x: f64,
    intensity: f64,
    [low, high]: [f64; 2],
    albedo: f64,
    g: f64,
    sigma_t: impl Fn(f64) -> f64 + Copy,
) -> f64 {
    integral(low, high, |z| {
        let d2 = x * x + z * z;
        let cosine = z / d2.sqrt();
        let phase = (1.0 - g * g) / (4.0 * PI * (1.0 + g * g - 2.0 * g * cosine).powf(1.5));
        let n = 200;
        let mean = |a: f64, b: f64| {
            (0..n).map(|i| sigma_t(a + (b - a) * (f64::from(i) + 0.5) / f64::from(n))).sum::<f64>()
                / f64::from(n)
        };
        let depth = mean(0.0, z) * d2.sqrt() + mean(z, high) * (high - z);
        albedo * sigma_t(z) * phase * intensity / d2 * (-depth).exp()
    })
}

fn once(more: &[(&str, Value)]) -> Value {
    with(json!({"type": "single_scattering"}), more)
}

#[test]
fn light_is_scattered_once_in_fog_without_end() {
    let sensor = with(view(), &[("medium", medium(0.4, 0.6, 0.3))]);
    let parts = [("sensor", sensor), ("lamp", point([0.7, 0.0, 0.0], 10.0)), ("i", once(&[]))];
    let expected = scattered_once(0.7, 10.0, [-60.0, 5.0 - NEAR], 0.6, 0.3, |_| 0.4);
    estimates(&scene(&parts), Strategies::PT, 400, [expected; 3]);
}

#[test]
fn light_is_scattered_once_in_marched_media() {
    let volumes = [(even(0.8), 0.3), (wave(), 0.01)];
    let truths: [fn(f64) -> f64; 2] = [|_| 0.8, wave_at];
    for ((volume, step), sigma_t) in volumes.into_iter().zip(truths) {
        let medium = with(heterogeneous(volume, json!(0.6)), &[("p", json!({"type": "hg", "g": -0.4}))]);
        let parts = [
            ("sensor", view()),
            ("cloud", cloud(medium)),
            ("lamp", point([0.5, 0.0, 0.0], 10.0)),
            ("i", once(&[("step", json!(step))])),
        ];
        let expected = scattered_once(0.5, 10.0, [-1.0, 1.0], 0.6, -0.4, sigma_t);
        estimates(&scene(&parts), Strategies::PT, 400, [expected; 3]);
    }
}

/// It is path tracing of two segments, bit for bit where nothing is marched.
#[test]
fn single_scattering_is_a_restriction() {
    let room = |integrator: Value| {
        scene(&[
            ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
            ("fog", medium(1.0, 0.8, 0.3)),
            ("room", room(0.6, Some(named("fog")))),
            ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, 2.0)),
            ("integrator", integrator),
        ])
    };
    let path = room(json!({"type": "volpath", "max_depth": 2}));
    let image = |scene: &Value| common::render(scene, Strategies::PT, 4, 1);
    assert_eq!(image(&room(once(&[]))), image(&path));
    assert_ne!(image(&room(json!({"type": "volpath"}))), image(&path));
    let direct = room(once(&[("max_depth", json!(1))]));
    assert_eq!(image(&direct), image(&room(json!({"type": "volpath", "max_depth": 1}))));
}

#[test]
fn media_without_scattering_obey_beer_and_lambert() {
    let seen_through = |medium: Value, depth: [f64; 3]| {
        let parts = [
            ("sensor", view()),
            ("cloud", cloud(medium)),
            ("sky", sky(2.0)),
            ("i", json!({"type": "non_scattering"})),
        ];
        let expected = depth.map(|depth| 2.0 * (-depth).exp());
        for strategies in [Strategies::PT, Strategies::BDPT] {
            estimates(&scene(&parts), strategies, 100, expected);
        }
    };
    let (sigma_t, albedo) = (rgb(2.0, 1.0, 0.5), rgb(0.75, 0.5, 0.25));
    // Twice sigma_t (1 - albedo).
    let depth = [1.0, 1.0, 0.75];
    seen_through(medium(sigma_t.clone(), albedo.clone(), 0.5), depth);
    seen_through(heterogeneous(even(sigma_t), even(albedo)), depth);
    seen_through(heterogeneous(even(2.0), json!(0.75)), [1.0; 3]);
    // An albedo of 0.5 + 0.25 cos(2 z), with extinction that varies too.
    let half = with(wave(), &[("value", json!(0.5))]);
    let depth = integral(-1.0, 1.0, |z| wave_at(z) * (1.0 - 0.5 * wave_at(z)));
    seen_through(heterogeneous(wave(), half.clone()), [depth; 3]);
    // A tracker that the scene asks for and that does not fit what is left gives way.
    let requested = with(heterogeneous(wave(), half), &[("tracker", json!("closed_form"))]);
    seen_through(requested, [depth; 3]);
}

#[test]
fn surfaces_scatter_where_media_do_not() {
    let parts = [
        ("sensor", view()),
        ("cloud", cloud(medium(2.0, 0.75, 0.0))),
        ("wall", wall(&[("bsdf", diffuse(0.5))])),
        ("sun", sun([0.0, 0.6, -0.8], 3.0)),
        ("i", json!({"type": "non_scattering"})),
    ];
    // The sun's light enters and leaves the cloud beside the camera's ray, which meets the wall at (0, 0, -2): it
    // crosses z = -1 at y = 0.75 and y = 1 at z = -2 + 4/3 = -2/3.
    let inside = (1.0 - 0.75) / 0.6;
    let expected = 0.5 / PI * 3.0 * 0.8 * (-0.5 * (inside + 2.0f64)).exp();
    estimates(&scene(&parts), Strategies::PT, 400, [expected; 3]);
}

/// A cloud that drifts is where a still one would be that was put there.
#[test]
fn a_scene_at_another_time_is_the_scene_of_that_time() {
    let blob = |more: &[(&str, Value)]| {
        let ball =
            json!({"type": "equipotential", "shape": "point", "center": [0.1, 0, 0], "c": 0.2, "d": 3.0});
        with(ball, more)
    };
    let drifting = json!({"type": "wind", "velocity": [0.25, -0.5, 0.0], "a": blob(&[])});
    let moved = json!([{"type": "translate", "value": [0.5, -1.0, 0.0]}]);
    let of_time = |volume: Value, time: f64| {
        let sum = json!({"type": "sum", "a": volume, "b": {"type": "exponential", "value": 0.2}});
        let parts = [("sensor", view()), ("cloud", cloud(heterogeneous(sum, json!(0.5)))), ("sky", sky(1.0))];
        Stage::new(&scene(&[&parts[..], &[("time", json!(time))]].concat())).setup.scene
    };
    let of = |volume: Value| of_time(volume, 0.0);
    let (mut later, there, now) = (of(drifting), of(blob(&[("to_world", moved)])), of(blob(&[])));
    let depths = |scene: &tyndall::scene::Scene| -> Vec<f32> {
        let varying = scene.media[1].heterogeneous().unwrap();
        let segment = |i: u16| {
            let (a, b) = (Vec3::new(0.1 * f32::from(i) - 1.0, -1.5, -4.0), Vec3::new(0.3, 1.2, -6.0));
            RaySegment { origin: a, direction: (b - a).normalize(), length: a.distance(b) }
        };
        (0..20).map(|i| varying.depth::<f32>(&segment(i))).collect()
    };
    let close = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-4 * b.abs());
    let still = depths(&now);
    assert!(still.iter().all(|depth| *depth > 0.0));
    assert!(close(&depths(&later), &still));
    assert!(later.set_time(2.0).unwrap());
    assert!(close(&depths(&later), &depths(&there)) && !close(&depths(&later), &still));
    assert!(later.set_time(0.0).unwrap());
    assert!(close(&depths(&later), &still));
    // Built at another time, it comes back to where it was at 0.
    let drifting = json!({"type": "wind", "velocity": [0.25, -0.5, 0.0], "a": blob(&[])});
    let mut late = of_time(drifting, 2.0);
    assert!(close(&depths(&late), &depths(&there)));
    assert!(late.set_time(0.0).unwrap());
    assert!(close(&depths(&late), &still));
    let mut unmoved = now;
    assert!(!unmoved.set_time(2.0).unwrap());
}

/// Grids drift without being read again, and keep their exact tracker.
#[test]
fn a_grid_drifts() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/scenes/crosscheck/assets/smoke.vol");
    let turn = json!({"type": "rotate", "axis": [1, 2, 3], "angle": 40});
    let step = json!({"type": "translate", "value": [0.5, -1.0, 0.25]});
    let grid = |steps: Vec<Value>| json!({"type": "gridvolume", "filename": file, "to_world": steps});
    let of = |volume: Value| {
        let medium = with(heterogeneous(volume, json!(0.5)), &[("tracker", json!("exact"))]);
        let parts = [("sensor", view()), ("cloud", cloud(medium)), ("sky", sky(1.0))];
        Stage::new(&scene(&parts)).setup.scene
    };
    let wind = json!({"type": "wind", "velocity": [1, -2, 0.5], "a": grid(vec![turn.clone()])});
    let (mut later, there) = (of(wind), of(grid(vec![turn, step])));
    assert!(later.set_time(0.5).unwrap());
    let [a, b] = [&later, &there].map(|scene| scene.media[1].heterogeneous().unwrap());
    let bounds = |scene: &tyndall::scene::Scene| {
        let extinction = scene.media[1].heterogeneous().unwrap().extinction();
        (extinction.low, extinction.high)
    };
    let ((low, high), (still_low, still_high)) = (bounds(&later), bounds(&there));
    assert!((low - still_low).abs().max_element() < 1e-5 && (high - still_high).abs().max_element() < 1e-5);
    let mut seen = 0;
    for i in 0..64u8 {
        let u = |bits: u8| f32::from(i >> bits & 3) / 3.0;
        let (from, to) = (low + (high - low) * Vec3::new(u(0), u(2), u(4)), low.midpoint(high));
        let length = from.distance(to);
        let segment = RaySegment { origin: from, direction: (to - from) / length, length };
        let (found, expected): (f32, f32) = (a.depth(&segment), b.depth(&segment));
        assert!((found - expected).abs() <= 1e-3 * expected + 1e-6, "{found} {expected}");
        let at = from.lerp(to, 0.9);
        let (found, expected): (Spectrum, Spectrum) = (a.extinction().at(at), b.extinction().at(at));
        assert!((found - expected).abs().max_element() <= 1e-3, "{found} {expected}");
        seen += usize::from(expected.x > 0.0);
    }
    assert!(seen > 16, "the sections miss the smoke");
}
