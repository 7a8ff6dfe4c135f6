//! Methods of free-flight sampling compared (P03T A.2.1, `mcs3d`).
//!
//! Photons of unit power enter a slab or a cube, of one medium or subdivided, at one point in one direction. For each
//! method, the power that leaves through each face and the power that is absorbed are recorded: of so many photons, or
//! of as many as an error takes.

pub mod cells;
pub mod drawing;
pub mod law;
pub mod stop;
pub mod tally;
#[cfg(test)]
mod tests;
mod walk;

use crate::phase::Phase;
use cells::{Cells, Matter};
use law::{FreePath, Law};
use serde::Serialize;
use statrs::distribution::{ContinuousCDF, Normal};
use std::time::Instant;
use stop::Stop;
use tally::{Estimate, QUANTITIES, Tally};

/// The form of the medium.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Shape {
    /// Between two parallel planes, infinite to the sides.
    Slab,
    /// A cube; photons enter in the middle of a face.
    Cube,
}

/// Matter in a form.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Its form.
    pub shape: Shape,
    /// Thickness of the slab, or side length of the cube (m).
    pub size: f64,
    /// What it is, cell by cell; layers in a slab.
    pub cells: Cells,
    /// How it scatters.
    pub phase: Phase,
    /// Angle between the direction of entry and the normal of the face (rad), in [0, pi/2).
    pub angle: f64,
}

/// How far photons fly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// In steps of this length (m), scattered at the end of a step with probability 1 - exp(-sigma_s step), where sigma_s
    /// varies 1 - exp of its integral over the step, absorbed along the way (CDS; Blasi et al.). What leaves within a step
    /// is not scattered in it.
    Constant(f64),
    /// Exponentially by sigma_t; every collision leaves the albedo of the power (RDS_t).
    ByExtinction,
    /// Exponentially by sigma_s; absorbed along the way (RDS_s).
    ByScattering,
    /// As by sigma_t, but first divided into what passes and what surely collides (Pattanaik & Mudur).
    Forced,
}

impl Method {
    /// As in tables.
    pub fn name(self) -> String {
        match self {
            Self::Constant(step) => format!("CDS {step}"),
            Self::ByExtinction => "RDS_t".into(),
            Self::ByScattering => "RDS_s".into(),
            Self::Forced => "forced".into(),
        }
    }

    /// True if theory says that its means are the physical ones.
    pub fn is_unbiased(self) -> bool {
        !matches!(self, Self::Constant(_))
    }
}

/// How much work to do.
#[derive(Clone, Copy, Debug)]
pub struct Effort {
    /// Of each method.
    pub each: Run,
    /// Of the reference run.
    pub truth: Run,
    /// Seed of all random numbers.
    pub seed: u64,
}

/// How many photons one run sends.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// Their number, at least 2.
    pub photons: u64,
    /// Fewer, if this is reached before.
    pub stop: Option<Stop>,
}

/// What one method found.
#[derive(Clone, Debug, Serialize)]
pub struct Found {
    /// As in tables.
    pub method: String,
    /// Photons sent in.
    pub photons: u64,
    /// False if its error was to be reached and was not.
    pub reached: bool,
    /// Time they took (s).
    pub seconds: f64,
    /// One for each of [`QUANTITIES`], in their order.
    pub estimates: Vec<Judged>,
    /// The largest of the |z|.
    pub largest_z: f64,
    /// False if some |z| is larger than chance makes it in one study of a hundred.
    pub agrees: bool,
}

/// An estimate against the truth.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Judged {
    /// What it is of.
    pub quantity: &'static str,
    /// Mean and standard error.
    #[serde(flatten)]
    pub estimate: Estimate,
    /// Mean less truth.
    pub bias: f64,
    /// That in standard errors of both; where no two photons differ, 1 / photons replaces the method's.
    pub z: f64,
    /// Variance of the mean times seconds: the lower the better, however many photons (s).
    pub variance_seconds: f64,
}

/// Everything.
#[derive(Clone, Debug, Serialize)]
pub struct Study {
    /// One for each of [`QUANTITIES`]: from a closed form (no error) or a long run by sigma_t (1 / photons where no two
    /// photons differ).
    pub truth: Vec<Estimate>,
    /// Photons of that run.
    pub truth_photons: u64,
    /// What each method found.
    pub methods: Vec<Found>,
    /// Mean lengths of flights by constant steps without end of the medium; none where nothing scatters, or where it is
    /// subdivided.
    pub laws: Vec<Law>,
    /// The same of exponential flights by sigma_t and by sigma_s, each where it is above 0.
    pub free_paths: Vec<FreePath>,
    /// Above this |z| is no chance.
    pub most_z: f64,
}

