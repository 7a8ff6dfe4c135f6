//! What is told of the samples of one pixel.

use serde::Serialize;
use std::collections::BTreeMap;

/// Samples of one pixel.
#[derive(Clone, Debug, Serialize)]
pub struct Pixel {
    /// Which program wrote it, with its version.
    pub made_by: String,
    /// Column and row, from the left and from the top.
    pub pixel: [u32; 2],
    /// Seed of the render.
    pub seed: u64,
    /// One a pass.
    pub samples: Vec<Sample>,
}

/// What one pass adds to the pixel, and how.
#[derive(Clone, Debug, Serialize)]
pub struct Sample {
    /// Number of the pass, from 0.
    pub sample: u64,
    /// What the pass finds in the pixel, and adds to it if pixels have samples of their own: the sum of the values of all
    /// contributions and splats.
    pub value: [f32; 3],
    /// Where on the film the camera subpath starts (pixels).
    pub film: [f32; 2],
    /// Through which point of the aperture, as the sensor samples it.
    pub aperture: [f32; 2],
    /// Factor of the filter on what the camera subpath contributes: 1, but for filters with negative lobes.
    pub filter: f32,
    /// The channel that samples distances, where extinction differs between channels.
    pub hero: Option<&'static str>,
    /// The camera subpath; where an interaction is forced the walk from that collision, then that from what lies
    /// behind.
    pub eye_walks: Vec<WalkText>,
    /// The strategies tried from its vertices.
    pub contributions: Vec<Contribution>,
    /// What light subpaths contributed to the pixel through the lens (t = 1).
    pub splats: Vec<SplatText>,
    /// The light subpaths named by the others, by their number in the pass.
    pub light_walks: BTreeMap<u64, WalkText>,
}

/// A walk.
#[derive(Clone, Debug, Serialize)]
pub struct WalkText {
    /// Its start: of a camera subpath the lens, of a light subpath a point of an emitter; none where nothing left it.
    pub start: Option<StartText>,
    /// Vertices after the start, numbered from 1.
    pub vertices: Vec<VertexText>,
    /// How it ended.
    pub end: &'static str,
}

/// Where a walk starts.
#[derive(Clone, Debug, Serialize)]
pub struct StartText {
    /// Where.
    pub position: [f64; 3],
    /// The emitter, of a light subpath.
    pub emitter: Option<EmitterText>,
    /// Density of the point as a start of a light subpath, the choice of the emitter included.
    pub density: Option<f32>,
    /// How it goes on.
    pub onward: Onward,
}

/// An emitter.
#[derive(Clone, Debug, Serialize)]
pub struct EmitterText {
    /// Number in the order of the scene, from 1.
    pub index: usize,
    /// Its plugin.
    pub kind: &'static str,
    /// The shape that it lies on.
    pub shape: Option<ShapeText>,
    /// The medium that emits.
    pub medium: Option<String>,
}

/// A shape.
#[derive(Clone, Debug, Serialize)]
pub struct ShapeText {
    /// Number in the order of the scene file, from 1, as an aov integrator's shape_index.
    pub index: u32,
    /// Id or plugin.
    pub name: String,
}

/// How a walk leaves its start or a vertex.
#[derive(Clone, Debug, Serialize)]
pub struct Onward {
    /// Unit direction.
    pub direction: [f32; 3],
    /// Density of the direction, survival included (1/sr); the probability of a Dirac lobe; of a light subpath that
    /// starts at infinity the density on its disk of starts (1/m^2).
    pub density: f32,
    /// It is that of a Dirac lobe.
    pub dirac: bool,
    /// The medium that the walk is then in.
    pub medium: String,
    /// Contribution over density, the scattering here included.
    pub throughput: [f32; 3],
}

