//! OpenEXR images: what was estimated, channel by channel, lossless but for the rounding of its numbers.

use super::{
    Channel,
    format::{Colours, Component, Format},
    output,
};
use crate::error::{Error, Result};
use ::exr::{
    error::Error as ExrError,
    image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, write::WritableImage},
    math::Vec2,
    meta::{
        MetaData,
        attribute::{AttributeValue, Chromaticities, LineOrder, Text},
        header::{ImageAttributes, LayerAttributes},
    },
    prelude::f16,
};
use std::{io, path::Path};

/// Writes `channels` to `path`. The window of a cropped film is an image of its own, as in Mitsuba.
pub fn write(path: &Path, width: usize, height: usize, channels: Vec<Channel>, format: Format) -> Result<()> {
    write_with(path, width, height, channels, format, None)
}

/// The same, with how the image was made, as [`made`] gives it again: ASCII.
pub fn write_with(
    path: &Path,
    width: usize,
    height: usize,
    channels: Vec<Channel>,
    format: Format,
    made: Option<&str>,
) -> Result<()> {
    for channel in &channels {
        output::check_size(path, width, height, channel.values.len())?;
    }
    let list = channels.into_iter().map(|Channel { name, values }| {
        let samples = match format.component {
            Component::Float16 => FlatSamples::F16(values.into_iter().map(f16::from_f32).collect()),
            Component::Float32 => FlatSamples::F32(values),
            Component::Uint32 => FlatSamples::U32(values.into_iter().map(whole).collect()),
        };
        AnyChannel::new(name.as_str(), samples)
    });
    let list = AnyChannels::sort(list.collect());
    let layer = Layer::new((width, height), LayerAttributes::default(), ENCODING, list);
    let mut image = Image::new(ImageAttributes::with_size((width, height)), layer);
    if let Some(made) = made.and_then(Text::new_or_none) {
        image.layer_data.attributes.other.insert(MADE.into(), AttributeValue::Text(made));
    }
    image.attributes.chromaticities = (format.colours == Colours::Xyz).then_some(XYZ);
    output::write(path, |file| {
        image.write().to_buffered(file).map_err(|error| match error {
            ExrError::Io(error) => error,
            other => io::Error::other(other),
        })
    })
}

/// How the image at `path` was made, if it says so.
pub fn made(path: &Path) -> Result<Option<String>> {
    let refuse = |error: ExrError| {
        let remedy = "name an OpenEXR file that a program has written whole";
        Error::new(path.display(), "an OpenEXR image", error.to_string(), remedy)
    };
    let read = MetaData::read_from_file(path, false).map_err(refuse)?;
    let attribute =
        read.headers.first().and_then(|header| header.own_attributes.other.get(&Text::from(MADE)));
    Ok(match attribute {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    })
}

/// Name of the attribute.
const MADE: &str = "tyndall";

/// Lines from the top: in any other order the file depends on which thread is first.
const ENCODING: Encoding = Encoding { line_order: LineOrder::Increasing, ..Encoding::FAST_LOSSLESS };

/// What X, Y, Z and white are, for readers that would take them for R, G, B.
const XYZ: Chromaticities = Chromaticities {
    red: Vec2(1.0, 0.0),
    green: Vec2(0.0, 1.0),
    blue: Vec2(0.0, 0.0),
    white: Vec2(1.0 / 3.0, 1.0 / 3.0),
};

/// [0, 1] on all of the whole numbers; NaN as 0.
fn whole(value: f32) -> u32 {
    (f64::from(value) * f64::from(u32::MAX)).round() as u32
}

#[cfg(test)]
mod tests {
    use super::*;
    use ::exr::prelude::read_first_flat_layer_from_file;

    fn channel(name: &str, values: &[f32]) -> Channel {
        Channel { name: name.into(), values: values.to_vec() }
    }

    fn read(path: &Path) -> Vec<(String, FlatSamples)> {
        let layer = read_first_flat_layer_from_file(path).unwrap().layer_data;
        layer.channel_data.list.into_iter().map(|c| (c.name.to_string(), c.sample_data)).collect()
    }

    #[test]
    fn what_is_written_is_read_in_every_component_format() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        let values = [0.1, -1e-30, 7e4, 1.0, 0.25, 2.0];
        let channels = || vec![channel("R", &values), channel("n.X", &[0.5; 6])];
        let format = Format::default();
        write(&path, 3, 2, channels(), format).unwrap();
        assert_eq!(read(&path)[0], ("R".into(), FlatSamples::F32(values.to_vec())));
        assert_eq!(read(&path)[1].0, "n.X");
        write(&path, 3, 2, channels(), Format { component: Component::Float16, ..format }).unwrap();
        let halves = [0.099_975_586, -0.0, f32::INFINITY, 1.0, 0.25, 2.0].map(f16::from_f32);
        assert_eq!(read(&path)[0].1, FlatSamples::F16(halves.to_vec()));
        // What Mitsuba 3.9.1 writes for 1/4, up to the rounding of its single precision: 2^30.
        write(&path, 3, 2, channels(), Format { component: Component::Uint32, ..format }).unwrap();
        let whole = [429_496_736, 0, u32::MAX, u32::MAX, 1 << 30, u32::MAX];
        assert_eq!(read(&path)[0].1, FlatSamples::U32(whole.to_vec()));
    }

    #[test]
    fn sizes_must_fit() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        for (width, height) in [(0, 0), (2, 2), (usize::MAX, 3)] {
            assert!(write(&path, width, height, vec![channel("Y", &[1.0; 3])], Format::default()).is_err());
        }
        assert!(!path.exists());
    }
}
