//! Smoke that its velocity carries along while the shutter is open (semi-Lagrangian advection): t seconds after the
//! time of its file, the value at x is what the file has at x - v(x) t. The result is a grid like any other, exact for
//! every tracker.

use super::{
    super::{Samples, files},
    checks::{check_bricks, extent},
    file::{Source, Values},
    lattice::Filter,
};
use crate::{
    error::Result,
    math::{DAffine3, DMat3, DVec3, Vec3, axes, boxes::image},
};
use rayon::prelude::*;
use std::{
    ops::{Add, Mul},
    path::Path,
};

/// How a file says that its contents move: in its own world, times `scale` (m/s).
pub(super) struct Velocity {
    grids: Vec<files::Source>,
    /// From the file's world to the samples of each.
    to_samples: Vec<DAffine3>,
    scale: f64,
    /// Bounds of every component.
    range: [DVec3; 2],
}

impl Velocity {
    /// The grid or, separated by commas, the three of a component each that `names` are of the file at `path`.
    pub(super) fn read(path: &Path, names: &str, scale: f64) -> Result<Self> {
        let open =
            |name: &str| files::open(path, Some(name.trim())).map_err(|problem| problem.at(path.display()));
        let grids = names.split(',').map(open).collect::<Result<Vec<_>>>()?;
        let channels: usize = grids.iter().map(files::Source::channels).sum();
        if channels != 3 || grids.len() == 2 {
            let found = format!("\"{names}\" of {channels} numbers to a voxel");
            let remedy = "name a grid of vectors, or three grids of numbers with commas between them";
            let problem = files::Problem::new("a velocity of three components", found, remedy);
            return Err(problem.at(path.display()));
        }
        let Some(bounds) = grids.iter().map(bounds).collect::<Option<Vec<_>>>() else {
            let found = format!("others in \"{names}\"");
            let remedy = "correct the grid, or set \"velocity_grid\" to \"\"";
            return Err(files::Problem::new("finite velocities", found, remedy).at(path.display()));
        };
        let of_grid = |grid: &files::Source| {
            let first = DVec3::from(grid.low.map(|i| i as f64));
            DAffine3::from_translation(-first) * grid.to_world.inverse()
        };
        let [low, high] = match bounds.as_slice() {
            [x, y, z] => [0, 1].map(|end| DVec3::new(x[end].x, y[end].y, z[end].z)),
            others => others.first().copied().unwrap_or_default(),
        }
        .map(|end| end * scale);
        // A negative scale turns them round.
        let range = [low.min(high), low.max(high)];
        Ok(Self { to_samples: grids.iter().map(of_grid).collect(), grids, scale, range })
    }

    /// The velocity at `position` in the file's world. Beyond the active voxels the nearest ones count: smoke that
    /// leaves them moves on.
    fn at(&self, position: DVec3) -> DVec3 {
        let of = |number: usize| -> DVec3 {
            let at = self.to_samples[number].transform_point3(position);
            match &self.grids[number].samples {
                files::Field::Grey(samples) => DVec3::splat(f64::from(between(samples, at, Beyond::Active))),
                files::Field::Colour(samples) => between(samples, at, Beyond::Active).as_dvec3(),
            }
        };
        let found = match self.grids.len() {
            3 => DVec3::new(of(0).x, of(1).y, of(2).z),
            _ => of(0),
        };
        found * self.scale
    }
}

/// Bounds of all that a grid holds; of a single component in every one. None if not all is finite.
fn bounds(grid: &files::Source) -> Option<[DVec3; 2]> {
    let (mut is_finite, mut bounds) = (true, [DVec3::INFINITY, DVec3::NEG_INFINITY]);
    let mut see = |value: DVec3| {
        is_finite &= value.is_finite();
        bounds = [bounds[0].min(value), bounds[1].max(value)];
    };
    match &grid.samples {
        files::Field::Grey(samples) => samples.each(&mut |_, value: f32, _| see(DVec3::splat(value.into()))),
        files::Field::Colour(samples) => samples.each(&mut |_, value: Vec3, _| see(value.as_dvec3())),
    }
    is_finite.then_some(bounds)
}

/// A grid and how it moves, kept while the shutter is open.
pub(super) struct Flow {
    /// As the file has it.
    pub source: Source,
    /// In the file's world.
    pub velocity: Velocity,
}

