//! Triangle meshes: what files hold, placed in the world, checked and ready for rays.

use super::{
    area::AreaTable,
    flat::{Flat, flat_error},
    model::{Primitive, ShapeModel},
    orientation::turned_over,
    placement::{Placement, is_in_range, shift},
    point::{Hit, Ray, SurfacePoint},
    smooth,
};
use crate::{
    description::{Params, parameter::Parameter, rows},
    error::{Error, Result},
    math::{Attribute, Corners, DMat4, DVec3, Frame, Vec2, Vec3, axes, offset::LARGEST_COORDINATE, warp},
    memory,
    sampling::Stream,
};
use std::{
    collections::{BTreeMap, HashMap},
    path::Path,
};

/// What a mesh file says, in object space.
#[derive(Clone, Debug, Default)]
pub struct MeshData {
    /// Vertices.
    pub positions: Vec<DVec3>,
    /// One for each vertex (null where unknown), or none at all.
    pub normals: Vec<DVec3>,
    /// One for each vertex, or none at all.
    pub uvs: Vec<Vec2>,
    /// Vertex numbers, all in range.
    pub triangles: Vec<[u32; 3]>,
    /// Colours, as many of each as there are vertices or triangles.
    pub attributes: Vec<Attribute>,
}

impl MeshData {
    /// An error unless memory holds the mesh of `file`, whose `length` bytes become at most `factor` each.
    pub fn check_memory(file: &Path, length: u64, factor: u64) -> Result<()> {
        let remedy = "give a mesh of fewer triangles, or more memory";
        let size = format!("a file of {length} bytes");
        memory::check(file.display(), "a mesh", &size, length.checked_mul(factor), remedy)
    }
}

/// Triangles in recentred world space.
#[derive(Clone, Debug)]
pub struct Mesh {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    triangles: Vec<[u32; 3]>,
    attributes: Vec<Attribute>,
    areas: AreaTable,
    /// -1 if `flip_normals` is set.
    facing: f32,
}

/// What every mesh has.
pub(super) const FACE_NORMALS: &[Parameter] = rows! {
    boolean("face_normals", false,
        "True: flat faces. False: vertex normals of the file, or computed if it has none."),
};

impl Mesh {
    /// Reads the parameters every mesh has, and places `data`, read from `file`, by them. As in Mitsuba,
    /// vertex normals are computed where the file has none, unless `face_normals` is set.
    pub fn build(params: &Params<'_>, world: DMat4, file: &Path, mut data: MeshData) -> Result<Self> {
        let placement = Placement::read(params, world)?;
        let face_normals = params.boolean("face_normals")?;
        let positions: Vec<Vec3> = data.positions.iter().map(|p| placement.point(*p).as_vec3()).collect();
        if let Some(index) = positions.iter().position(|p| !is_in_range(*p)) {
            let found = format!("vertex {} at {}", index + 1, data.positions[index]);
            let remedy = "correct the file, or \"to_world\" if that makes it too large";
            return Err(Error::new(
                file.display(),
                format!("coordinates below {LARGEST_COORDINATE:e}"),
                found,
                remedy,
            ));
        }
        drop_degenerate(params, file, &positions, &mut data)?;
        let normals = match data.normals.as_slice() {
            _ if face_normals => vec![],
            [] => smooth::vertex_normals(&positions, &data.triangles),
            given => given.iter().map(|n| (placement.normal(*n) * placement.handedness).as_vec3()).collect(),
        };
        let areas = AreaTable::new(data.triangles.iter().map(|t| double_area(&positions, t) * 0.5));
        let facing = if placement.flip_normals { -1.0 } else { 1.0 } * placement.handedness as f32;
        let MeshData { uvs, triangles, attributes, .. } = data;
        Ok(Self { positions, normals, uvs, triangles, attributes, areas, facing })
    }

    /// True if every edge is shared: an even number of triangles has it. Vertices at one position are one.
    pub fn is_closed(&self) -> bool {
        self.open_edges().is_empty()
    }

    /// Every edge that an odd number of triangles has, from vertex to vertex as the last of these has it.
    fn open_edges(&self) -> BTreeMap<[[u32; 3]; 2], [u32; 2]> {
        let mut odd = BTreeMap::new();
        for [a, b, c] in &self.triangles {
            for edge in [[*a, *b], [*b, *c], [*c, *a]] {
                let [from, to] = edge.map(|vertex| self.place(vertex));
                let place = [from.min(to), from.max(to)];
                if odd.remove(&place).is_none() {
                    odd.insert(place, edge);
                }
            }
        }
        odd
    }

