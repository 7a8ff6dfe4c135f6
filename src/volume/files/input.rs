//! Bytes of a file, in order and by place, with the number of those that are left always known.

use super::{Problem, Result};
use std::io::{Read, Seek, SeekFrom};

/// No name or type is longer (bytes).
const LONGEST_TEXT: u32 = 1 << 12;

/// A file that is read. All numbers are little-endian.
pub(super) struct Input<R> {
    source: R,
    length: u64,
    position: u64,
}

impl<R: Read + Seek> Input<R> {
    /// At the start of `source`.
    pub(super) fn new(mut source: R) -> Result<Self> {
        let length = source.seek(SeekFrom::End(0))?;
        source.rewind()?;
        Ok(Self { source, length, position: 0 })
    }

    /// Offset of the next byte (bytes).
    pub(super) fn position(&self) -> u64 {
        self.position
    }

    /// How many bytes there are from here on.
    pub(super) fn left(&self) -> u64 {
        self.length - self.position
    }

    fn need(&self, count: u64) -> Result<()> {
        if count <= self.left() {
            return Ok(());
        }
        let found = format!("{} left of {}", self.left(), self.length);
        Err(Problem::damage(format!("{count} more bytes"), found))
    }

    /// Goes to `position`.
    pub(super) fn seek(&mut self, position: u64) -> Result<()> {
        if position > self.length {
            let expected = format!("a place within the file, of {} bytes", self.length);
            return Err(Problem::damage(expected, format!("{position}")));
        }
        self.source.seek(SeekFrom::Start(position))?;
        self.position = position;
        Ok(())
    }

    /// Passes over `count` bytes.
    pub(super) fn skip(&mut self, count: u64) -> Result<()> {
        self.need(count)?;
        // A file is never longer than this type can represent.
        self.source.seek_relative(count.cast_signed())?;
        self.position += count;
        Ok(())
    }

    /// Fills `bytes`.
    pub(super) fn fill(&mut self, bytes: &mut [u8]) -> Result<()> {
        self.need(bytes.len() as u64)?;
        self.source.read_exact(bytes)?;
        self.position += bytes.len() as u64;
        Ok(())
    }

    /// Makes `bytes` the next `count` bytes.
    pub(super) fn load(&mut self, bytes: &mut Vec<u8>, count: u64) -> Result<()> {
        self.need(count)?;
        bytes.resize(count as usize, 0);
        self.fill(bytes)
    }

    /// The next `N` bytes.
    pub(super) fn array<const N: usize>(&mut self) -> Result<[u8; N]> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    /// The next number of 32 bits.
    pub(super) fn u32(&mut self) -> Result<u32> {
        self.array().map(u32::from_le_bytes)
    }

    /// The next number of 64 bits.
    pub(super) fn u64(&mut self) -> Result<u64> {
        self.array().map(u64::from_le_bytes)
    }

    /// The next signed number of 64 bits.
    pub(super) fn i64(&mut self) -> Result<i64> {
        self.array().map(i64::from_le_bytes)
    }

    /// The next three signed numbers of 32 bits.
    pub(super) fn coordinates(&mut self) -> Result<[i32; 3]> {
        let mut read = || self.array().map(i32::from_le_bytes);
        Ok([read()?, read()?, read()?])
    }

    /// A text after its length.
    pub(super) fn text(&mut self) -> Result<String> {
        let length = self.u32()?;
        if length > LONGEST_TEXT {
            return Err(Problem::damage(
                format!("a name of at most {LONGEST_TEXT} bytes"),
                length.to_string(),
            ));
        }
        let mut bytes = vec![];
        self.load(&mut bytes, length.into())?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }
}
