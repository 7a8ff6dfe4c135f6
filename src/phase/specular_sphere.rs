//! Spheres much larger than the wavelength whose surface reflects like a mirror of glass (P03T 2.3.5).

use super::{Deflection, PhaseModel, deflect};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::fresnel::{Interface, Interfaces};
use crate::math::{Vec3, warp};
use crate::sampling::{Discrete, Stream};
use std::f32::consts::TAU;
use std::sync::Arc;

/// rho(beta) / (4 pi rho_h): Fresnel's reflectance at the angle of incidence beta = (pi - theta) / 2 over its
/// average. A sphere that reflects all alike scatters alike into all directions; the light that is refracted
/// into it counts as absorbed.
#[derive(Clone, Debug)]
pub struct SpecularSphere {
    interface: Interface,
    /// 1 / (4 pi rho_h) (1/sr).
    scale: f32,
    mean_cosine: f32,
    envelope: Arc<Envelope>,
}

/// Steps that lie nowhere below the reflectance as a function of x = cos^2 of the angle of incidence. An even
/// x is a direction even over the sphere.
#[derive(Debug)]
struct Envelope {
    steps: Discrete,
    /// Where each step starts and how high it is.
    shape: Vec<(f32, f32)>,
}

impl Envelope {
    /// The reflectance across the plane of incidence falls with the cosine, that along it has no maximum but
    /// at the ends of an interval. Fine steps near grazing hold the peak of nearly equal indices.
    fn new(interface: &Interface) -> Self {
        let count = 256;
        let edge = |i: usize| (i as f64 / f64::from(count)).powi(4);
        let height = |i: usize| {
            let ends = [edge(i), edge(i + 1)].map(|x| interface.polarised(x.sqrt() as f32));
            let [(across, along), (_, other)] = ends;
            // The margin covers the rounding of the reflectance.
            0.5 * (across + along.max(other)) * 1.000_01
        };
        let indices = || 0..count as usize;
        let steps = Discrete::new(indices().map(|i| f64::from(height(i)) * (edge(i + 1) - edge(i))));
        Self { steps, shape: indices().map(|i| (edge(i) as f32, height(i))).collect() }
    }

    /// x with a density in proportion to `reflectance`.
    #[inline]
    fn sample(&self, reflectance: impl Fn(f32) -> f32, stream: &mut Stream) -> f32 {
        loop {
            let (index, _) = self.steps.sample(stream.uniform());
            let (start, height) = self.shape[index];
            let end = self.shape.get(index + 1).map_or(1.0, |next| next.0);
            let x = (start + (end - start) * stream.uniform()).min(1.0);
            if stream.uniform() * height < reflectance(x) {
                return x;
            }
        }
    }
}

impl SpecularSphere {
    /// `eta` is the index of refraction of the sphere over that of the medium, > 0 and not 1.
    pub fn new(eta: f64) -> Self {
        let interface = Interfaces::new(eta, 1.0).outside;
        let average = interface.diffuse_reflectance();
        Self {
            scale: (f64::from(warp::SPHERE_PDF) / average) as f32,
            mean_cosine: (1.0 - 2.0 * interface.moment(1) / average) as f32,
            envelope: Arc::new(Envelope::new(&interface)),
            interface,
        }
    }

    pub(super) const TABLE: Table = table! {
        "Spheres much larger than the wavelength that reflect as glass does: Fresnel's reflectance at (pi - theta) / 2, normalised (P03T 2.3.5).";
        number("eta", "", within(1e-3, 1e3), Required, "Index of refraction of the spheres over that around them, not 1."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let expected = "a relative index of refraction that differs from 1";
        let eta = params.float("eta")?;
        if (eta - 1.0).abs() > 1e-6 {
            return Ok(Self::new(eta));
        }
        Err(params.complain("eta", expected, eta.to_string()))
    }

    #[inline]
    fn reflectance(&self, x: f32) -> f32 {
        self.interface.reflectance(x.sqrt())
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        [1.33, 1.01, 2.4, 20.0, 0.75].map(Self::new).to_vec()
    }
}

impl PhaseModel for SpecularSphere {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        self.scale * self.reflectance(0.5 * turn.from_peak(1.0))
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        let x = self.envelope.sample(|x| self.reflectance(x), stream);
        deflect(direction, warp::near_pole(2.0 * x, TAU * stream.uniform()))
    }

    fn mean_cosine(&self) -> f32 {
        self.mean_cosine
    }
}
