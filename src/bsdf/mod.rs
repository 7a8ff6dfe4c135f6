//! Surface scattering: one file a model; this page is the contract and the registry.
//!
//! Conventions. Directions are unit vectors in the shading frame, z the shading normal, both pointing away
//! from the surface. `wi` is where the walk came from, `wo` where it goes on to. Densities are per solid
//! angle [1/sr]: `forward` is that of `wo` given `wi`, `backward` that of `wi` given `wo`. For a Dirac lobe
//! they are the discrete probabilities of choosing that lobe.

use crate::math::{Spectrum, Vec2, Vec3};
use crate::sampling::Stream;

/// What a walk carries: it decides whether refraction scales by the squared index ratio (radiance) or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Eye walks: `wi` points towards the eye.
    Radiance,
    /// Light walks: `wi` points towards the light.
    Importance,
}

/// The non-Dirac part of a BSDF for one pair of directions.
#[derive(Clone, Copy, Debug)]
pub struct BsdfValue {
    /// f(wi, wo) [1/sr], without any cosine.
    pub value: Spectrum,
    /// Density of `wo` given `wi` [1/sr].
    pub forward: f32,
    /// Density of `wi` given `wo` [1/sr].
    pub backward: f32,
}

impl BsdfValue {
    /// No scattering between the two directions.
    pub const ZERO: Self = Self { value: Spectrum::ZERO, forward: 0.0, backward: 0.0 };
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The new direction.
    pub wo: Vec3,
    /// f |cos wo| / forward; for a Dirac lobe its coefficient / its probability.
    pub weight: Spectrum,
    /// Density of `wo` given `wi` [1/sr], or the probability of the Dirac lobe.
    pub forward: f32,
    /// Density of `wi` given `wo` [1/sr], or the probability of the Dirac lobe on the way back.
    pub backward: f32,
    /// True where a Dirac lobe was sampled.
    pub dirac: bool,
}

/// What every surface model can do. `uv` is the texture position.
pub trait BsdfModel {
    /// Value and both densities of the non-Dirac part.
    fn evaluate(&self, uv: Vec2, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue;

    /// Samples `wo`; none where nothing scatters (`wi` on a dark side, grazing, total loss).
    fn sample(&self, uv: Vec2, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample>;

    /// Probability in [0, 1] with which a walk goes on from here (LW96 eq. 9: a walk ends by absorption):
    /// the largest channel of the albedo. It must be the same for both directions of any scattering pair, as
    /// it enters forward and backward densities alike, so it may depend on `uv` and, for models that do not
    /// transmit, on the side of `wi`, on nothing else.
    fn survival(&self, uv: Vec2, wi: Vec3) -> f32;

    /// The part of light that passes straight through as if nothing were there (`null`: 1; `thindielectric`:
    /// its transmittance at this |cos|; opaque surfaces: 0). Equal from both sides. It is no scattering:
    /// `sample` and `evaluate` leave it out, the ray goes on and no path vertex arises.
    fn null_transmission(&self, _uv: Vec2, _cosine: f32) -> Spectrum {
        Spectrum::ZERO
    }

    /// True if some of its scattering is not Dirac, so that it can be joined to another vertex.
    fn is_connectible(&self) -> bool;

    /// True if some of its scattering is Dirac.
    fn has_dirac(&self) -> bool {
        !self.is_connectible()
    }

    /// True if `null_transmission` can be other than 0.
    fn has_null(&self) -> bool {
        false
    }
}
