//! Surface scattering: one file a model; this page is the contract and the registry.
//!
//! Conventions. Directions are unit vectors in the shading frame, z the shading normal, both pointing away
//! from the surface. `wi` is where the walk came from, `wo` where it goes on to. Densities are per solid
//! angle (1/sr): `pdf_fwd` is that of `wo` given `wi`, `pdf_rev` that of `wi` given `wo`. For a Dirac lobe
//! they are the discrete probabilities of choosing that lobe.

mod beckmann;
mod blend;
mod bumpmap;
mod burley;
mod conductor;
mod dielectric;
mod difftrans;
mod diffuse;
mod index;
mod mask;
mod metals;
mod microfacet;
mod normalmap;
mod null;
mod perturbed;
mod plastic;
mod principled;
mod principledthin;
mod roughconductor;
mod roughdielectric;
mod roughplastic;
#[cfg(test)]
mod tests;
mod thindielectric;
mod translucent;
mod twosided;

pub use blend::Blend;
pub use bumpmap::BumpMap;
pub use conductor::Conductor;
pub use dielectric::Dielectric;
pub use difftrans::DiffuseTransmitter;
pub use diffuse::Diffuse;
pub use mask::Mask;
pub use normalmap::NormalMap;
pub use null::Null;
pub use plastic::Plastic;
pub use principled::Principled;
pub use principledthin::PrincipledThin;
pub use roughconductor::RoughConductor;
pub use roughdielectric::RoughDielectric;
pub use roughplastic::RoughPlastic;
pub use thindielectric::ThinDielectric;
pub use translucent::Translucent;
pub use twosided::TwoSided;

use crate::description::{Build, Library, Object, Params, Plugin, Registry, models};
use crate::error::{Error, Result};
use crate::math::{Spectrum, Uv, Vec3, vec3};
use crate::sampling::Stream;
use crate::texture::{self, Texture};
use std::f32::consts::PI;

/// What a walk carries: it decides whether refraction scales by the squared index ratio (radiance) or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Camera subpaths: `wi` points towards the eye.
    Radiance,
    /// Light subpaths: `wi` points towards the light.
    Importance,
}

impl Transport {
    /// Of the same path, walked from its other end.
    #[inline]
    pub fn reversed(self) -> Self {
        match self {
            Self::Radiance => Self::Importance,
            Self::Importance => Self::Radiance,
        }
    }
}

/// The non-Dirac part of a BSDF for one pair of directions.
#[derive(Clone, Copy, Debug)]
pub struct BsdfValue {
    /// f(wi, wo) (1/sr), without any cosine.
    pub value: Spectrum,
    /// Density of `wo` given `wi` (1/sr).
    pub pdf_fwd: f32,
    /// Density of `wi` given `wo` (1/sr).
    pub pdf_rev: f32,
}

impl BsdfValue {
    /// No scattering between the two directions.
    pub const ZERO: Self = Self { value: Spectrum::ZERO, pdf_fwd: 0.0, pdf_rev: 0.0 };

    /// The sample of `wo` that has this value and these densities; none where it cannot have been drawn.
    #[inline]
    fn sampled(self, wo: Vec3) -> Option<BsdfSample> {
        let Self { value, pdf_fwd, pdf_rev } = self;
        let weight = value * (wo.z.abs() / pdf_fwd);
        (pdf_fwd > 0.0).then_some(BsdfSample { wo, weight, pdf_fwd, pdf_rev, dirac: false })
    }
}

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample {
    /// The new direction.
    pub wo: Vec3,
    /// f |cos wo| / forward; for a Dirac lobe its coefficient / its probability.
    pub weight: Spectrum,
    /// Density of `wo` given `wi` (1/sr), or the probability of the Dirac lobe.
    pub pdf_fwd: f32,
    /// Density of `wi` given `wo` (1/sr), or the probability of the Dirac lobe on the way back.
    pub pdf_rev: f32,
    /// True where a Dirac lobe was sampled.
    pub dirac: bool,
}

/// What a smooth surface does to rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Smooth {
    /// It reflects them.
    Mirror,
    /// It reflects and refracts them. The index behind it, where the shading normal does not point, over that before it.
    Interface(f32),
}

/// Where a Dirac lobe leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Back to where the light came from.
    Reflected,
    /// Through the surface.
    Transmitted,
}

/// What every surface model can do. `uv` is the texture position.
pub trait BsdfModel {
    /// Value and both densities of the non-Dirac part.
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue;

    /// Samples `wo`; none where nothing scatters (`wi` on a dark side, grazing, total loss).
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample>;

    /// Probability in [0, 1] with which a walk goes on from here (LW96 eq. 9: a walk ends by absorption): the largest
    /// channel of the albedo. It enters forward and backward densities alike, so it must be the same for both
    /// directions of any scattering pair. It may depend only on `uv` and, for models that do not scatter across, on the
    /// side of `wi`. Where the albedo varies more with the direction, this is some mean of it. Walks end by it and not
    /// in `sample`: how albedos become survivals is a choice, see [`crate::settings::options::Survival`].
    fn survival(&self, uv: Uv, wi: Vec3) -> f32;

    /// The part of light that passes straight through as if nothing were there (`null`: 1; `thindielectric`:
    /// its transmittance at this |cos|; opaque surfaces: 0). Equal from both sides. It is no scattering:
    /// `sample` and `evaluate` leave it out, the ray goes on and no path vertex arises.
    fn null_transmission(&self, _uv: Uv, _cosine: f32) -> Spectrum {
        Spectrum::ZERO
    }

