//! First passes against closed forms, and against each other.

use super::{ELEMENTS, elements::Elements, links, particles, point::Point};
use crate::{
    format,
    guide::{distribution::Distribution, hierarchy::Node},
    math::{DVec3, Spectrum, Vec3},
    scene::{Scene, build},
    settings::Overrides,
};

fn scene(parts: &str) -> Scene {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, format!(r#"{{"type": "scene", "camera": {{"type": "perspective"}}, {parts}}}"#))
        .unwrap();
    build::build(&format::read(&file, &[]).unwrap(), Overrides::default()).unwrap().scene
}

/// Where a node is in the file.
fn place(scene: &Scene, node: &Node) -> DVec3 {
    node.centre().as_dvec3() + scene.recentre
}

/// The mean over elements above the plane of the lamp, by their measure.
fn mean(scene: &Scene, elements: &Elements, values: &[Distribution], towards: Vec3) -> f64 {
    let of = elements.hierarchy.elements.iter().zip(values).filter_map(|(node, value)| {
        let node = &elements.hierarchy.nodes[*node as usize];
        let measure = f64::from(node.measure.x);
        (place(scene, node).z > 1e-3).then(|| (measure * f64::from(value.at(towards).x), measure))
    });
    let (sum, measure) = of.fold((0.0, 0.0), |all, (value, measure)| (all.0 + value, all.1 + measure));
    sum / measure
}

/// Two unit squares, one apart or along a common edge: of what one sends the other gets its form factor (Howell's catalogue, C-11 and C-14).
#[test]
fn squares_get_their_form_factors() {
    const LAMP: &str = r#""lamp": {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.5}],
        "emitter": {"type": "area", "radiance": 1}}"#;
    let wall = |place: &str| {
        format!(
            r#"{LAMP}, "wall": {{"type": "rectangle", "to_world": [{{"type": "scale", "value": 0.5}}, {place}],
            "bsdf": {{"type": "twosided", "bsdf": {{"type": "diffuse", "reflectance": 0.8}}}}}}"#
        )
    };
    let opposite = wall(r#"{"type": "translate", "value": [0, 0, 1]}"#);
    let beside = wall(
        r#"{"type": "rotate", "axis": [0, 1, 0], "angle": 90}, {"type": "translate", "value": [0.5, 0, 0.5]}"#,
    );
    for (name, parts, towards, expected) in
        [("opposite", opposite, -Vec3::Z, 0.199_825), ("beside", beside, -Vec3::X, 0.200_044)]
    {
        let scene = scene(&parts);
        let elements = Elements::of(&scene, ELEMENTS);
        let by_links = links::solve(&scene, &elements, 1, links::NUMBER);
        let by_particles = particles::solve(&scene, &elements, 1, particles::LINES);
        for (method, values) in [("links", by_links), ("particles", by_particles)] {
            let found = mean(&scene, &elements, &values, towards) / 0.8;
            assert!((found / expected - 1.0).abs() < 0.02, "{name} by {method}: {found} of {expected}");
        }
    }
}

const CUBE: &str = r#""fog": {"type": "homogeneous", "sigma_t": 0.8, "albedo": 0.7},
    "cube": {"type": "cube", "to_world": [{"type": "scale", "value": 0.5}], "bsdf": {"type": "null"},
        "interior": {"type": "ref", "id": "fog"}},
    "lamp": {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.4},
        {"type": "rotate", "axis": [1, 0, 0], "angle": 180}, {"type": "translate", "value": [0, 0, 1.3]}],
        "emitter": {"type": "area", "radiance": 5}}"#;

