//! The paths of one pixel sample, written out for debugging: every vertex with its densities, every contribution with
//! its weight. Positions are those of the scene file.

pub mod outliers;
mod report;
pub mod sample;

pub use report::*;

use crate::{
    error::{Error, Result},
    math::{Spectrum, Vec3},
    medium::MediumIndex,
    render::{Settings, Stage},
    scene::{
        build::Setup,
        lights::{EmitterPoint, EmitterSample},
    },
    shape::SurfacePoint,
    transport::{Arrival, Interaction, Leg},
};
use sample::{Partner, PixelSample, Splat, Stop, Try, Walk};

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
    let stage = Stage::of(setup, film, settings);
    let pixel = y as usize * film.width as usize + x as usize;
    let numbers = u64::from(first)..u64::from(first) + u64::from(count);
    let max_depth = settings.options.max_depth;
    let samples = numbers.map(|number| {
        stage.show(number, |instrument, _| {
            describe(setup, max_depth, number, &PixelSample::of(instrument, number as usize, pixel))
        })
    });
    let samples = samples.collect::<Result<_>>()?;
    let made_by = concat!("Tyndall ", env!("CARGO_PKG_VERSION")).to_owned();
    Ok(Pixel { made_by, pixel: [x, y], seed: settings.seed, samples })
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
