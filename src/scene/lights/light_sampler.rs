//! Which emitter next-event estimation takes from a reference point.

use super::{
    Light,
    light_tree::{LightTree, Moments},
};
use crate::{
    emitter::{Kind, PointModel, SurfaceModel},
    math::{Spectrum, SpectrumExt, Vec3, warp},
    sampling::{Discrete, Stream, stream::Purpose},
    scene::accel::Geometry,
};
use std::f64::consts::PI;

/// How often an emitter is taken whatever the reference: the tree knows nothing of what stands in the way, and may think far
/// too little of an emitter.
const REGARDLESS: f64 = 0.2;

/// The distribution.
#[derive(Clone, Debug, Default)]
pub struct LightSampler {
    /// Half by power, half uniform, whatever the reference.
    regardless: Discrete,
    /// By what each is estimated to give the reference; none where there is nothing to choose.
    tree: Option<LightTree>,
}

/// What a sampler needs to know of a scene.
pub struct Extent<'a> {
    pub geometry: &'a Geometry,
    /// Of a sphere around it.
    pub centre: Vec3,
    /// [m]
    pub radius: f32,
}

impl LightSampler {
    /// Over `all` emitters that can be connected to, of the given powers.
    pub fn new(all: &[Light], powers: &[f64], extent: &Extent<'_>) -> Self {
        let joinable =
            |(light, power): (&Light, &f64)| if light.emitter.is_connectible() { *power } else { 0.0 };
        let powers: Vec<f64> = all.iter().zip(powers).map(joinable).collect();
        let total: f64 = powers.iter().sum();
        let count = powers.iter().filter(|p| **p > 0.0).count();
        let mixed = |p: &f64| if *p > 0.0 { p / total + 1.0 / count as f64 } else { 0.0 };
        let regardless = Discrete::new(powers.iter().map(mixed));
        let tree = if count > 1 { extent.tree(all, &powers, count) } else { None };
        Self { regardless, tree }
    }

    /// True where nothing can be connected to.
    pub fn is_empty(&self) -> bool {
        self.regardless.is_empty()
    }

    /// The emitter that `u` in [0, 1) falls on for `reference`, and its probability.
    #[inline]
    pub fn sample(&self, reference: Vec3, u: f64) -> (usize, f32) {
        let Some(tree) = &self.tree else {
            let (index, probability) = self.regardless.sample_precisely(u);
            return (index, probability as f32);
        };
        if u < REGARDLESS {
            let (index, probability) = self.regardless.sample_precisely(u / REGARDLESS);
            return (index, mixed(probability, tree.probability(index as u32, reference)));
        }
        let (index, by_tree) = tree.sample(reference, (u - REGARDLESS) / (1.0 - REGARDLESS));
        let index = index as usize;
        (index, mixed(self.regardless.probability_precisely(index), by_tree))
    }

    /// Probability of the emitter `index` for `reference`.
    #[inline]
    pub fn probability(&self, index: usize, reference: Vec3) -> f32 {
        let regardless = self.regardless.probability_precisely(index);
        match &self.tree {
            Some(tree) if regardless > 0.0 => mixed(regardless, tree.probability(index as u32, reference)),
            _ => regardless as f32,
        }
    }
}

#[inline]
fn mixed(regardless: f64, by_tree: f32) -> f32 {
    (REGARDLESS * regardless) as f32 + (1.0 - REGARDLESS) as f32 * by_tree
}

/// Rays that are looked at for what an emitter is like: the most and the fewest of one, and of all together.
const RAYS: [usize; 3] = [256, 16, 1 << 20];

/// What is nearer than this part of the scene's radius is no nearer.
const NEAREST: f64 = 1e-6;

/// The least light of a ray, in any unit.
const DARK: f64 = 1e-37;

/// Infinity, in radii of the scene: as far around it, light from there is the same everywhere.
const REACH: f64 = 1e4;

impl Extent<'_> {
    fn tree(&self, all: &[Light], powers: &[f64], count: usize) -> Option<LightTree> {
        let rays = (RAYS[2] / count).clamp(RAYS[1], RAYS[0]);
        let (mut far, mut near) = (Vec::new(), Vec::new());
        for (index, light) in all.iter().enumerate().filter(|(index, _)| powers[*index] > 0.0) {
            let number = index as u32;
            if light.emitter.is_infinite() {
                far.push((number, self.moments_of_infinite(powers[index])));
            } else {
                near.push((number, self.moments(light, number, rays).of_power(powers[index])));
            }
        }
        LightTree::new(far, near, all.len(), NEAREST * f64::from(self.radius))
    }

    /// Of an emitter at infinity that sends `power` through the sphere around the scene.
    fn moments_of_infinite(&self, power: f64) -> Moments {
        let radius = f64::from(self.radius);
        Moments::everywhere(power / (PI * radius.powi(2)), self.centre.as_dvec3(), REACH * radius)
    }

    /// What `light` sends where, up to a factor: from as many `rays`.
    fn moments(&self, light: &Light, number: u32, rays: usize) -> Moments {
        let ray = |sample: usize| {
            let mut stream = Stream::sobol(3, u64::from(number), sample as u64, Purpose::Pilot);
            let (value, position, direction) = self.ray(light, &mut stream);
            // What is dark wherever one looks is somewhere all the same.
            let power = f64::from(value.luminance()).clamp(DARK, f64::from(f32::MAX));
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
            (Kind::Medium(volume), _) => {
                let position = volume.emission.sample(stream);
                let value = volume.emission.at(position) / volume.emission.pdf_vol(position);
                (value, position, warp::to_sphere(stream.square()))
            }
            (Kind::Surface(_) | Kind::Infinite(_), _) => (Spectrum::ONE, self.centre, Vec3::ZERO),
        }
    }
}
