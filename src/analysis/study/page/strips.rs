//! The images of a scene: for every level of time all contenders' beside the reference, and their errors.

use super::{
    figures,
    inline::{self, Size},
    levels::{self, Level, Plan},
    maps::{self, Scale},
    read, tone,
};
use crate::{
    analysis::study::outcome::{ContenderOutcome, Outcome, SceneOutcome},
    error::Result,
    math::Spectrum,
};
use std::path::Path;

/// An image of the page.
pub(super) struct Picture {
    /// A data URI.
    pub uri: String,
    /// What it shows, in words.
    pub title: String,
}

/// A contender at a level.
pub(super) struct Shot {
    /// The contender's name.
    pub name: String,
    /// Its colour.
    pub series: usize,
    /// What it rendered.
    pub image: Picture,
    /// Where it went wrong.
    pub error: Picture,
    /// The actual time.
    pub seconds: String,
    /// How much longer or shorter than the level that is, where one must know.
    pub uneven: Option<String>,
    /// Samples per pixel.
    pub samples: String,
    /// Of all seeds.
    pub relmse: String,
}

/// Images of about the same time.
pub(super) struct Strip {
    /// That time.
    pub seconds: String,
    /// One of each contender.
    pub shots: Vec<Shot>,
}

/// A contender's variance.
pub(super) struct Spread {
    /// The contender's name.
    pub name: String,
    /// Its colour.
    pub series: usize,
    /// Of each pixel, over the reference's square.
    pub map: Picture,
}

/// All images of a scene.
pub(super) struct Strips {
    /// Pixels across, of what is shown.
    pub width: usize,
    /// Pixels down, of what is shown.
    pub height: usize,
    /// What all are compared with.
    pub reference: Picture,
    /// By growing time.
    pub levels: Vec<Strip>,
    /// Of contenders that have one.
    pub spreads: Vec<Spread>,
    /// The colours of all errors and variances, as a data URI.
    pub bar: String,
    /// Texts beside that, with their places (%).
    pub ticks: Vec<(String, f64)>,
    /// What is not shown, or not as it is.
    pub left_out: Vec<String>,
}

/// An image before it is coloured.
struct Shown {
    pixels: Vec<Spectrum>,
    errors: Vec<f64>,
}

impl Strips {
    /// Reads the images that `outcome` names.
    pub(super) fn new(folder: &Path, outcome: &Outcome, scene: &SceneOutcome) -> Result<Self> {
        let plan = levels::plan(outcome, scene);
        let size = Size { width: scene.width, height: scene.height, shrink: plan.shrink };
        let reference = read::image(&folder.join(&scene.reference.image), scene)?;
        let shown = |level: &Level| shown(folder, scene, level, &reference, size);
        let shown: Vec<Vec<Shown>> = plan.levels.iter().map(shown).collect::<Result<_>>()?;
        let spreads = spreads(folder, scene, &reference, size)?;
        let errors = shown.iter().flatten().flat_map(|shown| &shown.errors);
        let scale = Scale::of(errors.chain(spreads.iter().flat_map(|(_, values)| values)));
        let brush = Brush { size, white: tone::white(&reference), scale };
        let strips = plan.levels.iter().zip(&shown);
        let [width, height] = size.shown();
        Ok(Self {
            width,
            height,
            reference: brush.image(&size.colours(&reference), "Reference".into())?,
            levels: strips.map(|(level, shown)| brush.strip(scene, level, shown)).collect::<Result<_>>()?,
            spreads: spreads
                .iter()
                .map(|(series, values)| brush.spread(scene, *series, values))
                .collect::<Result<_>>()?,
            bar: inline::uri(256, 1, &Scale::bar())?,
            ticks: scale.ticks(),
            left_out: left_out(scene, &plan).into_iter().chain(broken(&shown)).collect(),
        })
    }
}

impl Strips {
    /// How many images are shown side by side, the reference among them.
    pub(super) fn count(&self) -> usize {
        1 + self.levels.first().map_or(0, |strip| strip.shots.len())
    }
}

