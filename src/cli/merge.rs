//! `tyndall merge`: parts of one image, their samples added up, their pixels put side by side.

use super::{
    arguments::{Arguments, Command},
    console::{complain, say},
    display::Display,
    outputs::check_short,
    parsers::image_file,
    provenance::{self, made, must_equal},
    render::{arguments::Render, precision::precision, target::Target, task},
};
use crate::{
    description::Object,
    error::{Error, Result},
    film::Window,
    inputs::{self, Reader},
    passes::{Settings, budget::Budget},
    render::{
        self, Image,
        sums::{
            AnySums, file,
            tiles::{self, Tile},
        },
    },
    scene::build::{Setup, build},
    settings::Crop,
};
use clap::{Args, Parser};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Put parts of one image together.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Merge {
    /// Files of sums, as render --sums writes them
    #[arg(value_name = "PARTS", required = true)]
    pub parts: Vec<PathBuf>,

    /// Image to write, as in render; its PNG is written next to it
    #[arg(short, long, value_name = "FILE", value_parser = image_file, required_unless_present = "sums")]
    pub output: Option<PathBuf>,

    /// Also write the sums of all parts, which must be of the same pixels, to this file, from which render --resume continues
    #[arg(long, value_name = "FILE")]
    pub sums: Option<PathBuf>,

    /// The scene of the parts, where it is no longer at the place that they name
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<PathBuf>,

    /// How the PNG shows the image; else as the parts' command says.
    #[command(flatten)]
    pub display: Display,
}

/// Runs the command.
pub fn run(arguments: &Merge) -> Result<()> {
    let paths: Vec<&Path> = arguments.parts.iter().map(PathBuf::as_path).collect();
    paths.iter().for_each(|path| inputs::note(path, Reader::Command));
    let mut parts = gathered(&paths)?;
    parts.iter_mut().for_each(|part| part.find_scene(arguments.scene.as_deref()));
    check_short(arguments.output.iter().chain(&arguments.sums))?;
    if let Some(path) = &arguments.sums {
        let [Part { sums, made, .. }] = parts.as_slice() else {
            let found = format!("{} parts side by side", parts.len());
            let remedy = "merge the samples of each part on its own, or leave out --sums";
            return Err(Error::new("--sums", "samples of the same pixels", found, remedy));
        };
        file::write(path, sums.kept(), made)?;
        say(&format!("samples {}: {}", sums.kept().samples(), path.display()));
    }
    match &arguments.output {
        Some(output) => write(arguments, output, parts),
        None => Ok(()),
    }
}

/// Samples of some pixels of the image.
struct Part {
    /// The first file of them.
    path: PathBuf,
    sums: AnySums,
    made: Value,
    /// The command that rendered them.
    render: Render,
}

impl Part {
    fn read(path: &Path) -> Result<Self> {
        let (mut sums, made) = file::read(path)?;
        let left_out = match &mut sums {
            AnySums::Samples(sums) => Some(sums.drop_unfinished())
                .filter(|fraction| *fraction > 0.0)
                .map(|fraction| format!("{:.0} % of one more sample is left out", 100.0 * fraction)),
            AnySums::Adaptive(halves) => Some(halves.share())
                .filter(|share| *share < 1.0)
                .map(|share| format!("only {:.1} % of its pixels are within the error", 100.0 * share)),
        };
        if let Some(left_out) = left_out {
            complain(&format!("note: {}: {left_out}; complete it with render --resume", path.display()));
        }
        let render = recorded(&made, path)?;
        Ok(Self { path: path.to_owned(), sums, made, render })
    }

    /// Says where its scene is, `elsewhere` than it was or not, and notes what that was read from.
    fn find_scene(&mut self, elsewhere: Option<&Path>) {
        let folder = Path::new(self.made["folder"].as_str().unwrap_or_default());
        let scene = &mut self.render.scene.file;
        *scene = elsewhere.map_or_else(|| folder.join(&scene), Path::to_owned);
        let files = self.made["settings"]["files"].as_object().into_iter().flatten();
        let beside = files.map(|(name, _)| scene.with_file_name(name));
        beside.chain([scene.clone()]).for_each(|file| inputs::note(&file, Reader::Scene));
    }

    /// Adds the samples of another, which has the same pixels.
    fn add(&mut self, other: &Self) -> Result<()> {
        if let (AnySums::Samples(sums), AnySums::Samples(more)) = (&mut self.sums, &other.sums)
            && sums.merge(more)
        {
            return Ok(());
        }
        let [more, sums] = [other, self].map(|part| part.sums.kept().samples());
        let found = format!("samples {more}, some of which are in {sums} already");
        let remedy = "leave it out, or render it again with other --samples or another --crop";
        Err(Error::new(other.path.display(), "samples that no other part has", found, remedy))
    }

    /// Which samples, of which pixels.
    fn describe(&self) -> String {
        let of = self.render.crop.map_or(String::new(), |crop| format!(" of {crop}"));
        format!("samples {}{of}", self.sums.kept().samples())
    }

    /// What it shows of `setup`, a scene with a film of its pixels.
    fn image(&mut self, setup: &Setup) -> Result<Image> {
        let (now, settings) = made_again(&self.render, setup)?;
        must_equal(&self.path, &self.made, &now)?;
        let Setup { film, integrator, .. } = setup;
        render::go_on(setup, film, &settings, &integrator.layers, &mut self.sums, &mut |_, _| {})
    }
}

