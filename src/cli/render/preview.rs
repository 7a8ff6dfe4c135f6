//! How the preview `fog` looks, in place of what the scene says.

use crate::{
    cli::console::complain,
    math::{Spectrum, vec3},
    settings::integrator::FogSettings,
    transport::Algorithm,
};
use clap::Args;

/// How the preview looks.
#[derive(Args, Clone, Copy, Debug, PartialEq)]
pub struct Preview {
    /// Radiance of the fog in the preview of --integrator fog (W/(m^2 sr)): one number, or red, green and blue [default: the
    /// scene's fog_color, or the mean of the sky, or that of the lit surfaces]
    #[arg(long, value_name = "R,G,B", value_parser = radiance, allow_negative_numbers = true)]
    pub fog_color: Option<Spectrum>,

    /// Radiance from all directions, besides the emitters, in the preview of --integrator fog (W/(m^2 sr)): one number, or red,
    /// green and blue [default: the scene's, or 0 under a sky, or that of the fog]
    #[arg(long, value_name = "R,G,B", value_parser = radiance, allow_negative_numbers = true)]
    pub ambient: Option<Spectrum>,

    /// Distance beyond which the preview of --integrator fog shows fog alone (m) [default: the scene's, or no limit]
    #[arg(long, value_name = "METRES", value_parser = distance, allow_negative_numbers = true)]
    pub threshold: Option<f32>,
}

fn radiance(text: &str) -> Result<Spectrum, String> {
    let number = |text: &str| text.trim().parse().ok().filter(|x: &f32| *x >= 0.0 && x.is_finite());
    let numbers: Option<Vec<f32>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some([grey]) => Ok(Spectrum::splat(*grey)),
        Some([r, g, b]) => Ok(vec3(*r, *g, *b)),
        _ => {
            Err("expected a radiance of 0 or more, such as 0.5, or three of them, such as 0.4,0.5,0.6".into())
        }
    }
}

fn distance(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|far: &f32| *far > 0.0 && far.is_finite());
    number.ok_or_else(|| "expected a distance above 0 in metres, such as 40".to_owned())
}

impl Preview {
    /// These settings; those of the scene where they say nothing.
    pub fn settings(&self) -> FogSettings {
        FogSettings { color: self.fog_color, ambient: self.ambient, threshold: self.threshold }
    }

    /// Warns where `algorithm` is another than this preview.
    pub fn warn_of_idle(&self, algorithm: Algorithm) {
        let given = [
            ("--fog-color", self.fog_color.is_some()),
            ("--ambient", self.ambient.is_some()),
            ("--threshold", self.threshold.is_some()),
        ];
        for (flag, _) in given.into_iter().filter(|(_, is_given)| *is_given && algorithm != Algorithm::Fog) {
            complain(&format!("warning: {flag} has no effect: it belongs to the preview --integrator fog"));
        }
    }
}
