//! The scene that a command is about, and the threads that work on it.

use super::{
    console::{announce, complain},
    media,
    parsers::{definition, scene_file},
};
use crate::{
    description::Object,
    error::{Error, Result},
    format,
    scene::{
        build::{self, Setup},
        sensors,
    },
    settings::Overrides,
    volume::grid::is_volume,
};
use clap::Args;
use std::{num::NonZeroUsize, path::PathBuf};

/// A scene file and its parameters.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Scene {
    /// Scene file: Mitsuba 3 XML (.xml) or JSON (.json), or - for standard input; or a volume file (.vdb, .nvdb, .vol)
    ///
    /// Of a volume file, or of numbered ones (plume_####.vdb), it is the scene that `tyndall new` writes. On standard input the first character tells the format. Names of other files in the scene then start at the
    /// current folder, and outputs without a name of their own are called "stdin".
    #[arg(value_name = "SCENE", value_parser = scene_file())]
    pub file: PathBuf,

    /// Set the parameter $name of the scene instead of its default; may be repeated
    #[arg(short = 'D', value_name = "name=value", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Sensor to see the scene by, where it has several: its id, or its number from 0 in file order [default: the first]
    ///
    /// `tyndall render --sensor all` renders one image after the other: NAME_SENSOR.exr and so on.
    #[arg(long, value_name = "SENSOR")]
    pub sensor: Option<String>,

    /// Refuse files with numbers a hair out of range instead of mending them
    ///
    /// Of volumes and images: negative numbers become 0, albedos and reflectances above 1 become 1, infinite numbers the
    /// greatest finite one of the file, each file with one warning. NaN is an error, and so are numbers so far out of range
    /// that they must mean something else: more than one in a hundred of those that are not 0, by more than a fifth of the
    /// greatest.
    #[arg(long)]
    pub strict: bool,
}

impl Scene {
    /// What the file says, with the one sensor that is wanted.
    pub fn read(&self) -> Result<Object> {
        format::told(&self.file)?.iter().for_each(|line| announce(line));
        let root = format::read(&self.file, &self.definitions)?;
        match &self.sensor {
            None => Ok(root),
            Some(sensor) => sensors::only(&root, sensor),
        }
    }

    /// What outputs are called that have no name of their own.
    pub fn name(&self) -> PathBuf {
        match format::is_standard_input(&self.file) {
            true => "stdin".into(),
            false if is_volume(&self.file) && !self.file.is_file() => self.unnumbered(),
            false => self.file.file_stem().unwrap_or_default().into(),
        }
    }

    /// What comes before the number in the name of numbered files; of none, "smoke".
    fn unnumbered(&self) -> PathBuf {
        let stem = self.file.file_stem().unwrap_or_default().to_string_lossy();
        let name = stem.split(['#', '%']).next().unwrap_or_default().trim_end_matches(['_', '.', '-']);
        if name.is_empty() { "smoke".into() } else { name.into() }
    }
}

/// Reads and builds a scene; warnings go to standard error.
pub(super) fn load(scene: &Scene, overrides: Overrides) -> Result<Setup> {
    let overrides = Overrides { strict: scene.strict, ..overrides };
    built(&scene.read()?, overrides)
}

/// Builds what was read; warnings go to standard error.
pub(super) fn built(root: &Object, overrides: Overrides) -> Result<Setup> {
    let setup = build::build(root, overrides)?;
    for warning in &setup.warnings {
        complain(&format!("warning: {warning}"));
    }
    media::warn_of_idle(&overrides, &setup);
    Ok(setup)
}

/// The threads that render.
pub(super) fn threads(wanted: Option<NonZeroUsize>) -> Result<rayon::ThreadPool> {
    let threads = wanted.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Error::new("--threads", "a number of threads this machine can start", error.to_string(), "use fewer")
    })
}
