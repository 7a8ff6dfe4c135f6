//! Two pictures side by side (P03T A.3): every measure, in radiance and as a screen shows them.

mod flip;
mod map;
#[cfg(test)]
mod tests;

pub use map::{MapOf, Mapped, map};

use super::{
    metrics::{self, Measures},
    picture::Picture,
};
use crate::{
    error::{Error, Result},
    film::png::ToneCurve,
    math::Spectrum,
};
use serde::Serialize;
use std::path::Path;

/// Up to where two values count as equal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tolerance {
    /// |x - r| up to this.
    Absolute(f64),
    /// |x - r| / |r| up to this.
    Relative(f64),
}

impl Tolerance {
    fn is_exceeded(self, x: f64, r: f64) -> bool {
        match self {
            Self::Absolute(most) => (x - r).abs() > most,
            Self::Relative(most) => (x - r).abs() > most * r.abs(),
        }
    }
}

/// How to look at two pictures.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// For the share of pixels that differ.
    pub tolerance: Tolerance,
    /// What makes display values of both; if not given, the curve of the reference.
    pub curve: Option<ToneCurve>,
    /// Pixels in a degree of the eye's field of view, for FLIP.
    pub pixels_per_degree: f32,
}

/// The largest difference of two values.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Largest {
    /// |x - r|.
    pub difference: f64,
    /// Its column, from 0 at the left.
    pub column: usize,
    /// Its row, from 0 at the top.
    pub row: usize,
    /// Its channel, from 0.
    pub channel: usize,
    /// x.
    pub image: f64,
    /// r.
    pub reference: f64,
}

/// Two pictures in one kind of numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Over all values.
    #[serde(flatten)]
    pub measures: Measures,
    /// Mean of each channel of the image.
    pub mean_image: Vec<f64>,
    /// Mean of each channel of the reference.
    pub mean_reference: Vec<f64>,
    /// The first over the second; not a number where both are 0.
    pub ratio: Vec<f64>,
    /// Where they differ most.
    pub largest: Largest,
    /// Pixels that differ in some channel by more than the tolerance (%).
    pub beyond: f64,
}

/// Everything that is said of two pictures.
#[derive(Clone, Debug)]
pub struct Difference {
    /// Channels that were compared.
    pub channels: usize,
    /// In the numbers of the files.
    pub radiance: Comparison,
    /// In what a screen shows, sRGB-encoded from 0 to 1; none for layers that are no colours.
    pub display: Option<Shown>,
}

/// Two pictures as a screen shows them.
#[derive(Clone, Debug)]
pub struct Shown {
    /// What made display values of both.
    pub curve: ToneCurve,
    /// The measures.
    pub comparison: Comparison,
    /// LDR-FLIP of every pixel, in [0, 1].
    pub flip: Vec<f32>,
}

impl Shown {
    /// Mean of FLIP.
    pub fn mean_flip(&self) -> f64 {
        self.flip.iter().map(|value| f64::from(*value)).sum::<f64>() / self.flip.len() as f64
    }
}

/// Names of the measures of a comparison.
pub const MEASURES: &[&str] =
    &["mse", "rmse", "relmse", "trimmed_relmse", "mape", "smape", "difference", "largest", "beyond"];

impl Comparison {
    /// A measure by its name; of the difference of means its size.
    pub fn measure(&self, name: &str) -> Option<f64> {
        let m = &self.measures;
        Some(match name {
            "mse" => m.mse,
            "rmse" => m.rmse,
            "relmse" => m.relmse,
            "trimmed_relmse" => m.trimmed_relmse,
            "mape" => m.mape,
            "smape" => m.smape,
            "difference" => m.difference.abs(),
            "largest" => self.largest.difference,
            "beyond" => self.beyond,
            _ => return None,
        })
    }
}

