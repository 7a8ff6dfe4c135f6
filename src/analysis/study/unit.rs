//! One render of one contender, looked at on its way: all budgets of a seed share their samples.

use super::{
    clock::CpuClock,
    contender::{Entry, Renderer},
    store::Store,
};
use crate::{
    analysis::{
        metrics::{Measures, measures},
        picture::Picture,
        study::outcome::number,
    },
    error::Result,
    film::{Film, format::Format},
    learning::training,
    math::Spectrum,
    passes::{Settings, budget::Budget},
    render::{self, Image, Snapshot},
};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;

/// What one seed gave at every budget.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Unit {
    /// The seed.
    pub seed: u64,
    /// Seconds of starting, reading and compiling that are in no point; none if not known.
    pub load_seconds: Option<f64>,
    /// The times are those of a whole command, start included.
    #[serde(default)]
    pub is_timed_outside: bool,
    /// What it did, in a line, where it says.
    #[serde(default)]
    pub plan: Option<String>,
    /// By growing budgets.
    pub points: Vec<Measured>,
}

/// What one seed gave at one budget; measures as in `outcome.rs`.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Measured {
    /// Samples per pixel.
    pub samples: u64,
    /// Time of rendering (s).
    pub seconds: f64,
    /// Processor time for the same (s); none if not known.
    #[serde(default)]
    pub cpu_seconds: Option<f64>,
    /// Mean squared error.
    #[serde(with = "number")]
    pub mse: f64,
    /// Relative mean squared error.
    #[serde(with = "number")]
    pub relmse: f64,
    /// The same, trimmed.
    #[serde(with = "number")]
    pub trimmed_relmse: f64,
    /// Mean absolute relative error.
    #[serde(with = "number")]
    pub mape: f64,
    /// The symmetric one.
    #[serde(with = "number")]
    pub smape: f64,
    /// Mean of the image over that of the reference, less 1.
    #[serde(with = "number")]
    pub difference: f64,
}

impl Measured {
    fn of(Seen { snapshot, cpu_seconds }: &Seen, reference: &[Spectrum]) -> Self {
        let Measures { mse, relmse, trimmed_relmse, mape, smape, difference, .. } =
            measures(&snapshot.pixels, reference);
        Self {
            samples: snapshot.samples_per_pixel,
            seconds: snapshot.elapsed.as_secs_f64(),
            cpu_seconds: *cpu_seconds,
            mse,
            relmse,
            trimmed_relmse,
            mape,
            smape,
            difference,
        }
    }
}

/// Mean over pixels and channels.
pub fn mean(pixels: &[Spectrum]) -> f64 {
    let sum: f64 = pixels.iter().flat_map(|pixel| pixel.to_array()).map(f64::from).sum();
    sum / (3 * pixels.len()).max(1) as f64
}

/// Where a render's files lie.
#[derive(Clone, Copy, Debug)]
pub struct Slot<'a> {
    /// Scene, as in file names.
    pub scene: &'a str,
    /// Contender, as in file names.
    pub contender: &'a str,
    /// Its seed.
    pub seed: u64,
}

impl Slot<'_> {
    /// Its numbers.
    pub fn numbers(&self) -> PathBuf {
        PathBuf::from(format!("runs/{}/turns/{}/{}.json", self.scene, self.contender, self.seed))
    }

    /// Its image at the largest budget.
    pub fn last_image(&self) -> PathBuf {
        self.numbers().with_extension("exr")
    }

    /// The image to be shown of budget `index`, kept of the first seed only.
    pub fn shown_image(&self, index: usize) -> PathBuf {
        PathBuf::from(format!("images/{}/{}/{index}.exr", self.scene, self.contender))
    }
}

/// An image on its way.
pub struct Seen {
    /// The image and its time.
    pub snapshot: Snapshot,
    /// Processor time for it (s); none if not known.
    pub cpu_seconds: Option<f64>,
}

