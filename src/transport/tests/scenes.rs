//! Scenes for the reference, as the JSON that users write.

use crate::{
    format,
    scene::{self, build::Setup},
    settings::Overrides,
};

/// Builds the scene of these parts: `"name": {...}` after each other.
pub(crate) fn build(parts: &[&str]) -> Setup {
    let text = format!("{{\"type\": \"scene\", {}}}", parts.join(", "));
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("scene.json");
    std::fs::write(&file, text).unwrap();
    std::fs::write(folder.path().join("octahedron.obj"), OCTAHEDRON).unwrap();
    std::fs::write(folder.path().join("voxels.vol"), voxels()).unwrap();
    std::fs::write(folder.path().join("flakes.vol"), flakes(&[ASKEW])).unwrap();
    std::fs::write(folder.path().join("half.vol"), flakes(&[[0.0; 6], [1.0, 1.0, 1.0, 0.0, 0.0, 0.0]]))
        .unwrap();
    std::fs::write(folder.path().join("felt.vol"), flakes(&FELT_MATRICES)).unwrap();
    let sky = |x: usize, y: usize| (x as f32 + 0.1, 3.0 - y as f32, if x == 2 { 40.0 } else { 0.5 });
    exr::prelude::write_rgb_file(folder.path().join("sky.exr"), 6, 4, sky).unwrap();
    let description = format::read(&file, &[]).unwrap_or_else(|error| panic!("{error}"));
    scene::build::build(&description, Overrides::default()).unwrap_or_else(|error| panic!("{error}"))
}

/// The matrix of flakes that lie askew: xx, yy, zz, xy, xz, yz.
const ASKEW: [f32; 6] = [0.04, 0.05, 0.9, 0.01, -0.1, 0.12];

/// Those of felt, from one end along x to the other.
pub(crate) const FELT_MATRICES: [[f32; 6]; 3] = [ASKEW, [1.6, 0.3, 0.1, -0.4, 0.0, 0.05], [0.0; 6]];

/// Matrices in a row along x, in Mitsuba's format.
fn flakes(matrices: &[[f32; 6]]) -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    [1i32, matrices.len() as i32, 1, 1, 6].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    [0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    matrices.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    bytes
}

/// A grid of 5 x 4 x 3 voxels between 0 and 1 in Mitsuba's format.
fn voxels() -> Vec<u8> {
    let mut bytes = b"VOL\x03".to_vec();
    [1i32, 5, 4, 3, 1].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    [0f32, 0.0, 0.0, 1.0, 1.0, 1.0].iter().for_each(|x| bytes.extend(x.to_le_bytes()));
    (0..60u32).for_each(|i| bytes.extend(((i * 37 % 60) as f32 / 59.0).to_le_bytes()));
    bytes
}

pub(crate) const FOG: &str = r#""fog": {"type": "homogeneous", "sigma_t": 0.6, "albedo": 0.9,
    "phase": {"type": "hg", "g": 0.5}}"#;

pub(crate) const CHROMATIC_FOG: &str = r#""fog": {"type": "homogeneous",
    "sigma_t": {"type": "rgb", "value": [0.2, 1.0, 5.0]}, "albedo": {"type": "rgb", "value": [0.9, 0.8, 0.6]}}"#;

pub(crate) const EXTREME_FOG: &str = r#""fog": {"type": "homogeneous",
    "sigma_t": {"type": "rgb", "value": [0.001, 1.0, 1000.0]}, "albedo": 0.95}"#;

/// Fog that takes nothing from blue.
pub(crate) const YELLOW_FOG: &str = r#""fog": {"type": "homogeneous",
    "sigma_t": {"type": "rgb", "value": [0.5, 1.0, 0.0]}, "albedo": 0.9}"#;

pub(crate) const CLEAR: &str = r#""fog": {"type": "homogeneous", "sigma_t": 0.0}"#;

