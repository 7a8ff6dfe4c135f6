//! Exposure, in stops: given, or chosen from the image.

use crate::math::{
    Spectrum, SpectrumExt,
    srgb::{shown, white},
};

/// More stops than this nobody needs.
pub const MOST_STOPS: f64 = 60.0;
/// What the average is shown as: middle grey.
const GREY: f64 = 0.18;
/// The share of pixels that are not brighter than the highlights: lamps and their noise decide about nothing.
const BELOW_HIGHLIGHTS: f64 = 0.99;
/// What is so many stops below the highlights counts for nothing either: a dark surrounding is to stay dark.
const STOPS_BELOW: f32 = 7.0;

/// How bright an image is shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Exposure {
    /// Radiance times 2 to the power of this.
    Stops(f64),
    /// The log-average luminance (Reinhard et al. 2002, eq. 1) becomes middle grey, 0.18: that of the pixels from
    /// 7 stops below the 99th percentile to there. Whole hundredths of a stop, to be written down and given again.
    Auto,
}

impl Exposure {
    /// Stops for `pixels` (linear sRGB); 0 for black ones.
    pub fn stops(self, pixels: &[Spectrum]) -> f64 {
        match self {
            Self::Stops(stops) => stops,
            Self::Auto => {
                let stops = average(pixels).map_or(0.0, |average| GREY.log2() - average);
                // No -0, which would be printed.
                ((stops.clamp(-MOST_STOPS, MOST_STOPS) * 100.0).round() / 100.0) + 0.0
            }
        }
    }
}

/// Mean of the logarithm, to base 2, of the luminances that count.
fn average(pixels: &[Spectrum]) -> Option<f64> {
    let highest = [BELOW_HIGHLIGHTS, 1.0].into_iter().filter_map(|share| white(pixels, share));
    let highest = highest.into_iter().find(|luminance| *luminance > 0.0)?;
    let lowest = highest * (-STOPS_BELOW).exp2();
    let luminances = pixels.iter().map(|pixel| shown(*pixel).luminance());
    let counted = luminances.filter(|luminance| (lowest..=highest).contains(luminance));
    let (count, sum) =
        counted.fold((0.0, 0.0), |(count, sum), luminance| (count + 1.0, sum + f64::from(luminance).log2()));
    Some(sum / count)
}
