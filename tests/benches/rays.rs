//! Rays in a list of shapes, in a tree of few, and in a mesh; with `$TYNDALL_RAYS`, those of its `rays.f32` (six numbers each)
//! against its `mesh.ply`: `python3 -m validation rays` compares them with Embree's.

use crate::read;
use divan::{Bencher, black_box, counter::ItemsCount};
use std::{
    env, fs,
    path::{Path, PathBuf},
};
use tyndall::{
    math::{Vec3, warp},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    settings::Overrides,
    shape::Ray,
};

const RAYS: u64 = 1 << 14;

/// Where rays are shot.
fn places() -> Vec<String> {
    let own = ["4 rectangles", "16 rectangles", "64 rectangles", "mesh"].map(String::from);
    own.into_iter().chain(env::var("TYNDALL_RAYS").ok()).collect()
}

fn scene(place: &str) -> Scene {
    match place.split_once(' ') {
        Some((count, _)) => scene_of(&rectangles(count.parse().expect("a number of rectangles"))),
        None if place == "mesh" => ball(),
        None => mesh(&Path::new(place).join("mesh.ply")),
    }
}

/// A scene of these objects, in JSON without the outer braces.
fn scene_of(objects: &str) -> Scene {
    let folder = tempfile::tempdir().expect("a folder for a scene");
    let path = folder.path().join("scene.json");
    let sensor = r#""type": "scene", "sensor": {"type": "perspective"}"#;
    fs::write(&path, format!("{{{sensor}, {objects}}}")).expect("a scene is written");
    read(&path, Overrides::default()).scene
}

/// So many of them, each turned and moved elsewhere within a box of half width 1.
fn rectangles(count: u64) -> String {
    let one = |i| {
        let mut stream = Stream::new(12, i, 0, Purpose::Study);
        let [x, y, z] = [0; 3].map(|_| 2.0 * stream.uniform() - 1.0);
        let place = format!(
            r#"[{{"type": "scale", "value": {}}}, {{"type": "rotate", "axis": [1, 2, 0.5], "angle": {}}}, {{"type": "translate", "value": [{x}, {y}, {z}]}}]"#,
            0.2 + 0.2 * stream.uniform(),
            360.0 * stream.uniform()
        );
        format!(r#""shape{i}": {{"type": "rectangle", "to_world": {place}}}"#)
    };
    (0..count).map(one).collect::<Vec<_>>().join(", ")
}

fn mesh(file: &Path) -> Scene {
    let plugin = file.extension().expect("a mesh has a format").display();
    scene_of(&format!(r#""mesh": {{"type": "{plugin}", "filename": {:?}}}"#, file.display().to_string()))
}

/// A unit ball of 100,000 triangles.
fn ball() -> Scene {
    const RINGS: usize = 158;
    const SIDES: usize = 317;
    let corner = |ring: usize, side: usize| {
        let v = warp::spherical(
            (std::f32::consts::PI * ring as f32 / RINGS as f32).cos(),
            std::f32::consts::TAU * side as f32 / SIDES as f32,
        );
        format!("v {} {} {}\n", v.x, v.y, v.z)
    };
    let at = |ring: usize, side: usize| 1 + ring * SIDES + side % SIDES;
    let face = |ring: usize, side: usize| {
        let [a, b, c, d] = [at(ring, side), at(ring + 1, side), at(ring + 1, side + 1), at(ring, side + 1)];
        format!("f {a} {b} {c}\nf {a} {c} {d}\n")
    };
    let all = |rings: usize, of: &dyn Fn(usize, usize) -> String| -> String {
        (0..rings).flat_map(|ring| (0..SIDES).map(move |side| of(ring, side))).collect()
    };
    let folder = tempfile::tempdir().expect("a folder for a mesh");
    let path = folder.path().join("ball.obj");
    fs::write(&path, all(RINGS + 1, &corner) + &all(RINGS, &face)).expect("a mesh is written");
    mesh(&path)
}

fn rays(place: &str) -> Vec<Ray> {
    let file = PathBuf::from(place).join("rays.f32");
    let Ok(bytes) = fs::read(file) else { return (0..RAYS).map(incoherent).collect() };
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect();
    let ray = |six: &[f32; 6]| Ray {
        origin: Vec3::from_slice(six),
        direction: Vec3::from_slice(&six[3..]),
        t_max: f32::INFINITY,
    };
    numbers.as_chunks().0.iter().map(ray).collect()
}

/// From anywhere within the box of half width 1, in any direction.
fn incoherent(index: u64) -> Ray {
    let mut stream = Stream::new(9, index, 0, Purpose::Study);
    let [x, y, z] = [0; 3].map(|_| 2.0 * stream.uniform() - 1.0);
    Ray { origin: Vec3::new(x, y, z), direction: warp::to_sphere(stream.square()), t_max: f32::INFINITY }
}

/// Times how all rays are shot, one after the other.
fn shoot(bencher: Bencher<'_, '_>, place: &str, hits: impl Fn(&Scene, &Ray) -> bool) {
    let (scene, rays) = (scene(place), rays(place));
    let all = || rays.iter().filter(|ray| hits(&scene, black_box(ray))).count();
    eprintln!("{place}: {} rays hit", all());
    bencher.counter(ItemsCount::new(rays.len())).bench_local(all);
}

#[divan::bench(args = places())]
fn closest(bencher: Bencher<'_, '_>, place: &str) {
    shoot(bencher, place, |scene, ray| scene.geometry.closest(ray).is_some());
}

#[divan::bench(args = places())]
fn occluded(bencher: Bencher<'_, '_>, place: &str) {
    shoot(bencher, place, |scene, ray| scene.geometry.occluded(ray));
}

/// The nearest hit and all that is known of its point.
#[divan::bench(args = places())]
fn surface(bencher: Bencher<'_, '_>, place: &str) {
    shoot(bencher, place, |scene, ray| match scene.geometry.closest(ray) {
        Some(hit) => scene.geometry.surface(ray, &hit).normal.x > 0.0,
        None => false,
    });
}
