//! The preview `fog` (BMA02 eq. 5): surfaces as they are lit, behind a veil of constant radiance as thick as the media
//! make it. One ray a sample and no shadows: a picture for placing objects, not for measurements.

use crate::{
    bsdf::{BsdfModel, Transport},
    emitter::{Emitter, InfiniteModel},
    math::{Channels, Spectrum, Vec3},
    passes::{Settings, compiled::Compiled, pass::Outcome},
    sampling::{Stream, stream::Purpose},
    scene::{
        Scene,
        lights::{Aim, EmitterSample},
    },
    settings::{integrator::FogSettings, options::Sky},
    shape::{Ray, SurfacePoint},
    transport::{NullCrossing, Segment, profiles::Everything},
};
use std::f32::consts::PI;

/// Surfaces that a ray passes, or is mirrored or refracted by, before it gives up.
const MOST_LEGS: u32 = 64;
/// Up to this many emitters light every point; of more, this many are drawn for each point.
const LIGHTS_PER_POINT: usize = 16;
/// Rays that measure how bright surfaces are.
const PILOT_RAYS: usize = 1024;

/// A scene in fog of one radiance.
pub(super) struct Preview<'a> {
    scene: &'a Scene,
    hide_emitters: bool,
    threshold: f32,
    /// L_fog.
    veil: Spectrum,
    /// What surfaces receive from everywhere.
    ambient: Spectrum,
}

/// Rays through pixels all over the film, with random numbers of their own.
fn pilot_rays(compiled: &dyn Compiled, seed: u64) -> impl Iterator<Item = (Ray, Stream)> {
    let (scene, film) = (compiled.scene(), compiled.film());
    (0..PILOT_RAYS).map(move |index| {
        let pixel = (index as u128 * film.len() as u128 / PILOT_RAYS as u128) as usize;
        let mut stream = Stream::new(seed, index as u64, 0, Purpose::Pilot);
        let (position, _) = film.sample(pixel, &mut stream);
        let aperture = scene.sensor.sample_aperture(&mut stream);
        (scene.sensor.ray(position, aperture).ray, stream)
    })
}

/// What a ray has reached.
struct Sight {
    /// The part of radiance from there that remains.
    through: Spectrum,
    /// The share of the veil before it.
    veiled: Spectrum,
    /// Radiance of emitters on the way and of the surface itself.
    emitted: Spectrum,
    end: End,
}

enum End {
    /// A surface, seen along this direction.
    Surface(Box<SurfacePoint>, Vec3),
    /// Infinity, or nothing that could be seen.
    Radiance(Spectrum),
}

impl<'a> Preview<'a> {
    /// Prepares to show what `compiled` shows.
    pub(super) fn of(compiled: &'a dyn Compiled, fog: &FogSettings, settings: &Settings) -> Self {
        let Settings { seed, options, .. } = settings;
        Self::new(compiled.scene(), fog, options.hide_emitters, pilot_rays(compiled, *seed))
    }

    /// One sample of each of `pixels`, along the primary rays of `compiled`.
    pub(super) fn show(
        &self,
        compiled: &dyn Compiled,
        pass: usize,
        pixels: impl Iterator<Item = usize>,
    ) -> Outcome {
        let show = |pixel| {
            let mut start = compiled.camera_start(pass, pixel);
            let ray = self.scene.sensor.ray(start.position, start.aperture).ray;
            (
                pixel as u32,
                self.radiance(ray, &mut start.stream) * (start.weight * self.scene.sensor.response()),
            )
        };
        Outcome::of_parts(pixels.map(show).collect(), Vec::new(), Vec::new())
    }

    /// Prepares to show `scene`. Radiance that `fog` does not set is measured along `rays`.
    fn new(
        scene: &'a Scene,
        fog: &FogSettings,
        hide_emitters: bool,
        rays: impl Iterator<Item = (Ray, Stream)>,
    ) -> Self {
        let threshold = fog.threshold.unwrap_or(f32::INFINITY);
        let dark = Self { threshold, ..Self::dark(scene, hide_emitters) };
        let sky = surroundings(scene);
        let veil = fog.color.or(sky).unwrap_or_else(|| dark.brightness(rays));
        let ambient = fog.ambient.unwrap_or(if sky.is_some() { Spectrum::ZERO } else { veil });
        Self { veil, ambient: ambient + even_sky(scene), ..dark }
    }

    /// Without fog, and without light from everywhere.
    fn dark(scene: &'a Scene, hide_emitters: bool) -> Self {
        let (threshold, veil, ambient) = (f32::INFINITY, Spectrum::ZERO, Spectrum::ZERO);
        Self { scene, hide_emitters, threshold, veil, ambient }
    }

