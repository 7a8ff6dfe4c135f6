//! Instruments: what is measured about renders, and how it is reported.
//!
//! # Error against run time: `tyndall study`
//!
//! ```text
//! tyndall study scenes/foggy_room.json scenes/church.json -o study --vary integrator=bdpt,pt,lt --seconds 8
//! ```
//!
//! Contenders take turns, seed by seed, on the same cores; every render is looked at as its samples double up to the
//! largest budget (`--seconds`, or `--spp`), against a reference that is made in independent batches, so that its own
//! error is known, or given (`--reference`). A table is printed, and the folder has
//!
//! - `study.json`: per scene, contender and budget the time, MSE, relMSE, relMSE without the worst 0.1 %, MAPE, SMAPE and
//!   the difference of means, each with its interval over the seeds; per contender the slope of relMSE over time, the
//!   efficiency 1 / (relMSE x seconds), and its ratio to the first contender's; notes on what a contender leaves out, on
//!   signs of bias, and on errors that are the reference's own ([`study::outcome`] documents every field);
//! - `study.csv`: one row per scene, contender, budget and seed;
//! - `images/`: references, an image for every budget, variance over the seeds;
//! - `runs/`: what is needed to resume. A study that was stopped, in whatever way, is resumed by the same command, to the
//!   same numbers: the plan that the pilots lead to is in `runs/plan.json` before anything is measured.
//!
//! Axes multiply: `--vary OPTION=A,B` for any option of `render` that says how paths are made (`--vary max-depth=2,4,-1`,
//! `--vary strategies=hit+next-event,hit+next-event+join`); `--contender "NAME: OPTIONS"` adds one by hand. `tyndall study --help` explains `--seeds`,
//! `--doublings`, `--confidence`, `--reference-by`, `--reference-seconds`, `--size` and `-D`.
//!
//! How to read it. The points of one curve share samples: its intervals over seeds hold at each budget, not for
//! differences between budgets, and the slope is fitted seed by seed. Intervals are Student's t over seeds; of what is
//! positive for the logarithm of the mean, so that they never reach zero (its error, for efficiencies and ratios, by
//! bootstrap). Few seeds of a contender with rare, bright samples say little, whatever the interval: the trimmed relMSE,
//! far below the other, shows it. The time of the first budgets includes what is done once (pilot walks), and images of
//! few pixels keep few threads busy there.
//!
//! # What makes the noise: `tyndall strategies`, `tyndall pixel`
//!
//! `tyndall strategies SCENE` writes the image of every strategy (s, t), weighted and alone, as EXR layers and as pyramids
//! on contact sheets; a table of shares of energy, variance and time; and which kinds of strategies the scene could do
//! without, by error x time of short renders that take turns. `tyndall pixel SCENE X Y` writes the paths of that pixel's
//! samples as JSON, the very ones that a render with the same seed makes: vertices with their pdfs, connections with their
//! weights, light subpaths, and the value that they add up to. `tyndall pixel SCENE --outliers` finds the contributions that make
//! single bright pixels, and writes their paths as JSON or draws them on a page.
//!
//! # Images: `tyndall diff`
//!
//! How far an image is from a reference (OpenEXR, PFM, Radiance, PNG; `--layer NAME` for layers): MSE, RMSE, relMSE, MAPE,
//! SMAPE, means, the largest difference, the share of pixels beyond a tolerance, FLIP, in radiance and in display units, as
//! a table and as JSON; the exit code is for scripts (`--fail-above relmse=0.01`).
//!
//! # Phase functions: `tyndall phase`
//!
//! ```text
//! tyndall phase blendphase weight=0.3 a=hg a.g=0.9 b=isotropic
//! ```
//!
//! samples a phase function, tests the samples against its pdf by chi-square, and draws it: a polar plot (SVG) and a mesh
//! (PLY).
//!
//! # Free flights: `tyndall flights`
//!
//! ```text
//! tyndall flights hg g=0.75 --sigma-a 0.1 --sigma-s 0.9 --size 2 --svg steps.svg
//! ```
//!
//! sends photons into a slab or a cube by constant steps, by exponential flights of sigma_t and of sigma_s, and with the
//! first collision forced: bias against a long run and closed forms, variance times seconds, and the law that constant steps
//! miss the mean free path by (P03T fig. A.12).

pub mod chi_square;
pub mod darkness;
pub mod diff;
pub mod flights;
pub mod guide;
pub mod interval;
mod lettering;
pub mod metrics;
pub mod phase;
pub mod picture;
pub mod pixel;
mod sheet;
pub mod strategies;
pub mod study;

use crate::{
    error::{Error, Result},
    transport::Algorithm,
};

/// An error where an `algorithm` makes no whole paths, of which there is something to say.
fn check_paths(algorithm: Algorithm) -> Result<()> {
    if !algorithm.is_preview() {
        return Ok(());
    }
    let (remedy, found) = ("choose --integrator bdpt, pt or lt", format!("{}, a preview", algorithm.name()));
    Err(Error::new("the scene's integrator", "one that makes whole paths", found, remedy))
}
