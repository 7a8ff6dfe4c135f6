//! The layers of an image, made once its samples are taken.

use super::primary;
use crate::{
    film::{
        Channel,
        accumulator::Accumulator,
        format::{XYZ_ROWS, planes, to_xyz},
        layer::{Content, Layer},
    },
    math::{Spectrum, Vec3},
    passes::Settings,
};
use std::time::{Duration, Instant};

/// True once alpha and layers, which come after the samples, take too long for the budget of a render that began at
/// `started`.
pub(super) fn late(settings: &Settings, started: Instant) -> impl Fn() -> bool {
    const GRACE: Duration = Duration::from_millis(100);
    let budget = settings.budget;
    move || budget.is_over(started.elapsed().saturating_sub(GRACE))
}

/// What is known of an image, for its layers.
pub(super) struct Known<'a> {
    pub pixels: &'a [Spectrum],
    pub passes: &'a Accumulator,
    pub seen: &'a primary::Seen,
}

impl Known<'_> {
    /// The channels of all `layers`. Layers that contributions are sorted into are planes from 1 on, in their order.
    pub(super) fn channels(&self, layers: &[Layer], plane: impl Fn(usize) -> Vec<Spectrum>) -> Vec<Channel> {
        let mut sorted = 0;
        let mut channels = Vec::new();
        for layer in layers {
            let values = if layer.is_sorted() {
                sorted += 1;
                planes(plane(sorted).iter().copied())
            } else {
                self.develop(layer)
            };
            let named = layer.channel_names().zip(values);
            channels.extend(named.map(|(name, values)| Channel { name, values }));
        }
        channels
    }

    /// The values of a layer, channel by channel. Variances are left out where a single pass cannot estimate them.
    fn develop(&self, layer: &Layer) -> Vec<Vec<f32>> {
        let Self { pixels, passes, seen } = self;
        match layer.content {
            Content::Surface(quantity) => seen.of(quantity),
            Content::Image => {
                let mut values = planes(pixels.iter().copied());
                values.push(seen.alpha.clone());
                values
            }
            Content::Mean => planes(pixels.iter().map(|pixel| to_xyz(*pixel))),
            Content::SecondMoment => XYZ_ROWS.iter().map(|row| passes.second_moment(*row)).collect(),
            Content::Variance => Vec3::AXES.iter().filter_map(|row| passes.variance(*row)).collect(),
            // Sorted, not developed.
            Content::Part(_) => Vec::new(),
        }
    }
}
