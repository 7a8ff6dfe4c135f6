//! The image file of a render: where, and what is in it.

use super::arguments::Render;
use crate::{
    cli::{console::complain, display::Display, provenance},
    error::{Error, Result},
    film::{
        self, Film,
        format::{FileKind, Format},
    },
    math::Spectrum,
    render::{Image, sums::Picture},
    scene::build::Setup,
};
use serde_json::Value;
use std::path::PathBuf;

/// The image file: where, and what is in it. The PNG is beside it.
pub(crate) struct Target {
    pub path: PathBuf,
    pub format: Format,
    /// How the PNG shows it.
    pub display: Display,
}

/// The name of an image that nobody named: biased images say so.
fn unnamed(arguments: &Render, setup: &Setup) -> PathBuf {
    let name = arguments.scene.name();
    match setup.scene.softened {
        Some(_) => format!("{}-softened", name.to_string_lossy()).into(),
        None => name,
    }
}

impl Target {
    /// The kind of file is that of the output's name, else that of the scene's film.
    pub(crate) fn new(arguments: &Render, setup: &Setup) -> Result<Self> {
        let scene = setup.film.format;
        let named = arguments.output.as_deref().and_then(|path| Some((path, path.extension()?)));
        let named =
            named.and_then(|(path, end)| Some((path, FileKind::of_extension(&end.to_string_lossy())?)));
        let (path, file) = match (named, &arguments.output) {
            (Some((path, file)), _) => (path.to_owned(), file),
            (None, Some(path)) if film::output::is_stream(path) => (path.clone(), scene.file),
            (None, Some(path)) => (path.with_extension(scene.file.extension()), scene.file),
            (None, None) => (unnamed(arguments, setup).with_extension(scene.file.extension()), scene.file),
        };
        let has_layers = !setup.integrator.layers.is_empty();
        if file != FileKind::OpenExr && (has_layers || arguments.batches.is_some()) {
            let layers = match (arguments.groups, arguments.components, has_layers) {
                (true, ..) => "of --groups",
                (_, true, _) => "of --components",
                (.., true) => "of the scene's aov or moment integrator",
                _ => "of --batches",
            };
            let expected = format!("an OpenEXR file, to hold the layers {layers}");
            let found = format!("a file that contains {}", file.holds());
            let remedy = "use a name that ends in .exr, or set the film's file_format to openexr";
            return Err(Error::new(path.display(), expected, found, remedy));
        }
        let format = scene.in_file(file);
        if format.names() != scene.names() {
            let (holds, names) = (file.holds(), format.names().concat());
            complain(&format!("warning: {} contains {holds}; {names} is written", path.display()));
        }
        Ok(Self { path, format, display: arguments.display })
    }

    /// Makes the folder that the image goes to.
    pub(crate) fn make_folder(&self) -> Result<()> {
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.exists());
        folder.map_or(Ok(()), film::output::create_folder)
    }

    /// The PNG; none beside a device or pipe.
    pub(crate) fn preview(&self) -> Option<PathBuf> {
        (!film::output::is_stream(&self.path)).then(|| self.path.with_extension("png"))
    }

    /// Chooses an exposure for `pixels`, where that is to be done; says which.
    pub(crate) fn expose(&mut self, pixels: &[Spectrum]) -> Option<String> {
        self.preview().and_then(|_| self.display.choose(pixels))
    }

    /// Where its sums are, unless the user wants them elsewhere: no other image has the same.
    pub(crate) fn sums(&self) -> PathBuf {
        let mut name = self.path.as_os_str().to_owned();
        name.push(".sums");
        name.into()
    }

    /// The same for one frame of an animation: its number before the ending.
    pub(crate) fn numbered(&self, frame: u32, digits: usize) -> Self {
        let end = self.path.extension().unwrap_or_default().to_string_lossy();
        let path = self.path.with_extension(format!("{frame:0digits$}.{end}"));
        Self { path, format: self.format, display: self.display }
    }

    /// Writes the image, and the layers that it then no longer has; and its PNG.
    /// Files that can say how they were `made` do.
    pub(crate) fn write(&self, film: &Film, image: &mut Image, made: &Value) -> Result<()> {
        let made = provenance::metadata(made, image);
        let (width, height) = (film.width as usize, film.height as usize);
        let mut channels = self.format.channels(&image.pixels, &image.alpha);
        match self.format.file {
            FileKind::OpenExr => {
                channels.append(&mut image.layers);
                film::exr::write_with(&self.path, width, height, channels, self.format, Some(&made))
            }
            FileKind::Pfm => film::raster::write_pfm(&self.path, width, height, &channels),
            FileKind::Rgbe => film::raster::write_rgbe(&self.path, width, height, &image.pixels),
        }?;
        let display = self.display.of(&image.pixels);
        let made = provenance::shown(&made, display);
        let write =
            |path: PathBuf| film::png::write_with(&path, width, height, &image.pixels, display, Some(&made));
        self.preview().map_or(Ok(()), write)
    }

    /// Writes the image so far: without alpha and layers, which are rendered at the end.
    pub(crate) fn draw(&self, film: &Film, picture: &dyn Picture, made: &Value) -> Result<()> {
        let format = Format { alpha: false, ..self.format };
        let target = Self { path: self.path.clone(), format, display: self.display };
        target.write(film, &mut picture.image(), made)
    }
}