    /// The mean brightness that emitters give the surfaces that rays hit; 1 where they give none.
    fn brightness(&self, rays: impl Iterator<Item = (Ray, Stream)>) -> Spectrum {
        let (mut sum, mut count) = (Spectrum::ZERO, 0);
        for (ray, mut stream) in rays {
            if let End::Surface(point, incoming) = self.follow(ray, &mut stream).end {
                sum += self.lit(&point, incoming, &mut stream);
                count += 1;
            }
        }
        if sum.max_element() > 0.0 { sum / count as f32 } else { Spectrum::ONE }
    }

    /// Radiance along a primary ray.
    pub(super) fn radiance(&self, ray: Ray, stream: &mut Stream) -> Spectrum {
        let Sight { through, veiled, emitted, end } = self.follow(ray, stream);
        let behind = match end {
            End::Radiance(radiance) => radiance,
            End::Surface(point, incoming) => {
                self.lit(&point, incoming, stream) + self.surrounded(&point, incoming, stream)
            }
        };
        veiled * self.veil + emitted + through * behind
    }

    /// Follows a ray to the first surface that scatters light. At smooth surfaces and nulls it goes on as light does.
    fn follow(&self, ray: Ray, stream: &mut Stream) -> Sight {
        let nothing = End::Radiance(Spectrum::ZERO);
        let mut sight =
            Sight { through: Spectrum::ONE, veiled: Spectrum::ZERO, emitted: Spectrum::ZERO, end: nothing };
        let mut segment = Segment::along(self.scene, ray, self.scene.sensor_medium(&ray), self.hide_emitters);
        let mut left = self.threshold;
        for _ in 0..MOST_LEGS {
            if let Some(end) = self.advance(&mut sight, &mut segment, &mut left, stream) {
                return Sight { end, ..sight };
            }
        }
        sight
    }

    /// Follows a `segment` to the next surface, within the distance `left`, and passes it; none unless the ray ends.
    fn advance(
        &self,
        sight: &mut Sight,
        segment: &mut Segment<'a>,
        left: &mut f32,
        stream: &mut Stream,
    ) -> Option<End> {
        let Ray { direction, t_max, .. } = *segment.ray();
        let (interval, hit) = segment.next::<Everything>(*left);
        if hit.is_none() && *left < t_max {
            // Beyond the threshold there is fog alone.
            sight.veiled += std::mem::replace(&mut sight.through, Spectrum::ZERO);
            return Some(End::Radiance(Spectrum::ZERO));
        }
        // f of BMA02 eq. 6.
        let remains = segment.medium().quick_depth(&interval.segment).exp_neg();
        sight.veiled += sight.through * (Spectrum::ONE - remains);
        sight.through *= remains;
        let Some(hit) = hit else {
            let sky = self
                .scene
                .lights
                .infinity_hit(direction, segment.ray().origin, Aim::default())
                .filter(|_| !segment.is_hidden());
            return Some(End::Radiance(sky.map_or(Spectrum::ZERO, |sample| sample.value)));
        };
        *left -= interval.segment.length;
        let point = segment.surface(&hit);
        if !segment.is_hidden() {
            sight.emitted += sight.through * self.emitted(&point, segment.ray());
        }
        let Some(weight) = self.pass(segment, &point, stream) else {
            return Some(End::Surface(Box::new(point), -direction));
        };
        sight.through *= weight;
        (sight.through.max_element() <= 0.0).then_some(End::Radiance(Spectrum::ZERO))
    }

    /// Takes a `segment` beyond a surface point; the factor on its radiance, or none where it ends.
    fn pass(&self, segment: &mut Segment<'a>, point: &SurfacePoint, stream: &mut Stream) -> Option<Spectrum> {
        match segment.sample_crossing(point, stream) {
            NullCrossing::Passed(passed, probability) => {
                segment.cross(point);
                Some(passed / probability)
            }
            NullCrossing::Stopped(probability) => {
                let (beyond, weight) = deflect(self.scene, segment, point, stream)?;
                *segment = beyond;
                Some(weight / probability)
            }
        }
    }

    /// Radiance that the surface itself emits along the ray.
    fn emitted(&self, point: &SurfacePoint, ray: &Ray) -> Spectrum {
        let Scene { lights, geometry, .. } = self.scene;
        let light = self.scene.surface(point.shape).emitter;
        let sample =
            light.and_then(|light| lights.surface_hit(geometry, light, point, ray.origin, Sky::default()));
        sample.map_or(Spectrum::ZERO, |sample| sample.value / sample.cosine)
    }

