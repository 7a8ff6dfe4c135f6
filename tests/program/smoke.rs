//! Volume files as tools write them: what is in them, and smoke made of them.

use crate::sandbox::Sandbox;
use flate2::read::GzDecoder;
use serde_json::{Value, json};
use std::{
    fs::{self, File},
    io::Read as _,
    path::Path,
};

impl Sandbox {
    /// Adds the file `sample` of src/volume/files/samples, unpacked, as `name`.
    pub(crate) fn with_sample(self, sample: &str, name: &str) -> Self {
        let samples = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/volume/files/samples");
        let mut bytes = vec![];
        let file = File::open(samples.join(format!("{sample}.gz"))).unwrap();
        GzDecoder::new(file).read_to_end(&mut bytes).unwrap();
        fs::write(self.path(name), bytes).unwrap();
        self
    }
}

fn camera() -> Value {
    let look = json!([{"type": "lookat", "origin": [0.6, 1, 6], "target": [0.6, 1, 0.6], "up": [0, 1, 0]}]);
    let film = json!({"type": "hdrfilm", "width": 12, "height": 16});
    json!({"type": "perspective", "fov": 30, "to_world": look, "film": film})
}

/// A scene that is complete: smoke of a file, a light, a camera.
fn scene(filename: &str) -> Value {
    json!({
        "type": "scene",
        "plume": {"type": "smoke", "filename": filename, "density_scale": 3},
        "sky": {"type": "constant"},
        "camera": camera(),
    })
}

/// The same as [`scene`] of houdini.vdb.
fn by_hand() -> Value {
    let grid = |name: &str| json!({"type": "gridvolume", "filename": "houdini.vdb", "grid": name});
    let mut fire = grid("burn");
    fire["convert"] = "blackbody".into();
    fire["temperature_scale"] = 1500.into();
    fire["temperature_offset"] = 1500.into();
    let plume = json!({"type": "heterogeneous", "sigma_t": grid("density"), "scale": 3, "albedo": grid("Cd"), "emission": fire, "emission_scale": 0.01});
    let place = json!([{"type": "scale", "value": [0.875, 1.25, 0.875]}, {"type": "translate", "value": [0.5, 0.875, 0.5]}]);
    let shape = json!({"type": "cube", "to_world": place, "bsdf": {"type": "null"}, "interior": {"type": "ref", "id": "plume"}});
    json!({"type": "scene", "plume": plume, "box": shape, "sky": {"type": "constant"}, "camera": camera()})
}

#[test]
fn a_line_of_smoke_is_the_same_as_twenty_by_hand() {
    let sandbox = Sandbox::with_scene(&scene("houdini.vdb")).with_sample("houdini.vdb", "houdini.vdb");
    fs::write(sandbox.path("hand.json"), by_hand().to_string()).unwrap();
    let xml = r#"<scene version="3.0.0"><shape type="smoke"><string name="filename" value="houdini.vdb"/>
        <float name="density_scale" value="3"/></shape><emitter type="constant"/><sensor type="perspective">
        <float name="fov" value="30"/><transform name="to_world"><lookat origin="0.6, 1, 6" target="0.6, 1, 0.6" up="0, 1, 0"/>
        </transform><film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="16"/></film></sensor></scene>"#;
    fs::write(sandbox.path("smoke.xml"), xml).unwrap();
    for file in ["scene.json", "hand.json", "smoke.xml"] {
        let run = sandbox.run(&format!("render {file} --spp 4 -o {file}.exr")).ends(0);
        assert!(!run.err().contains("warning"), "{}", run.err());
    }
    let image = sandbox.channels("hand.json.exr");
    assert_eq!(sandbox.channels("scene.json.exr"), image);
    assert_eq!(sandbox.channels("smoke.xml.exr"), image);
}

#[test]
fn info_of_a_scene_tells_what_smoke_took() {
    let sandbox = Sandbox::with_scene(&scene("houdini.vdb")).with_sample("houdini.vdb", "houdini.vdb");
    let run = sandbox.run("info scene.json --report r.json").ends(0);
    let expected = "smoke       plume: houdini.vdb, density from \"density\", light from \"burn\" (1500 K + 1500 K x its value, up to 3000 K), colour from \"Cd\"; not used: \"temperature\", \"vel\" (a velocity)\n";
    assert!(run.out().contains(expected), "{}", run.out());
    let smoke = &sandbox.json("r.json")["smoke"][0];
    assert_eq!((&smoke["density"], &smoke["temperature"]["grid"]), (&json!("density"), &json!("burn")));
}

