//! Samples on an integer lattice, as files hold them: what grids are built from.

use std::marker::PhantomData;

/// Values at the points of a lattice. Grids interpolate between them.
pub trait Samples<V>: Send + Sync {
    /// Number of samples along x, y and z, each at least 1.
    fn size(&self) -> [usize; 3];

    /// The sample at an index below `size`.
    fn at(&self, index: [usize; 3]) -> V;

    /// The value of all samples from `low` to `high`, both included, if the source knows without looking at each that
    /// they are equal; a sparse file does so for what it leaves out.
    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<V>;

    /// Shows `visit` every sample with its index and a count of 1; of many that a source knows to be equal, one with
    /// their count. What a sparse file leaves out counts once.
    fn each(&self, visit: &mut dyn FnMut([usize; 3], V, u64)) {
        let [x, y, z] = self.size();
        let indices = (0..z).flat_map(|k| (0..y).flat_map(move |j| (0..x).map(move |i| [i, j, k])));
        indices.for_each(|index| visit(index, self.at(index), 1));
    }
}

impl<V, S: Samples<V> + ?Sized> Samples<V> for Box<S> {
    fn size(&self) -> [usize; 3] {
        (**self).size()
    }

    fn at(&self, index: [usize; 3]) -> V {
        (**self).at(index)
    }

    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<V> {
        (**self).uniform(low, high)
    }

    fn each(&self, visit: &mut dyn FnMut([usize; 3], V, u64)) {
        (**self).each(visit);
    }
}

/// Samples of which a function is taken.
pub struct Mapped<T, S, F> {
    samples: S,
    function: F,
    of: PhantomData<fn(T)>,
}

impl<T, S, F> Mapped<T, S, F> {
    /// `function` of each of `samples`.
    pub fn new(samples: S, function: F) -> Self {
        Self { samples, function, of: PhantomData }
    }
}

impl<T, U, S: Samples<T>, F: Fn(T) -> U + Send + Sync> Samples<U> for Mapped<T, S, F> {
    fn size(&self) -> [usize; 3] {
        self.samples.size()
    }

    fn at(&self, index: [usize; 3]) -> U {
        (self.function)(self.samples.at(index))
    }

    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<U> {
        self.samples.uniform(low, high).map(&self.function)
    }

    fn each(&self, visit: &mut dyn FnMut([usize; 3], U, u64)) {
        self.samples.each(&mut |index, value, count| visit(index, (self.function)(value), count));
    }
}
