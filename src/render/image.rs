//! Images of renders, and their progress.

use crate::{
    film::{Channel, noise::Noise},
    math::Spectrum,
    passes::faults::Faults,
};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// The progress of a render.
#[derive(Clone, Copy, Debug)]
pub struct Progress {
    /// Pixel samples done, over all pixels.
    pub samples: u64,
    /// Passes (samples per pixel) completed.
    pub passes: u64,
    /// Time since the first sample.
    pub elapsed: Duration,
    /// Its estimated relative error, once it is known.
    pub noise: Option<Noise>,
    /// The part of the pixels that have the requested precision, if one was requested.
    pub within: Option<f64>,
    /// No more samples follow.
    pub is_last: bool,
}

/// A finished render.
#[derive(Clone, Debug)]
pub struct Image {
    /// Row-major radiance, top row first.
    pub pixels: Vec<Spectrum>,
    /// Samples of every pixel.
    pub samples_per_pixel: u64,
    /// The fraction of the pixels that have one more, where the time ended before all had it.
    pub unfinished: f64,
    /// Time spent on samples, and on pilots and learning before them.
    pub elapsed: Duration,
    /// Its estimated relative error, once it is known.
    pub noise: Option<Noise>,
    /// The part of each pixel that the scene covers, in [0, 1] for filters without negative lobes; empty if not
    /// requested.
    pub alpha: Vec<f32>,
    /// The channels of all layers, in their order.
    pub layers: Vec<Channel>,
    /// How far a requested precision was reached, if one was requested.
    pub reached: Option<Reached>,
    /// What went wrong on the way.
    pub faults: Faults,
}

impl Image {
    /// Samples per pixel, on average.
    pub fn samples(&self) -> f64 {
        self.samples_per_pixel as f64 + self.unfinished
    }
}

/// The image while it is being rendered.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Row-major radiance, top row first: what a render of so many samples would have been, bit for bit.
    pub pixels: Vec<Spectrum>,
    /// Samples per pixel.
    pub samples_per_pixel: u64,
    /// Time spent on them, pilot walks included; the time for earlier snapshots is not.
    pub elapsed: Duration,
}

/// The precision required of every pixel. Its value is off by less than `error`, relative to the sum of the value and a
/// hundredth of the image's mean luminance (see [`Relative::difference`]); in every channel, with probability
/// `confidence`.
///
/// [`Relative::difference`]: crate::math::relative::Relative::difference
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
pub struct Precision {
    /// In (0, 1].
    pub error: f64,
    /// In (0, 1).
    pub confidence: f64,
}

/// How a render with a requested precision ended.
#[derive(Clone, Debug, PartialEq)]
pub struct Reached {
    /// The part of the pixels that are within the error, as estimated from their samples.
    pub share: f64,
    /// Samples taken of each pixel by camera subpaths.
    pub samples: Vec<u32>,
}
