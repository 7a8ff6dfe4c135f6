//! A study as a figure of a paper: for each scene its reference, with frames of a few crops, and beside it these crops by every
//! contender at its last budget, with what they cost. Here is what it shows; the Python package draws it.

mod crops;

use super::{
    outcome::{ContenderOutcome, Outcome, SceneOutcome},
    page::{figures, maps, read},
};
use crate::{
    error::{Error, Result},
    film::view::Display,
    math::{Spectrum, SpectrumExt},
    settings::Crop,
};
use image::ExtendedColorType;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is to be shown; all scenes and contenders where none are named.
pub struct Wanted<'a> {
    /// Names of scenes, in order.
    pub scenes: &'a [String],
    /// Names of contenders, in order.
    pub contenders: &'a [String],
    /// Parts of all images; none for those that tell most.
    pub crops: &'a [Crop],
    /// How the reference of a scene is shown, which is named, and all its images with it.
    pub display: &'a dyn Fn(&str, &[Spectrum]) -> Display,
}

/// A scene.
#[derive(Serialize)]
struct Row {
    name: String,
    /// A picture.
    reference: PathBuf,
    /// Columns and rows of the top left corner; pixels across and down.
    crops: Vec<[usize; 4]>,
    columns: Vec<Column>,
}

/// A contender in a scene.
#[derive(Serialize)]
struct Column {
    name: String,
    /// A picture.
    image: PathBuf,
    relmse: String,
    seconds: String,
    /// Its efficiency over that of the first.
    lead: String,
    /// Nobody is more efficient.
    is_best: bool,
}

/// Name of the description of a figure.
const FIGURE: &str = "figure.json";

/// Writes what a figure of the study in `folder` shows to the folder `to`: pictures, and a description that names them, whose
/// path this gives.
pub fn write(folder: &Path, wanted: &Wanted<'_>, to: &Path) -> Result<PathBuf> {
    let outcome = read::outcome(&folder.join("study.json"))?;
    let scenes = scenes(&outcome, wanted.scenes)?;
    check_contenders(&scenes, wanted.contenders)?;
    let row = |(index, scene): (usize, &&SceneOutcome)| row(folder, scene, wanted, to, index);
    let rows = scenes.iter().enumerate().map(row).collect::<Result<Vec<Row>>>()?;
    let path = to.join(FIGURE);
    let text = serde_json::json!({ "rows": rows }).to_string();
    std::fs::write(&path, text).map_err(|error| Error::io(&path, "write", &error))?;
    Ok(path)
}

/// Those of these `names`, or all.
fn scenes<'a>(outcome: &'a Outcome, names: &[String]) -> Result<Vec<&'a SceneOutcome>> {
    if names.is_empty() {
        return Ok(outcome.scenes.iter().collect());
    }
    let known = || outcome.scenes.iter().map(|scene| scene.name.as_str());
    let find = |name: &String| outcome.scenes.iter().find(|scene| scene.name == *name);
    names.iter().map(|name| find(name).ok_or_else(|| unknown("--scene", name, known()))).collect()
}

/// Refuses a name that no contender of any scene has.
fn check_contenders(scenes: &[&SceneOutcome], names: &[String]) -> Result<()> {
    let mut known: Vec<&str> = Vec::new();
    for contender in scenes.iter().flat_map(|scene| &scene.contenders) {
        if !known.contains(&contender.name.as_str()) {
            known.push(&contender.name);
        }
    }
    match names.iter().find(|name| !known.contains(&name.as_str())) {
        None => Ok(()),
        Some(name) => Err(unknown("--contender", name, known.into_iter())),
    }
}

fn unknown<'a>(place: &str, name: &str, known: impl Iterator<Item = &'a str>) -> Error {
    let known: Vec<&str> = known.collect();
    Error::new(
        place,
        format!("a name of the study: {}", known.join(", ")),
        format!("\"{name}\""),
        "give one of these",
    )
}