impl Difference {
    /// A measure by its name, "display." before it for display values, or "flip".
    pub fn measure(&self, name: &str) -> Option<f64> {
        let display = self.display.as_ref();
        match name.strip_prefix("display.") {
            Some(name) => display?.comparison.measure(name),
            None if name == "flip" => display.map(Shown::mean_flip),
            None => self.radiance.measure(name),
        }
    }
}

/// Compares two pictures; `files` are their names, for errors.
pub fn compare(image: &Picture, reference: &Picture, files: [&Path; 2], view: &View) -> Result<Difference> {
    image.check_finite(files[0])?;
    reference.check_finite(files[1])?;
    let channels = common_channels(image, reference, files)?;
    let radiance = comparison([&image.pixels, &reference.pixels], image.width, channels, view.tolerance);
    let display = (image.is_colour && reference.is_colour).then(|| shown(image, reference, channels, view));
    Ok(Difference { channels, radiance, display })
}

/// The channels in which both can be compared: grey is a colour too.
fn common_channels(image: &Picture, reference: &Picture, files: [&Path; 2]) -> Result<usize> {
    let size = |p: &Picture| format!("{} x {} pixels", p.width, p.height);
    if (image.width, image.height) != (reference.width, reference.height) {
        let expected = format!("{}, as {} has", size(reference), files[1].display());
        let remedy = "render both at one size (tyndall render --size)";
        return Err(Error::new(files[0].display(), expected, size(image), remedy));
    }
    if image.channels == reference.channels || image.is_colour && reference.is_colour {
        return Ok(image.channels.max(reference.channels));
    }
    let expected = format!("{} channels, as {} has", reference.channels, files[1].display());
    let remedy = "compare layers that hold the same thing";
    Err(Error::new(files[0].display(), expected, image.channels.to_string(), remedy))
}

fn shown(image: &Picture, reference: &Picture, channels: usize, view: &View) -> Shown {
    let curve = view.curve.unwrap_or_else(|| ToneCurve::of(&reference.pixels));
    let [image_shown, reference_shown] =
        [image, reference].map(|p| p.pixels.iter().map(|pixel| curve.show(*pixel)).collect::<Vec<_>>());
    let flip = flip::map([&image_shown, &reference_shown], image.width, view.pixels_per_degree);
    let comparison = comparison([&image_shown, &reference_shown], image.width, channels, view.tolerance);
    Shown { curve, comparison, flip }
}

fn comparison(
    [image, reference]: [&[Spectrum]; 2],
    width: usize,
    channels: usize,
    tolerance: Tolerance,
) -> Comparison {
    let [mean_image, mean_reference] = [image, reference].map(|p| metrics::means(p)[..channels].to_vec());
    let ratio = mean_image.iter().zip(&mean_reference).map(|(x, r)| x / r).collect();
    let differs = |(x, r): (&Spectrum, &Spectrum)| {
        (0..channels).any(|channel| tolerance.is_exceeded(f64::from(x[channel]), f64::from(r[channel])))
    };
    let beyond = image.iter().zip(reference).filter(|pair| differs(*pair)).count();
    Comparison {
        measures: metrics::measures_of(image, reference, channels),
        mean_image,
        mean_reference,
        ratio,
        largest: largest([image, reference], width, channels),
        beyond: 100.0 * beyond as f64 / image.len() as f64,
    }
}

fn largest([image, reference]: [&[Spectrum]; 2], width: usize, channels: usize) -> Largest {
    let value = |at: usize, channel: usize| {
        let (image, reference) = (f64::from(image[at][channel]), f64::from(reference[at][channel]));
        let difference = (image - reference).abs();
        Largest { difference, column: at % width, row: at / width, channel, image, reference }
    };
    let all = (0..image.len()).flat_map(|at| (0..channels).map(move |channel| value(at, channel)));
    // Of equal ones the first.
    let first = value(0, 0);
    all.fold(first, |most, next| if next.difference > most.difference { next } else { most })
}
