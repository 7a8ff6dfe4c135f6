//! What a scene and the command line say about how it is rendered: integrator, sampler, film.

pub mod film;
pub mod heuristic;
pub mod integrator;
pub mod options;
pub mod sampler;

use crate::{
    description::params::Child,
    error::Error,
    film::Window,
    medium::MediumOverrides,
    settings::integrator::{FogSettings, Restriction},
};
use serde_json::{Map, Value};

/// Settings of the command line that override those of the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides {
    /// Width and height (pixels).
    pub size: Option<(u32, u32)>,
    /// The only part of the image to render.
    pub crop: Option<Crop>,
    /// How flights in heterogeneous media are sampled.
    pub media: MediumOverrides,
    /// What light does in media, in place of what the integrator says.
    pub scattering: Option<Restriction>,
    /// How the preview `fog` looks.
    pub fog: FogSettings,
    /// Also an image of what each group of emitters contributes.
    pub groups: bool,
    /// Also an image of each component of radiance.
    pub components: bool,
    /// Smooth glass and metal are as rough as this.
    pub soften: Option<f64>,
    /// Files with numbers a hair out of range are refused, not mended.
    pub strict: bool,
}

impl Overrides {
    /// Those that decide about samples and that nothing else of a setup tells.
    pub fn json(&self) -> Map<String, Value> {
        let MediumOverrides { step, march_error, .. } = self.media;
        let scattering = self.scattering.map(Restriction::name);
        let all = [
            ("step", step.map(Value::from)),
            ("march_error", march_error.map(Value::from)),
            ("scattering", scattering.map(Value::from)),
            ("soften", self.soften.map(Value::from)),
        ];
        all.into_iter().filter_map(|(name, value)| Some((name.to_owned(), value?))).collect()
    }
}

/// A part of an image (pixels).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// Its top left corner.
    pub corner: [u32; 2],
    /// Pixels across and down, both positive.
    pub size: [u32; 2],
}

impl Crop {
    /// That of `window`, a part of the image `whole`.
    pub fn of(window: &Window, whole: &Window) -> Self {
        let corner = [0, 1].map(|axis| window.offset[axis] - whole.offset[axis]);
        Self { corner, size: window.size }
    }

    /// Where in its film this part of the image `whole` lies.
    pub fn within(&self, whole: &Window) -> Window {
        let offset = [0, 1].map(|axis| whole.offset[axis] + self.corner[axis]);
        Window { offset, size: self.size, ..*whole }
    }
}

impl std::fmt::Display for Crop {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { corner: [x, y], size: [width, height] } = self;
        write!(f, "{width}x{height}+{x}+{y}")
    }
}

/// The error of a second one where there may be one.
pub fn only_one(second: &Child<'_>, what: &str) -> Error {
    Error::new(second.location, format!("one {what}"), format!("a second {what}"), "remove one of them")
}
