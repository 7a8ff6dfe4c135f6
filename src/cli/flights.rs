//! `tyndall flights`: ways of sampling flights, one against the other.

use super::{
    console::{Answer, say},
    outputs::check_short,
    parsers::seed,
};
use crate::{
    analysis::{
        flights::{
            self, Effort, Experiment, Found, Run, Study,
            cells::{Cells, Matter},
            drawing,
            law::{FreePath, Law},
            stop::Stop,
            tally::{ABSORBED, DIRECT, Estimate, QUANTITIES, REFLECTED, SCATTERED, SCATTERINGS, TRANSMITTED},
        },
        phase::described,
    },
    error::{Error, Result},
    film::output,
};
use clap::{Args, ValueEnum};
use serde_json::json;
use std::path::PathBuf;

/// Compare methods of free-flight sampling.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Flights {
    /// Phase function of the medium, as for `tyndall phase`
    #[arg(value_name = "PHASE", default_value = "isotropic")]
    pub phase: String,

    /// Its parameters
    #[arg(value_name = "name=value")]
    pub parameters: Vec<String>,

    /// Absorption (1/m); of a subdivided medium one for each cell, separated by commas: x first, then y, then depth
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',', num_args = 1, value_parser = coefficient, allow_negative_numbers = true)]
    pub sigma_a: Vec<f64>,

    /// Scattering (1/m), in the same way; one number is that of all cells
    #[arg(long, value_name = "LIST", required = true, value_delimiter = ',', num_args = 1, value_parser = coefficient, allow_negative_numbers = true)]
    pub sigma_s: Vec<f64>,

    /// Number of equal cells of a subdivided medium along x, y and depth [default: as many layers as coefficients]
    #[arg(long, value_name = "XxYxZ", value_parser = cells)]
    pub cells: Option<[usize; 3]>,

    /// Shape of the medium
    #[arg(long, value_enum, value_name = "NAME", default_value_t = Shape::Slab)]
    pub shape: Shape,

    /// Thickness of the slab, or side length of the cube (m)
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = length, allow_negative_numbers = true)]
    pub size: f64,

    /// Angle between the light and the normal of the face it enters (degrees)
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = angle, allow_negative_numbers = true)]
    pub angle: f64,

    /// Lengths of constant steps (m), separated by commas [default: 1, 1/2, 1/4 and 1/8 of the mean free path]
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1, value_parser = length, allow_negative_numbers = true)]
    pub steps: Vec<f64>,

    /// Number of photons for each method; with --relative-error, the most [default: 100000, with --relative-error
    /// 100000000]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=1_000_000_000_000))]
    pub photons: Option<u64>,

    /// Send photons until the scattered light, through all faces, is known within this relative error
    ///
    /// It is estimated from the photons themselves, every thousand of them.
    #[arg(long, value_name = "X", value_parser = share)]
    pub relative_error: Option<f64>,

    /// Probability that the error is below --relative-error when a method stops
    #[arg(long, value_name = "P", requires = "relative_error", default_value_t = 0.95, value_parser = share)]
    pub confidence: f64,

    /// Number of photons of the reference, sampled with sigma_t [default: four times that of each method, or as many as
    /// half of --relative-error takes]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=1_000_000_000_000))]
    pub truth_photons: Option<u64>,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// How the comparison is given.
    #[command(flatten)]
    pub answer: Answer,

    /// Also plot the mean distance of constant steps against the predicted mean, to this SVG file
    #[arg(long, value_name = "FILE")]
    pub svg: Option<PathBuf>,
}

/// Shape of the medium.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
pub enum Shape {
    /// Between two parallel planes, infinite to the sides
    Slab,
    /// A cube; light enters at the centre of a face
    Cube,
}

fn coefficient(text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|x| (0.0..=1e6).contains(x));
    value.ok_or_else(|| "expected a number from 0 to 1e6, such as 0.5".into())
}

fn cells(text: &str) -> std::result::Result<[usize; 3], String> {
    let counts: Option<Vec<usize>> =
        text.split('x').map(|n| n.parse().ok().filter(|n| (1..=100).contains(n))).collect();
    let counts = counts.and_then(|counts| <[usize; 3]>::try_from(counts).ok());
    counts.ok_or_else(|| "expected three numbers from 1 to 100, such as 2x2x4".into())
}

