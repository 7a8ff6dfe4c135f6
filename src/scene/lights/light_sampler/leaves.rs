//! The leaves of a scene's light tree: its emitters, and of emissive media the cells.

use super::Cells;
use crate::{
    emitter::{BeamModel, Kind, PointModel, SurfaceModel},
    math::{DVec3, Spectrum, SpectrumExt, Vec3, warp},
    medium::Emission,
    sampling::{Stream, stream::Purpose},
    scene::{
        accel::Geometry,
        lights::{
            disk::Disk,
            light::Light,
            light_tree::{LightTree, Moments},
        },
    },
};
use std::f64::consts::PI;

/// What a sampler needs to know of a scene.
pub(crate) struct Extent<'a> {
    pub geometry: &'a Geometry,
    /// Centre of a sphere around it.
    pub centre: Vec3,
    /// Its radius (m).
    pub radius: f32,
}

/// Rays sampled of all emitters together, to estimate their moments.
const RAYS: usize = 1 << 20;

/// The fewest and the most of one emitter.
const RAYS_OF_ONE: [usize; 2] = [16, 256];

/// The least light of a ray, in any unit.
const DARK: f64 = 1e-37;

/// Distances below this part of the scene's radius make no difference.
const NEAREST: f64 = 1e-6;

/// Infinity, in radii of the scene: as far around it, light from there is the same everywhere.
const REACH: f64 = 1e4;

/// Media of more cells are one leaf: trees fit into memory.
const MOST_CELLS: usize = 1 << 17;

/// A medium is one leaf if its light comes from within this distance of its centre (root mean square, in radii of the
/// scene). Measured: cells gain 1.25 in a smoky hall with a row of twelve flames (0.5 radii), and lose 1.1 to 1.4 with
/// one fire (less than 0.05). From most points all of that fire is equally far, and a tree of thousands of cells is
/// slow.
const NARROW: f64 = 0.125;

/// What a tree is built of.
#[derive(Default)]
struct Leaves {
    far: Vec<(u32, Moments)>,
    near: Vec<(u32, Moments)>,
    media: Vec<Cells>,
    /// Numbers given so far.
    count: usize,
}

impl Extent<'_> {
    /// Over the emitters of `all` that have any of the `powers`; and the media whose cells are leaves.
    pub(super) fn tree(&self, all: &[Light], powers: &[f64]) -> (Option<LightTree>, Vec<Cells>) {
        let [fewest, most] = RAYS_OF_ONE;
        let count = powers.iter().filter(|power| **power > 0.0).count();
        let rays = (RAYS / count.max(1)).clamp(fewest, most);
        let mut leaves = Leaves { count: all.len(), ..Leaves::default() };
        for (number, (light, power)) in (0..).zip(all.iter().zip(powers)) {
            if *power <= 0.0 {
                continue;
            }
            match &light.emitter.kind {
                Kind::Infinite(_) => leaves.far.push((number, self.moments_of_infinite(*power))),
                Kind::Medium(volume) if self.is_wide(&volume.emission) => {
                    leaves.add_cells(number, &volume.emission, *power);
                }
                _ => leaves.near.push((number, self.moments(light, number, rays).of_power(*power))),
            }
        }
        let Leaves { far, near, media, count } = leaves;
        (LightTree::new(far, near, count, NEAREST * f64::from(self.radius)), media)
    }

    /// True if the cells of `emission` are worth telling apart.
    fn is_wide(&self, emission: &Emission) -> bool {
        let all = cells(emission).fold(Moments::default(), |sum, (_, cell)| sum + cell);
        emission.cell_count() <= MOST_CELLS && all.variance().sqrt() > NARROW * f64::from(self.radius)
    }

    /// Of an emitter at infinity that sends `power` through the sphere around the scene.
    fn moments_of_infinite(&self, power: f64) -> Moments {
        let radius = f64::from(self.radius);
        Moments::everywhere(power / (PI * radius.powi(2)), self.centre.as_dvec3(), REACH * radius)
    }

    /// Moments of what `light` emits, up to a factor, estimated from this many `rays`.
    fn moments(&self, light: &Light, number: u32, rays: usize) -> Moments {
        let ray = |sample: usize| {
            let mut stream = Stream::sobol(3, u64::from(number), sample as u64, Purpose::Pilot);
            let (value, position, direction) = self.ray(light, &mut stream);
            let power = f64::from(value.luminance());
            // An emitter without light in any ray still has a place.
            let power = if power.is_finite() { power.max(DARK) } else { DARK };
            Moments::ray(power, position.as_dvec3(), direction.as_dvec3())
        };
        (0..rays).map(ray).fold(Moments::default(), |sum, ray| sum + ray)
    }

    /// Light that leaves `light`, up to a factor: value over density, position, direction.
    fn ray(&self, light: &Light, stream: &mut Stream) -> (Spectrum, Vec3, Vec3) {
        match (&light.emitter.kind, light.shape) {
            (Kind::Surface(surface), Some(shape)) => {
                let point = self.geometry.sample_area(shape, stream);
                let emission = surface.sample(&point, 1.0, stream);
                (emission.throughput, point.position, emission.direction)
            }
            (Kind::Point(point), _) => {
                let direction = point.sample(stream);
                (point.intensity(direction) / point.pdf_sr(direction), light.position, direction)
            }
            (Kind::Beam(beam), _) => {
                let disk = Disk::of_beam(beam, light.position);
                (beam.irradiance(), disk.sample(stream), beam.direction())
            }
            (Kind::Medium(volume), _) => {
                let position = volume.emission.sample(stream);
                let value = volume.emission.at(position) / volume.emission.pdf_vol(position);
                (value, position, warp::to_sphere(stream.square()))
            }
            (Kind::Surface(_) | Kind::Infinite(_), _) => (Spectrum::ONE, self.centre, Vec3::ZERO),
        }
    }
}

impl Leaves {
    /// The cells of `emission` that emit.
    fn add_cells(&mut self, emitter: u32, emission: &Emission, power: f64) {
        let first = self.count as u32;
        self.media.push(Cells { emitter, first });
        self.count += emission.cell_count();
        let leaf = |(cell, moments): (u32, Moments)| (first + cell, moments.of_power(power * moments.power));
        self.near.extend(cells(emission).map(leaf));
    }
}

/// The cells of `emission` that emit, their powers as parts of all.
fn cells(emission: &Emission) -> impl Iterator<Item = (u32, Moments)> {
    let cell = |cell| {
        let centre = emission.position_in(cell, Vec3::splat(0.5)).as_dvec3();
        let moments = Moments::ray(emission.cell_probability(cell), centre, DVec3::ZERO);
        (cell, moments.spread_by(emission.cell_variance()))
    };
    (0..emission.cell_count() as u32).map(cell).filter(|(_, moments)| moments.power > 0.0)
}
