//! What every target does with its bytes: a file of them, read through the public interface as a user's scene.
//! An error is fine; a panic, a hang, or memory beyond all proportion to the file is a find.

use std::{fs, path::PathBuf, sync::OnceLock};
use tempfile::TempDir;
use tyndall::{
    format,
    format::Spelling,
    scene::{self},
    settings::Overrides,
    volume::files,
};

fn path(name: &str) -> PathBuf {
    static FOLDER: OnceLock<TempDir> = OnceLock::new();
    FOLDER.get_or_init(|| TempDir::new().expect("a folder for temporaries")).path().join(name)
}

fn put(name: &str, data: &[u8]) -> PathBuf {
    let path = path(name);
    fs::write(&path, data).expect("a file for the fuzzer's bytes");
    path
}

/// Reads and builds the scene at `path`; mistakes in it must have all their parts.
fn load(path: PathBuf) {
    let built = format::read(&path, &[]).and_then(|root| scene::build::build(&root, Overrides::default()));
    if let Err(error) = built {
        for part in [error.place, error.expected, error.found, error.remedy] {
            assert!(!part.is_empty(), "a message without one of its parts");
        }
    }
}

/// `data` as a scene file. What can be read can be written in both spellings, and means the same again.
pub fn scene(name: &str, data: &[u8]) {
    let path = put(name, data);
    if let Ok(root) = format::read(&path, &[]) {
        let folder = path.parent().expect("a file has a folder");
        for (spelling, copy) in [(Spelling::Xml, "copy.xml"), (Spelling::Json, "copy.json")] {
            let Ok(text) = format::write(&root, spelling, folder) else { continue };
            let again = format::read(&put(copy, text.as_bytes()), &[]).expect("what is written can be read");
            let again = format::write(&again, spelling, folder).expect("and written again");
            assert_eq!(text, again, "what is written again is the same");
        }
    }
    load(path);
}

const CAMERA: &str =
    r#""camera": {"type": "perspective", "film": {"type": "hdrfilm", "width": 4, "height": 4}}"#;

fn around(inside: &str) -> PathBuf {
    put("scene.json", format!(r#"{{"type": "scene", {CAMERA}, "thing": {inside}}}"#).as_bytes())
}

/// `data` as the file of a shape whose type is the ending of that file.
pub fn shape(kind: &str, data: &[u8]) {
    put(&format!("mesh.{kind}"), data);
    load(around(&format!(r#"{{"type": "{kind}", "filename": "mesh.{kind}"}}"#)));
}

/// `data` as an image, which a texture reads.
pub fn image(ending: &str, data: &[u8]) {
    put(&format!("image.{ending}"), data);
    let texture = format!(r#"{{"type": "bitmap", "filename": "image.{ending}"}}"#);
    load(around(&format!(
        r#"{{"type": "rectangle", "bsdf": {{"type": "diffuse", "reflectance": {texture}}}}}"#
    )));
}

/// `data` as the values of a `tabphase`.
pub fn phase_table(data: &[u8]) {
    let text = String::from_utf8_lossy(data);
    let plain = text.chars().filter(|c| !c.is_control() && !"\"\\$".contains(*c)).collect::<String>();
    let phase = format!(r#"{{"type": "tabphase", "values": "{plain}"}}"#);
    load(around(&format!(r#"{{"type": "cube", "interior": {{"type": "homogeneous", "phase": {phase}}}}}"#)));
}

/// `data` as a file of volumes, of which every usual grid is read.
pub fn volume(ending: &str, data: &[u8]) {
    let path = put(&format!("volume.{ending}"), data);
    for grid in [None, Some("density"), Some("smoke"), Some("Cd"), Some("temperature")] {
        if let Err(problem) = files::open(&path, grid) {
            for part in [problem.expected, problem.found, problem.remedy] {
                assert!(!part.is_empty(), "a message without one of its parts");
            }
        }
    }
}
