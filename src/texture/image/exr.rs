//! OpenEXR: the first flat layer; R G B, X Y Z or Y, of any sample type.

use super::{Image, LONGEST_SIDE, MOST_PIXELS, undecodable};
use crate::error::{Error, Result};
use crate::math::{Spectrum, colour::xyz_to_rgb};
use exr::{
    image::{AnyChannel, FlatSamples},
    meta::{MetaData, header::Header},
    prelude::{ReadChannels, ReadLayers, read as reader},
};
use std::path::Path;

/// Reads the data window, as Mitsuba does; the display window is ignored.
pub(super) fn read(path: &Path) -> Result<Image> {
    check(path)?;
    let layer = reader()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_file(path)
        .map_err(|error| undecodable(path, error))?
        .layer_data;
    let channels = &layer.channel_data.list;
    let named = |name: &str| channels.iter().find(|channel| channel.name.eq(name));
    let pixels = if let [Some(r), Some(g), Some(b)] = ["R", "G", "B"].map(named) {
        colors(r, g, b)
    } else if let [Some(x), Some(y), Some(z)] = ["X", "Y", "Z"].map(named) {
        colors(x, y, z).into_iter().map(|xyz| xyz_to_rgb(xyz.as_dvec3()).as_vec3()).collect()
    } else if let Some(y) = named("Y").filter(|_| named("RY").is_none()) {
        y.sample_data.values_as_f32().map(Spectrum::splat).collect()
    } else {
        let names: Vec<_> = channels.iter().map(|channel| channel.name.to_string()).collect();
        let found = format!("the channels {}", names.join(", "));
        let remedy = "save the image with channels of these names in its first layer";
        return Err(Error::new(path.display(), "R G B, X Y Z or Y", found, remedy));
    };
    Ok(Image { width: layer.size.width(), height: layer.size.height(), pixels })
}

/// No part of the file is larger than images may be: checked before memory is allocated for them.
pub fn check(path: &Path) -> Result<()> {
    let meta = MetaData::read_from_file(path, false).map_err(|error| undecodable(path, error))?;
    meta.headers.iter().try_for_each(|header| check_size(path, header))
}

/// The samples of all channels together must not be more than those of the largest image in R G B A.
fn check_size(path: &Path, header: &Header) -> Result<()> {
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let longest = LONGEST_SIDE as usize;
    let samples = width.saturating_mul(height).saturating_mul(header.channels.list.len());
    if width <= longest && height <= longest && samples <= 4 * MOST_PIXELS {
        return Ok(());
    }
    let channels = header.channels.list.len();
    Err(undecodable(path, format!("{width} x {height} pixels of {channels} channels")))
}

fn colors(
    a: &AnyChannel<FlatSamples>,
    b: &AnyChannel<FlatSamples>,
    c: &AnyChannel<FlatSamples>,
) -> Vec<Spectrum> {
    let [a, b, c] = [a, b, c].map(|channel| channel.sample_data.values_as_f32());
    a.zip(b).zip(c).map(|((a, b), c)| Spectrum::new(a, b, c)).collect()
}
