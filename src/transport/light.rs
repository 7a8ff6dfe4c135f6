//! The light walk's side: vertices joined to the lens (t = 1) and kept for joins with eye walks.

use super::{
    Estimator,
    cache::LightCache,
    connect::{self, Joined, Span},
    forced,
    profile::Profile,
    record::{Meeting, Recorder},
    segment::Interaction,
    vertex::Vertex,
    walk::{Departure, Kind, Visitor, walk},
    weight::{End, Sums},
};
use crate::{
    bsdf::Transport,
    math::{Lanes, Spectrum, Vec2, Vec3},
    sampling::Stream,
    scene::{
        Scene,
        lights::{EmissionSample, EmitterPoint},
    },
    sensor::Projection,
    shape::Ray,
};

/// One light walk on its way.
pub struct Light<'a, P: Profile, R> {
    estimator: &'a Estimator<'a, P>,
    cache: &'a mut LightCache<P::Sums>,
    recorder: &'a mut R,
    start: EmissionSample,
    hero: usize,
}

/// One light walk: its vertices go to `cache`, its joins with the lens to `recorder`.
pub fn trace<P: Profile>(
    estimator: &Estimator<'_, P>,
    cache: &mut LightCache<P::Sums>,
    recorder: &mut impl Recorder<P::Sums>,
    hero: usize,
    stream: &mut Stream,
) {
    cache.add_walk(hero, estimator.keep);
    let scene = estimator.scene;
    let Some(start) = begin::<P>(scene, stream) else { return };
    recorder.emit(&start);
    let departure = depart(estimator, &start);
    let kind =
        Kind { transport: Transport::Importance, hero, max_edges: estimator.max_edges.saturating_sub(1) };
    let mut light = Light::new(estimator, cache, recorder, start, hero);
    let aperture = scene.sensor.sample_aperture(stream);
    if estimator.counts.lens > 0.0 {
        light.recorder.start();
        let joined = light.join_start_to_lens(aperture, stream);
        light.splat(1, joined);
    }
    walk(scene, kind, departure, &mut light, stream);
}

/// Where a light walk starts; none where nothing leaves.
pub fn begin<P: Profile>(scene: &Scene, stream: &mut Stream) -> Option<EmissionSample> {
    let start = scene.lights.sample_emission(&scene.geometry, stream)?;
    // Points are sampled in the box around a medium that shines: not all lie in it.
    let astray = P::EMISSIVE && start.point.is_volume() && {
        let medium = scene.lights.all[start.light as usize].medium;
        !scene.is_within(medium, start.ray.origin, start.ray.direction)
    };
    (!astray).then_some(start)
}

/// Leaves the emitter. Before it only an eye walk that meets it can join.
pub fn depart<P: Profile>(estimator: &Estimator<'_, P>, start: &EmissionSample) -> Departure<P::Sums> {
    let scene = estimator.scene;
    let emitter = &scene.lights.all[start.light as usize].emitter;
    let hits = if emitter.is_hittable() { estimator.counts.hit } else { 0.0 };
    let Ray { origin, direction, .. } = start.ray;
    let medium = scene.emission_medium(start.light, origin, direction);
    let arriving = if P::INFINITE && start.point.is_infinite() {
        scene.media[medium.0 as usize].transmittance_from_infinity()
    } else {
        Spectrum::ONE
    };
    Departure {
        position: start.position(),
        ray: start.ray,
        medium,
        from_infinity: start.point.is_infinite(),
        edges: 0,
        hidden: false,
        dirac: !emitter.is_connectible(),
        throughput: start.throughput * arriving,
        forward: start.pdf_direction,
        carried: P::Sums::of(connect::rate_at::<P>(&start.point).scaled(hits * start.cosine / start.pdf)),
        reach: P::Lanes::splat(1.0),
    }
}

impl<P: Profile, R: Recorder<P::Sums>> Visitor<P> for Light<'_, P, R> {
    #[inline]
    fn joins(&self, edges: u32, position: Vec3) -> f32 {
        if edges > 1 {
            return self.estimator.counts.join;
        }
        let scene = self.estimator.scene;
        let ratio = scene.lights.connect_over_start(&scene.geometry, &self.start, position);
        self.estimator.counts.next_event * ratio
    }

    #[inline]
    fn depart(&mut self, departure: &Departure<P::Sums>) {
        self.recorder.depart(departure);
    }

    #[inline]
    fn arrive(&mut self, vertex: &Vertex<P::Sums>, stream: &mut Stream) {
        self.recorder.arrive(vertex);
        if !vertex.is_connectible(self.estimator.scene) {
            return;
        }
        if self.estimator.counts.lens > 0.0 {
            let aperture = self.estimator.scene.sensor.sample_aperture(stream);
            self.recorder.start();
            let joined = self.join_to_lens(vertex, aperture, stream);
            self.splat(vertex.subpath.edges + 1, joined);
        }
        let keep = self.estimator.keep;
        if keep > 0.0 && (keep >= 1.0 || stream.uniform() < keep) {
            self.cache.push(self.hero, *vertex);
            self.recorder.keep();
        }
    }
}

