//! Smoke of files as tools write them, and the same written by hand.

use crate::{
    error::{Error, Result},
    format,
    math::{Bounds, DVec3, RaySegment, Spectrum, Vec3},
    medium::MediumIndex,
    phase::PhaseModel as _,
    scene::{
        build::{Setup, build},
        shutter::Shutter,
    },
    settings::Overrides,
};
use flate2::read::GzDecoder;
use std::{
    fs::{self, File},
    io::Read as _,
    path::Path,
};
use tempfile::TempDir;

/// Unpacks the file `name` of src/volume/files/samples into `folder`, as `target`.
fn unpack(folder: &Path, name: &str, target: &str) {
    let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/volume/files/samples");
    let mut bytes = vec![];
    let file = File::open(samples.join(format!("{name}.gz"))).unwrap();
    GzDecoder::new(file).read_to_end(&mut bytes).unwrap();
    fs::write(folder.join(target), bytes).unwrap();
}

/// A scene of smoke of the file `name`, with further parameters, and whatever else is in it.
fn scene(name: &str, parameters: &str, others: &str) -> Result<Setup> {
    let folder = tempfile::tempdir().unwrap();
    if name.ends_with("vdb") {
        unpack(folder.path(), name, name);
    }
    let text = format!(
        r#"{{"type": "scene", "plume": {{"type": "smoke", "filename": "{name}" {parameters}}} {others},
            "sky": {{"type": "constant"}}, "camera": {{"type": "perspective"}}}}"#
    );
    let path = folder.path().join("scene.json");
    fs::write(&path, text).unwrap();
    build(&format::read(&path, &[])?, Overrides::default())
}

fn smoke(name: &str, parameters: &str) -> Setup {
    scene(name, parameters, "").unwrap()
}

fn refused(name: &str, parameters: &str, others: &str) -> Error {
    scene(name, parameters, others).map(drop).unwrap_err()
}

/// What was taken of a file, without the file's name.
fn taken(name: &str, parameters: &str) -> String {
    let setup = smoke(name, parameters);
    let [taken] = setup.smoke.as_slice() else { panic!("{name}") };
    taken.to_string().split_once(&format!("{name}, ")).unwrap().1.to_owned()
}