/// What a place in the cube of [`CUBE`] scatters of the lamp's light: an integral over the lamp.
fn once_scattered(at: DVec3) -> f64 {
    const STEPS: u32 = 24;
    let edge = 0.8 / f64::from(STEPS);
    let along = |index: u32| -0.4 + edge * (f64::from(index) + 0.5);
    let patches = (0..STEPS * STEPS).map(|index| DVec3::new(along(index % STEPS), along(index / STEPS), 1.3));
    let part = |lamp: DVec3| {
        let to = lamp - at;
        let cosine = to.z / to.length();
        // The light enters through the top, or through a side that is nearer.
        let leaves = |axis: usize| {
            if to[axis] == 0.0 { f64::INFINITY } else { (0.5 * to[axis].signum() - at[axis]) / to[axis] }
        };
        let inside = leaves(0).min(leaves(1)).min(leaves(2)) * to.length();
        5.0 * cosine / to.length_squared() * (-0.8 * inside).exp()
    };
    patches.map(part).sum::<f64>() * edge * edge * 0.7 / (4.0 * std::f64::consts::PI)
}

/// Light that a medium scatters once; the more links there are the better.
#[test]
fn more_links_find_more_of_a_medium() {
    let scene = scene(CUBE);
    let elements = Elements::of(&scene, ELEMENTS);
    let error = |number: usize| {
        let values = links::solve(&scene, &elements, 1, number);
        let of = elements.hierarchy.elements.iter().zip(&values).filter_map(|(node, value)| {
            let node = &elements.hierarchy.nodes[*node as usize];
            let own = &elements.points[node.points.start as usize..node.points.end as usize];
            let at = |point: &Point| point.interaction.position().as_dvec3() + scene.recentre;
            let expected = own.iter().map(|point| once_scattered(at(point))).sum::<f64>() / own.len() as f64;
            let error = f64::from(value.at(Vec3::X).x) / expected - 1.0;
            (place(&scene, node).z < 0.9).then(|| (error, f64::from(node.measure.x)))
        });
        let (sum, measure) =
            of.fold((0.0, 0.0), |all, (error, measure)| (all.0 + error.powi(2) * measure, all.1 + measure));
        (sum / measure).sqrt()
    };
    let errors = [1 << 8, 1 << 13, 1 << 18].map(error);
    assert!(errors[0] > 1.3 * errors[1] && errors[1] > 1.3 * errors[2] && errors[2] < 0.05, "{errors:?}");
}

