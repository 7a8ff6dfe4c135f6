//! `tyndall report`: a study's folder in, a page for people out, and on demand a figure for a paper.

use super::{console::say, display::Display, parsers::crop_of_image, python::Script};
use crate::{
    analysis::study::{figure, page},
    error::{Error, Result},
    film::output,
    math::Spectrum,
    settings::Crop,
};
use clap::Args;
use std::{
    ffi::OsStr,
    path::{Path, PathBuf},
};

/// Make the page of a study.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Report {
    /// Folder of the study, with study.json and its images
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,

    /// Also write its table, curves and images for a README to this folder: convergence.md, .svg and _strips.svg
    #[arg(long, value_name = "FOLDER")]
    pub record: Option<PathBuf>,

    /// Also write a figure for a paper, 7 inches wide, to this file (.pdf, .png); may be repeated
    ///
    /// A row for each scene: the reference, with frames of crops; and these crops by every contender at its last budget, with
    /// relMSE and seconds, means over all seeds, and the efficiency over that of the first contender, the best set bold. It
    /// needs Python with the package tyndall and its extra: `pip install '.[figure]'`. The environment variable
    /// TYNDALL_PYTHON names another Python than python3.
    #[arg(long = "figure", value_name = "FILE", value_parser = figure_file)]
    pub figures: Vec<PathBuf>,

    /// Show this scene in the figure; may be repeated, the order counts [default: all]
    #[arg(long = "scene", value_name = "NAME", requires = "figures")]
    pub scenes: Vec<String>,

    /// Show this contender in the figure; may be repeated, the order counts [default: all]
    #[arg(long = "contender", value_name = "NAME", requires = "figures")]
    pub contenders: Vec<String>,

    /// Show this part of the images in the figure: pixels across and down, and its top left corner, or X,Y,WIDTH,HEIGHT; may
    /// be repeated [default: two, where the errors of contenders differ most]
    #[arg(long = "crop", value_name = "WxH+X+Y", value_parser = crop_of_image, allow_hyphen_values = true,
          requires = "figures")]
    pub crops: Vec<Crop>,

    /// How the figure shows images; auto is chosen for each scene, by its reference.
    #[command(flatten)]
    pub display: Display,
}

/// What draws.
const SCRIPT: Script = Script { name: "figure", needs: "matplotlib" };

fn figure_file(text: &str) -> std::result::Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let ending = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("pdf" | "png") => Ok(path),
        _ => Err("expected a file name that ends in .pdf or .png".to_owned()),
    }
}

/// Runs the command.
pub(super) fn run(arguments: &Report) -> Result<()> {
    if arguments.figures.is_empty() && arguments.display != Display::default() {
        let (expected, found) =
            ("--figure with them", "--exposure or --view, but no figure that would be shown so");
        return Err(Error::new("--exposure, --view", expected, found, "add --figure, or leave them out"));
    }
    let figures: Vec<(&Path, u64)> = arguments.figures.iter().map(|path| (path.as_path(), 0)).collect();
    for (path, _) in &figures {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
        folder.map_or(Ok(()), output::create_folder)?;
    }
    output::check(&figures)?;
    if !figures.is_empty() {
        SCRIPT.check()?;
    }
    let mut paths = vec![page::write(&arguments.folder)?];
    if let Some(to) = &arguments.record {
        paths.extend(page::record(&arguments.folder, to)?);
    }
    if !figures.is_empty() {
        draw(arguments)?;
        paths.extend(arguments.figures.clone());
    }
    paths.iter().for_each(|path| say(&path.display().to_string()));
    Ok(())
}

/// Writes the figures.
fn draw(arguments: &Report) -> Result<()> {
    let Report { folder, figures, scenes, contenders, crops, display, .. } = arguments;
    let pictures = tempfile::tempdir().map_err(|error| {
        Error::new(
            "--figure",
            "a temporary folder that can be made",
            error.to_string(),
            "set TMPDIR to a folder",
        )
    })?;
    let show = |scene: &str, reference: &[Spectrum]| {
        let mut display = *display;
        display.choose(reference).iter().for_each(|chosen| say(&format!("{scene}{chosen}")));
        display.of(reference)
    };
    let wanted = figure::Wanted { scenes, contenders, crops, display: &show };
    let described = figure::write(folder, &wanted, pictures.path())?;
    let words: Vec<&OsStr> = [&described].into_iter().chain(figures).map(|path| path.as_os_str()).collect();
    SCRIPT.run(&words, |said| Error::new("--figure", "a figure that can be drawn", said, "see what it says"))
}
