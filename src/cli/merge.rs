//! `tyndall merge`: parts of one image, added up.

use super::{
    arguments::{self, Arguments, Command},
    complain,
    goal::Goal,
    load, made,
    outputs::check_short,
    say,
};
use crate::{
    error::{Error, Result},
    render::{
        self, Image,
        budget::Budget,
        sums::Sums,
        sums_file::{self, read},
    },
};
use clap::{Args, Parser};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Add up parts of one image.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Merge {
    /// Files of sums, as render --sums writes them
    #[arg(value_name = "PARTS", required = true)]
    pub parts: Vec<PathBuf>,

    /// Image to write, as in render; its PNG is written next to it
    #[arg(short, long, value_name = "FILE", value_parser = arguments::image_file, required_unless_present = "sums")]
    pub output: Option<PathBuf>,

    /// Also write the sums of all parts to this file, from which render --resume continues
    #[arg(long, value_name = "FILE")]
    pub sums: Option<PathBuf>,

    /// The scene of the parts, where it is no longer at the place that they name
    #[arg(long, value_name = "SCENE")]
    pub scene: Option<PathBuf>,
}

/// Runs the command.
pub fn run(arguments: &Merge) -> Result<()> {
    let parts: Vec<&Path> = arguments.parts.iter().map(PathBuf::as_path).collect();
    check_short(arguments.output.iter().chain(&arguments.sums), &parts)?;
    let (mut sums, made) = part(&arguments.parts[0])?;
    for path in &arguments.parts[1..] {
        let (more, other) = part(path)?;
        made::must_equal(path, &other, &made)?;
        if !sums.merge(&more) {
            let found =
                format!("samples {}, some of which are in {} already", more.samples(), sums.samples());
            let remedy = "leave it out, or render it again with other --samples";
            return Err(Error::new(path.display(), "samples that no other part has", found, remedy));
        }
    }
    let count = sums.samples().count();
    if count == 0 {
        let place = arguments.parts[0].display();
        let found = "no sample of every pixel";
        return Err(Error::new(
            place,
            "at least one sample",
            found,
            "complete the part with render --resume",
        ));
    }
    if let Some(path) = &arguments.sums {
        sums_file::write(path, &sums, &made)?;
        say(&format!("samples {}: {}", sums.samples(), path.display()));
    }
    match &arguments.output {
        Some(output) => develop(arguments, output, &made, sums),
        None => Ok(()),
    }
}

/// A part, of which whole passes count only.
fn part(path: &Path) -> Result<(Sums, Value)> {
    let (mut sums, made) = read(path)?;
    let unfinished = sums.drop_unfinished();
    if unfinished > 0.0 {
        let (path, percent) = (path.display(), 100.0 * unfinished);
        complain(&format!(
            "warning: {path}: {percent:.0} % of one more sample is left out; complete it with render --resume"
        ));
    }
    Ok((sums, made))
}

/// Writes the image. The scene is read for its film, and for alpha and layers, which are rendered again.
fn develop(arguments: &Merge, output: &Path, made: &Value, mut sums: Sums) -> Result<()> {
    let mut render = recorded(made, &arguments.parts[0])?;
    let folder = PathBuf::from(made["folder"].as_str().unwrap_or_default());
    render.scene.file = arguments.scene.clone().unwrap_or_else(|| folder.join(&render.scene.file));
    render.output = Some(output.to_owned());
    let setup = load(&render.scene, render.size, render.estimator.tracker)?;
    let settings = render.estimator.settings(&setup, render.seed, Budget::samples(0))?;
    let now = made::made(made::settings(&render.scene, &setup, &settings)?);
    made::must_equal(&arguments.parts[0], made, &now)?;
    let goal = Goal::new(&render, &setup)?;
    let others: Vec<&Path> = arguments.parts.iter().chain(&arguments.sums).map(PathBuf::as_path).collect();
    check_short([&goal.path].into_iter().chain(&goal.preview()), &others)?;
    let layers = &setup.integrator.layers;
    let mut image: Image =
        render::render_on(&setup.scene, &setup.film, &settings, layers, &mut sums, &mut |_, _| {});
    goal.write(&setup.film, &mut image, &now)?;
    say(&format!("samples {}: {}", sums.samples(), goal.path.display()));
    Ok(())
}

/// The command that a part was rendered with.
fn recorded(made: &Value, part: &Path) -> Result<arguments::Render> {
    let words = made["command"].as_array().into_iter().flatten().filter_map(Value::as_str);
    match Arguments::try_parse_from(words) {
        Ok(Arguments { command: Command::Render(render), .. }) => Ok(render),
        _ => {
            let found = "none, or one that this version does not understand";
            let remedy = "use the version of tyndall that wrote it";
            Err(Error::new(part.display(), "the command that rendered it", found, remedy))
        }
    }
}