fn share(text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|x: &f64| *x > 0.0 && *x < 1.0);
    value.ok_or_else(|| "expected a number between 0 and 1, such as 0.01".into())
}

fn length(text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|x| (1e-6..=1e6).contains(x));
    value.ok_or_else(|| "expected a length from 1e-6 to 1e6, such as 0.1".into())
}

fn angle(text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|x| (0.0..=89.9).contains(x));
    value.ok_or_else(|| "expected degrees from 0 to 89.9".into())
}

/// Runs the command; true if all methods agree with the truth that theory says are unbiased.
pub fn run(arguments: &Flights) -> Result<bool> {
    let experiment = experiment(arguments)?;
    let steps = steps(arguments, &experiment)?;
    let drawn = drawn(arguments, &experiment, &steps)?;
    check_short([&arguments.svg, &arguments.answer.report].into_iter().flatten())?;
    let study = flights::study(&experiment, &steps, effort(arguments));
    say(&describe(arguments, &experiment, &study));
    if let Some((path, sigma_s)) = drawn {
        let drawing = drawing::svg(&study.laws, sigma_s)?;
        output::write(path, |file| file.write_all(drawing.as_bytes()))?;
    }
    arguments.answer.give(&figures(arguments, &experiment, &study))?;
    let is_random = |found: &&Found| !found.method.starts_with("CDS");
    Ok(study.methods.iter().filter(is_random).all(|found| found.agrees))
}

/// The file of mean free flights, and the scattering that they are of.
fn drawn<'a>(
    arguments: &'a Flights,
    experiment: &Experiment,
    steps: &[f64],
) -> Result<Option<(&'a PathBuf, f64)>> {
    let Some(path) = &arguments.svg else { return Ok(None) };
    let Some(Matter { sigma_s, .. }) = experiment.cells.only() else {
        let remedy = "leave it out, or give one --sigma-a and one --sigma-s";
        return Err(Error::new("--svg", "free flights in one medium", "a subdivided one", remedy));
    };
    if !steps.iter().any(|step| Law::is_measurable(*step, sigma_s)) {
        let remedy = "increase --sigma-s, or use longer --steps";
        return Err(Error::new("--svg", "free flights that end in a scattering event", "none", remedy));
    }
    Ok(Some((path, sigma_s)))
}

/// Photons of a method where neither a number nor an error is given, and at most where an error is.
const PHOTONS: u64 = 100_000;
const MOST_PHOTONS: u64 = 100_000_000;

fn effort(arguments: &Flights) -> Effort {
    let Flights { photons, truth_photons, seed, .. } = *arguments;
    let stop = arguments.relative_error.map(|error| Stop::new(error, arguments.confidence));
    let photons = photons.unwrap_or(if stop.is_some() { MOST_PHOTONS } else { PHOTONS });
    let truth = match truth_photons {
        Some(photons) => Run { photons, stop: None },
        None => Run { photons: 4 * photons, stop: stop.map(Stop::halved) },
    };
    Effort { each: Run { photons, stop }, truth, seed }
}

/// What is in each cell.
fn media(arguments: &Flights) -> Result<Cells> {
    let Flights { sigma_a, sigma_s, .. } = arguments;
    let counts = arguments.cells.unwrap_or([1, 1, sigma_a.len().max(sigma_s.len())]);
    let all: usize = counts.iter().product();
    let each = |option: &str, list: &[f64]| match list {
        [one] => Ok(vec![*one; all]),
        list if list.len() == all => Ok(list.to_vec()),
        list => {
            let expected = format!("one number, or one for each of the {all} cells");
            let remedy = "give one or as many, or change --cells";
            Err(Error::new(option, expected, format!("{} numbers", list.len()), remedy))
        }
    };
    let (sigma_a, sigma_s) = (each("--sigma-a", sigma_a)?, each("--sigma-s", sigma_s)?);
    let matter = sigma_a.into_iter().zip(sigma_s).map(|(sigma_a, sigma_s)| Matter { sigma_a, sigma_s });
    Ok(Cells::new(counts, matter.collect()))
}