    /// True if some of its scattering is not Dirac, so that it can be connected to another vertex.
    fn is_connectible(&self) -> bool;

    /// True if some of its scattering is Dirac.
    fn has_dirac(&self) -> bool {
        !self.is_connectible()
    }

    /// True if `null_transmission` can be other than 0.
    fn has_null(&self) -> bool {
        false
    }

    /// True if light can get to the other side other than straight through.
    fn scatters_across(&self) -> bool {
        false
    }

    /// What it does to rays, if it is smooth and nothing else.
    fn smooth(&self) -> Option<Smooth> {
        None
    }

    /// The direction and the coefficient of the Dirac lobe on one side of a smooth surface; none where light cannot go there.
    fn dirac(&self, _uv: Uv, _wi: Vec3, _side: Side, _transport: Transport) -> Option<(Vec3, Spectrum)> {
        None
    }

    /// What an `albedo` layer shows, seen from `wi`: as in Mitsuba the diffuse reflectance of models that have
    /// one, pi f towards the normal of others.
    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        let up = vec3(0.0, 0.0, 1f32.copysign(wi.z));
        self.evaluate(uv, wi, up, Transport::Radiance).value * PI
    }

    /// True if light can be transmitted, refracted or not.
    fn transmits(&self) -> bool {
        self.has_null() || self.scatters_across()
    }
}

/// Makes the enum, its dispatch, the registry and the list of test examples from one row a model. A model
/// has `fn build(&Params)`, giving itself or any other `Bsdf`, the table of its parameters, and, for the tests, `fn examples() -> Vec<_>`.
macro_rules! bsdfs {
    ($($name:literal => $model:ident,)*) => {
        models! {
            /// Any surface model.
            Bsdf: BsdfModel [$($model)*]
            #[inline] fn evaluate(uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue;
            #[inline] fn sample(uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample>;
            #[inline] fn survival(uv: Uv, wi: Vec3) -> f32;
            #[inline] fn null_transmission(uv: Uv, cosine: f32) -> Spectrum;
            #[inline] fn is_connectible() -> bool;
            #[inline] fn has_dirac() -> bool;
            #[inline] fn has_null() -> bool;
            #[inline] fn albedo(uv: Uv, wi: Vec3) -> Spectrum;
            fn smooth() -> Option<Smooth>;
            fn dirac(uv: Uv, wi: Vec3, side: Side, transport: Transport) -> Option<(Vec3, Spectrum)>;
            fn scatters_across() -> bool;
        }

        /// Every surface model there is, by plugin name.
        pub const ROWS: Registry<Plugin<Build<Bsdf>>> = Registry::new("a bsdf", &[
            $(($name, Plugin {
                table: $model::TABLE,
                build: |params: &Params<'_>| $model::build(params).map(Bsdf::from),
            }),)*
        ]);

        /// Instances of every model, for the tests that hold for all.
        #[cfg(test)]
        fn examples() -> Vec<Bsdf> {
            let mut all: Vec<Bsdf> = Vec::new();
            $(all.extend($model::examples().into_iter().map(Bsdf::from));)*
            all
        }
    };
}

bsdfs! {
    "diffuse" => Diffuse,
    "null" => Null,
    "dielectric" => Dielectric,
    "thindielectric" => ThinDielectric,
    "roughdielectric" => RoughDielectric,
    "conductor" => Conductor,
    "roughconductor" => RoughConductor,
    "plastic" => Plastic,
    "roughplastic" => RoughPlastic,
    "principled" => Principled,
    "principledthin" => PrincipledThin,
    "difftrans" => DiffuseTransmitter,
    "translucent" => Translucent,
    "twosided" => TwoSided,
    "mask" => Mask,
    "blendbsdf" => Blend,
    "normalmap" => NormalMap,
    "bumpmap" => BumpMap,
}

/// Builds the surface model that `object` describes.
pub fn build(object: &Object, library: &Library) -> Result<Bsdf> {
    ROWS.build(object, library)
}

/// The parameter `name` as a texture of reflectances or transmittances.
fn reflectance(params: &Params<'_>, name: &'static str) -> Result<Texture> {
    bounded(params, name, ": more light would leave than arrives")
}

/// The parameter `name` as a texture whose channels are in the range of its row; `why` they must be.
fn bounded(params: &Params<'_>, name: &'static str, why: &str) -> Result<Texture> {
    let texture = texture::parameter(params, name)?;
    let max = texture.max().max_element();
    match params.expected(name, f64::from(max)) {
        None => Ok(texture),
        Some(expected) => Err(params.complain(name, expected, format!("one that reaches {max}{why}"))),
    }
}

/// The `COUNT` nested bsdfs, in file order; textures and other children are not among them.
fn only_nested<const COUNT: usize>(params: &Params<'_>) -> Result<[Bsdf; COUNT]> {
    let children = params.children("bsdf", |child| ROWS.has(child.object))?;
    let nested =
        children.iter().map(|child| build(child.object, params.library)).collect::<Result<Vec<_>>>()?;
    nested.try_into().map_err(|found: Vec<Bsdf>| {
        let plural = if COUNT == 1 { "" } else { "s" };
        let remedy = format!("nest {COUNT} bsdf{plural} in the {}", params.object.plugin);
        Error::new(params.location(), format!("{COUNT} nested bsdf{plural}"), found.len().to_string(), remedy)
    })
}

/// The mirror image of `w` about the shading normal.
#[inline]
fn mirror(w: Vec3) -> Vec3 {
    vec3(-w.x, -w.y, w.z)
}