/// The light that surfaces and media scatter in a room with a lamp and a thing in it, and all of it, by links over that by particles.
fn in_a_room(walls: &str, fog: &str) -> [f32; 3] {
    let interior = if fog.is_empty() { "" } else { r#", "exterior": {"type": "ref", "id": "medium"}"# };
    let scene = scene(&format!(
        r#"{fog}
        "room": {{"type": "cube", "flip_normals": true, "bsdf": {walls}{interior}}},
        "lamp": {{"type": "sphere", "center": [0.4, 0.3, 0.2], "radius": 0.2, "emitter": {{"type": "area", "radiance": 3}}{interior}}},
        "thing": {{"type": "cube", "to_world": [{{"type": "scale", "value": 0.3}}, {{"type": "translate", "value": [-0.3, -0.5, 0]}}],
            "bsdf": {{"type": "diffuse", "reflectance": 0.3}}{interior}}}"#
    ));
    let elements = Elements::of(&scene, ELEMENTS);
    let split = |values: Vec<Distribution>| {
        let mut sums = [0.0; 3];
        for (power, node) in elements.powers(&values).into_iter().zip(&elements.hierarchy.elements) {
            let is_medium = elements.points(*node)[0].interaction.normal().is_none();
            sums[usize::from(is_medium)] += power;
            sums[2] += power;
        }
        sums
    };
    let by_links = split(links::solve(&scene, &elements, u32::MAX, links::NUMBER));
    let by_particles = split(particles::solve(&scene, &elements, u32::MAX, particles::LINES));
    [0, 1, 2].map(|of| if by_particles[of] == 0.0 { 1.0 } else { by_links[of] / by_particles[of] })
}

/// Both methods find the same, whatever scatters.
#[test]
fn both_methods_find_the_same() {
    const DIFFUSE: &str = r#"{"type": "diffuse", "reflectance": 0.6}"#;
    const ROUGH: &str =
        r#"{"type": "roughconductor", "material": "none", "alpha": 0.4, "specular_reflectance": 0.8}"#;
    let fog = |words: &str| format!(r#""medium": {{"type": "homogeneous", {words}}},"#);
    for (name, walls, fog) in [
        ("empty", DIFFUSE, String::new()),
        ("rough metal", ROUGH, String::new()),
        ("fog", DIFFUSE, fog(r#""sigma_t": 0.5, "albedo": 0.8"#)),
        ("dense fog", DIFFUSE, fog(r#""sigma_t": 5, "albedo": 0.9"#)),
        ("white fog", DIFFUSE, fog(r#""sigma_t": 2, "albedo": 1"#)),
        ("forward", DIFFUSE, fog(r#""sigma_t": 1.5, "albedo": 0.9, "phase": {"type": "hg", "g": 0.8}"#)),
    ] {
        let [surfaces, media, all] = in_a_room(walls, &fog);
        let is_close = |ratio: f32, within: f32| (ratio - 1.0).abs() < within;
        // Of the little light that gets through dense fog to surfaces, links bring 9 % too much.
        assert!(
            is_close(all, 0.02) && is_close(media, 0.03) && is_close(surfaces, 0.12),
            "{name}: {surfaces} {media} {all}"
        );
    }
}

/// Light of a lamp without a surface that is scattered once is the same by both: no link and no particle carries it.
#[test]
fn lamps_count_as_one_bounce() {
    let scene = scene(
        r#""floor": {"type": "rectangle", "bsdf": {"type": "diffuse", "reflectance": 0.5}},
            "wall": {"type": "rectangle", "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 90}, {"type": "translate", "value": [-1, 0, 1]}],
                "bsdf": {"type": "diffuse", "reflectance": 0.5}},
            "lamp": {"type": "point", "position": [0.5, 0.2, 1.5], "intensity": 2}"#,
    );
    let elements = Elements::of(&scene, 256);
    let solved = |bounces| {
        let by_links = links::solve(&scene, &elements, bounces, 1 << 12);
        let by_particles = particles::solve(&scene, &elements, bounces, 1 << 14);
        [by_links, by_particles].map(|values| elements.power(&values))
    };
    let ([once, by_particles], [twice, _]) = (solved(1), solved(2));
    assert!(once > 0.0 && once == by_particles && twice > 1.02 * once, "{once} {by_particles} {twice}");
}

/// The same light, however many threads there are.
#[test]
fn threads_change_nothing() {
    let scene = scene(CUBE);
    let solved = |threads: usize| -> Vec<Vec<Spectrum>> {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let elements = Elements::of(&scene, 256);
            let both = [
                links::solve(&scene, &elements, 3, 1 << 12),
                particles::solve(&scene, &elements, 3, 1 << 14),
            ];
            both.into_iter().flatten().map(|value| value.values).collect()
        })
    };
    assert!(solved(1) == solved(3));
}

/// In a hollow ball that shines, as much is reflected once as the ball reflects.
#[test]
fn a_hollow_ball_keeps_its_light() {
    let scene = scene(
        r#""shell": {"type": "sphere", "flip_normals": true, "bsdf": {"type": "diffuse", "reflectance": 0.5},
            "emitter": {"type": "area", "radiance": 1.5}}"#,
    );
    let elements = Elements::of(&scene, ELEMENTS);
    for (method, values) in [
        ("particles", particles::solve(&scene, &elements, 1, particles::LINES)),
        ("links", links::solve(&scene, &elements, 1, links::NUMBER)),
    ] {
        let of = elements.hierarchy.elements.iter().zip(&values).map(|(node, value)| {
            let measure = f64::from(elements.hierarchy.nodes[*node as usize].measure.x);
            [measure * f64::from(value.sum().x), measure]
        });
        let [sent, measure] = of.fold([0.0, 0.0], |all, one| [all[0] + one[0], all[1] + one[1]]);
        assert!((sent / measure / 0.75 - 1.0).abs() < 0.02, "{method}: {}", sent / measure);
    }
}
