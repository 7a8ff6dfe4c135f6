//! Files that are no scenes, but are taken for such: what they are, and what to do.

use crate::error::Error;
use std::path::Path;

/// Endings of names, what such a file is, and what to do with it.
type Kind = (&'static [&'static str], &'static str, &'static str);

const KINDS: [Kind; 9] = [
    (
        &["exr", "png", "hdr", "rgbe", "pfm", "jpg", "jpeg", "tif", "tiff"],
        "an image",
        "give the scene; \"tyndall info\" of an image that Tyndall made prints the command that made it",
    ),
    (&["sums", "safetensors"], "a checkpoint", "give the scene and --resume, or use \"tyndall merge\""),
    (
        &["blend"],
        "a scene of Blender",
        "export it from Blender by the add-on mitsuba-blender as Mitsuba 3 XML; volumes (.vdb) are rendered as they are",
    ),
    (
        &["pbrt"],
        "a scene of pbrt",
        "write it again as Mitsuba 3 XML or JSON; its volumes (.nvdb) are rendered as they are",
    ),
    (
        &["hip", "hiplc", "hipnc", "ma", "mb", "max", "c4d"],
        "a scene of another program",
        "export its volumes as .vdb and its meshes as .obj or .ply, and name them in a scene",
    ),
    (
        &["usd", "usda", "usdc", "usdz", "gltf", "glb", "fbx", "dae", "abc"],
        "a scene in a format that Tyndall does not read",
        "import it into Blender, and export it by the add-on mitsuba-blender as Mitsuba 3 XML",
    ),
    (
        &["obj", "ply", "serialized"],
        "a mesh",
        "name it in a scene, such as {\"type\": \"ply\", \"filename\": \"mesh.ply\"}; \"tyndall new room\" writes a scene",
    ),
    (
        &["stl", "off"],
        "a mesh in a format that Tyndall does not read",
        "convert it to .ply or .obj, and name it in a scene",
    ),
    (
        &["bgeo", "sc", "fga", "raw", "npy", "npz", "f3d"],
        "data of another program",
        "export the volume as .vdb",
    ),
];

/// The error for the file at `path`, if its name says what it is.
pub(super) fn known(path: &Path) -> Option<Error> {
    let end = path.extension()?.to_string_lossy().to_lowercase();
    let (_, what, remedy) = KINDS.iter().find(|(ends, ..)| ends.contains(&end.as_str()))?;
    Some(Error::new(
        path.display(),
        "a scene file (.xml, .json) or a volume file (.vdb, .nvdb, .vol)",
        *what,
        *remedy,
    ))
}
