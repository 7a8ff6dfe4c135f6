//! A weighted sum of two phase functions: Mitsuba's `blendphase`, and the two-term functions of P03 eq. 3 and
//! P03T 2.3.4.

use super::{Deflection, HenyeyGreenstein, Phase, PhaseModel, Schlick, build};
use crate::description::{Params, Table, parameter::Parameter, rows, table};
use crate::error::{Error, Result};
use crate::math::Vec3;
use crate::sampling::Stream;
use crate::volume::{self, Place, Volume, VolumeModel as _};
use std::sync::Arc;

/// (1 - weight) first + weight second.
#[derive(Clone, Debug)]
pub struct Blend {
    /// In [0, 1]; where it varies, the middle of its bounds: what the blend is like on the whole.
    weight: f32,
    varying: Option<Arc<Volume>>,
    parts: Arc<[Phase; 2]>,
}

/// What functions of two lobes have.
const TERMS: &[Parameter] = rows! {
    number("r", "", within(0.0, 1.0), Required, "Weight of the first lobe."),
    number("g1", "", between(-1.0, 1.0), Required, "Asymmetry of the first lobe."),
    number("g2", "", between(-1.0, 1.0), Required, "Asymmetry of the second lobe."),
};

impl Blend {
    /// `weight` in [0, 1] is the share of the second part.
    pub fn new(weight: f32, first: Phase, second: Phase) -> Self {
        Self { weight, varying: None, parts: Arc::new([first, second]) }
    }

    /// The share of the second part is a volume, which is evaluated everywhere; beyond 0 and 1 it counts as these.
    fn varying(weight: Arc<Volume>, first: Phase, second: Phase) -> Self {
        let [low, high] = weight.domain().unwrap_or([Vec3::ZERO; 2]);
        let [least, most] = weight.range(low, high).map(|bound| bound.x.clamp(0.0, 1.0));
        Self { varying: Some(weight), ..Self::new(0.5 * (least + most), first, second) }
    }

    fn weight_at(&self, position: Vec3) -> f32 {
        let varying = |weight: &Volume| weight.eval::<f32>(position).clamp(0.0, 1.0);
        self.varying.as_deref().map_or(self.weight, varying)
    }

    /// What `of` says of the parts, by their shares.
    #[inline]
    fn mean(&self, weight: f32, of: impl Fn(&Phase) -> f32) -> f32 {
        let [first, second] = &*self.parts;
        of(first) * (1.0 - weight) + of(second) * weight
    }

    #[inline]
    fn choose(&self, weight: f32, stream: &mut Stream) -> &Phase {
        &self.parts[usize::from(stream.uniform() < weight)]
    }

    pub(super) const TABLE: Table = table! {
        "A mixture of two phase functions: (1 - weight) first + weight second.";
        volume("weight", "", 1.0, Required, "Weight of the second; a volume is clamped to [0, 1]."),
        nested("phase", Required, "The two phase functions."),
    };

    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let weight = volume::parameter(params, "weight", place)?;
        if !weight.is_grey() {
            return Err(params.complain("weight", "one value for all colours", "one for each"));
        }
        match params.children("phase", |child| child.name != "weight")?.as_slice() {
            [first, second] => {
                let part = |object| build(object, params.library, place);
                let parts = [(first.location, part(first.object)?), (second.location, part(second.object)?)];
                if let Some((place, _)) = parts.iter().find(|(_, part)| matches!(part, Phase::Sggx(_))) {
                    let remedy = "overlap two media, one with the sggx";
                    let expected = "phase functions that leave the extinction as it is";
                    return Err(Error::new(place, expected, "an sggx", remedy));
                }
                let [(_, first), (_, second)] = parts;
                Ok(match weight {
                    Volume::Constant(weight) => Self::new(weight.eval(Vec3::ZERO), first, second),
                    weight => Self::varying(Arc::new(weight), first, second),
                })
            }
            others => Err(Error::new(
                params.location(),
                "two nested phase functions",
                format!("{}", others.len()),
                "give exactly two; a blend of three is a blend with a nested blend",
            )),
        }
    }

    pub(super) const HG_TABLE: Table = table! {
    "Two Henyey-Greenstein lobes: r hg(g1) + (1 - r) hg(g2) (P03 eq. 3)."; ; TERMS };

    pub(super) const SCHLICK_TABLE: Table = table! {
    "Two Schlick lobes (P03T 2.3.4). r, g1, g2 as fitted by Blasi et al.: Rayleigh 0.5, -0.46, 0.46; haze 0.12, -0.5, 0.7; murk 0.19, -0.65, 0.91."; ; TERMS };

    pub(super) fn two_term_hg(params: &Params<'_>) -> Result<Self> {
        Self::two_term(params, |g| HenyeyGreenstein::new(g).into())
    }

    pub(super) fn two_term_schlick(params: &Params<'_>) -> Result<Self> {
        Self::two_term(params, |g| Schlick::new(g).into())
    }

    fn two_term(params: &Params<'_>, term: fn(f64) -> Phase) -> Result<Self> {
        let first = params.float("r")?;
        Ok(Self::new((1.0 - first) as f32, term(params.float("g1")?), term(params.float("g2")?)))
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::{HenyeyGreenstein, Isotropic, Rayleigh};
        let hg = |g| Phase::HenyeyGreenstein(HenyeyGreenstein::new(g));
        let inner = Self::new(0.25, hg(0.9), hg(-0.5));
        vec![
            Self::new(0.0, hg(0.5), Phase::Isotropic(Isotropic)),
            Self::new(1.0, hg(0.5), Phase::Isotropic(Isotropic)),
            inner.clone(),
            Self::new(0.7, Phase::Blend(inner), Phase::Rayleigh(Rayleigh)),
        ]
    }
}

