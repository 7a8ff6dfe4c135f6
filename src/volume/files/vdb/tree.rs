//! The tree of an OpenVDB grid: first all nodes but the values of blocks, then these.

use super::super::{
    Problem, Result,
    input::Input,
    sparse::{BLOCK, Builder, is_set, unpack},
    value::Value,
};
use super::values::{self, Coding, Scratch};
use std::io::{Read, Seek};

/// Side of a child of the root, in samples: a power of two.
const TOP: u32 = 12;

/// Inner nodes, from those below the root: log2 of how many children they have along a side, and of the side of one.
const NODES: [(u32, u32); 2] = [(5, 7), (4, 3)];

/// Length of the mask of a block (bytes).
const MASK: usize = BLOCK / 8;

struct Reader<'a, V, R> {
    input: &'a mut Input<R>,
    coding: Coding,
    builder: Builder<V>,
    scratch: Scratch,
    /// Origins of all blocks, in the order of the file.
    blocks: Vec<[i32; 3]>,
}

/// Reads a tree; the values of its blocks start at `start`.
pub(super) fn read<V: Value, R: Read + Seek>(
    input: &mut Input<R>,
    coding: Coding,
    start: u64,
) -> Result<Builder<V>> {
    // The number of buffers, of which there is one.
    input.skip(4)?;
    let builder = Builder::new(values::single(input, coding)?);
    let mut reader = Reader { input, coding, builder, scratch: Scratch::default(), blocks: vec![] };
    reader.root()?;
    reader.input.seek(start)?;
    reader.values()?;
    Ok(reader.builder)
}

impl<V: Value, R: Read + Seek> Reader<'_, V, R> {
    fn root(&mut self) -> Result<()> {
        let (tiles, children) = (self.input.u32()?, self.input.u32()?);
        for _ in 0..tiles {
            let origin = self.origin()?;
            let value = values::single(self.input, self.coding)?;
            let [active] = self.input.array()?;
            self.builder.tile(2, origin, value, active != 0);
        }
        for _ in 0..children {
            let origin = self.origin()?;
            self.inner(0, origin)?;
        }
        Ok(())
    }

    fn origin(&mut self) -> Result<[i32; 3]> {
        let origin = self.input.coordinates()?;
        if origin.iter().all(|i| i % (1 << TOP) == 0) {
            return Ok(origin);
        }
        Err(Problem::damage(format!("a node at multiples of {}", 1 << TOP), format!("{origin:?}")))
    }

    /// Reads the inner node at `origin`, of depth 0 or 1, and all below it.
    fn inner(&mut self, depth: usize, origin: [i32; 3]) -> Result<()> {
        let (bits, side) = NODES[depth];
        let count = 1_usize << (3 * bits);
        let (mut children, mut active) = (vec![0; count / 8], vec![0; count / 8]);
        self.input.fill(&mut children)?;
        self.input.fill(&mut active)?;
        let mut tiles = vec![];
        let background = self.builder.background();
        values::read(self.input, self.coding, background, &active, &mut self.scratch, &mut tiles)?;
        let place = |n: usize| {
            let offset = unpack(n, bits);
            std::array::from_fn(|axis| origin[axis] + (offset[axis] << side))
        };
        for n in (0..count).filter(|&n| !is_set(&children, n)) {
            self.builder.tile(1 - depth, place(n), tiles[n], is_set(&active, n));
        }
        drop(tiles);
        for n in (0..count).filter(|&n| is_set(&children, n)) {
            if depth == 0 { self.inner(1, place(n))? } else { self.block(place(n))? }
        }
        Ok(())
    }

    /// The mask of a block is repeated beside its values.
    fn block(&mut self, origin: [i32; 3]) -> Result<()> {
        self.input.skip(MASK as u64)?;
        self.blocks.push(origin);
        Ok(())
    }

    fn values(&mut self) -> Result<()> {
        let background = self.builder.background();
        let mut found = vec![];
        for origin in std::mem::take(&mut self.blocks) {
            let mask = self.input.array::<MASK>()?;
            values::read(self.input, self.coding, background, &mask, &mut self.scratch, &mut found)?;
            let whole = found.as_slice().try_into().ok();
            let whole = whole.ok_or_else(|| Problem::damage("a block of values", "too few"))?;
            self.builder.block(origin, whole, &mask);
        }
        Ok(())
    }
}
