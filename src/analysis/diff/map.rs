//! Where two pictures differ, in false colours.

use super::Difference;
use crate::{
    analysis::picture::Picture,
    math::{Spectrum, relative::Relative},
};

/// What a map shows of every pixel.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum MapOf {
    /// Mean over its channels of (x - r)^2 / (r^2 + 0.01 m^2), m the mean luminance of r.
    Relative,
    /// Mean over its channels of |x - r|.
    Absolute,
    /// Mean over its channels of x - r.
    Signed,
    /// FLIP.
    Flip,
}

/// A map, and what its colours mean.
#[derive(Clone, Debug)]
pub struct Mapped {
    /// Row by row from the top.
    pub values: Vec<f32>,
    /// The values of the first and the last colour.
    pub range: (f32, f32),
}

/// The share of pixels that the scale of a map holds, where its range is not given.
const HELD: f64 = 0.99;

/// A map of the difference between `image` and `reference`. Its scale ends at `most` > 0; if not given, FLIP's at 1
/// and others where 99 % of the pixels are below. None where FLIP is requested and not known.
pub fn map(
    of: MapOf,
    image: &Picture,
    reference: &Picture,
    difference: &Difference,
    most: Option<f32>,
) -> Option<Mapped> {
    let of_pixels = |value: &dyn Fn(f64, f64) -> f64| -> Vec<f32> {
        let pairs = image.pixels.iter().zip(&reference.pixels);
        pairs.map(|(x, r)| mean(*x, *r, difference.channels, value)).collect()
    };
    let to = Relative::to(&reference.pixels, difference.channels);
    let values = match of {
        MapOf::Relative => of_pixels(&|x, r| to.square((x - r).powi(2), r)),
        MapOf::Absolute => of_pixels(&|x, r| (x - r).abs()),
        MapOf::Signed => of_pixels(&|x, r| x - r),
        MapOf::Flip => difference.display.as_ref()?.flip.clone(),
    };
    let most = most.unwrap_or_else(|| if of == MapOf::Flip { 1.0 } else { end(&values) });
    let range = (if of == MapOf::Signed { -most } else { 0.0 }, most);
    Some(Mapped { values, range })
}

fn mean(x: Spectrum, r: Spectrum, channels: usize, value: &dyn Fn(f64, f64) -> f64) -> f32 {
    let sum: f64 = (0..channels).map(|c| value(f64::from(x[c]), f64::from(r[c]))).sum();
    (sum / channels as f64) as f32
}

/// A value > 0 that 99 % do not exceed in size; the largest where that many are 0, and 1 where all are.
fn end(values: &[f32]) -> f32 {
    let mut sizes: Vec<f32> = values.iter().map(|value| value.abs()).collect();
    sizes.sort_unstable_by(f32::total_cmp);
    let rank = (sizes.len() as f64 * HELD) as usize;
    let largest = sizes.last().copied().unwrap_or(0.0);
    let held = sizes.get(rank).copied().unwrap_or(largest);
    [held, largest].into_iter().find(|size| *size > 0.0).unwrap_or(1.0)
}
