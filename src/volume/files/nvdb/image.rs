//! The image of a NanoVDB grid in memory: numbers and nodes by their place.

use super::super::{Problem, Result, value::array};

/// Bytes of a grid.
pub(super) struct Image(Vec<u8>);

impl Image {
    /// `bytes` start with one of NanoVDB's magic words.
    pub(super) fn new(bytes: Vec<u8>) -> Result<Self> {
        if super::MAGICS.contains(&array(&bytes, 0)) {
            return Ok(Self(bytes));
        }
        let found = format!("\"{}\"", array::<8>(&bytes, 0).escape_ascii());
        Err(Problem::damage("a NanoVDB grid", found))
    }

    /// How many bytes there are.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The `length` bytes from `at`.
    pub(super) fn bytes(&self, at: usize, length: usize) -> Result<&[u8]> {
        let bytes = at.checked_add(length).and_then(|end| self.0.get(at..end));
        bytes.ok_or_else(|| {
            let expected = format!("a place within the grid's {} bytes", self.len());
            Problem::damage(expected, format!("{length} bytes from byte {at}"))
        })
    }

    fn array<const N: usize>(&self, at: usize) -> Result<[u8; N]> {
        self.bytes(at, N).map(|bytes| array(bytes, 0))
    }

    /// The number of 32 bits at `at`.
    pub(super) fn u32(&self, at: usize) -> Result<u32> {
        self.array(at).map(u32::from_le_bytes)
    }

    /// The number of 64 bits at `at`.
    pub(super) fn u64(&self, at: usize) -> Result<u64> {
        self.array(at).map(u64::from_le_bytes)
    }

    /// The real number of 64 bits at `at`.
    pub(super) fn f64(&self, at: usize) -> Result<f64> {
        self.array(at).map(f64::from_le_bytes)
    }

    /// The position of a node: its distance from the node at `from` is stored at `at`.
    pub(super) fn follow(&self, from: usize, at: usize) -> Result<usize> {
        let offset = self.u64(at)?.cast_signed();
        let place = isize::try_from(offset).ok().and_then(|offset| from.checked_add_signed(offset));
        let place = place.filter(|place| *place < self.len());
        place.ok_or_else(|| {
            let expected = format!("a node within the grid's {} bytes", self.len());
            Problem::damage(expected, format!("one {offset} bytes from byte {from}"))
        })
    }
}
