//! The arrays of a render to a precision, of which `.0` and `.1` are those of its two halves. Camera and light of `layers`
//! that contributions are sorted into follow those of the image:
//!
//! | array | type, shape | is |
//! |---|---|---|
//! | `camera_sums.N`, `light_sums.N` | f64 \[pixels, 3\] | sums over passes of what camera and light subpaths contributed, row by row |
//! | `squares.N` | f64 \[pixels, 3\] | sums over passes of the squares of both together |
//! | `errors.N` | f64 \[pixels\] | squared relative errors as estimated last |
//! | `content.N` | u8 \[pixels\] | 1 where this half says that the pixel has converged |
//! | `camera_means.N` | f64 \[pixels, 3\] | means of camera subpaths, where the other half says so |
//! | `light_means.N` | f64 \[pixels, 3\] | means of light subpaths, once the other half says so of all pixels |
//! | `samples` | u32 \[pixels\] | samples taken |
//! | `camera`, `light` | f32 \[pixels, 3\] | what camera and light subpaths of the unfinished pass contributed so far, if there is one |
//! | `known` | u8 \[pixels\] | 1 where camera subpaths of it have been traced |

use super::{
    Stored,
    array::{Array, Arrays},
};
use crate::{
    math::DVec3,
    passes::{blocks::count_of, faults::Faults},
    render::{
        image::{Image, Precision},
        sums::{Halves, Kept, Picture, half::Half, samples::Samples},
    },
};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::time::Duration;

pub(super) const KIND: &str = "adaptive";

/// What is known besides the arrays.
#[derive(Deserialize, Serialize)]
struct State {
    kind: String,
    width: usize,
    height: usize,
    precision: Precision,
    /// Passes of each half, and up to the next check.
    passes: [u64; 2],
    goal: u64,
    /// Mean luminances of each half's image; 0 before they are known.
    means: [f64; 2],
    /// Layers that contributions are sorted into.
    #[serde(default)]
    layers: usize,
    /// Blocks done of the unfinished pass.
    blocks: usize,
    /// Time spent (s).
    seconds: f64,
    /// What went wrong on the way.
    faults: Faults,
}

impl Picture for Halves {
    fn image(&self) -> Image {
        self.image()
    }

    fn size(&self) -> (usize, usize) {
        self.size()
    }
}

impl Kept for Halves {
    fn samples(&self) -> Samples {
        Samples::from(0..self.passes())
    }

    fn store(&self) -> Stored {
        let (width, height) = self.size();
        let state = json!(State {
            kind: KIND.to_owned(),
            width,
            height,
            precision: self.precision,
            passes: self.halves.each_ref().map(|half| half.passes),
            goal: self.goal,
            means: self.halves.each_ref().map(|half| half.mean),
            layers: self.halves[0].camera.len() / (width * height) - 1,
            blocks: self.blocks,
            seconds: self.elapsed.as_secs_f64(),
            faults: self.faults.clone(),
        });
        // Wide numbers first, so that all stand where such numbers may.
        let halves = || self.halves.iter().enumerate();
        let mut arrays: Vec<Array> = halves().flat_map(|(index, half)| stored(index, half)).collect();
        arrays.push(Array::row("samples", "U32", self.samples.iter().map(|n| n.to_le_bytes())));
        arrays.extend(Array::of_pass(&self.pass, self.blocks > 0));
        arrays.extend(halves().map(|(index, half)| {
            let content = half.content.iter().map(|content| [u8::from(*content)]);
            Array::row(&format!("content.{index}"), "U8", content)
        }));
        arrays.push(Array::of_known(&self.pass, self.blocks > 0));
        Stored(state, arrays)
    }
}

/// Arrays of a half's wide numbers.
fn stored(index: usize, half: &Half) -> Vec<Array> {
    let name = |name: &str| format!("{name}.{index}");
    let ended = half.ended.iter().map(|mean| mean.as_ref().unwrap_or(&DVec3::ZERO));
    let mut arrays = vec![
        Array::vectors(&name("camera_sums"), &half.camera),
        Array::vectors(&name("light_sums"), &half.light),
        Array::vectors(&name("squares"), &half.squares),
        Array::row(&name("errors"), "F64", half.errors.iter().map(|error| error.to_le_bytes())),
        Array::vectors(&name("camera_means"), ended),
    ];
    arrays.extend(half.ended_light.as_ref().map(|light| Array::vectors(&name("light_means"), light)));
    arrays
}

/// The halves that were stored; none where arrays do not fit.
pub(super) fn halves(state: Value, arrays: &Arrays<'_>) -> Option<Halves> {
    let state: State = serde_json::from_value(state).ok()?;
    let pixels = state.width.checked_mul(state.height).filter(|pixels| *pixels > 0)?;
    let half = |index: usize| half(index, &state, pixels, arrays);
    let mut halves = [half(0)?, half(1)?];
    let contents = halves.each_ref().map(|half| half.content.clone());
    for (half, other) in halves.iter_mut().zip(contents.iter().rev()) {
        // The other half ended them.
        half.ended
            .iter_mut()
            .zip(other.iter().cycle())
            .filter(|(_, content)| !**content)
            .for_each(|(mean, _)| *mean = None);
    }
    let mut found = Halves::of(halves, state.precision, state.goal, state.width);
    found.samples = arrays.row("samples", u32::from_le_bytes).filter(|samples| samples.len() == pixels)?;
    found.faults = state.faults;
    found.elapsed = Duration::try_from_secs_f64(state.seconds).ok()?;
    found.blocks = arrays.blocks(state.blocks);
    found.pass = arrays.pass(found.halves[0].camera.len(), found.blocks > 0)?;
    (found.blocks < count_of(pixels)).then_some(found)
}

fn half(index: usize, state: &State, pixels: usize, arrays: &Arrays<'_>) -> Option<Half> {
    let name = |name: &str| format!("{name}.{index}");
    let planes = pixels.checked_mul(state.layers.checked_add(1)?)?;
    let vectors = |array: &str| arrays.vectors(&name(array), planes);
    let errors = arrays.row(&name("errors"), f64::from_le_bytes)?;
    let content = arrays.row(&name("content"), |byte: [u8; 1]| byte[0] == 1)?;
    let fits = errors.len() == pixels && content.len() == pixels;
    fits.then_some(Half {
        passes: state.passes[index],
        mean: state.means[index],
        camera: vectors("camera_sums")?,
        light: vectors("light_sums")?,
        squares: arrays.vectors(&name("squares"), pixels)?,
        ended: vectors("camera_means")?.into_iter().map(Some).collect(),
        ended_light: vectors("light_means"),
        errors,
        content,
    })
}
