//! Sparse samples: blocks of 8^3 values where a file has such, tiles of one value, and the background elsewhere. The
//! sizes are those of OpenVDB's trees of shape 5-4-3 (Museth 2013, "VDB: High-resolution sparse volumes with dynamic
//! topology", sec. 3).

use super::{Problem, Result, Value};
use crate::volume::Samples;
use std::collections::HashMap;

/// Values of a block.
pub(super) const BLOCK: usize = 512;

/// Sides of a block, of a tile that could be 16^3 blocks, and of one that could be 32^3 of these: powers of two.
const LEVELS: [u32; 3] = [3, 7, 12];

/// No more blocks than these are looked at to find that all samples of a box are equal.
const MOST_LOOKED_AT: i64 = 512;

/// Samples of a grid within the box of its active ones, grown by one sample on every side.
#[derive(Clone, Debug)]
pub struct Sparse<V> {
    low: [i64; 3],
    size: [usize; 3],
    tree: Tree<V>,
    active: Active<V>,
}

/// The samples that a file says are active.
#[derive(Clone, Copy, Debug)]
pub struct Active<V> {
    /// How many there are.
    pub count: u64,
    /// The least and the greatest value of every channel; the background where there are none.
    pub range: [V; 2],
}

#[derive(Clone, Debug)]
struct Tree<V> {
    background: V,
    /// By place in units of blocks, x-major inside.
    blocks: HashMap<[i32; 3], Box<[V; BLOCK]>>,
    /// By place in units of their sides, of every level; a place is in one map at most.
    tiles: [HashMap<[i32; 3], V>; 3],
}

/// The place of a point in units of `2^level`; indices are of 32 bits, or one more.
fn place(index: [i64; 3], level: u32) -> [i32; 3] {
    index.map(|i| (i >> level) as i32)
}

/// What a block of samples is.
enum Content<'a, V> {
    Uniform(V),
    Varying(&'a [V; BLOCK]),
}

impl<V: Value> Tree<V> {
    /// The block of the sample at `index`.
    fn content(&self, index: [i64; 3]) -> Content<'_, V> {
        if let Some(block) = self.blocks.get(&place(index, LEVELS[0])) {
            return Content::Varying(block);
        }
        let tile = |(tiles, level): (&HashMap<_, V>, u32)| tiles.get(&place(index, level)).copied();
        Content::Uniform(self.tiles.iter().zip(LEVELS).find_map(tile).unwrap_or(self.background))
    }
}

impl<V: Copy> Sparse<V> {
    /// What is active.
    pub fn active(&self) -> Active<V> {
        self.active
    }

    /// The value of what the file does not name; of a level set, the greatest distance that it holds.
    pub fn background(&self) -> V {
        self.tree.background
    }

    /// Memory that the values take, as they are held while they are read (bytes).
    pub fn bytes(&self) -> u64 {
        let tiles: usize = self.tree.tiles.iter().map(HashMap::len).sum();
        ((self.tree.blocks.len() * BLOCK + tiles) * size_of::<V>()) as u64
    }
}

impl<V: Value> Sparse<V> {
    /// The grid's index of the first sample.
    pub fn low(&self) -> [i64; 3] {
        self.low
    }

    fn index(&self, sample: [usize; 3]) -> [i64; 3] {
        std::array::from_fn(|axis| self.low[axis] + sample[axis] as i64)
    }

    /// The first sample of the cube at `start`, and how many of its samples are within the box.
    fn cut(&self, start: [i64; 3], side: i64) -> Option<([usize; 3], u64)> {
        let first: [i64; 3] = std::array::from_fn(|axis| (start[axis] - self.low[axis]).max(0));
        let length = |axis: usize| {
            let end = (start[axis] - self.low[axis] + side).min(self.size[axis] as i64);
            (end - first[axis]).max(0) as u64
        };
        let count = (0..3).map(length).product();
        (count > 0).then_some((first.map(|i| i as usize), count))
    }
}

impl<V: Value> Samples<V> for Sparse<V> {
    fn size(&self) -> [usize; 3] {
        self.size
    }