/// Renders `entry` with `seed` up to the last of `marks`, and shows it at each. `notify` hears what share is
/// done. What is known of the times, without any points.
pub fn shoot(
    entry: &Entry,
    seed: u64,
    marks: &[u64],
    notify: &mut dyn FnMut(f64),
    show: &mut dyn FnMut(Seen),
) -> Result<Unit> {
    let unit =
        |load_seconds, plan| Unit { seed, load_seconds, is_timed_outside: false, plan, points: Vec::new() };
    match &entry.renderer {
        Renderer::Own { settings, load_seconds, head } => {
            let last = marks.last().copied().unwrap_or(1);
            // The pilot's time is part of every image's.
            let budget = Budget { spent: settings.budget.spent, ..Budget::samples(last) };
            let settings = settled(settings, seed, budget);
            let film = plain_film(entry);
            let all = last as f64 * film.len() as f64;
            let progress = &mut |progress: render::Progress| notify(progress.samples as f64 / all);
            let mut clock = CpuClock::start(head.cpu_seconds);
            let show = &mut |snapshot| {
                let seen = Seen { snapshot, cpu_seconds: clock.seconds() };
                clock.hold(|| show(seen));
            };
            render::render_in_steps(&*entry.setup, &film, &settings, marks, progress, show)?;
            Ok(unit(Some(*load_seconds), Some(head.plan.clone())))
        }
        Renderer::External(external) => {
            let rendered = external.render(seed, marks)?;
            rendered.seen.into_iter().for_each(show);
            let is_timed_outside = rendered.is_timed_outside;
            Ok(Unit { is_timed_outside, ..unit(rendered.load_seconds, rendered.plan) })
        }
    }
}

/// An image of this program's, with what it says of its own noise; none of other renderers.
pub fn pilot(entry: &Entry, seed: u64, budget: Budget) -> Result<Option<Image>> {
    let Renderer::Own { settings, .. } = &entry.renderer else { return Ok(None) };
    let settings = settled(settings, seed, budget);
    // Learnt once for all renders of the scene: no sample takes a part of that time.
    training::learn_for(&entry.setup.scene, &plain_film(entry), &settings);
    render::render(&*entry.setup, &plain_film(entry), &settings, &mut |_| {}).map(Some)
}

fn settled(settings: &Settings, seed: u64, budget: Budget) -> Settings {
    let mut settings = *settings;
    settings.seed = seed;
    settings.budget = budget;
    settings
}

/// The film without alpha, which would cost rays that no measure looks at.
fn plain_film(entry: &Entry) -> Film {
    let mut film = entry.setup.film.clone();
    film.format = Format::default();
    film
}

/// Renders a unit as if nobody had rendered the scene before, and stores it; images of all budgets only if they are to be `shown`.
pub fn run(
    store: &Store,
    slot: Slot<'_>,
    entry: &Entry,
    marks: &[u64],
    reference: &Picture,
    shown: bool,
    notify: &mut dyn FnMut(f64),
) -> Result<()> {
    let (mut points, mut snapshots) = (Vec::new(), Vec::new());
    if let Renderer::Own { head, .. } = &entry.renderer {
        head.put_back(&entry.setup.scene);
    }
    let unit = shoot(entry, slot.seed, marks, notify, &mut |seen| {
        points.push(Measured::of(&seen, &reference.pixels));
        if !shown {
            snapshots.clear();
        }
        snapshots.push(Picture { pixels: seen.snapshot.pixels, ..*reference });
    })?;
    if shown {
        for (index, image) in snapshots.iter().enumerate() {
            store.write_image(slot.shown_image(index), image)?;
        }
    }
    if let Some(last) = snapshots.last() {
        store.write_image(slot.last_image(), last)?;
    }
    store.write_json(slot.numbers(), &Unit { points, ..unit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn the_difference_is_that_of_means() {
        let snapshot = |value| Seen {
            snapshot: Snapshot {
                pixels: vec![Spectrum::splat(value), Spectrum::ZERO],
                samples_per_pixel: 3,
                elapsed: Duration::from_millis(250),
            },
            cpu_seconds: None,
        };
        let found = Measured::of(&snapshot(1.5), &[Spectrum::ONE, Spectrum::ZERO]);
        assert_eq!((found.samples, found.seconds, found.difference), (3, 0.25, 0.5));
        assert_eq!(Measured::of(&snapshot(0.0), &[Spectrum::ZERO; 2]).difference, 0.0);
        let broken = Measured::of(&snapshot(f32::NAN), &[Spectrum::ONE; 2]);
        assert!(broken.relmse.is_nan() && broken.difference.is_nan());
        let text = serde_json::to_string(&broken).unwrap();
        assert!(serde_json::from_str::<Measured>(&text).unwrap().mse.is_nan());
    }
}
