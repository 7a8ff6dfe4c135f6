//! What all density functions share: a place in the world, a factor, and a box outside of which they are 0.
//!
//! Functions work in f64 in their own coordinates: a function may be defined far from where it is seen, and its
//! phases must not lose what the recentred f32 positions have.

use super::{Place, VolumeModel};
use crate::{
    description::{Params, Table, parameter::Parameter, rows},
    error::Result,
    math::{Channels, DAffine3, DVec3, RaySegment, Spectrum, SpectrumExt, Vec3, boxes},
};
use std::fmt::Debug;

/// A straight line in a function's own coordinates; t is in metres of the world.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// Where t = 0.
    pub origin: DVec3,
    /// Change of position per metre of the world.
    pub direction: DVec3,
}

impl Line {
    /// The point at `t`.
    #[inline]
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// What all density functions have.
pub(super) const COMMON: &[Parameter] = rows! {
    transform("to_world", "From local to world coordinates."),
    colour("value", "", f64::INFINITY, Is(1.0), "Scales it."),
    vector("min", "", Said("no limit"), "Lower corner, in local coordinates, of the box outside of which it is 0."),
    vector("max", "", Said("no limit"), "Upper corner of that box."),
};

/// A density function in its own coordinates, without its factor.
pub trait Function: Clone + Debug + Send + Sync {
    /// Its parameters, those in [`COMMON`] included.
    const TABLE: Table;

    /// Reads its parameters.
    fn read(params: &Params<'_>) -> Result<Self>;

    /// The value at `position`.
    fn eval(&self, position: DVec3) -> f64;

    /// Bounds of the value within a finite box inside `extent`, wide enough for rounding.
    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2];

    /// The box outside of which it is 0; entries may be infinite.
    fn extent(&self) -> [DVec3; 2] {
        EVERYWHERE
    }

    /// True if [`Self::integral`] is known in closed form.
    fn has_integral(&self) -> bool {
        true
    }

    /// The integral over t from `first` to `last`, both finite, `first` < `last`, all of it inside `extent`.
    fn integral(&self, line: &Line, first: f64, last: f64) -> f64;

