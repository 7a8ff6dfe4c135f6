//! The cache of light subpaths that the camera subpaths of a block are connected to: connecting every camera
//! vertex to a fixed number of its vertices, drawn uniformly, bounds the cost of a pixel sample linearly in
//! its length.

use super::{mis::MisSums, vertex::Vertex};

/// Vertices of light subpaths, those of one hero channel together.
#[derive(Clone, Debug)]
pub struct LightCache<S: MisSums> {
    pools: Vec<Pool<S>>,
}

#[derive(Clone, Debug)]
struct Pool<S: MisSums> {
    vertices: Vec<Vertex<S>>,
    /// Light subpaths that could have left vertices here, times the probability that a vertex was kept.
    walks: f32,
}

impl<S: MisSums> LightCache<S> {
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

    /// The vertices for camera subpaths of `hero`, and the factor that makes `connections` uniform draws from them an
    /// estimate of the sum over all vertices of one light subpath: vertices / (connections x walks).
    #[inline]
    pub fn pool(&self, hero: usize, connections: u32) -> Option<(&[Vertex<S>], f32)> {
        let pool = &self.pools[hero];
        if pool.vertices.is_empty() || connections == 0 {
            return None;
        }
        Some((&pool.vertices, pool.vertices.len() as f32 / (connections as f32 * pool.walks)))
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
