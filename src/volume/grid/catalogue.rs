//! What a grid file holds, without building a volume of it.

use super::file::{Values, is_vdb, numbers};
use super::vol;
use crate::{
    description::mend::Survey,
    error::Result,
    math::{DAffine3, DVec3, Spectrum, axes, boxes::image},
    volume::{
        Samples,
        files::{Archive, Field, Label, Source, Sparse, Value, roles::Roles},
    },
};
use std::path::{Path, PathBuf};

/// A file, and what it says of its grids.
pub struct Catalogue {
    path: PathBuf,
    archive: Option<Archive>,
    /// In the file's order. The one of a `.vol` file has no name.
    pub labels: Vec<Label>,
}

/// What a grid is like, its values read.
#[derive(Clone, Debug)]
pub struct Contents {
    /// The first and the last active voxel; none where no voxel is active.
    pub active_box: Option<[[i64; 3]; 2]>,
    /// How many voxels are active.
    pub active: u64,
    /// The least and the greatest active value of every channel.
    pub range: [Vec<f32>; 2],
    /// From indices to where the file says that voxels lie; the centres of voxels have integer indices.
    pub to_world: DAffine3,
    /// The box around all that a `gridvolume` of the grid fills.
    pub domain: [DVec3; 2],
    /// True if all values are 0.
    pub is_nothing: bool,
    /// The greatest finite value, at least 0.
    pub greatest: f32,
    /// Memory that the values take when they have been read (bytes).
    pub bytes: u64,
}

/// Velocities of a file.
#[derive(Clone, Copy, Debug, Default)]
pub struct Velocities {
    /// Bounds of their components, 0 among them.
    pub bounds: [DVec3; 2],
    /// What a number of 1 stands for (m/s); none where the file does not say.
    pub unit: Option<f64>,
}

/// Blender's fluids write velocities in voxels per unit of their own time. A second is 2.5 units at the domain's time scale
/// of 1; the file does not hold that scale. The front of smoke that rose in Blender 5.0 moved by 2.2 to 2.7 times its
/// velocity (four frames, two resolutions, 12 and 24 frames a second).
const VOXELS_PER_SECOND: f64 = 2.5;

/// The grids of a file that are of use, and what they hold.
#[derive(Clone, Debug)]
pub struct Held {
    /// Which they are.
    pub roles: Roles,
    /// What the density holds.
    pub density: Option<Contents>,
    /// What the fire or temperature holds.
    pub fire: Option<Contents>,
    /// Those that are of none, for they hold nothing.
    pub empty: Vec<usize>,
}

impl Contents {
    /// The box around all active voxels in the file's world.
    pub fn active_world(&self) -> Option<[DVec3; 2]> {
        let ends = self.active_box?.map(|index| DVec3::from(index.map(|i| i as f64)));
        Some(image(&self.to_world, [ends[0] - 0.5, ends[1] + 0.5]))
    }

    /// The greatest active number of the first channel; of what is infinite, the greatest that is not.
    pub fn hottest(&self) -> f32 {
        self.range[1][0].min(self.greatest)
    }

    /// Length of a voxel along each axis of the grid.
    pub fn voxel_size(&self) -> DVec3 {
        let axes = self.to_world.matrix3;
        DVec3::new(axes.x_axis.length(), axes.y_axis.length(), axes.z_axis.length())
    }
}

impl Catalogue {
    /// Opens the file at `path`.
    pub fn open(path: &Path) -> Result<Self> {
        let path = path.to_owned();
        if !is_vdb(&path) {
            let channels = match vol::read(&path)?.values {
                Values::Grey(_) => 1,
                Values::Chromatic(_) => 3,
            };
            let kind = if channels == 1 { "float32" } else { "3 x float32" }.to_owned();
            let label = Label { kind, channels: Some(channels), ..Label::default() };
            return Ok(Self { path, archive: None, labels: vec![label] });
        }
        let mut archive = Archive::open(&path).map_err(|problem| problem.at(path.display()))?;
        let labels = archive.labels();
        Ok(Self { path, archive: Some(archive), labels })
    }

    /// True if the file says that a program wrote it whose +z is up.
    pub fn is_z_up(&self) -> bool {
        self.labels.iter().any(|label| label.is_z_up)
    }

    /// True if its grids have names.
    pub fn has_names(&self) -> bool {
        self.archive.is_some()
    }

