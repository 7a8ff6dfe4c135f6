//! `tyndall phase`: a phase function by itself.

use super::{
    console::{self, Answer, say},
    explain,
    outputs::check_short,
    parsers::seed,
};
use crate::{
    analysis::phase::{self, Check, Division, described, drawing, mesh::Mesh},
    error::Result,
    film::output,
    phase::Phase as Model,
};
use clap::Args;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Test and draw a phase function.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Phase {
    /// Plugin name of the phase function, such as hg
    #[arg(value_name = "NAME", required_unless_present = "list")]
    pub name: Option<String>,

    /// Parameters: numbers, text (values=0.5,1,3), or @FILE for the contents of a file
    ///
    /// A value that is the name of a phase function creates a nested one; prefix the parameters of that one with
    /// its name: blendphase weight=0.3 a=hg a.g=0.9 b=isotropic
    #[arg(value_name = "name=value")]
    pub parameters: Vec<String>,

    /// List all phase functions: formulas with their sources, and parameters
    #[arg(long, exclusive = true)]
    pub list: bool,

    /// Number of directions to sample
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(2..=1_000_000_000_000))]
    pub samples: u64,

    /// Seed of all random numbers
    #[arg(long, value_name = "N", value_parser = seed, default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// Number of parallels that divide the sphere, both poles included; closer together near the poles
    #[arg(long, value_name = "P", default_value_t = 65, value_parser = clap::value_parser!(u16).range(3..=1025))]
    pub parallels: u16,

    /// Number of meridians that divide the sphere
    #[arg(long, value_name = "M", default_value_t = 32, value_parser = clap::value_parser!(u16).range(3..=1024))]
    pub meridians: u16,

    /// Significance: the p-value below which the test fails
    #[arg(long, value_name = "P", default_value_t = 1e-3, value_parser = significance)]
    pub significance: f64,

    /// Also draw: NAME.svg, a polar plot, NAME.ply, a mesh of the pdf, and NAME_samples.ply, one of the sampled flux,
    /// to this folder, created if missing
    #[arg(short, long, value_name = "FOLDER")]
    pub output: Option<PathBuf>,

    /// How the test is given.
    #[command(flatten)]
    pub answer: Answer,
}

fn significance(text: &str) -> std::result::Result<f64, String> {
    let value = text.parse().ok().filter(|p: &f64| *p > 0.0 && *p < 1.0);
    value.ok_or_else(|| "expected a number between 0 and 1, such as 0.001".into())
}

/// Runs the command; true if the samples are as the density says.
pub fn run(arguments: &Phase) -> Result<bool> {
    let Some(name) = &arguments.name else {
        console::print(explain::listing("phase").trim_end());
        return Ok(true);
    };
    let phase = described::build(name, &arguments.parameters)?;
    let drawings = arguments.output.as_ref().map(|folder| Drawings::new(folder, name)).transpose()?;
    check_short(drawings.iter().flat_map(Drawings::files).chain(&arguments.answer.report))?;
    let division = Division { parallels: arguments.parallels.into(), meridians: arguments.meridians.into() };
    let check = phase::check(&phase, &phase, division, arguments.samples, arguments.seed);
    let failures = check.failures(arguments.significance);
    say(&describe(arguments, &check, &failures));
    if let Some(drawings) = drawings {
        let title = std::iter::once(name).chain(&arguments.parameters).cloned().collect::<Vec<_>>();
        drawings.write(&title.join(" "), &phase, &check, division)?;
    }
    arguments.answer.give(&figures(arguments, &check, &failures))?;
    Ok(failures.is_empty())
}

/// The files that are drawn.
struct Drawings {
    polar: PathBuf,
    density: PathBuf,
    samples: PathBuf,
}

impl Drawings {
    fn new(folder: &Path, name: &str) -> Result<Self> {
        output::create_folder(folder)?;
        let file = |end: &str| folder.join(format!("{name}{end}"));
        Ok(Self { polar: file(".svg"), density: file(".ply"), samples: file("_samples.ply") })
    }

    fn files(&self) -> [&PathBuf; 3] {
        [&self.polar, &self.density, &self.samples]
    }

    fn write(&self, title: &str, phase: &Model, check: &Check, division: Division) -> Result<()> {
        let polar = drawing::svg(title, phase, check)?;
        output::write(&self.polar, |file| file.write_all(polar.as_bytes()))?;
        output::write(&self.density, |mut file| Mesh::of_density(phase, division).write(&mut file))?;
        let samples = Mesh::of_samples(&check.cells, division);
        output::write(&self.samples, |mut file| samples.write(&mut file))?;
        say(&self.files().map(|file| file.display().to_string()).join(", "));
        Ok(())
    }
}

fn figures(arguments: &Phase, check: &Check, failures: &[&str]) -> Value {
    json!({
        "phase": arguments.name,
        "parameters": arguments.parameters,
        "samples": arguments.samples,
        "seed": arguments.seed,
        "parallels": arguments.parallels,
        "meridians": arguments.meridians,
        "significance": arguments.significance,
        "normalisation": check.normalisation,
        "mean_cosine": check.mean_cosine,
        "stated_mean_cosine": check.stated_mean_cosine,
        "sampled_mean_cosine": check.sampled_mean_cosine,
        "standard_error": check.standard_error,
        "z": check.z(),
        "chi_square": check.fit,
        "failures": failures,
        "holds": failures.is_empty(),
    })
}

fn describe(arguments: &Phase, check: &Check, failures: &[&str]) -> String {
    let fit = &check.fit;
    let verdict = match failures {
        [] => "the samples are distributed according to the pdf".to_owned(),
        some => format!("FAILS: {}", some.join("; ")),
    };
    [
        format!("normalisation      {:.6} (integral of the pdf over the sphere)", check.normalisation),
        format!(
            "mean cosine        {:.6} of the pdf, {:.6} stated by the phase function",
            check.mean_cosine, check.stated_mean_cosine
        ),
        format!(
            "                   {:.6} +- {:.6} of {} samples, a deviation of {:+.2} standard errors",
            check.sampled_mean_cosine, check.standard_error, arguments.samples, check.z()
        ),
        format!(
            "chi-square         {:.1} with {} degrees of freedom ({} parallels x {} meridians, cells of fewer than 5 pooled)",
            fit.statistic, fit.freedom, arguments.parallels, arguments.meridians
        ),
        format!("p-value            {:.4}", fit.p_value),
        format!("verdict            {verdict}"),
    ]
    .join("\n")
}