/// Those of `names` that rendered the scene, or all.
fn contenders<'a>(scene: &'a SceneOutcome, names: &[String]) -> Vec<&'a ContenderOutcome> {
    match names.is_empty() {
        true => scene.contenders.iter().collect(),
        false => names.iter().filter_map(|name| scene.contenders.iter().find(|c| c.name == *name)).collect(),
    }
}

fn row(folder: &Path, scene: &SceneOutcome, wanted: &Wanted<'_>, to: &Path, index: usize) -> Result<Row> {
    let size = [scene.width, scene.height];
    let reference = read::image(&folder.join(&scene.reference.image), scene)?;
    let contenders = contenders(scene, wanted.contenders);
    let images = contenders.iter().map(|one| read::image(&folder.join(&last(one).image), scene));
    let images: Vec<Vec<Spectrum>> = images.collect::<Result<_>>()?;
    let crops = match wanted.crops {
        [] => {
            let errors: Vec<_> = images.iter().map(|image| maps::errors(image, &reference)).collect();
            let luminance: Vec<f64> = reference.iter().map(|pixel| pixel.luminance().into()).collect();
            crops::choose(size, &luminance, &errors)
        }
        crops => crops.iter().map(|crop| within(crop, scene)).collect::<Result<_>>()?,
    };
    let display = (wanted.display)(&scene.name, &reference);
    let picture = |name: String, pixels: &[Spectrum]| {
        let path = to.join(format!("{index}-{name}.png"));
        save(&path, size, &display.bytes_like(pixels, &reference))?;
        Ok(path)
    };
    let best = contenders.iter().map(|one| one.efficiency.mean).fold(f64::NEG_INFINITY, f64::max);
    let first = contenders.first().map_or(f64::NAN, |one| one.efficiency.mean);
    let column = |(number, (contender, pixels)): (usize, (&&ContenderOutcome, &Vec<Spectrum>))| {
        Ok(Column {
            name: contender.name.clone(),
            image: picture(number.to_string(), pixels)?,
            relmse: figures::number(last(contender).relmse.mean),
            seconds: figures::seconds(last(contender).seconds.mean),
            lead: if number == 0 { "1×".into() } else { lead(contender.efficiency.mean / first) },
            is_best: contender.efficiency.mean >= best,
        })
    };
    Ok(Row {
        name: scene.name.clone(),
        reference: picture("reference".into(), &reference)?,
        crops,
        columns: contenders.iter().zip(&images).enumerate().map(column).collect::<Result<_>>()?,
    })
}

/// Its last budget, which every contender of a study that was read has.
fn last(contender: &ContenderOutcome) -> &super::outcome::Point {
    &contender.points[contender.points.len() - 1]
}

/// Of efficiencies; one of an image with NaN is none.
fn lead(ratio: f64) -> String {
    let number = figures::number(ratio);
    if ratio.is_nan() { number } else { format!("{number}×") }
}

/// A crop as column, row, width and height, refused unless it is within the images of `scene`.
fn within(crop: &Crop, scene: &SceneOutcome) -> Result<[usize; 4]> {
    let [x, y, width, height] =
        [crop.corner[0], crop.corner[1], crop.size[0], crop.size[1]].map(|side| side as usize);
    match x + width <= scene.width && y + height <= scene.height {
        true => Ok([x, y, width, height]),
        false => Err(Error::new(
            "--crop",
            format!("a part of the image of {}, which is {} x {}", scene.name, scene.width, scene.height),
            format!("{width}x{height}+{x}+{y}"),
            "give one that is within, or choose scenes by --scene",
        )),
    }
}

fn save(path: &Path, [width, height]: [usize; 2], bytes: &[u8]) -> Result<()> {
    // Both are those of an image in memory.
    let saved = image::save_buffer(path, bytes, width as u32, height as u32, ExtendedColorType::Rgb8);
    saved.map_err(|error| {
        Error::new(path.display(), "a picture that can be written", error.to_string(), "see what it says")
    })
}
