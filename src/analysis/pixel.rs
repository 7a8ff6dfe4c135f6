//! The paths of one pixel sample, written out for debugging: every vertex with its densities, every contribution with
//! its weight. Positions are those of the scene file.

pub mod sample;

use crate::{
    error::{Error, Result},
    math::{Spectrum, Vec3},
    medium::MediumIndex,
    render::{Settings, instrument::Instrument},
    scene::{
        build::Setup,
        lights::{EmitterPoint, EmitterSample},
    },
    shape::SurfacePoint,
    transport::{Arrival, Interaction, Leg},
};
use sample::{Partner, PixelSample, Splat, Stop, Try, Walk};
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
    /// What the pass adds to the pixel: the sum of the values of all contributions and splats.
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

/// Makes `count` samples of pixel (`x`, `y`) again, from sample number `first`, of a render by `settings`.
pub fn examine(
    setup: &Setup,
    settings: &Settings,
    [x, y]: [u32; 2],
    first: u32,
    count: u32,
) -> Result<Pixel> {
    let film = &setup.film;
    let size = [film.width, film.height];
    for (name, at, size) in [("X", x, size[0]), ("Y", y, size[1])] {
        if at >= size {
            let expected = format!("a pixel of the image, from 0 to {}", size - 1);
            let remedy = "choose one within the image, or another --size";
            return Err(Error::new(name, expected, at.to_string(), remedy));
        }
    }
    super::check_paths(settings.options.algorithm)?;
    let instrument = Instrument::new(&setup.scene, film, settings);
    let pixel = y as usize * film.width as usize + x as usize;
    let numbers = u64::from(first)..u64::from(first) + u64::from(count);
    let max_depth = settings.options.max_depth;
    let samples = numbers.map(|number| {
        describe(setup, max_depth, number, &PixelSample::of(&instrument, number as usize, pixel))
    });
    let made_by = concat!("Tyndall ", env!("CARGO_PKG_VERSION")).to_owned();
    Ok(Pixel { made_by, pixel: [x, y], seed: settings.seed, samples: samples.collect() })
}

impl Pixel {
    /// As JSON. What is not finite is null.
    pub fn json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }
}

/// Writes sample number `number` out.
fn describe(setup: &Setup, max_depth: Option<u32>, number: u64, sample: &PixelSample) -> Sample {
    let text = Text { setup };
    let longest = max_depth.unwrap_or(u32::MAX);
    Sample {
        sample: number,
        value: sample.value.to_array(),
        film: sample.film.to_array(),
        aperture: sample.aperture.to_array(),
        filter: sample.factor,
        hero: sample.hero.map(|hero| ["red", "green", "blue"][hero]),
        eye_walks: sample.camera.iter().map(|walk| text.walk(walk, longest)).collect(),
        contributions: sample.tries.iter().map(|one| text.contribution(one, sample.factor)).collect(),
        splats: sample.splats.iter().map(splat).collect(),
        light_walks: sample
            .light
            .iter()
            .map(|(number, walk)| (*number, text.walk(walk, longest.saturating_sub(1))))
            .collect(),
    }
}

fn splat(splat: &Splat) -> SplatText {
    SplatText {
        s: splat.s,
        walk: splat.walk,
        vertex: splat.s - 1,
        film: splat.film.to_array(),
        share: splat.share,
        transmittance: splat.contribution.transmittance.to_array(),
        unweighted: (splat.contribution.alone * splat.share).to_array(),
        weight: splat.contribution.share(),
        value: splat.value().to_array(),
    }
}

/// What a scene calls its parts.
struct Text<'a> {
    setup: &'a Setup,
}

