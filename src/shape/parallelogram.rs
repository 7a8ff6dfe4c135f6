//! Parallelograms: rectangles under any affine transform, and the faces of cubes.

use super::{
    area::AreaTable,
    flat::{Flat, flat_error},
    model::{Primitive, ShapeModel},
    placement::{Placement, is_in_range, shift},
    point::{Hit, Ray, SurfacePoint},
    spherical_rectangle::{Seen, SphericalRectangle},
};
use crate::{
    description::Params,
    error::{Error, Result},
    math::{DMat3, DMat4, DVec3, Frame, Vec3, measure, vec2},
    sampling::Stream,
};
use std::collections::BTreeMap;

/// corner + u `edge_u` + v `edge_v` for u, v in [0, 1]; (u, v) are the texture coordinates too.
#[derive(Clone, Copy, Debug)]
pub struct Parallelogram {
    corner: Vec3,
    edge_u: Vec3,
    edge_v: Vec3,
    normal: Vec3,
    shading: Frame,
    area: f64,
}

impl Parallelogram {
    /// The image of `face`, its normal given in object space too. Mitsuba takes the geometric normal from the
    /// winding and the shading normal from the transformed object normal: under a mirroring they are opposite.
    fn place(placement: &Placement, grid: &Grid, face: &ObjectFace) -> Self {
        let [corner, edge_u, edge_v, normal] = face.map(DVec3::from);
        let turn = if placement.flip_normals { -placement.handedness } else { placement.handedness };
        let winding = normal.dot(edge_u.cross(edge_v)).signum();
        let corner = grid.snap(placement.point(corner));
        let (edge_u, edge_v) = (grid.snap(placement.vector(edge_u)), grid.snap(placement.vector(edge_v)));
        let shading_turn = if placement.is_mirrored() { -1.0 } else { 1.0 };
        Self::spanned(corner, edge_u, edge_v, winding * turn, shading_turn)
    }

    /// From rounded edges: `turn` is 1 where the normal is that of u x v, else -1; `shading_turn` is 1 where the shading
    /// normal is that, else -1. The plane is that of the points.
    fn spanned(corner: Vec3, edge_u: Vec3, edge_v: Vec3, turn: f64, shading_turn: f32) -> Self {
        let cross = edge_u.as_dvec3().cross(edge_v.as_dvec3());
        let normal = (cross.normalize() * turn).as_vec3();
        let shading = Frame::along(normal * shading_turn, edge_u);
        Self { corner, edge_u, edge_v, normal, shading, area: cross.length() }
    }

    /// True if `corner` is one of it, up to rounding.
    fn holds(&self, corner: DVec3) -> bool {
        let slack = 1e-3 * f64::from(self.edge_u.length().min(self.edge_v.length()));
        self.corners().iter().any(|own| own.distance(corner) < slack)
    }

    fn corners(&self) -> [DVec3; 4] {
        let [corner, u, v] = [self.corner, self.edge_u, self.edge_v].map(|p| p.as_dvec3());
        [corner, corner + u, corner + v, corner + u + v]
    }

    /// The same between other corners.
    fn between(&self, [corner, u, v, _]: [DVec3; 4]) -> Self {
        let [corner, u, v] = [corner, u - corner, v - corner].map(|p| p.as_vec3());
        let turn = self.edge_u.cross(self.edge_v).dot(self.normal).signum();
        let shading_turn = self.normal.dot(self.shading.normal).signum();
        Self::spanned(corner, u, v, f64::from(turn), shading_turn)
    }

    /// As the ray tracer needs it.
    pub fn flat(&self) -> Flat {
        let Self { corner, edge_u, edge_v, normal, .. } = *self;
        Flat { corner, edge_u, edge_v, normal, triangle: false }
    }

