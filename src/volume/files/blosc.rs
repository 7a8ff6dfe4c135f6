//! Frames of the Blosc compressor, version 1, as OpenVDB and NanoVDB write them: LZ4 with bytes of equal significance
//! put together. The layout is that of c-blosc's README_CHUNK_FORMAT; no decoder of it in Rust is well kept.

use super::{Problem, Result, value::array};

/// Length of a frame's header (bytes).
const HEADER: usize = 16;

/// Flags: bytes are shuffled; they are as they were; bits are shuffled; blocks are in one piece.
const SHUFFLED: u8 = 1;
const STORED: u8 = 2;
const BIT_SHUFFLED: u8 = 4;
const WHOLE: u8 = 16;

/// The three highest bits of the flags: the compressor.
const LZ4: u8 = 1;

/// Values of more bytes are not split, nor are blocks with fewer values.
const MOST_PIECES: usize = 16;
const LEAST_VALUES: usize = 128;

/// LZ4 makes no more than this of a byte.
const LARGEST_RATIO: usize = 256;

struct Frame<'a> {
    flags: u8,
    /// Bytes of a value.
    width: usize,
    /// Bytes of a block, but perhaps of the last.
    block: usize,
    bytes: &'a [u8],
}

fn damaged(found: impl Into<String>) -> Problem {
    Problem::damage("values packed by Blosc", found)
}

/// Unpacks a frame that holds `count` bytes into `out`.
pub(super) fn unpack(bytes: &[u8], count: usize, out: &mut Vec<u8>) -> Result<()> {
    let (frame, length) = Frame::new(bytes)?;
    if length != count || count / LARGEST_RATIO > bytes.len() {
        return Err(damaged(format!("{length} bytes in {}, not {count}", bytes.len())));
    }
    out.clear();
    if frame.flags & STORED != 0 {
        let stored = bytes.get(HEADER..HEADER + count);
        out.extend_from_slice(stored.ok_or_else(|| damaged("fewer bytes than stated"))?);
        return Ok(());
    }
    out.resize(count, 0);
    let mut scratch = vec![0; frame.block.min(count)];
    for (number, block) in out.chunks_mut(frame.block).enumerate() {
        frame.unpack(number, block, &mut scratch[..block.len()])?;
    }
    Ok(())
}

impl<'a> Frame<'a> {
    /// The frame in `bytes`, and how many bytes it holds.
    fn new(bytes: &'a [u8]) -> Result<(Self, usize)> {
        if bytes.len() < HEADER {
            return Err(damaged("fewer bytes than stated"));
        }
        let (flags, width) = (bytes[2], bytes[3].into());
        let [length, block] = [4, 8].map(|at| u32::from_le_bytes(array(bytes, at)) as usize);
        if flags & STORED == 0 && (flags >> 5 != LZ4 || flags & BIT_SHUFFLED != 0) {
            let names = ["BloscLZ", "LZ4", "Snappy", "zlib", "Zstandard"];
            let name = names.get(usize::from(flags >> 5)).unwrap_or(&"an unknown compressor");
            let bits = if flags & BIT_SHUFFLED != 0 { " with shuffled bits" } else { "" };
            let remedy = "save the file with OpenVDB's own Blosc or zip compression, or without any";
            return Err(Problem::new("Blosc compression by LZ4", format!("{name}{bits}"), remedy));
        }
        if block == 0 || width == 0 {
            return Err(damaged("blocks of no bytes"));
        }
        Ok((Self { flags, width, block, bytes }, length))
    }

    /// Unpacks block `number` into `block`, by way of `scratch`, which is as long.
    fn unpack(&self, number: usize, block: &mut [u8], scratch: &mut [u8]) -> Result<()> {
        let shuffled = self.flags & SHUFFLED != 0 && self.width > 1;
        let start = u32::from_le_bytes(array(self.bytes, HEADER + 4 * number)) as usize;
        self.pieces(start, block.len(), if shuffled { &mut *scratch } else { &mut *block })?;
        if shuffled {
            unshuffle(scratch, self.width, block);
        }
        Ok(())
    }

    /// A block may be in as many pieces as a value has bytes.
    fn pieces(&self, start: usize, length: usize, out: &mut [u8]) -> Result<()> {
        let is_split = self.flags & WHOLE == 0
            && length == self.block
            && self.width <= MOST_PIECES
            && length / self.width >= LEAST_VALUES
            && length.is_multiple_of(self.width);
        let mut at = start;
        for piece in out.chunks_mut(if is_split { length / self.width } else { length }) {
            let packed = u32::from_le_bytes(array(self.bytes, at)) as usize;
            at += 4;
            let bytes = at.checked_add(packed).and_then(|end| self.bytes.get(at..end));
            let bytes =
                bytes.filter(|bytes| !bytes.is_empty()).ok_or_else(|| damaged("a piece beyond the end"))?;
            expand(bytes, piece)?;
            at += packed;
        }
        Ok(())
    }
}

/// What did not become shorter is stored as it was.
fn expand(bytes: &[u8], piece: &mut [u8]) -> Result<()> {
    if bytes.len() == piece.len() {
        piece.copy_from_slice(bytes);
        return Ok(());
    }
    match lz4_flex::block::decompress_into(bytes, piece) {
        Ok(length) if length == piece.len() => Ok(()),
        Ok(length) => Err(damaged(format!("{length} bytes in a piece of {}", piece.len()))),
        Err(error) => Err(damaged(error.to_string())),
    }
}

/// First bytes of all values, then second ones, and so on, become values; what is left of a whole value stays.
fn unshuffle(shuffled: &[u8], width: usize, values: &mut [u8]) {
    let count = shuffled.len() / width;
    for (index, value) in values.chunks_exact_mut(width).enumerate() {
        for (byte, out) in value.iter_mut().enumerate() {
            *out = shuffled[byte * count + index];
        }
    }
    let rest = count * width;
    values[rest..].copy_from_slice(&shuffled[rest..]);
}
