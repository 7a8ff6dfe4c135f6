//! The cache of light walks that the eye walks of a block are joined with: joining every eye vertex with a
//! fixed number of its vertices, drawn uniformly, bounds the cost of a pixel sample linearly in its length.

use super::{vertex::Vertex, weight::Sums};

/// Vertices of light walks, those of one hero channel together.
#[derive(Clone, Debug)]
pub struct LightCache<S: Sums> {
    pools: Vec<Pool<S>>,
}

#[derive(Clone, Debug)]
struct Pool<S: Sums> {
    vertices: Vec<Vertex<S>>,
    /// Light walks that could have left vertices here, times the probability that a vertex was kept.
    walks: f32,
}

impl<S: Sums> LightCache<S> {
    /// No walks, for `heroes` hero channels.
    pub fn new(heroes: usize) -> Self {
        Self { pools: (0..heroes).map(|_| Pool { vertices: Vec::new(), walks: 0.0 }).collect() }
    }

    /// Counts one walk of `hero` whose vertices are kept with probability `keep`.
    pub fn add_walk(&mut self, hero: usize, keep: f32) {
        self.pools[hero].walks += keep;
    }

    /// Keeps a vertex.
    #[inline]
    pub fn push(&mut self, hero: usize, vertex: Vertex<S>) {
        self.pools[hero].vertices.push(vertex);
    }

    /// The vertices for eye walks of `hero`, and the factor that makes `joins` uniform draws from them an
    /// estimate of the sum over all vertices of one light walk: vertices / (joins x walks).
    #[inline]
    pub fn pool(&self, hero: usize, joins: u32) -> Option<(&[Vertex<S>], f32)> {
        let pool = &self.pools[hero];
        if pool.vertices.is_empty() || joins == 0 {
            return None;
        }
        Some((&pool.vertices, pool.vertices.len() as f32 / (joins as f32 * pool.walks)))
    }

    /// Vertices kept in all.
    pub fn len(&self) -> usize {
        self.pools.iter().map(|pool| pool.vertices.len()).sum()
    }

    /// True if no vertex was kept.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
