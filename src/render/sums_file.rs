//! Sums in a file, in the format safetensors: named arrays behind a header of JSON, which numpy and others read too.
//!
//! | array | type, shape | is |
//! |---|---|---|
//! | `windows`, `parts` | i16 \[n\], i64 \[n, 2\] | exact sums over samples, see [`ExactSum::to_parts`]: of R, G, B and the luminance's square of each pixel, row by row; then, where layers need them, of R R, R G, R B, G G, G B, B B |
//! | `camera`, `light` | f32 \[pixels, 3\] | what camera and light subpaths of the unfinished sample contributed so far, if there is one |
//!
//! The header's entries are `tyndall`, which holds [`State`] as JSON, and a checksum of it and the arrays.

use super::{block::Pass, faults::Faults, samples::Samples, sums::Sums};
use crate::{
    error::{Error, Result},
    film::{accumulator::Accumulator, output},
    math::{Spectrum, exact_sum::ExactSum},
};
use safetensors::SafeTensors;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use std::{ops::Range, path::Path, time::Duration};
use xxhash_rust::xxh3::Xxh3;

/// The entry of the header.
const ENTRY: &str = "tyndall";
/// And that of the XXH3 of this entry and all arrays, 128 bits.
const CHECKSUM: &str = "checksum";
/// The arrays, and the types of their numbers.
const NAMES: [(&str, &str); 4] = [("parts", "I64"), ("windows", "I16"), ("camera", "F32"), ("light", "F32")];

/// What is known besides the arrays.
#[derive(Clone, Debug, Deserialize, Serialize)]
struct State {
    width: usize,
    height: usize,
    /// Ranges of the samples that every pixel has.
    samples: Vec<Range<u64>>,
    /// Number of the unfinished sample, and how many of its blocks are done.
    unfinished: (u64, usize),
    /// Time spent [s].
    seconds: f64,
    /// What went wrong on the way.
    faults: Faults,
    /// How the image is made.
    made: Value,
}

/// Writes `sums`, and how the image is `made`, to `path`.
pub fn write(path: &Path, sums: &Sums, made: &Value) -> Result<()> {
    let all = || sums.accumulator.sums().map(ExactSum::to_parts);
    let windows: Vec<u8> = all().flat_map(|(window, _)| window.to_le_bytes()).collect();
    let parts: Vec<u8> = all().flat_map(|(_, parts)| parts).flat_map(i64::to_le_bytes).collect();
    let (camera, light) = if sums.blocks > 0 { sums.pass.parts() } else { (&[][..], &[][..]) };
    let [camera, light] = [camera, light].map(bytes_of);
    let (width, height) = sums.size();
    let state = json!(State {
        width,
        height,
        samples: sums.samples.ranges().to_vec(),
        unfinished: (sums.sample, sums.blocks),
        seconds: sums.elapsed.as_secs_f64(),
        faults: sums.faults.clone(),
        made: made.clone(),
    });
    let arrays = [&parts, &windows, &camera, &light];
    let shapes = [
        vec![windows.len() / 2, 2],
        vec![windows.len() / 2],
        vec![camera.len() / 12, 3],
        vec![light.len() / 12, 3],
    ];
    let header = header(&state.to_string(), shapes, arrays);
    output::write(path, |to| {
        to.write_all(&(header.len() as u64).to_le_bytes())?;
        to.write_all(header.as_bytes())?;
        arrays.into_iter().try_for_each(|array| to.write_all(array))
    })
}

/// The header of a safetensors file, padded so that the arrays begin at a multiple of 8 bytes.
fn header(state: &str, shapes: [Vec<usize>; 4], arrays: [&Vec<u8>; 4]) -> String {
    let mut header =
        json!({ "__metadata__": { ENTRY: state, CHECKSUM: checksum(state, arrays.map(Vec::as_slice)) } });
    let mut end = 0;
    for (((name, kind), shape), array) in NAMES.into_iter().zip(shapes).zip(arrays) {
        let begin = end;
        end += array.len();
        header[name] = json!({ "dtype": kind, "shape": shape, "data_offsets": [begin, end] });
    }
    let text = header.to_string();
    format!("{text:width$}", width = text.len().next_multiple_of(8))
}