    /// What of its grids has the `roles` that their names say, its values read: a grid that holds nothing but 0 is as good
    /// as none, as long as there is smoke or fire.
    pub fn held(&mut self, mut roles: Roles) -> Result<Held> {
        let mut read = |number: Option<usize>| number.map(|number| self.contents(number)).transpose();
        let (mut density, mut fire) = (read(roles.density)?, read(roles.temperature)?);
        let is_nothing = |contents: &Option<Contents>| contents.as_ref().is_some_and(|it| it.is_nothing);
        let mut empty = vec![];
        if density.is_some() && is_nothing(&fire) {
            (fire, empty) = (None, roles.temperature.take().into_iter().collect());
        }
        if fire.is_some() && is_nothing(&density) {
            (density, empty) = (None, roles.density.take().into_iter().collect());
        }
        let colours = roles.color.iter().map(|number| read(Some(*number))).collect::<Result<Vec<_>>>()?;
        if colours.iter().all(is_nothing) {
            empty.append(&mut roles.color);
        } else if density.is_none() {
            roles.color.clear();
        }
        Ok(Held { roles, density, fire, empty })
    }

    /// The velocity that grids `numbers` are.
    pub fn velocities(&mut self, numbers: &[usize]) -> Result<Velocities> {
        let grids = numbers.iter().map(|number| self.contents(*number)).collect::<Result<Vec<_>>>()?;
        let is_of_fluids = numbers.iter().any(|number| self.labels[*number].is_of_fluids);
        let voxel = grids.first().filter(|_| is_of_fluids).map(|grid| grid.voxel_size().max_element());
        let bound = |end: usize| {
            let all: Vec<f32> = grids.iter().flat_map(|grid| grid.range[end].iter().copied()).collect();
            DVec3::from(axes(|axis| all.get(axis).copied().unwrap_or_default().into()))
        };
        let bounds = [bound(0).min(DVec3::ZERO), bound(1).max(DVec3::ZERO)];
        Ok(Velocities { bounds, unit: voxel.map(|voxel| VOXELS_PER_SECOND * voxel) })
    }

    /// Reads grid `number`.
    pub fn contents(&mut self, number: usize) -> Result<Contents> {
        match &mut self.archive {
            None => vol::read(&self.path).map(|source| of_vol(&source)),
            Some(archive) => {
                let source = archive.source(number).map_err(|problem| problem.at(self.path.display()))?;
                Ok(of_vdb(&source))
            }
        }
    }
}

fn of_vdb(source: &Source) -> Contents {
    let (active, range, bytes, survey) = match &source.samples {
        Field::Grey(samples) => figures(samples, |value| [value]),
        Field::Colour(samples) => figures(samples, |value| value.to_array()),
    };
    let (low, size) = (source.low, source.size());
    let last = [0, 1, 2].map(|axis| low[axis] + size[axis] as i64 - 2);
    Contents {
        active_box: (active > 0).then_some([low.map(|i| i + 1), last]),
        active,
        range,
        to_world: source.to_world,
        domain: image(&source.to_world, source.voxels()),
        is_nothing: survey.is_nothing(),
        greatest: survey.greatest(),
        bytes,
    }
}

fn figures<V: Value, const N: usize>(
    samples: &Sparse<V>,
    split: impl Fn(V) -> [f32; N],
) -> (u64, [Vec<f32>; 2], u64, Survey) {
    let active = samples.active();
    let range = active.range.map(|value| split(value).to_vec());
    (active.count, range, samples.bytes(), survey(samples, split))
}

fn survey<V, const N: usize>(samples: &(impl Samples<V> + ?Sized), split: impl Fn(V) -> [f32; N]) -> Survey {
    Survey::of(|visit| numbers(samples, &split, visit), f32::INFINITY)
}

fn of_vol(source: &super::Source) -> Contents {
    let (size, range, survey) = match &source.values {
        Values::Grey(samples) => {
            let [low, high] = range(&**samples, f32::min, f32::max);
            (samples.size(), [vec![low], vec![high]], survey(samples, |value| [value]))
        }
        Values::Chromatic(samples) => {
            let ends = range(&**samples, Spectrum::min, Spectrum::max);
            let survey = survey(samples, |value| value.to_array());
            (samples.size(), ends.map(|end| end.to_array().to_vec()), survey)
        }
    };
    let active = size.iter().map(|n| *n as u64).product();
    let voxel = DVec3::from(size.map(|n| 1.0 / n as f64));
    Contents {
        active_box: Some([[0; 3], size.map(|n| n as i64 - 1)]),
        active,
        bytes: active * 4 * range[0].len() as u64,
        range,
        to_world: source.to_file
            * DAffine3::from_scale(voxel)
            * DAffine3::from_translation(DVec3::splat(0.5)),
        domain: image(&source.to_file, [DVec3::ZERO, DVec3::ONE]),
        is_nothing: survey.is_nothing(),
        greatest: survey.greatest(),
    }
}

/// The least and the greatest of all samples, by each channel.
fn range<V: Copy>(samples: &dyn Samples<V>, least: fn(V, V) -> V, greatest: fn(V, V) -> V) -> [V; 2] {
    let [x, y, z] = samples.size();
    let first = samples.at([0; 3]);
    let indices = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
    indices.fold([first; 2], |[low, high], index| {
        let value = samples.at(index);
        [least(low, value), greatest(high, value)]
    })
}
