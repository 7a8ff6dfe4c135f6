//! What primary rays see: alpha, and the layers that describe the first surface. A cheap pass of its own,
//! only where something requests it. Pixels take no samples of others, whichever those of the image take: what is even
//! stays even up to the border, and alpha within [0, 1].

use super::{instrument::Instrument, subject::Stage};
use crate::{
    bsdf::BsdfModel,
    error::Result,
    film::{
        Film,
        layer::{Content, Layer, Quantity},
    },
    math::{DVec3, Spectrum, Vec2, Vec3, vec2, vec3},
    passes::blocks::CameraStart,
    sampling::Stream,
    scene::Scene,
    shape::{Hit, Ray, SurfacePoint},
    transport::Interaction,
};
use rayon::prelude::*;

/// What is requested of primary rays.
pub(super) struct Pass {
    alpha: bool,
    quantities: Vec<Quantity>,
}

/// What they saw.
pub(super) struct Seen {
    /// The part of each pixel that the scene covers; empty where it was not requested.
    pub alpha: Vec<f32>,
    /// Per quantity, one plane per channel.
    planes: Vec<(Quantity, Vec<Vec<f32>>)>,
}

impl Seen {
    /// The planes of a quantity.
    pub(super) fn of(&self, quantity: Quantity) -> Vec<Vec<f32>> {
        self.planes.iter().find(|(q, _)| *q == quantity).map_or(Vec::new(), |(_, planes)| planes.clone())
    }
}

impl Pass {
    /// What `film` and `layers` request.
    pub(super) fn new(film: &Film, layers: &[Layer]) -> Self {
        let mut quantities: Vec<Quantity> = Vec::new();
        for layer in layers {
            if let Content::Surface(quantity) = layer.content
                && !quantities.contains(&quantity)
            {
                quantities.push(quantity);
            }
        }
        let alpha = film.format.alpha || layers.iter().any(|layer| layer.content == Content::Image);
        Self { alpha, quantities }
    }

    fn interacts(&self) -> bool {
        self.quantities.iter().any(|quantity| quantity.is_of_interaction())
    }

    /// Traces one primary ray per pixel for each of `passes`, or fewer once `is_over`, but at least one.
    pub(super) fn run(&self, stage: &Stage<'_>, passes: u64, is_over: impl Fn() -> bool) -> Result<Seen> {
        let film = stage.instrument.film;
        let width = usize::from(self.alpha) + self.quantities.len();
        if !self.alpha && self.quantities.is_empty() {
            return Ok(Seen { alpha: Vec::new(), planes: Vec::new() });
        }
        let mut sums = vec![DVec3::ZERO; film.len() * width];
        let mut done = 0;
        while done == 0 || done < passes && !is_over() {
            stage.show(done, |instrument, most| {
                let end = passes.min(done.saturating_add(most as u64));
                loop {
                    self.trace(instrument, [done, passes], &mut sums);
                    done += 1;
                    if done >= end || is_over() {
                        break;
                    }
                }
            })?;
        }
        let plane = |item: usize, component: usize| -> Vec<f32> {
            let sums = sums.iter().skip(item).step_by(width);
            sums.map(|sum| (sum[component] / done as f64) as f32).collect()
        };
        let first = usize::from(self.alpha);
        let planes = self.quantities.iter().enumerate().map(|(i, quantity)| {
            (*quantity, (0..quantity.channels().len()).map(|c| plane(first + i, c)).collect())
        });
        let alpha = if self.alpha { plane(0, 0) } else { Vec::new() };
        Ok(Seen { alpha, planes: planes.collect() })
    }

    /// Adds a primary ray of every pixel to `sums`, that of `pass`, one of `passes`.
    fn trace(&self, instrument: &Instrument<'_>, [pass, passes]: [u64; 2], sums: &mut [DVec3]) {
        let environment = instrument.scene.lights.environment.is_some();
        let width = sums.len() / instrument.film.len();
        sums.par_chunks_mut(width).enumerate().for_each(|(pixel, sums)| {
            let mut start = instrument.compiled.own_start(pass as usize, pixel);
            let view = View::new(instrument, environment, &start, passes);
            let alpha = self.alpha.then(|| Vec3::splat(view.alpha(&mut start.stream)));
            let first = self.interacts().then(|| view.first_interaction(&mut start.stream)).flatten();
            let values = self.quantities.iter().map(|quantity| match quantity.is_of_interaction() {
                true => view.quantity_of(first.as_ref(), *quantity),
                false => view.quantity(*quantity),
            });
            for (sum, value) in sums.iter_mut().zip(alpha.into_iter().chain(values)) {
                *sum += (value * start.weight).as_dvec3();
            }
        });
    }
}