    /// Triangles from the edges of every opening to its middle; none where there is no opening, or nothing to close.
    pub fn lid(&self) -> Option<Self> {
        let mut open: Vec<[u32; 2]> = self.open_edges().into_values().collect();
        let (mut positions, mut triangles) = (Vec::new(), Vec::new());
        while let Some([start, mut end]) = open.pop() {
            let mut rim = vec![start];
            while self.place(end) != self.place(start)
                && let Some(next) = open.iter().position(|[from, _]| self.place(*from) == self.place(end))
            {
                rim.push(end);
                end = open.swap_remove(next)[1];
            }
            let (first, count) = (positions.len() as u32, rim.len() as u32);
            positions.extend(rim.iter().map(|vertex| self.positions[*vertex as usize]));
            positions.push(positions[first as usize..].iter().sum::<Vec3>() / count as f32);
            // The other way round than the triangles beyond the edges.
            triangles.extend((0..count).map(|i| [first + (i + 1) % count, first + i, first + count]));
        }
        triangles.retain(|t| (double_area(&positions, t) as f32).is_normal());
        let areas = AreaTable::new(triangles.iter().map(|t| double_area(&positions, t) * 0.5));
        let bare = Self { normals: vec![], uvs: vec![], attributes: vec![], ..self.clone() };
        let lid = Self { positions, triangles, areas, ..bare };
        let size = self.areas.total() + lid.areas.total();
        let holds_space = (self.volume() + lid.volume()).abs() > 1e-6 * size.powf(1.5);
        (!lid.triangles.is_empty() && holds_space).then_some(lid)
    }

    /// What it adds to the volume that a closed mesh holds, of which it is a part (m^3).
    pub fn volume(&self) -> f64 {
        let corners = |t: &[u32; 3]| t.map(|vertex| self.positions[vertex as usize].as_dvec3());
        self.triangles.iter().map(corners).map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum()
    }

    /// The same with all triangles facing as most of their neighbours do, and how many were turned over for that; none
    /// where they do.
    pub fn oriented(&self) -> Option<(Self, usize)> {
        let places: Vec<_> = self.triangles.iter().map(|t| t.map(|vertex| self.place(vertex))).collect();
        let turned = turned_over(&places)?;
        let mut mesh = self.clone();
        mesh.triangles.iter_mut().zip(&turned).filter(|(_, turned)| **turned).for_each(|(t, _)| t.swap(1, 2));
        Some((mesh, turned.iter().filter(|turned| **turned).count()))
    }

    /// True if it is closed and its normals point into what it holds.
    pub fn is_inside_out(&self) -> bool {
        self.volume() * f64::from(self.facing) < 0.0 && self.is_closed()
    }

    /// See [`super::Shape::displaced`]. Vertices at one position stay together.
    pub fn displaced(&self, moves: &BTreeMap<usize, f64>) -> Self {
        let mut planes: HashMap<[u32; 3], Vec<(DVec3, f64)>> = HashMap::new();
        for vertex in moves.keys().flat_map(|triangle| self.triangles[*triangle]) {
            planes.entry(self.place(vertex)).or_default();
        }
        for (index, triangle) in self.triangles.iter().enumerate() {
            for vertex in triangle {
                if let Some(planes) = planes.get_mut(&self.place(*vertex)) {
                    let normal = self.flat(index).normal.as_dvec3().normalize();
                    planes.push((normal, moves.get(&index).copied().unwrap_or(0.0)));
                }
            }
        }
        let shifts: HashMap<_, _> =
            planes.into_iter().map(|(place, planes)| (place, shift(&planes))).collect();
        let displaced = |vertex: usize| {
            let by = shifts.get(&self.place(vertex as u32)).copied().unwrap_or(DVec3::ZERO);
            (self.positions[vertex].as_dvec3() + by).as_vec3()
        };
        let positions: Vec<Vec3> = (0..self.positions.len()).map(displaced).collect();
        let areas = AreaTable::new(self.triangles.iter().map(|t| double_area(&positions, t) * 0.5));
        Self { positions, areas, ..self.clone() }
    }

    /// The position of vertex `index`, for comparison; 0 and -0 are one.
    fn place(&self, index: u32) -> [u32; 3] {
        (self.positions[index as usize] + Vec3::ZERO).to_array().map(f32::to_bits)
    }

    /// Its own colours.
    pub fn attributes(&self) -> &[Attribute] {
        &self.attributes
    }

    /// Where these are looked up at `point`: barycentric coordinates by the areas that it divides the triangle into.
    pub fn corners(&self, point: &SurfacePoint) -> Corners {
        let vertices = self.triangles[point.primitive as usize];
        let Flat { corner, edge_u, edge_v, .. } = self.flat(point.primitive as usize);
        // In f64, which the fourth power of the smallest triangle's sides does not leave.
        let [edge_u, edge_v, from] = [edge_u, edge_v, point.position - corner].map(Vec3::as_dvec3);
        let out = edge_u.cross(edge_v);
        let share = |part: DVec3| (part.dot(out) / out.length_squared()).clamp(0.0, 1.0) as f32;
        let (u, v) = (share(from.cross(edge_v)), share(edge_u.cross(from)));
        let weights = Vec3::new((1.0 - u - v).max(0.0), u, v);
        Corners { triangle: point.primitive, vertices, weights }
    }

