//! OpenEXR: the first flat layer; R G B, X Y Z or Y, of any sample type.

mod window;

pub use window::Window;

use super::{Image, LONGEST_SIDE, MOST_PIXELS, undecodable};
use crate::error::{Error, Result};
use crate::math::{Spectrum, colour::xyz_to_rgb};
use exr::{
    meta::{MetaData, header::Header},
    prelude::{ReadChannels, ReadLayers, read as reader},
};
use std::path::Path;

/// Reads the display window.
pub(super) fn read(path: &Path) -> Result<Image> {
    check(path)?;
    let image = reader()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_file(path)
        .map_err(|error| undecodable(path, error))?;
    let layer = image.layer_data;
    let window = Window::new(&image.attributes, &layer);
    let channels = &layer.channel_data.list;
    let named = |name: &str| {
        channels
            .iter()
            .find(|channel| channel.name.eq(name))
            .map(|channel| window.values(&channel.sample_data))
    };
    let pixels = if let [Some(r), Some(g), Some(b)] = ["R", "G", "B"].map(named) {
        colors(&r, &g, &b)
    } else if let [Some(x), Some(y), Some(z)] = ["X", "Y", "Z"].map(named) {
        colors(&x, &y, &z).into_iter().map(|xyz| xyz_to_rgb(xyz.as_dvec3()).as_vec3()).collect()
    } else if let Some(y) = named("Y").filter(|_| named("RY").is_none()) {
        y.into_iter().map(Spectrum::splat).collect()
    } else {
        let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
        let found = format!("the channels {}", names.join(", "));
        let remedy = "save the image with channels of these names in its first layer";
        return Err(Error::new(path.display(), "R G B, X Y Z or Y", found, remedy));
    };
    let [width, height] = window.size;
    Ok(Image { width, height, pixels })
}

/// No part of the file is larger than images may be: checked before memory is allocated for them.
pub fn check(path: &Path) -> Result<()> {
    let meta = MetaData::read_from_file(path, false).map_err(|error| undecodable(path, error))?;
    meta.headers.iter().try_for_each(|header| check_size(path, header))
}

/// The samples of all channels together must not be more than those of the largest image in R G B A.
fn check_size(path: &Path, header: &Header) -> Result<()> {
    let (layer, shown) = (header.layer_size, header.shared_attributes.display_window.size);
    let (width, height) = (layer.width().max(shown.width()), layer.height().max(shown.height()));
    let longest = LONGEST_SIDE as usize;
    let samples = width.saturating_mul(height).saturating_mul(header.channels.list.len());
    if width <= longest && height <= longest && samples <= 4 * MOST_PIXELS {
        return Ok(());
    }
    let channels = header.channels.list.len();
    Err(undecodable(path, format!("{width} x {height} pixels of {channels} channels")))
}

fn colors(a: &[f32], b: &[f32], c: &[f32]) -> Vec<Spectrum> {
    a.iter().zip(b).zip(c).map(|((a, b), c)| Spectrum::new(*a, *b, *c)).collect()
}