/// Fog that emits where it absorbs, and little elsewhere.
pub(crate) const GLOWING_FOG: &str = r#""fog": {"type": "homogeneous", "sigma_t": 0.6, "albedo": 0.9,
    "radiance": {"type": "rgb", "value": [3, 2, 1]}, "phase": {"type": "hg", "g": 0.5}}"#;

pub(crate) const GLOWING_CHROMATIC_FOG: &str = r#""fog": {"type": "homogeneous",
    "sigma_t": {"type": "rgb", "value": [0.2, 1.0, 5.0]}, "albedo": {"type": "rgb", "value": [0.9, 0.8, 0.6]},
    "emission": {"type": "rgb", "value": [1, 2, 0.5]}}"#;

/// A room whose walls bound the fog in it.
pub(crate) const SHELL: &str = r#""room": {"type": "cube", "flip_normals": true, "exterior": {"type": "ref", "id": "fog"},
    "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.7, 0.6, 0.5]}}}"#;

/// Fog of flakes.
pub(crate) const FLAKES: &str = r#""fog": {"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [2, 1.5, 1]}, "albedo": 0.9,
    "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "flakes.vol"}}}"#;

/// Flakes that vary.
pub(crate) const WAVES_OF_FLAKES: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "scale": 3, "albedo": 0.9,
    "sigma_t": {"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [3, 5, 1]}},
    "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "flakes.vol"}}}}"#;

/// Flakes that change from x = -1 to x = 1, in a medium of one colour, in one of three, and in one that varies.
pub(crate) const FELT: &str = r#""fog": {"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.9,
    "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "felt.vol",
        "to_world": [{"type": "scale", "value": 2}, {"type": "translate", "value": [-1, -1, -1]}]}}}"#;
pub(crate) const CHROMATIC_FELT: &str = r#""fog": {"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [2, 1.5, 1]}, "albedo": 0.9,
    "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "felt.vol",
        "to_world": [{"type": "scale", "value": 2}, {"type": "translate", "value": [-1, -1, -1]}]}}}"#;

/// Dense flakes where x > 0, and none elsewhere.
pub(crate) const HALF_FELT: &str = r#""fog": {"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [40, 60, 50]}, "albedo": 0.9,
    "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "half.vol", "filter_type": "nearest",
        "to_world": [{"type": "scale", "value": 2}, {"type": "translate", "value": [-1, -1, -1]}]}}}"#;

pub(crate) const WAVES_OF_FELT: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "scale": 3, "albedo": 0.9,
    "sigma_t": {"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [3, 5, 1]}},
    "phase": {"type": "sggx", "S": {"type": "gridvolume", "filename": "felt.vol",
        "to_world": [{"type": "scale", "value": 2}, {"type": "translate", "value": [-1, -1, -1]}]}}}}"#;

/// Smoke of a medium that has a name.
pub(crate) const HAZE: &str = r#""haze": {"type": "homogeneous", "sigma_t": 1.2, "albedo": 0.95,
    "phase": {"type": "hg", "g": -0.3}},
    "smoke": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "ref", "id": "haze"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}]}"#;

/// Fire in that.
pub(crate) const FIRE_BALL: &str = r#""kernel": {"type": "sphere", "radius": 0.5, "bsdf": {"type": "null"},
    "interior": {"type": "homogeneous", "sigma_t": 2, "albedo": 0.4, "temperature": 1500, "emission_scale": 2},
    "exterior": {"type": "ref", "id": "haze"}}"#;

/// Fire that varies, of smoke that varies, in a box that it does not fill.
pub(crate) const FIRE_BOX: &str = r#""fire": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "albedo": 0.7, "scale": 2,
    "sigma_t": {"type": "exponential", "scale_height": 0.7},
    "emission": {"type": "exponential", "scale_height": 0.3, "max": [2, 0.2, 2]}}}"#;

