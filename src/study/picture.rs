//! Images read back as they were written, and written for a study.

use crate::{
    error::{Error, Result},
    film::{exr, format::Format},
    math::{Spectrum, vec3},
};
use ::exr::prelude::{FlatSamples, read_first_flat_layer_from_file};
use std::path::Path;

/// An image of radiance, whatever numbers it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Row by row from the top.
    pub pixels: Vec<Spectrum>,
}

/// Reads an OpenEXR file or a Portable Float Map.
pub fn read(path: &Path) -> Result<Picture> {
    match path.extension().is_some_and(|end| end.eq_ignore_ascii_case("pfm")) {
        true => read_pfm(path),
        false => read_exr(path),
    }
}

fn refuse(path: &Path, found: impl Into<String>) -> Error {
    let expected = "an OpenEXR file with channels R, G, B, or a float map (.pfm)";
    Error::new(path.display(), expected, found, "give an image that tyndall render wrote, for example")
}

fn read_exr(path: &Path) -> Result<Picture> {
    let image = read_first_flat_layer_from_file(path).map_err(|error| refuse(path, error.to_string()))?;
    let (width, height) = (image.layer_data.size.width(), image.layer_data.size.height());
    let channels = &image.layer_data.channel_data.list;
    let named = |name: &str| channels.iter().find(|c| c.name.to_string() == name).map(|c| &c.sample_data);
    let values = |samples: &FlatSamples| -> Vec<f32> { samples.values_as_f32().collect() };
    let missing = || {
        let names: Vec<String> = channels.iter().map(|c| c.name.to_string()).collect();
        refuse(path, format!("the channels {}", names.join(", ")))
    };
    let [r, g, b] = match (named("R"), named("G"), named("B")) {
        (Some(r), Some(g), Some(b)) => [r, g, b].map(values),
        _ => {
            let grey = named("Y").ok_or_else(missing)?;
            std::array::from_fn(|_| values(grey))
        }
    };
    let pixels = r.iter().zip(&g).zip(&b).map(|((r, g), b)| vec3(*r, *g, *b)).collect();
    Ok(Picture { width, height, pixels })
}

fn read_pfm(path: &Path) -> Result<Picture> {
    let bytes = std::fs::read(path).map_err(|error| Error::io(path, "read", &error))?;
    parse_pfm(&bytes).ok_or_else(|| refuse(path, "a float map that is none, or not whole"))
}

/// A line of text each for kind, size and byte order (negative: little-endian), then rows from the bottom up.
fn parse_pfm(bytes: &[u8]) -> Option<Picture> {
    let mut lines = bytes.splitn(4, |byte| *byte == b'\n');
    let mut line = || std::str::from_utf8(lines.next()?).ok().map(str::trim);
    let channels = match line()? {
        "PF" => 3,
        "Pf" => 1,
        _ => return None,
    };
    let (width, height) = line()?.split_once(' ')?;
    let (width, height): (usize, usize) = (width.parse().ok()?, height.trim().parse().ok()?);
    let little = line()?.parse::<f64>().ok()? < 0.0;
    let numbers = lines.next()?.as_chunks::<4>().0;
    let row = width.checked_mul(channels)?;
    if row == 0 || height == 0 || numbers.len() != row.checked_mul(height)? {
        return None;
    }
    let value =
        |bytes: &[u8; 4]| if little { f32::from_le_bytes(*bytes) } else { f32::from_be_bytes(*bytes) };
    let pixel =
        |pixel: &[[u8; 4]]| vec3(value(&pixel[0]), value(&pixel[channels / 2]), value(&pixel[channels - 1]));
    let pixels = numbers.chunks(row).rev().flat_map(|row| row.chunks(channels).map(pixel)).collect();
    Some(Picture { width, height, pixels })
}

/// Writes an OpenEXR file of single precision, which [`read`] reads bit for bit.
pub fn write(path: &Path, picture: &Picture) -> Result<()> {
    let format = Format::default();
    exr::write(path, picture.width, picture.height, format.channels(&picture.pixels, &[]), format)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::raster;

    #[test]
    fn what_is_written_is_read() {
        let folder = tempfile::tempdir().unwrap();
        let pixels = (0..6).map(|i| vec3(i as f32, -0.5, f32::INFINITY)).collect();
        let picture = Picture { width: 3, height: 2, pixels };
        write(&folder.path().join("a.exr"), &picture).unwrap();
        assert_eq!(read(&folder.path().join("a.exr")).unwrap(), picture);
        let channels = Format::default().channels(&picture.pixels, &[]);
        raster::write_pfm(&folder.path().join("a.pfm"), 3, 2, &channels).unwrap();
        assert_eq!(read(&folder.path().join("a.pfm")).unwrap(), picture);
        std::fs::write(folder.path().join("b.pfm"), b"PF\n3 2\n-1\nfew").unwrap();
        for name in ["b.pfm", "c.pfm", "c.exr"] {
            assert!(read(&folder.path().join(name)).is_err(), "{name}");
        }
    }
}
