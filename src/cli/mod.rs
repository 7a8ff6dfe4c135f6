//! The command line: arguments in, exit code out.

pub mod arguments;
mod candidates;
mod console;
mod contenders;
mod convert;
mod denoise;
mod depth;
pub mod diff;
mod display;
mod estimator;
mod explain;
mod fit;
pub mod flights;
mod guide;
mod heading;
mod info;
mod interrupt;
mod manual;
mod media;
pub mod merge;
mod new;
mod outputs;
mod overview;
mod parsers;
pub mod phase;
mod picture;
mod pixel;
mod plan;
mod progress;
mod provenance;
mod python;
mod render;
mod report;
mod scene;
mod strategies;
mod study;
mod view;
mod volumes;

use crate::error::Result;
use arguments::{Arguments, Command};
use clap::Parser;
use console::{complain, heard, note};
use std::process::ExitCode;

/// Runs the program; bad input ends it with code 2 and a message that says what to mend. So does a standard output that
/// takes no more, once all files are written; a closed pipe, whose reader has read enough, changes nothing.
pub fn run() -> ExitCode {
    match Arguments::try_parse() {
        Ok(arguments) => {
            let json = arguments.command.answer().is_some_and(|answer| answer.json);
            console::set(arguments.quiet, json, arguments.progress);
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
        Command::View(view) => view::run(view),
        Command::Merge(merge) => merge::run(merge),
        Command::Strategies(strategies) => strategies::run(strategies),
        Command::Guide(guide) => guide::run(guide),
        Command::Pixel(pixel) => pixel::run(pixel),
        Command::Info(info) => info::run(info),
        Command::Convert(convert) => convert::run(convert),
        Command::New(new) => new::run(new),
        Command::Denoise(denoise) => denoise::run(denoise),
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
