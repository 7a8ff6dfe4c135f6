//! OpenEXR with all its layers: the parts of a file, and in each the channels that share a name up to the last dot.

use super::{Picture, pixel};
use crate::{
    description::suggest,
    error::{Error, Result},
    math::{Spectrum, colour::xyz_to_rgb},
    texture::image::{Window, check_exr, undecodable},
};
use exr::{
    image::{AnyChannels, FlatImage, FlatSamples},
    prelude::{ReadChannels, ReadLayers, read as reader},
};
use std::path::Path;

/// Reads the layer called `name`, or the channel of this full name; if not given, the channels without a layer.
pub(super) fn read(path: &Path, name: Option<&str>) -> Result<Picture> {
    let image = decode(path)?;
    let layers = layers(&image);
    let wanted = name.unwrap_or_default();
    let found = layers.iter().find(|layer| layer.name == wanted && layer.order().is_some());
    if let Some((layer, order)) = found.and_then(|layer| Some((layer, layer.order()?))) {
        return Ok(layer.picture(&order));
    }
    let channel = layers.iter().find_map(|layer| {
        Some((layer, layer.channels.iter().position(|(channel, _)| layer.full_name(channel) == wanted)?))
    });
    match channel {
        Some((layer, index)) if !wanted.is_empty() => Ok(layer.picture(&[index])),
        _ => Err(missing(path, name, &layers)),
    }
}

fn decode(path: &Path) -> Result<FlatImage> {
    check_exr(path)?;
    let reader = reader().no_deep_data().largest_resolution_level().all_channels().all_layers();
    let reader = reader.all_attributes().non_parallel();
    reader.from_file(path).map_err(|error| undecodable(path, error))
}

/// Channels that share a name up to the last dot.
struct Layer<'a> {
    /// Empty for channels without a dot in the only part, or in one without a name.
    name: String,
    window: Window,
    /// What follows the dot, and the values.
    channels: Vec<(String, &'a FlatSamples)>,
}

fn layers(image: &FlatImage) -> Vec<Layer<'_>> {
    let mut layers: Vec<Layer<'_>> = Vec::new();
    let several = image.layer_data.len() > 1;
    for part in &image.layer_data {
        let named = part.attributes.layer_name.as_ref().filter(|_| several).map(ToString::to_string);
        let window = Window::new(&image.attributes, part);
        let AnyChannels { list } = &part.channel_data;
        for channel in list {
            let full = channel.name.to_string();
            let (layer, suffix) = full.rsplit_once('.').unwrap_or(("", &full));
            let words = [named.as_deref().unwrap_or_default(), layer];
            let name = words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join(".");
            let value = (suffix.to_owned(), &channel.sample_data);
            match layers.iter_mut().find(|layer| layer.name == name && layer.window == window) {
                Some(layer) => layer.channels.push(value),
                None => layers.push(Layer { name, window, channels: vec![value] }),
            }
        }
    }
    layers
}

/// Sets of channels that make a pixel, in the order in which they are looked for.
const KNOWN: &[&[&str]] = &[&["R", "G", "B"], &["X", "Y", "Z"], &["U", "V"], &["Y"]];

impl Layer<'_> {
    fn full_name(&self, channel: &str) -> String {
        if self.name.is_empty() { channel.to_owned() } else { format!("{}.{channel}", self.name) }
    }

    fn index(&self, channel: &str) -> Option<usize> {
        self.channels.iter().position(|(name, _)| name == channel)
    }

    fn is(&self, channels: &[&str]) -> bool {
        channels.iter().all(|channel| self.index(channel).is_some())
    }

    /// Which of its channels make a pixel, in order; none where that is not known. A lone channel does,
    /// whatever its name. Y with differences of colour beside it (RY, BY) is no picture.
    fn order(&self) -> Option<Vec<usize>> {
        let known = KNOWN.iter().find(|known| self.is(known) && self.index("RY").is_none());
        if let Some(known) = known {
            return known.iter().map(|channel| self.index(channel)).collect();
        }
        // A is opacity where it accompanies colours, but alone it is all there is.
        (self.channels.len() == 1).then(|| vec![0])
    }

    /// The image; X, Y, Z without a layer's name are its colours in another space, in a layer they may be anything.
    fn picture(&self, order: &[usize]) -> Picture {
        let planes: Vec<Vec<f32>> =
            order.iter().map(|index| self.window.values(self.channels[*index].1)).collect();
        let values = |at: usize| {
            let mut values = [0.0; 3];
            values.iter_mut().zip(&planes).for_each(|(value, plane)| *value = plane[at]);
            pixel(&values[..planes.len()])
        };
        let is_colour = self.is_colour(order);
        let is_xyz = is_colour && self.channels[order[0]].0 == "X";
        let colour = |raw: Spectrum| if is_xyz { xyz_to_rgb(raw.as_dvec3()).as_vec3() } else { raw };
        let [width, height] = self.window.size;
        let pixels = (0..width * height).map(|at| colour(values(at))).collect();
        Picture { width, height, pixels, channels: planes.len(), is_colour }
    }

    /// True if these channels are light: R G B anywhere, X Y Z and Y where no layer is named.
    fn is_colour(&self, order: &[usize]) -> bool {
        match (order.len(), self.channels[order[0]].0.as_str()) {
            (3, "R") => true,
            (3, "X") | (1, "Y") => self.name.is_empty(),
            _ => false,
        }
    }

    /// Its name with its channels, as `depth (T)`.
    fn describe(&self) -> String {
        let channels: Vec<&str> = self.channels.iter().map(|(name, _)| name.as_str()).collect();
        match self.name.as_str() {
            "" => channels.join(" "),
            name => format!("{name} ({})", channels.join(" ")),
        }
    }
}

fn missing(path: &Path, name: Option<&str>, layers: &[Layer<'_>]) -> Error {
    let all: Vec<String> = layers.iter().map(Layer::describe).collect();
    let found = format!("the channels {}", all.join(", "));
    let names: Vec<&str> =
        layers.iter().map(|layer| layer.name.as_str()).filter(|name| !name.is_empty()).collect();
    match name {
        Some(name) => {
            let expected = format!("a layer \"{name}\" of channels R G B, X Y Z, U V, Y or one other");
            let remedy = format!("{} (or the full name of a channel)", suggest(name, "layers", &names));
            Error::new(path.display(), expected, found, remedy)
        }
        None => {
            let remedy = match names.is_empty() {
                true => "save the image with channels of these names".to_owned(),
                false => format!("choose a layer: {}", names.join(", ")),
            };
            Error::new(path.display(), "the channels R G B, X Y Z or Y, in no layer", found, remedy)
        }
    }
}