fn experiment(arguments: &Flights) -> Result<Experiment> {
    let phase = described::build(&arguments.phase, &arguments.parameters)?;
    let cells = media(arguments)?;
    if cells.mean_extinction() == 0.0 {
        let remedy = "set one of them to a value above 0";
        return Err(Error::new("--sigma-a and --sigma-s", "matter", "none: both are 0", remedy));
    }
    if let ([x, y, _], Shape::Slab) = (cells.counts(), arguments.shape)
        && x * y > 1
    {
        let remedy = "use --shape cube";
        return Err(Error::new(
            "--cells",
            "1x1xZ: a slab has no ends along x and y",
            format!("{x}x{y}"),
            remedy,
        ));
    }
    let shape = match arguments.shape {
        Shape::Slab => flights::Shape::Slab,
        Shape::Cube => flights::Shape::Cube,
    };
    Ok(Experiment { shape, size: arguments.size, cells, phase, angle: arguments.angle.to_radians() })
}

/// Maximum number of steps of a photon from face to face.
const MOST_STEPS: f64 = 1e6;

fn steps(arguments: &Flights, experiment: &Experiment) -> Result<Vec<f64>> {
    let mean_free_path = 1.0 / experiment.cells.mean_extinction();
    let requested = match arguments.steps.is_empty() {
        true => [1.0, 0.5, 0.25, 0.125].map(|part| part * mean_free_path).to_vec(),
        false => arguments.steps.clone(),
    };
    match requested.iter().find(|step| experiment.size > MOST_STEPS * **step) {
        None => Ok(requested),
        Some(step) => {
            let expected =
                format!("steps of at least {} m, a millionth of the size", experiment.size / MOST_STEPS);
            Err(Error::new("--steps", expected, step.to_string(), "use longer --steps"))
        }
    }
}

/// What the table shows, with its titles.
const COLUMNS: &[(&str, usize)] = &[
    ("reflected", REFLECTED),
    ("transmitted", TRANSMITTED),
    ("scattered", SCATTERED),
    ("unscattered", DIRECT),
    ("absorbed", ABSORBED),
    ("scatterings", SCATTERINGS),
];

fn describe(arguments: &Flights, experiment: &Experiment, study: &Study) -> String {
    let Flights { size, angle, .. } = arguments;
    let form = match arguments.shape {
        Shape::Slab => "slab",
        Shape::Cube => "cube",
    };
    let phase = std::iter::once(&arguments.phase).chain(&arguments.parameters).cloned().collect::<Vec<_>>();
    let mut lines = vec![
        format!(
            "{form} of {size} m, {}, {}, light at {angle} degrees, {}",
            matter(arguments, experiment),
            phase.join(" "),
            amount(arguments)
        ),
        "shares of the power, each with its standard error; scattered: through all faces; unscattered: through the far one".into(),
        format!(
            "truth: unscattered light in closed form, the rest from {} photons sampled with sigma_t; |z| above {:.2} is significant",
            study.truth_photons, study.most_z
        ),
        String::new(),
        heading(),
        row("truth", COLUMNS.iter().map(|(_, q)| (study.truth[*q].mean, study.truth[*q].standard_error)), ""),
    ];
    lines.extend(study.methods.iter().map(method));
    lines.extend(study.methods.iter().filter(|found| !found.reached).map(unreached));
    if experiment.cells.only().is_some() {
        lines.push(String::new());
        lines.push("mean free flights in an unbounded medium".into());
        lines.extend(study.free_paths.iter().map(free_path));
        lines.extend(study.laws.iter().map(law));
    }
    lines.join("\n").trim_end().to_owned()
}

/// The coefficients, and of what they are.
fn matter(arguments: &Flights, experiment: &Experiment) -> String {
    let list = |list: &[f64]| list.iter().map(f64::to_string).collect::<Vec<_>>().join(",");
    let (a, s) = (list(&arguments.sigma_a), list(&arguments.sigma_s));
    let cells = match experiment.cells.counts() {
        [1, 1, 1] => String::new(),
        [x, y, z] => format!(" in {x}x{y}x{z} cells"),
    };
    format!("sigma_a {a}, sigma_s {s} /m{cells}")
}