impl Flow {
    /// The grid so many `seconds` after the time of its file, larger by what has left its box; `path` is the file.
    pub(super) fn after(&self, path: &Path, seconds: f64) -> Result<Source> {
        let Self { source: Source { values, to_file, name, .. }, velocity } = self;
        let size = match values {
            Values::Grey(samples) => samples.size(),
            Values::Chromatic(samples) => samples.size(),
        };
        let drift = Drift::new(to_file, size, velocity, seconds);
        drift.check(path)?;
        check_bricks(path, drift.size, &extent(drift.size, Filter::Trilinear, [DVec3::ZERO, DVec3::ONE]).0)?;
        let values = match values {
            Values::Grey(samples) => Values::Grey(Box::new(drift.carried(&**samples))),
            Values::Chromatic(samples) => Values::Chromatic(Box::new(drift.carried(&**samples))),
        };
        Ok(Source { values, to_file: *to_file * drift.cube(), name: name.clone(), others: Vec::new() })
    }
}

/// Where the contents of a grid are carried, in units of its voxels.
struct Drift<'a> {
    /// From indices of the file's samples to its world.
    to_file: DAffine3,
    /// From velocities in that to what they carry within the time (samples).
    to_way: DMat3,
    velocity: &'a Velocity,
    /// Samples that the file has.
    given: [usize; 3],
    /// How far anything is carried, at least and at most.
    range: [DVec3; 2],
    /// Index of the first sample, counted from the file's first one, and all samples.
    first: [i64; 3],
    size: [usize; 3],
}

/// How far contents may be carried, in sizes of the grid: beyond this, velocities must have another unit.
pub const FARTHEST: f64 = 100.0;

/// Says that something is carried so many times its size.
pub fn too_far(times: f64) -> files::Problem {
    let expected = format!("a velocity that carries what it moves no farther than {FARTHEST} times its size");
    let found = format!("{times:.3e} times while the shutter is open");
    let remedy = "shorten the exposure (\"shutter_open\", \"shutter_close\"), or correct \"velocity_scale\"";
    files::Problem::new(expected, found, remedy)
}

impl<'a> Drift<'a> {
    fn new(cube: &DAffine3, given: [usize; 3], velocity: &'a Velocity, seconds: f64) -> Self {
        let voxels = DVec3::from(given.map(|n| n as f64));
        let to_file =
            *cube * DAffine3::from_scale(voxels.recip()) * DAffine3::from_translation(DVec3::splat(0.5));
        let to_way = to_file.matrix3.inverse() * seconds;
        let range = image(&DAffine3::from_mat3(to_way), velocity.range);
        let first = axes(|axis| range[0][axis].floor() as i64);
        let last = axes(|axis| (range[1][axis].ceil() as i64).saturating_add(given[axis] as i64));
        let size = axes(|axis| last[axis].saturating_sub(first[axis]).max(1) as usize);
        Self { to_file, to_way, velocity, given, range, first, size }
    }

    /// An error where it gets too far.
    fn check(&self, path: &Path) -> Result<()> {
        let farthest = self.range[0].abs().max(self.range[1].abs());
        let times = axes(|axis| farthest[axis] / self.given[axis] as f64).into_iter().fold(0.0, f64::max);
        if times <= FARTHEST {
            return Ok(());
        }
        Err(too_far(times).at(path.display()))
    }

    /// From the unit cube of all samples to that of the file's.
    fn cube(&self) -> DAffine3 {
        let given = DVec3::from(self.given.map(|n| n as f64));
        let [first, size] = [self.first.map(|n| n as f64), self.size.map(|n| n as f64)].map(DVec3::from);
        DAffine3::from_translation(first / given) * DAffine3::from_scale(size / given)
    }

    fn carried<V: Carried>(&self, samples: &dyn Samples<V>) -> Blocks<V> {
        let across = self.size.map(|n| n.div_ceil(SIDE));
        let blocks = (0..across.iter().product()).into_par_iter().map(|number: usize| {
            let [x, y] = [across[0], across[1]];
            self.block(samples, [number % x, number / x % y, number / (x * y)])
        });
        Blocks { size: self.size, across, blocks: blocks.collect() }
    }

