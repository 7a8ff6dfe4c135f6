//! Independent images of one scene as one: their mean, its standard error, and each of them.

use crate::{
    film::{
        Channel,
        format::Format,
        layer::{Content, Layer},
        noise::Noise,
    },
    math::DVec3,
    passes::faults::Faults,
    render::image::Image,
};
use std::time::Duration;

impl Image {
    /// The mean of `images` of one film, each rendered with a seed of its own.
    ///
    /// Its layers are those of the images (`layers`), then `standard_error.*`, the estimated standard error of the mean
    /// in every colour of `format`, and `batch.0.*`, `batch.1.*` and so on, the images themselves.
    pub fn mean_of(images: &[Self], layers: &[Layer], format: Format) -> Self {
        let count = images.len() as f64;
        let colours = Format { alpha: false, ..format };
        let batches: Vec<_> = images.iter().map(|image| colours.channels(&image.pixels, &[])).collect();
        let mut channels = mean_layers(images, layers);
        let errors = (0..batches[0].len()).map(|c| Channel {
            name: format!("standard_error.{}", batches[0][c].name),
            values: merged(&planes(&batches, c), standard_error),
        });
        channels.extend(errors);
        for (k, batch) in batches.into_iter().enumerate() {
            let named = |channel: Channel| Channel { name: format!("batch.{k}.{}", channel.name), ..channel };
            channels.extend(batch.into_iter().map(named));
        }
        let mean_pixel = |i: usize| {
            let sum: DVec3 = images.iter().map(|image| image.pixels[i].as_dvec3()).sum();
            (sum / count).as_vec3()
        };
        let alphas: Vec<_> = images.iter().map(|image| &image.alpha[..]).collect();
        let noises: Option<Vec<_>> =
            images.iter().map(|image| Some((1.0 / (count * count), image.noise?))).collect();
        Self {
            pixels: (0..images[0].pixels.len()).map(mean_pixel).collect(),
            samples_per_pixel: images.iter().map(|image| image.samples_per_pixel).sum(),
            unfinished: images.iter().map(|image| image.unfinished).sum(),
            elapsed: images.iter().map(|image| image.elapsed).sum::<Duration>(),
            noise: noises.map(|noises| Noise::sum(noises.into_iter())),
            alpha: merged(&alphas, mean),
            layers: channels,
            reached: None,
            faults: images.iter().fold(Faults::default(), |mut all, image| {
                all.merge(&image.faults);
                all
            }),
        }
    }
}

/// The means of the images' own layers; a variance of the image is that much smaller for the mean.
fn mean_layers(images: &[Image], layers: &[Layer]) -> Vec<Channel> {
    let variances = layers.iter().filter(|layer| layer.content == Content::Variance);
    let variances: Vec<String> = variances.flat_map(Layer::channel_names).collect();
    let lists: Vec<_> = images.iter().map(|image| image.layers.clone()).collect();
    let mean = |c: usize| {
        let name = lists[0][c].name.clone();
        let mut values = merged(&planes(&lists, c), mean);
        if variances.contains(&name) {
            values.iter_mut().for_each(|value| *value /= images.len() as f32);
        }
        Channel { name, values }
    };
    (0..lists[0].len()).map(mean).collect()
}

/// Channel `c` of every image.
fn planes(images: &[Vec<Channel>], c: usize) -> Vec<&[f32]> {
    images.iter().map(|channels| &channels[c].values[..]).collect()
}

/// `merge` applied to the values of the planes at each position.
fn merged(planes: &[&[f32]], merge: fn(&[f64]) -> f64) -> Vec<f32> {
    let at = |i: usize| merge(&planes.iter().map(|plane| f64::from(plane[i])).collect::<Vec<_>>()) as f32;
    (0..planes[0].len()).map(at).collect()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Of the mean of two or more independent values.
fn standard_error(values: &[f64]) -> f64 {
    let (mean, count) = (mean(values), values.len() as f64);
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (squares / (count - 1.0) / count).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::vec3;

    #[test]
    fn the_mean_its_error_and_every_image() {
        let images = [1.0, 3.0, 5.0].map(|value| Image {
            pixels: vec![vec3(value, 2.0, 0.0)],
            samples_per_pixel: 4,
            unfinished: 0.0,
            elapsed: Duration::from_secs(1),
            noise: Some(Noise { error: 0.3, carriers: 5.0 }),
            alpha: vec![value / 10.0],
            layers: ["depth.T", "variance.R"]
                .map(|name| Channel { name: name.into(), values: vec![value] })
                .to_vec(),
            reached: None,
            faults: Faults::default(),
        });
        let layers = [Layer { name: "variance".into(), content: Content::Variance }];
        let all = Image::mean_of(&images, &layers, Format::default());
        assert_eq!((&all.pixels[..], all.samples_per_pixel), (&[vec3(3.0, 2.0, 0.0)][..], 12));
        assert!(
            (all.noise.unwrap().error - 0.3 / 3f64.sqrt()).abs() < 1e-12 && (all.alpha[0] - 0.3).abs() < 1e-6
        );
        let value = |name: &str| all.layers.iter().find(|layer| layer.name == name).unwrap().values[0];
        // Sample variance 4, of the mean a third of it.
        assert!((value("standard_error.R") - (4.0f32 / 3.0).sqrt()).abs() < 1e-6);
        assert_eq!((value("standard_error.G"), value("batch.0.R"), value("batch.2.R")), (0.0, 1.0, 5.0));
        assert_eq!((value("depth.T"), value("variance.R"), all.layers.len()), (3.0, 1.0, 2 + 3 + 9));
    }
}
