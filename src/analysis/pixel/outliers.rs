//! The contributions that make single bright pixels (fireflies), with their paths. Only the brightest of each pixel
//! counts. They are sorted by the squared error that they add to the image: an emitter that is seen in every sample of
//! its pixels is bright, but no noise.

mod page;
mod path;
mod report;
mod search;
mod table;

pub use page::page;
pub use report::*;
pub use table::table;

use super::sample::PixelSample;
use crate::{
    error::Result,
    film::moments::Moments,
    math::SpectrumExt,
    memory,
    render::{Settings, Stage},
    scene::build::Setup,
};
use path::replay;
use search::{Found, search};
use std::cmp::Ordering;

/// Numbers of four bytes that are kept of every pixel: sums and squares, the pass at hand, the brightest contribution.
const NUMBERS: usize = 26;

/// What is searched.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// How many contributions are told of, at most.
    pub most: usize,
    /// Number of the first sample of every pixel.
    pub first: u32,
    /// How many samples of every pixel, above 0.
    pub samples: u32,
}

/// The contributions to the samples of `plan` that make most of the error of a render by `settings`. Says how many samples are
/// done.
pub fn examine(
    setup: &Setup,
    settings: &Settings,
    plan: &Plan,
    progress: &mut dyn FnMut(u64),
) -> Result<Outliers> {
    let film = &setup.film;
    crate::analysis::check_paths(settings.options.algorithm)?;
    let size = format!("{} x {} pixels", film.width, film.height);
    let remedy = "use a smaller --size";
    memory::check("tyndall pixel --outliers", "an image", &size, Some(film.bytes(NUMBERS)), remedy)?;
    let stage = Stage::of(setup, film, settings);
    let first = plan.first as usize;
    let samples = first..first + plan.samples as usize;
    let (found, moments) = search(&stage, samples, progress)?;
    let image = Image::of(&moments);
    let mut outliers = Vec::new();
    for one in image.worst(found, plan.most) {
        let (number, pixel) = (one.sample as usize, one.pixel as usize);
        let sample = stage.show(number as u64, |instrument, _| PixelSample::of(instrument, number, pixel))?;
        outliers.extend(replay(setup, &sample, &one).map(|outlier| image.judge(&one, &sample, outlier)));
    }
    outliers.sort_by(|a, b| b.error_share.partial_cmp(&a.error_share).unwrap_or(Ordering::Equal));
    Ok(Outliers {
        made_by: concat!("Tyndall ", env!("CARGO_PKG_VERSION")).to_owned(),
        seed: settings.seed,
        size: [film.width, film.height],
        first_sample: plan.first,
        samples: plan.samples,
        strategies: settings.options.strategies.names(),
        mean: image.mean,
        outliers,
    })
}

/// What contributions are measured by: luminances.
struct Image {
    samples: f64,
    /// Sums over the samples of each pixel.
    sums: Vec<f64>,
    mean: f64,
    /// Squared deviations of all samples from the means of their pixels, summed; none of a single sample.
    deviations: Option<f64>,
}

impl Image {
    fn of(moments: &Moments) -> Self {
        let samples = moments.passes() as f64;
        let sums: Vec<f64> =
            moments.mean().iter().map(|pixel| samples * f64::from(pixel.luminance())).collect();
        let mean = sums.iter().sum::<f64>() / samples / sums.len() as f64;
        let deviations = moments.luminance_variance().map(|variance| variance * (samples - 1.0));
        Self { samples, sums, mean, deviations }
    }

    /// How much a contribution `own` to a sample of `all` adds to the squared deviations of a pixel that adds up to
    /// `sum`: sum x^2 - (sum x)^2 / n with it, less the same without it.
    fn less(&self, own: f64, all: f64, sum: f64) -> f64 {
        own * (2.0 * all - own) - own * (2.0 * sum - own) / self.samples
    }

    /// Those of `found` that add most error, no more than `most`, as if each were alone in its sample; for a single
    /// sample, which tells of no error, the brightest.
    fn worst(&self, found: Vec<Found>, most: usize) -> Vec<Found> {
        let size = |one: &Found| {
            let own = f64::from(one.luminance);
            let is_one = self.deviations.is_none();
            if is_one { own.abs() } else { self.less(own, own, self.sums[one.pixel as usize]) }
        };
        let mut sized: Vec<(f64, Found)> = found.into_iter().map(|one| (size(&one), one)).collect();
        sized.sort_by(|a, b| b.0.total_cmp(&a.0));
        sized.into_iter().take(most).take_while(|(size, _)| *size > 0.0).map(|(_, one)| one).collect()
    }

    /// Says how much the contribution is of its pixel and of the error.
    fn judge(&self, found: &Found, sample: &PixelSample, outlier: Outlier) -> Outlier {
        let (own, sum) = (f64::from(found.luminance), self.sums[found.pixel as usize]);
        let less = self.less(own, f64::from(sample.value.luminance()), sum);
        Outlier {
            times_mean: own.abs() / self.mean,
            pixel_share: (sum != 0.0).then(|| own / sum),
            error_share: self.deviations.filter(|all| *all > 0.0).map(|all| less / all),
            ..outlier
        }
    }
}