    /// The samples of a block.
    fn block<V: Carried>(&self, samples: &dyn Samples<V>, block: [usize; 3]) -> Block<V> {
        let first = block.map(|i| i * SIDE);
        if let Some(value) = self.known(samples, first) {
            return Block::Uniform(value);
        }
        let offsets = (0..SIDE * SIDE * SIDE).map(|n| [n % SIDE, n / SIDE % SIDE, n / (SIDE * SIDE)]);
        let values: Vec<V> = offsets
            .map(|offset| {
                let at = DVec3::from(axes(|i| (first[i] + offset[i]) as f64 + self.first[i] as f64));
                between(samples, at - self.carried_by(at), Beyond::Nothing)
            })
            .collect();
        match values.iter().all(|value| *value == values[0]) {
            true => Block::Uniform(values[0]),
            false => Block::Varying(values.into()),
        }
    }

    /// How far what is now at the sample `at` was carried.
    fn carried_by(&self, at: DVec3) -> DVec3 {
        self.to_way * self.velocity.at(self.to_file.transform_point3(at))
    }

    /// The single value of the block from `first` on, if all places it may come from have it.
    fn known<V: Carried>(&self, samples: &dyn Samples<V>, first: [usize; 3]) -> Option<V> {
        let start = |axis: usize| first[axis] as f64 + self.first[axis] as f64;
        let low = axes(|axis| (start(axis) - self.range[1][axis]).floor() - 1.0);
        let high = axes(|axis| (start(axis) + SIDE as f64 - self.range[0][axis]).ceil() + 1.0);
        let last = self.given.map(|n| (n - 1) as f64);
        if (0..3).any(|axis| high[axis] < 0.0 || low[axis] > last[axis]) {
            return Some(V::default());
        }
        let ends = [low, high].map(|end| axes(|axis| end[axis].clamp(0.0, last[axis]) as usize));
        let value = samples.uniform(ends[0], ends[1])?;
        let is_within = (0..3).all(|axis| low[axis] >= 0.0 && high[axis] <= last[axis]);
        (is_within || value == V::default()).then_some(value)
    }
}

/// Samples along a side of a block.
const SIDE: usize = 8;

/// What was carried, block by block.
struct Blocks<V> {
    size: [usize; 3],
    across: [usize; 3],
    blocks: Vec<Block<V>>,
}

enum Block<V> {
    Uniform(V),
    Varying(Box<[V]>),
}

impl<V> Blocks<V> {
    fn block(&self, [x, y, z]: [usize; 3]) -> &Block<V> {
        &self.blocks[x + self.across[0] * (y + self.across[1] * z)]
    }
}

impl<V: Carried> Samples<V> for Blocks<V> {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn at(&self, index: [usize; 3]) -> V {
        match self.block(index.map(|i| i / SIDE)) {
            Block::Uniform(value) => *value,
            Block::Varying(values) => {
                let [x, y, z] = index.map(|i| i % SIDE);
                values[x + SIDE * (y + SIDE * z)]
            }
        }
    }

    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<V> {
        let [x, y, z] = axes(|axis| low[axis] / SIDE..=high[axis] / SIDE);
        let places = z.flat_map(|k| {
            let x = x.clone();
            y.clone().flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        });
        let mut first = None;
        for place in places {
            let Block::Uniform(value) = self.block(place) else { return None };
            if *first.get_or_insert(*value) != *value {
                return None;
            }
        }
        first
    }
}

/// A number or a colour.
trait Carried: Copy + Default + PartialEq + Send + Sync + Add<Output = Self> + Mul<f32, Output = Self> {}
impl Carried for f32 {}
impl Carried for Vec3 {}

/// What lies beyond the first and the last sample.
#[derive(Clone, Copy, PartialEq)]
enum Beyond {
    Nothing,
    /// What the active sample next to it has, which is the second or the last but one.
    Active,
}

/// Samples interpolated between the eight around `at`, whose indices they have.
fn between<V: Carried>(samples: &(impl Samples<V> + ?Sized), at: DVec3, beyond: Beyond) -> V {
    let size = samples.size();
    let (floor, part) = (at.floor(), at - at.floor());
    let corners = (0..8).map(|n| axes(|axis| n >> axis & 1));
    corners.fold(V::default(), |sum, corner| {
        let weight: f64 = (0..3).map(|i| if corner[i] == 1 { part[i] } else { 1.0 - part[i] }).product();
        let index = axes(|axis| floor[axis] + f64::from(corner[axis]));
        let edge = if beyond == Beyond::Active { 1 } else { 0 };
        let kept = axes(|axis| index[axis].clamp(edge as f64, (size[axis] - 1 - edge) as f64));
        let is_beyond = beyond == Beyond::Nothing && kept != index;
        if is_beyond || weight == 0.0 {
            sum
        } else {
            sum + samples.at(kept.map(|i| i as usize)) * weight as f32
        }
    })
}

