//! Portable Float Maps: a line of text each for kind, size and scale, then rows of floats from the bottom up.

use super::{Picture, pixel};
use crate::{
    error::{Error, Result},
    texture::image::{LONGEST_SIDE, MOST_PIXELS},
};
use std::path::Path;

/// What the lines of text say.
struct Header {
    /// 3 for "PF", 1 for "Pf".
    channels: usize,
    width: usize,
    height: usize,
    /// All values are multiplied by its size, as Mitsuba does; negative: little-endian.
    scale: f32,
}

/// Reads a file.
pub(super) fn read(path: &Path) -> Result<Picture> {
    let bytes = std::fs::read(path).map_err(|error| Error::io(path, "read", &error))?;
    let (header, data) = header(&bytes).ok_or_else(|| broken(path, "another beginning".into()))?;
    let Header { channels, width, height, scale } = header;
    let needed = 4 * channels * width * height;
    if data.len() != needed {
        return Err(broken(path, format!("{} bytes after it for {width} x {height} pixels", data.len())));
    }
    let number = |bytes: &[u8]| {
        let bytes = [bytes[0], bytes[1], bytes[2], bytes[3]];
        scale.abs() * if scale < 0.0 { f32::from_le_bytes(bytes) } else { f32::from_be_bytes(bytes) }
    };
    let values: Vec<f32> = data.chunks_exact(4).map(number).collect();
    let rows = values.chunks_exact(channels * width).rev();
    let pixels = rows.flat_map(|row| row.chunks_exact(channels)).map(pixel).collect();
    Ok(Picture { width, height, pixels, channels, is_colour: true })
}

/// The header, and what comes after the one white space that ends it.
fn header(bytes: &[u8]) -> Option<(Header, &[u8])> {
    let mut rest = bytes;
    let mut word = || {
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = rest[start..].iter().take(32).position(u8::is_ascii_whitespace)?;
        let word = std::str::from_utf8(&rest[start..start + length]).ok()?;
        rest = &rest[start + length + 1..];
        Some(word)
    };
    let channels = match word()? {
        "PF" => 3,
        "Pf" => 1,
        _ => return None,
    };
    let (width, height): (usize, usize) = (word()?.parse().ok()?, word()?.parse().ok()?);
    let scale: f32 = word()?.parse().ok()?;
    let sides = 1..=LONGEST_SIDE as usize;
    let fits = sides.contains(&width) && sides.contains(&height) && width * height <= MOST_PIXELS;
    (fits && scale.is_finite() && scale != 0.0).then_some((Header { channels, width, height, scale }, rest))
}

fn broken(path: &Path, found: String) -> Error {
    let expected = format!(
        "a float map: PF or Pf, width and height up to {LONGEST_SIDE} (at most {MOST_PIXELS} pixels), a scale, \
         and 4 bytes a value"
    );
    Error::new(path.display(), expected, found, "write the file again; it may have been cut off")
}