    /// Light of all emitters reflected at a point, as if nothing blocked it. A uniform sky is left out: it is ambient
    /// light.
    fn lit(&self, point: &SurfacePoint, incoming: Vec3, stream: &mut Stream) -> Spectrum {
        let Scene { lights, geometry, .. } = self.scene;
        let reference = point.position;
        if lights.all.len() > LIGHTS_PER_POINT {
            let mut draw = |_| {
                let sample = lights.sample_emitter(geometry, reference, Aim::default(), stream)?;
                even_radiance(&lights.all[sample.light as usize].emitter).is_none().then_some(sample)
            };
            let samples = (0..LIGHTS_PER_POINT).filter_map(&mut draw);
            let sum: Spectrum = samples.map(|sample| self.reflected(point, incoming, &sample)).sum();
            return sum / LIGHTS_PER_POINT as f32;
        }
        let is_sampled = |emitter: &Emitter| emitter.is_connectible() && even_radiance(emitter).is_none();
        let others = lights.all.iter().enumerate().filter(|(_, light)| is_sampled(&light.emitter));
        let samples = others.filter_map(|(index, _)| {
            lights.sample_point_of(geometry, (index, 1.0), reference, Aim::default(), stream)
        });
        samples.map(|sample| self.reflected(point, incoming, &sample)).sum()
    }

    /// Light of one emitter point reflected at a surface point.
    fn reflected(&self, point: &SurfacePoint, incoming: Vec3, sample: &EmitterSample) -> Spectrum {
        let Some((direction, distance_squared)) = sample.point.seen_from(point.position) else {
            return Spectrum::ZERO;
        };
        let (wi, wo) = (point.shading.to_local(incoming), point.shading.to_local(direction));
        let found = self.scene.at(point, |bsdf, uv| bsdf.evaluate(uv, wi, wo, Transport::Radiance));
        found.value * wo.z.abs() * sample.value / (sample.pdf * distance_squared)
    }

    /// Ambient light reflected at a point.
    fn surrounded(&self, point: &SurfacePoint, incoming: Vec3, stream: &mut Stream) -> Spectrum {
        if self.ambient == Spectrum::ZERO {
            return Spectrum::ZERO;
        }
        let wi = point.shading.to_local(incoming);
        let sample = self.scene.at(point, |bsdf, uv| bsdf.sample(uv, wi, Transport::Radiance, stream));
        sample.map_or(Spectrum::ZERO, |sample| sample.weight) * self.ambient
    }
}

/// Radiance of emitters along a primary ray that nothing scatters but smooth surfaces.
pub(super) fn seen(scene: &Scene, hide_emitters: bool, ray: Ray, stream: &mut Stream) -> Spectrum {
    let Sight { through, emitted, end, .. } = Preview::dark(scene, hide_emitters).follow(ray, stream);
    match end {
        End::Radiance(radiance) => emitted + through * radiance,
        End::Surface(..) => emitted,
    }
}

/// The segment beyond a smooth surface, and its factor; none where the ray ends.
pub(super) fn deflect<'a>(
    scene: &'a Scene,
    segment: &Segment<'a>,
    point: &SurfacePoint,
    stream: &mut Stream,
) -> Option<(Segment<'a>, Spectrum)> {
    let surface = scene.surface(point.shape);
    if surface.connectible || surface.emitter.is_some() {
        return None;
    }
    let wi = point.shading.to_local(-segment.ray().direction);
    let sample = scene.at(point, |bsdf, uv| bsdf.sample(uv, wi, Transport::Radiance, stream));
    let Some(sample) = sample else {
        return Some((*segment, Spectrum::ZERO));
    };
    let direction = point.shading.to_world(sample.wo).normalize();
    let origin = point.leaving(direction).origin;
    let ray = Ray { origin, direction, t_max: f32::INFINITY };
    Some((segment.deflected(point, ray), sample.weight))
}

/// Mean radiance of the environment, if there is one.
fn surroundings(scene: &Scene) -> Option<Spectrum> {
    let sky = scene.lights.all[scene.lights.environment? as usize].emitter.environment()?;
    Some(sky.fluence().as_vec3() / (4.0 * PI))
}

/// Radiance of uniform skies: ambient light, known without samples.
fn even_sky(scene: &Scene) -> Spectrum {
    scene.lights.all.iter().filter_map(|light| even_radiance(&light.emitter)).sum()
}

fn even_radiance(emitter: &Emitter) -> Option<Spectrum> {
    emitter.environment()?.even_radiance()
}
