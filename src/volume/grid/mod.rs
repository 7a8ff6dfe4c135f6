//! `gridvolume`: values on a lattice of voxels, from a file, as in Mitsuba.
//!
//! The voxels fill the unit cube of `to_world` (or of the file's own box); their centres lie at (i + 1/2) /
//! n. [`VolumeModel::contains`] says where the value counts: as in Mitsuba, within the axis-aligned box
//! around the transformed cube. [`VolumeModel::eval`] goes on beyond it as `wrap_mode` says, and so it does
//! in what a turned or sheared cube leaves of its box; integrals and inversions count the box and no more.

mod advection;
mod catalogue;
mod checks;
mod convert;
mod file;
mod lattice;
mod sixfold;
#[cfg(test)]
mod tests;
mod vol;
mod voxel;
mod walk;
mod wrap;

use super::{Coarse, Place, VolumeModel};
use crate::{
    description::{Library, Params, Table, table},
    error::{Error, Result},
    math::{
        Affine3A, Channels, DAffine3, DVec3, RaySegment, Spectrum, Vec3, axes,
        boxes::{image, narrowed},
        cells::{Cells, Crossing},
    },
};
use advection::{Flow, Velocity};
use checks::*;
use convert::Convert;
pub use convert::HOTTEST;
use lattice::{BRICK, Brick, Lattice};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};
use voxel::Voxel;
use walk::{Line, Target, Walk};

pub use advection::{FARTHEST, too_far};

pub use crate::math::Wrap;
pub use catalogue::{Catalogue, Contents, Held, Velocities};
pub use file::{Source, Values, is_volume, to_vol};
pub use lattice::Filter;
pub use sixfold::Sixfold;

/// Where an optical depth, summed along a segment, reaches a given value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reached<L> {
    /// Within the segment.
    Within {
        /// The place (m).
        t: f32,
        /// The depth of every channel up to there.
        depth: L,
        /// The extinction there, scaled (1/m); that of the hero is not 0.
        value: L,
    },
    /// Not at all.
    Beyond {
        /// The depth of every channel along the whole segment.
        depth: L,
    },
}

/// A lattice of numbers or colours. Cheap to clone: all of it is shared.
#[derive(Clone, Debug)]
pub struct Grid {
    bricks: Bricks,
    frame: Arc<Frame>,
}

/// Where a grid lies.
#[derive(Debug)]
struct Frame {
    wrap: Wrap,
    /// From the world to the unit cube.
    to_local: DAffine3,
    /// From the world to the lattice, in cells.
    to_lattice: DAffine3,
    /// From the unit cube to the lattice: a scale and then a shift.
    scale: DVec3,
    shift: DVec3,
    /// The box around the transformed cube.
    domain: [DVec3; 2],
}

#[derive(Clone, Debug)]
enum Bricks {
    Grey(Arc<Lattice<f32>>),
    Chromatic(Arc<Lattice<Spectrum>>),
}

/// Evaluates `$body` for the lattice, whatever it holds.
macro_rules! each {
    ($grid:expr, $lattice:ident => $body:expr) => {
        match &$grid.bricks {
            Bricks::Grey($lattice) => $body,
            Bricks::Chromatic($lattice) => $body,
        }
    };
}

/// What a description gives.
struct Given<'a> {
    path: PathBuf,
    grid: Option<&'a str>,
    filter: Filter,
    wrap: Wrap,
    to_world: DAffine3,
    uses_file_box: bool,
    convert: Convert,
    /// The velocity that carries it along, and for how long (s).
    velocity: Option<(&'a str, f64)>,
    seconds: f64,
}

impl<'a> Given<'a> {
    fn read(params: &Params<'a>, place: &Place) -> Result<Self> {
        let path = params.file("filename")?;
        let is_vdb = file::is_vdb(&path);
        if params.object.properties.iter().any(|property| property.name == "data")
            || (params.has("grid") && !is_vdb)
        {
            let remedy = "save the grid to a file and give its name as \"filename\"; \"grid\" names one of several \
                          in a .vdb or .nvdb file";
            return Err(Error::new(params.location(), "a grid file", "a grid in memory", remedy));
        }
        params.boolean("raw")?;
        let filters = [("trilinear", Filter::Trilinear), ("nearest", Filter::Nearest)];
        Ok(Self {
            grid: params.optional_string("grid")?,
            filter: params.choice("filter_type", &filters)?,
            wrap: params.choice("wrap_mode", &Wrap::NAMES)?,
            to_world: place.to_world(params)?,
            uses_file_box: params.optional_boolean("use_grid_bbox")?.unwrap_or(is_vdb),
            convert: Convert::read(params)?,
            velocity: velocity(params)?,
            seconds: place.after,
            path,
        })
    }

