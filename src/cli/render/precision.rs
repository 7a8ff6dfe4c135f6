//! The options --error and --confidence.

use super::arguments::Render;
use crate::{
    error::{Error, Result},
    film::layer::Content,
    render::{Precision, Settings},
    scene::build::Setup,
};

/// What every pixel is to be known with.
pub(crate) fn precision(arguments: &Render, setup: &Setup, settings: &Settings) -> Result<Option<Precision>> {
    let Some(error) = arguments.error else { return Ok(None) };
    let refuse = |found: &str, remedy: &str| {
        let expected = "an image without layers of moments";
        Err(Error::new("--error", expected, found, remedy))
    };
    if settings.options.algorithm.is_preview() {
        let found = format!("the preview {}", settings.options.algorithm.name());
        return refuse(&found, "remove --error, or choose another --integrator");
    }
    if setup.integrator.layers.iter().any(|layer| layer.needs_squares() || layer.content == Content::Mean) {
        return refuse(
            "the integrator moment",
            "remove --error, or remove the integrator moment from the scene",
        );
    }
    Ok(Some(Precision { error, confidence: arguments.confidence.unwrap_or(CONFIDENCE) }))
}

/// Default probability that a pixel is within the error.
const CONFIDENCE: f64 = 0.95;