#[test]
fn roles_are_those_of_the_tool_that_wrote_the_file() {
    let kelvins = "1500 K + 1500 K x its value, up to 3000 K";
    let cases = [
        (
            "houdini.vdb",
            format!(r#"density from "density", light from "burn" ({kelvins}), colour from "Cd"; not used: "temperature", "vel" (a velocity)"#),
        ),
        (
            "houdini_old.vdb",
            r#"density from "density", light from "heat" (0 K + 1000 K x its value, up to 1000 K), colour from "Cd.x", "Cd.y", "Cd.z"; not used: "temperature", "vel.x" (a velocity), "vel.y" (a velocity), "vel.z" (a velocity)"#.to_owned(),
        ),
        (
            "blender.vdb",
            format!(r#"density from "density", light from "flame" ({kelvins}), colour from "color_r", "color_g", "color_b"; not used: "heat", "velocity" (a velocity)"#),
        ),
        ("bifrost.vdb", r#"density from "voxel_fog_density"; not used: "voxel_velocity" (a velocity)"#.to_owned()),
        (
            "kelvin.vdb",
            r#"density from "density", light from "temperature" (0 K + 1 K x its value, up to 1800 K)"#.to_owned(),
        ),
        ("zip.nvdb", r#"density from "density""#.to_owned()),
        ("twins.vdb", r#"density from "density[0]"; not used: "density[1]""#.to_owned()),
    ];
    for (name, expected) in cases {
        assert_eq!(taken(name, ""), expected, "{name}");
    }
}

#[test]
fn grids_that_hold_nothing_are_as_good_as_none() {
    let smoke = taken("blender5.vdb", "");
    let unused = r#""flame" (empty), "temperature", "color_r" (empty), "color_g" (empty), "color_b" (empty), "velocity" (a velocity)"#;
    assert_eq!(smoke, format!(r#"density from "density"; not used: {unused}"#));
    assert_eq!(bound(&self::smoke("blender5.vdb", ""))[1], Spectrum::splat(0.75));
    let fire = taken("burning.vdb", "");
    assert!(fire.starts_with("no density, light from \"flame\""), "{fire}");
    assert!(fire.ends_with(r#"; not used: "density" (empty), "heat", "Cd""#), "{fire}");
    // Of smoke that has not begun there is still the density.
    let nothing = taken("burning.vdb", r#", "temperature_grid": "heat""#);
    assert_eq!(nothing, r#"density from "density", colour from "Cd"; not used: "flame", "heat" (empty)"#);
}

#[test]
fn a_velocity_that_is_taken_for_a_density_is_refused_and_the_density_named() {
    let velocity = refused("blender5.vdb", r#", "density_grid": "velocity""#, "");
    assert!(velocity.place.ends_with("blender5.vdb") && velocity.found.starts_with("-0.4"), "{velocity}");
    assert_eq!(velocity.remedy, "choose another grid of the file: \"density\"");
}

#[test]
fn names_and_ramps_may_be_given() {
    let of_heat =
        r#", "temperature_grid": "temperature", "temperature_scale": 900, "temperature_offset": 100"#;
    assert!(taken("houdini.vdb", of_heat).contains(r#"light from "temperature" (100 K + 900 K x its value"#));
    let soot = taken("strange.vdb", r#", "density_grid": "soot""#);
    assert_eq!(soot, r#"density from "soot"; not used: "tar""#);
    let dark = taken("houdini.vdb", r#", "emission_scale": 0, "color_grid": """#);
    assert_eq!(dark, r#"density from "density"; not used: "temperature", "burn", "Cd", "vel" (a velocity)"#);
    let fire = taken("houdini.vdb", r#", "density_grid": """#);
    assert!(fire.starts_with("no density, light from \"burn\""), "{fire}");
    let fog = taken("levelset.vdb", r#", "level_set_to_fog": true"#);
    assert!(fog.starts_with("density from the level set"), "{fog}");
}

/// The medium's greatest extinction and albedo.
fn bound(setup: &Setup) -> [Spectrum; 2] {
    let bound = setup.scene.media[1].bound();
    [bound.sigma_t, bound.albedo]
}

/// The box that the smoke is in, in the coordinates of the scene.
fn container(setup: &Setup) -> [DVec3; 2] {
    let Bounds { low, high } = setup.scene.geometry.bounds();
    [low, high].map(|corner| corner.as_dvec3() + setup.scene.recentre)
}

#[test]
fn factors_are_of_density_brightness_and_size() {
    let plain = smoke("houdini.vdb", "");
    let [sigma_t, albedo] = bound(&plain);
    assert!(sigma_t.x > 0.5 && albedo.x > albedo.z, "{sigma_t} {albedo}");
    let [dense, _] = bound(&smoke("houdini.vdb", r#", "density_scale": 3"#));
    assert_eq!(dense, sigma_t * 3.0);
    let [_, dark] = bound(&smoke("houdini.vdb", r#", "albedo": 0.5"#));
    assert!((dark - 0.5 * albedo).abs().max_element() < 1e-6, "{dark} {albedo}");
    let [_, plain_albedo] = bound(&smoke("twins.vdb", ""));
    assert_eq!(plain_albedo, Spectrum::splat(0.75));
    let power =
        |parameters| smoke("houdini.vdb", parameters).scene.media[1].emission.as_ref().unwrap().power();
    let (once, twice) = (power(""), power(r#", "emission_scale": 0.02"#));
    assert!((twice - 2.0 * once).abs().max_element() < 1e-6 * once.max_element(), "{once} {twice}");
    let [low, high] = container(&plain);
    let [l, h] = container(&smoke(
        "houdini.vdb",
        r#", "scale": 2, "to_world": [{"type": "translate", "value": [1, 0, 0]}]"#,
    ));
    let expected = [2.0 * low + DVec3::X, 2.0 * high + DVec3::X];
    assert!(
        (l - expected[0]).abs().max_element() < 1e-5 && (h - expected[1]).abs().max_element() < 1e-5,
        "{l} {h}"
    );
}

/// The albedo at some points of the smoke.
fn albedos(setup: &Setup) -> Vec<Spectrum> {
    let varying = setup.scene.media[1].heterogeneous().unwrap();
    let points = [[0.5, 0.2, 0.5], [0.3, 1.0, 0.6], [0.55, 0.72, 0.41]].map(DVec3::from);
    points
        .iter()
        .map(|point| varying.at::<Spectrum>((*point - setup.scene.recentre).as_vec3()).albedo)
        .collect()
}

#[test]
fn three_grids_of_a_component_are_one_of_colours() {
    let one = albedos(&smoke("houdini.vdb", r#", "albedo": 0.8"#));
    for (name, rounding) in [("houdini_old.vdb", 1e-6), ("blender.vdb", 1e-3)] {
        let three = albedos(&smoke(name, r#", "albedo": 0.8"#));
        let off = one.iter().zip(&three).map(|(a, b)| (*a - *b).abs().max_element());
        assert!(off.fold(0.0, f32::max) < rounding, "{name}: {three:?} for {one:?}");
    }
    assert!(one[1].x > 0.5 && one[1].z < 0.25, "{one:?}");
}

#[test]
fn the_container_holds_smoke_and_fire() {
    let [low, high] = container(&smoke("kelvin.vdb", ""));
    // One voxel more than the active ones on every side; the fire begins three voxels lower.
    let fire = smoke("kelvin.vdb", r#", "density_grid": """#);
    let [l, h] = container(&fire);
    assert!(low.cmple(l).all() && high.cmpge(h).all() && low.y < -0.75, "{low} {high} {l} {h}");
    assert!(fire.scene.media[1].heterogeneous().is_none(), "fire alone scatters nothing");
    assert_eq!(bound(&fire)[0], Spectrum::ZERO);
}

#[test]
fn level_sets_become_fog_that_is_thickest_inside() {
    let [sigma_t, _] = bound(&smoke("levelset.vdb", r#", "level_set_to_fog": true, "density_scale": 2"#));
    assert!((sigma_t.x - 2.0).abs() < 1e-5, "{sigma_t}");
}

#[test]
fn what_refers_to_smoke_means_what_is_in_it() {
    let camera =
        r#", "eye": {"type": "point", "position": [0.6, 1, 0.6], "medium": {"type": "ref", "id": "plume"}}"#;
    let setup = scene("houdini.vdb", "", camera).unwrap();
    let inside = setup.scene.lights.all.iter().find(|light| light.emitter.name == "point").unwrap();
    assert_eq!(inside.medium, MediumIndex(1));
    assert_eq!(
        (setup.medium_names.as_slice(), setup.shape_names.as_slice()),
        (&["plume".to_owned()][..], &["plume (its box)".to_owned()][..])
    );
    let hazy = r#", "lobe": {"type": "hg", "g": 0.5}, "haze": {"type": "homogeneous", "sigma_t": 0.1}"#;
    let parts = r#", "phase": {"type": "ref", "id": "lobe"}, "exterior": {"type": "ref", "id": "haze"}"#;
    let setup = scene("houdini.vdb", parts, hazy).unwrap();
    assert_eq!(setup.scene.media.len(), 3);
    assert!((setup.scene.media[1].phase.mean_cosine() - 0.5).abs() < 1e-6);
}

#[test]
fn mistakes_are_explained_at_the_smoke() {
    let strange = refused("strange.vdb", "", "");
    assert!(strange.place.ends_with("$.plume.filename"), "{strange}");
    assert!(strange.found.contains("\"soot\"") && strange.found.contains("\"tar\""), "{strange}");
    assert!(strange.remedy.contains("density_grid"), "{strange}");
    let surface = refused("levelset.vdb", "", "");
    assert!(surface.remedy.contains("level_set_to_fog"), "{surface}");
    let misspelt = refused("houdini.vdb", r#", "densty_scale": 2"#, "");
    assert!(misspelt.remedy.contains("\"density_scale\""), "{misspelt}");
    let unknown = refused("houdini.vdb", r#", "density_grid": "densty""#, "");
    assert!(unknown.expected.contains("density_grid") && unknown.remedy.contains("\"density\""), "{unknown}");
    let nothing = refused("houdini.vdb", r#", "density_grid": "", "temperature_grid": """#, "");
    assert!(nothing.found.contains("\"density\""), "{nothing}");
    let white = refused("houdini.vdb", r#", "albedo": 1.5"#, "");
    assert!(white.place.ends_with("$.plume.albedo"), "{white}");
    let still = refused("houdini.vdb", r#", "fps": 12"#, "");
    assert!(still.remedy.contains("%04d"), "{still}");
    let lobes = r#", "a": {"type": "hg"}, "b": {"type": "isotropic"}"#;
    assert!(refused("houdini.vdb", lobes, "").place.ends_with("$.plume.b"));
    assert!(refused("none.vol", "", "").found.contains("none.vol"));
    let ball = r#", "ball": {"type": "sphere", "inside": {"type": "smoke", "filename": "houdini.vdb"}}"#;
    assert!(refused("houdini.vdb", "", ball).place.ends_with("$.ball.inside"));
}

#[test]
fn the_scene_s_time_chooses_a_numbered_file() {
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), "houdini.vdb", "a_0001.vdb");
    unpack(folder.path(), "blender.vdb", "a_0002.vdb");
    let at = |time: f64, more: &str| {
        let path = folder.path().join("scene.json");
        let text = format!(
            r#"{{"type": "scene", "time": {time}, "plume": {{"type": "smoke", "filename": "a_####.vdb" {more}}},
                "sky": {{"type": "constant"}}, "camera": {{"type": "perspective"}}}}"#
        );
        fs::write(&path, text).unwrap();
        let setup = build(&format::read(&path, &[])?, Overrides::default())?;
        let sources = format::sources(&path, &[], None)?;
        assert!(sources.files.contains(&setup.smoke[0].file), "{sources:?}");
        Ok(setup.smoke[0].file.file_name().unwrap().to_string_lossy().into_owned())
    };
    assert_eq!(at(0.0, ""), Ok("a_0001.vdb".to_owned()));
    assert_eq!(at(1.0 / 24.0, ""), Ok("a_0002.vdb".to_owned()));
    assert_eq!(at(0.1, r#", "fps": 10, "first_frame": 1"#), Ok("a_0002.vdb".to_owned()));
    let missing: Error = at(0.2, "").unwrap_err();
    assert!(missing.found == "frames 1 to 2" && missing.expected.starts_with("a_0006.vdb"), "{missing}");
}

#[test]
fn z_of_a_file_may_point_up() {
    // The file says that Blender wrote it.
    let [low, high] = container(&smoke("upright.vdb", ""));
    let text = smoke("upright.vdb", "").smoke[0].to_string();
    assert!(text.contains("upright.vdb, +z up, density"), "{text}");
    assert!((high - low - DVec3::new(1.75, 2.5, 1.75)).abs().max_element() < 1e-5, "{low} {high}");
    assert!((low - DVec3::new(-0.375, -0.375, -1.375)).abs().max_element() < 1e-5, "{low} {high}");
    let [low, high] = container(&smoke("upright.vdb", r#", "up": "y""#));
    assert!((high - low - DVec3::new(1.75, 1.75, 2.5)).abs().max_element() < 1e-5, "{low} {high}");
    // What turns it already, and a scene that has +z up itself, are left alone.
    let turned = r#", "to_world": [{"type": "rotate", "axis": [1, 0, 0], "angle": -90}]"#;
    let [l, h] = container(&smoke("upright.vdb", turned));
    assert!((h - l - DVec3::new(1.75, 2.5, 1.75)).abs().max_element() < 1e-5, "{l} {h}");
    let camera = r#", "first": {"type": "perspective",
        "to_world": [{"type": "lookat", "origin": [9, 0, 1], "target": [0, 0, 1], "up": [0, 0, 1]}]}"#;
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), "upright.vdb", "upright.vdb");
    let text = format!(
        r#"{{"type": "scene" {camera}, "plume": {{"type": "smoke", "filename": "upright.vdb"}}, "sky": {{"type": "constant"}}}}"#
    );
    let path = folder.path().join("scene.json");
    fs::write(&path, text).unwrap();
    let blender = build(&format::read(&path, &[]).unwrap(), Overrides::default()).unwrap();
    assert!(!blender.smoke[0].to_string().contains("+z up"), "{}", blender.smoke[0]);
    // Size and place come after the turn.
    let place = r#", "up": "z", "scale": 2, "to_world": [{"type": "translate", "value": [0, 10, 0]}]"#;
    let [low, high] = container(&smoke("houdini.vdb", place));
    let [l, h] = container(&smoke("houdini.vdb", ""));
    let expected = [
        DVec3::new(l.x, l.z, -h.y) * 2.0 + 10.0 * DVec3::Y,
        DVec3::new(h.x, h.z, -l.y) * 2.0 + 10.0 * DVec3::Y,
    ];
    assert!(
        (low - expected[0]).abs().max_element() < 1e-4 && (high - expected[1]).abs().max_element() < 1e-4,
        "{low} {high}"
    );
    assert!(refused("houdini.vdb", r#", "up": "x""#, "").expected.contains("z"));
}

#[test]
fn fire_has_a_light_group() {
    let setup = smoke("houdini.vdb", r#", "group": "fire""#);
    assert_eq!(setup.scene.lights.groups(), ["fire", "rest"]);
    assert!(refused("houdini.vdb", r#", "group": """#, "").place.ends_with("$.plume.group"));
}

/// Smoke of a file with velocities, seen while the shutter is open from `opens` to `closes`.
fn exposed(parameters: &str, opens: f64, closes: f64) -> Result<(TempDir, Setup)> {
    exposed_of("houdini.vdb", parameters, opens, closes)
}

fn exposed_of(name: &str, parameters: &str, opens: f64, closes: f64) -> Result<(TempDir, Setup)> {
    let folder = tempfile::tempdir().unwrap();
    unpack(folder.path(), name, "smoke.vdb");
    let text = format!(
        r#"{{"type": "scene", "plume": {{"type": "smoke", "filename": "smoke.vdb", "emission_scale": 0 {parameters}}},
            "sky": {{"type": "constant"}},
            "camera": {{"type": "perspective", "shutter_open": {opens}, "shutter_close": {closes}}}}}"#
    );
    let path = folder.path().join("scene.json");
    fs::write(&path, text).unwrap();
    build(&format::read(&path, &[])?, Overrides::default()).map(|setup| (folder, setup))
}

/// What the smoke of `setup` is across a few places.
fn depths(setup: &Setup) -> Vec<f32> {
    let medium = setup.scene.media.iter().find_map(|medium| medium.heterogeneous()).unwrap();
    let recentre = setup.scene.recentre.as_vec3();
    let across = |i: i32| RaySegment {
        origin: Vec3::new(-2.0, 0.2 * i as f32, 0.5) - recentre,
        direction: Vec3::X,
        length: 5.0,
    };
    (0..8).map(|i| medium.depth::<f32>(&across(i))).collect()
}

#[test]
fn every_pass_sees_smoke_where_it_is_then() {
    let shutter = Shutter { opens: -0.5, closes: 0.75 };
    let (_folder, moving) = exposed("", -0.5, 0.75).unwrap();
    assert_eq!(moving.exposure(), Some([-0.5, 0.75]));
    let mut seen = Vec::new();
    for pass in [0, 1, 7] {
        let at = shutter.moment(5, pass);
        let found = depths(&moving.moment(5, pass).unwrap().unwrap());
        let expected = depths(&exposed("", at, at).unwrap().1);
        assert!(found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-4), "{found:?} {expected:?}");
        assert!(found.iter().sum::<f32>() > 0.1 && !seen.contains(&found), "pass {pass}");
        seen.push(found);
    }
}

/// A frame that Blender 5.0 simulated, in voxels of 0.15625 m.
#[test]
fn velocities_of_blender_s_fluids_are_in_voxels_per_0_4_s() {
    let scale =
        |name, parameters: &str| exposed_of(name, parameters, 0.0, 0.02).unwrap().1.smoke[0].velocity_scale;
    assert_eq!(scale("blender_fluids.vdb", ""), Some(2.5 * 0.15625));
    assert_eq!(scale("blender_fluids.vdb", r#", "velocity_scale": 3"#), Some(3.0));
    assert_eq!(scale("houdini.vdb", ""), None);
    let told = exposed_of("blender_fluids.vdb", "", 0.0, 0.02).unwrap().1.smoke[0].to_string();
    assert!(
        told.contains("+z up") && told.contains("carried along by \"velocity\" (1 is 0.3906 m/s)"),
        "{told}"
    );
}

#[test]
fn velocities_of_another_unit_are_refused() {
    let refused = exposed(r#", "velocity_scale": 1e30"#, 0.0, 1.0).map(drop).unwrap_err();
    assert!(refused.to_string().contains("velocity_scale"), "{refused}");
    assert!(exposed(r#", "velocity_grid": """#, 0.0, 1.0).unwrap().1.exposure().is_none());
}
