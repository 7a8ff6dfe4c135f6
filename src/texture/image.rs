//! Image files as grids of linear colours, for textures and environments alike.

mod exr;
#[cfg(test)]
mod tests;

pub use exr::{Window, check as check_exr};

use crate::description::{
    Library,
    mend::{self, Number},
};
use crate::error::{Error, Result};
use crate::math::{Spectrum, srgb::Srgb as _, vec3};
use ::image::{
    DynamicImage, ImageDecoder, ImageFormat, ImageReader, ImageResult, Limits, codecs::hdr::HdrDecoder,
};
use std::{fs::File, io::BufReader, path::Path};

/// An image in linear sRGB, without its opacity.
#[derive(Clone, Debug)]
pub struct Image {
    /// Columns, at least 1.
    pub width: usize,
    /// Rows, at least 1.
    pub height: usize,
    /// Finite and >= 0, row by row from the top.
    pub pixels: Vec<Spectrum>,
}

/// The longest side of an image (pixels).
pub const LONGEST_SIDE: u32 = 1 << 16;

/// An image has at most this many pixels (16384 x 8192): a few bytes of header must not allocate all memory.
pub const MOST_PIXELS: usize = 1 << 27;

/// What a decoder may allocate (bytes): the most pixels, in four channels of 32 bits.
const MOST_BYTES: u64 = 16 * MOST_PIXELS as u64;

/// Reads an image file of any known format. Integer formats hold sRGB and are made linear unless `raw`; float
/// formats hold linear colours. Grey becomes three equal channels; opacity is dropped, as in Mitsuba. Channels that are
/// almost from 0 to `most` are brought there.
pub fn read(path: &Path, raw: bool, most: f32, library: &Library) -> Result<Image> {
    mended(path, read_unchecked(path, raw)?, most, library)
}

/// The same without checking the pixels, which may be negative or not finite.
pub fn read_unchecked(path: &Path, raw: bool) -> Result<Image> {
    let reader = ImageReader::open(path).and_then(ImageReader::with_guessed_format);
    let reader = reader.map_err(|error| Error::io(path, "read", &error))?;
    match reader.format() {
        Some(ImageFormat::OpenExr) => exr::read(path),
        _ => Ok(linear(decode(path, reader)?, raw)),
    }
}

type FileReader = ImageReader<BufReader<File>>;

fn decode(path: &Path, mut reader: FileReader) -> Result<DynamicImage> {
    let mut limits = Limits::no_limits();
    limits.max_image_width = Some(LONGEST_SIDE);
    limits.max_image_height = Some(LONGEST_SIDE);
    limits.max_alloc = Some(MOST_BYTES);
    let image = if reader.format() == Some(ImageFormat::Hdr) {
        decode_hdr(reader, limits)
    } else {
        reader.limits(limits);
        reader.decode()
    };
    image.map_err(|error| undecodable(path, error))
}

/// Half of all Radiance files, Mitsuba's among them, begin with `#?RGBE`, which only a lenient decoder takes.
fn decode_hdr(reader: FileReader, mut limits: Limits) -> ImageResult<DynamicImage> {
    let decoder = HdrDecoder::new_nonstrict(reader.into_inner())?;
    limits.reserve(decoder.total_bytes())?;
    let (width, height) = decoder.dimensions();
    limits.check_dimensions(width, height)?;
    DynamicImage::from_decoder(decoder)
}

/// The error for a file that is no image, or one of more pixels than are taken.
pub fn undecodable(path: &Path, error: impl std::fmt::Display) -> Error {
    let expected = format!("an image file, of at most {MOST_PIXELS} pixels and {LONGEST_SIDE} a side");
    let remedy = "give a png, jpeg, hdr, exr, bmp, tga or ppm file, or a smaller image";
    Error::new(path.display(), expected, format!("something that does not decode: {error}"), remedy)
}

fn linear(image: DynamicImage, raw: bool) -> Image {
    let is_linear = raw || matches!(image, DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_));
    let buffer = image.into_rgb32f();
    let decode = |x: f32| if is_linear { x } else { x.srgb_decoded() };
    let pixels = buffer.pixels().map(|p| vec3(decode(p[0]), decode(p[1]), decode(p[2]))).collect();
    Image { width: buffer.width() as usize, height: buffer.height() as usize, pixels }
}

/// `image` with all of its colours finite and from 0 to `most`, if it has colours and they almost are.
fn mended(path: &Path, mut image: Image, most: f32, library: &Library) -> Result<Image> {
    let remedy = "correct the image: light and reflectance must be finite and in this range in every pixel";
    if image.pixels.is_empty() {
        return Err(Error::new(path.display(), "pixels with finite colours >= 0", "no pixels", remedy));
    }
    let numbers = |visit: &mut dyn FnMut(Number)| {
        for (index, pixel) in image.pixels.iter().enumerate() {
            let at = [index % image.width, index / image.width, 0];
            for (channel, value) in pixel.to_array().into_iter().enumerate() {
                visit(Number { value, at, channel, count: 1 });
            }
        }
    };
    let place = |number: &Number| {
        let [x, y, _] = number.at;
        format!("channel {} of column {x}, row {y}", number.channel)
    };
    let file = mend::Source { path, part: "", what: "pixels", place, remedy };
    if let Some(mend) = file.mend(numbers, most, library)? {
        image.pixels.iter_mut().for_each(|pixel| *pixel = pixel.map(|number| mend.of(number)));
    }
    Ok(image)
}
