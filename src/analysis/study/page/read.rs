//! The contents of a page, from a study's folder.

use crate::{
    analysis::{
        picture::{self, Picture},
        study::outcome::{Outcome, SceneOutcome},
    },
    error::{Error, Result},
    math::Spectrum,
};
use std::path::Path;

/// The study in the file at `path`: at least one scene, in each at least one contender with at least one budget.
pub(in crate::analysis::study) fn outcome(path: &Path) -> Result<Outcome> {
    let remedy = "give the folder of a study, as tyndall study or python3 -m validation efficiency leaves it";
    let text = std::fs::read_to_string(path)
        .map_err(|error| Error::new(path.display(), "the numbers of a study", error.to_string(), remedy))?;
    let outcome: Outcome = serde_json::from_str(&text).map_err(|error| {
        let place = format!("{}:{}:{}", path.display(), error.line(), error.column());
        let remedy = "run the study again";
        Error::new(place, "a study as JSON", error.to_string(), remedy)
    })?;
    match gap(&outcome) {
        None => Ok(outcome),
        Some((expected, found)) => {
            Err(Error::new(path.display(), expected, found, "run the study again until it has finished"))
        }
    }
}

/// What must be there and is not: what was expected, what was found.
fn gap(outcome: &Outcome) -> Option<(&'static str, String)> {
    if outcome.scenes.is_empty() {
        return Some(("at least one scene", "none".into()));
    }
    outcome.scenes.iter().find_map(gap_in_scene)
}

fn gap_in_scene(scene: &SceneOutcome) -> Option<(&'static str, String)> {
    let name = &scene.name;
    if scene.width == 0 || scene.height == 0 {
        return Some(("images with pixels", format!("{} x {} in {name}", scene.width, scene.height)));
    }
    if scene.contenders.is_empty() {
        return Some(("at least one contender in every scene", format!("none in {name}")));
    }
    if let Some(idle) = scene.contenders.iter().find(|contender| contender.points.is_empty()) {
        return Some((
            "at least one budget for every contender",
            format!("none for {} in {name}", idle.name),
        ));
    }
    let alone = scene.contenders.iter().skip(1).find(|contender| contender.ratio.is_none())?;
    Some(("a ratio to the first contender for every other", format!("none for {} in {name}", alone.name)))
}

/// The pixels of an image that has the size of `scene`, of any values.
pub(in crate::analysis::study) fn image(path: &Path, scene: &SceneOutcome) -> Result<Vec<Spectrum>> {
    let expected = || format!("an image of {} x {} pixels", scene.width, scene.height);
    let remedy = "run the study again, or restore its images";
    let picture = picture::read(path).map_err(|error| Error {
        expected: expected(),
        remedy: remedy.to_owned(),
        ..error
    })?;
    let Picture { width, height, pixels, .. } = picture;
    if (width, height) != (scene.width, scene.height) {
        return Err(Error::new(path.display(), expected(), format!("{width} x {height}"), remedy));
    }
    Ok(pixels)
}
