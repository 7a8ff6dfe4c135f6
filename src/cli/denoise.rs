//! `tyndall denoise` and `render --denoise`: Open Image Denoise, by the Python package, whose extra `denoise` has it.

use super::{
    console::{complain, say},
    display::Display,
    outputs::check_short,
    python::Script,
};
use crate::{
    analysis::picture,
    error::{Error, Result},
    film::{exr, view},
    inputs::{self, Reader},
};
use clap::Args;
use serde_json::Value;
use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

/// Denoise an image.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Denoise {
    /// OpenEXR image; layers "albedo" and "normal" in it, as render --denoise writes them, keep edges sharp
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,

    /// How the PNG shows the denoised image.
    #[command(flatten)]
    pub display: Display,
}

/// What denoises.
const SCRIPT: Script = Script { name: "denoise", needs: "pyoidn (Open Image Denoise)" };

/// Runs the command.
pub(super) fn run(Denoise { image, display }: &Denoise) -> Result<()> {
    inputs::note(image, Reader::Command);
    let mut display = *display;
    let exposure = display.choose(&picture::read(image)?.pixels).unwrap_or_default();
    check()?;
    if shares_samples(image)? {
        complain(&format!(
            "warning: pixels of {} share samples. The denoiser leaves much of such noise: render the image with --denoise, \
             or with --film-samples apart",
            image.display()
        ));
    }
    let written = denoise(image, display.of(&[]))?;
    say(&format!("{}{exposure}", written.display()));
    Ok(())
}

/// True if a render with shared samples made the image.
fn shares_samples(image: &Path) -> Result<bool> {
    let made = exr::made(image)?.and_then(|text| serde_json::from_str::<Value>(&text).ok());
    Ok(made.is_some_and(|made| made["shares_samples"] == true))
}

/// An error unless images can be denoised: better known before hours of rendering than after.
pub(super) fn check() -> Result<()> {
    SCRIPT.check()
}

/// Writes the image at `path`, denoised, beside it as `NAME.denoised.exr` and, as `display` shows it, `.png`; the former's
/// path.
pub(super) fn denoise(path: &Path, display: view::Display) -> Result<PathBuf> {
    let [written, shown] = names(path);
    check_short([&written, &shown])?;
    let view = format!("--view={}", display.view.name());
    let exposure = format!("--exposure={}", display.stops);
    let words =
        [path.as_os_str(), written.as_os_str(), shown.as_os_str(), OsStr::new(&view), OsStr::new(&exposure)];
    SCRIPT.run(&words, |said| {
        let remedy = "see what it says; the image must be one of colours, and its folder one to write to";
        Error::new(path.display(), "an image that can be denoised", said, remedy)
    })?;
    Ok(written)
}

/// The files that the image at `path` becomes.
pub(super) fn names(path: &Path) -> [PathBuf; 2] {
    ["exr", "png"].map(|end| path.with_extension(format!("denoised.{end}")))
}
