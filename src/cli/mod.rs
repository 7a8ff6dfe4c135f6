//! The command line: arguments in, exit code out.

pub mod arguments;
mod contenders;
mod convert;
pub mod diff;
mod estimator;
pub mod flights;
mod info;
mod interrupt;
mod keeper;
mod made;
pub mod merge;
mod outputs;
pub mod phase;
mod pixel;
mod render;
mod report;
mod strategies;
mod study;

use crate::{
    error::{Error, Result},
    format,
    medium::DistanceMethod,
    scene::{self, build::Setup},
    settings::Overrides,
};
use arguments::{Arguments, Command};
use clap::Parser;
use std::{
    io::{self, ErrorKind, Write as _},
    num::NonZeroUsize,
    process::ExitCode,
    sync::{
        OnceLock,
        atomic::{AtomicBool, Ordering},
    },
};

/// Runs the program; bad input ends it with code 2 and a message that says what to mend. So does a standard output that
/// takes no more, once all files are written; a closed pipe, whose reader has read enough, changes nothing.
pub fn run() -> ExitCode {
    match Arguments::try_parse() {
        Ok(arguments) => judged(obey(&arguments.command).and_then(|holds| heard().map(|()| holds))),
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
        Command::Pixel(pixel) => pixel::run(pixel),
        Command::Info(info) => info::run(info),
        Command::Convert(convert) => convert::run(convert),
        Command::Report(report) => report::run(report),
        Command::Study(study) => study::run(study),
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
fn load(
    scene: &arguments::Scene,
    size: Option<arguments::Size>,
    tracker: Option<DistanceMethod>,
) -> Result<Setup> {
    let root = format::read(&scene.file, &scene.definitions)?;
    let overrides = Overrides { size: size.map(|size| (size.width, size.height)), tracker };
    let setup = scene::build::build(&root, overrides)?;
    for warning in &setup.warnings {
        complain(&format!("warning: {warning}"));
    }
    if tracker.is_some() && setup.scene.media.iter().all(|medium| medium.heterogeneous().is_none()) {
        complain("warning: --tracker has no effect: this scene has no heterogeneous medium");
    }
    Ok(setup)
}

/// The threads that render.
fn threads(wanted: Option<NonZeroUsize>) -> Result<rayon::ThreadPool> {
    let threads = wanted.map_or(0, usize::from);
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        Error::new("--threads", "a number of threads this machine can start", error.to_string(), "use fewer")
    })
}

/// To standard output, unless a file is written there. Work goes on where that fails, so that nothing is lost; [`heard`]
/// tells in the end.
fn say(text: &str) {
    if STDOUT_IS_TAKEN.load(Ordering::Relaxed) {
        return complain(text);
    }
    note(writeln!(io::stdout(), "{text}").and_then(|()| io::stdout().flush()));
}

/// One of the outputs is standard output.
static STDOUT_IS_TAKEN: AtomicBool = AtomicBool::new(false);

/// Why standard output took no more.
static UNHEARD: OnceLock<io::Error> = OnceLock::new();

fn note(said: io::Result<()>) {
    if let Err(error) = said {
        let _ = UNHEARD.set(error);
    }
}

/// An error unless all that was said was written, or nobody reads any more.
fn heard() -> Result<()> {
    match UNHEARD.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => {
            let remedy = "send it to another place; the files of this command are as they should be";
            Err(Error::new("standard output", "to write what is reported", error.to_string(), remedy))
        }
        _ => Ok(()),
    }
}

/// To standard error.
fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}
