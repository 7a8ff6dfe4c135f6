//! An opaque surface seen from both sides: Mitsuba's `twosided`.

use super::{Bsdf, BsdfModel, BsdfSample, BsdfValue, Transport, build};
use crate::description::{Location, Object, Params, Table, table};
use crate::error::{Error, Result};
use crate::math::{Spectrum, Uv, Vec3, vec3};
use crate::sampling::Stream;
use std::sync::Arc;

/// One model on the side of the normal and the same or another, mirrored, on the other.
#[derive(Clone, Debug)]
pub struct TwoSided {
    /// Front and back.
    sides: Arc<[Bsdf; 2]>,
}

impl TwoSided {
    /// Neither side may transmit light.
    pub fn new(front: Bsdf, back: Bsdf) -> Self {
        Self { sides: Arc::new([front, back]) }
    }

    pub(super) const TABLE: Table = table! {
        "An opaque surface with one BSDF for both sides, or one for each.";
        nested("bsdf", Required, "One for both sides, or two: front and back."),
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let children = params.children("bsdf", |_| true)?;
        let sides = children
            .iter()
            .map(|child| opaque(params, child.object, child.location))
            .collect::<Result<Vec<_>>>()?;
        match sides.as_slice() {
            [both] => Ok(Self::new(both.clone(), both.clone())),
            [front, back] => Ok(Self::new(front.clone(), back.clone())),
            others => Err(Error::new(
                params.location(),
                "one nested bsdf, or two: front and back",
                others.len().to_string(),
                "nest one or two",
            )),
        }
    }

    /// The model that `wi` hits and the factor that turns directions to its upper side.
    #[inline]
    fn side(&self, wi: Vec3) -> (&Bsdf, Vec3) {
        let [front, back] = &*self.sides;
        if wi.z > 0.0 { (front, Vec3::ONE) } else { (back, vec3(1.0, 1.0, -1.0)) }
    }

    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        use super::{Conductor, Diffuse, RoughConductor};
        let grey = |x| Bsdf::from(Diffuse::grey(x));
        let rough = RoughConductor::examples().swap_remove(2);
        let mirror = Conductor::examples().swap_remove(1);
        vec![
            Self::new(grey(0.5), grey(0.5)),
            Self::new(grey(0.9), rough.into()),
            Self::new(mirror.clone().into(), mirror.into()),
        ]
    }
}

fn opaque(params: &Params<'_>, object: &Object, location: &Location) -> Result<Bsdf> {
    let bsdf = build(object, params.library)?;
    if !bsdf.transmits() {
        return Ok(bsdf);
    }
    Err(Error::new(
        location,
        "a bsdf that transmits no light",
        format!("\"{}\"", object.plugin),
        "use it without \"twosided\": it has two sides already",
    ))
}

impl BsdfModel for TwoSided {
    #[inline]
    fn evaluate(&self, uv: Uv, wi: Vec3, wo: Vec3, transport: Transport) -> BsdfValue {
        let (bsdf, turn) = self.side(wi);
        bsdf.evaluate(uv, wi * turn, wo * turn, transport)
    }

    #[inline]
    fn sample(&self, uv: Uv, wi: Vec3, transport: Transport, stream: &mut Stream) -> Option<BsdfSample> {
        let (bsdf, turn) = self.side(wi);
        bsdf.sample(uv, wi * turn, transport, stream)
            .map(|sample| BsdfSample { wo: sample.wo * turn, ..sample })
    }

    #[inline]
    fn survival(&self, uv: Uv, wi: Vec3) -> f32 {
        let (bsdf, turn) = self.side(wi);
        bsdf.survival(uv, wi * turn)
    }

    fn albedo(&self, uv: Uv, wi: Vec3) -> Spectrum {
        let (bsdf, turn) = self.side(wi);
        bsdf.albedo(uv, wi * turn)
    }

    fn is_connectible(&self) -> bool {
        self.sides.iter().any(BsdfModel::is_connectible)
    }

    fn has_dirac(&self) -> bool {
        self.sides.iter().any(BsdfModel::has_dirac)
    }
}