impl<'a, P: Profile, R: Recorder<P::Sums>> Light<'a, P, R> {
    /// The walk that begins with `start`.
    pub fn new(
        estimator: &'a Estimator<'a, P>,
        cache: &'a mut LightCache<P::Sums>,
        recorder: &'a mut R,
        start: EmissionSample,
        hero: usize,
    ) -> Self {
        Self { estimator, cache, recorder, start, hero }
    }

    #[inline]
    fn splat(&mut self, s: u32, joined: Option<(Vec2, Joined)>) {
        if let Some((film, joined)) = joined {
            let joined = joined / self.estimator.counts.lens;
            self.recorder.contribute(s, 1, Meeting::Lens(film), Some(&joined));
        }
        self.recorder.stop(s, 1);
    }

    /// t = 1: a vertex as the sensor sees it through a point of its aperture, and where on the film [pixels].
    #[inline]
    pub fn join_to_lens(
        &self,
        vertex: &Vertex<P::Sums>,
        aperture: Vec2,
        stream: &mut Stream,
    ) -> Option<(Vec2, Joined)> {
        let scene = self.estimator.scene;
        let seen = scene.sensor.project(vertex.position(), aperture)?;
        let hidden = self.estimator.hide_emitters && vertex.is_on_emitter(scene);
        if hidden || !self.recorder.covers(seen.film) {
            return None;
        }
        let mut end = connect::vertex_end(scene, vertex, -seen.ray.direction, Transport::Importance)?;
        if P::MEDIA
            && self.estimator.forced_interaction
            && matches!(vertex.interaction, Interaction::Medium(..))
        {
            end.tail = end.tail.times(forced::gain(self.estimator, seen.ray));
        }
        let joined = self.join_end(&end, &seen, false, stream)?;
        Some((seen.film, joined))
    }

    /// s = 1, t = 1: the emitter itself as the sensor sees it, where an eye walk could have met it.
    pub fn join_start_to_lens(&self, aperture: Vec2, stream: &mut Stream) -> Option<(Vec2, Joined)> {
        let (estimator, start) = (self.estimator, &self.start);
        let scene = estimator.scene;
        let hidden = estimator.hide_emitters && !(P::EMISSIVE && start.point.is_volume());
        let seen_directly = estimator.max_edges > 0 && !hidden;
        let hittable = scene.lights.all[start.light as usize].emitter.is_hittable();
        if estimator.counts.lens <= 0.0 || !hittable || !seen_directly {
            return None;
        }
        let seen = match start.point {
            EmitterPoint::Direction(towards) => scene.sensor.project_direction(towards, aperture),
            _ => scene.sensor.project(start.position(), aperture),
        };
        let seen = seen.filter(|seen| self.recorder.covers(seen.film))?;
        let end = start_end::<P>(estimator, start, -seen.ray.direction)?;
        let joined = self.join_end(&end, &seen, start.point.is_infinite(), stream)?;
        Some((seen.film, joined))
    }

    #[inline]
    fn join_end(
        &self,
        end: &End<P::Sums>,
        seen: &Projection,
        infinite: bool,
        stream: &mut Stream,
    ) -> Option<Joined> {
        let (scene, counts) = (self.estimator.scene, &self.estimator.counts);
        let Projection { ray, density, distance_squared, .. } = *seen;
        let hidden = self.estimator.hide_emitters;
        let lens = End {
            origin: Some(ray.origin),
            lift: Vec3::ZERO,
            medium: scene.sensor_medium,
            within: false,
            value: Spectrum::splat(density),
            forward: density,
            cosine: 1.0,
            inverse: 1.0,
            sigma_t: P::Lanes::splat(1.0),
            reach: P::Lanes::splat(1.0),
            tail: P::Sums::none(),
        };
        let strategy = self.estimator.strategy(counts.lens);
        if P::INFINITE && infinite {
            let span = Span { ray, cut: 0.0, distance_squared, hidden };
            connect::join_along::<P>(scene, &span, &lens, end, strategy, stream)
        } else {
            connect::join::<P>(scene, end, &lens, distance_squared, strategy, hidden, stream)
        }
    }
}

/// The emitter point of a light walk as the end of a join in unit direction `towards`; none where it does not
/// emit that way.
fn start_end<P: Profile>(
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
    towards: Vec3,
) -> Option<End<P::Sums>> {
    let emission = estimator.scene.lights.emission(start, towards)?;
    let origin = start.point.ray_origin(towards);
    let leaving = origin.unwrap_or(start.ray.origin);
    Some(End {
        origin,
        // Never the far end of a join: the lens is.
        lift: Vec3::ZERO,
        medium: estimator.scene.emission_medium(start.light, leaving, towards),
        within: false,
        value: emission.value / start.pdf,
        forward: emission.pdf_direction,
        cosine: emission.cosine,
        inverse: 1.0 / start.pdf,
        sigma_t: connect::rate_at::<P>(&start.point),
        reach: P::Lanes::splat(1.0),
        tail: P::Sums::of(P::Lanes::splat(estimator.counts.hit)),
    })
}
