//! `tyndall flights`: ways of sampling flights, one against the other.

use super::{outputs::check_short, say, voice::Answer};
use crate::{
    analysis::{
        flights::{
            self, Effort, Experiment, Found, Study, drawing,
            law::{FreePath, Law},
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

    /// Absorption [1/m]
    #[arg(long, value_name = "X", value_parser = coefficient, allow_negative_numbers = true)]
    pub sigma_a: f64,

    /// Scattering [1/m]
    #[arg(long, value_name = "X", value_parser = coefficient, allow_negative_numbers = true)]
    pub sigma_s: f64,

    /// Shape of the medium
    #[arg(long, value_enum, value_name = "NAME", default_value_t = Shape::Slab)]
    pub shape: Shape,

    /// Thickness of the slab, or side length of the cube [m]
    #[arg(long, value_name = "X", default_value_t = 1.0, value_parser = length, allow_negative_numbers = true)]
    pub size: f64,

    /// Angle between the light and the normal of the face it enters [degrees]
    #[arg(long, value_name = "X", default_value_t = 0.0, value_parser = angle, allow_negative_numbers = true)]
    pub angle: f64,

    /// Lengths of constant steps [m], separated by commas [default: 1, 1/2, 1/4 and 1/8 of the mean free path]
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1, value_parser = length, allow_negative_numbers = true)]
    pub steps: Vec<f64>,

    /// Number of photons for each method
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(2..=1_000_000_000_000))]
    pub photons: u64,

    /// Number of photons of the reference, sampled with sigma_t [default: four times that of each method]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..=1_000_000_000_000))]
    pub truth_photons: Option<u64>,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", default_value_t = 0)]
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
    if arguments.svg.is_some() && !steps.iter().any(|step| Law::is_measurable(*step, experiment.sigma_s)) {
        let remedy = "increase --sigma-s, or use longer --steps";
        return Err(Error::new("--svg", "free flights that end in a scattering event", "none", remedy));
    }
    check_short([&arguments.svg, &arguments.answer.report].into_iter().flatten(), &[])?;
    let truth_photons = arguments.truth_photons.unwrap_or(4 * arguments.photons);
    let effort = Effort { photons: arguments.photons, truth_photons, seed: arguments.seed };
    let study = flights::study(&experiment, &steps, effort);
    say(&describe(arguments, &study, truth_photons));
    if let Some(path) = &arguments.svg {
        let drawing = drawing::svg(&study.laws, experiment.sigma_s)?;
        output::write(path, |file| file.write_all(drawing.as_bytes()))?;
    }
    arguments.answer.give(&figures(arguments, &study, truth_photons))?;
    let is_random = |found: &&Found| !found.method.starts_with("CDS");
    Ok(study.methods.iter().filter(is_random).all(|found| found.agrees))
}

fn experiment(arguments: &Flights) -> Result<Experiment> {
    let phase = described::build(&arguments.phase, &arguments.parameters)?;
    let Flights { sigma_a, sigma_s, size, .. } = *arguments;
    if sigma_a + sigma_s == 0.0 {
        let remedy = "set one of them to a value above 0";
        return Err(Error::new("--sigma-a and --sigma-s", "matter", "none: both are 0", remedy));
    }
    let shape = match arguments.shape {
        Shape::Slab => flights::Shape::Slab,
        Shape::Cube => flights::Shape::Cube,
    };
    Ok(Experiment { shape, size, sigma_a, sigma_s, phase, angle: arguments.angle.to_radians() })
}

/// Maximum number of steps of a photon from face to face.
const MOST_STEPS: f64 = 1e6;

fn steps(arguments: &Flights, experiment: &Experiment) -> Result<Vec<f64>> {
    let mean_free_path = 1.0 / (experiment.sigma_a + experiment.sigma_s);
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

fn describe(arguments: &Flights, study: &Study, truth_photons: u64) -> String {
    let Flights { sigma_a, sigma_s, size, angle, photons, .. } = arguments;
    let form = match arguments.shape {
        Shape::Slab => "slab",
        Shape::Cube => "cube",
    };
    let phase = std::iter::once(&arguments.phase).chain(&arguments.parameters).cloned().collect::<Vec<_>>();
    let mut lines = vec![
        format!(
            "{form} of {size} m, sigma_a {sigma_a}, sigma_s {sigma_s} /m, {}, light at {angle} degrees, {photons} photons each",
            phase.join(" ")
        ),
        "shares of the power, each with its standard error; scattered: through all faces; unscattered: through the far one".into(),
        format!(
            "truth: unscattered light in closed form, the rest from {truth_photons} photons sampled with sigma_t; |z| above {:.2} is significant",
            study.most_z
        ),
        String::new(),
        heading(),
        row("truth", COLUMNS.iter().map(|(_, q)| (study.truth[*q].mean, study.truth[*q].standard_error)), ""),
    ];
    lines.extend(study.methods.iter().map(method));
    lines.push(String::new());
    lines.push("mean free flights in an unbounded medium".into());
    lines.extend(study.free_paths.iter().map(free_path));
    lines.extend(study.laws.iter().map(law));
    lines.join("\n").trim_end().to_owned()
}

fn heading() -> String {
    let titles: String = COLUMNS.iter().map(|(title, _)| format!("{title:>19}")).collect();
    format!("{:<12}{titles}{:>8}{:>9}{:>12}  verdict", "method", "max |z|", "seconds", "var x s")
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
    let rest = format!("{:>8.2}{:>9.3}{cost:>12.2e}  {verdict}", found.largest_z, found.seconds);
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

fn figures(arguments: &Flights, study: &Study, truth_photons: u64) -> serde_json::Value {
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
        "sigma_a": arguments.sigma_a,
        "sigma_s": arguments.sigma_s,
        "seed": arguments.seed,
        "truth_photons": truth_photons,
        "truth": truth,
        "most_z": study.most_z,
        "methods": study.methods,
        "mean_flights": study.laws,
        "mean_free_paths": study.free_paths,
    })
}