impl Text<'_> {
    fn position(&self, position: Vec3) -> [f64; 3] {
        (position.as_dvec3() + self.setup.scene.recentre).to_array()
    }

    fn medium(&self, medium: MediumIndex) -> String {
        self.setup.medium_name(medium)
    }

    fn shape(&self, shape: u32) -> ShapeText {
        ShapeText { index: shape + 1, name: self.setup.shape_names[shape as usize].clone() }
    }

    fn emitter(&self, light: u32) -> EmitterText {
        let index = light as usize;
        let light = &self.setup.scene.lights.all[index];
        let shines = light.emitter.name == "medium";
        EmitterText {
            index: index + 1,
            kind: light.emitter.name,
            shape: light.shape.map(|shape| self.shape(shape)),
            medium: shines.then(|| self.medium(light.medium)),
        }
    }

    fn surface(&self, point: &SurfacePoint) -> SurfaceText {
        let scene = &self.setup.scene;
        let surface = scene.surface(point.shape);
        SurfaceText {
            shape: self.shape(point.shape),
            bsdf: self.setup.bsdf_names[surface.bsdf as usize].clone(),
            normal: point.normal.to_array(),
            shading_normal: point.shading.normal.to_array(),
            uv: point.uv.get().to_array(),
            emitter: surface.emitter.map(|light| scene.lights.all[light as usize].emitter.name),
        }
    }

    fn onward(&self, leg: &Leg) -> Onward {
        Onward {
            direction: leg.direction.to_array(),
            density: leg.density,
            dirac: leg.dirac,
            medium: self.medium(leg.medium),
            throughput: leg.throughput.to_array(),
        }
    }

    fn vertex(&self, stop: &Stop) -> VertexText {
        let position = Some(stop.interaction.position());
        let onward = stop.onward.as_ref().map(|leg| self.onward(leg));
        match &stop.interaction {
            Interaction::Surface(point) => VertexText {
                surface: Some(self.surface(point)),
                onward,
                ..self.arrival(&stop.arrival, "surface", position)
            },
            Interaction::Medium(_, matter) => VertexText {
                sigma_t: Some(matter.sigma_t.to_array()),
                albedo: Some(matter.albedo.to_array()),
                onward,
                ..self.arrival(&stop.arrival, "medium", position)
            },
        }
    }

    /// Where a walk met an emitter.
    fn met(&self, arrival: &Arrival, point: &EmitterPoint) -> VertexText {
        let kind = match point {
            EmitterPoint::Surface(_) | EmitterPoint::Point(_) | EmitterPoint::Beam { .. } => "surface",
            EmitterPoint::Volume { .. } => "medium",
            EmitterPoint::Direction(_) => "escape",
        };
        self.arrival(arrival, kind, point.position())
    }

    fn arrival(&self, arrival: &Arrival, kind: &'static str, position: Option<Vec3>) -> VertexText {
        let measure = match kind {
            "surface" => "1/m^2",
            "medium" => "1/m^3",
            _ => "1/sr",
        };
        VertexText {
            kind,
            position: position.map(|position| self.position(position)),
            incoming: arrival.incoming.to_array(),
            density: arrival.density,
            measure,
            throughput: arrival.throughput.to_array(),
            medium: self.medium(arrival.medium),
            surface: None,
            sigma_t: None,
            albedo: None,
            onward: None,
        }
    }

    fn walk(&self, walk: &Walk, longest: u32) -> WalkText {
        let start = walk.start.as_ref().map(|leg| StartText {
            position: self.position(walk.emitter.map_or(leg.position, |start| start.position())),
            emitter: walk.emitter.map(|start| self.emitter(start.light)),
            density: walk.emitter.map(|start| start.pdf),
            onward: self.onward(leg),
        });
        let left = walk.stops.last().map_or(walk.start.is_some(), |stop| stop.onward.is_some());
        let end = match () {
            () if left => "left the scene",
            () if walk.stops.len() as u64 >= u64::from(longest) => "as long as paths may be",
            () => "absorbed",
        };
        WalkText { start, vertices: walk.stops.iter().map(|stop| self.vertex(stop)).collect(), end }
    }

    fn point(&self, sample: &EmitterSample) -> PointText {
        let direction =
            if let EmitterPoint::Direction(towards) = sample.point { Some(towards) } else { None };
        PointText {
            emitter: self.emitter(sample.light),
            position: sample.point.position().map(|position| self.position(position)),
            direction: direction.map(|towards| towards.to_array()),
            connect_density: sample.pdf,
            start_density: sample.pdf_start,
        }
    }

    fn contribution(&self, one: &Try, factor: f32) -> Contribution {
        let (emitter, met, light) = match &one.partner {
            Partner::Met(arrival, sample) => {
                (Some(self.point(sample)), Some(self.met(arrival, &sample.point)), None)
            }
            Partner::Emitter(sample) => (Some(self.point(sample)), None, None),
            Partner::Light { walk, edges, .. } => {
                (None, None, Some(LightVertex { walk: *walk, vertex: *edges }))
            }
        };
        let joined = one.contribution.as_ref();
        Contribution {
            s: one.s,
            t: one.t,
            strategy: one.kind.name(),
            eye_walk: one.walk,
            eye_vertex: one.t - 1,
            met,
            emitter,
            light,
            reached: joined.is_some(),
            transmittance: joined.map(|joined| joined.transmittance.to_array()),
            unweighted: joined.map(|joined| (joined.alone * factor).to_array()),
            weight: joined.map(|joined| joined.share()),
            value: joined.map_or(Spectrum::ZERO, |joined| joined.value * factor).to_array(),
        }
    }
}