/// The parts in files, those of the same pixels added up.
fn gathered(paths: &[&Path]) -> Result<Vec<Part>> {
    let mut parts: Vec<Part> = Vec::new();
    for path in paths {
        let part = Part::read(path)?;
        if let Some(first) = parts.first() {
            let [made, first] = [&part, first].map(|part| provenance::without_window(&part.made));
            must_equal(path, &made, &first)?;
        }
        let window = |part: &Part| part.made["settings"]["film"]["window"].clone();
        match parts.iter_mut().find(|other| window(other) == window(&part)) {
            Some(other) => {
                must_equal(path, &part.made, &other.made)?;
                other.add(&part)?;
            }
            None => parts.push(part),
        }
    }
    match parts.iter().find(|part| part.sums.kept().samples().count() == 0) {
        Some(part) => Err(Error::new(
            part.path.display(),
            "at least one sample",
            "no sample of every pixel",
            "complete the part with render --resume",
        )),
        None => Ok(parts),
    }
}

/// Writes the image. The scene is read for its film, and for alpha and layers, which are rendered again.
fn write(arguments: &Merge, output: &Path, mut parts: Vec<Part>) -> Result<()> {
    let crop = parts[0].render.crop.filter(|_| parts.len() == 1);
    let first = parts[0].render.clone();
    let display = arguments.display.or(first.display);
    let whole = Render { output: Some(output.to_owned()), crop, display, ..first };
    let root = whole.scene.read()?;
    let setup = build(&root, whole.overrides())?;
    let mut target = Target::new(&whole, &setup)?;
    check_short([&target.path].into_iter().chain(&target.preview()).chain(&arguments.sums))?;
    let (mut image, what) = match parts.as_mut_slice() {
        [part] => (part.image(&setup)?, part.describe()),
        parts => (side_by_side(parts, &root, &setup)?, format!("{} parts", parts.len())),
    };
    let exposure = target.expose(&image.pixels);
    target.write(&setup.film, &mut image, &made_again(&whole, &setup)?.0)?;
    say(&format!("{what}: {}{}", target.path.display(), exposure.unwrap_or_default()));
    Ok(())
}

/// The image of parts that cover the film of `setup`.
fn side_by_side(parts: &mut [Part], root: &Object, setup: &Setup) -> Result<Image> {
    let whole = setup.film.window;
    let window = |part: &Part| part.render.crop.map_or(whole, |crop| crop.within(&whole));
    let windows: Vec<Window> = parts.iter().map(window).collect();
    check_cover(parts, &windows, &whole)?;
    let tile = |(part, window): (&mut Part, &Window)| {
        let image = part.image(&build(root, part.render.overrides())?)?;
        Ok(Tile { window: *window, image })
    };
    let tiles = parts.iter_mut().zip(&windows).map(tile).collect::<Result<Vec<_>>>()?;
    Ok(Image::of_tiles(&whole, &tiles))
}

/// Refuses parts that overlap or do not cover `whole`.
fn check_cover(parts: &[Part], windows: &[Window], whole: &Window) -> Result<()> {
    for (k, window) in windows.iter().enumerate() {
        if let Some(other) = (0..k).find(|other| tiles::overlap(&windows[*other], window)) {
            let (crop, path) = (Crop::of(window, whole), parts[other].path.display());
            let found = format!("{crop}, some of which are in {path} already");
            let remedy = "leave it out, or render it again with another --crop";
            return Err(Error::new(parts[k].path.display(), "pixels that no other part has", found, remedy));
        }
    }
    let Some(missing) = tiles::missing(whole, windows) else { return Ok(()) };
    let (missing, [width, height]) = (Crop::of(&missing, whole), whole.size);
    let expected = format!("parts that cover the image of {width} x {height} pixels");
    let remedy = format!("add the part that render --crop {missing} --sums FILE makes");
    Err(Error::new("merge", expected, format!("no part with {missing}"), remedy))
}

/// How the command `render` would make the image of `setup` now, and the settings for that, without samples to add.
fn made_again(render: &Render, setup: &Setup) -> Result<(Value, Settings)> {
    let estimator = task::estimator(render, setup)?;
    let (settings, chosen) = estimator.chosen(setup, render.seed, Budget::samples(0))?;
    let precision = precision(render, setup, &settings)?;
    let recorded = provenance::settings(&render.scene, setup, &settings, chosen, precision)?;
    let now = made(recorded, provenance::shares_samples(setup, &settings));
    Ok((now, Settings { seed: render.seed_of_part(), ..settings }))
}

/// The command that a part was rendered with.
fn recorded(made: &Value, part: &Path) -> Result<Render> {
    let words = made["command"].as_array().into_iter().flatten().filter_map(Value::as_str);
    match Arguments::try_parse_from(words) {
        Ok(Arguments { command: Command::Render(render), .. }) => Ok(*render),
        _ => {
            let found = "none, or one that this version does not understand";
            let remedy = "use the version of tyndall that wrote it";
            Err(Error::new(part.display(), "the command that rendered it", found, remedy))
        }
    }
}
