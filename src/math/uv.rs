//! Where on a surface textures are looked up. Of most surfaces none are, and most textures need no more than two coordinates.

use super::{Frame, Spectrum};
use glam::{Vec2, Vec3, vec2};
use std::f32::consts::FRAC_1_PI;

/// Where on a shape a texture is looked up. What takes long to compute is computed where a texture varies.
#[derive(Clone, Copy, Debug)]
pub enum Uv<'a> {
    /// u and v.
    At(Vec2),
    /// The unit direction from a sphere's centre, whose parallels u runs along, and v from pole to pole.
    OnSphere(Vec3),
    /// With all that is known of the place, where textures ask for more than u and v.
    Known(&'a Detail<'a>),
}

/// All that is known of a place on a surface.
#[derive(Clone, Copy, Debug)]
pub struct Detail<'a> {
    /// Texture coordinates.
    pub uv: Uv<'static>,
    /// World position, recentred.
    pub position: Vec3,
    /// The geometric normal, in the shading frame.
    pub normal: Vec3,
    /// How position changes with u and v (m), in the shading frame.
    pub partials: [Vec3; 2],
    /// What else the shape has values of.
    pub attributes: &'a [Attribute],
    /// Where these are.
    pub corners: Corners,
}

/// A place in a triangle of a mesh.
#[derive(Clone, Copy, Debug, Default)]
pub struct Corners {
    /// The number of the triangle.
    pub triangle: u32,
    /// Those of its corners.
    pub vertices: [u32; 3],
    /// Barycentric coordinates, of these corners.
    pub weights: Vec3,
}

/// Colours over a mesh.
#[derive(Clone, Debug)]
pub struct Attribute {
    /// As textures call it: `vertex_...`, interpolated between the corners, or `face_...`, one a triangle.
    pub name: String,
    /// One a vertex or triangle.
    pub values: Vec<Spectrum>,
}

impl Attribute {
    /// How the names of colours of triangles begin.
    pub const OF_FACES: &'static str = "face_";

    /// True if there is one a triangle.
    pub fn is_of_faces(&self) -> bool {
        self.name.starts_with(Self::OF_FACES)
    }

    fn at(&self, corners: &Corners) -> Spectrum {
        let [a, b, c] = corners.vertices.map(|vertex| vertex as usize);
        let Vec3 { x, y, z } = corners.weights;
        if self.is_of_faces() {
            self.values[corners.triangle as usize]
        } else {
            self.values[a] * x + self.values[b] * y + self.values[c] * z
        }
    }
}

impl Detail<'_> {
    /// The same in a frame that is itself given in the shading frame.
    pub fn turned(&self, frame: &Frame) -> Self {
        let partials = self.partials.map(|partial| frame.to_local(partial));
        Self { normal: frame.to_local(self.normal), partials, ..*self }
    }

    /// The value of the attribute `name`; black where there is none, which scenes are refused for.
    pub fn attribute(&self, name: &str) -> Spectrum {
        let found = self.attributes.iter().find(|attribute| attribute.name == name);
        found.map_or(Spectrum::ZERO, |attribute| attribute.at(&self.corners))
    }
}

impl Uv<'_> {
    /// u and v.
    #[inline]
    pub fn get(self) -> Vec2 {
        match self {
            Self::At(uv) => uv,
            Self::OnSphere(out) => on_sphere(out),
            Self::Known(detail) => detail.uv.get(),
        }
    }
}

impl From<Vec2> for Uv<'_> {
    #[inline]
    fn from(uv: Vec2) -> Self {
        Self::At(uv)
    }
}

#[inline(never)]
fn on_sphere(out: Vec3) -> Vec2 {
    let turn = out.y.atan2(out.x) * (0.5 * FRAC_1_PI);
    vec2(if turn < 0.0 { turn + 1.0 } else { turn }, out.z.clamp(-1.0, 1.0).acos() * FRAC_1_PI)
}