    /// The point (`u`, `v`).
    #[inline]
    pub fn point(&self, u: f32, v: f32) -> SurfacePoint {
        let (along_u, along_v) = (self.edge_u * u, self.edge_v * v);
        SurfacePoint {
            position: self.corner + (along_u + along_v),
            error: flat_error(self.corner, along_u, along_v),
            normal: self.normal,
            shading: self.shading,
            uv: vec2(u, v).into(),
            shape: 0,
            primitive: 0,
        }
    }

    /// f32 can hold it.
    fn fits(&self) -> bool {
        (self.area as f32).is_normal()
            && [self.corner, self.edge_u, self.edge_v, self.normal].into_iter().all(is_in_range)
    }
}

/// Steps per axis in which all corners and edges of a shape are whole numbers: every corner is then exact
/// however it is summed, and the faces of a box touch without gaps. 0: no steps.
struct Grid(DVec3);

impl Grid {
    /// For faces by their four corners, along u first.
    fn new(faces: &[[DVec3; 4]]) -> Self {
        let reach = faces.iter().flatten().fold(DVec3::ZERO, |reach, corner| reach.max(corner.abs()));
        // The last place of the largest f32 coordinate.
        let step = reach.map(|r| f64::from(f32::EPSILON) * r.log2().floor().exp2());
        let edges = faces.iter().flat_map(|[corner, u, v, _]| [u - corner, v - corner]);
        let shortest = edges.map(DVec3::length).fold(f64::INFINITY, f64::min);
        // Shapes this much smaller than their distance from the origin would be bent out of shape.
        let fits = step.max_element() * 1000.0 < shortest;
        Self(if fits { step } else { DVec3::ZERO })
    }

    fn snap(&self, v: DVec3) -> Vec3 {
        DVec3::select(self.0.cmpgt(DVec3::ZERO), (v / self.0).round() * self.0, v).as_vec3()
    }
}

/// The corners of the faces of a box, or of a single one, in whole steps: all are sums of the same few edges, so that faces
/// have their corners in common to the bit.
fn snapped(faces: &[[DVec3; 4]]) -> Vec<[DVec3; 4]> {
    let grid = Grid::new(faces);
    let [origin, u, v, _] = faces[0];
    let normal = (u - origin).cross(v - origin);
    let height = |corner: &DVec3| normal.dot(*corner - origin).abs();
    let farthest = faces.iter().flatten().max_by(|a, b| height(a).total_cmp(&height(b)));
    // Of a single face, anything across it.
    let apex =
        farthest.copied().filter(|corner| height(corner) > 1e-3 * normal.length()).unwrap_or(origin + normal);
    let given = DMat3::from_cols(u - origin, v - origin, apex - origin).inverse();
    let snap = |p: DVec3| grid.snap(p).as_dvec3();
    let base = snap(origin);
    let edges = DMat3::from_cols(snap(u) - base, snap(v) - base, snap(apex) - base);
    let place = |corner: DVec3| base + edges * (given * (corner - origin)).round();
    faces.iter().map(|corners| corners.map(place)).collect()
}

/// One or more parallelograms as one shape.
#[derive(Clone, Debug)]
pub struct Parallelograms {
    faces: Vec<Parallelogram>,
    areas: AreaTable,
    /// Where it is a single right-angled one: sampling by solid angle.
    spherical: Option<SphericalRectangle>,
}

/// A face in object space: corner, edges along growing u and v, normal.
pub(super) type ObjectFace = [[f64; 3]; 4];

impl Parallelograms {
    /// Places `faces` by the parameters `to_world` and `flip_normals`.
    pub fn build(params: &Params<'_>, world: DMat4, faces: &[ObjectFace]) -> Result<Self> {
        let placement = Placement::read(params, world)?;
        let corners = faces.iter().map(|face| {
            let [corner, u, v, _] = face.map(DVec3::from);
            [corner, corner + u, corner + v, corner + u + v].map(|corner| placement.point(corner))
        });
        let grid = Grid::new(&corners.collect::<Vec<_>>());
        let faces: Vec<_> = faces.iter().map(|face| Parallelogram::place(&placement, &grid, face)).collect();
        if faces.iter().all(Parallelogram::fits) {
            return Ok(Self::new(faces));
        }
        Err(Error::new(
            params.location(),
            format!("a {} with finite corners and an area", params.object.plugin),
            "one that f32 coordinates cannot hold (too large, too small or too flat)",
            "correct \"to_world\"",
        ))
    }