impl PhaseModel for Blend {
    #[inline]
    fn pdf_sr(&self, turn: Deflection) -> f32 {
        self.mean(self.weight, |part| part.pdf_sr(turn))
    }

    #[inline]
    fn sample(&self, direction: Vec3, stream: &mut Stream) -> Vec3 {
        self.choose(self.weight, stream).sample(direction, stream)
    }

    fn mean_cosine(&self) -> f32 {
        self.mean(self.weight, PhaseModel::mean_cosine)
    }
}

/// What differs from one point to another. What [`PhaseModel`] says of such a blend is so where its weight is the middle
/// of its bounds, and of such flakes where their matrix is the mean of all.
impl Phase {
    /// [`PhaseModel::pdf_sr`] at a world position.
    #[inline]
    pub fn pdf_sr_at(&self, position: Vec3, turn: Deflection) -> f32 {
        match self {
            Self::Blend(blend) => {
                blend.mean(blend.weight_at(position), |part| part.pdf_sr_at(position, turn))
            }
            Self::Sggx(flakes) => flakes.pdf_sr_at(position, turn),
            _ => self.pdf_sr(turn),
        }
    }

    /// [`PhaseModel::sample`] at a world position.
    #[inline]
    pub fn sample_at(&self, position: Vec3, direction: Vec3, stream: &mut Stream) -> Vec3 {
        match self {
            Self::Blend(blend) => {
                blend.choose(blend.weight_at(position), stream).sample_at(position, direction, stream)
            }
            Self::Sggx(flakes) => flakes.sample_at(position, direction, stream),
            _ => self.sample(direction, stream),
        }
    }

    /// True if it differs from one point to another.
    pub fn varies(&self) -> bool {
        match self {
            Self::Blend(blend) => blend.varying.is_some() || blend.parts.iter().any(Self::varies),
            Self::Sggx(flakes) => flakes.varies(),
            _ => false,
        }
    }

    /// It at `time` (s); none where it is the same at all times.
    pub fn at_time(&self, time: f64) -> Option<Self> {
        let Self::Blend(blend) = self else { return None };
        let varying = blend.varying.as_ref().and_then(|weight| weight.at_time(time)).map(Arc::new);
        let moved = blend.parts.each_ref().map(|part| part.at_time(time));
        if varying.is_none() && moved.iter().all(Option::is_none) {
            return None;
        }
        let [first, second] = moved;
        let [a, b] = &*blend.parts;
        let (first, second) = (first.unwrap_or_else(|| a.clone()), second.unwrap_or_else(|| b.clone()));
        Some(Self::Blend(match varying.or_else(|| blend.varying.clone()) {
            Some(weight) => Blend::varying(weight, first, second),
            None => Blend::new(blend.weight, first, second),
        }))
    }
}