/// A primary ray and what it hits first; nulls and boundaries of media count, as in Mitsuba.
struct View<'a, 's> {
    scene: &'a Scene,
    instrument: &'a Instrument<'s>,
    film: Vec2,
    aperture: Vec2,
    ray: Ray,
    hit: Option<(Hit, SurfacePoint)>,
    /// There is an environment emitter, in every direction at infinity.
    environment: bool,
    /// Step across the film that `duv_dx` refers to (pixels).
    step: f32,
}

impl<'a, 's> View<'a, 's> {
    fn new(instrument: &'a Instrument<'s>, environment: bool, start: &CameraStart, passes: u64) -> Self {
        let scene = instrument.scene;
        let CameraStart { position: film, aperture, .. } = *start;
        let ray = scene.sensor.ray(film, aperture).ray;
        let hit = scene.geometry.closest(&ray).map(|hit| (hit, scene.geometry.surface(&ray, &hit)));
        Self { scene, instrument, film, aperture, ray, hit, environment, step: 1.0 / (passes as f32).sqrt() }
    }

    /// The probability that the ray interacts with something or hits a visible environment, which Mitsuba's `volpath`
    /// finds by walking on. Hidden emitters do not count.
    fn alpha(&self, stream: &mut Stream) -> f32 {
        let hidden = self.instrument.settings.options.hide_emitters;
        if self.environment && !hidden {
            return 1.0;
        }
        let through = self.instrument.compiled.transmittance(self.ray, stream);
        1.0 - (through.x + through.y + through.z) / 3.0
    }

    fn first_interaction(&self, stream: &mut Stream) -> Option<Interaction> {
        self.instrument.compiled.first_interaction(self.ray, stream)
    }

    /// 0 where there is none.
    fn quantity_of(&self, first: Option<&Interaction>, quantity: Quantity) -> Vec3 {
        match (first, quantity) {
            (None, _) => Vec3::ZERO,
            (Some(Interaction::Medium(_, properties)), Quantity::FirstAlbedo) => properties.albedo,
            (Some(Interaction::Medium(..)), _) => -self.ray.direction,
            (Some(Interaction::Surface(point)), Quantity::FirstAlbedo) => self.albedo(point),
            (Some(Interaction::Surface(point)), _) => point.shading.normal,
        }
    }

    /// 0 where nothing is met.
    fn quantity(&self, quantity: Quantity) -> Vec3 {
        let Some((hit, point)) = &self.hit else { return Vec3::ZERO };
        let geometry = &self.scene.geometry;
        match quantity {
            Quantity::Albedo => self.albedo(point),
            Quantity::Depth => vec3(hit.t, 0.0, 0.0),
            Quantity::Position => (point.position.as_dvec3() + self.scene.recentre).as_vec3(),
            Quantity::Uv => point.uv.get().extend(0.0),
            Quantity::GeometricNormal => point.normal,
            Quantity::ShadingNormal => point.shading.normal,
            Quantity::DpDu => geometry.partials(point).0,
            Quantity::DpDv => geometry.partials(point).1,
            Quantity::DuvDx => self.uv_change(point, vec2(1.0, 0.0)).extend(0.0),
            Quantity::DuvDy => self.uv_change(point, vec2(0.0, 1.0)).extend(0.0),
            Quantity::PrimitiveIndex => vec3(point.primitive as f32, 0.0, 0.0),
            Quantity::ShapeIndex => vec3((point.shape + 1) as f32, 0.0, 0.0),
            // Those of the first interaction, which has a function of its own.
            Quantity::FirstAlbedo | Quantity::FirstNormal => Vec3::ZERO,
        }
    }

    /// Albedo of the visible side. If this is black, that of the other side, as in Mitsuba: a one-sided surface has an
    /// albedo from behind too.
    fn albedo(&self, point: &SurfacePoint) -> Spectrum {
        let albedo_of = |wi: Vec3| self.scene.at(point, |bsdf, uv| bsdf.albedo(uv, wi));
        let wi = point.shading.to_local(-self.ray.direction);
        let seen = albedo_of(wi);
        if seen == Spectrum::ZERO { albedo_of(vec3(wi.x, wi.y, -wi.z)) } else { seen }
    }

    /// How the texture coordinates change from here to where a neighbouring ray hits the tangent plane.
    fn uv_change(&self, point: &SurfacePoint, across: Vec2) -> Vec2 {
        let (du, dv) = self.scene.geometry.partials(point);
        let neighbour = self.film + across * self.step;
        let Ray { origin, direction, .. } = self.scene.sensor.ray(neighbour, self.aperture).ray;
        let t = (point.position - origin).dot(point.normal) / direction.dot(point.normal);
        let moved = origin + direction * t - point.position;
        let (uu, uv, vv) = (du.dot(du), du.dot(dv), dv.dot(dv));
        let (mu, mv) = (du.dot(moved), dv.dot(moved));
        let change = vec2(vv * mu - uv * mv, uu * mv - uv * mu) / (uu * vv - uv * uv);
        // Not finite: a neighbour that runs along the surface, or a pole of the coordinates.
        if change.is_finite() { change } else { Vec2::ZERO }
    }
}
