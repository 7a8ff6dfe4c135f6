//! What a scene is read from: its own file, and all that it includes and names.

use super::{
    draft::Draft,
    input::{bytes, is_standard_input},
};
use crate::{
    description::{Library, Object, Property, Value, keyframes::Key},
    error::{Error, Result},
    inputs::{self, Reader},
    volume::{
        files::sequence::{Clock, Sequence},
        grid::is_volume,
    },
};
use std::{
    fs::File,
    io,
    path::{Path, PathBuf},
};
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

/// All that a scene depends on besides the user's definitions: if none of it changes, the scene does not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sources {
    /// The scene file, the files that it includes, and those that its plugins name (meshes, images, grids) and that
    /// exist, each once.
    pub files: Vec<PathBuf>,
    /// Spectra, which may come from files that the tree no longer names: pairs of wavelength (nm) and value.
    pub spectra: Vec<Vec<(f64, f64)>>,
}

/// A fingerprint of `bytes`: XXH3, 128 bits.
pub fn fingerprint(bytes: &[u8]) -> String {
    format!("{:032x}", xxh3_128(bytes))
}

/// The same of all bytes of the file at `path`.
pub fn file_fingerprint(path: &Path) -> Result<String> {
    if is_standard_input(path) {
        return bytes(path).map(|bytes| fingerprint(&bytes));
    }
    let mut sum = Xxh3::new();
    let copied = File::open(path).and_then(|mut file| io::copy(&mut file, &mut sum));
    copied.map_err(|error| Error::io(path, "read", &error))?;
    Ok(format!("{:032x}", sum.digest128()))
}

impl Sources {
    /// The sources of the scene `draft`, read from `path`. Of numbered files, only the one shown at `time` (s), by
    /// default the scene's own.
    pub(super) fn of(path: &Path, draft: Draft, time: Option<f64>) -> Self {
        // A volume file is what the scene around it names.
        let files = if is_volume(path) { vec![] } else { vec![path.to_owned()] };
        let mut sources = Self { files, spectra: Vec::new() };
        sources.add_all(draft.included);
        sources.walk(&draft.root, time.or(draft.root.number("time")).unwrap_or(0.0));
        sources
    }

    /// Fingerprints of all files by their names, which are relative to the folder of the scene if they lie in it; and of
    /// the spectra.
    pub fn fingerprints(&self) -> Result<Vec<(String, String)>> {
        let folder = self.files.first().and_then(|scene| scene.parent()).unwrap_or(Path::new(""));
        let of_file = |file: &PathBuf| {
            let name = file.strip_prefix(folder).unwrap_or(file).display().to_string();
            Ok((name, file_fingerprint(file)?))
        };
        let mut all: Vec<_> = self.files.iter().map(of_file).collect::<Result<_>>()?;
        if !self.spectra.is_empty() {
            let numbers = self.spectra.iter().flatten().flat_map(|(x, y)| [*x, *y]);
            let bytes: Vec<u8> = numbers.flat_map(f64::to_le_bytes).collect();
            all.push(("spectra".to_owned(), fingerprint(&bytes)));
        }
        Ok(all)
    }

    fn walk(&mut self, object: &Object, time: f64) {
        for property in &object.properties {
            match &property.value {
                Value::Object(child) => self.walk(child, time),
                Value::Spectrum(pairs) => self.spectra.push(pairs.clone()),
                Value::Keyframes(keyframes) => {
                    self.spectra.extend(keyframes.keys().iter().filter_map(spectrum))
                }
                _ => self.add_all(named(property).map(|path| shown(object, path, time))),
            }
        }
    }

    /// A file that is not there is for its plugin to complain about.
    fn add_all(&mut self, files: impl IntoIterator<Item = PathBuf>) {
        for file in files {
            if file.is_file() && !self.files.contains(&file) {
                self.files.push(file);
            }
        }
    }
}

fn spectrum(key: &Key) -> Option<Vec<(f64, f64)>> {
    if let Value::Spectrum(pairs) = &key.value.value { Some(pairs.clone()) } else { None }
}

/// The file that a property names, as plugins look for it. All such properties end so.
fn named(property: &Property) -> Option<PathBuf> {
    match &property.value {
        Value::String(name) if property.name.ends_with("filename") => {
            Some(Library::default().file(name, &property.location))
        }
        _ => None,
    }
}

/// Notes all files that the objects in `root` name; of numbered ones, whichever is shown when.
pub(super) fn note(object: &Object) {
    for property in &object.properties {
        if let Value::Object(child) = &property.value {
            note(child);
        }
        let Some(path) = named(property) else { continue };
        match Sequence::new(&path, Clock::of(object)) {
            Some(sequence) => sequence.files().for_each(|file| inputs::note(&file, Reader::Scene)),
            None => inputs::note(&path, Reader::Scene),
        }
    }
}

/// The file that `path` is at `time` (s) for a plugin, which may show numbered ones.
fn shown(object: &Object, path: PathBuf, time: f64) -> PathBuf {
    let sequence = Sequence::new(&path, Clock::of(object)).and_then(|sequence| sequence.at(time).ok());
    sequence.unwrap_or(path)
}

#[cfg(test)]
mod tests {
    use crate::format::sources;
    use std::fs;

    #[test]
    fn whatever_a_scene_is_read_from_is_found_once() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::create_dir(path("parts")).unwrap();
        let scene = r#"<scene version="3.0.0"><include filename="parts/wall.xml"/>
            <emitter type="envmap"><string name="filename" value="sky.exr"/></emitter>
            <shape type="ply"><string name="filename" value="none.ply"/></shape></scene>"#;
        let wall = r#"<scene version="3.0.0"><shape type="obj"><string name="filename" value="wall.obj"/>
            <bsdf type="diffuse"><spectrum name="reflectance" filename="grey.spd"/></bsdf></shape>
            <shape type="obj"><string name="filename" value="wall.obj"/></shape></scene>"#;
        let files =
            [("scene.xml", scene), ("parts/wall.xml", wall), ("parts/grey.spd", "400 0.5\n700 0.25\n")];
        for (name, text) in files.into_iter().chain([("sky.exr", ""), ("parts/wall.obj", "")]) {
            fs::write(path(name), text).unwrap();
        }
        let mut found = sources(&path("scene.xml"), &[], None).unwrap();
        found.files.sort();
        assert_eq!(found.files, ["parts/wall.obj", "parts/wall.xml", "scene.xml", "sky.exr"].map(path));
        assert_eq!(found.spectra, [[(400.0, 0.5), (700.0, 0.25)]]);
    }
}
