//! A surface whose normal is another than its shape's: what `normalmap` and `bumpmap` share.

use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Transport, only_nested};
use crate::description::{Params, parameter::Parameter, rows};
use crate::error::Result;
use crate::math::{Frame, Spectrum, Uv, Vec3, vec3};
use crate::sampling::Stream;
use std::sync::Arc;

/// Where normals come from.
pub trait Normals {
    /// Along the normal at `uv`, in the shading frame; of any length.
    fn normal(&self, uv: Uv) -> Vec3;
}

/// The nested model, seen in a frame around another normal.
///
/// As in Mitsuba, that frame depends on the direction of the eye, and the shadowing on that of the light. The model is
/// thus one function of both, whichever way a path is walked; it is not reciprocal. Eye and light must each be on the
/// same side of the surface in both frames. Mitsuba demands this of the light alone, which differs without
/// `flip_invalid_normals`.
#[derive(Clone, Debug)]
pub struct Perturbed<N> {
    normals: N,
    nested: Arc<Bsdf>,
    flips: bool,
    shadows: bool,
}

/// Where light grazes more than this, what it brings stays finite.
const LEAST_COSINE: f32 = 1e-6;

/// What both plugins have.
pub(super) const PERTURBED: &[Parameter] = rows! {
    boolean("flip_invalid_normals", true, "True: where the eye would see the back of the perturbed surface, its normal is tilted the other way."),
    boolean("use_shadowing_function", true, "True: light that grazes the surface is dimmed, against hard edges of shadows (Estevez et al. 2019)."),
    nested("bsdf", Required, "The surface."),
};

/// The perturbed surface at one point.
struct Here {
    /// Unit.
    normal: Vec3,
    flips: bool,
}

impl Here {
    /// True if for an eye there the normal is tilted the other way.
    #[inline]
    fn is_flipped_for(&self, eye: Vec3) -> bool {
        self.flips && eye.z * eye.dot(self.normal) <= 0.0
    }

    #[inline]
    fn frame(&self, flipped: bool) -> Frame {
        let Vec3 { x, y, z } = self.normal;
        let normal = if flipped { vec3(-x, -y, z) } else { self.normal };
        let tangent = (Vec3::X - normal * normal.x).try_normalize().unwrap_or(Vec3::Y);
        Frame { tangent, bitangent: normal.cross(tangent), normal }
    }

    /// Probability that a walk from a light takes the frame `flipped` for the eye, or the other: about the share of
    /// such eyes.
    #[inline]
    fn chance(&self, flipped: bool) -> f32 {
        let Vec3 { x, y, z } = self.normal;
        let share = if self.flips { 0.5 * (x * x + y * y) / (1.0 + z.max(0.0)) } else { 0.0 };
        if flipped { share } else { 1.0 - share }
    }
}

/// Both in one order: the eye's and the light's of the directions where a walk came from and goes to.
#[inline]
fn ends(transport: Transport, wi: Vec3, wo: Vec3) -> [Vec3; 2] {
    if transport == Transport::Radiance { [wi, wo] } else { [wo, wi] }
}

/// What `look` sees where textures are looked up in the perturbed frame, as a perturbed surface nested in it does.
#[inline]
fn within<R>(frame: &Frame, uv: Uv, look: impl FnOnce(Uv) -> R) -> R {
    if let Uv::Known(detail) = uv { look(Uv::Known(&detail.turned(frame))) } else { look(uv) }
}

/// True if `w` is on the same side of the surface in both frames.
#[inline]
fn agree(w: Vec3, local: Vec3) -> bool {
    w.z > 0.0 && local.z > 0.0 || w.z < 0.0 && local.z < 0.0
}

impl<N: Normals> Perturbed<N> {
    pub(super) fn build_around(params: &Params<'_>, normals: N) -> Result<Self> {
        let [nested] = only_nested(params)?;
        let flips = params.boolean("flip_invalid_normals")?;
        Ok(Self {
            normals,
            nested: Arc::new(nested),
            flips,
            shadows: params.boolean("use_shadowing_function")?,
        })
    }

    #[cfg(test)]
    pub(super) fn example(normals: N, nested: Bsdf, flips: bool, shadows: bool) -> Self {
        Self { normals, nested: Arc::new(nested), flips, shadows }
    }

