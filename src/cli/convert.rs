//! `tyndall convert`: converts a scene between XML and JSON, an image to a PNG, or a volume file to Mitsuba's.

use super::{
    console::complain,
    display::Display,
    outputs::check_short,
    parsers::{definition, scene_file},
    provenance,
};
use crate::{
    analysis::picture,
    error::{Error, Result},
    film, format,
    inputs::{self, Reader},
    volume::grid,
};
use clap::Args;
use std::path::{Path, PathBuf};

/// Convert a scene, an image or a volume file.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Convert {
    /// Scene file: Mitsuba 3 XML (.xml) or JSON (.json), or - for standard input; or an image; or a volume file
    #[arg(value_name = "IN", value_parser = scene_file())]
    pub input: PathBuf,

    /// Scene file to write: .xml or .json; of an image: .png; of a volume file: .vol
    #[arg(value_name = "OUT")]
    pub output: PathBuf,

    /// Set the parameter $name of the scene instead of its default; may be repeated
    #[arg(short = 'D', value_name = "name=value", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// The grid that is meant in a file of several [default: the one named "density", else the only one]
    #[arg(long, value_name = "NAME")]
    pub grid: Option<String>,

    /// The layer of an OpenEXR image that the PNG shows, or the channel with this full name [default: the channels without a
    /// layer]
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,

    /// How the PNG of an image shows it.
    #[command(flatten)]
    pub display: Display,
}

/// Runs the command.
pub(super) fn run(arguments: &Convert) -> Result<()> {
    let Convert { definitions, grid, layer, display, input, output } = arguments;
    let of_scenes = [(!definitions.is_empty(), "-D")];
    let of_images = [
        (display.exposure.is_some(), "--exposure"),
        (display.view.is_some(), "--view"),
        (layer.is_some(), "--layer"),
    ];
    let of_volumes = [(grid.is_some(), "--grid")];
    let is = |kind| output.extension().is_some_and(|end| end.eq_ignore_ascii_case(kind));
    let (to_png, to_vol) = (is("png"), is("vol"));
    if to_png || to_vol {
        refuse(&of_scenes, "a scene file to write", output)?;
    }
    if !to_png {
        refuse(&of_images, "a PNG to write", output)?;
    }
    if !to_vol {
        refuse(&of_volumes, "a .vol file to write", output)?;
    }
    inputs::note(input, Reader::Command);
    match (to_png, to_vol) {
        (true, _) => show(input, layer.as_deref(), output, *display),
        (_, true) => voxels(input, grid.as_deref(), output),
        _ if format::is_scene(output) => scene(arguments),
        _ => {
            let expected = "a file to write that ends in .xml or .json (of a scene), .png (of an image) or .vol (of a volume)";
            let found = output.extension().map_or("a name without an extension".into(), |end| {
                format!("one that ends in .{}", end.to_string_lossy())
            });
            Err(Error::new(output.display(), expected, found, "give it one of these endings"))
        }
    }
}

/// Refuses options that do not go with this output.
fn refuse(options: &[(bool, &str)], expected: &str, output: &Path) -> Result<()> {
    match options.iter().find(|(is_given, _)| *is_given) {
        None => Ok(()),
        Some((_, name)) => {
            let remedy = format!("remove {name}, or name another file to write");
            Err(Error::new(*name, expected, output.display().to_string(), remedy))
        }
    }
}

fn scene(arguments: &Convert) -> Result<()> {
    let Convert { input, output, definitions, .. } = arguments;
    let conversion = format::convert(input, output, definitions)?;
    check_short([output])?;
    film::output::write(output, |file| file.write_all(conversion.text.as_bytes()))?;
    for note in &conversion.notes {
        complain(&format!("note: {note}"));
    }
    super::console::say(&output.display().to_string());
    Ok(())
}

/// The `.vol` file `output` of the volume file `input`.
fn voxels(input: &Path, grid: Option<&str>, output: &Path) -> Result<()> {
    check_short([&output.to_owned()])?;
    if format::is_scene(input) {
        let remedy = "name a .vol, .vdb or .nvdb to read, or a .xml, .json or .png to write";
        return Err(Error::new(input.display(), "a volume file", "a scene", remedy));
    }
    let voxels = grid::to_vol(input, grid)?;
    film::output::write(output, |file| voxels.write(file))?;
    super::console::say(&output.display().to_string());
    Ok(())
}

/// The PNG `output` of the image `input` or one of its layers, which says what the image says of its making.
fn show(input: &Path, layer: Option<&str>, output: &Path, mut display: Display) -> Result<()> {
    let image = picture::read_layer(input, layer)?;
    check_short([&output.to_owned()])?;
    let exposure = display.choose(&image.pixels).unwrap_or_default();
    let display = display.of(&image.pixels);
    let is_openexr = input.extension().is_some_and(|end| end.eq_ignore_ascii_case("exr"));
    let made = if is_openexr { film::exr::made(input)? } else { None };
    let made = provenance::shown(made.as_deref().unwrap_or("{}"), display);
    film::png::write_with(output, image.width, image.height, &image.pixels, display, Some(&made))?;
    super::console::say(&format!("{}{exposure}", output.display()));
    Ok(())
}
