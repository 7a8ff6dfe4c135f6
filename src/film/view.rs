//! How a screen shows an image: its exposure, and the view transform from radiance to the range of the screen. Neither
//! is stored in the image.

mod agx;
mod exposure;
#[cfg(test)]
mod tests;

pub use exposure::{Exposure, MOST_STOPS};

use super::png::ToneCurve;
use crate::math::{
    Spectrum,
    srgb::{Srgb as _, byte, shown},
};
use agx::Agx;

/// View transforms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum View {
    /// [`ToneCurve::White`]: an image without highlights is shown as it is; highlights keep their hue.
    #[default]
    Standard,
    /// [`agx`]: a filmic curve over 16.5 stops; what is bright loses colour, as on film.
    Agx,
    /// The fit by Narkowicz (2015) of the curve of ACES, each channel by itself: more contrast than AgX.
    Aces,
    /// As it is, cut off at 1.
    Linear,
}

impl View {
    /// Every view by its name.
    pub const NAMES: &[(&'static str, Self)] =
        &[("standard", Self::Standard), ("agx", Self::Agx), ("aces", Self::Aces), ("linear", Self::Linear)];

    /// Its name.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, view)| *view == self).map_or("", |(name, _)| name)
    }
}

/// How an image is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// The view transform.
    pub view: View,
    /// Radiance is multiplied by 2 to the power of this first: from -[`MOST_STOPS`] to [`MOST_STOPS`].
    pub stops: f64,
}

impl Display {
    /// `pixels` (linear sRGB) as 8-bit sRGB, three bytes each. NaN and negative channels are shown black, infinite ones
    /// white.
    pub fn bytes(self, pixels: &[Spectrum]) -> Vec<u8> {
        self.bytes_like(pixels, pixels)
    }

    /// The same, by the curve that suits `model`: images of one scene side by side are shown alike, whatever their noise.
    pub fn bytes_like(self, pixels: &[Spectrum], model: &[Spectrum]) -> Vec<u8> {
        let scale = self.stops.exp2() as f32;
        let expose = |pixels: &[Spectrum]| pixels.iter().map(|pixel| shown(*pixel * scale)).collect();
        let exposed: Vec<Spectrum> = expose(pixels);
        match self.view {
            View::Standard => {
                let curve = ToneCurve::of(&expose(model));
                bytes(&exposed, |pixel| curve.map(pixel))
            }
            View::Agx => {
                let agx = Agx::new();
                bytes(&exposed, |pixel| agx.map(pixel))
            }
            View::Aces => bytes(&exposed, |pixel| each(pixel, aces)),
            View::Linear => bytes(&exposed, |pixel| pixel),
        }
    }
}

/// Pixels that `map` makes linear sRGB for a screen, cut off at 0 and 1.
fn bytes(pixels: &[Spectrum], map: impl Fn(Spectrum) -> Spectrum) -> Vec<u8> {
    pixels.iter().flat_map(|pixel| encoded(map(*pixel)).to_array().map(byte)).collect()
}

/// Linear sRGB for a screen, cut off at 0 and 1, as sRGB-encoded channels.
pub fn encoded(linear: Spectrum) -> Spectrum {
    each(linear, |c| c.clamp(0.0, 1.0).srgb_encoded())
}

fn each(pixel: Spectrum, curve: impl Fn(f32) -> f32) -> Spectrum {
    Spectrum::from_array(pixel.to_array().map(curve))
}

/// Narkowicz, "ACES filmic tone mapping curve" (2015): a rational fit for x up to 16 or so, which tends to 251 / 243.
fn aces(x: f32) -> f32 {
    let x = f64::from(x);
    (x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)) as f32
}
