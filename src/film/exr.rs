//! OpenEXR images: what was estimated, in 32-bit floats, linear sRGB.

use super::output;
use crate::{error::Result, math::Spectrum};
use ::exr::{
    error::Error as ExrError,
    image::{Image, SpecificChannels, write::WritableImage},
    math::Vec2,
};
use std::{io, path::Path};

/// Writes `pixels` (row-major, top row first) to `path` with the channels R, G, B, lossless.
pub fn write(path: &Path, width: usize, height: usize, pixels: &[Spectrum]) -> Result<()> {
    output::check_size(path, width, height, pixels)?;
    let channels = SpecificChannels::rgb(|Vec2(x, y)| {
        let Spectrum { x: red, y: green, z: blue } = pixels[y * width + x];
        (red, green, blue)
    });
    let image = Image::from_channels((width, height), channels);
    output::write(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            ExrError::Io(error) => error,
            other => io::Error::other(other),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;
    use ::exr::prelude::read_first_rgba_layer_from_file;

    #[test]
    fn what_is_written_is_read_to_the_last_bit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        let pixels: Vec<_> = (0..6).map(|i| vec3(i as f32, 0.1 * i as f32, -1e-30)).collect();
        write(&path, 3, 2, &pixels).unwrap();
        let image = read_first_rgba_layer_from_file(
            &path,
            |size, _| (size.width(), vec![Spectrum::ZERO; size.area()]),
            |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = vec3(r, g, b);
            },
        );
        assert_eq!(image.unwrap().layer_data.channel_data.pixels, (3, pixels));
    }

    #[test]
    fn sizes_must_fit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        for (width, height) in [(0, 0), (2, 2), (usize::MAX, 3)] {
            assert!(write(&path, width, height, &[Spectrum::ONE; 3]).is_err());
        }
        assert!(!path.exists());
    }
}
