//! What is told of the brightest contributions.

use super::super::{EmitterText, SurfaceText};
use serde::Serialize;

/// The brightest contributions of a render.
#[derive(Clone, Debug, Serialize)]
pub struct Outliers {
    /// Which program wrote it, with its version.
    pub made_by: String,
    /// Seed of the render.
    pub seed: u64,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Number of the first sample of every pixel.
    pub first_sample: u32,
    /// Samples of every pixel.
    pub samples: u32,
    /// Kinds of strategies that ran.
    pub strategies: Vec<&'static str>,
    /// Mean luminance of the image.
    pub mean: f64,
    /// Those without which there would be the least squared error first, no two of one pixel; of a single sample the brightest.
    pub outliers: Vec<Outlier>,
}

/// A contribution.
#[derive(Clone, Debug, Serialize)]
pub struct Outlier {
    /// Column and row of the pixel, from the left and from the top. A light subpath's contribution is told of once: where the
    /// filter gives the largest share of it.
    pub pixel: [u32; 2],
    /// Number of the sample.
    pub sample: u64,
    /// Where on the film (pixels).
    pub film: [f32; 2],
    /// The kind of strategy.
    pub strategy: &'static str,
    /// Light vertices.
    pub s: u32,
    /// Camera vertices, the lens among them.
    pub t: u32,
    /// Its luminance over the mean luminance of the image.
    pub times_mean: f64,
    /// Its share of the pixel, by luminance; none where that is black.
    pub pixel_share: Option<f64>,
    /// The part of the image's squared error that it adds, as its samples tell, by luminance; none of a single sample.
    pub error_share: Option<f64>,
    /// What the strategy would contribute alone: contribution over density and samples.
    pub unweighted: [f32; 3],
    /// Its weight: over all strategies of one path they sum to 1.
    pub weight: f32,
    /// What the sample of the pixel gets.
    pub value: [f32; 3],
    /// Its path, from the lens to the emitter.
    pub path: Vec<PathVertex>,
}

/// A vertex of a path.
#[derive(Clone, Debug, Serialize)]
pub struct PathVertex {
    /// What it is: "camera", "surface", "medium" or "emitter".
    pub kind: &'static str,
    /// The subpath that made it, "camera" or "light"; of next-event estimation the emitter's point is light's.
    pub subpath: &'static str,
    /// Where; none at infinity. Of the lens its middle, if it is connected to a light subpath.
    pub position: Option<[f64; 3]>,
    /// Unit direction towards it, at infinity.
    pub direction: Option<[f32; 3]>,
    /// Density by which its subpath made it, given the vertex before, in `measure`; none of the lens.
    pub density: Option<f32>,
    /// "1/m^2" on surfaces, "1/m^3" in media, "1/sr" at infinity; "1" for a probability.
    pub measure: Option<&'static str>,
    /// Its subpath went on by a Dirac lobe.
    pub dirac: bool,
    /// The medium that it lies in, or that its subpath came through.
    pub medium: Option<String>,
    /// On a surface, what it is.
    pub surface: Option<SurfaceText>,
    /// The emitter.
    pub emitter: Option<EmitterText>,
}

impl Outliers {
    /// As JSON. What is not finite is null.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

impl Outlier {
    /// A `path` that nothing else is known of.
    pub(super) fn of(s: u32, t: u32, path: Vec<PathVertex>) -> Self {
        Self {
            pixel: [0; 2],
            sample: 0,
            film: [0.0; 2],
            strategy: "",
            s,
            t,
            times_mean: 0.0,
            pixel_share: None,
            error_share: None,
            unweighted: [0.0; 3],
            weight: 0.0,
            value: [0.0; 3],
            path,
        }
    }
}

impl PathVertex {
    pub(super) fn lens() -> Self {
        Self {
            kind: "camera",
            subpath: "camera",
            position: None,
            direction: None,
            density: None,
            measure: None,
            dirac: false,
            medium: None,
            surface: None,
            emitter: None,
        }
    }
}
