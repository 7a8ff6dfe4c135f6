//! A surface with holes: Mitsuba's `mask`.

use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Transport, bounded, only_nested};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Spectrum, Uv, Vec3};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::sync::Arc;

/// The nested model where it is opaque, nothing at all where it is not.
#[derive(Clone, Debug)]
pub struct Mask {
    opacity: Texture,
    nested: Arc<Bsdf>,
}

impl Mask {
    pub(super) const TABLE: Table = table! {
        "A surface with holes.";
        texture("opacity", 1.0, Is(0.5), "Fraction of the surface that is present."),
        nested("bsdf", Required, "The surface."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let opacity = bounded(params, "opacity", "")?;
        let [nested] = only_nested(params)?;
        Ok(Self { opacity, nested: Arc::new(nested) })
    }

    #[inline]
    fn opacity(&self, uv: Uv) -> f32 {
        self.opacity.number(uv).clamp(0.0, 1.0)
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::{Diffuse, Plastic, ThinDielectric, TwoSided};
        let with = |opacity, nested: Bsdf| Self {
            opacity: Texture::constant(Spectrum::splat(opacity)),
            nested: Arc::new(nested),
        };
        let pane = ThinDielectric::examples().swap_remove(4);
        let plastic = Plastic::examples().swap_remove(1);
        let inner = with(0.4, Diffuse::grey(0.9).into());
        vec![
            with(0.7, Diffuse::grey(0.8).into()),
            with(0.5, TwoSided::new(plastic.into(), Diffuse::grey(0.5).into()).into()),
            with(0.25, pane.into()),
            with(0.5, inner.into()),
            with(0.0, Diffuse::grey(0.8).into()),
        ]
    }
}

impl BsdfModel for Mask {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        let nested = self.nested.evaluate(uv, wi, wo, transport);
        BsdfValue { value: nested.value * self.opacity(uv), ..nested }
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let nested = self.nested.sample(uv, wi, transport, stream)?;
        Some(BsdfSample { weight: nested.weight * self.opacity(uv), ..nested })
    }

    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        self.nested.survival(uv, wi)
    }

    #[inline]
    fn null_transmission(&self, uv: Uv, cosine: f32) -> Spectrum {
        let opacity = self.opacity(uv);
        self.nested.null_transmission(uv, cosine) * opacity + Spectrum::splat(1.0 - opacity)
    }

    fn is_connectible(&self) -> bool {
        self.nested.is_connectible()
    }

    fn has_dirac(&self) -> bool {
        self.nested.has_dirac()
    }

    fn has_null(&self) -> bool {
        true
    }

    /// As in Mitsuba, holes do not count.
    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        self.nested.albedo(uv, wi)
    }

    fn scatters_across(&self) -> bool {
        self.nested.scatters_across()
    }
}