    /// Instances for the tests that hold for all.
    #[cfg(test)]
    fn examples() -> Vec<Self>;
}

const EVERYWHERE: [DVec3; 2] = [DVec3::NEG_INFINITY, DVec3::INFINITY];

/// Two boxes' common part, which may be empty.
pub(super) fn common(a: [DVec3; 2], b: [DVec3; 2]) -> [DVec3; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// The box around an affine map's image of a finite box, wide enough for rounding.
fn image(map: &DAffine3, finite: [DVec3; 2]) -> [DVec3; 2] {
    let [low, high] = boxes::image(map, finite);
    // Far more than rounding can move a point by, far less than f32 can resolve.
    let slack = (low.abs().max(high.abs()) + map.translation.abs()) * 1e-12;
    [low - slack, high + slack]
}

/// A density function placed in the world.
#[derive(Clone, Debug)]
pub struct Placed<F> {
    to_own: DAffine3,
    value: Spectrum,
    bounds: [DVec3; 2],
    domain: Option<[Vec3; 2]>,
    function: F,
}

impl<F: Function> Placed<F> {
    pub(super) const TABLE: Table = F::TABLE;

    /// Reads the function and the parameters that all have.
    pub(super) fn build(params: &Params<'_>, place: &Place) -> Result<Self> {
        let function = F::read(params)?;
        let bounds = bounds(params)?;
        Ok(Self::new(function, place.to_world(params)?, params.color("value")?, bounds))
    }

    fn new(function: F, to_world: DAffine3, value: Spectrum, bounds: [DVec3; 2]) -> Self {
        let bounds = common(bounds, function.extent());
        let is_finite = bounds[0].is_finite() && bounds[1].is_finite();
        let domain = is_finite.then(|| {
            let [low, high] = image(&to_world, bounds);
            let (low, high) = (low.as_vec3(), high.as_vec3());
            [low.map(f32::next_down), high.map(f32::next_up)]
        });
        Self { to_own: to_world.inverse(), value, bounds, domain, function }
    }

    /// `segment` in own coordinates, and the part of it that lies within the bounds. What is infinite ends where f32
    /// does.
    fn clipped(&self, segment: &RaySegment) -> Option<(Line, [f64; 2])> {
        let line = Line {
            origin: self.to_own.transform_point3(segment.origin.as_dvec3()),
            direction: self.to_own.transform_vector3(segment.direction.as_dvec3()),
        };
        let last = f64::from(segment.length.min(f32::MAX));
        let [first, last] = boxes::narrowed(line.origin, line.direction, self.bounds, [0.0, last]);
        (first < last).then_some((line, [first, last]))
    }

    /// Every function plain, and moved, bounded and coloured.
    #[cfg(test)]
    pub(super) fn examples() -> Vec<Self> {
        let turn = crate::math::DMat3::from_rotation_y(0.7) * crate::math::DMat3::from_rotation_x(-1.1);
        let map = DAffine3::from_translation(DVec3::new(0.5, 0.2, -0.3))
            * DAffine3::from_mat3(turn)
            * DAffine3::from_scale(DVec3::new(1.5, -0.8, 2.0));
        let far = DAffine3::from_translation(DVec3::new(-1e5, 3e4, 2e5));
        let (small, colour) = ([DVec3::splat(-0.9), DVec3::new(0.4, 0.7, 1.2)], Spectrum::new(0.0, 0.3, 2.0));
        let example = |function: Self| function;
        F::examples()
            .into_iter()
            .flat_map(|f| {
                [
                    example(Self::new(f.clone(), DAffine3::IDENTITY, Spectrum::ONE, EVERYWHERE)),
                    example(Self::new(f.clone(), map, colour, small)),
                    example(Self::new(f, far, Spectrum::splat(0.5), EVERYWHERE)),
                ]
            })
            .collect()
    }
}

/// The corners `min` and `max`.
fn bounds(params: &Params<'_>) -> Result<[DVec3; 2]> {
    let low = params.optional_vector("min")?.unwrap_or(DVec3::NEG_INFINITY);
    let high = params.optional_vector("max")?.unwrap_or(DVec3::INFINITY);
    match low.cmplt(high).all() {
        true => Ok([low, high]),
        false => {
            Err(params.complain("max", format!("entries above those of \"min\", {low}"), high.to_string()))
        }
    }
}

/// Bounds in f32 of a value times one channel of the factor.
fn scaled([least, most]: [f64; 2], factor: f32) -> [f32; 2] {
    let (least, most) = (least * f64::from(factor), most * f64::from(factor));
    // Values are rounded to f32 and multiplied in it.
    [(least - 2e-7 * least.abs()) as f32, (most + 2e-7 * most.abs()) as f32]
}

impl<F: Function> VolumeModel for Placed<F> {
    #[inline]
    fn eval<L: Channels>(&self, position: Vec3) -> L {
        let own = self.to_own.transform_point3(position.as_dvec3());
        match own.cmpge(self.bounds[0]).all() && own.cmple(self.bounds[1]).all() {
            true => L::from_spectrum(self.value).scaled(self.function.eval(own) as f32),
            false => L::splat(0.0),
        }
    }

    fn range(&self, low: Vec3, high: Vec3) -> [Spectrum; 2] {
        let all = image(&self.to_own, [low.as_dvec3(), high.as_dvec3()]);
        let [low, high] = common(all, self.bounds);
        if !low.cmple(high).all() {
            return [Spectrum::ZERO; 2];
        }
        let [mut least, mut most] = self.function.range(low, high);
        if [low, high] != all {
            (least, most) = (least.min(0.0), most.max(0.0));
        }
        let channels: [[f32; 2]; 3] = std::array::from_fn(|c| scaled([least, most], self.value[c]));
        [0, 1].map(|end| Spectrum::from_array(channels.map(|channel| channel[end])))
    }

    fn domain(&self) -> Option<[Vec3; 2]> {
        self.domain
    }

    fn is_zero(&self) -> bool {
        self.value == Spectrum::ZERO
    }

    fn is_grey(&self) -> bool {
        self.value.is_grey()
    }

    fn has_integral(&self) -> bool {
        self.function.has_integral()
    }

    #[inline]
    fn integral<L: Channels>(&self, segment: &RaySegment) -> L {
        match self.clipped(segment) {
            Some((line, [first, last])) => {
                L::from_spectrum(self.value).scaled(self.function.integral(&line, first, last) as f32)
            }
            None => L::splat(0.0),
        }
    }

    fn moved(&self, by: DVec3) -> Self {
        let to_world = DAffine3::from_translation(by) * self.to_own.inverse();
        let own = Self::new(self.function.clone(), to_world, self.value, self.bounds);
        // Inverted once, not twice, positions are as exact as before.
        Self { to_own: self.to_own * DAffine3::from_translation(-by), ..own }
    }
}

/// All nested `plugin`s, which are parts of a function and no volumes of their own.
pub(super) fn parts<T>(
    params: &Params<'_>,
    plugin: &str,
    table: &'static Table,
    read: impl Fn(&Params<'_>) -> Result<T>,
) -> Result<Vec<T>> {
    let read = |object| {
        let part = Params::new(object, params.library, table);
        let built = read(&part)?;
        part.finish()?;
        Ok(built)
    };
    params
        .children("volume", |child| child.object.plugin == plugin)?
        .iter()
        .map(|child| read(child.object))
        .collect()
}