/// Reads what [`write`] wrote: the sums, and how their image is made.
pub fn read(path: &Path) -> Result<(Sums, Value)> {
    let bytes = std::fs::read(path).map_err(|error| Error::io(path, "read", &error))?;
    let refuse = |found: &str| {
        let remedy = "name a file that --sums or a checkpoint wrote; a damaged one must be rendered again";
        Error::new(path.display(), "the sums of a render", found, remedy)
    };
    let broken = |error: &dyn std::fmt::Display| {
        refuse(&format!("a file that is damaged or of another kind ({error})"))
    };
    let (_, header) = SafeTensors::read_metadata(&bytes).map_err(|error| broken(&error))?;
    let entry = |name: &str| header.metadata().as_ref().and_then(|entries| entries.get(name));
    let (Some(text), Some(wanted)) = (entry(ENTRY), entry(CHECKSUM)) else {
        return Err(refuse("arrays that another program wrote"));
    };
    let arrays = SafeTensors::deserialize(&bytes).map_err(|error| broken(&error))?;
    let array = |(name, _): (&str, &str)| {
        arrays.tensor(name).map(|array| array.data()).map_err(|error| broken(&error))
    };
    let [parts, windows, camera, light] = NAMES.map(array);
    let arrays = [parts?, windows?, camera?, light?];
    if checksum(text, arrays) != *wanted {
        return Err(refuse("a damaged file: its checksum is another"));
    }
    let state: State = serde_json::from_str(text).map_err(|error| broken(&error))?;
    let made = state.made.clone();
    let sums = sums_of(state, arrays);
    Ok((sums.ok_or_else(|| refuse("arrays that do not fit each other"))?, made))
}

fn sums_of(state: State, [parts, windows, camera, light]: [&[u8]; 4]) -> Option<Sums> {
    let parts = parts.as_chunks().0.iter().map(|part| i64::from_le_bytes(*part));
    let parts: Vec<i64> = parts.collect();
    let windows = windows.as_chunks().0.iter().map(|window| i16::from_le_bytes(*window));
    let sums = windows.zip(parts.as_chunks().0).map(|(window, parts)| ExactSum::from_parts(window, *parts));
    let sums: Vec<ExactSum> = sums.collect();
    let pixels = state.width.checked_mul(state.height).filter(|pixels| *pixels > 0)?;
    let samples = if state.samples.is_empty() { Samples::default() } else { Samples::of(state.samples)? };
    let accumulator = Accumulator::from_sums(pixels, samples.halves(), &sums)?;
    let mut sums = Sums::of(accumulator, samples, state.width);
    sums.faults = state.faults;
    sums.elapsed = Duration::try_from_secs_f64(state.seconds).ok()?;
    if state.unfinished.1 > 0 {
        let [camera, light] = [camera, light].map(spectra_of);
        if camera.len() != pixels || light.len() != pixels || state.unfinished.1 >= sums.division().count() {
            return None;
        }
        (sums.sample, sums.blocks) = state.unfinished;
        sums.pass = Pass::of(camera, light);
    }
    Some(sums)
}

fn bytes_of(spectra: &[Spectrum]) -> Vec<u8> {
    spectra.iter().flat_map(|spectrum| spectrum.to_array()).flat_map(f32::to_le_bytes).collect()
}

fn spectra_of(bytes: &[u8]) -> Vec<Spectrum> {
    let values: Vec<f32> = bytes.as_chunks().0.iter().map(|value| f32::from_le_bytes(*value)).collect();
    values.as_chunks().0.iter().map(|value| Spectrum::from_array(*value)).collect()
}

fn checksum(text: &str, arrays: [&[u8]; 4]) -> String {
    let mut sum = Xxh3::new();
    sum.update(text.as_bytes());
    arrays.into_iter().for_each(|array| sum.update(array));
    format!("{:032x}", sum.digest128())
}
