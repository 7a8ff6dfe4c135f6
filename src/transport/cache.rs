//! The light subpaths that the camera subpaths of a block connect to. Each camera vertex connects to a fixed number of
//! light vertices, drawn uniformly: the cost of a pixel sample is linear in its length. Connecting to all vertices of
//! one light subpath is the estimator of LW96.

use super::{mis::MisSums, vertex::Vertex};
use crate::sampling::Stream;

/// Most vertices of a hero channel in a cache that is drawn from; some 50 MB. In thick white media some walks have
/// millions of vertices: a uniform choice then stands for all (algorithm R: Vitter 1985, "Random Sampling with a
/// Reservoir"). This is rare, for the limit is 16 times the average aimed at.
const MOST: usize = 1 << 18;

/// Vertices of light subpaths, those of one hero channel together.
#[derive(Clone, Debug)]
pub struct LightCache<S: MisSums> {
    pools: Vec<Pool<S>>,
    walks: Vec<Begun>,
}

#[derive(Clone, Debug)]
struct Pool<S: MisSums> {
    vertices: Vec<Vertex<S>>,
    /// Number of vertices that `vertices` stand for.
    count: usize,
    /// Light subpaths that could have left vertices here, times the probability that a vertex was kept.
    walks: f32,
}

/// Where the vertices of a walk begin.
#[derive(Clone, Copy, Debug)]
struct Begun {
    hero: usize,
    first: usize,
}

/// The light vertices that the vertices of one camera subpath are connected to.
#[derive(Clone, Copy, Debug)]
pub struct Partners<'a, S: MisSums> {
    vertices: &'a [Vertex<S>],
    /// The first of them in its pool.
    first: usize,
    /// How many of them each camera vertex is connected to.
    pub count: usize,
    /// True if they are drawn at random; else taken in order.
    is_drawn: bool,
    /// Factor from the sum over these connections to an estimate of the sum over all vertices of one light subpath: all
    /// vertices / (connections x walks) where they are drawn.
    pub scale: f32,
}

impl<'a, S: MisSums> Partners<'a, S> {
    /// Nothing to connect to.
    pub const NONE: Self = Self { vertices: &[], first: 0, count: 0, is_drawn: false, scale: 1.0 };

    /// The vertex for connection number `turn`, and its index in the pool.
    #[inline]
    pub fn pick(&self, turn: usize, stream: &mut Stream) -> (usize, &'a Vertex<S>) {
        let index = if self.is_drawn { stream.below(self.vertices.len()) } else { turn };
        (self.first + index, &self.vertices[index])
    }

    /// All of them.
    #[cfg(test)]
    pub fn vertices(&self) -> &'a [Vertex<S>] {
        self.vertices
    }
}

impl<S: MisSums> LightCache<S> {
    /// No walks, for `heroes` hero channels.
    pub fn new(heroes: usize) -> Self {
        let pool = |_| Pool { vertices: Vec::new(), count: 0, walks: 0.0 };
        Self { pools: (0..heroes).map(pool).collect(), walks: Vec::new() }
    }

    /// Counts one walk of `hero` whose vertices are kept with probability `keep`.
    pub fn add_walk(&mut self, hero: usize, keep: f32) {
        self.walks.push(Begun { hero, first: self.pools[hero].vertices.len() });
        self.pools[hero].walks += keep;
    }

    /// Keeps a vertex, always if `keeps_all`; its index in the pool, none if it was dropped.
    #[inline]
    pub fn push(
        &mut self,
        hero: usize,
        vertex: Vertex<S>,
        keeps_all: bool,
        stream: &mut Stream,
    ) -> Option<usize> {
        let Pool { vertices, count, .. } = &mut self.pools[hero];
        *count += 1;
        if vertices.len() < MOST || keeps_all {
            vertices.push(vertex);
            return Some(vertices.len() - 1);
        }
        let place = stream.below(*count);
        vertices.get_mut(place).map(|old| {
            *old = vertex;
            place
        })
    }

    /// `connections` uniform draws from the vertices for camera subpaths of `hero`.
    #[inline]
    pub fn drawn(&self, hero: usize, connections: u32) -> Partners<'_, S> {
        let pool = &self.pools[hero];
        if pool.vertices.is_empty() || connections == 0 {
            return Partners::NONE;
        }
        let scale = pool.count as f32 / (connections as f32 * pool.walks);
        Partners { vertices: &pool.vertices, first: 0, count: connections as usize, is_drawn: true, scale }
    }

    /// All vertices of one `walk`, by its number in the cache.
    pub fn all_of(&self, walk: usize) -> Partners<'_, S> {
        let Some(Begun { hero, first }) = self.walks.get(walk).copied() else { return Partners::NONE };
        let next = self.walks[walk + 1..].iter().find(|next| next.hero == hero);
        let all = &self.pools[hero].vertices;
        let vertices = &all[first..next.map_or(all.len(), |next| next.first)];
        Partners { vertices, first, count: vertices.len(), ..Partners::NONE }
    }

    /// Number of vertices that the cache stands for.
    pub fn len(&self) -> usize {
        self.pools.iter().map(|pool| pool.count).sum()
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
