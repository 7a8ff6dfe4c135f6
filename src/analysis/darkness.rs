//! Why an image is black: rays through it are followed to the first surface that scatters, and from there to the lights.
//! Asked only where the image is black, after the fact.

use crate::transport::coverage::{self, Share};
use crate::{
    bsdf::{BsdfModel, Transport},
    film::Film,
    math::{Bounds, Spectrum, SpectrumExt, Vec3},
    sampling::{Stream, stream::Purpose},
    scene::{
        Scene,
        build::Setup,
        lights::{Aim, Light},
    },
    sensor::Sensor,
    shape::{Ray, SurfacePoint},
    transport::{Options, Segment, Strategies, profiles::Everything},
};
use std::{cmp::Ordering, f32::consts::PI};

/// Rays across the image.
const RAYS: usize = 64;

/// Samples of emitters at each surface.
const LIGHTS: usize = 4;

/// Surfaces that a ray passes before it gives up.
const MOST_SURFACES: usize = 1000;

/// Optical thickness that practically no light passes: exp(-50) is 2e-22.
const THICK: f32 = 50.0;

/// What keeps light from a ray.
#[derive(Clone, Copy, Debug, PartialEq, PartialOrd)]
enum Cause {
    /// A medium across the view.
    Thick,
    /// A medium between what is seen and the light.
    ThickToLight,
    /// The back of a one-sided shape is seen.
    BackSeen(u32),
    /// All light is behind the shape that is seen.
    BackLit(u32),
    /// The first shape is seen, the second is before the light.
    Hidden(u32, u32),
    /// All lamps face away from what is seen.
    Away,
    /// No surface and no sky.
    Nothing,
}

/// A cause, with optical thickness and length (m) of what is in the way.
type Found = (Cause, f32, f32);

/// How a ray through boundaries ends.
struct End {
    /// Of the clearest channel.
    depth: f32,
    /// Of what extinguishes light (m).
    length: f32,
    surface: Option<SurfacePoint>,
}

/// Why the image `pixels` of `setup` by `options` is black, or dark beside its emitters; none where it is not, or where rays do
/// not show why.
pub fn reason(pixels: &[Spectrum], setup: &Setup, options: &Options) -> Option<String> {
    let light: f64 = pixels.iter().map(|pixel| f64::from(pixel.luminance())).sum();
    // Of a scene without light it has been said before.
    if !is_dark(light / pixels.len() as f64, &setup.scene) {
        return None;
    }
    if options.max_depth == Some(0) {
        let text =
            "the image is black: max_depth 0 leaves out all light. 1 shows emitters alone, 2 what they light";
        return Some(text.to_owned());
    }
    let look = Look { setup, film: &setup.film };
    match (look.cause(), light == 0.0) {
        (Some(cause), true) => Some(format!("the image is black: {cause}")),
        (Some(cause), false) => Some(format!("the image is nearly black: {cause}")),
        (None, true) => Some(format!("the image is black: {}", unreached(&setup.scene, options))),
        (None, false) => None,
    }
}

/// An image is dark below this part of the radiance of all emitters' power, spread over the scene.
const DARK: f64 = 1e-9;

/// True if an image of this `mean` luminance is next to nothing beside what the emitters emit.
fn is_dark(mean: f64, scene: &Scene) -> bool {
    let Bounds { low, high } = scene.geometry.bounds();
    let radius =
        Some(0.5 * (high - low).length()).filter(|radius| *radius > 0.0 && radius.is_finite()).unwrap_or(1.0);
    let area = |light: &Light| light.shape.map_or(0.0, |shape| scene.geometry.area(shape));
    let power: f64 = scene.lights.all.iter().map(|light| light.emitter.power(area(light), radius)).sum();
    mean < DARK * power / f64::from(4.0 * PI * PI * radius * radius)
}