#[test]
fn info_of_a_volume_file_lists_its_grids() {
    let sandbox = Sandbox::new().with_sample("houdini.vdb", "a.vdb").with_sample("several.nvdb", "b.NVDB");
    let text = sandbox.run("info a.vdb").ends(0).out();
    let lines: Vec<_> = text.lines().collect();
    let expected = [
        "grid        \"density\", Tree_float_5_4_3, fog volume",
        "  voxels    5 x 8 x 5, from [0, 0, 0] to [4, 7, 4]; 72 are active",
        "  world     [-0.125, -0.125, -0.125] to [1.125, 1.875, 1.125], voxels of [0.25, 0.25, 0.25]",
        "  values    0.09375 to 1",
        "  memory    2.0 kB",
    ];
    assert_eq!(lines[..5], expected, "{text}");
    assert!(text.contains("\"vel\", Tree_vec3s_5_4_3, fog volume, a velocity\n"), "{text}");
    let last = [
        "smoke       density from \"density\", light from \"burn\", colour from \"Cd\", carried along by \"vel\" while \
         the shutter is open",
        "scene       tyndall render a.vdb renders it; tyndall new a.vdb writes a scene",
    ];
    assert_eq!(lines[lines.len() - 2..], last);
    let figures: Value = serde_json::from_str(&sandbox.run("info a.vdb --json").ends(0).out()).unwrap();
    let density = &figures["grids"][0];
    assert_eq!((&density["box"], &density["active_voxels"]), (&json!([[0, 0, 0], [4, 7, 4]]), &json!(72)));
    assert_eq!(density["world"], json!([[-0.125, -0.125, -0.125], [1.125, 1.875, 1.125]]));
    // What cannot be read is listed all the same.
    let text = sandbox.run("info b.NVDB").ends(0).out();
    assert!(text.contains("grid        \"ids\", int32") && text.contains("not read"), "{text}");
    let smoke = text.lines().find(|line| line.starts_with("smoke       ")).unwrap();
    assert!(smoke.contains("density_grid"), "{text}");
    let missing = sandbox.run("info c.vdb").ends(2).err();
    assert!(missing.contains("c.vdb: expected a file to read"), "{missing}");
}

#[test]
fn info_of_a_vol_file_tells_what_a_grid_without_a_name_is_like() {
    let sandbox = Sandbox::new();
    let grid = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/crosscheck/assets/smoke_colours.vol");
    fs::copy(grid, sandbox.path("a.vol")).unwrap();
    let text = sandbox.run("info a.vol").ends(0).out();
    assert!(
        text.contains("the only grid, 3 x float32")
            && text.contains("smoke       density from the only grid"),
        "{text}"
    );
    fs::write(sandbox.path("scene.json"), scene("a.vol").to_string()).unwrap();
    assert!(sandbox.run("info scene.json").ends(0).out().contains("density from its grid"));
}

#[test]
fn frames_of_numbered_files_show_each_its_own() {
    // The first frame has neither fire nor colours.
    let sandbox = Sandbox::with_scene(&scene("a_%04d.vdb"));
    let sandbox = sandbox.with_sample("twins.vdb", "a_0007.vdb").with_sample("houdini.vdb", "a_0008.vdb");
    let run =
        sandbox.run("render scene.json -o a.exr --frames 0..1 --fps 24 --spp 4 --report r.json").ends(0);
    assert!(!run.err().contains("warning"), "{}", run.err());
    let figures = sandbox.json("r.json");
    let profile = |frame: usize| figures["frames"][frame]["profile"].clone();
    assert_ne!(profile(0), profile(1), "fire is a matter of the second frame only");
    let second = sandbox.channels("a.0001.exr");
    assert_ne!(sandbox.channels("a.0000.exr"), second);
    sandbox.run("render scene.json -o a.exr --frames 1 --fps 24 --spp 4").ends(0);
    assert_eq!(sandbox.channels("a.0001.exr"), second);
    let made: Value = serde_json::from_str(&sandbox.run("info a.0001.exr --json").ends(0).out()).unwrap();
    assert!(made["settings"]["files"]["a_0008.vdb"].is_string(), "{made}");
}

