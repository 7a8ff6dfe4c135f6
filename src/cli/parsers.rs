//! How values of options are read.

use crate::{
    film::accumulator::MOST_PASSES,
    format,
    settings::{Crop, options::Algorithm},
};
use clap::builder::{PathBufValueParser, PossibleValue, PossibleValuesParser, TypedValueParser};
use std::{num::NonZeroUsize, path::PathBuf, time::Duration};

/// Where the viewer tev listens.
pub(super) const VIEWER: &str = "127.0.0.1:14158";

/// Samples of every pixel, the last one excluded.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Samples {
    /// The first.
    pub first: u32,
    /// After the last.
    pub end: u32,
}

/// Frames of an animation, both included.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Frames {
    /// The first.
    pub first: u32,
    /// The last.
    pub last: u32,
}

impl Frames {
    /// Digits of their numbers in names of files.
    pub fn digits(self) -> usize {
        self.last.to_string().len().max(4)
    }
}

/// Width and height of an image in pixels, both positive.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Size {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl From<Size> for (u32, u32) {
    fn from(size: Size) -> Self {
        (size.width, size.height)
    }
}

/// No film needs more pixels on a side; a size beyond is a slip of the finger.
const LARGEST_SIDE: u32 = 65_536;

pub(super) fn positive_u32(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(0) => Err("it must be at least 1".into()),
        Ok(number) => Ok(number),
        Err(_) => Err("expected a whole number from 1 to 4294967295, such as 64".into()),
    }
}

pub(super) fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("expected a whole number from 0 to {}, such as 7", u64::MAX))
}

pub(super) fn contributions(text: &str) -> Result<u16, String> {
    let number = text.parse().ok().filter(|most| (1..=1000).contains(most));
    number.ok_or_else(|| "expected a number of contributions from 1 to 1000, such as 10".to_owned())
}

pub(super) fn batches(text: &str) -> Result<u32, String> {
    let number = text.parse().ok().filter(|batches| (2..=1000).contains(batches));
    number.ok_or_else(|| "expected a number of images from 2 to 1000, such as 16".to_owned())
}

pub(super) fn frames(text: &str) -> Result<Frames, String> {
    let expected = || "expected frames from 0 to 99999999, such as 0..47, or one, such as 12".to_owned();
    let frame = |text: &str| text.parse().ok().filter(|n| *n <= 99_999_999).ok_or_else(expected);
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let (first, last) = (frame(first)?, frame(last)?);
    if first > last {
        return Err(format!("expected the first frame before the last: {last}..{first}"));
    }
    Ok(Frames { first, last })
}

pub(super) fn samples(text: &str) -> Result<Samples, String> {
    let pair = text.split_once("..").and_then(|(first, end)| Some((first.parse().ok()?, end.parse().ok()?)));
    let pair = pair.filter(|(first, end)| first < end && u64::from(*end) <= MOST_PASSES);
    let (first, end) = pair.ok_or_else(|| {
        format!("expected two numbers from 0 to {MOST_PASSES}, the first below the second, such as 0..64 (--spp sets their number)")
    })?;
    Ok(Samples { first, end })
}

pub(super) fn address(text: &str) -> Result<String, String> {
    let port =
        text.rsplit_once(':').and_then(|(host, port)| port.parse::<u16>().ok().filter(|_| !host.is_empty()));
    port.map(|_| text.to_owned()).ok_or_else(|| format!("expected a host and a port, such as {}", VIEWER))
}

pub(super) fn fps(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|fps: &f64| (1e-6..=1e9).contains(fps));
    number.ok_or_else(|| "expected frames per second from 1e-6 to 1e9, such as 24 or 29.97".to_owned())
}

pub(super) fn relative_error(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|error: &f64| (1e-5..=1.0).contains(error));
    number.ok_or_else(|| "expected a relative error from 1e-5 to 1, such as 0.02".to_owned())
}

pub(super) fn confidence(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|confidence: &f64| (0.5..=0.9999).contains(confidence));
    number.ok_or_else(|| "expected a probability from 0.5 to 0.9999, such as 0.95".to_owned())
}

pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let threads = positive_u32(text)?;
    NonZeroUsize::new(threads as usize)
        .filter(|threads| threads.get() <= 4096)
        .ok_or_else(|| "expected at most 4096 threads".into())
}

/// Reads a name of a table as the value that it refers to.
pub(super) fn one_of<T: Copy + Send + Sync + 'static>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.iter().map(|(name, _)| *name)).try_map(|name| {
        let found = table.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value).ok_or("unknown name")
    })
}

/// An algorithm by its name, or by that of Mitsuba's.
pub(super) fn algorithm() -> impl TypedValueParser<Value = Algorithm> {
    let value = |(name, algorithm): (&'static str, Algorithm)| {
        let aliases = Algorithm::ALIASES.into_iter().filter(move |(_, of)| *of == algorithm);
        PossibleValue::new(name).aliases(aliases.map(|(alias, _)| alias))
    };
    PossibleValuesParser::new(Algorithm::NAMES.map(value)).try_map(|typed| {
        let found = Algorithm::NAMES.iter().chain(&Algorithm::ALIASES).find(|(name, _)| *name == typed);
        found.map(|(_, algorithm)| *algorithm).ok_or("unknown name")
    })
}

pub(super) fn size(text: &str) -> Result<Size, String> {
    let expected = || format!("expected WIDTHxHEIGHT in pixels from 1 to {LARGEST_SIDE}, such as 640x480");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side =
        |text: &str| text.parse().ok().filter(|side| (1..=LARGEST_SIDE).contains(side)).ok_or_else(expected);
    Ok(Size { width: side(width)?, height: side(height)? })
}

pub(super) fn crop(text: &str) -> Result<Crop, String> {
    let parts = text.split_once('+').and_then(|(pixels, corner)| {
        let (x, y) = corner.split_once('+')?;
        let Size { width, height } = size(pixels).ok()?;
        Some(Crop { corner: [x.parse().ok()?, y.parse().ok()?], size: [width, height] })
    });
    parts.ok_or_else(|| "expected WIDTHxHEIGHT+X+Y in pixels, such as 320x240+640+0".to_owned())
}

/// The same, or X,Y,WIDTH,HEIGHT.
pub(super) fn crop_of_image(text: &str) -> Result<Crop, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|part| part.parse().ok()).collect();
    match numbers.as_deref() {
        Some([x, y, width, height]) => crop(&format!("{width}x{height}+{x}+{y}")),
        _ => crop(text),
    }
}

pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let expected = || "expected a time above 0, such as 90, 90s, 5m or 1.5h".to_owned();
    let (number, seconds) = match text.char_indices().next_back() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, 1.0),
    };
    let number: f64 = number.parse().map_err(|_| expected())?;
    let duration = Duration::try_from_secs_f64(number * seconds).map_err(|_| expected())?;
    if duration.is_zero() { Err(expected()) } else { Ok(duration) }
}

pub(super) fn definition(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected name=value, such as -D res=512")?;
    if name.is_empty() || name.contains(char::is_whitespace) {
        return Err("expected a name without spaces before \"=\"".into());
    }
    Ok((name.to_owned(), value.to_owned()))
}

/// The path of a scene; - is that of standard input.
pub(super) fn scene_file() -> impl TypedValueParser<Value = PathBuf> {
    let named = |path: PathBuf| if path.as_os_str() == "-" { format::STANDARD_INPUT.into() } else { path };
    PathBufValueParser::new().map(named)
}

pub(super) fn image_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("exr" | "pfm" | "rgbe" | "hdr" | "png") => Ok(path),
        _ if crate::film::output::is_stream(&path) => Ok(path),
        _ => Err("expected a file name that ends in .exr, .pfm, .rgbe, .hdr or .png".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units() {
        for (text, seconds) in [("90", 90.0), ("90s", 90.0), ("0.5", 0.5), ("5m", 300.0), ("1.5h", 5400.0)] {
            assert_eq!(duration(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["0", "-1", "s", "", "5 m", "nan", "inf", "1e300", "5d", "5\u{b5}"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }
}
