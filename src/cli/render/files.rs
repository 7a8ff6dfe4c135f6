//! Whether a render will have the memory and the room that it takes is checked before any work is done.

use super::{
    arguments::Render,
    checkpoint::{SumsFile, sums_file},
    target::Target,
};
use crate::{
    cli::{
        denoise,
        outputs::{self, NUMBERS},
    },
    error::Result,
    film::{Film, layer::Layer},
    inputs,
    scene::build::Setup,
};
use std::path::{Path, PathBuf};

/// Of the frames of an animation, so many have their names tried.
const MOST_FRAMES: usize = 10_000;

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

/// Memory for the film of a render, its files, and room for them.
pub(super) fn check(arguments: &Render, setup: &Setup, target: &Target) -> Result<()> {
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
    let bytes = film.bytes(target.format.names().len() + layers + batches * (3 + layers));
    let images = if arguments.is_part() { Vec::new() } else { images(arguments, target) };
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
    let denoised = images.iter().filter(|_| arguments.denoise).flat_map(|(image, _)| denoise::names(image));
    let denoised: Vec<PathBuf> = denoised.collect();
    outputs.extend(denoised.iter().map(|image| (image.as_path(), 0)));
    outputs.extend(arguments.answer.report.as_deref().map(|report| (report, 0)));
    outputs::check(&outputs)?;
    let sums = sums_file(arguments, target);
    sums.iter().flat_map(SumsFile::names).try_for_each(|name| inputs::guard(&name))
}

/// Images with their previews.
fn images(arguments: &Render, target: &Target) -> Vec<(PathBuf, Option<PathBuf>)> {
    let both = |target: &Target| (target.path.clone(), target.preview());
    match arguments.frames {
        None => vec![both(target)],
        Some(frames) => {
            let numbers = (frames.first..=frames.last).take(MOST_FRAMES);
            numbers.map(|frame| both(&target.numbered(frame, frames.digits()))).collect()
        }
    }
}

/// Three bytes a pixel, before they are compressed.
fn preview_bytes(film: &Film) -> u64 {
    film.bytes(1) / 4 * 3
}
