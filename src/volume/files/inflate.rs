//! Bytes packed by zlib.

use super::{Problem, Result};
use flate2::bufread::ZlibDecoder;
use std::io::Read;

/// Deflate makes no more than this of a byte.
const LARGEST_RATIO: u64 = 1032;

/// Unpacks `count` bytes into `out`.
pub(super) fn unpack(bytes: &[u8], count: u64, out: &mut Vec<u8>) -> Result<()> {
    let damaged = |found: String| Problem::damage(format!("{count} bytes packed by zlib"), found);
    if count / LARGEST_RATIO > bytes.len() as u64 {
        return Err(damaged(format!("{} packed ones, which cannot hold them", bytes.len())));
    }
    out.clear();
    let read = ZlibDecoder::new(bytes).take(count).read_to_end(out);
    match read {
        Ok(length) if length as u64 == count => Ok(()),
        Ok(length) => Err(damaged(format!("{length}"))),
        Err(error) => Err(damaged(format!("damaged ones ({error})"))),
    }
}
