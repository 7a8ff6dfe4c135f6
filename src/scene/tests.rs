//! Textures that ask for more than texture coordinates, against values of Mitsuba 3.9.1.

use super::*;
use crate::{
    bsdf::Transport,
    format,
    math::vec3,
    scene::build::{Setup, build},
    settings::Overrides,
    shape::Ray,
};
use std::path::Path;

fn built(shape: &str) -> Setup {
    let folder = tempfile::tempdir().unwrap();
    let assets = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/crosscheck/assets");
    let shape = shape.replace("ASSETS", &assets.display().to_string());
    let text = format!(
        r#"{{"type": "scene", "a": {shape}, "sky": {{"type": "constant"}}, "camera": {{"type": "perspective"}}}}"#
    );
    let path = folder.path().join("scene.json");
    std::fs::write(&path, text).unwrap();
    build(&format::read(&path, &[]).unwrap(), Overrides::default()).unwrap()
}

/// Light from about above, as the point that a ray meets reflects it back along the ray.
fn reflected(scene: &Scene, origin: Vec3, direction: Vec3) -> Spectrum {
    let origin = (origin.as_dvec3() - scene.recentre).as_vec3();
    let ray = Ray { origin, direction: direction.normalize(), t_max: f32::INFINITY };
    let point = scene.geometry.surface(&ray, &scene.geometry.closest(&ray).unwrap());
    let (wi, wo) = (-ray.direction, vec3(0.3, 0.4, 0.8).normalize());
    let (wi, wo) = (point.shading.to_local(wi), point.shading.to_local(wo));
    scene.at(&point, |bsdf, uv| bsdf.evaluate(uv, wi, wo, Transport::Radiance)).value * wo.z.abs()
}

fn check(shape: &str, rays: [[Vec3; 2]; 3], expected: [[f32; 3]; 3]) {
    let setup = built(shape);
    for ([origin, direction], expected) in rays.into_iter().zip(expected) {
        let found = reflected(&setup.scene, origin, direction);
        let close = found.distance(expected.into()) <= 1e-3 * Spectrum::from(expected).length() + 1e-6;
        assert!(close, "{shape} from {origin}: {found} for {expected:?}");
    }
}

const RAYS: [[Vec3; 2]; 3] = [
    [vec3(0.1, 0.2, 3.0), vec3(0.0, 0.0, -1.0)],
    [vec3(-0.4, 0.5, 3.0), vec3(0.1, 0.0, -1.0)],
    [vec3(0.3, -0.5, 3.0), vec3(0.0, 0.1, -1.0)],
];

#[test]
fn meshes_bring_their_colours_along() {
    let grey = |values: [f32; 3]| values.map(|x| [x; 3]);
    for (name, expected) in [
        (
            "vertex_color",
            [
                [0.190_255, 0.101_504, 0.137_738],
                [0.184_197, 0.113_985, 0.123_868],
                [0.138_715, 0.130_784, 0.044_542],
            ],
        ),
        ("vertex_wear", grey([0.073_230_6, 0.133_503, 0.097_356_2])),
        (
            "face_color",
            [
                [0.030_328_2, 0.044_976_7, 0.082_401_7],
                [0.045_830_1, 0.223_178, 0.103_157],
                [0.123_513, 0.105_101, 0.027_815_4],
            ],
        ),
        ("face_gold", grey([0.131_655, 0.063_325_5, 0.052_040_9])),
    ] {
        let bsdf = format!(
            r#"{{"type": "diffuse", "reflectance": {{"type": "mesh_attribute", "name": "{name}"}}}}"#
        );
        check(&format!(r#"{{"type": "ply", "filename": "ASSETS/gem.ply", "b": {bsdf}}}"#), RAYS, expected);
    }
}

/// An image raises every shape by the texture coordinates of that shape.
#[test]
fn bumps_are_those_of_mitsuba() {
    let height = r#"{"type": "bitmap", "filename": "ASSETS/dunes.png", "raw": true}"#;
    let bsdf =
        format!(r#""b": {{"type": "bumpmap", "h": {height}, "scale": 0.6, "b": {{"type": "diffuse"}}}}"#);
    let turned = r#""to_world": [{"type": "rotate", "axis": [0, 0, 1], "angle": 20}, {"type": "scale", "value": [1, 2, 1]}]"#;
    let behind = r#""to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 180}], "flip_normals": true"#;
    for (shape, expected) in [
        (r#""type": "ply", "filename": "ASSETS/gem.ply""#.to_owned(), [0.153_364, 0.140_63, 0.078_926_3]),
        (r#""type": "sphere""#.into(), [0.079_738_7, 0.108_264, 0.056_379_7]),
        (format!(r#""type": "rectangle", {turned}"#), [0.072_218, 0.075_883_2, 0.096_123_9]),
        (format!(r#""type": "rectangle", {behind}"#), [0.149_275, 0.144_106, 0.093_088_1]),
        (r#""type": "disk""#.into(), [0.135_445, 0.025_667_9, 0.111_972]),
        (
            r#""type": "cylinder", "p0": [0, -1, 0], "p1": [0, 1, 0]"#.into(),
            [0.154_959, 0.149_419, 0.106_837],
        ),
    ] {
        check(&format!("{{{shape}, {bsdf}}}"), RAYS, expected.map(|x| [x; 3]));
    }
}

/// The inner one is raised in the frame of the outer. Of bumps in bumps Mitsuba 3.9.1 mixes the frames, so that even a flat
/// outer one changes what is in it; here it changes nothing.
#[test]
fn perturbed_surfaces_nest() {
    let image = |name: &str| format!(r#"{{"type": "bitmap", "filename": "ASSETS/{name}.png", "raw": true}}"#);
    let (height, map) = (image("dunes"), image("dimples"));
    let bumps = |scale: f64, inner: &str| {
        format!(r#"{{"type": "bumpmap", "h": {height}, "scale": {scale}, "b": {inner}}}"#)
    };
    let inner = bumps(0.6, r#"{"type": "diffuse"}"#);
    for (outer, expected) in [
        (
            format!(r#"{{"type": "normalmap", "normalmap": {map}, "b": {inner}}}"#),
            [0.024_403_7, 0.133_568, 0.0],
        ),
        (bumps(0.0, &inner), [0.079_738_7, 0.108_264, 0.056_379_7]),
    ] {
        check(&format!(r#"{{"type": "sphere", "b": {outer}}}"#), RAYS, expected.map(|x| [x; 3]));
    }
}

#[test]
fn volumes_colour_what_passes_through_them() {
    let volume = r#"{"type": "gridvolume", "filename": "ASSETS/albedo_colours.vol"}"#;
    let bsdf = format!(r#"{{"type": "diffuse", "reflectance": {{"type": "volume", "volume": {volume}}}}}"#);
    let shape = format!(r#"{{"type": "sphere", "center": [0.5, 0.5, 0.5], "radius": 0.6, "b": {bsdf}}}"#);
    let rays = [
        [vec3(0.5, 0.5, 3.0), vec3(0.0, 0.0, -1.0)],
        [vec3(0.2, 0.8, 3.0), vec3(0.0, 0.05, -1.0)],
        [vec3(0.9, 0.3, 3.0), vec3(0.0, 0.0, -1.0)],
    ];
    check(
        &shape,
        rays,
        [
            [0.175_37, 0.263_044, 0.190_346],
            [0.147_627, 0.131_103, 0.146_048],
            [0.138_989, 0.103_903, 0.135_845],
        ],
    );
}