fn shown(
    folder: &Path,
    scene: &SceneOutcome,
    level: &Level,
    reference: &[Spectrum],
    size: Size,
) -> Result<Vec<Shown>> {
    let of = |(contender, pick): (&ContenderOutcome, &usize)| {
        let image = read::image(&folder.join(&contender.points[*pick].image), scene)?;
        let errors = size.values(&maps::errors(&image, reference));
        Ok(Shown { pixels: size.colours(&image), errors })
    };
    scene.contenders.iter().zip(&level.picks).map(of).collect()
}

/// The relative variances of those contenders that name a file of variances.
fn spreads(
    folder: &Path,
    scene: &SceneOutcome,
    reference: &[Spectrum],
    size: Size,
) -> Result<Vec<(usize, Vec<f64>)>> {
    let named = scene.contenders.iter().enumerate().filter(|(_, c)| !c.variance.as_os_str().is_empty());
    let of = |(series, contender): (usize, &ContenderOutcome)| {
        let variance = read::image(&folder.join(&contender.variance), scene)?;
        Ok((series, size.values(&maps::variances(&variance, reference))))
    };
    named.map(of).collect()
}

fn left_out(scene: &SceneOutcome, plan: &Plan) -> Vec<String> {
    let Plan { levels, available, shrink } = plan;
    let mut said = Vec::new();
    if levels.len() < *available {
        said.push(format!("{} of {available} levels of time are shown.", levels.len()));
    }
    if *shrink > 1 {
        let (width, height) = (scene.width, scene.height);
        said.push(format!(
            "To keep this file small, images of {width} × {height} pixels are averaged over {shrink} × {shrink}: \
             noise looks weaker than it is. The numbers are of the whole images."
        ));
    }
    said
}

/// A word on pixels that are no light, where there are any.
fn broken(shown: &[Vec<Shown>]) -> Option<String> {
    let found = shown.iter().flatten().any(|shown| shown.errors.iter().any(|error| error.is_nan()));
    found.then(|| "Magenta in images and green in errors: pixels that are not numbers.".into())
}

/// What all images of a scene are shown by.
struct Brush {
    size: Size,
    white: f64,
    scale: Scale,
}

impl Brush {
    fn uri(&self, bytes: &[u8]) -> Result<String> {
        let [width, height] = self.size.shown();
        inline::uri(width, height, bytes)
    }

    fn image(&self, pixels: &[Spectrum], title: String) -> Result<Picture> {
        Ok(Picture { uri: self.uri(&tone::encoded(pixels, self.white))?, title })
    }

    fn map(&self, values: &[f64], title: String) -> Result<Picture> {
        Ok(Picture { uri: self.uri(&self.scale.coloured(values))?, title })
    }

    fn strip(&self, scene: &SceneOutcome, level: &Level, shown: &[Shown]) -> Result<Strip> {
        let shots = shown.iter().enumerate().map(|(series, shown)| self.shot(scene, level, series, shown));
        Ok(Strip { seconds: figures::seconds(level.seconds), shots: shots.collect::<Result<_>>()? })
    }

    fn shot(&self, scene: &SceneOutcome, level: &Level, series: usize, shown: &Shown) -> Result<Shot> {
        let contender = &scene.contenders[series];
        let point = &contender.points[level.picks[series]];
        let (name, seconds) = (contender.name.clone(), figures::seconds(point.seconds.mean));
        Ok(Shot {
            image: self.image(&shown.pixels, format!("{name}, {seconds}"))?,
            error: self.map(&shown.errors, format!("{name}, {seconds}, error"))?,
            name,
            series,
            seconds,
            uneven: uneven(levels::time(point.seconds.mean) / level.seconds),
            samples: figures::count(point.samples),
            relmse: figures::number(point.relmse.mean),
        })
    }

    fn spread(&self, scene: &SceneOutcome, series: usize, values: &[f64]) -> Result<Spread> {
        let name = scene.contenders[series].name.clone();
        let map = self.map(values, format!("{name}, variance"))?;
        Ok(Spread { name, series, map })
    }
}

/// Says by what factor a time differs from another, if by more than a quarter.
fn uneven(ratio: f64) -> Option<String> {
    match ratio {
        ratio if !(ratio > 0.0 && ratio.is_finite()) => Some("another time".into()),
        ratio if ratio > 1.25 => Some(format!("{}× the time", figures::number(ratio))),
        ratio if ratio < 0.8 => Some(format!("1/{} of the time", figures::number(1.0 / ratio))),
        _ => None,
    }
}
