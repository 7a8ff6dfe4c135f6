//! A diffuse base under a smooth coat of clear dielectric: Mitsuba's `plastic`.

use super::{BsdfModel, BsdfSample, BsdfValue, Transport, index, mirror, reflectance};
use crate::description::{Params, Table, parameter::Parameter, rows, table};
use crate::error::Result;
use crate::math::fresnel::Interface;
use crate::math::{Spectrum, Uv, Vec3, warp};
use crate::sampling::Stream;
use crate::texture::Texture;
use std::f32::consts::{FRAC_1_PI, PI};

/// The coat reflects as Fresnel says, as a Dirac lobe; what it lets in is scattered by the base until it gets
/// out. The lower side is black.
#[derive(Clone, Debug)]
pub struct Plastic {
    coat: Interface,
    /// The part of even light from outside that gets in.
    entering: f32,
    base: Base,
}

/// What smooth and rough plastic share: the tints, and the base as seen through the coat.
#[derive(Clone, Debug)]
pub(super) struct Base {
    specular: Texture,
    pub diffuse: Texture,
    /// True if what the coat throws back to the base takes on its colour each time.
    nonlinear: bool,
    /// The part of light from the base that the coat throws back.
    returned: f32,
    /// The squared index of the outside over that of the coat: light from below widens as it leaves.
    compression: f32,
}

/// The coat counts this many times its light when it is chosen against the base. The base can be connected to emitters;
/// the coat's reflection is found by sampling alone.
const FAVOURED: f32 = 4.0;

/// Beyond, next to nothing gets out of the coat again, and f32 does not know how much.
const HIGHEST_RATIO: f32 = 20.0;

/// What plastic does with light, in its own proportions.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    /// The tint of the coat's reflection.
    pub(super) specular: Spectrum,
    /// f of the base over the transmittances of the coat on both ways (1/sr).
    pub(super) base: Spectrum,
    /// Largest channel of the albedos of coat (as if all were reflected) and base (as if all got in).
    of_coat: f32,
    of_base: f32,
}

impl Shares {
    /// Probabilities of the coat, `favoured` so many times, and of the base, if the coat lets the part `into` of the
    /// light in; 0 where neither reflects any.
    #[inline]
    pub(super) fn choose(&self, into: f32, favoured: f32) -> (f32, f32) {
        let (coat, base) = (favoured * (1.0 - into) * self.of_coat, into * self.of_base);
        let total = coat + base;
        if total > 0.0 { (coat / total, base / total) } else { (0.0, 0.0) }
    }
}

/// What plastics have.
pub(super) const BASE: &[Parameter] = rows! {
    index::inside("polypropylene"),
    index::OUTSIDE,
    texture("diffuse_reflectance", 1.0, Is(0.5), "Albedo of the base."),
    texture("specular_reflectance", 1.0, Is(1.0), "Scales the coat's reflection; physically 1."),
    boolean("nonlinear", false, "True: colours shift by interreflection under the coat."),
};

impl Base {
    /// `ratio` is the index of the coat over that outside; `returned` see the field.
    pub(super) fn build(params: &Params<'_>, ratio: f32, returned: f32) -> Result<Self> {
        if !(1.0 / HIGHEST_RATIO..=HIGHEST_RATIO).contains(&ratio) {
            let expected = format!("an index at most {HIGHEST_RATIO} times that of the other side");
            return Err(params.complain("int_ior", expected, format!("{ratio} times that")));
        }
        Ok(Self {
            specular: reflectance(params, "specular_reflectance")?,
            diffuse: reflectance(params, "diffuse_reflectance")?,
            nonlinear: params.boolean("nonlinear")?,
            returned,
            compression: 1.0 / (ratio * ratio),
        })
    }

    /// `entering` is the part of even light from outside that gets in.
    #[inline]
    pub(super) fn at(&self, uv: Uv, entering: f32) -> Shares {
        let (specular, diffuse) = (self.specular.eval(uv), self.diffuse.eval(uv));
        let kept = if self.nonlinear { diffuse * self.returned } else { Spectrum::splat(self.returned) };
        let base = diffuse * (self.compression * FRAC_1_PI) / (Spectrum::ONE - kept);
        Shares {
            specular,
            base,
            of_coat: specular.max_element(),
            of_base: base.max_element() * PI * entering,
        }
    }

    /// Between the albedo in even light and that of the coat where it reflects all: walks that graze it again and again gain
    /// little weight.
    #[inline]
    pub(super) fn survival(&self, uv: Uv, entering: f32) -> f32 {
        let Shares { of_coat, of_base, .. } = self.at(uv, entering);
        let even = (1.0 - entering) * of_coat + entering * of_base;
        (even * of_coat.max(of_base)).sqrt().min(1.0)
    }

