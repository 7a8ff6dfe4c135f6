//! The triangles between shaded pixels: constrained Delaunay, whose corners are those of the image (P03T sec. 6.4).

use super::conductance::Maps;
use crate::math::Spectrum;
use rayon::prelude::*;
use spade::{
    ConstrainedDelaunayTriangulation, HasPosition, Point2, Triangulation,
    handles::{FixedVertexHandle, VertexHandle},
};

/// A shaded pixel.
#[derive(Clone, Copy, Debug)]
struct Shaded {
    pixel: usize,
    place: [i64; 2],
    radiance: Spectrum,
}

impl HasPosition for Shaded {
    type Scalar = f64;
    fn position(&self) -> Point2<f64> {
        let [x, y] = self.place;
        Point2::new(x as f64, y as f64)
    }
}

type Vertex<'a> = VertexHandle<'a, Shaded, (), spade::CdtEdge<()>, ()>;

/// Shaded pixels, and the triangles between them.
pub(super) struct Mesh {
    width: usize,
    triangles: ConstrainedDelaunayTriangulation<Shaded>,
    /// Of every pixel its vertex, if it is shaded.
    vertices: Vec<Option<FixedVertexHandle>>,
}

/// Two shaded pixels, the first one first.
pub(super) type Edge = [u32; 2];

impl Mesh {
    /// Nothing is shaded, of an image of these sizes.
    pub(super) fn new(width: usize, pixels: usize) -> Self {
        Self { width, triangles: ConstrainedDelaunayTriangulation::new(), vertices: vec![None; pixels] }
    }

    /// Number of shaded pixels.
    pub(super) fn len(&self) -> usize {
        self.triangles.num_vertices()
    }

    /// The radiance of a pixel, if it is shaded.
    pub(super) fn at(&self, pixel: usize) -> Option<Spectrum> {
        self.vertices[pixel].map(|vertex| self.triangles.vertex(vertex).data().radiance)
    }

    /// The radiances of all shaded pixels.
    pub(super) fn radiances(&self) -> impl Iterator<Item = Spectrum> + '_ {
        self.triangles.vertices().map(|vertex| vertex.data().radiance)
    }

    /// Adds a pixel that was not shaded yet; `hint` is a shaded pixel near it.
    pub(super) fn insert(&mut self, pixel: usize, radiance: Spectrum, hint: Option<usize>) {
        let place = [pixel % self.width, pixel / self.width].map(|x| x as i64);
        let shaded = Shaded { pixel, place, radiance };
        let added = match hint.and_then(|hint| self.vertices[hint]) {
            Some(hint) => self.triangles.insert_with_hint(shaded, hint),
            None => self.triangles.insert(shaded),
        };
        // Places are small whole numbers, which no triangulation refuses.
        self.vertices[pixel] = added.ok();
    }

    /// True if the edge is there.
    pub(super) fn has(&self, [a, b]: Edge) -> bool {
        let ends = self.vertices[a as usize].zip(self.vertices[b as usize]);
        ends.is_some_and(|(a, b)| self.triangles.get_edge_from_neighbors(a, b).is_some())
    }

    /// All edges.
    pub(super) fn edges(&self) -> impl Iterator<Item = Edge> + '_ {
        self.triangles.undirected_edges().map(|edge| {
            let [a, b] = edge.vertices();
            edge_of(a, b)
        })
    }

    /// The edges at a shaded pixel.
    pub(super) fn edges_at(&self, pixel: usize) -> impl Iterator<Item = Edge> + '_ {
        let vertex = self.vertices[pixel].map(|vertex| self.triangles.vertex(vertex));
        vertex.into_iter().flat_map(|vertex| vertex.out_edges().map(|edge| edge_of(edge.from(), edge.to())))
    }

    /// Makes a permanent edge between two shaded pixels, unless it would cross a permanent one. Returns the pixels
    /// whose edges may have changed.
    pub(super) fn constrain(&mut self, [a, b]: Edge) -> Vec<usize> {
        let Some((from, to)) = self.vertices[a as usize].zip(self.vertices[b as usize]) else {
            return Vec::new();
        };
        if !self.triangles.can_add_constraint(from, to) {
            return Vec::new();
        }
        let crossed = self.triangles.get_conflicting_edges_between_vertices(from, to);
        let around = crossed.flat_map(|edge| edge.vertices()).map(|vertex| vertex.data().pixel);
        let around: Vec<usize> = around.chain([a as usize, b as usize]).collect();
        self.triangles.add_constraint(from, to);
        around
    }

    /// The picture. Shaded pixels keep their radiance; others interpolate the corners of their triangle by Gouraud's
    /// weights (P03T sec. 6.4) times their similarity. Outlines stay sharp where triangles reach across.
    pub(super) fn paint(&self, maps: &Maps) -> Vec<Spectrum> {
        let faces: Vec<[Shaded; 3]> =
            self.triangles.inner_faces().map(|face| face.vertices().map(|vertex| *vertex.data())).collect();
        let painted: Vec<Vec<(usize, Spectrum)>> =
            faces.par_iter().map(|corners| self.fill(corners, maps)).collect();
        let mut picture = vec![Spectrum::ZERO; self.vertices.len()];
        painted.into_iter().flatten().for_each(|(pixel, value)| picture[pixel] = value);
        self.triangles.vertices().map(|vertex| *vertex.data()).for_each(|it| picture[it.pixel] = it.radiance);
        picture
    }

    /// The pixels of a triangle, those on its edges among them.
    fn fill(&self, corners: &[Shaded; 3], maps: &Maps) -> Vec<(usize, Spectrum)> {
        let [a, b, c] = corners.map(|corner| corner.place);
        let bound = |axis: usize| {
            let of = [a[axis], b[axis], c[axis]];
            of.into_iter().min().unwrap_or(0)..=of.into_iter().max().unwrap_or(0)
        };
        let twice =
            |[x, y]: [i64; 2], [p, q]: [i64; 2], [r, s]: [i64; 2]| (p - x) * (s - y) - (r - x) * (q - y);
        let all = twice(a, b, c);
        let mut filled = Vec::new();
        for y in bound(1) {
            for x in bound(0) {
                let at = [x, y];
                let parts =
                    [twice(at, b, c), twice(a, at, c), twice(a, b, at)].map(|part| part * all.signum());
                if parts.iter().all(|part| *part >= 0) {
                    let pixel = (y * self.width as i64 + x) as usize;
                    let weights = parts.map(|part| part as f32 / all.abs() as f32);
                    filled.push((pixel, blended(pixel, corners, weights, maps)));
                }
            }
        }
        filled
    }
}

/// Least similarity of a corner: where all corners are unlike the pixel, the weights are Gouraud's again.
const LEAST: f32 = 1e-4;

/// The mean of the corners, weighted by their similarity to the pixel.
fn blended(pixel: usize, corners: &[Shaded; 3], weights: [f32; 3], maps: &Maps) -> Spectrum {
    let (mut sum, mut all) = (Spectrum::ZERO, 0.0);
    for (corner, weight) in corners.iter().zip(weights).filter(|(_, weight)| *weight > 0.0) {
        let weight = weight * (maps.likeness(pixel, corner.pixel) + LEAST);
        (sum, all) = (sum + corner.radiance * weight, all + weight);
    }
    sum / all
}

fn edge_of(a: Vertex<'_>, b: Vertex<'_>) -> Edge {
    let [a, b] = [a, b].map(|vertex| vertex.data().pixel as u32);
    [a.min(b), a.max(b)]
}
