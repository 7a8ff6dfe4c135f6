//! Pictures to compare: read from every format that renders are kept in, and shown in false colours.
//!
//! Nothing of a file is mended or refused for its values: what is negative, infinite or NaN is what an
//! instrument is there to see.

mod exr;
mod pfm;
#[cfg(test)]
mod tests;

use crate::{
    error::{Error, Result},
    film::{self, format::Format},
    math::{Spectrum, vec3},
    texture::image,
};
use colorgrad::Gradient;
use std::{fs::File, io::Read as _, path::Path};

/// An image in the linear numbers of its file.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
    /// Row by row from the top: linear sRGB, or what else the channels of a layer are. One channel fills all
    /// three places, two leave the third 0.
    pub pixels: Vec<Spectrum>,
    /// How many channels the file has for a pixel: 1, 2 or 3. Opacity is left out.
    pub channels: usize,
    /// True for light that a screen can show; false for layers of anything else, such as normals.
    pub is_colour: bool,
}

impl Picture {
    /// An image of radiance.
    pub fn new(width: usize, height: usize, pixels: Vec<Spectrum>) -> Self {
        Self { width, height, pixels, channels: 3, is_colour: true }
    }

    /// Writes it as an OpenEXR file of single precision, which [`read`] reads bit for bit.
    pub fn write(&self, path: &Path) -> Result<()> {
        let format = Format::default();
        film::exr::write(path, self.width, self.height, format.channels(&self.pixels, &[]), format)
    }

    /// An error that names the first value that is not finite, where there is one.
    pub fn check_finite(&self, path: &Path) -> Result<()> {
        let values = || (0..self.channels).flat_map(|channel| self.pixels.iter().map(move |p| p[channel]));
        let broken = values().filter(|value| !value.is_finite()).count();
        let Some(at) = self.pixels.iter().position(|pixel| !pixel.is_finite()) else { return Ok(()) };
        let (x, y) = (at % self.width, at / self.width);
        let found = format!("{} in column {x}, row {y} ({broken} such values in all)", self.pixels[at]);
        let remedy = "no measure holds for such an image: find what made these values, or render it again";
        Err(Error::new(path.display(), "finite values in all pixels", found, remedy))
    }
}

/// Reads an OpenEXR file (the channels without a layer), a float map, a Radiance file, or a PNG or any other image
/// of whole numbers, which are taken as sRGB and made linear.
pub fn read(path: &Path) -> Result<Picture> {
    read_layer(path, None)
}

/// The same for one layer of an OpenEXR file, by its name, or one channel by its full name.
pub fn read_layer(path: &Path, layer: Option<&str>) -> Result<Picture> {
    let start = start_of(path)?;
    if start == EXR_MARK {
        return exr::read(path, layer);
    }
    if let Some(name) = layer {
        let expected = format!("an OpenEXR file, to have a layer \"{name}\"");
        let remedy = "name an .exr file, or leave the layer out";
        return Err(Error::new(path.display(), expected, "a file of another format, without layers", remedy));
    }
    if start.starts_with(b"PF") || start.starts_with(b"Pf") {
        return pfm::read(path);
    }
    let image::Image { width, height, pixels } = image::read_unchecked(path, false)?;
    Ok(Picture { width, height, pixels, channels: 3, is_colour: true })
}

/// The first bytes of every OpenEXR file.
const EXR_MARK: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];

/// The first four bytes of a file, or as many as it has.
fn start_of(path: &Path) -> Result<Vec<u8>> {
    let mut start = Vec::new();
    let file = File::open(path).map_err(|error| Error::io(path, "read", &error))?;
    file.take(4).read_to_end(&mut start).map_err(|error| Error::io(path, "read", &error))?;
    Ok(start)
}

/// What represents values that are not finite: no colour of either scale.
const BROKEN: [u8; 3] = [0, 255, 0];

/// Colours (8-bit sRGB, three bytes a value) of `values`, which lie in `range` = (low, high) or are cut to it.
///
/// From low = 0 or above: black for low over red to bright yellow for high (inferno). With low < 0: blue for low,
/// nearly white for the middle, red for high; a range from -m to m shows 0 so. Infinite values are cut off as well,
/// NaN is bright green.
pub fn false_colour(values: &[f32], range: (f32, f32)) -> Vec<u8> {
    let (low, high) = range;
    let table = if low < 0.0 { colours(|t| colorgrad::preset::rd_bu().at(1.0 - t)) } else { inferno() };
    let place = |value: f32| {
        let t = (f64::from(value) - f64::from(low)) / (f64::from(high) - f64::from(low));
        // Of an empty range all that is not above it is low.
        let t = if t.is_nan() { f64::from(u8::from(value > high)) } else { t.clamp(0.0, 1.0) };
        (t * (TABLE - 1) as f64).round() as usize
    };
    values.iter().flat_map(|value| if value.is_nan() { BROKEN } else { table[place(*value)] }).collect()
}

/// Colours of a scale that are distinguished: four times as many as 8 bits show.
const TABLE: usize = 1024;

fn inferno() -> Vec<[u8; 3]> {
    let gradient = colorgrad::preset::inferno();
    colours(|t| gradient.at(t))
}

fn colours(at: impl Fn(f32) -> colorgrad::Color) -> Vec<[u8; 3]> {
    let colour = |i: usize| {
        let [r, g, b, _] = at(i as f32 / (TABLE - 1) as f32).to_rgba8();
        [r, g, b]
    };
    (0..TABLE).map(colour).collect()
}

/// A pixel of `channels` values.
fn pixel(values: &[f32]) -> Spectrum {
    match *values {
        [a] => Spectrum::splat(a),
        [a, b] => vec3(a, b, 0.0),
        [a, b, c, ..] => vec3(a, b, c),
        [] => Spectrum::ZERO,
    }
}