/// Light without matter.
pub(crate) const NEON: &str = r#""neon": {"type": "sphere", "radius": 0.7, "bsdf": {"type": "null"},
    "interior": {"type": "homogeneous", "sigma_t": 0, "emission": {"type": "rgb", "value": [3, 0.5, 0.2]}}}"#;

pub(crate) const CHROMATIC_FIRE: &str = r#""fire": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "albedo": {"type": "constvolume", "value": 0.8}, "scale": 1.5,
    "sigma_t": {"type": "constvolume", "value": {"type": "rgb", "value": [0.2, 1, 4]},
        "to_world": [{"type": "scale", "value": 4}, {"type": "translate", "value": [-2, -2, -2]}]},
    "radiance": {"type": "exponential", "scale_height": 0.5}}}"#;

/// The same by a tracker whose transmittance is random.
pub(crate) const TRACKED_FIRE: &str = r#""fire": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "tracker": "null_collision", "albedo": 0.8, "sigma_t": {"type": "product",
    "colour": {"type": "constvolume", "value": {"type": "rgb", "value": [0.2, 1, 4]}},
    "layers": {"type": "exponential", "scale_height": 0.8}},
    "temperature": {"type": "exponential", "scale_height": 3, "value": 1500}}}"#;

/// Smoke in waves, its albedo in others.
pub(crate) const WAVES: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "scale": 1.5,
    "sigma_t": {"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [3, 5, 1]}},
    "albedo": {"type": "cosine", "constant": 0.6, "a": {"type": "wave", "amplitude": 0.3, "vector": [0, 5, 3]}},
    "phase": {"type": "hg", "g": 0.4}}}"#;

/// The same in three colours.
pub(crate) const CHROMATIC_WAVES: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "albedo": 0.9,
    "sigma_t": {"type": "product", "a": {"type": "constvolume", "value": {"type": "rgb", "value": [0.1, 1, 6]}},
    "b": {"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [3, 5, 1]}}}}}"#;

/// The same by null collisions, where the weights use a stand-in.
pub(crate) const TRACKED_WAVES: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "interior": {"type": "heterogeneous", "albedo": 0.9, "tracker": "null_collision",
    "sigma_t": {"type": "product", "a": {"type": "constvolume", "value": {"type": "rgb", "value": [0.1, 1, 6]}},
    "b": {"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [3, 5, 1]}}}}}"#;

/// Random voxels, read from a file that [`build`] writes.
pub(crate) const VOXELS: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "heterogeneous", "albedo": 0.9, "scale": 3, "sigma_t": {"type": "gridvolume",
    "filename": "voxels.vol", "to_world": [{"type": "scale", "value": 1.8}, {"type": "translate", "value": [-0.9, -0.8, -0.9]}]}}}"#;

/// A camera in the fog, in the room.
pub(crate) const INSIDE: &str = r#""camera": {"type": "perspective", "fov": 80,
    "to_world": [{"type": "lookat", "origin": [0.1, 0, -0.9], "target": [0, 0.05, 0], "up": [0, 1, 0]}],
    "film": {"type": "hdrfilm", "width": 16, "height": 12}, "fog": {"type": "ref", "id": "fog"}}"#;

/// A camera in the open, six metres off.
pub(crate) const OUTSIDE: &str = r#""camera": {"type": "perspective", "fov": 40,
    "to_world": [{"type": "lookat", "origin": [0.5, 1, -6], "target": [0, 0, 0], "up": [0, 1, 0]}],
    "film": {"type": "hdrfilm", "width": 16, "height": 12}}"#;

/// A camera in the fog with a lens as wide as the reference needs it.
pub(crate) const LENS: &str = r#""camera": {"type": "thinlens", "fov": 80, "aperture_radius": 0.05, "focus_distance": 0.9,
    "to_world": [{"type": "lookat", "origin": [0.1, 0, -0.9], "target": [0, 0.05, 0], "up": [0, 1, 0]}],
    "film": {"type": "hdrfilm", "width": 16, "height": 12}, "fog": {"type": "ref", "id": "fog"}}"#;

