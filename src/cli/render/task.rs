//! What is to be rendered, as the arguments and a pilot say.

use super::{arguments::Render, precision::precision, progressive, viewer::Viewer};
use crate::{
    analysis::study::clock::CpuClock,
    cli::{console::complain, estimator::Estimator, interrupt, parsers::Samples, provenance},
    error::{Error, Result},
    film::sharing::FilmSamples,
    learning::pilot::Choice,
    passes::{Settings, budget::Budget},
    render::{Precision, sums::Picture},
    scene::build::Setup,
    transport::Algorithm,
};
use serde_json::Value;
use std::{sync::Mutex, time::Instant};

/// What is to be rendered.
pub(super) struct Task<'a> {
    /// How, and for how long.
    pub settings: Settings,
    /// That is asked for.
    pub precision: Option<Precision>,
    /// What the user wants.
    pub arguments: &'a Render,
    /// See [`provenance::made`].
    pub made: Value,
    /// Where the picture so far is shown.
    pub viewer: &'a Mutex<Option<Viewer>>,
    /// Processor time since before the pilot.
    pub clock: CpuClock,
}

impl<'a> Task<'a> {
    /// That of `setup`, and what a pilot chose.
    pub(super) fn new(
        arguments: &'a Render,
        setup: &Setup,
        viewer: &'a Mutex<Option<Viewer>>,
    ) -> Result<(Self, Option<Choice>)> {
        let clock = CpuClock::start(0.0);
        let (settings, chosen) = settings(arguments, setup)?;
        let precision = precision(arguments, setup, &settings)?;
        let recorded = provenance::settings(&arguments.scene, setup, &settings, chosen, precision)?;
        let made = provenance::made(recorded, provenance::shares_samples(setup, &settings));
        let settings = Settings { seed: arguments.seed_of_part(), ..settings };
        Ok((Self { settings, precision, arguments, made, viewer, clock }, chosen))
    }

    /// Shows what there is in the viewer, if there is one; it goes when it fails.
    pub(super) fn show(&self, picture: &dyn Picture) {
        let Ok(mut viewer) = self.viewer.lock() else { return };
        if let Some(Err(error)) = viewer.as_mut().map(|viewer| viewer.show(picture)) {
            complain(&format!("warning: lost the connection to tev: {error}"));
            *viewer = None;
        }
    }
}

/// How paths are sampled: pixels have samples of their own where they need different numbers, and for denoisers, which
/// expect that the noise of pixels is independent.
pub(in crate::cli) fn estimator(arguments: &Render, setup: &Setup) -> Result<Estimator> {
    let Render { estimator, error, pixels, denoise, .. } = arguments;
    let mut estimator = match pixels.progressive {
        None => estimator.clone(),
        Some(_) => progressive::estimator(estimator, setup)?,
    };
    let uneven = [(error.is_some(), "--error"), (pixels.progressive.is_some(), "--progressive")];
    let uneven = uneven.into_iter().find_map(|(is_given, name)| is_given.then_some(name));
    if let (Some(name), Some(FilmSamples::Shared)) = (uneven, estimator.film_samples) {
        let expected = format!("own with {name}, where pixels have different numbers of samples");
        return Err(Error::new(
            "--film-samples",
            expected,
            "shared",
            format!("remove {name} or --film-samples"),
        ));
    }
    if uneven.is_some() || *denoise {
        let usual = if *denoise { FilmSamples::Apart } else { FilmSamples::Own };
        estimator.film_samples.get_or_insert(usual);
    }
    Ok(estimator)
}

fn settings(arguments: &Render, setup: &Setup) -> Result<(Settings, Option<Choice>)> {
    let estimator = estimator(arguments, setup)?;
    let started = Instant::now();
    let (settings, chosen) = estimator.chosen(setup, arguments.seed, to_come(arguments, setup))?;
    let spent = started.elapsed();
    arguments.fog.warn_of_idle(settings.options.algorithm);
    let budget = budget(arguments, setup, settings.options.algorithm == Algorithm::Fog);
    Ok((Settings { budget: Budget { spent, ..budget }, ..settings }, chosen))
}

/// The budget by which a pilot judges. Parts of one image need not know how many there are. They choose alike, as for
/// an image without end.
pub(super) fn to_come(arguments: &Render, setup: &Setup) -> Budget {
    match arguments.samples {
        None => budget(arguments, setup, false),
        Some(_) => Budget::ENDLESS,
    }
}

/// Maximum number of samples per pixel of a preview, unless --spp is given.
const PREVIEW_SAMPLES: u64 = 4;

fn budget(arguments: &Render, setup: &Setup, is_preview: bool) -> Budget {
    let samples_per_pixel = match (arguments.spp, arguments.time_limit) {
        (Some(spp), _) => Some(u64::from(spp)),
        (None, Some(_)) if arguments.pixels.progressive.is_none() => None,
        (None, None) if arguments.error.is_some() => None,
        (None, _) if is_preview => Some(setup.samples_per_pixel.min(PREVIEW_SAMPLES)),
        (None, _) => Some(setup.samples_per_pixel),
    };
    let all = Budget {
        samples_per_pixel,
        time: arguments.time_limit,
        interrupted: interrupt::came,
        ..Budget::ENDLESS
    };
    match arguments.samples {
        None => all,
        Some(Samples { first, end }) => {
            Budget { first_sample: first.into(), samples_per_pixel: Some((end - first).into()), ..all }
        }
    }
}