    fn at(&self, index: [usize; 3]) -> V {
        let index = self.index(index);
        match self.tree.content(index) {
            Content::Uniform(value) => value,
            Content::Varying(block) => {
                let [x, y, z] = index.map(|i| (i & 7) as usize);
                block[(x << 6) | (y << 3) | z]
            }
        }
    }

    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<V> {
        let (low, high) = (self.index(low).map(|i| i >> 3), self.index(high).map(|i| i >> 3));
        let count = (0..3).try_fold(1_i64, |count, axis| count.checked_mul(high[axis] - low[axis] + 1));
        if count.is_none_or(|count| count > MOST_LOOKED_AT) {
            return None;
        }
        let mut first = None;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                for z in low[2]..=high[2] {
                    let Content::Uniform(value) = self.tree.content([x << 3, y << 3, z << 3]) else {
                        return None;
                    };
                    if *first.get_or_insert(value) != value {
                        return None;
                    }
                }
            }
        }
        first
    }

    fn each(&self, visit: &mut dyn FnMut([usize; 3], V, u64)) {
        let Tree { background, blocks, tiles } = &self.tree;
        visit([0; 3], *background, 1);
        for (place, block) in blocks {
            let start = place.map(|i| i64::from(i) << LEVELS[0]);
            for (n, value) in block.iter().enumerate() {
                let offset = unpack(n, LEVELS[0]);
                let index = std::array::from_fn(|axis| start[axis] + i64::from(offset[axis]));
                self.cut(index, 1).into_iter().for_each(|(sample, count)| visit(sample, *value, count));
            }
        }
        for (tiles, level) in tiles.iter().zip(LEVELS) {
            for (place, value) in tiles {
                let start = place.map(|i| i64::from(i) << level);
                self.cut(start, 1 << level)
                    .into_iter()
                    .for_each(|(sample, count)| visit(sample, *value, count));
            }
        }
    }
}

/// True if bit number `n` of a file's mask is set.
pub(super) fn is_set(mask: &[u8], n: usize) -> bool {
    mask.get(n >> 3).is_some_and(|byte| byte >> (n & 7) & 1 == 1)
}

/// The place, within a node of `2^bits` children along each side, of child number `n`.
pub(super) fn unpack(n: usize, bits: u32) -> [i32; 3] {
    let side = (1 << bits) - 1;
    [n >> (2 * bits), (n >> bits) & side, n & side].map(|i| i as i32)
}

/// Takes the nodes of a tree in any order.
pub(super) struct Builder<V> {
    tree: Tree<V>,
    /// The box of active samples, both included; the wrong way round where there are none.
    active: [[i64; 3]; 2],
    count: u64,
    range: Option<[V; 2]>,
}

impl<V: Value> Builder<V> {
    /// `background` everywhere.
    pub(super) fn new(background: V) -> Self {
        let tree =
            Tree { background, blocks: HashMap::new(), tiles: std::array::from_fn(|_| HashMap::new()) };
        Self { tree, active: [[i64::MAX; 3], [i64::MIN; 3]], count: 0, range: None }
    }

    /// The value of what no file names.
    pub(super) fn background(&self) -> V {
        self.tree.background
    }

    fn include(&mut self, low: [i64; 3], high: [i64; 3], value: V) {
        self.count += (0..3).map(|axis| (high[axis] - low[axis] + 1) as u64).product::<u64>();
        let [least, greatest] = self.range.unwrap_or([value; 2]);
        self.range = Some([least.least(value), greatest.greatest(value)]);
        for axis in 0..3 {
            self.active[0][axis] = self.active[0][axis].min(low[axis]);
            self.active[1][axis] = self.active[1][axis].max(high[axis]);
        }
    }

    /// One value in a cube at `origin`: of level 0, 1 or 2, as long as a block, 16 blocks, or 512.
    pub(super) fn tile(&mut self, level: usize, origin: [i32; 3], value: V, active: bool) {
        let origin = origin.map(i64::from);
        if active {
            let side = 1 << LEVELS[level];
            self.include(origin, origin.map(|i| i + side - 1), value);
        }
        if value != self.tree.background {
            self.tree.tiles[level].insert(place(origin, LEVELS[level]), value);
        }
    }

    /// The values of the block at `origin`, those that are active marked in `mask`.
    pub(super) fn block(&mut self, origin: [i32; 3], values: &[V; BLOCK], mask: &[u8]) {
        let start = origin.map(i64::from);
        for n in (0..BLOCK).filter(|&n| is_set(mask, n)) {
            let offset = unpack(n, LEVELS[0]);
            let index = std::array::from_fn(|axis| start[axis] + i64::from(offset[axis]));
            self.include(index, index, values[n]);
        }
        if values.iter().all(|value| *value == values[0]) {
            self.tile(0, origin, values[0], false);
        } else {
            self.tree.blocks.insert(place(start, LEVELS[0]), Box::new(*values));
        }
    }

    /// All nodes are there. A grid without active samples is empty wherever one looks.
    pub(super) fn finish(self) -> Result<Sparse<V>> {
        let [mut low, mut high] = self.active;
        if low[0] > high[0] {
            if self.tree.background != V::ZERO {
                let found = "one without any, whose background is not 0";
                let remedy = "fill the part of space that is meant, or use a constvolume";
                return Err(Problem::new("a grid with active voxels", found, remedy));
            }
            (low, high) = ([0; 3], [0; 3]);
        }
        let size = std::array::from_fn(|axis| (high[axis] - low[axis] + 3) as usize);
        let active = Active { count: self.count, range: self.range.unwrap_or([self.tree.background; 2]) };
        Ok(Sparse { low: low.map(|i| i - 1), size, tree: self.tree, active })
    }
}
