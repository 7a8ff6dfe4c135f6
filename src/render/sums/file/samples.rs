//! The arrays of a render by samples or time:
//!
//! | array | type, shape | is |
//! |---|---|---|
//! | `windows`, `parts` | i16 \[n\], i64 \[n, 2\] | exact sums over samples, see [`Parts`](crate::math::exact_sums::Parts): of R, G, B and the difference of the halves of each pixel, row by row, of the image and of `layers` that contributions are sorted into; then, where layers need them, of R R, R G, R B, G G, G B, B B |
//! | `camera`, `light` | f32 \[pixels, 3\] | what camera and light subpaths of the unfinished sample contributed so far, if there is one |
//! | `known` | u8 \[pixels\] | 1 where camera subpaths of it have been traced |

use super::{
    Stored,
    array::{Array, Arrays},
};
use crate::{
    film::accumulator::Accumulator,
    passes::{blocks::count_of, faults::Faults},
    render::{
        image::Image,
        sums::{Kept, Picture, Sums, samples::Samples},
    },
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::{ops::Range, time::Duration};

pub(super) const KIND: &str = "samples";

/// What is known besides the arrays.
#[derive(Deserialize, Serialize)]
struct State {
    kind: String,
    width: usize,
    height: usize,
    /// Ranges of the samples that every pixel has.
    samples: Vec<Range<u64>>,
    /// Layers that contributions are sorted into.
    #[serde(default)]
    layers: usize,
    /// Number of the unfinished sample, and how many of its blocks are done.
    unfinished: (u64, usize),
    /// Time spent (s).
    seconds: f64,
    /// What went wrong on the way.
    faults: Faults,
}

impl Picture for Sums {
    fn image(&self) -> Image {
        self.image()
    }

    fn size(&self) -> (usize, usize) {
        self.size()
    }
}

impl Kept for Sums {
    fn samples(&self) -> Samples {
        self.samples.clone()
    }

    fn store(&self) -> Stored {
        let (width, height) = self.size();
        let state = json!(State {
            kind: KIND.to_owned(),
            width,
            height,
            samples: self.samples.ranges().to_vec(),
            layers: self.accumulator.len_of_planes() / self.accumulator.len() - 1,
            unfinished: (self.sample, self.blocks),
            seconds: self.elapsed.as_secs_f64(),
            faults: self.faults.clone(),
        });
        let parts = self.accumulator.sums().flat_map(|(_, parts)| parts).map(i64::to_le_bytes);
        let windows = self.accumulator.sums().map(|(window, _)| window.to_le_bytes());
        let mut arrays =
            vec![Array::row("parts", "I64", parts).in_columns(2), Array::row("windows", "I16", windows)];
        arrays.extend(Array::of_pass(&self.pass, self.blocks > 0));
        arrays.push(Array::of_known(&self.pass, self.blocks > 0));
        Stored(state, arrays)
    }
}

/// The sums that were stored; none where arrays do not fit.
pub(super) fn sums(state: Value, arrays: &Arrays<'_>) -> Option<Sums> {
    let state: State = serde_json::from_value(state).ok()?;
    let parts = arrays.row("parts", i64::from_le_bytes)?;
    let windows = arrays.row("windows", i16::from_le_bytes)?;
    let sums = windows.into_iter().zip(parts.as_chunks().0);
    let sums: Vec<_> = sums.map(|(window, parts)| (window, *parts)).collect();
    let pixels = state.width.checked_mul(state.height).filter(|pixels| *pixels > 0)?;
    let samples = if state.samples.is_empty() { Samples::default() } else { Samples::of(state.samples)? };
    let planes = state.layers.checked_add(1)?;
    let accumulator = Accumulator::from_sums(pixels, planes, samples.halves(), &sums)?;
    let mut sums = Sums::of(accumulator, samples, state.width);
    sums.faults = state.faults;
    sums.elapsed = Duration::try_from_secs_f64(state.seconds).ok()?;
    (sums.sample, sums.blocks) = (state.unfinished.0, arrays.blocks(state.unfinished.1));
    sums.pass = arrays.pass(sums.accumulator.len_of_planes(), sums.blocks > 0)?;
    (sums.blocks < count_of(pixels)).then_some(sums)
}
