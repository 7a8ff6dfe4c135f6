//! Cells of space, or of directions: a kd-tree that is divided where many weighted points fall, and between those whose values differ.

use super::quadtree::effective;

/// A point with the weight it has among others.
pub trait Keyed<const D: usize> {
    /// What its cell is looked up by.
    fn key(&self) -> [f32; D];
    /// At least 0, finite.
    fn weight(&self) -> f32;
    /// What both sides of a division should differ in, if in anything.
    fn value(&self) -> Option<f32> {
        None
    }
}

/// Parts of an extent between which cells may be divided where values differ.
const PARTS: usize = 32;
/// Least part of the variance of values that a division off the middle must explain: values are noisy.
const EXPLAINED: f64 = 0.05;

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
    /// At most 2^`levels` cells; none where nothing is `keyed`. A cell is divided if it has at least twice so many
    /// `points`, as [`effective`] counts them. `leaf` makes the content of a cell from its items.
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

    /// The contents of all leaves.
    pub fn leaves(&self) -> impl Iterator<Item = &T> {
        self.all.iter().filter_map(|cell| match cell {
            Cell::Leaf(leaf) => Some(leaf),
            Cell::Split { .. } => None,
        })
    }

    /// Memory that the cells take (bytes), without what else their contents point at.
    pub fn bytes(&self) -> usize {
        size_of_val(&self.all[..])
    }

    /// How many there are, those that are divided too.
    pub fn count(&self) -> usize {
        self.all.len()
    }

    /// The content of cell `index`, or the two cells that it is divided into; the first cell is the root.
    pub fn cell(&self, index: usize) -> Result<&T, [u32; 2]> {
        match &self.all[index] {
            Cell::Split { beyond, .. } => Err([index as u32 + 1, *beyond]),
            Cell::Leaf(leaf) => Ok(leaf),
        }
    }

    /// The content of the cell around `key`.
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
    /// No cells.
    fn default() -> Self {
        Self { all: Vec::new() }
    }
}

/// The items of a cell, divided or not.
enum Parts<K> {
    Whole(Vec<K>),
    Split { axis: usize, at: f32, parts: Box<[Self; 2]> },
}

fn divide<const D: usize, K: Keyed<D> + Send>(keyed: Vec<K>, points: f64, levels: u32) -> Parts<K> {
    let divides = levels > 0 && effective(keyed.iter().map(K::weight)) >= points;
    let split = || by_value(&keyed, 0.5 * points).or_else(|| in_the_middle(&keyed));
    let Some((axis, at)) = divides.then(split).flatten() else {
        return Parts::Whole(keyed);
    };
    let (near, far): (Vec<K>, Vec<K>) = keyed.into_iter().partition(|one| one.key()[axis] < at);
    let (near, far) = rayon::join(|| divide(near, points, levels - 1), || divide(far, points, levels - 1));
    Parts::Split { axis, at, parts: Box::new([near, far]) }
}

/// The axis on which the keys lie furthest apart, and the key there at which the upper half of the weight begins. If
/// the lowest key has more than half, it is the next one. None where all keys are equal.
fn in_the_middle<const D: usize, K: Keyed<D>>(keyed: &[K]) -> Option<(usize, f32)> {
    let [low, high] = bounds(keyed);
    let extent = |axis: &usize| high[*axis] - low[*axis];
    let axis = (0..D).max_by(|a, b| extent(a).total_cmp(&extent(b)))?;
    let mut along: Vec<(f32, f32)> = keyed.iter().map(|one| (one.key()[axis], one.weight())).collect();
    along.sort_by(|a, b| a.0.total_cmp(&b.0));
    let half = 0.5 * along.iter().map(|(_, weight)| f64::from(*weight)).sum::<f64>();
    let mut sum = 0.0;
    let (middle, _) = *along.iter().find(|(_, weight)| {
        sum += f64::from(*weight);
        sum >= half
    })?;
    // Equal keys all lie on one side.
    let lowest = along[0].0;
    let (at, _) = *along.iter().find(|(key, _)| *key > lowest && *key >= middle)?;
    Some((axis, at))
}

