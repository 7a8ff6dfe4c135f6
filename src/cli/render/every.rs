//! One image a sensor: `--sensor all`.

use super::arguments::Render;
use crate::{
    error::{Error, Result},
    film::output,
    format,
    scene::sensors,
};
use std::path::{Path, PathBuf};

/// What `--sensor` calls all of them.
pub(super) const ALL: &str = "all";

/// The renders of all sensors, each into a file with the sensor's name behind its own.
pub(super) fn sensor(arguments: &Render) -> Result<Vec<Render>> {
    let scene = &arguments.scene;
    let output = arguments.output.clone().unwrap_or_else(|| scene.name());
    let single = [
        ("--sums", arguments.sums.is_some()),
        ("--resume", arguments.resume),
        ("--report", arguments.answer.report.is_some()),
        ("--json", arguments.answer.json),
        ("a device or pipe as output", output::is_stream(&output)),
        ("a scene on standard input", format::is_standard_input(&scene.file)),
    ];
    if let Some((found, _)) = single.into_iter().find(|(_, given)| *given) {
        let remedy = "name one sensor at a time";
        return Err(Error::new("--sensor all", "options that several images can share", found, remedy));
    }
    let root = format::read(&scene.file, &scene.definitions)?;
    let mut renders: Vec<Render> = Vec::new();
    for name in sensors::names(&root)? {
        let path = behind(&output, &name);
        if renders.iter().any(|other| other.output.as_deref().is_some_and(|other| is_same(other, &path))) {
            let found = format!("a second one for {}", path.display());
            let remedy = format!("give the sensor \"{name}\" another id");
            return Err(Error::new("--sensor all", "one sensor for each file", found, remedy));
        }
        let mut one = Render { output: Some(path), ..arguments.clone() };
        one.scene.sensor = Some(name);
        renders.push(one);
    }
    Ok(renders)
}

/// `path` with `_name` behind its stem. A dot in the name would begin an ending, a slash a folder.
fn behind(path: &Path, name: &str) -> PathBuf {
    let name = name.replace(|letter: char| !(letter.is_alphanumeric() || "-_ ".contains(letter)), "_");
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let end = path.extension().map_or(String::new(), |end| format!(".{}", end.to_string_lossy()));
    path.with_file_name(format!("{stem}_{name}{end}"))
}

/// True of two names that may be one file: some file systems do not tell capitals from small letters.
fn is_same(a: &Path, b: &Path) -> bool {
    a.to_string_lossy().to_lowercase() == b.to_string_lossy().to_lowercase()
}