    #[inline]
    fn at(&self, uv: Uv) -> Here {
        let normal = self.normals.normal(uv).try_normalize().unwrap_or(Vec3::Z);
        Here { normal, flips: self.flips }
    }

    /// The factor on the nested value for `light`, which is `local` in the perturbed frame: the ratio of its cosines,
    /// shadowed.
    #[inline]
    fn factor(&self, here: &Here, light: Vec3, local: Vec3) -> f32 {
        let (cosine, Vec3 { x, y, z }) = (light.z.abs(), here.normal);
        if !self.shadows {
            return local.z.abs() / cosine.max(LEAST_COSINE);
        }
        let (tilt, square) = (0.125 * (x * x + y * y), z * z);
        let alpha_square = if tilt < square { tilt / square } else { 1.0 };
        let spread = alpha_square * (light.x * light.x + light.y * light.y);
        2.0 * local.z.abs() / (cosine + (cosine * cosine + spread).sqrt()).max(LEAST_COSINE)
    }
}

impl<N: Normals> BsdfModel for Perturbed<N> {
    // Never inlined, like all that follow: calls of the common models, which share their dispatch, stay small.
    #[inline(never)]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        let here = self.at(uv);
        let [eye, light] = ends(transport, wi, wo);
        let flipped = here.is_flipped_for(eye);
        let frame = here.frame(flipped);
        let (from, to) = (frame.to_local(wi), frame.to_local(wo));
        if !agree(wi, from) || !agree(wo, to) {
            return BsdfValue::ZERO;
        }
        let BsdfValue { value, pdf_fwd, pdf_rev } =
            within(&frame, uv, |uv| self.nested.evaluate(uv, from, to, transport));
        let factor = self.factor(&here, light, ends(transport, from, to)[1]);
        let chance = here.chance(flipped);
        let [fwd, rev] = if transport == Transport::Radiance { [1.0, chance] } else { [chance, 1.0] };
        BsdfValue { value: value * factor, pdf_fwd: pdf_fwd * fwd, pdf_rev: pdf_rev * rev }
    }

    /// A walk from a light does not know yet where the eye will be. It takes one of both frames, and ends if the eye
    /// does not see that one.
    #[inline(never)]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let here = self.at(uv);
        let is_camera = transport == Transport::Radiance;
        let flipped = if is_camera { here.is_flipped_for(wi) } else { stream.uniform() < here.chance(true) };
        let frame = here.frame(flipped);
        let from = frame.to_local(wi);
        if !agree(wi, from) {
            return None;
        }
        let nested = within(&frame, uv, |uv| self.nested.sample(uv, from, transport, stream))?;
        let wo = frame.to_world(nested.wo).normalize();
        if !agree(wo, nested.wo) || !is_camera && here.is_flipped_for(wo) != flipped {
            return None;
        }
        if !nested.dirac {
            return self.evaluate(uv, wi, wo, transport).sampled(wo);
        }
        let chance = here.chance(flipped);
        let [light, local] = if is_camera { [wo, nested.wo] } else { [wi, from] };
        let cosines = wo.z.abs() / nested.wo.z.abs();
        let [fwd, rev] = if is_camera { [1.0, chance] } else { [chance, 1.0] };
        Some(BsdfSample {
            wo,
            weight: nested.weight * (self.factor(&here, light, local) * cosines / fwd),
            pdf_fwd: nested.pdf_fwd * fwd,
            pdf_rev: nested.pdf_rev * rev,
            dirac: true,
        })
    }

    #[inline(never)]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        self.nested.survival(uv, wi)
    }

    /// Of the unperturbed surface: light that passes straight through knows no frame. Mitsuba 3.9.1 lets such light through where
    /// it samples it, and none where it connects to emitters.
    fn null_transmission(&self, uv: Uv, cosine: f32) -> Spectrum {
        self.nested.null_transmission(uv, cosine)
    }

    fn is_connectible(&self) -> bool {
        self.nested.is_connectible()
    }

    fn has_dirac(&self) -> bool {
        self.nested.has_dirac()
    }

    fn has_null(&self) -> bool {
        self.nested.has_null()
    }

    fn scatters_across(&self) -> bool {
        self.nested.scatters_across()
    }

    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        self.nested.albedo(uv, wi)
    }
}