pub(crate) const ROOM: &str = r#""room": {"type": "cube", "flip_normals": true,
    "bsdf": {"type": "diffuse", "reflectance": {"type": "rgb", "value": [0.7, 0.6, 0.5]}}}"#;

pub(crate) const LAMP: &str = r#""lamp": {"type": "rectangle",
    "to_world": [{"type": "scale", "value": 0.4}, {"type": "rotate", "axis": [1, 0, 0], "angle": 90},
                 {"type": "translate", "value": [0, 0.95, 0.2]}],
    "bsdf": {"type": "diffuse", "reflectance": 0.3},
    "emitter": {"type": "area", "radiance": 5}}"#;

pub(crate) const BALL: &str = r#""ball": {"type": "sphere", "center": [0.3, -0.6, 0.3], "radius": 0.35,
    "bsdf": {"type": "diffuse", "reflectance": 0.4}}"#;

pub(crate) const BULB: &str = r#""bulb": {"type": "sphere", "center": [-0.5, 0.4, 0.4], "radius": 0.15,
    "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [9, 7, 3]}}}"#;

/// A lamp that lets everything pass, in the camera's view.
pub(crate) const NULL_LAMP: &str = r#""lamp": {"type": "rectangle",
    "to_world": [{"type": "scale", "value": 0.5}, {"type": "rotate", "axis": [0, 1, 0], "angle": 160},
                 {"type": "translate", "value": [0, 0.1, 0.1]}],
    "bsdf": {"type": "null"}, "emitter": {"type": "area", "radiance": 2}}"#;

/// A bulb with holes.
pub(crate) const MASKED_BULB: &str = r#""bulb": {"type": "sphere", "center": [-0.3, 0.2, 0.3], "radius": 0.3,
    "bsdf": {"type": "mask", "opacity": 0.4, "nested": {"type": "diffuse", "reflectance": 0.6}},
    "emitter": {"type": "area", "radiance": {"type": "rgb", "value": [9, 7, 3]}}}"#;

/// Smoke whose boundary emits.
pub(crate) const BRIGHT_SMOKE: &str = r#""smoke": {"type": "sphere", "bsdf": {"type": "null"},
    "interior": {"type": "homogeneous", "sigma_t": 1.2, "albedo": 0.95},
    "emitter": {"type": "area", "radiance": 1.5}}"#;

/// Glass around thinner fog.
pub(crate) const GLASS_BALL: &str = r#""haze": {"type": "homogeneous", "sigma_t": 1.5, "albedo": 0.95},
    "ball": {"type": "sphere", "center": [0.3, -0.4, 0.2], "radius": 0.4,
    "bsdf": {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0},
    "interior": {"type": "ref", "id": "haze"}, "exterior": {"type": "ref", "id": "fog"}}"#;

pub(crate) const MIRROR: &str = r#""mirror": {"type": "rectangle",
    "to_world": [{"type": "scale", "value": 0.6}, {"type": "rotate", "axis": [0, 1, 0], "angle": 60},
                 {"type": "translate", "value": [-0.8, -0.2, 0.3]}],
    "bsdf": {"type": "twosided", "bsdf": {"type": "conductor", "material": "none"}}}"#;

pub(crate) const FROSTED_BALL: &str = r#""ball": {"type": "sphere", "center": [0.3, -0.4, 0.2], "radius": 0.4,
    "bsdf": {"type": "roughdielectric", "alpha": 0.3, "int_ior": 1.5, "ext_ior": 1.0}}"#;

pub(crate) const PANE: &str = r#""pane": {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.9},
    {"type": "rotate", "axis": [0, 1, 0], "angle": 10}, {"type": "translate", "value": [0, 0, 0.1]}],
    "bsdf": {"type": "thindielectric", "int_ior": 1.5,
             "specular_transmittance": {"type": "rgb", "value": [0.9, 0.5, 0.2]}, "specular_reflectance": 0.9}}"#;

