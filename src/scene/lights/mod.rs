//! All emitters of a scene: which one is chosen, where its light starts, how a point is connected to it.
//!
//! An emitter point has two densities: as the start of a light subpath, and as the choice of next-event estimation from
//! a given reference. Both contain the probability of choosing the emitter: by power for starts, by estimated
//! contribution to the reference for next-event estimation. Densities are per area (1/m^2) for shapes, discrete for
//! points and single directions, per solid angle (1/sr) for emitters at infinity, whose "point" is a direction
//! (discrete for a beam, which has one), and per volume (1/m^3) for emissive media. For how camera subpaths sample a
//! point in a medium, and so the density of s = 0, see [`Emission::rate`].

mod aim;
mod clearings;
mod disk;
mod emission_sample;
mod emitter_sample;
mod groups;
mod light;
mod light_sampler;
mod light_tree;
mod pivot;
mod point;
mod starts;
mod volume;

pub use aim::Aim;
pub use clearings::Clearings;
pub use disk::Disk;
pub use emission_sample::{EmissionSample, Emitted};
pub use emitter_sample::EmitterSample;
pub use light::Light;
pub use pivot::{Pivot, Place};
pub use point::EmitterPoint;
pub use starts::{Densities, Start, Starts};
pub(super) use volume::emissive;

use super::{accel::Geometry, memo::Memo};
use crate::{
    emitter::Kind,
    math::{Bounds, Spectrum, Vec3},
    medium::{Emission, Medium, MediumIndex},
    sampling::Discrete,
    settings::options::Sky,
};
use light_sampler::{Extent, LightSampler};

/// All emitters.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// In file order.
    pub all: Vec<Light>,
    /// By power: where light subpaths start.
    starts: Discrete,
    /// Which emitter a reference point is connected to.
    connections: LightSampler,
    /// The same without the environment; none if there is no environment, or nothing else.
    lamps: Option<LightSampler>,
    /// Which emitter equiangular sampling takes.
    pivoting: Discrete,
    /// The pivot of each emitter that equiangular sampling applies to.
    pivots: Vec<Option<Pivot>>,
    /// The emitter that each medium is.
    of_media: Vec<Option<u32>>,
    /// Index of what surrounds the scene.
    pub environment: Option<u32>,
    /// Centre of a sphere around the scene.
    centre: Vec3,
    /// Its radius (m).
    radius: f32,
    /// Transmittance from infinity to the scene: 1, or 0 in fog without end.
    from_infinity: Spectrum,
    /// Starts of light subpaths that aim at targets.
    pub aimed: Memo,
    /// What was learnt of paths that reach an image.
    pub learnt: Memo,
    /// What camera subpaths end in, and the links that guide some.
    pub endings: Memo,
}

impl Lights {
    /// Arranges `all` emitters of a scene within a sphere around `geometry` and what varies of the medium `outside`.
    pub fn new(all: Vec<Light>, geometry: &Geometry, outside: &Medium) -> Self {
        let (centre, radius) = sphere_around(geometry, outside);
        let from_infinity = outside.transmittance_from_infinity();
        let weight = |light: &Light| {
            let area = light.shape.map_or(0.0, |shape| geometry.area(shape));
            let arriving = if light.emitter.is_infinite() { from_infinity.max_element() } else { 1.0 };
            let power = light.emitter.power(area, radius);
            power * f64::from(light.emitter.sampling_weight * arriving)
        };
        let powers: Vec<f64> = all.iter().map(weight).collect();
        let pivots: Vec<Option<Pivot>> = all.iter().map(|light| Pivot::of(light, geometry)).collect();
        let placed = powers.iter().zip(&pivots).map(|(power, pivot)| pivot.map_or(0.0, |_| *power));
        let environment = all.iter().position(|light| light.emitter.environment().is_some());
        let extent = Extent { geometry, centre, radius };
        Self {
            starts: Discrete::new(powers.iter().copied()),
            connections: LightSampler::new(&all, &powers, &extent),
            lamps: environment.and_then(|sky| {
                let powers: Vec<f64> = powers
                    .iter()
                    .enumerate()
                    .map(|(index, power)| if index == sky { 0.0 } else { *power })
                    .collect();
                Some(LightSampler::new(&all, &powers, &extent)).filter(|lamps| !lamps.is_empty())
            }),
            pivoting: light_sampler::regardless(placed),
            of_media: of_media(&all),
            environment: environment.map(|index| index as u32),
            pivots,
            all,
            centre,
            radius,
            from_infinity,
            aimed: Memo::default(),
            learnt: Memo::default(),
            endings: Memo::default(),
        }
    }