#[test]
fn info_of_numbered_files_tells_which_there_are_and_what_the_first_holds() {
    let sandbox =
        Sandbox::new().with_sample("twins.vdb", "a_0007.vdb").with_sample("houdini.vdb", "a_0009.vdb");
    let text = sandbox.run("info a_####.vdb").ends(0).out();
    assert!(
        text.starts_with("frames      2: 7 and 9\nthe first   a_0007.vdb\ngrid        \"density[0]\""),
        "{text}"
    );
    let figures: Value = serde_json::from_str(&sandbox.run("info a_%04d.vdb --json").ends(0).out()).unwrap();
    assert_eq!(figures["frames"], json!([7, 9]));
    sandbox.run("info b_####.vdb").refuses(&["none for \"b_####.vdb\""]);
}

#[test]
fn a_frame_without_a_file_is_told_of_before_anything_is_rendered() {
    let sandbox = Sandbox::with_scene(&scene("a_####.vdb"));
    let sandbox = sandbox.with_sample("twins.vdb", "a_0007.vdb").with_sample("twins.vdb", "a_0009.vdb");
    let run = sandbox.run("render scene.json -o a.exr --frames 0..2 --spp 1").ends(2);
    let expected = "error: frame 1, at 0.041666666666666664 s: scene.json $.plume.filename: expected a_0008.vdb, the frame at 0.041666666666666664 s x 24 frames per second after frame 7, found frames 7 and 9\n  remedy: correct \"first_frame\", \"fps\" or the time, or write the frames that are missing\n";
    assert_eq!(run.err(), expected);
    assert_eq!(sandbox.files(), ["a_0007.vdb", "a_0009.vdb", "scene.json"]);
    let none = Sandbox::with_scene(&scene("b_####.vdb")).run("info scene.json").ends(2).err();
    assert!(none.contains("found none for \"b_####.vdb\""), "{none}");
}

/// Mitsuba's file of one grid among several holds the same smoke, where the OpenVDB file says that it lies.
#[test]
fn a_grid_becomes_mitsubas_file() {
    let mut grid = json!({"type": "gridvolume", "filename": "a.vdb", "grid": "burn", "use_grid_bbox": true});
    let room = |grid: &Value| {
        let medium = json!({"type": "heterogeneous", "sigma_t": grid, "scale": 3});
        let size = json!([{"type": "scale", "value": 9}]);
        let smoke = json!({"type": "cube", "to_world": size, "bsdf": {"type": "null"}, "interior": medium});
        json!({"type": "scene", "smoke": smoke, "sky": {"type": "constant"}, "camera": camera()})
    };
    let sandbox = Sandbox::with_scene(&room(&grid)).with_sample("houdini.vdb", "a.vdb");
    sandbox.run("convert a.vdb a.vol --grid burn").ends(0);
    grid = json!({"type": "gridvolume", "filename": "a.vol", "use_grid_bbox": true});
    fs::write(sandbox.path("b.json"), room(&grid).to_string()).unwrap();
    sandbox.run("render scene.json --spp 1 -o a.exr").ends(0);
    sandbox.run("render b.json --spp 1 -o b.exr").ends(0);
    assert_eq!(sandbox.channels("a.exr"), sandbox.channels("b.exr"));
    sandbox.run("convert scene.json c.vol").refuses(&["scene.json", "a volume file", "a scene"]);
    sandbox.run("convert a.vdb c.vol --grid fire").refuses(&["a.vdb", "fire"]);
    sandbox.run("convert a.vdb c.json --grid burn").refuses(&["--grid", "a .vol file to write"]);
    sandbox.run("convert a.vdb c.vol -D x=1").refuses(&["-D", "a scene file to write"]);
    sandbox.run("convert a.vdb a.vdb.vol --view agx").refuses(&["--view", "a PNG to write"]);
}