/// A surface that scatters both as a Dirac lobe and diffusely, on one side.
pub(crate) const PLASTIC_BALL: &str = r#""ball": {"type": "sphere", "center": [0.3, -0.4, 0.2], "radius": 0.4,
    "bsdf": {"type": "plastic", "int_ior": 2.0}}"#;

/// Smooth glass and chalk at one place, and both with holes.
pub(crate) const VEILED_BALL: &str = r#""ball": {"type": "sphere", "center": [0.3, -0.4, 0.2], "radius": 0.4,
    "bsdf": {"type": "mask", "opacity": 0.7, "nested": {"type": "blendbsdf", "weight": 0.4,
    "glass": {"type": "dielectric", "int_ior": 1.5},
    "chalk": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.8}}}}}"#;

/// Stained glass, half of which goes straight through.
pub(crate) const STAINED_PANE: &str = r#""pane": {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.9},
    {"type": "rotate", "axis": [0, 1, 0], "angle": 10}, {"type": "translate", "value": [0, 0, 0.1]}],
    "bsdf": {"type": "translucent", "transmittance": {"type": "rgb", "value": [0.9, 0.5, 0.2]}}}"#;

/// The same with a lobe.
pub(crate) const BLURRED_PANE: &str = r#""pane": {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.9},
    {"type": "rotate", "axis": [0, 1, 0], "angle": 10}, {"type": "translate", "value": [0, 0, 0.1]}],
    "bsdf": {"type": "translucent", "transmittance": 0.9, "directional": 0.7, "exponent": 30}}"#;

/// A cube of smoke in the open.
pub(crate) const SMOKE: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "homogeneous", "sigma_t": 1.2, "albedo": 0.95, "phase": {"type": "hg", "g": -0.3}}}"#;

pub(crate) const CHROMATIC_SMOKE: &str = r#""smoke": {"type": "cube", "bsdf": {"type": "null"},
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 25}],
    "interior": {"type": "homogeneous", "sigma_t": {"type": "rgb", "value": [0.1, 1, 10]}, "albedo": 0.9}}"#;

/// Denser smoke within the smoke.
pub(crate) const KERNEL: &str = r#""kernel": {"type": "sphere", "radius": 0.5, "bsdf": {"type": "null"},
    "interior": {"type": "homogeneous", "sigma_t": 4, "albedo": 0.8},
    "exterior": {"type": "homogeneous", "sigma_t": 1.2, "albedo": 0.95, "phase": {"type": "hg", "g": -0.3}}}"#;

pub(crate) const GROUND: &str = r#""ground": {"type": "rectangle",
    "to_world": [{"type": "scale", "value": 4}, {"type": "rotate", "axis": [1, 0, 0], "angle": -90},
                 {"type": "translate", "value": [0, -1.2, 0]}],
    "bsdf": {"type": "diffuse", "reflectance": 0.5}}"#;

pub(crate) const SKY: &str = r#""sky": {"type": "constant", "radiance": 0.7}"#;

pub(crate) const SKY_IMAGE: &str = r#""sky": {"type": "envmap", "filename": "sky.exr",
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 40}]}"#;

pub(crate) const LUMINAIRE: &str = r#""lamp": {"type": "rectangle",
    "to_world": [{"type": "scale", "value": 0.4}, {"type": "rotate", "axis": [1, 0, 0], "angle": 90},
                 {"type": "translate", "value": [0, 0.95, 0.2]}],
    "emitter": {"type": "area", "radiance": {"type": "checkerboard", "color0": 5, "color1": 1},
                "profile": "0:1 40:0.8 60:0"}}"#;

