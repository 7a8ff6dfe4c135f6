//! The command line: arguments in, exit code out.

pub mod arguments;
mod candidates;
mod clip;
mod contenders;
mod convert;
pub mod diff;
mod display;
mod estimator;
mod explain;
pub mod flights;
mod goal;
mod guide;
mod info;
mod interrupt;
mod keeper;
mod made;
mod manual;
mod media;
pub mod merge;
mod outputs;
pub mod phase;
mod picture;
mod pixel;
mod plan;
mod precision;
mod preview;
mod progress;
mod progressive;
mod render;
mod report;
mod strategies;
mod study;
mod viewer;
mod voice;
mod volumes;

use crate::{
    description::Object,
    error::{Error, Result},
    scene::{self, build::Setup},
    settings::Overrides,
};
use arguments::{Arguments, Command};
use clap::Parser;
use std::{num::NonZeroUsize, process::ExitCode};
use voice::{complain, heard, note, say};

/// Runs the program; bad input ends it with code 2 and a message that says what to mend. So does a standard output that
/// takes no more, once all files are written; a closed pipe, whose reader has read enough, changes nothing.
pub fn run() -> ExitCode {
    match Arguments::try_parse() {
        Ok(arguments) => {
            let json = arguments.command.answer().is_some_and(|answer| answer.json);
            voice::set(arguments.quiet, json, arguments.progress);
            judged(obey(&arguments.command).and_then(|holds| heard().map(|()| holds)))
        }
        // Help, the version, or what is wrong with the arguments.
        Err(answer) => {
            note(answer.print());
            let code = u8::try_from(answer.exit_code()).unwrap_or(2);
            heard().map_or_else(|error| judged(Err(error)), |()| ExitCode::from(code))
        }
    }
}

/// True if what the command judges holds.
fn obey(command: &Command) -> Result<bool> {
    let outcome = match command {
        Command::Render(render) => render::run(render),
        Command::Merge(merge) => merge::run(merge),
        Command::Strategies(strategies) => strategies::run(strategies),
        Command::Guide(guide) => guide::run(guide),
        Command::Pixel(pixel) => pixel::run(pixel),
        Command::Info(info) => info::run(info),
        Command::Convert(convert) => convert::run(convert),
        Command::Report(report) => report::run(report),
        Command::Study(study) => study::run(study),
        Command::Explain(explain) => explain::run(explain),
        Command::Completions(completions) => manual::complete(completions),
        Command::Man(man) => manual::run(man),
        Command::Diff(diff) => return diff::run(diff),
        Command::Phase(phase) => return phase::run(phase),
        Command::Flights(flights) => return flights::run(flights),
    };
    outcome.map(|()| true)
}

/// 0 if the claim holds, 1 if it does not, 2 on an error, which is printed; what shells expect of a signal that ended a
/// render.
fn judged(outcome: Result<bool>) -> ExitCode {
    match outcome {
        Ok(true) => interrupt::signal().map_or(ExitCode::SUCCESS, |(_, code)| ExitCode::from(code)),
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            complain(&format!("error: {error}"));
            ExitCode::from(2)
        }
    }
}

/// Reads and builds a scene; warnings go to standard error.
fn load(scene: &arguments::Scene, overrides: Overrides) -> Result<Setup> {
    let overrides = Overrides { strict: scene.strict, ..overrides };
    built(&scene.read()?, overrides)
}

/// Builds what was read; warnings go to standard error.
fn built(root: &Object, overrides: Overrides) -> Result<Setup> {
    let setup = scene::build::build(root, overrides)?;
    for warning in &setup.warnings {
        complain(&format!("warning: {warning}"));
    }
    media::warn_of_idle(&overrides, &setup);
    Ok(setup)
}

/// The threads that render.
fn threads(wanted: Option<NonZeroUsize>) -> Result<rayon::ThreadPool> {
    let threads = wanted.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Error::new("--threads", "a number of threads this machine can start", error.to_string(), "use fewer")
    })
}
