//! Samples on an integer lattice, as files hold them: what grids are built from.

/// Values at the points of a lattice. Grids interpolate between them.
pub trait Samples<V> {
    /// Number of samples along x, y and z, each at least 1.
    fn size(&self) -> [usize; 3];

    /// The sample at an index below `size`.
    fn at(&self, index: [usize; 3]) -> V;

    /// The value of all samples from `low` to `high`, both included, if the source knows without looking at each that
    /// they are equal; a sparse file does so for what it leaves out.
    fn uniform(&self, low: [usize; 3], high: [usize; 3]) -> Option<V>;
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
}
