//! What the command line says about media, in place of what the scene says: how flights in those that vary are sampled,
//! and how often light is scattered in any.

use super::{console::complain, parsers::one_of};
use crate::{
    medium::{DistanceMethod, MediumOverrides},
    scene::{Scene, build::Setup},
    settings::{Overrides, integrator::Restriction},
};
use clap::Args;

/// How light goes through media.
#[derive(Args, Clone, Copy, Debug, PartialEq)]
pub struct Media {
    /// Free-flight sampling method in heterogeneous media [default: the setting of each medium]
    ///
    /// auto: the cheapest unbiased method; closed_form: closed-form optical depth, not available for every
    /// volume; exact: regular tracking of grids, cell by cell; march: ray marching, biased by its step size;
    /// null_collision: delta tracking and ratio tracking; residual_ratio: delta tracking and residual ratio
    /// tracking.
    #[arg(long, value_name = "NAME", value_parser = one_of(&DistanceMethod::NAMES))]
    pub tracker: Option<DistanceMethod>,

    /// Ray-march heterogeneous media by intervals of at most this length (m) [default: the setting of each medium]
    ///
    /// Implies --tracker march. `tyndall study SCENE --vary step=0.4,0.2,0.1` measures the bias of each step.
    #[arg(long, value_name = "METRES", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,

    /// Ray-march heterogeneous media by the longest intervals with at most this error of transmittance, from 1e-7 to 1
    /// [default: the setting of each medium]
    ///
    /// Implies --tracker march. The error is measured along many segments before the render begins.
    #[arg(long, value_name = "E", value_parser = march_error, conflicts_with = "step", allow_negative_numbers = true)]
    pub march_error: Option<f64>,

    /// How often media scatter light [default: the scene's integrator]
    ///
    /// multiple: as often as it happens; single: once at most, with paths of at most two segments and ray marching
    /// unless --tracker says otherwise, as the integrator single_scattering; none: they absorb and emit only, as the integrator
    /// non_scattering.
    #[arg(long, value_name = "NAME", value_parser = one_of(&Restriction::NAMES))]
    pub scattering: Option<Restriction>,
}

fn step(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|step: &f64| *step > 0.0 && step.is_finite());
    number.ok_or_else(|| "expected a length above 0 in metres, such as 0.05".to_owned())
}

fn march_error(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|error: &f64| (1e-7..=1.0).contains(error));
    number.ok_or_else(|| "expected an error of transmittance from 1e-7 to 1, such as 1e-3".to_owned())
}

impl Media {
    /// What these options override in a scene.
    pub fn overrides(&self) -> Overrides {
        let Self { tracker, step, march_error, scattering } = *self;
        let marching = (step.is_some() || march_error.is_some()).then_some(DistanceMethod::RayMarching);
        let media = MediumOverrides { tracker: tracker.or(marching), step, march_error, absorbing: false };
        Overrides { media, scattering, ..Overrides::default() }
    }
}

/// What of `overrides` makes no difference to a scene, and why.
pub(super) fn idle(overrides: &Overrides, scene: &Scene) -> Option<String> {
    let MediumOverrides { tracker, step, march_error, .. } = overrides.media;
    let given = [("--step", step.is_some()), ("--march-error", march_error.is_some())];
    let marching = given.into_iter().find_map(|(flag, is_given)| is_given.then_some(flag));
    let mut varying = scene.media.iter().filter_map(|medium| medium.heterogeneous()).peekable();
    match (marching, tracker) {
        (None, None) => None,
        (flag, _) if varying.peek().is_none() => {
            let flag = flag.unwrap_or("--tracker");
            Some(format!("{flag} has no effect: this scene has no heterogeneous medium"))
        }
        (Some(flag), Some(tracker)) if tracker != DistanceMethod::RayMarching => {
            let name = tracker.name();
            Some(format!("{flag} has no effect: --tracker {name} does not march"))
        }
        _ => None,
    }
}

/// Warns of what makes no difference to `setup`.
pub(super) fn warn_of_idle(overrides: &Overrides, setup: &Setup) {
    if let Some(text) = idle(overrides, &setup.scene) {
        complain(&format!("warning: {text}"));
    }
}