    #[cfg(test)]
    pub(super) fn examples(ratio: f32, returned: f32) -> [Self; 3] {
        let with = |specular, diffuse, nonlinear| Self {
            specular: Texture::constant(specular),
            diffuse: Texture::constant(diffuse),
            nonlinear,
            returned,
            compression: 1.0 / (ratio * ratio),
        };
        [
            with(Spectrum::ONE, Spectrum::splat(0.5), false),
            with(Spectrum::new(0.5, 0.3, 0.0), Spectrum::new(0.9, 0.5, 0.0), true),
            with(Spectrum::ONE, Spectrum::ZERO, false),
        ]
    }
}

/// The part of even light from inside a coat of relative index 1 / `index` that it throws back. Up to an index
/// of 2.5 of either side over the other this is Egan & Hilgeman's fit, as in Mitsuba: within 0.2% for plastics,
/// 1.3% at most. Beyond no fit holds and it is the average itself.
fn returned(inside: &Interface) -> f32 {
    let index = f64::from(inside.ratio);
    let inverse = 1.0 / index;
    let value = if !(0.4..=2.5).contains(&index) {
        inside.diffuse_reflectance()
    } else if index < 1.0 {
        0.6681 + 0.7099 * index - 1.4399 * index * index + 0.0636 * inverse
    } else {
        let terms = [-1.36881, 4.98554, -7.80989, 6.75335, -3.4793, 0.919_317];
        terms.iter().fold(0.0, |sum, term| sum * inverse + term)
    };
    value as f32
}

impl Plastic {
    pub(super) const TABLE: Table = table! { "A diffuse base under a smooth clear coat."; ; BASE };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let interfaces = index::interfaces(params)?;
        let coat = interfaces.outside;
        let entering = (1.0 - coat.diffuse_reflectance()) as f32;
        Ok(Self { coat, entering, base: Base::build(params, coat.ratio, returned(&interfaces.inside))? })
    }

    /// The base between two directions on the upper side.
    #[inline]
    fn scatter(&self, shares: &Shares, wi: Vec3, wo: Vec3) -> BsdfValue {
        let (into, out) = (1.0 - self.coat.reflectance(wi.z), 1.0 - self.coat.reflectance(wo.z));
        BsdfValue {
            value: shares.base * (into * out),
            pdf_fwd: shares.choose(into, FAVOURED).1 * warp::cosine_hemisphere_pdf(wo.z),
            pdf_rev: shares.choose(out, FAVOURED).1 * warp::cosine_hemisphere_pdf(wi.z),
        }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use crate::math::fresnel::Interfaces;
        let with = |(inside, outside), i: usize| {
            let Interfaces { outside: coat, inside } = Interfaces::new(inside, outside);
            let entering = (1.0 - coat.diffuse_reflectance()) as f32;
            let base = Base::examples(coat.ratio, returned(&inside))[i].clone();
            Self { coat, entering, base }
        };
        vec![with((1.49, 1.0), 0), with((1.9, 1.0), 1), with((1.5, 1.0), 2), with((1.0, 1.33), 0)]
    }
}

impl BsdfModel for Plastic {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, _: Transport) -> BsdfValue {
        if wi.z <= 0.0 || wo.z <= 0.0 {
            return BsdfValue::ZERO;
        }
        self.scatter(&self.base.at(uv, self.entering), wi, wo)
    }

    /// The coat's reflection is as likely on the way back: Fresnel's reflectance is the same there.
    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, _: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        if wi.z <= 0.0 {
            return None;
        }
        let shares = self.base.at(uv, self.entering);
        let fresnel = self.coat.reflectance(wi.z);
        let (reflect, _) = shares.choose(1.0 - fresnel, FAVOURED);
        if stream.uniform() < reflect {
            let weight = shares.specular * (fresnel / reflect);
            return Some(BsdfSample {
                wo: mirror(wi),
                weight,
                pdf_fwd: reflect,
                pdf_rev: reflect,
                dirac: true,
            });
        }
        let wo = warp::to_cosine_hemisphere(stream.square());
        self.scatter(&shares, wi, wo).sampled(wo)
    }

    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        if wi.z > 0.0 { self.base.survival(uv, self.entering) } else { 0.0 }
    }

    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        if wi.z > 0.0 { self.base.diffuse.eval(uv) } else { Spectrum::ZERO }
    }

    fn is_connectible(&self) -> bool {
        true
    }

    fn has_dirac(&self) -> bool {
        true
    }
}