    /// The file, as the velocity has carried its values along.
    fn source(&self, most: f32, library: &Library) -> Result<Source> {
        let Self { path, grid, convert, .. } = self;
        let read = || file::open(path, *grid, *convert)?.mended(path, most, library);
        let Some((names, scale)) = self.velocity.filter(|_| self.seconds != 0.0) else { return read() };
        let key = format!("{} {grid:?} {convert:?} {names} {scale}", path.display());
        let flow = library
            .kept
            .recall(key, || Ok(Flow { source: read()?, velocity: Velocity::read(path, names, scale)? }))?;
        flow.after(path, self.seconds)
    }
}

/// Names the grid of a velocity that carries values along.
pub const VELOCITY: &str = "velocity_grid";

/// The grids of the velocity that carries values along, and what theirs are times (m/s); none where none is given.
fn velocity<'a>(params: &Params<'a>) -> Result<Option<(&'a str, f64)>> {
    let (names, scale) = (params.optional_string(VELOCITY)?, params.float("velocity_scale")?);
    Ok(names.filter(|names| !names.trim().is_empty()).map(|names| (names, scale)))
}

impl Grid {
    pub(super) const TABLE: Table = table! {
        "Voxels from a file; they fill the unit cube of `to_world`, or the file's own box.";
        file("filename", "The file: .vol, .vdb or .nvdb."),
        text("grid", "the name of a grid", Said("density, or the only one"), "Name of the grid in a .vdb or .nvdb file.").ours(),
        choice("filter_type", &["trilinear", "nearest"], "trilinear", "Interpolation."),
        choice("wrap_mode", &words::<3, _>(&Wrap::NAMES), "clamp", "Lookup outside the voxels, within the world box around them."),
        boolean("raw", false, "No effect: voxels are numbers."),
        boolean("use_grid_bbox", false, "True: the voxels fill the file's own box.").said("true for .vdb and .nvdb files, else false"),
        transform("to_world", "Places the unit cube."),
        choice("convert", &words::<3, _>(&Convert::NAMES), "none", "`fog`: level set to density. `blackbody`: temperature to radiance.").ours(),
        number("temperature_scale", "K", within(0.0, HOTTEST), Is(1.0), "For `blackbody`: kelvin per unit of the grid.").ours(),
        number("temperature_offset", "K", within(0.0, HOTTEST), Is(0.0), "For `blackbody`: temperature just above a value of 0.").ours(),
        text(VELOCITY, "the name of a grid, or three with commas", Optional, "Grid of the same file (m/s, in its world) that carries the values along while the camera's shutter is open.").ours(),
        number("velocity_scale", "", ANY, Is(1.0), "Multiplies the velocity.").ours(),
        ignored("accel", "the maximum is known, and no texture unit runs"),
        ignored("max_value", "the maximum is known, and no texture unit runs"),
    };

    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let given = Given::read(params, place)?;
        let source = given.source(place.most, params.library)?;
        let Given { path, filter, wrap, mut to_world, uses_file_box, .. } = given;
        if uses_file_box {
            check_box(&path, &source.to_file)?;
            to_world *= source.to_file;
        }
        Self::new(&path, source.values, filter, wrap, to_world)
    }

    /// Makes bricks of `values`, which are finite and at least 0 and whose voxels fill the unit cube of `to_world`; errors
    /// name `path`. More of them than memory holds is an error.
    pub fn new(path: &Path, values: Values, filter: Filter, wrap: Wrap, to_world: DAffine3) -> Result<Self> {
        let to_local = to_world.inverse();
        check_place(path, &to_world, &to_local)?;
        let domain = image(&to_world, [DVec3::ZERO, DVec3::ONE]);
        let size = match &values {
            Values::Grey(samples) => samples.size(),
            Values::Chromatic(samples) => samples.size(),
        };
        // Before anything looks at all of its border.
        check_bricks(path, size, &extent(size, filter, [DVec3::ZERO, DVec3::ONE]).0)?;
        let reach = reach(&values, wrap, image(&to_local, domain));
        let (extent, shift) = extent(size, filter, reach);
        check_bricks(path, size, &extent)?;
        let scale = DVec3::from(size.map(|n| n as f64));
        let to_lattice = DAffine3::from_translation(shift) * DAffine3::from_scale(scale) * to_local;
        let to_world = to_lattice.inverse();
        // What a ray within the box never reaches is not kept.
        let is_needed = |brick: [usize; 3]| {
            let low = DVec3::from(brick.map(|i| (i * BRICK) as f64 - 0.01));
            let [low, high] = image(&to_world, [low, low + (BRICK as f64 + 0.02)]);
            low.cmple(domain[1]).all() && high.cmpge(domain[0]).all()
        };
        let bricks = match values {
            Values::Grey(samples) => {
                let bytes = Lattice::most_bytes(&*samples, wrap, filter, &extent);
                check_memory(path, size, Some(bytes))?;
                Bricks::Grey(Arc::new(Lattice::build(&*samples, wrap, filter, &extent, is_needed)))
            }
            Values::Chromatic(samples) => {
                let bytes = Lattice::most_bytes(&*samples, wrap, filter, &extent);
                check_memory(path, size, Some(bytes))?;
                let lattice = Lattice::build(&*samples, wrap, filter, &extent, is_needed);
                drop(samples);
                collapse(lattice)
            }
        };
        let frame = Arc::new(Frame { wrap, to_local, to_lattice, scale, shift, domain });
        Ok(Self { bricks, frame })
    }

    /// The grid from afar: a cell a brick. The means are those of the parts of bricks that lie in the box.
    pub fn coarse(&self) -> Coarse {
        let cells = each!(self, lattice => lattice.bricks.iter().map(Brick::summary).collect());
        Coarse::from_cells(self.bricks(), self.to_bricks(), cells)
    }

    /// Bricks of 8 x 8 x 8 cells along x, y and z.
    pub fn bricks(&self) -> [u32; 3] {
        each!(self, lattice => lattice.size.map(|n| n as u32))
    }

    /// From world positions to the lattice of bricks, each a unit cube.
    pub fn to_bricks(&self) -> Affine3A {
        let map = DAffine3::from_scale(DVec3::splat(1.0 / BRICK as f64)) * self.frame.to_lattice;
        Affine3A::from_mat3_translation(map.matrix3.as_mat3(), map.translation.as_vec3())
    }

    /// A bound of the values in a brick.
    pub fn brick_max<L: Channels>(&self, [x, y, z]: [u32; 3]) -> L {
        let at = [x as usize, y as usize, z as usize];
        each!(self, lattice => channels(lattice.bricks[lattice.index(at)].most))
    }

    /// The mean of the values in a brick, over the part of it that lies in the unit cube (in what is kept of the
    /// lattice, where a turned cube leaves some of its box).
    pub fn brick_mean<L: Channels>(&self, [x, y, z]: [u32; 3]) -> L {
        let at = [x as usize, y as usize, z as usize];
        each!(self, lattice => channels(lattice.bricks[lattice.index(at)].mean))
    }

    /// About how many cells `segment` crosses: their boundaries, and bricks of one value counted as one.
    pub fn cells_crossed(&self, segment: &RaySegment) -> f64 {
        each!(self, lattice => {
            let Some((line, [first, last])) = self.clip(segment, lattice.cells) else { return 0.0 };
            let per_metre: f64 = line.direction.iter().map(|d| d.abs()).sum();
            let mapped = segment.mapped(&self.to_bricks());
            let cells = Cells::new(&mapped, first as f32, last as f32, self.bricks());
            let cost = |Crossing { cell, first, last }: Crossing| {
                let brick = &lattice.bricks[cell as usize];
                1.0 + if brick.values.is_some() { per_metre * f64::from(last - first) } else { 0.0 }
            };
            cells.map(cost).sum()
        })
    }

    /// The first place along `segment` where the integral of the hero's channel, times its `scale`, exceeds
    /// `remaining`.
    pub fn invert<L: Channels>(
        &self,
        segment: &RaySegment,
        scale: L,
        hero: usize,
        remaining: f32,
    ) -> Reached<L> {
        let factor = f64::from(scale.hero(hero));
        let value = if factor > 0.0 { f64::from(remaining) / factor } else { f64::INFINITY };
        let target = Target { hero, value };
        each!(self, lattice => match self.clip(segment, lattice.cells) {
            None => Reached::Beyond { depth: L::splat(0.0) },
            Some((line, [first, last])) => reached(&lattice.invert(&line, first, last, target), scale),
        })
    }

    /// The line of `segment` in the lattice, and from where to where it counts.
    #[inline]
    fn clip(&self, segment: &RaySegment, cells: [usize; 3]) -> Option<(Line, [f64; 2])> {
        let (origin, direction) = (segment.origin.as_dvec3(), segment.direction.as_dvec3());
        let range = narrowed(origin, direction, self.frame.domain, [0.0, f64::from(segment.length)]);
        let map = &self.frame.to_lattice;
        let (origin, direction) = (map.transform_point3(origin), map.transform_vector3(direction));
        let range = narrowed(origin, direction, [DVec3::ZERO, DVec3::from(axes(|i| cells[i] as f64))], range);
        let line = Line { origin: origin.to_array(), direction: direction.to_array() };
        (range[0] < range[1]).then_some((line, range))
    }
}

