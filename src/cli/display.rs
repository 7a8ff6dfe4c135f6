//! The options --exposure and --view: how the PNG shows an image. Neither changes the image itself.

use super::parsers::one_of;
use crate::{
    film::view::{self, Exposure, MOST_STOPS, View},
    math::Spectrum,
};
use clap::Args;

/// How the PNG shows the image.
#[derive(Args, Clone, Copy, Debug, Default, PartialEq)]
pub struct Display {
    /// Show the image in the PNG 2^STOPS times as bright; auto: so that its average becomes middle grey [default: 0]
    ///
    /// auto takes the log-average luminance of the pixels from 7 stops below the 99th percentile to there, so that
    /// neither lamps nor dark surroundings count, and makes it 0.18. The stops are printed, to be given again; frames of
    /// an animation are all shown with those of the first. The image file itself does not change.
    #[arg(long, value_name = "STOPS", value_parser = exposure, allow_negative_numbers = true)]
    pub exposure: Option<Exposure>,

    /// View transform of the PNG [default: standard]
    ///
    /// standard: the curve of Reinhard et al. 2002; an image without highlights is shown as it is, highlights keep their
    /// hue. agx: filmic, 16.5 stops from black to white with 6.5 of them above middle grey; what is bright loses colour
    /// (Sobotka 2022). aces: a fit of the curve of ACES for each channel, with more contrast (Narkowicz 2015). linear: as
    /// it is, cut off at 1. The image file itself does not change.
    #[arg(long, value_name = "NAME", value_parser = one_of(View::NAMES))]
    pub view: Option<View>,
}

impl Display {
    /// What is given here, else there.
    pub fn or(self, other: Self) -> Self {
        Self { exposure: self.exposure.or(other.exposure), view: self.view.or(other.view) }
    }

    /// Chooses an exposure for `pixels`, where that is to be done; what to say of it.
    pub fn choose(&mut self, pixels: &[Spectrum]) -> Option<String> {
        let chosen = self.exposure.filter(|exposure| *exposure == Exposure::Auto)?.stops(pixels);
        self.exposure = Some(Exposure::Stops(chosen));
        Some(format!(", shown with --exposure {chosen}"))
    }

    /// For an image of `pixels`.
    pub fn of(self, pixels: &[Spectrum]) -> view::Display {
        let stops = self.exposure.map_or(0.0, |exposure| exposure.stops(pixels));
        view::Display { view: self.view.unwrap_or_default(), stops }
    }
}

fn exposure(text: &str) -> Result<Exposure, String> {
    if text == "auto" {
        return Ok(Exposure::Auto);
    }
    let stops = text.parse().ok().filter(|stops: &f64| stops.abs() <= MOST_STOPS);
    stops
        .map(Exposure::Stops)
        .ok_or_else(|| format!("expected a number from -{MOST_STOPS} to {MOST_STOPS}, such as 2.5, or auto"))
}