/// What no rays show: light that the strategies do not reach, or that is rare.
fn unreached(scene: &Scene, options: &Options) -> String {
    let is_bdpt = options.strategies == Strategies::BDPT;
    let kinds = coverage::unreached(scene, options);
    let least = options.min_depth;
    match kinds.iter().min_by_key(|kind| kind.by_bdpt as u8) {
        Some(kind) if kind.by_bdpt == Share::None => format!("no integrator reaches {}", kind.light),
        Some(kind) if is_bdpt => format!("bdpt reaches only a part of {}", kind.light),
        Some(kind) => format!("these strategies do not reach {}; bdpt does", kind.light),
        None if least > 1 => {
            format!(
                "no sample found light on paths of {least} segments or more, and min_depth leaves out the others"
            )
        }
        None if options.max_depth == Some(1) => {
            let how =
                if options.hide_emitters { "hide_emitters hides those in view" } else { "none is in view" };
            format!("max_depth 1 shows emitters alone, and {how}. 2 shows what they light")
        }
        None => {
            let too_long = |most| format!(", or take longer paths than max_depth ({most}) allows");
            let longer = options.max_depth.map_or(String::new(), too_long);
            let other = if is_bdpt { "" } else { ", or --integrator bdpt" };
            format!("no sample found light. It may be rare{longer}: take more samples{other}")
        }
    }
}

struct Look<'a> {
    setup: &'a Setup,
    film: &'a Film,
}

impl Look<'_> {
    /// What keeps light from most of the rays, in words; those that meet nothing count where all of them do.
    fn cause(&self) -> Option<String> {
        let mut found: Vec<_> = (0..RAYS).map(|index| self.through(index)).collect();
        let is_nothing = |found: &Option<Found>| matches!(found, Some((Cause::Nothing, ..)));
        if !found.iter().all(is_nothing) {
            found.retain(|found| !is_nothing(found));
        }
        let count = found.len();
        let mut found: Vec<Found> = found.into_iter().flatten().collect();
        found.sort_by(|a, b| a.partial_cmp(b).unwrap_or(Ordering::Equal));
        let most = found.chunk_by(|a, b| a.0 == b.0).max_by_key(|alike| alike.len())?;
        let (cause, depth, length) = &most[most.len() / 2];
        (2 * most.len() >= count).then(|| self.in_words(cause, *depth, *length))
    }

    /// What keeps light from ray `index`.
    fn through(&self, index: usize) -> Option<Found> {
        let scene = &self.setup.scene;
        let mut stream = Stream::new(0, index as u64, 0, Purpose::Study);
        let pixel = (stream.uniform() * self.film.len() as f32) as usize;
        let (position, _) = self.film.sample(pixel.min(self.film.len() - 1), &mut stream);
        let ray = scene.sensor.ray(position, scene.sensor.sample_aperture(&mut stream)).ray;
        let mut segment = Segment::along(scene, ray, scene.sensor_medium(&ray), false);
        let End { depth, length, surface } = follow(scene, &mut segment);
        if depth > THICK {
            return Some((Cause::Thick, depth, length));
        }
        match surface {
            None if depth == 0.0 && scene.lights.environment.is_none() => Some((Cause::Nothing, 0.0, 0.0)),
            None => None,
            Some(point) => self.at_surface(&segment, &point, &mut stream),
        }
    }

    /// What keeps light from the `point` that `segment` ends on.
    fn at_surface(&self, segment: &Segment<'_>, point: &SurfacePoint, stream: &mut Stream) -> Option<Found> {
        let incoming = -segment.ray().direction;
        let survival = |wi| self.setup.scene.at(point, |bsdf, uv| bsdf.survival(uv, wi));
        let wi = point.shading.to_local(incoming);
        if survival(wi) <= 0.0 {
            let has_front = survival(-wi) > 0.0;
            return has_front.then_some((Cause::BackSeen(point.shape), 0.0, 0.0));
        }
        let mut causes = (0..LIGHTS).map(|_| self.to_light(segment, point, incoming, stream));
        // One light that arrives is enough.
        causes.try_fold(None, |_, cause| cause.map(Some)).flatten()
    }

    /// What keeps the light of a sample of the emitters from `point`; none where nothing does.
    fn to_light(
        &self,
        segment: &Segment<'_>,
        point: &SurfacePoint,
        incoming: Vec3,
        stream: &mut Stream,
    ) -> Option<Found> {
        let scene = &self.setup.scene;
        let Some(sample) =
            scene.lights.sample_emitter(&scene.geometry, point.position, Aim::default(), stream)
        else {
            return self.are_all_lamps().then_some((Cause::Away, 0.0, 0.0));
        };
        let (direction, squared) = sample.point.seen_from(point.position)?;
        let (wi, wo) = (point.shading.to_local(incoming), point.shading.to_local(direction));
        let bsdf = scene.bsdf(point.shape);
        if !bsdf.is_connectible() || sample.point.is_parallel() && !sample.point.is_infinite() {
            return None;
        }
        if sample.value.max_element() <= 0.0 {
            return Some((Cause::Away, 0.0, 0.0));
        }
        let found = scene.at(point, |bsdf, uv| bsdf.evaluate(uv, wi, wo, Transport::Radiance));
        if found.value.max_element() <= 0.0 {
            return (wi.z * wo.z < 0.0).then_some((Cause::BackLit(point.shape), 0.0, 0.0));
        }
        let origin = point.leaving(direction).origin;
        let t_max = if sample.point.is_infinite() { f32::INFINITY } else { squared.sqrt() * 0.999 };
        let ray = Ray { origin, direction, t_max };
        let End { depth, length, surface } = follow(scene, &mut segment.deflected(point, ray));
        match surface {
            // What refracts light may let it through.
            Some(other) if scene.surface(other.shape).transmits => None,
            Some(other) => Some((Cause::Hidden(point.shape, other.shape), 0.0, 0.0)),
            None => (depth > THICK).then_some((Cause::ThickToLight, depth, length)),
        }
    }

    /// True if shapes alone emit.
    fn are_all_lamps(&self) -> bool {
        self.setup.scene.lights.all.iter().all(|light| light.shape.is_some())
    }

    fn in_words(&self, cause: &Cause, depth: f32, length: f32) -> String {
        let name = |shape: &u32| format!("\"{}\"", self.setup.shape_names[*shape as usize]);
        match cause {
            Cause::Thick => thick("the view", depth, length),
            Cause::ThickToLight => thick("the way from the surfaces in view to the light", depth, length),
            Cause::BackSeen(shape) => format!(
                "the camera sees the back of {}, which is black: its bsdf has one side. Put the bsdf into a \"twosided\", or set \
                 \"flip_normals\"",
                name(shape)
            ),
            Cause::BackLit(shape) => format!(
                "all light falls on the back of {}, whose front is in view. Move or turn the light (a \"direction\" is that \
                 in which light goes)",
                name(shape)
            ),
            Cause::Hidden(seen, between) if seen == between => {
                format!("{} hides all light from the side of it that is in view", name(seen))
            }
            Cause::Hidden(seen, between) => {
                format!("{} hides all light from {}, which is in view", name(between), name(seen))
            }
            Cause::Away => "all lamps face away from the surfaces in view. An \"area\" emitter shines where the normals of its \
                            shape point: set \"flip_normals\", or turn the shape"
                .to_owned(),
            Cause::Nothing if matches!(self.setup.scene.sensor, Sensor::Irradiance(_)) => {
                "no surface, medium or sky is in view of the irradiancemeter. Light straight from emitters without a size \
                 (\"point\", \"spot\", \"directional\", ...) does not count, as in Mitsuba: make it an \"area\" emitter"
                    .to_owned()
            }
            Cause::Nothing => "no surface, medium or sky is in view. Check where the camera looks (\"to_world\")".to_owned(),
        }
    }
}

