//! What is known to fail is said before any work is done.

use super::{arguments::Render, render::Goal};
use crate::{
    error::Result,
    film::{Film, output},
    scene::build::Setup,
};
use std::path::{Path, PathBuf};

/// Of the frames of an animation, so many have their names tried.
const MOST_FRAMES: usize = 10_000;

/// Memory for the film of a render, its files, and room for them.
pub fn check_render(arguments: &Render, setup: &Setup, goal: &Goal) -> Result<()> {
    let Setup { film, integrator, .. } = setup;
    let batches = arguments.batches.map_or(0, |batches| batches as usize);
    let layers: usize = integrator.layers.iter().map(|layer| layer.suffixes().len()).sum();
    film.check_memory(layers, batches)?;
    let bytes = film.bytes(goal.format.names().len() + layers + batches * (3 + layers));
    let images = images(arguments, goal);
    let mut outputs: Vec<(&Path, u64)> = Vec::new();
    for (index, (image, preview)) in images.iter().enumerate() {
        // An animation that does not fit keeps the frames that did: room for the first is asked for.
        let [bytes, shown] = if index == 0 { [bytes, preview_bytes(film)] } else { [0, 0] };
        outputs.push((image, bytes));
        outputs.extend(preview.as_deref().map(|preview| (preview, shown)));
    }
    outputs.extend(arguments.report.as_deref().map(|report| (report, 0)));
    output::check(&outputs, &[&arguments.scene.file])
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
