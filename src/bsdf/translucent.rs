//! The stained-glass pane of LW96 fig. 6, "scattering the incident light partly diffusely and partly
//! directionally".

use super::{BsdfModel, BsdfSample, BsdfValue, Transport, reflectance};
use crate::description::{Params, Table, table};
use crate::error::Result;
use crate::math::{Frame, Spectrum, Uv, Vec3, vec3, warp};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::f32::consts::{FRAC_1_PI, TAU};

/// A thin pane that lets light through and reflects none: what comes through is tinted by `transmittance`, and
/// of it the share `directional` goes on about as it came, the rest evenly into the far hemisphere.
///
/// LW96 gives no formula. Here the diffuse part is (1 - directional) transmittance / pi. The directional part
/// has one of two shapes:
/// - without `exponent` it passes straight through, undeflected, and is no scattering;
/// - with `exponent` n it is Phong's lobe (n + 1) / (2 pi) cos^n about the straight way on, over the larger of
///   the cosines of both directions (Neumann et al. 1999). With that divisor the pane is reciprocal, gives back
///   no more light than it got (straight on (n + 1) / (n + 2) of it, where it leaves at a smaller cosine all but the
///   ratio of the cosines is lost), and tends to the straight passage as n grows. What the lobe would throw back to
///   the near side is turned over to the far side.
///
/// Both sides are alike. Near the pane the sky behind it is seen blurred; blend it with a `diffuse` or a
/// `thindielectric` where it shall reflect, too.
#[derive(Clone, Debug)]
pub struct Translucent {
    transmittance: Texture,
    directional: f32,
    /// None: straight through.
    exponent: Option<f32>,
}

/// Narrower lobes have no more than a few directions in f32.
const LARGEST_EXPONENT: f64 = 1e8;

/// Where both directions graze more than this, no angle between them is known, and the divisor stays finite.
const LEAST_COSINE: f32 = 1e-6;

impl Translucent {
    pub(super) const TABLE: Table = table! {
        "A pane that transmits light partly undeflected and partly diffusely: the stained glass of LW96 fig. 6.";
        texture("transmittance", 1.0, Is(0.5), "Fraction of light transmitted."),
        number("directional", "", within(0.0, 1.0), Is(0.5), "Fraction of the transmitted light that is not deflected."),
        number(
            "exponent", "", within(0.0, LARGEST_EXPONENT), Optional,
            "Spreads that fraction into a lobe; greater is narrower. Reciprocity absorbs a part of it: under uniform light 33 % at 0, 12 % at 20, 1 % at 3000.",
        ),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let transmittance = reflectance(params, "transmittance")?;
        let directional = params.float("directional")? as f32;
        let exponent = params.optional_float("exponent")?.map(|exponent| exponent as f32);
        Ok(Self { transmittance, directional, exponent })
    }

    /// The share that passes straight through, the share scattered diffusely, and that scattered in a lobe.
    #[inline]
    fn shares(&self) -> [f32; 3] {
        let diffuse = 1.0 - self.directional;
        match self.exponent {
            None => [self.directional, diffuse, 0.0],
            Some(_) => [0.0, diffuse, self.directional],
        }
    }

    /// Density of the lobe at `wo` (1/sr), the turned-over part included. It is the same for `wi` given `wo`.
    #[inline]
    fn lobe(&self, n: f32, wi: Vec3, wo: Vec3) -> f32 {
        let turned = vec3(wo.x, wo.y, -wo.z);
        // cos^n of the angle to the straight way on, from 1 - cos: half the square of what the two sum up to.
        let power = |wo: Vec3| {
            let one_minus_cos = 0.5 * (wi + wo).length_squared();
            if one_minus_cos < 1.0 { (n * (-one_minus_cos).ln_1p()).exp() } else { 0.0 }
        };
        (n + 1.0) / TAU * (power(wo) + power(turned))
    }

    /// A direction of the lobe, of either side.
    #[inline]
    fn sample_lobe(n: f32, wi: Vec3, stream: &mut Stream) -> Vec3 {
        let u = stream.square();
        let one_minus_cos = -(u.x.ln() / (n + 1.0)).exp_m1();
        Frame::around(-wi).to_world(warp::near_pole(one_minus_cos, TAU * u.y)).normalize()
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let with = |transmittance, directional, exponent| Self {
            transmittance: Texture::constant(transmittance),
            directional,
            exponent,
        };
        vec![
            with(Spectrum::new(0.9, 0.3, 0.0), 0.6, None),
            with(Spectrum::ONE, 1.0, None),
            with(Spectrum::new(1.0, 0.5, 0.2), 0.5, Some(20.0)),
            with(Spectrum::ONE, 1.0, Some(0.0)),
            with(Spectrum::ONE, 0.8, Some(300.0)),
        ]
    }
}

impl BsdfModel for Translucent {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, _: Transport) -> BsdfValue {
        let [_, diffuse, directional] = self.shares();
        if wi.z * wo.z.signum() >= 0.0 || wo.z == 0.0 || diffuse + directional <= 0.0 {
            return BsdfValue::ZERO;
        }
        let lobe = self.exponent.map_or(0.0, |n| directional * self.lobe(n, wi, wo));
        let (cos_i, cos_o) = (wi.z.abs(), wo.z.abs());
        let larger = cos_i.max(cos_o).max(LEAST_COSINE);
        let scattered = 1.0 / (diffuse + directional);
        BsdfValue {
            value: self.transmittance.eval(uv) * (diffuse * FRAC_1_PI + lobe / larger),
            pdf_fwd: scattered * (diffuse * warp::cosine_hemisphere_pdf(cos_o) + lobe),
            pdf_rev: scattered * (diffuse * warp::cosine_hemisphere_pdf(cos_i) + lobe),
        }
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let [_, diffuse, directional] = self.shares();
        let w = match self.exponent {
            Some(n) if stream.uniform() * (diffuse + directional) < directional => {
                Self::sample_lobe(n, wi, stream)
            }
            _ if diffuse > 0.0 => warp::to_cosine_hemisphere(stream.square()),
            _ => return None,
        };
        let wo = vec3(w.x, w.y, -w.z.abs().copysign(wi.z));
        self.evaluate(uv, wi, wo, transport).sampled(wo)
    }

    /// Of what does not pass straight through, the part that is not absorbed.
    #[inline]
    fn survival(&self, uv: Uv, _: Vec3) -> f32 {
        let ([straight, diffuse, lobe], most) = (self.shares(), self.transmittance.eval(uv).max_element());
        if diffuse + lobe > 0.0 { (diffuse + lobe) * most / (1.0 - straight * most) } else { 0.0 }
    }

    #[inline]
    fn null_transmission(&self, uv: Uv, _: f32) -> Spectrum {
        self.transmittance.eval(uv) * self.shares()[0]
    }

    fn is_connectible(&self) -> bool {
        self.shares()[1] + self.shares()[2] > 0.0
    }

    fn has_dirac(&self) -> bool {
        false
    }

    fn has_null(&self) -> bool {
        self.shares()[0] > 0.0
    }

    fn scatters_across(&self) -> bool {
        true
    }
}
