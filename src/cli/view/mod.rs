//! `tyndall view`: a page on this machine, where a scene is looked at while it is written.

mod board;
mod camera;
mod loaded;
mod painter;
mod server;
mod watch;

use super::{
    console::print,
    display::Display,
    estimator::Estimator,
    heading, interrupt,
    parsers::{Size, size, threads as threads_of},
    render::preview::Preview,
    scene::{Scene, threads},
};
use crate::{error::Result, format, settings::Overrides};
use board::Board;
use clap::Args;
use painter::Painter;
use server::Server;
use std::{num::NonZeroUsize, sync::Arc, thread};
use watch::Watch;

/// Look at a scene in a browser.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Arguments {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Port of the page, on the loopback address [default: one that is free]
    #[arg(long, value_name = "PORT", value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub port: Option<u16>,

    /// Size of the image in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, alias = "resolution", value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads_of, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// How pictures are shown at first.
    #[command(flatten, next_help_heading = heading::LOOK)]
    pub display: Display,

    /// How pictures look while the camera moves.
    #[command(flatten, next_help_heading = heading::LOOK)]
    pub fog: Preview,

    /// How paths are sampled.
    #[command(flatten, next_help_heading = heading::METHOD)]
    pub estimator: Estimator,
}

impl Arguments {
    /// What the options override in the scene.
    fn overrides(&self) -> Overrides {
        Overrides { fog: self.fog.settings(), ..self.estimator.overrides(self.size) }
    }
}

/// Runs the command until a signal ends it.
pub(super) fn run(arguments: &Arguments) -> Result<()> {
    let board = Arc::new(Board::new(arguments.display));
    let mut painter = Painter::new(arguments, &board)?;
    let (pool, server) = (threads(arguments.threads)?, Server::new(arguments.port)?);
    // What comes through a pipe cannot be read again.
    let watch = (!format::is_standard_input(&arguments.scene.file)).then(Watch::default);
    interrupt::listen();
    print(&server.address());
    thread::scope(|scope| {
        let painting = scope.spawn(|| pool.install(|| painter.paint()));
        let is_over = || interrupt::came() || painting.is_finished();
        watch.into_iter().for_each(|watch| {
            scope.spawn(|| watch.tell(&board, || board.is_closed()));
        });
        server.serve(&board, is_over);
        board.close();
    });
    Ok(())
}