/// The axis and the place where a division separates the values of `keyed` best, with at least so many `points` in each
/// half; none where there are no values or they hardly differ.
fn by_value<const D: usize, K: Keyed<D>>(keyed: &[K], points: f64) -> Option<(usize, f32)> {
    keyed.first()?.value()?;
    let [low, high] = bounds(keyed);
    let size: [f32; D] = std::array::from_fn(|axis| (high[axis] - low[axis]) / PARTS as f32);
    let mut parts = [[Moments::default(); PARTS]; D];
    for one in keyed {
        let (key, value) = (one.key(), f64::from(one.value()?));
        for (axis, parts) in parts.iter_mut().enumerate() {
            let part = (((key[axis] - low[axis]) / size[axis]) as usize).min(PARTS - 1);
            parts[part] = parts[part].and(Moments([1.0, value, value * value]));
        }
    }
    let all = parts[0].into_iter().fold(Moments::default(), Moments::and);
    let mut best = (all.scatter() * (1.0 - EXPLAINED), None);
    for (axis, parts) in parts.iter().enumerate() {
        let mut near = Moments::default();
        for (index, part) in parts.iter().enumerate().take(PARTS - 1) {
            near = near.and(*part);
            let far = all.without(near);
            let remains = near.scatter() + far.scatter();
            if near.0[0].min(far.0[0]) >= points && remains < best.0 {
                best = (remains, Some((axis, low[axis] + size[axis] * (index + 1) as f32)));
            }
        }
    }
    best.1
}

/// The least and the greatest coordinates.
fn bounds<const D: usize, K: Keyed<D>>(keyed: &[K]) -> [[f32; D]; 2] {
    let (mut low, mut high) = ([f32::INFINITY; D], [f32::NEG_INFINITY; D]);
    for key in keyed.iter().map(K::key) {
        for axis in 0..D {
            low[axis] = low[axis].min(key[axis]);
            high[axis] = high[axis].max(key[axis]);
        }
    }
    [low, high]
}

/// Of values: their number, their sum and that of their squares.
#[derive(Clone, Copy, Debug, Default)]
struct Moments([f64; 3]);

impl Moments {
    fn and(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }

    fn without(self, part: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - part.0[i]))
    }

    /// Squared differences from their mean, summed.
    fn scatter(self) -> f64 {
        let [count, sum, squares] = self.0;
        if count > 0.0 { squares - sum * sum / count } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::{Stream, stream::Purpose};

    /// A point of a room, and how bright it is there.
    struct Lit([f32; 3], f32);

    impl Keyed<3> for Lit {
        fn key(&self) -> [f32; 3] {
            self.0
        }
        fn weight(&self) -> f32 {
            1.0
        }
        fn value(&self) -> Option<f32> {
            Some(self.1)
        }
    }

    /// Nine in ten lie on one plane, which is the lowest there is along the longest way.
    #[test]
    fn where_most_lie_on_a_plane_cells_end_beside_it() {
        struct Point([f32; 3]);
        impl Keyed<3> for Point {
            fn key(&self) -> [f32; 3] {
                self.0
            }
            fn weight(&self) -> f32 {
                1.0
            }
        }
        let mut stream = Stream::new(7, 0, 0, Purpose::Study);
        let mut point = |index: u32| {
            let at = stream.square();
            Point([at.x, at.y, if index.is_multiple_of(10) { 1.0 + 9.0 * stream.uniform() } else { 0.0 }])
        };
        let known = (0..10_000).map(&mut point).collect();
        let mut counts = Vec::new();
        Cells::learn(known, 64.0, 15, |points: Vec<Point>| counts.push(points.len()));
        assert!(counts.iter().all(|count| *count < 200), "{counts:?}");
    }

    /// A wall stands between two rooms, one of which is dark.
    #[test]
    fn cells_end_where_values_change() {
        const WALL: f32 = 0.37;
        let mut stream = Stream::new(6, 0, 0, Purpose::Study);
        let mut point = || {
            let (at, z) = (stream.square(), stream.uniform());
            Lit([at.x, at.y, z], if at.x < WALL { 1.0 } else { 100.0 })
        };
        let known = (0..20_000).map(|_| point()).collect();
        let mean = |lit: Vec<Lit>| lit.iter().map(|lit| lit.1).sum::<f32>() / lit.len() as f32;
        let cells = Cells::learn(known, 64.0, 15, mean);
        for Lit(at, value) in (0..2000).map(|_| point()).filter(|lit| (lit.0[0] - WALL).abs() > 0.01) {
            assert_eq!(cells.at(at), Some(&value), "{at:?}");
        }
        assert!(Cells::<3, f32>::learn(Vec::<Lit>::new(), 64.0, 15, mean).at([0.5; 3]).is_none());
    }
}