#[cfg(test)]
mod tests {
    use crate::{
        description::{Library, Value},
        error::Result,
        math::{DVec3, Spectrum, Vec3, vec3},
        testing::object,
        volume::{self, Place, Volume, VolumeModel as _, files::tests::sample},
    };

    fn text(word: &str) -> Value {
        Value::String(word.into())
    }

    /// The grid called `name` of a file, so many seconds `after` its time.
    fn grid(file: &str, name: &str, after: f64, more: &[(&str, Value)]) -> Result<Volume> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("smoke.vdb");
        std::fs::write(&path, sample(file)).unwrap();
        let mut all = vec![("filename", text(&path.display().to_string())), ("grid", text(name))];
        all.extend_from_slice(more);
        let place = Place { after, ..Place::new(DVec3::ZERO, 0.0) };
        volume::build(&object("gridvolume", &all), &Library::default(), &place)
    }

    /// Samples lie a quarter apart from 0 on, 5 x 8 x 5 of them are active in the velocity.
    fn samples() -> impl Iterator<Item = Vec3> {
        let all = (-4..9).flat_map(|x| (-4..12).flat_map(move |y| (-4..9).map(move |z| [x, y, z])));
        all.map(|index| Vec3::from_array(index.map(|i: i16| 0.25 * f32::from(i))))
    }

    #[test]
    fn smoke_is_where_its_velocity_took_it() {
        let still = grid("houdini.vdb", "density", 0.0, &[]).unwrap();
        let velocity = grid("houdini.vdb", "vel", 0.0, &[]).unwrap();
        for after in [-0.3, 0.1, 0.7] {
            let moved = grid("houdini.vdb", "density", after, &[("velocity_grid", text("vel"))]).unwrap();
            for at in samples() {
                let active = at.clamp(Vec3::ZERO, vec3(1.0, 1.75, 1.0));
                let from = at - velocity.eval::<Spectrum>(active) * after as f32;
                let (found, expected): (f32, f32) = (moved.inside(at), still.inside(from));
                assert!((found - expected).abs() < 1e-5, "{after} s, {at}: {found} for {expected}");
            }
        }
    }

    #[test]
    fn three_grids_are_one_velocity() {
        let still = grid("houdini_old.vdb", "density", 0.0, &[]).unwrap();
        let [x, y, z] =
            ["vel.x", "vel.y", "vel.z"].map(|name| grid("houdini_old.vdb", name, 0.0, &[]).unwrap());
        let names = [("velocity_grid", text("vel.x, vel.y,vel.z")), ("velocity_scale", Value::Float(2.0))];
        let moved = grid("houdini_old.vdb", "density", 0.1, &names).unwrap();
        for at in samples() {
            let active = at.clamp(Vec3::ZERO, vec3(1.0, 1.75, 1.0));
            let from = at - 0.2 * vec3(x.eval(active), y.eval(active), z.eval(active));
            let (found, expected): (f32, f32) = (moved.inside(at), still.inside(from));
            assert!((found - expected).abs() < 1e-5, "{at}: {found} for {expected}");
        }
    }

    #[test]
    fn what_does_not_move_stays() {
        let still = grid("houdini.vdb", "density", 0.0, &[]).unwrap();
        let names = [("velocity_grid", text("vel")), ("velocity_scale", Value::Float(0.0))];
        let kept = grid("houdini.vdb", "density", 5.0, &names).unwrap();
        assert_eq!(still.domain(), kept.domain());
        samples().for_each(|at| assert_eq!(still.inside::<f32>(at), kept.inside::<f32>(at)));
    }

    #[test]
    fn what_is_no_velocity_is_refused() {
        let refused = |names| {
            let error = grid("houdini.vdb", "density", 1.0, &[("velocity_grid", text(names))]).map(drop);
            error.unwrap_err().to_string()
        };
        assert!(refused("density").contains("three components"), "{}", refused("density"));
        assert!(refused("vel,vel").contains("three components"), "{}", refused("vel,vel"));
        assert!(refused("speed").contains("\"vel\""), "{}", refused("speed"));
    }
}
