//! `tyndall denoise` and `render --denoise`: Open Image Denoise, by the Python package, whose extra `denoise` has it.

use super::{console::say, display::Display, outputs::check_short};
use crate::{
    analysis::picture,
    error::{Error, Result},
    film::view,
    inputs::{self, Reader},
};
use clap::Args;
use std::{
    ffi::{OsStr, OsString},
    path::{Path, PathBuf},
    process::Command,
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

/// The Python that is used.
const PYTHON: &str = "TYNDALL_PYTHON";

/// Runs the command.
pub(super) fn run(Denoise { image, display }: &Denoise) -> Result<()> {
    inputs::note(image, Reader::Command);
    let mut display = *display;
    let exposure = display.choose(&picture::read(image)?.pixels).unwrap_or_default();
    check()?;
    let written = denoise(image, display.of(&[]))?;
    say(&format!("{}{exposure}", written.display()));
    Ok(())
}

/// An error unless images can be denoised: better known before hours of rendering than after.
pub(super) fn check() -> Result<()> {
    python(&[OsStr::new("--check")], lacking)
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
    python(&words, |said| {
        let remedy = "see what it says; the image must be one of colours, and its folder one to write to";
        Error::new(path.display(), "an image that can be denoised", said, remedy)
    })?;
    Ok(written)
}

/// The files that the image at `path` becomes.
pub(super) fn names(path: &Path) -> [PathBuf; 2] {
    ["exr", "png"].map(|end| path.with_extension(format!("denoised.{end}")))
}

/// The Python that is run.
fn interpreter() -> OsString {
    std::env::var_os(PYTHON).unwrap_or_else(|| "python3".into())
}

/// The error where it has not what is needed, as it `said`.
fn lacking(said: String) -> Error {
    let remedy = format!(
        "pip install '.[denoise]' in the folder of Tyndall's sources; {PYTHON} names another Python than {}",
        interpreter().display()
    );
    Error::new("denoise", "Python with the packages tyndall and pyoidn (Open Image Denoise)", said, remedy)
}

/// Runs `python3 -m tyndall denoise` with `words`; the error of its `failure` says why.
fn python(words: &[&OsStr], failure: impl Fn(String) -> Error) -> Result<()> {
    let name = interpreter();
    let done = Command::new(&name).args(["-m", "tyndall", "denoise"]).args(words).output();
    let done = done.map_err(|error| lacking(format!("{}: {error}", name.display())))?;
    if done.status.success() {
        return Ok(());
    }
    let said = String::from_utf8_lossy(&done.stderr).trim().to_owned();
    Err(failure(said.lines().last().unwrap_or("no word of why it failed").to_owned()))
}