    /// Triangle `index` as the ray tracer needs it.
    #[inline]
    pub fn flat(&self, index: usize) -> Flat {
        let [a, b, c] = axes(|i| self.positions[self.triangles[index][i] as usize]);
        let (edge_u, edge_v) = (b - a, c - a);
        let normal = edge_u.as_dvec3().cross(edge_v.as_dvec3()).normalize().as_vec3();
        Flat { corner: a, edge_u, edge_v, normal, triangle: true }
    }

    /// The point of triangle `index` at barycentric `u` (second corner), `v` (third corner).
    #[inline]
    pub fn point(&self, index: usize, u: f32, v: f32) -> SurfacePoint {
        let Flat { corner, edge_u, edge_v, normal, .. } = self.flat(index);
        let (along_u, along_v) = (edge_u * u, edge_v * v);
        let (uv, tangent) = self.texture(index, u, v, edge_u, edge_v);
        SurfacePoint {
            position: corner + (along_u + along_v),
            error: flat_error(corner, along_u, along_v),
            normal: normal * self.facing,
            shading: Frame::along(self.shading_normal(index, u, v, normal) * self.facing, tangent),
            uv: uv.into(),
            shape: 0,
            primitive: index as u32,
        }
    }

    /// Interpolated; the geometric one where that comes to nothing.
    #[inline]
    fn shading_normal(&self, index: usize, u: f32, v: f32, geometric: Vec3) -> Vec3 {
        if self.normals.is_empty() {
            return geometric;
        }
        let [a, b, c] = axes(|i| self.normals[self.triangles[index][i] as usize]);
        (a * (1.0 - u - v) + b * u + c * v).normalize_or(geometric)
    }

    /// Texture coordinates, and the direction in which u grows. Without coordinates: (u, v) themselves.
    #[inline]
    fn texture(&self, index: usize, u: f32, v: f32, edge_u: Vec3, edge_v: Vec3) -> (Vec2, Vec3) {
        if self.uvs.is_empty() {
            return (Vec2::new(u, v), edge_u);
        }
        let [a, b, c] = axes(|i| self.uvs[self.triangles[index][i] as usize]);
        let (along_u, along_v) = (b - a, c - a);
        let tangent = (edge_u * along_v.y - edge_v * along_u.y) * along_u.perp_dot(along_v).signum();
        (a + along_u * u + along_v * v, tangent)
    }
}

impl ShapeModel for Mesh {
    fn primitive_count(&self) -> usize {
        self.triangles.len()
    }

    fn primitive(&self, index: usize) -> Primitive {
        Primitive::Flat(self.flat(index))
    }

    #[inline]
    fn surface(&self, index: usize, _: &Ray, hit: &Hit) -> SurfacePoint {
        self.point(index, hit.u, hit.v)
    }

    fn area(&self) -> f32 {
        self.areas.total() as f32
    }

    fn sample_area(&self, stream: &mut Stream) -> SurfacePoint {
        let index = self.areas.sample(stream);
        let at = warp::to_triangle(stream.square());
        self.point(index, at.x, at.y)
    }
}

fn double_area(positions: &[Vec3], triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|i| positions[i as usize]);
    (b - a).as_dvec3().cross((c - a).as_dvec3()).length()
}

/// Those of `values` that are to be kept.
fn keep<T>(values: &mut Vec<T>, kept: &[bool]) {
    let mut kept = kept.iter();
    values.retain(|_| kept.next().is_some_and(|kept| *kept));
}

/// Takes out triangles without an area, with a warning; an error where none is left.
fn drop_degenerate(params: &Params<'_>, file: &Path, positions: &[Vec3], data: &mut MeshData) -> Result<()> {
    let before = data.triangles.len();
    // Normal as f32, so that 1 / area stays finite.
    let proper: Vec<bool> =
        data.triangles.iter().map(|t| (double_area(positions, t) as f32).is_normal()).collect();
    keep(&mut data.triangles, &proper);
    let of_faces = data.attributes.iter_mut().filter(|attribute| attribute.is_of_faces());
    of_faces.for_each(|attribute| keep(&mut attribute.values, &proper));
    let dropped = before - data.triangles.len();
    if data.triangles.is_empty() {
        let found = if before == 0 { "none".into() } else { format!("{before} without area") };
        let remedy = "give a mesh with at least one proper triangle";
        return Err(Error::new(file.display(), "triangles", found, remedy));
    }
    if dropped > 0 {
        let text =
            format!("{}: {dropped} of {before} triangles have no area and are ignored", file.display());
        params.library.warn(params.location(), &text);
    }
    Ok(())
}