pub(crate) const BEAM: &str = r#""beam": {"type": "rectangle",
    "to_world": [{"type": "scale", "value": 0.2}, {"type": "rotate", "axis": [0, 1, 0], "angle": 90},
                 {"type": "translate", "value": [-0.9, 0.1, 0]}],
    "emitter": {"type": "directionalarea", "radiance": 8}}"#;

/// A beam across the room and the smoke.
pub(crate) const SEARCHLIGHT: &str = r#""searchlight": {"type": "collimated", "radius": 0.3, "irradiance": 4,
    "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 70}, {"type": "rotate", "axis": [0, 0, 1], "angle": -25},
                 {"type": "translate", "value": [-0.55, 0.4, 0]}]}"#;

pub(crate) const PROFILED_POINT: &str = r#""point": {"type": "point", "intensity": 2, "profile": "0:1 90:0.1 120:0",
    "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": 50}, {"type": "translate", "value": [-0.3, 0.8, 0]}]}"#;

pub(crate) const SUN: &str =
    r#""sun": {"type": "directional", "direction": [0.4, -1, 0.5], "irradiance": 3}"#;

pub(crate) const POINT: &str = r#""point": {"type": "point", "position": [-0.3, 0.8, -0.2], "intensity": 2}"#;

pub(crate) const SPOT: &str = r#""spot": {"type": "spot", "cutoff_angle": 35, "intensity": 6,
    "to_world": [{"type": "lookat", "origin": [0.6, 0.9, -0.4], "target": [0, -0.5, 0], "up": [0, 0, 1]}]}"#;

/// A ball that emits inwards and reflects little.
pub(crate) const HOLLOW: &str = r#""shell": {"type": "sphere", "flip_normals": true,
    "bsdf": {"type": "diffuse", "reflectance": 0.3}, "emitter": {"type": "area", "radiance": 1}}"#;

/// White walls far apart, in fog that absorbs nothing.
pub(crate) const FURNACE: &str = r#""fog": {"type": "homogeneous", "sigma_t": 20, "albedo": 1},
    "room": {"type": "cube", "flip_normals": true, "bsdf": {"type": "diffuse", "reflectance": 1}}"#;

/// A tunnel with the camera at one end and a lamp at the other, 100 mean free paths off.
pub(crate) const TUNNEL: &str = r#""fog": {"type": "homogeneous", "sigma_t": 1, "albedo": 0.9},
    "camera": {"type": "perspective", "fov": 60,
    "to_world": [{"type": "lookat", "origin": [0, 0, -51], "target": [0, 0, 0], "up": [0, 1, 0]}],
    "film": {"type": "hdrfilm", "width": 16, "height": 12}, "fog": {"type": "ref", "id": "fog"}},
    "tunnel": {"type": "cube", "flip_normals": true, "to_world": [{"type": "scale", "value": [5, 5, 53]}],
    "bsdf": {"type": "diffuse", "reflectance": 0.5}},
    "lamp": {"type": "rectangle", "to_world": [{"type": "rotate", "axis": [0, 1, 0], "angle": 180},
    {"type": "translate", "value": [0, 0, 51]}], "emitter": {"type": "area", "radiance": 1}}"#;

/// Eight triangles that reflect as if they were a sphere.
pub(crate) const SMOOTH: &str = r#""smooth": {"type": "obj", "filename": "octahedron.obj",
    "to_world": [{"type": "scale", "value": 0.5}, {"type": "translate", "value": [0.2, -0.3, 0.1]}],
    "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.8}}}"#;

const OCTAHEDRON: &str = "
v 1 0 0\nv -1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nv 0 0 -1
vn 1 0 0\nvn -1 0 0\nvn 0 1 0\nvn 0 -1 0\nvn 0 0 1\nvn 0 0 -1
f 1//1 3//3 5//5\nf 3//3 2//2 5//5\nf 2//2 4//4 5//5\nf 4//4 1//1 5//5
f 3//3 1//1 6//6\nf 2//2 3//3 6//6\nf 4//4 2//2 6//6\nf 1//1 4//4 6//6
";
