//! The tree of a NanoVDB grid. Nodes hold the distances to their children, so a hostile file can let many parents have
//! the same one: no more nodes are visited than the file has room for.

use super::{
    super::{
        Problem, Result,
        sparse::{Builder, is_set, unpack},
        value::{Format, Value},
    },
    image::Image,
    leaf::Leaf,
};

/// Where the tree starts, after what is said of the grid (bytes).
const TREE: usize = 672;

/// Where the tree says how far the root is from it (bytes).
const ROOT: usize = TREE + 24;

/// Places within the root (bytes): the number of its children and tiles, and the background.
const TABLE_SIZE: usize = 24;
const BACKGROUND: usize = 28;

/// A row of the root's table, and places within (bytes): distance to the child, state, value.
const ROW: usize = 32;
const ROW_CHILD: usize = 8;
const ROW_STATE: usize = 16;
const ROW_VALUE: usize = 20;

/// Where the masks of an inner node start: of active values, then of children (bytes).
const MASKS: usize = 32;

/// Inner nodes, from those below the root: log2 of how many children they have along a side, and of the side of one.
const NODES: [(u32, u32); 2] = [(5, 7), (4, 3)];

/// Where a struct's next part starts after `length` bytes.
fn aligned(length: usize) -> usize {
    length.next_multiple_of(32)
}

/// Length of a value (bytes).
fn size<V: Value>() -> usize {
    V::CHANNELS * Format::Float.size()
}

/// Length of the least and the greatest value, and two numbers about them (bytes).
fn statistics<V: Value>() -> usize {
    2 * size::<V>() + 2 * 4
}

/// An inner node's measures (bytes).
#[derive(Clone, Copy)]
struct Measures {
    /// Of a mask.
    mask: usize,
    /// Where the table starts.
    table: usize,
    /// Of a row of the table: a value, or the distance to a child.
    row: usize,
    /// Of all.
    whole: usize,
}

impl Measures {
    fn new<V: Value>(bits: u32) -> Self {
        let count = 1 << (3 * bits);
        let mask = count / 8;
        let table = aligned(MASKS + 2 * mask + statistics::<V>());
        let row = size::<V>().next_multiple_of(8);
        Self { mask, table, row, whole: aligned(table + count * row) }
    }
}

struct Reader<'a, V> {
    image: &'a Image,
    leaf: Leaf,
    builder: Builder<V>,
    inner: [Measures; 2],
    /// How many more inner nodes of either depth, and blocks, the file has room for.
    room: [usize; 3],
}

/// Reads the tree of `image`, whose blocks are written as `leaf` says.
pub(super) fn read<V: Value>(image: &Image, leaf: Leaf) -> Result<Builder<V>> {
    let root = image.follow(TREE, ROOT)?;
    let background = Format::Float.value(image.bytes(root + BACKGROUND, size::<V>())?, 0);
    let inner = NODES.map(|(bits, _)| Measures::new::<V>(bits));
    let lengths = [inner[0].whole, inner[1].whole, leaf.shortest::<V>()];
    let room = lengths.map(|length| image.len() / length);
    let mut reader = Reader { image, leaf, builder: Builder::new(background), inner, room };
    reader.root(root)?;
    Ok(reader.builder)
}

/// The origin of a child of the root: 21 bits of each coordinate, in units of 4096.
fn origin(key: u64) -> [i32; 3] {
    [42, 21, 0].map(|shift| ((key >> shift) as i32) << 12)
}

impl<V: Value> Reader<'_, V> {
    /// Counts a node of `kind`.
    fn enter(&mut self, kind: usize) -> Result<()> {
        let left = self.room[kind].checked_sub(1);
        self.room[kind] =
            left.ok_or_else(|| Problem::damage("nodes apart from each other", "more than fit"))?;
        Ok(())
    }

    fn root(&mut self, at: usize) -> Result<()> {
        let count = self.image.u32(at + TABLE_SIZE)? as usize;
        let table = at + aligned(BACKGROUND + size::<V>() + statistics::<V>());
        let rows = self.image.bytes(table, count.saturating_mul(ROW))?;
        for (index, row) in rows.chunks_exact(ROW).enumerate() {
            let place = table + index * ROW;
            let origin = origin(self.image.u64(place)?);
            if self.image.u64(place + ROW_CHILD)? == 0 {
                let value = Format::Float.value(&row[ROW_VALUE..], 0);
                self.builder.tile(2, origin, value, self.image.u32(place + ROW_STATE)? != 0);
            } else {
                self.inner(0, self.image.follow(at, place + ROW_CHILD)?, origin)?;
            }
        }
        Ok(())
    }

    /// The inner node at `at`, of depth 0 or 1, whose first sample is at `origin`.
    fn inner(&mut self, depth: usize, at: usize, origin: [i32; 3]) -> Result<()> {
        self.enter(depth)?;
        let (bits, side) = NODES[depth];
        let Measures { mask, table, row, whole } = self.inner[depth];
        let node = self.image.bytes(at, whole)?;
        let (active, children) = (&node[MASKS..MASKS + mask], &node[MASKS + mask..MASKS + 2 * mask]);
        for n in 0..1 << (3 * bits) {
            let offset = unpack(n, bits);
            let place = std::array::from_fn(|axis| origin[axis] + (offset[axis] << side));
            let entry = table + n * row;
            if !is_set(children, n) {
                let value = Format::Float.value(&node[entry..], 0);
                self.builder.tile(1 - depth, place, value, is_set(active, n));
                continue;
            }
            let child = self.image.follow(at, at + entry)?;
            if depth == 0 { self.inner(1, child, place)? } else { self.block(child, place)? }
        }
        Ok(())
    }

    fn block(&mut self, at: usize, origin: [i32; 3]) -> Result<()> {
        self.enter(2)?;
        let (mask, values) = self.leaf.read(self.image, at)?;
        self.builder.block(origin, &values, mask);
        Ok(())
    }
}