/// The probability of a false alarm in a whole study.
const SIGNIFICANCE: f64 = 0.01;

/// Runs all methods: constant steps of the lengths `steps` (m), and those without steps.
pub fn study(experiment: &Experiment, steps: &[f64], effort: Effort) -> Study {
    let random = [Method::ByExtinction, Method::ByScattering, Method::Forced];
    let constant = steps.iter().map(|step| Method::Constant(*step));
    let methods: Vec<Method> = random.into_iter().chain(constant).collect();
    let (truth, truth_photons) = truth(experiment, effort);
    let most_z = most_z(methods.len() * QUANTITIES.len());
    let found = |(index, method): (usize, &Method)| {
        let (tally, seconds) = send(experiment, *method, effort.each, effort.seed, index as u64 + 1);
        let reached = effort.each.stop.is_none_or(|stop| stop.is_reached(&tally));
        Found { reached, ..judge(*method, &tally, seconds, &truth, most_z) }
    };
    let methods = methods.iter().enumerate().map(found).collect();
    let only = experiment.cells.only();
    let laws = only.map_or_else(Vec::new, |matter| laws(matter, steps, effort));
    let free_paths = only.map_or_else(Vec::new, |matter| free_paths(matter, effort));
    Study { truth, truth_photons, methods, laws, free_paths, most_z }
}

/// Flights that one measurement of a mean length takes at most.
const MOST_FLIGHTS: u64 = 10_000_000;

fn laws(matter: Matter, steps: &[f64], effort: Effort) -> Vec<Law> {
    let flights = effort.each.photons.min(MOST_FLIGHTS);
    let measure = |(index, step): (usize, &f64)| {
        Law::measure(*step, matter.sigma_s, flights, effort.seed, index as u64)
    };
    steps.iter().enumerate().filter_map(measure).collect()
}

fn free_paths(matter: Matter, effort: Effort) -> Vec<FreePath> {
    let flights = effort.each.photons.min(MOST_FLIGHTS);
    let by = [("RDS_t", matter.sigma_t()), ("RDS_s", matter.sigma_s)];
    let measure =
        |(index, (method, sigma))| FreePath::measure(method, sigma, flights, effort.seed, index as u64);
    by.into_iter().enumerate().filter_map(measure).collect()
}

/// The |z| that one of `tests` exceeds by chance with probability 0.01 (Sidak).
fn most_z(tests: usize) -> f64 {
    let each = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests as f64);
    Normal::standard().inverse_cdf(1.0 - 0.5 * each)
}

/// A long run of flights by sigma_t, and closed forms in place of what has one; and its photons.
fn truth(experiment: &Experiment, effort: Effort) -> (Vec<Estimate>, u64) {
    let (tally, _) = send(experiment, Method::ByExtinction, effort.truth, effort.seed, 0);
    let known = experiment.closed_forms();
    let run = tally.estimates().into_iter().map(|run| run.at_best(tally.photons));
    (run.zip(known).map(|(run, known)| known.map_or(run, Estimate::exact)).collect(), tally.photons)
}

/// Sends photons in; seconds they take.
fn send(experiment: &Experiment, method: Method, run: Run, seed: u64, index: u64) -> (Tally, f64) {
    let started = Instant::now();
    let mut tally = Tally::default();
    let walker = walk::Walker::new(experiment, method);
    for photon in 0..run.photons {
        tally.add(&walker.walk(seed, index, photon));
        if run.stop.is_some_and(|stop| stop.ends(&tally)) {
            break;
        }
    }
    (tally, started.elapsed().as_secs_f64())
}

fn judge(method: Method, tally: &Tally, seconds: f64, truth: &[Estimate], most_z: f64) -> Found {
    let judged = |((quantity, estimate), truth): ((&&'static str, Estimate), &Estimate)| Judged {
        quantity,
        estimate,
        bias: estimate.mean - truth.mean,
        z: estimate.at_best(tally.photons).z(truth),
        variance_seconds: estimate.standard_error.powi(2) * seconds,
    };
    let estimates: Vec<Judged> = QUANTITIES.iter().zip(tally.estimates()).zip(truth).map(judged).collect();
    let largest_z = estimates.iter().map(|judged| judged.z.abs()).fold(0.0, f64::max);
    let (method, photons) = (method.name(), tally.photons);
    Found { method, photons, reached: true, seconds, estimates, largest_z, agrees: largest_z <= most_z }
}