/// A medium that nothing gets through, over `length` metres of `what`.
fn thick(what: &str, depth: f32, length: f32) -> String {
    let over = if length.is_finite() { format!(" over {length:.1} m") } else { String::new() };
    let depth = if depth.is_finite() { format!("{depth:.0}") } else { "infinite".to_owned() };
    format!(
        "the optical thickness of {what} is {depth}{over}: nothing gets through more than {THICK}. sigma_t is per metre: is \
         the scene in centimetres? Then set the \"scale\" of the medium to 0.01 of what it is"
    )
}

/// Follows `segment` to its end or the first surface that stops light.
fn follow(scene: &Scene, segment: &mut Segment<'_>) -> End {
    let mut end = End { depth: 0.0, length: 0.0, surface: None };
    for _ in 0..MOST_SURFACES {
        let (interval, hit) = segment.next::<Everything>(f32::INFINITY);
        let depth = segment.medium().quick_depth(&interval.segment).min_element();
        end.depth += depth;
        end.length += if depth > 0.0 { interval.segment.length } else { 0.0 };
        let Some(hit) = hit else { break };
        let point = segment.surface(&hit);
        if scene.null_transmission(&point, segment.ray().direction).max_element() <= 0.0 {
            end.surface = Some(point);
            break;
        }
        segment.cross(&point);
    }
    end
}
