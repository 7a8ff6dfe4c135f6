//! What is said of outputs that cannot be written, and of a few odd options: commands beside a scene.

use crate::sandbox::Sandbox;
use std::fmt::Write as _;

/// Names, and the words of commands.
const COMMANDS: &[(&str, &str)] = &[
    ("an image inside a file", "render scene.json -o scene.json/a.exr"),
    ("a report over a folder", "render scene.json --report folder"),
    ("a report with the name of a folder", "render scene.json --report other/"),
    ("a report over the image", "render scene.json -o a.exr --report ./a.exr"),
    ("a report over the preview", "render scene.json -o a.exr --report a.png"),
    ("a report over the scene", "render scene.json --report scene.json"),
    ("a report inside a file", "render scene.json --report scene.json/r.json"),
    ("a report on a full device", "render scene.json --spp 1 --report /dev/full"),
    ("a name without the ending of an image", "render scene.json -o image.jpg"),
    ("paths of a pixel in a folder that is missing", "pixel scene.json 0 0 -o missing/p.json"),
    ("outliers of one pixel", "pixel scene.json 0 0 --outliers"),
    ("a page of one pixel", "pixel scene.json 0 0 -o paths.html"),
    ("paths longer than the longest", "render scene.json --min-depth 4 --max-depth 3"),
    ("a gathering of long paths", "render scene.json --integrator gather --min-depth 2"),
    ("a study inside a file", "study scene.json -o scene.json/s"),
    ("strategies in place of a file", "strategies scene.json -o scene.json"),
    ("a conversion to an ending that nobody knows", "convert scene.json scene.yaml"),
    ("half a seed", "render scene.json --seed 1.5"),
    ("a phase function drawn nowhere", "phase hg -o scene.json/drawn"),
];

/// The messages of all of them.
pub(super) fn messages() -> String {
    let lamp = r#""lamp": {"type": "point", "intensity": 1}"#;
    let film = r#""film": {"type": "hdrfilm", "width": 2, "height": 2}"#;
    let sensor = format!(r#""sensor": {{"type": "perspective", {film}}}"#);
    let scene = format!(r#"{{"type": "scene", {sensor}, {lamp}}}"#);
    let sandbox = Sandbox::with_files(&[("scene.json", &scene), ("folder/file", "")]);
    let mut text = String::new();
    for (name, words) in COMMANDS {
        let message = sandbox.run(words).ends(2).err();
        writeln!(text, "# {name}\ntyndall {words}\n{}\n", message.trim_end().replace("\n\n", "\n")).unwrap();
    }
    text
}
