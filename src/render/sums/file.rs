//! What a render knows in a file, in the format safetensors: named arrays behind a header of JSON, which numpy and others
//! read too. [`samples`] and [`adaptive`] say which arrays.
//!
//! The header's entries are `tyndall`, a JSON object with `kind`, how the image is `made` and what is known besides the
//! arrays, and a checksum of it and the arrays.

mod adaptive;
mod array;
mod samples;

use super::{AnySums, Kept};
use crate::{
    error::{Error, Result},
    film::output,
};
use array::{Array, Arrays};
use safetensors::SafeTensors;
use serde_json::{Value, json};
use std::{fs::File, io::Read as _, path::Path};
use xxhash_rust::xxh3::Xxh3;

/// The entry of the header.
const ENTRY: &str = "tyndall";
/// And that of the XXH3 of this entry and all arrays, 128 bits.
const CHECKSUM: &str = "checksum";
/// How the header begins, after its length in eight bytes.
const BEGIN: &[u8] = br#"{"__metadata__":{"tyndall":"#;

/// What a file holds: a JSON object and arrays.
pub struct Stored(Value, Vec<Array>);

/// Writes `sums`, and how the image is `made`, to `path`.
pub fn write(path: &Path, sums: &dyn Kept, made: &Value) -> Result<()> {
    let Stored(mut state, arrays) = sums.store();
    state["made"] = made.clone();
    let header = header(&state.to_string(), &arrays);
    output::write(path, |to| {
        to.write_all(&(header.len() as u64).to_le_bytes())?;
        to.write_all(header.as_bytes())?;
        arrays.iter().try_for_each(|array| to.write_all(&array.bytes))
    })
}

/// The header of a safetensors file, padded so that the arrays begin at a multiple of 8 bytes.
fn header(state: &str, arrays: &[Array]) -> String {
    let sum = checksum(state, arrays.iter().map(|array| array.bytes.as_slice()));
    let mut header = json!({ "__metadata__": { ENTRY: state, CHECKSUM: sum } });
    let mut end = 0;
    for Array { name, kind, shape, bytes } in arrays {
        let begin = end;
        end += bytes.len();
        header[name] = json!({ "dtype": kind, "shape": shape, "data_offsets": [begin, end] });
    }
    let text = header.to_string();
    format!("{text:width$}", width = text.len().next_multiple_of(8))
}

/// True if a file begins as [`write()`] begins one.
pub fn is_one(path: &Path) -> bool {
    let mut begin = [0; 8 + BEGIN.len()];
    path.is_file()
        && File::open(path).and_then(|mut file| file.read_exact(&mut begin)).is_ok()
        && begin.ends_with(BEGIN)
}

/// Reads what [`write()`] wrote: the sums, and how their image is made.
pub fn read(path: &Path) -> Result<(AnySums, Value)> {
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
    let arrays = Arrays::of(SafeTensors::deserialize(&bytes).map_err(|error| broken(&error))?);
    if checksum(text, arrays.in_order()) != *wanted {
        return Err(refuse("a damaged file: its checksum is another"));
    }
    let mut state: Value = serde_json::from_str(text).map_err(|error| broken(&error))?;
    let made = state["made"].take();
    let found = match state["kind"].as_str() {
        Some(samples::KIND) => samples::sums(state, &arrays).map(AnySums::Samples),
        Some(adaptive::KIND) => adaptive::halves(state, &arrays).map(AnySums::Adaptive),
        _ => None,
    };
    Ok((found.ok_or_else(|| refuse("arrays that do not fit each other"))?, made))
}

fn checksum<'a>(text: &str, arrays: impl Iterator<Item = &'a [u8]>) -> String {
    let mut sum = Xxh3::new();
    sum.update(text.as_bytes());
    arrays.for_each(|array| sum.update(array));
    format!("{:032x}", sum.digest128())
}
