//! Grid files of all formats, seen alike.

use super::{
    super::{Mapped, Samples},
    convert::Convert,
    vol::{self, Vol},
};
use crate::{
    description::{
        Library,
        mend::{self, Mend, Number},
    },
    error::Result,
    math::{DAffine3, DMat3, DVec3, Spectrum},
    volume::files,
};
use std::path::Path;

/// What a file holds.
pub enum Values {
    /// A number per voxel.
    Grey(Box<dyn Samples<f32>>),
    /// A colour per voxel.
    Chromatic(Box<dyn Samples<Spectrum>>),
}

/// A grid as its file has it.
pub struct Source {
    /// The voxels.
    pub values: Values,
    /// From the unit cube to where the file says that the grid lies.
    pub to_file: DAffine3,
    /// The grid's name; empty where grids have none.
    pub name: String,
    /// Other grids of the file that may have been meant.
    pub others: Vec<String>,
}

impl Source {
    /// The same with all values finite and from 0 to `most`, if they almost are; `path` is the file.
    pub fn mended(self, path: &Path, most: f32, library: &Library) -> Result<Self> {
        // Another grid is meant where this one is no density, but no other colour.
        let remedy = match self.others.is_empty() || most.is_finite() {
            true => "correct the grid: densities, colours and light must be finite and in this range".into(),
            false => format!("choose another grid of the file: \"{}\"", self.others.join("\", \"")),
        };
        let place = |number: &Number| {
            let [x, y, z] = number.at;
            format!("channel {} of the voxel ({x}, {y}, {z})", number.channel)
        };
        let file = mend::Source { path, part: &self.name, what: "voxels", place, remedy: &remedy };
        let values = match self.values {
            Values::Grey(samples) => {
                let mend = file.mend(|visit| numbers(&samples, |value| [value], visit), most, library)?;
                Values::Grey(mapped(samples, mend, Mend::of))
            }
            Values::Chromatic(samples) => {
                let mend =
                    file.mend(|visit| numbers(&samples, |value| value.to_array(), visit), most, library)?;
                Values::Chromatic(mapped(samples, mend, |mend, value| value.map(|number| mend.of(number))))
            }
        };
        Ok(Self { values, ..self })
    }
}

/// Shows `visit` the numbers of all samples.
pub(super) fn numbers<V, const N: usize>(
    samples: &(impl Samples<V> + ?Sized),
    split: impl Fn(V) -> [f32; N],
    visit: &mut dyn FnMut(Number),
) {
    samples.each(&mut |at, value, count| {
        for (channel, value) in split(value).into_iter().enumerate() {
            visit(Number { value, at, channel, count });
        }
    });
}

fn mapped<V: 'static>(
    samples: Box<dyn Samples<V>>,
    mend: Option<Mend>,
    of: impl Fn(Mend, V) -> V + Send + Sync + 'static,
) -> Box<dyn Samples<V>> {
    match mend {
        None => samples,
        Some(mend) => Box::new(Mapped::new(samples, move |value| of(mend, value))),
    }
}

/// True if the extension of `path` is one of the formats that hold several grids by name, each with a place in the world.
pub(super) fn is_vdb(path: &Path) -> bool {
    let extension = path.extension().and_then(|extension| extension.to_str()).unwrap_or("");
    ["vdb", "nvdb"].iter().any(|known| extension.eq_ignore_ascii_case(known))
}

/// True if the file at `path` is a volume by its name.
pub fn is_volume(path: &Path) -> bool {
    is_vdb(path) || path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("vol"))
}

/// Opens a grid file; the format follows from the extension, and is Mitsuba's `.vol` for any not known. `grid` is the
/// name of the one that is meant, for formats that hold several.
pub(super) fn open(path: &Path, grid: Option<&str>, convert: Convert) -> Result<Source> {
    let explain = |problem: files::Problem| problem.at(path.display());
    if !is_vdb(path) {
        let source = vol::read(path)?;
        return Ok(Source { values: convert.of(source.values).map_err(explain)?, ..source });
    }
    let source = files::open(path, grid).map_err(explain)?;
    let to_file = source.to_world * cube_to(source.voxels());
    let (name, others) = (source.label.name.clone(), source.others.clone());
    Ok(Source { values: convert.of_source(source).map_err(explain)?, to_file, name, others })
}

/// A grid of the file at `path` as Mitsuba's `.vol` holds it: where it lies and as it is.
pub fn to_vol(path: &Path, grid: Option<&str>) -> Result<Vol> {
    Vol::new(path, open(path, grid, Convert::No)?)
}

/// From the unit cube to a box.
fn cube_to([low, high]: [DVec3; 2]) -> DAffine3 {
    DAffine3 { matrix3: DMat3::from_diagonal(high - low), translation: low }
}
