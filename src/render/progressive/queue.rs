//! Which pixel comes next: edges ordered by how much they may hide (P03T sec. 6.4).

use super::{
    conductance::Maps,
    mesh::{Edge, Mesh},
};
use crate::{
    film::format::to_xyz,
    math::{Spectrum, SpectrumExt, Vec3, colour::lab},
};
use std::{
    cmp::Ordering,
    collections::{BinaryHeap, HashSet},
};

/// Added to 1 - conductance, for shadows fall where nothing else changes. P03T has 0, which gave six times the error in
/// a picture of shadows on a wall (0.02 in its place; relMSE).
const UNSEEN: f64 = 1.0;
/// The luminance of a mean pixel over that of white: half the lightness.
const GREY: f32 = 0.18;

/// An edge in the queue.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Entry {
    measure: f64,
    edge: Edge,
}

impl Eq for Entry {}

impl Ord for Entry {
    fn cmp(&self, other: &Self) -> Ordering {
        self.measure.total_cmp(&other.measure).then_with(|| other.edge.cmp(&self.edge))
    }
}

impl PartialOrd for Entry {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// The edges of a mesh, the worst first.
pub(super) struct Queue {
    heap: BinaryHeap<Entry>,
    queued: HashSet<Edge>,
    /// The luminance that is taken as white.
    white: f32,
    /// Number of shaded pixels that it was found from.
    found_from: usize,
}

impl Queue {
    /// No edges.
    pub(super) fn new() -> Self {
        Self { heap: BinaryHeap::new(), queued: HashSet::new(), white: 1.0, found_from: 0 }
    }

    /// Adds `edges` of `mesh` that are not queued yet. Whenever the number of shaded pixels has doubled, finds white
    /// anew and measures all edges by it.
    pub(super) fn add(&mut self, mesh: &Mesh, maps: &Maps, edges: impl Iterator<Item = Edge>) {
        if mesh.len() >= 2 * self.found_from {
            let mean = mesh.radiances().map(|radiance| radiance.luminance().max(0.0)).sum::<f32>()
                / mesh.len() as f32;
            (self.white, self.found_from) = (if mean > 0.0 { mean / GREY } else { 1.0 }, mesh.len());
            (self.heap, self.queued) = (BinaryHeap::new(), HashSet::new());
            mesh.edges().for_each(|edge| self.push(mesh, maps, edge));
        } else {
            edges.for_each(|edge| self.push(mesh, maps, edge));
        }
    }

    fn push(&mut self, mesh: &Mesh, maps: &Maps, edge: Edge) {
        if let Some(measure) = self.measure(mesh, maps, edge)
            && self.queued.insert(edge)
        {
            self.heap.push(Entry { measure, edge });
        }
    }

    /// P03T sec. 6.4: e_measure, with [`UNSEEN`]; none for neighbours.
    fn measure(&self, mesh: &Mesh, maps: &Maps, [a, b]: Edge) -> Option<f64> {
        let (a, b) = (a as usize, b as usize);
        let place = |pixel: usize| [pixel % maps.width(), pixel / maps.width()];
        let [wide, high] = [0, 1].map(|axis| place(a)[axis].abs_diff(place(b)[axis]));
        if wide.max(high) < 2 {
            return None;
        }
        let colour = |pixel| mesh.at(pixel).map(|radiance| lab_over(radiance, self.white));
        let differs = colour(a)?.distance(colour(b)?);
        let hidden = 1.0 - f64::from(maps.along(a, b)) + UNSEEN;
        Some(hidden * (wide * wide + high * high) as f64 * (f64::from(differs) + 1.0))
    }

    /// Takes the worst edge that is still there.
    pub(super) fn pop(&mut self, mesh: &Mesh) -> Option<Edge> {
        loop {
            let Entry { edge, .. } = self.heap.pop()?;
            self.queued.remove(&edge);
            if mesh.has(edge) {
                return Some(edge);
            }
        }
    }
}

/// CIELAB of a radiance, relative to white of this luminance.
fn lab_over(radiance: Spectrum, white: f32) -> Vec3 {
    lab((to_xyz(radiance) / (to_xyz(Spectrum::ONE) * white)).max(Spectrum::ZERO))
}

/// The pixel that divides an edge: halfway between its middle and the step of greatest resistance (P03T sec. 6.4), or
/// the nearest pixel that is not `taken`; none where all are.
pub(super) fn division(maps: &Maps, [a, b]: Edge, taken: impl Fn(usize) -> bool) -> Option<usize> {
    let mut pixels = Vec::new();
    let (mut worst, mut at) = (0.0, None);
    maps.walk(a as usize, b as usize, |pixel, resistance| {
        if resistance > worst {
            (worst, at) = (resistance, Some(pixels.len()));
        }
        pixels.push(pixel);
    });
    let middle = pixels.len() / 2;
    let wanted = at.map_or(middle, |at| (at + middle) / 2);
    let mut near: Vec<usize> = (0..pixels.len()).collect();
    near.sort_by_key(|index| (index.abs_diff(wanted), *index));
    near.into_iter().map(|index| pixels[index]).find(|pixel| !taken(*pixel))
}