fn amount(arguments: &Flights) -> String {
    match arguments.relative_error {
        None => format!("{} photons each", effort(arguments).each.photons),
        Some(error) => format!(
            "photons until scattered light is known within {} % with a confidence of {} %",
            rounded(100.0 * error),
            rounded(100.0 * arguments.confidence)
        ),
    }
}

/// Without the digits that are rounding.
fn rounded(percent: f64) -> f64 {
    (percent * 1e9).round() / 1e9
}

fn unreached(found: &Found) -> String {
    format!("{} is less certain than that after {} photons: increase --photons", found.method, found.photons)
}

fn heading() -> String {
    let titles: String = COLUMNS.iter().map(|(title, _)| format!("{title:>19}")).collect();
    format!(
        "{:<12}{titles}{:>8}{:>11}{:>9}{:>12}  verdict",
        "method", "max |z|", "photons", "seconds", "var x s"
    )
}

fn row(title: &str, cells: impl Iterator<Item = (f64, f64)>, rest: &str) -> String {
    let cells: String = cells
        .map(|(mean, error)| format!("{mean:>10.5} +-{error:.0e}"))
        .map(|c| format!("{c:>19}"))
        .collect();
    format!("{title:<12}{cells}{rest}")
}

fn method(found: &Found) -> String {
    let cells = COLUMNS.iter().map(|(_, q)| {
        let estimate = found.estimates[*q].estimate;
        (estimate.mean, estimate.standard_error)
    });
    let verdict = if found.agrees { "agrees" } else { "is biased" };
    let cost = found.estimates[SCATTERED].variance_seconds;
    let Found { largest_z, photons, seconds, .. } = found;
    let rest = format!("{largest_z:>8.2}{photons:>11}{seconds:>9.3}{cost:>12.2e}  {verdict}");
    row(&found.method, cells, &rest)
}

fn free_path(path: &FreePath) -> String {
    let FreePath { method, measured, expected, z } = path;
    let Estimate { mean, standard_error } = measured;
    format!(
        "{method:<15} measured {mean:.6} +- {standard_error:.1e} m, mean free path {expected:.6} (z {z:+.2})"
    )
}

fn law(law: &Law) -> String {
    format!(
        "step {:<10.4} measured {:.6} +- {:.1e} m, law {:.6} (z {:+.2}), {:+.3} % off that of RDS_s (z {:+.1})",
        law.step,
        law.measured.mean,
        law.measured.standard_error,
        law.expected,
        law.z,
        100.0 * law.error / (law.expected - law.error),
        law.z_of_mean_free_path
    )
}

/// One number as a number, several as a list.
fn numbers(list: &[f64]) -> serde_json::Value {
    if let [one] = list { json!(one) } else { json!(list) }
}

fn figures(arguments: &Flights, experiment: &Experiment, study: &Study) -> serde_json::Value {
    let truth: Vec<_> = QUANTITIES
        .iter()
        .zip(&study.truth)
        .map(|(quantity, estimate)| {
            json!({ "quantity": quantity, "mean": estimate.mean, "standard_error": estimate.standard_error })
        })
        .collect();
    json!({
        "phase": arguments.phase,
        "parameters": arguments.parameters,
        "shape": format!("{:?}", arguments.shape).to_lowercase(),
        "size": arguments.size,
        "angle": arguments.angle,
        "sigma_a": numbers(&arguments.sigma_a),
        "sigma_s": numbers(&arguments.sigma_s),
        "cells": experiment.cells.counts(),
        "relative_error": arguments.relative_error,
        "confidence": arguments.relative_error.map(|_| arguments.confidence),
        "seed": arguments.seed,
        "truth_photons": study.truth_photons,
        "truth": truth,
        "most_z": study.most_z,
        "methods": study.methods,
        "mean_flights": study.laws,
        "mean_free_paths": study.free_paths,
    })
}
