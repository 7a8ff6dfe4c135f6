//! Cells of space, or of directions: a kd-tree that is divided where many weighted points fall.

use super::quadtree::effective;

/// A point with the weight it has among others.
pub trait Keyed<const D: usize> {
    /// What its cell is looked up by.
    fn key(&self) -> [f32; D];
    /// At least 0, finite.
    fn weight(&self) -> f32;
}

/// A kd-tree with something in every leaf.
#[derive(Clone, Debug)]
pub struct Cells<const D: usize, T> {
    all: Vec<Cell<T>>,
}

#[derive(Clone, Debug)]
enum Cell<T> {
    /// Keys of less than `at` along `axis` are found in the next cell, others in the cell of this index.
    Split {
        axis: usize,
        at: f32,
        beyond: u32,
    },
    Leaf(T),
}

impl<const D: usize, T> Cells<D, T> {
    /// No more than 2^`levels` cells, none where nothing is `keyed`, each with at least so many `points`, as [`effective`] counts them, in which `leaf` finds
    /// what it holds.
    pub fn learn<K: Keyed<D> + Send>(
        keyed: Vec<K>,
        points: f64,
        levels: u32,
        mut leaf: impl FnMut(Vec<K>) -> T,
    ) -> Self {
        let mut cells = Self { all: Vec::new() };
        if keyed.is_empty() {
            return cells;
        }
        cells.grow(divide(keyed, 2.0 * points, levels), &mut leaf);
        cells
    }

    fn grow<K>(&mut self, parts: Parts<K>, leaf: &mut impl FnMut(Vec<K>) -> T) {
        let (axis, at, [near, far]) = match parts {
            Parts::Whole(keyed) => return self.all.push(Cell::Leaf(leaf(keyed))),
            Parts::Split { axis, at, parts } => (axis, at, *parts),
        };
        let index = self.all.len();
        self.all.push(Cell::Split { axis, at, beyond: 0 });
        self.grow(near, leaf);
        let next = self.all.len() as u32;
        if let Cell::Split { beyond, .. } = &mut self.all[index] {
            *beyond = next;
        }
        self.grow(far, leaf);
    }

    /// Memory that the cells take [bytes], without what else their contents point at.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.all[..])
    }

    /// What holds `key`.
    #[inline]
    pub fn at(&self, key: [f32; D]) -> Option<&T> {
        let mut index = 0;
        loop {
            match self.all.get(index)? {
                Cell::Split { axis, at, beyond } => {
                    index = if key[*axis] < *at { index + 1 } else { *beyond as usize };
                }
                Cell::Leaf(leaf) => return Some(leaf),
            }
        }
    }
}

impl<const D: usize, T> Default for Cells<D, T> {
    /// None at all.
    fn default() -> Self {
        Self { all: Vec::new() }
    }
}

/// What the cells below one hold.
enum Parts<K> {
    Whole(Vec<K>),
    Split { axis: usize, at: f32, parts: Box<[Self; 2]> },
}

fn divide<const D: usize, K: Keyed<D> + Send>(mut keyed: Vec<K>, points: f64, levels: u32) -> Parts<K> {
    let divides = levels > 0 && effective(keyed.iter().map(K::weight)) >= points;
    let Some((axis, middle)) = divides.then(|| split(&mut keyed)).flatten() else {
        return Parts::Whole(keyed);
    };
    let far = keyed.split_off(middle);
    let at = far[0].key()[axis];
    let (near, far) = rayon::join(|| divide(keyed, points, levels - 1), || divide(far, points, levels - 1));
    Parts::Split { axis, at, parts: Box::new([near, far]) }
}

/// Sorts `keyed` along the axis on which the keys lie furthest apart. The axis and where the upper half of the weight begins;
/// none where both halves would not have something.
fn split<const D: usize, K: Keyed<D>>(keyed: &mut [K]) -> Option<(usize, usize)> {
    let (mut low, mut high) = ([f32::INFINITY; D], [f32::NEG_INFINITY; D]);
    for key in keyed.iter().map(K::key) {
        for axis in 0..D {
            low[axis] = low[axis].min(key[axis]);
            high[axis] = high[axis].max(key[axis]);
        }
    }
    let extent = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..D).max_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    keyed.sort_by(|a, b| a.key()[axis].total_cmp(&b.key()[axis]));
    let half = 0.5 * keyed.iter().map(|one| f64::from(one.weight())).sum::<f64>();
    let mut sum = 0.0;
    let middle = keyed.iter().position(|one| {
        sum += f64::from(one.weight());
        sum >= half
    })?;
    // The first of equal keys, so that all of them lie on one side.
    let at = keyed[middle].key()[axis];
    let first = keyed.partition_point(|one| one.key()[axis] < at);
    (first > 0).then_some((axis, first))
}
