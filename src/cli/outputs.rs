//! What is known to fail is said before any work is done.

use super::{
    arguments::{Render, Scene},
    goal::Goal,
    keeper::{SumsFile, sums_file},
};
use crate::{
    error::Result,
    film::{Film, layer::Layer, output},
    inputs,
    scene::build::Setup,
};
use std::path::{Path, PathBuf};

/// Of the frames of an animation, so many have their names tried.
const MOST_FRAMES: usize = 10_000;

/// What a render keeps of every pixel, in numbers of four bytes, files in the making included: exact sums (24) and once
/// more while they are written, the pass at hand (6), the image and its files. Measured: 51, with 22 channels of layers 3 for
/// each, with batches 5 for each, with precision 134 in all; and some more.
pub const NUMBERS: usize = 72;
/// Sums of products, where layers need them, and once more while they are written.
const NUMBERS_OF_PRODUCTS: usize = 72;
/// What a file of sums holds of every pixel, in the same numbers.
const NUMBERS_OF_SUMS: usize = 24;
/// And one of a render to a precision.
const NUMBERS_OF_HALVES: usize = 72;
const NUMBERS_OF_PRECISION: usize = 100;
const NUMBERS_OF_LAYER: usize = 4;
/// Of a layer that contributions are sorted into: its own sums, once more while they are written, and the pass at hand.
const NUMBERS_OF_SORTED: usize = 60;
const NUMBERS_OF_BATCH: usize = 7;

/// An error unless `outputs` can be written, as [`output::check`] says. Where one of them is standard output, reports go
/// to standard error.
pub fn check(outputs: &[(&Path, u64)]) -> Result<()> {
    output::check(outputs)?;
    if outputs.iter().any(|(path, _)| output::is_stdout(path)) {
        super::voice::take_stdout();
    }
    Ok(())
}

/// The folder that a command writes to, which then exists: the one that was asked for, or one named after `scene` and what it is `of`.
pub fn folder(wanted: Option<&PathBuf>, scene: &Scene, of: &str) -> Result<PathBuf> {
    let named = || PathBuf::from(format!("{}-{of}", scene.name().to_string_lossy()));
    let folder = wanted.cloned().unwrap_or_else(named);
    output::create_folder(&folder)?;
    Ok(folder)
}

/// What was written, in a line.
pub fn listed(folder: &Path, files: &[PathBuf]) -> String {
    let names = files.iter().filter_map(|file| file.file_name()).map(|name| name.to_string_lossy());
    format!("in {}: {}", folder.display(), names.collect::<Vec<_>>().join(", "))
}

/// The same for files of which there may be none, all of them short.
pub fn check_short<'a>(files: impl IntoIterator<Item = &'a PathBuf>) -> Result<()> {
    check(&files.into_iter().map(|path| (path.as_path(), 0)).collect::<Vec<_>>())
}

/// Memory for the film of a render, its files, and room for them.
pub fn check_render(arguments: &Render, setup: &Setup, goal: &Goal) -> Result<()> {
    let Setup { film, integrator, .. } = setup;
    let batches = arguments.batches.map_or(0, |batches| batches as usize);
    let layers: usize = integrator.layers.iter().map(|layer| layer.suffixes().len()).sum();
    let precision = if arguments.error.is_some() { NUMBERS_OF_PRECISION } else { 0 };
    let each = NUMBERS_OF_BATCH + 2 * layers;
    let products = integrator.layers.iter().any(Layer::needs_squares);
    let products = if products { NUMBERS_OF_PRODUCTS } else { 0 };
    let sorted = integrator.layers.iter().filter(|layer| layer.is_sorted()).count();
    let layered = NUMBERS_OF_LAYER * layers + NUMBERS_OF_SORTED * sorted;
    film.check_memory(NUMBERS + products + precision + layered + batches * each)?;
    let bytes = film.bytes(goal.format.names().len() + layers + batches * (3 + layers));
    let images = if arguments.is_part() { Vec::new() } else { images(arguments, goal) };
    let kept = match arguments.error {
        Some(_) => NUMBERS_OF_HALVES * (1 + sorted),
        None => NUMBERS_OF_SUMS * (1 + sorted) + products / 2,
    };
    // Two of them, while one replaces the other.
    let sums = arguments.sums.as_deref().map(|sums| (sums, 2 * film.bytes(kept)));
    let mut outputs: Vec<(&Path, u64)> = sums.into_iter().collect();
    for (index, (image, preview)) in images.iter().enumerate() {
        // An animation that does not fit keeps the frames that did: room for the first is asked for.
        let [bytes, shown] = if index == 0 { [bytes, preview_bytes(film)] } else { [0, 0] };
        outputs.push((image, bytes));
        outputs.extend(preview.as_deref().map(|preview| (preview, shown)));
    }
    outputs.extend(arguments.answer.report.as_deref().map(|report| (report, 0)));
    check(&outputs)?;
    let sums = sums_file(arguments, goal);
    sums.iter().flat_map(SumsFile::names).try_for_each(|name| inputs::guard(&name))
}

/// Images with their previews.
fn images(arguments: &Render, goal: &Goal) -> Vec<(PathBuf, Option<PathBuf>)> {
    let both = |goal: &Goal| (goal.path.clone(), goal.preview());
    match arguments.frames {
        None => vec![both(goal)],
        Some(frames) => {
            let numbers = (frames.first..=frames.last).take(MOST_FRAMES);
            numbers.map(|frame| both(&goal.numbered(frame, frames.digits()))).collect()
        }
    }
}

/// Three bytes a pixel, before they are compressed.
fn preview_bytes(film: &Film) -> u64 {
    film.bytes(1) / 4 * 3
}