    fn new(faces: Vec<Parallelogram>) -> Self {
        let areas = AreaTable::new(faces.iter().map(|face| face.area));
        let spherical = match faces.as_slice() {
            [face] => SphericalRectangle::new(face.corner, face.edge_u, face.edge_v),
            _ => None,
        };
        Self { faces, areas, spherical }
    }

    /// See [`super::Shape::winding`].
    pub fn winding(&self, index: usize) -> f64 {
        let centre = |face: &Parallelogram| face.corners().iter().sum::<DVec3>() * 0.25;
        let middle = self.faces.iter().map(centre).sum::<DVec3>() / self.faces.len() as f64;
        let face = &self.faces[index];
        (centre(face) - middle).dot(face.normal.as_dvec3()).signum()
    }

    /// See [`super::Shape::displaced`].
    pub fn displaced(&self, moves: &BTreeMap<usize, f64>) -> Self {
        let planes: Vec<_> = (self.faces.iter().enumerate())
            .map(|(index, face)| (face, moves.get(&index).copied().unwrap_or(0.0)))
            .collect();
        let displaced = |corner: DVec3| {
            let through = planes.iter().filter(|(face, _)| face.holds(corner));
            let planes: Vec<_> =
                through.map(|(face, by)| (face.normal.as_dvec3().normalize(), *by)).collect();
            corner + shift(&planes)
        };
        let corners: Vec<_> = self.faces.iter().map(|face| face.corners().map(displaced)).collect();
        let snapped = snapped(&corners);
        Self::new(self.faces.iter().zip(snapped).map(|(face, corners)| face.between(corners)).collect())
    }

    fn seen_from(&self, reference: Vec3) -> Option<Seen> {
        self.spherical.as_ref().and_then(|s| s.seen_from(reference))
    }
}

impl ShapeModel for Parallelograms {
    fn primitive_count(&self) -> usize {
        self.faces.len()
    }

    fn primitive(&self, index: usize) -> Primitive {
        Primitive::Flat(self.faces[index].flat())
    }

    #[inline]
    fn surface(&self, index: usize, _: &Ray, hit: &Hit) -> SurfacePoint {
        SurfacePoint { primitive: index as u32, ..self.faces[index].point(hit.u, hit.v) }
    }

    fn area(&self) -> f32 {
        self.areas.total() as f32
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        let index = if self.faces.len() == 1 { 0 } else { self.areas.sample(stream) };
        let at = stream.square();
        self.faces[index].point(at.x, at.y)
    }

    /// Uniform in solid angle from `reference` where that is precise, else by area; with its density (1/m^2).
    fn sample_toward(&self, reference: Vec3, stream: &mut Stream) -> (SurfacePoint, f32) {
        let Some(seen) = self.seen_from(reference) else {
            return (self.sample_area(stream), 1.0 / self.area());
        };
        let at = seen.sample(stream.square());
        let point = self.faces[0].point(at.x, at.y);
        (point, pdf_area_from_solid_angle(&seen, reference, &point))
    }

    fn pdf_area_toward(&self, reference: Vec3, point: &SurfacePoint) -> f32 {
        match self.seen_from(reference) {
            Some(seen) => pdf_area_from_solid_angle(&seen, reference, point),
            None => 1.0 / self.area(),
        }
    }
}

/// Uniform in solid angle, as a density per area (1/m^2).
fn pdf_area_from_solid_angle(seen: &Seen, reference: Vec3, point: &SurfacePoint) -> f32 {
    let Some((direction, _, squared)) = measure::between(point.position, reference) else { return 0.0 };
    measure::solid_angle_to_vertex(direction.dot(point.normal), squared) * seen.pdf_sr()
}
