//! A phase function as meshes: its lobe, as far from the origin in every direction as the density is high there, and
//! what samples of it carry, as far as they are dense.

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

/// Corners and faces.
#[derive(Clone, Debug)]
pub struct Mesh {
    /// What it is of.
    of: &'static str,
    /// Distances in 1/sr; light flies along z before it is scattered.
    pub corners: Vec<DVec3>,
    /// Counter-clockwise as seen from outside.
    pub faces: Vec<Vec<u32>>,
}

impl Mesh {
    /// Of the density of `phase`: triangles at both poles, two for each cell between.
    pub fn of_density(phase: &Phase, division: Division) -> Self {
        let Division { parallels, meridians } = division;
        let corner = |parallel: usize, meridian: usize| {
            let place = division.place(parallel);
            division.direction(parallel, meridian) * quadrature::pdf_at(phase, place)
        };
        let mut corners = vec![corner(0, 0)];
        corners.extend(
            (1..parallels - 1).flat_map(|p| (0..meridians).map(move |m| (p, m))).map(|(p, m)| corner(p, m)),
        );
        corners.push(corner(parallels - 1, 0));
        Self { of: "density of a phase function", corners, faces: triangles(parallels, meridians) }
    }

    /// Of `counts`, one for each cell of the division, slice by slice from straight on: every cell is a plane face by
    /// itself, at the share of the samples that fell into it over its solid angle (P03T figs. A.7, A.8). Cells without
    /// a sample have none.
    pub fn of_samples(counts: &[u64], division: Division) -> Self {
        let meridians = division.meridians;
        let all = counts.iter().sum::<u64>() as f64;
        let (mut corners, mut faces) = (Vec::new(), Vec::new());
        for (cell, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
            let (slice, sector) = (cell / meridians, cell % meridians);
            let [low, high] = [slice, slice + 1].map(|parallel| division.place(parallel));
            let solid_angle = quadrature::solid_angle(low, high) / meridians as f64;
            let distance = *count as f64 / all / solid_angle;
            let first = corners.len() as u32;
            corners.extend(division.outline(slice, sector).into_iter().map(|corner| corner * distance));
            faces.push((first..corners.len() as u32).collect());
        }
        Self { of: "flux of samples over solid angle", corners, faces }
    }

    /// Writes a text file in the Stanford format.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let mut ply = Ply::<DefaultElement>::new();
        ply.header.encoding = Encoding::Ascii;
        ply.header.comments.push(format!("{} [1/sr]; forward is +z", self.of));
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
        ply.payload.insert("face".into(), self.faces.iter().map(|corners| face_of(corners)).collect());
        Writer::new().write_ply(out, &mut ply).map(|_| ())
    }
}

impl Division {
    /// Where a parallel lies, from 0, straight on, to 1, straight back.
    fn place(self, parallel: usize) -> f64 {
        parallel as f64 / (self.parallels - 1) as f64
    }

    /// Where a parallel and a meridian meet, a unit vector.
    fn direction(self, parallel: usize, meridian: usize) -> DVec3 {
        let (sine, cosine) = quadrature::angle_at(self.place(parallel)).sin_cos();
        let azimuth = TAU * meridian as f64 / self.meridians as f64;
        DVec3::new(sine * azimuth.cos(), sine * azimuth.sin(), cosine)
    }

    /// The corners of a cell, counter-clockwise as seen from outside: three at a pole, four elsewhere.
    fn outline(self, slice: usize, sector: usize) -> Vec<DVec3> {
        let upper = [(slice, sector + 1), (slice, sector)];
        let lower = [(slice + 1, sector), (slice + 1, sector + 1)];
        let at_first = if slice == 0 { &upper[..1] } else { &upper[..] };
        let at_last = if slice + 2 == self.parallels { &lower[..1] } else { &lower[..] };
        at_first
            .iter()
            .chain(at_last)
            .map(|(parallel, meridian)| self.direction(*parallel, *meridian))
            .collect()
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

fn face_of(corners: &[u32]) -> DefaultElement {
    let mut element = DefaultElement::new();
    element.insert(CORNERS.into(), Property::ListUInt(corners.to_vec()));
    element
}

/// Corner 0 is the pole straight on, the last the other; between them are rings of `meridians` corners.
fn triangles(parallels: usize, meridians: usize) -> Vec<Vec<u32>> {
    let ring =
        |parallel: usize, meridian: usize| (1 + (parallel - 1) * meridians + meridian % meridians) as u32;
    let last = (1 + (parallels - 2) * meridians) as u32;
    let mut all = Vec::new();
    for m in 0..meridians {
        all.push(vec![0, ring(1, m), ring(1, m + 1)]);
        for p in 1..parallels - 2 {
            all.push(vec![ring(p, m), ring(p + 1, m), ring(p + 1, m + 1)]);
            all.push(vec![ring(p, m), ring(p + 1, m + 1), ring(p, m + 1)]);
        }
        all.push(vec![ring(parallels - 2, m), last, ring(parallels - 2, m + 1)]);
    }
    all
}
