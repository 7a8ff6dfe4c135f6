//! The path of a contribution, put together from what its subpaths did.

use super::{
    super::{Text, VertexText, sample::*},
    Outlier, PathVertex,
    search::{Found, Which},
};
use crate::{
    math::Vec2,
    scene::{
        build::Setup,
        lights::{EmissionSample, EmitterPoint, EmitterSample},
    },
    transport::strategy::StrategyKind,
};

/// The contribution that was `found`, in the sample that was made again; none if it is not there.
pub(super) fn replay(setup: &Setup, sample: &PixelSample, found: &Found) -> Option<Outlier> {
    let path = Path { text: Text { setup }, sample };
    let width = setup.film.width;
    let at = [found.pixel % width, found.pixel / width];
    let outlier = match found.which {
        Which::Try(number) => path.by_camera(sample.tries.get(number as usize)?)?,
        Which::Splat { walk, s } => {
            path.by_light(sample.splats.iter().find(|splat| splat.walk == walk && splat.s == s)?)?
        }
    };
    Some(Outlier { pixel: at, sample: found.sample, ..outlier })
}

/// Puts the path of a contribution together.
struct Path<'a> {
    text: Text<'a>,
    sample: &'a PixelSample,
}

impl Path<'_> {
    fn by_camera(&self, one: &Try) -> Option<Outlier> {
        let (joined, factor) = (one.contribution.as_ref()?, self.sample.factor);
        let walk = self.sample.camera.get(one.walk)?;
        let position = walk.start.map(|start| self.text.position(start.position));
        let mut path = vec![PathVertex { position, ..PathVertex::lens() }];
        let (vertices, tail) = match &one.partner {
            Partner::Met(arrival, point) => {
                let met = self.text.met(arrival, &point.point);
                let emitter = self.emitter(point.light, &point.point, met.density);
                (one.t - 2, vec![PathVertex { subpath: "camera", ..emitter }])
            }
            Partner::Emitter(EmitterSample { light, point, pdf, .. }) => {
                (one.t - 1, vec![self.emitter(*light, point, *pdf)])
            }
            Partner::Light { walk, edges, .. } => (one.t - 1, self.light(*walk, *edges)?),
        };
        let is_joined = one.s > 0;
        path.extend(self.stops(walk, vertices, is_joined, "camera"));
        path.extend(tail);
        Some(Outlier {
            film: self.sample.film.to_array(),
            strategy: one.kind.name(),
            unweighted: (joined.alone * factor).to_array(),
            weight: joined.share(),
            value: (joined.value * factor).to_array(),
            ..Outlier::of(one.s, one.t, path)
        })
    }

    fn by_light(&self, splat: &Splat) -> Option<Outlier> {
        let lens = self.text.setup.scene.sensor.ray(splat.film, Vec2::ZERO).position;
        let mut path = vec![PathVertex { position: Some(self.text.position(lens)), ..PathVertex::lens() }];
        path.extend(self.light(splat.walk, splat.s - 1)?);
        let joined = &splat.contribution;
        Some(Outlier {
            film: splat.film.to_array(),
            strategy: StrategyKind::Lens.name(),
            unweighted: (joined.alone * splat.share).to_array(),
            weight: joined.share(),
            value: splat.value().to_array(),
            ..Outlier::of(splat.s, 1, path)
        })
    }

    /// The first `vertices` of a walk after its start; the last of them may be joined to another subpath.
    fn stops(&self, walk: &Walk, vertices: u32, is_joined: bool, subpath: &'static str) -> Vec<PathVertex> {
        let stops = walk.stops.iter().take(vertices as usize).enumerate();
        let vertex = |(index, stop): (usize, &Stop)| {
            let goes_on = !is_joined || index + 1 < vertices as usize;
            let VertexText { kind, position, density, measure, medium, surface, onward, .. } =
                self.text.vertex(stop);
            PathVertex {
                kind,
                subpath,
                position,
                direction: None,
                density: Some(density),
                measure: Some(measure),
                dirac: goes_on && onward.is_some_and(|onward| onward.dirac),
                medium: Some(medium),
                surface,
                emitter: None,
            }
        };
        stops.map(vertex).collect()
    }

    /// The first `edges` segments of a light subpath, backwards.
    fn light(&self, walk: u64, edges: u32) -> Option<Vec<PathVertex>> {
        let walk = self.sample.light.get(&walk)?;
        let EmissionSample { light, point, pdf, .. } = &walk.emitter?;
        let mut path = vec![self.emitter(*light, point, *pdf)];
        path.extend(self.stops(walk, edges, true, "light"));
        path.reverse();
        Some(path)
    }

    /// A point of emitter number `light`.
    fn emitter(&self, light: u32, point: &EmitterPoint, density: f32) -> PathVertex {
        let measure = match point {
            EmitterPoint::Surface(_) => "1/m^2",
            EmitterPoint::Volume { .. } => "1/m^3",
            EmitterPoint::Direction(_) if self.is_hittable(light) => "1/sr",
            _ => "1",
        };
        let direction =
            if let EmitterPoint::Direction(towards) = point { Some(towards.to_array()) } else { None };
        PathVertex {
            kind: "emitter",
            subpath: "light",
            position: point.position().map(|position| self.text.position(position)),
            direction,
            density: Some(density),
            measure: Some(measure),
            emitter: Some(self.text.emitter(light)),
            ..PathVertex::lens()
        }
    }

    fn is_hittable(&self, light: u32) -> bool {
        self.text.setup.scene.lights.all[light as usize].emitter.is_hittable()
    }
}