    /// The probability that a light subpath starts at an emitter, without what was learnt.
    pub fn start_probability(&self, light: usize) -> f32 {
        self.starts.probability(light)
    }

    /// True where nothing emits.
    pub fn is_empty(&self) -> bool {
        self.starts.is_empty()
    }

    /// True if some emitter is at infinity.
    pub fn has_infinite(&self) -> bool {
        self.all.iter().any(|light| light.emitter.is_infinite())
    }

    /// True if some emitter's rays are parallel, at infinity or not.
    pub fn has_parallel(&self) -> bool {
        self.all.iter().any(|light| light.emitter.is_parallel())
    }

    /// True if next-event estimation may leave the environment to other strategies.
    pub fn has_lamps_besides_sky(&self) -> bool {
        self.lamps.is_some()
    }

    /// True if next-event estimation takes the environment, where there is one.
    #[inline]
    pub fn connects_to_sky(&self, sky: Sky) -> bool {
        sky == Sky::NextEvent || self.lamps.is_none()
    }

    /// Which emitter next-event estimation takes.
    #[inline]
    fn connections(&self, sky: Sky) -> &LightSampler {
        match (&self.lamps, sky) {
            (Some(lamps), Sky::Hit) => lamps,
            _ => &self.connections,
        }
    }

    /// The factor by which [`Sky::Hit`] raises the probability that next-event estimation from `reference` takes the
    /// emitter `light`, if it takes others in proportion.
    pub fn without_sky(&self, light: u32, reference: Vec3) -> f32 {
        match self.environment {
            Some(sky) if sky == light => 0.0,
            Some(sky) => {
                1.0 / (1.0 - self.connections.probability(sky as usize, reference)).max(f32::EPSILON)
            }
            None => 1.0,
        }
    }

    /// True if some medium emits light.
    pub fn has_media(&self) -> bool {
        !self.of_media.is_empty()
    }

    /// The emitter that `medium` is, and what it emits; none where it is dark.
    #[inline]
    pub fn of_medium(&self, medium: MediumIndex) -> Option<(u32, &Emission)> {
        let index = self.of_media.get(medium.0 as usize).copied().flatten()?;
        let Kind::Medium(volume) = &self.all[index as usize].emitter.kind else { return None };
        Some((index, &volume.emission))
    }

    /// The disk around the scene that faces `towards`, where light of an emitter at infinity starts.
    #[inline]
    pub(super) fn disk_towards(&self, towards: Vec3) -> Disk {
        Disk::around(self.centre, self.radius, towards)
    }

    /// The disk from which the emitter `index` sends parallel light in unit `direction`; none where light leaves
    /// points.
    #[inline]
    pub(super) fn disk(&self, index: usize, direction: Vec3) -> Option<Disk> {
        let light = &self.all[index];
        Disk::of(light).or_else(|| light.emitter.is_infinite().then(|| self.disk_towards(-direction)))
    }
}

/// The emitter of each medium, up to the last that emits.
fn of_media(all: &[Light]) -> Vec<Option<u32>> {
    let mut found = Vec::new();
    for (index, light) in all.iter().enumerate() {
        if matches!(light.emitter.kind, Kind::Medium(_)) {
            let medium = light.medium.0 as usize;
            found.resize(found.len().max(medium + 1), None);
            found[medium] = Some(index as u32);
        }
    }
    found
}

/// Centre and radius of a sphere that holds everything.
fn sphere_around(geometry: &Geometry, outside: &Medium) -> (Vec3, f32) {
    let all = geometry.bounds().union(outside.extent().unwrap_or(Bounds::EMPTY));
    if !all.is_finite() {
        return (Vec3::ZERO, 1.0);
    }
    let radius = 0.5 * all.size().length() * (1.0 + 1e-3);
    // Where there is nothing, or a point, any sphere will do that has an area.
    (0.5 * (all.low + all.high), if radius * radius > f32::MIN_POSITIVE { radius } else { 1.0 })
}