#[cfg(test)]
impl Grid {
    pub(super) fn examples() -> Vec<Self> {
        tests::examples()
    }

    /// How many bricks hold values of their own, and how many there are.
    fn counts(&self) -> [usize; 2] {
        each!(self, lattice => {
            let full = lattice.bricks.iter().filter(|brick| brick.values.is_some());
            [full.count(), lattice.bricks.len()]
        })
    }
}

impl VolumeModel for Grid {
    #[inline]
    fn eval<L: Channels>(&self, position: Vec3) -> L {
        let local = self.frame.to_local.transform_point3(position.as_dvec3());
        let at =
            DVec3::from(axes(|i| self.frame.wrap.coordinate(local[i]))) * self.frame.scale + self.frame.shift;
        each!(self, lattice => channels(lattice.eval(at.to_array())))
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let [low, high] = image(&self.frame.to_local, [low.as_dvec3(), high.as_dvec3()]);
        let ends = axes(|axis| {
            self.frame
                .wrap
                .interval(low[axis], high[axis])
                .map(|x| x * self.frame.scale[axis] + self.frame.shift[axis])
        });
        let (low, high) = (axes(|i| ends[i][0]), axes(|i| ends[i][1]));
        each!(self, lattice => lattice.range(low, high).map(Channels::to_spectrum))
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        let [low, high] = self.frame.domain.map(|end| end.as_vec3());
        // Not less than the true box, whatever f32 makes of it.
        let outward = |x: f32, exact: f64, next: fn(f32) -> f32, is_short: bool| {
            if is_short && f64::from(x) != exact { next(x) } else { x }
        };
        let low = std::array::from_fn(|i| {
            let exact = self.frame.domain[0][i];
            outward(low[i], exact, f32::next_down, f64::from(low[i]) > exact)
        });
        let high = std::array::from_fn(|i| {
            let exact = self.frame.domain[1][i];
            outward(high[i], exact, f32::next_up, f64::from(high[i]) < exact)
        });
        Some([Vec3::from_array(low), Vec3::from_array(high)])
    }

