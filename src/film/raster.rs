//! The two older formats that Mitsuba writes: Portable Float Map and Radiance's RGBE.

use super::{Channel, output};
use crate::{error::Result, math::Spectrum};
use image::{ImageError, codecs::hdr::HdrEncoder};
use std::{io, path::Path};

/// Writes one or three channels as a Portable Float Map: a line of text for kind, size and byte order each
/// (negative: little-endian), then rows of floats from the bottom up.
pub fn write_pfm(path: &Path, width: usize, height: usize, channels: &[Channel]) -> Result<()> {
    for channel in channels {
        output::check_size(path, width, height, channel.values.len())?;
    }
    let kind = if channels.len() == 1 { "Pf" } else { "PF" };
    output::write(path, |file| {
        write!(file, "{kind}\n{width} {height}\n-1.0\n")?;
        for pixel in (0..height).rev().flat_map(|y| y * width..(y + 1) * width) {
            for channel in channels {
                file.write_all(&channel.values[pixel].to_le_bytes())?;
            }
        }
        Ok(())
    })
}

/// Writes an image as RGBE. What is negative becomes 0: the format has no sign.
pub fn write_rgbe(path: &Path, width: usize, height: usize, pixels: &[Spectrum]) -> Result<()> {
    output::check_size(path, width, height, pixels.len())?;
    let pixels: Vec<_> =
        pixels.iter().map(|pixel| image::Rgb(pixel.max(Spectrum::ZERO).to_array())).collect();
    output::write(path, |file| HdrEncoder::new(file).encode(&pixels, width, height).map_err(plain_error))
}

/// What the system said, where it was the system.
fn plain_error(error: ImageError) -> io::Error {
    match error {
        ImageError::IoError(error) => error,
        other => io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{film::format::Format, math::vec3};

    fn pixels() -> [Spectrum; 6] {
        std::array::from_fn(|i| vec3(i as f32, 0.5 * i as f32, 0.25))
    }

    #[test]
    fn a_float_map_starts_at_the_bottom() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.pfm");
        write_pfm(&path, 3, 2, &Format::default().channels(&pixels(), &[])).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let header = b"PF\n3 2\n-1.0\n";
        assert!(bytes.starts_with(header) && bytes.len() == header.len() + 6 * 12);
        let first: Vec<f32> = bytes[header.len()..header.len() + 12]
            .chunks(4)
            .map(|b| f32::from_le_bytes(b.try_into().unwrap()))
            .collect();
        assert_eq!(first, pixels()[3].to_array());
    }

    #[test]
    fn a_radiance_file_is_read_back() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.hdr");
        write_rgbe(&path, 3, 2, &pixels()).unwrap();
        let image = image::open(&path).unwrap().to_rgb32f();
        for (pixel, read) in pixels().iter().zip(image.pixels()) {
            let error = (*pixel - Spectrum::from_array(read.0)).abs().max_element();
            assert!(error <= pixel.max_element() / 128.0, "{pixel} {read:?}");
        }
    }
}
