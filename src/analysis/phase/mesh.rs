//! The lobe of a phase function as a mesh: as far from the origin in every direction as its density is high there.

use super::{Division, quadrature};
use crate::{math::DVec3, phase::Phase};
use ply_rs_bw::{
    ply::{
        Addable, DefaultElement, ElementDef, Encoding, Ply, Property, PropertyDef, PropertyType, ScalarType,
    },
    writer::Writer,
};
use std::{
    f64::consts::TAU,
    io::{self, Write},
};

/// Corners and triangles.
#[derive(Clone, Debug)]
pub struct Lobe {
    /// Distances in 1/sr; light flies along z before it is scattered.
    pub corners: Vec<DVec3>,
    /// Counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Lobe {
    /// Of the density of `phase`: triangles at both poles, two for each cell between.
    pub fn new(phase: &Phase, division: Division) -> Self {
        let Division { parallels, meridians } = division;
        let corner = |parallel: usize, meridian: usize| {
            let place = parallel as f64 / (parallels - 1) as f64;
            let (sine, cosine) = quadrature::angle_at(place).sin_cos();
            let azimuth = TAU * meridian as f64 / meridians as f64;
            let direction = DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine);
            direction * quadrature::pdf_at(phase, place)
        };
        let mut corners = vec![corner(0, 0)];
        corners.extend(
            (1..parallels - 1).flat_map(|p| (0..meridians).map(move |m| (p, m))).map(|(p, m)| corner(p, m)),
        );
        corners.push(corner(parallels - 1, 0));
        Self { corners, triangles: triangles(parallels, meridians) }
    }

    /// Writes a text file in the Stanford format.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let mut ply = Ply::<DefaultElement>::new();
        ply.header.encoding = Encoding::Ascii;
        ply.header.comments.push("density of a phase function [1/sr]; forward is +z".into());
        let mut vertex = ElementDef::new("vertex".into());
        for axis in AXES {
            vertex.properties.add(PropertyDef::new(axis.into(), PropertyType::Scalar(ScalarType::Float)));
        }
        let mut face = ElementDef::new("face".into());
        let list = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
        face.properties.add(PropertyDef::new(CORNERS.into(), list));
        ply.header.elements.add(vertex);
        ply.header.elements.add(face);
        ply.payload.insert("vertex".into(), self.corners.iter().map(vertex_of).collect());
        ply.payload.insert("face".into(), self.triangles.iter().map(face_of).collect());
        Writer::new().write_ply(out, &mut ply).map(|_| ())
    }
}

const AXES: [&str; 3] = ["x", "y", "z"];
const CORNERS: &str = "vertex_indices";

fn vertex_of(corner: &DVec3) -> DefaultElement {
    let mut element = DefaultElement::new();
    for (axis, value) in AXES.into_iter().zip(corner.to_array()) {
        element.insert(axis.into(), Property::Float(value as f32));
    }
    element
}

fn face_of(corners: &[u32; 3]) -> DefaultElement {
    let mut element = DefaultElement::new();
    element.insert(CORNERS.into(), Property::ListUInt(corners.to_vec()));
    element
}

/// Corner 0 is the pole straight on, the last the other; between them are rings of `meridians` corners.
fn triangles(parallels: usize, meridians: usize) -> Vec<[u32; 3]> {
    let ring =
        |parallel: usize, meridian: usize| (1 + (parallel - 1) * meridians + meridian % meridians) as u32;
    let last = (1 + (parallels - 2) * meridians) as u32;
    let mut all = Vec::new();
    for m in 0..meridians {
        all.push([0, ring(1, m), ring(1, m + 1)]);
        for p in 1..parallels - 2 {
            all.push([ring(p, m), ring(p + 1, m), ring(p + 1, m + 1)]);
            all.push([ring(p, m), ring(p + 1, m + 1), ring(p, m + 1)]);
        }
        all.push([ring(parallels - 2, m), last, ring(parallels - 2, m + 1)]);
    }
    all
}