/// A vertex.
#[derive(Clone, Debug, Serialize)]
pub struct VertexText {
    /// What it lies on or in: "surface", "medium", or "escape" for a direction at infinity.
    pub kind: &'static str,
    /// Where; none at infinity.
    pub position: Option<[f64; 3]>,
    /// Unit direction towards the vertex before.
    pub incoming: [f32; 3],
    /// Density by the hero channel, given the vertex before, in `measure`.
    pub density: f32,
    /// "1/m^2" on surfaces, "1/m^3" in media, "1/sr" at infinity.
    pub measure: &'static str,
    /// Contribution over density of all before the scattering here.
    pub throughput: [f32; 3],
    /// The medium of the segment that ended here.
    pub medium: String,
    /// On a surface, what it is.
    pub surface: Option<SurfaceText>,
    /// In a medium, its extinction coefficient here (1/m).
    pub sigma_t: Option<[f32; 3]>,
    /// In a medium, its albedo here.
    pub albedo: Option<[f32; 3]>,
    /// How the walk went on; none where it ended.
    pub onward: Option<Onward>,
}

/// A point of a surface.
#[derive(Clone, Debug, Serialize)]
pub struct SurfaceText {
    /// Its shape.
    pub shape: ShapeText,
    /// Id or plugin of its BSDF.
    pub bsdf: String,
    /// Geometric normal.
    pub normal: [f32; 3],
    /// Shading normal.
    pub shading_normal: [f32; 3],
    /// Texture coordinates.
    pub uv: [f32; 2],
    /// Its plugin, if it emits.
    pub emitter: Option<&'static str>,
}

/// A strategy tried from a vertex of the camera subpath.
#[derive(Clone, Debug, Serialize)]
pub struct Contribution {
    /// Light vertices.
    pub s: u32,
    /// Camera vertices, the lens among them.
    pub t: u32,
    /// The kind of strategy.
    pub strategy: &'static str,
    /// The camera subpath, by its number from 0.
    pub eye_walk: usize,
    /// The last camera vertex, by its number in the walk. For s = 0 it is on the emitter.
    pub eye_vertex: u32,
    /// For s = 0, how the walk came to the emitter: in a medium and at infinity that is at no vertex of its own.
    pub met: Option<VertexText>,
    /// For s < 2, the point of the emitter.
    pub emitter: Option<PointText>,
    /// For s >= 2, the vertex of a light subpath.
    pub light: Option<LightVertex>,
    /// False where the way is blocked or nothing scatters along it.
    pub reached: bool,
    /// What remains of radiance along the connecting segment; 1 where there is none.
    pub transmittance: Option<[f32; 3]>,
    /// What the strategy would contribute alone: contribution over density and samples.
    pub unweighted: Option<[f32; 3]>,
    /// Its weight: over all strategies of one path they sum to 1.
    pub weight: Option<f32>,
    /// What the pixel gets.
    pub value: [f32; 3],
}

/// A vertex of a light subpath.
#[derive(Clone, Debug, Serialize)]
pub struct LightVertex {
    /// Number of the walk.
    pub walk: u64,
    /// Number of the vertex.
    pub vertex: u32,
}

/// A point of an emitter.
#[derive(Clone, Debug, Serialize)]
pub struct PointText {
    /// The emitter.
    pub emitter: EmitterText,
    /// Where; none at infinity.
    pub position: Option<[f64; 3]>,
    /// Unit direction towards it, at infinity.
    pub direction: Option<[f32; 3]>,
    /// Density by which next-event estimation picks it from here.
    pub connect_density: f32,
    /// Density by which light subpaths start there, learnt starts included.
    pub start_density: f32,
}

/// What a light subpath contributed through the lens.
#[derive(Clone, Debug, Serialize)]
pub struct SplatText {
    /// Light vertices; t = 1.
    pub s: u32,
    /// Number of the walk.
    pub walk: u64,
    /// Number of its vertex, 0 for the emitter.
    pub vertex: u32,
    /// Where it came down (pixels).
    pub film: [f32; 2],
    /// The share that the filter gives this pixel.
    pub share: f32,
    /// What remains of radiance along the connecting segment.
    pub transmittance: [f32; 3],
    /// What the strategy would contribute alone.
    pub unweighted: [f32; 3],
    /// Its weight.
    pub weight: f32,
    /// What the pixel gets.
    pub value: [f32; 3],
}