    #[inline]
    fn contains(&self, position: Vec3) -> bool {
        let position = position.as_dvec3();
        position.cmpge(self.frame.domain[0]).all() && position.cmple(self.frame.domain[1]).all()
    }

    fn is_grey(&self) -> bool {
        matches!(self.bricks, Bricks::Grey(_))
    }

    fn has_integral(&self) -> bool {
        true
    }

    #[inline]
    fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        each!(self, lattice => match self.clip(segment, lattice.cells) {
            None => L::splat(0.0),
            Some((line, [first, last])) => narrow(lattice, lattice.integral(&line, first, last)),
        })
    }

    fn moved(&self, by: DVec3) -> Self {
        let Frame { wrap, to_local, to_lattice, scale, shift, domain } = *self.frame;
        let back = DAffine3::from_translation(-by);
        let (to_local, to_lattice) = (to_local * back, to_lattice * back);
        let domain = domain.map(|corner| corner + by);
        let frame = Frame { wrap, to_local, to_lattice, scale, shift, domain };
        Self { bricks: self.bricks.clone(), frame: Arc::new(frame) }
    }
}

/// A voxel in the requested channels.
#[inline]
fn channels<L: Channels>(value: impl Channels) -> L {
    L::from_spectrum(value.to_spectrum())
}

#[inline]
fn narrow<V: Voxel, L: Channels>(_: &Lattice<V>, sum: V::Sum) -> L {
    channels(V::narrow(sum))
}

fn reached<V: Voxel, L: Channels>(walk: &Walk<V>, scale: L) -> Reached<L> {
    let depth = channels::<L>(V::narrow(walk.sum)) * scale;
    match walk.stop {
        None => Reached::Beyond { depth },
        Some((t, value)) => Reached::Within { t: t as f32, depth, value: channels::<L>(value) * scale },
    }
}
