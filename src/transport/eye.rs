//! The eye walk's side: emitters met and media passed that shine (s = 0), next-event estimation (s = 1), joins with
//! light walks (s >= 2).

use super::{
    Estimator,
    cache::LightCache,
    connect::{self, Joined, Span},
    profile::Profile,
    record::{Meeting, Recorder},
    segment::{FlightPart, Interaction},
    vertex::{Subpath, Vertex},
    walk::{Arrival, Departure, Kind, Visitor, arrive, walk},
    weight::{self, Sums},
};
use crate::{
    bsdf::Transport,
    math::{Lanes, Spectrum, Vec2, Vec3, measure},
    sampling::Stream,
    scene::{Scene, lights::EmitterSample},
    sensor::SensorRay,
    shape::Ray,
};

/// Gathers the radiance of one pixel sample.
pub struct Eye<'a, P: Profile, R> {
    estimator: &'a Estimator<'a, P>,
    cache: &'a LightCache<P::Sums>,
    hero: usize,
    /// The vertex before the current one: where next-event estimation would have been made from.
    previous: Vec3,
    recorder: R,
}

/// One eye walk through `film` [pixels] and a point of the aperture, joined with the light walks of `cache`; its
/// radiance goes to `recorder`.
pub fn sample<P: Profile, R: Recorder<P::Sums>>(
    estimator: &Estimator<'_, P>,
    cache: &LightCache<P::Sums>,
    film: Vec2,
    aperture: Vec2,
    hero: usize,
    recorder: R,
    stream: &mut Stream,
) -> R {
    let kind = Kind { transport: Transport::Radiance, hero, max_edges: estimator.max_edges };
    let departure = depart(estimator, film, aperture);
    let mut eye = Eye::new(estimator, cache, hero, departure.position, recorder);
    walk(estimator.scene, kind, departure, &mut eye, stream);
    eye.recorder
}

/// Leaves the sensor through a film position and a point of its aperture. Nothing can join before the sensor:
/// its sums are zero.
pub fn depart<P: Profile>(estimator: &Estimator<'_, P>, film: Vec2, aperture: Vec2) -> Departure<P::Sums> {
    let sensor = &estimator.scene.sensor;
    let SensorRay { position, ray, density } = sensor.ray(film, aperture);
    Departure {
        position,
        ray,
        medium: estimator.scene.sensor_medium,
        from_infinity: sensor.is_parallel(),
        edges: 0,
        hidden: estimator.hide_emitters,
        dirac: false,
        throughput: Spectrum::ONE,
        forward: density,
        carried: P::Sums::none(),
        reach: P::Lanes::splat(1.0),
    }
}

impl<P: Profile, R: Recorder<P::Sums>> Visitor<P> for Eye<'_, P, R> {
    #[inline]
    fn joins(&self, edges: u32, _: Vec3) -> f32 {
        if edges == 1 { self.estimator.counts.lens } else { self.estimator.counts.join }
    }

    #[inline]
    fn depart(&mut self, departure: &Departure<P::Sums>) {
        self.recorder.depart(departure);
    }

    #[inline]
    fn arrive(&mut self, vertex: &Vertex<P::Sums>, stream: &mut Stream) {
        self.recorder.arrive(vertex);
        if let Interaction::Surface(point) = &vertex.interaction
            && let Some(light) = self.estimator.scene.surface(point.shape).emitter
        {
            let Scene { lights, geometry, .. } = self.estimator.scene;
            let found = |eye: &Self| lights.surface_hit(geometry, light, point, eye.previous);
            self.emission(&vertex.subpath, found);
        }
        if vertex.subpath.edges < self.estimator.max_edges && vertex.is_connectible(self.estimator.scene) {
            if self.estimator.counts.next_event > 0.0 {
                self.next_event(vertex, stream);
            }
            self.join(vertex, stream);
        }
        self.previous = vertex.position();
    }

    /// s = 0 in a medium: of all points of a flight one is taken, by where it may shine most. That a flight comes as far
    /// as a point as often as radiance does is what makes up for the transmittance up to there.
    #[inline]
    fn pass(&mut self, departure: &Departure<P::Sums>, part: &FlightPart<P::Lanes>, stream: &mut Stream) {
        let Some((light, emission)) = self.estimator.scene.lights.of_medium(part.medium) else { return };
        if self.estimator.counts.hit <= 0.0 {
            return;
        }
        self.recorder.start();
        if let Some((t, density)) = emission.sample_along(&part.interval.section, stream)
            && let Some((subpath, sample)) = self.meet(departure, part, light, t, stream)
        {
            let hit = self.hit(&subpath, &sample).map(|hit| hit / density);
            self.recorder.contribute(0, subpath.edges + 1, Meeting::Met(&subpath, &sample), hit.as_ref());
        }
        self.recorder.stop(0, departure.edges + 2);
    }

    fn escape(&mut self, subpath: &Subpath<P::Sums>) {
        self.recorder.escape(subpath);
        self.emission(subpath, |eye| eye.estimator.scene.lights.infinity_hit(-subpath.incoming));
    }
}

impl<'a, P: Profile, R: Recorder<P::Sums>> Eye<'a, P, R> {
    /// What it gathers goes to `recorder`; the walk begins at the point `start` of the sensor.
    pub fn new(
        estimator: &'a Estimator<'a, P>,
        cache: &'a LightCache<P::Sums>,
        hero: usize,
        start: Vec3,
        recorder: R,
    ) -> Self {
        Self { estimator, cache, hero, previous: start, recorder }
    }

    /// Another walk from the point `start` of the sensor.
    pub fn restart(&mut self, start: Vec3) {
        self.previous = start;
    }

    /// What was gathered.
    pub fn into_recorder(self) -> R {
        self.recorder
    }

    /// s = 0: the walk has come to an emitter, a point of which is `found` if it emits this way.
    #[inline]
    fn emission(&mut self, subpath: &Subpath<P::Sums>, found: impl FnOnce(&Self) -> Option<EmitterSample>) {
        if self.estimator.counts.hit <= 0.0 {
            return;
        }
        self.recorder.start();
        if let Some(sample) = found(self) {
            let hit = self.hit(subpath, &sample);
            self.recorder.contribute(0, subpath.edges + 1, Meeting::Met(subpath, &sample), hit.as_ref());
        }
        self.recorder.stop(0, subpath.edges + 1);
    }

    /// The end of a walk at a point of a medium that shines, as the emitter `light`; none where it is dark there.
    pub fn meet(
        &self,
        departure: &Departure<P::Sums>,
        part: &FlightPart<P::Lanes>,
        light: u32,
        t: f32,
        stream: &mut Stream,
    ) -> Option<(Subpath<P::Sums>, EmitterSample)> {
        let (scene, position) = (self.estimator.scene, part.interval.section.at(t));
        let sample = scene.lights.volume_sample(light, position)?;
        let state = part.until::<P>(scene, t, self.hero, stream);
        let sigma_t = connect::rate_at::<P>(&sample.point);
        let at = Arrival { position: Some(position), cosine: 1.0, sigma_t };
        Some((arrive::<P>(departure, &state, part.medium, &at, self.hero)?, sample))
    }

    /// s = 0: the walk has met an emitter.
    ///
    /// LW96 eq. 3: the term L_e, weighted by eq. 14.
    #[inline]
    pub fn hit(&self, subpath: &Subpath<P::Sums>, sample: &EmitterSample) -> Option<Joined> {
        let counts = &self.estimator.counts;
        // Media are no emitters that can be hidden: what is behind them is seen through them.
        let hidden = self.estimator.hide_emitters && !(P::EMISSIVE && sample.point.is_volume());
        if counts.hit <= 0.0 || (subpath.edges == 1 && hidden) {
            return None;
        }
        // Both ends of the segment before must be able to join; across it joins s = 1, which from the sensor is
        // a light walk's first vertex and from anywhere else next-event estimation. Parallel rays meet what is
        // at infinity in one direction, which no light walk starts in.
        let unseen = P::INFINITE && sample.point.is_infinite() && self.estimator.scene.sensor.is_parallel();
        let joins = match (subpath.after_dirac, subpath.edges) {
            (true, _) => 0.0,
            (false, 1) if unseen => 0.0,
            (false, 1) => counts.lens * sample.pdf_start,
            (false, _) => counts.next_event * sample.pdf,
        };
        let unit = subpath.inverse / counts.hit;
        let by_light = subpath.partial.scaled(sample.pdf_direction * sample.pdf_start * unit);
        let others = P::Sums::of(subpath.reach_before.scaled(joins * unit)).and(by_light);
        // `value` is radiance x cosine on shapes: the walk's density already contains that cosine. The rate of media is
        // for weights alone.
        let radiance = sample.value / sample.cosine;
        let weight = weight::hit(subpath.reach, others, self.estimator.heuristic);
        let weight_alone = weight::alone(subpath.reach);
        Some(Joined {
            value: subpath.throughput * radiance * (weight / counts.hit),
            weight,
            alone: subpath.throughput * radiance * (weight_alone / counts.hit),
            weight_alone,
            transmittance: Spectrum::ONE,
        })
    }

    /// s = 1: a freshly sampled emitter point.
    #[inline]
    fn next_event(&mut self, vertex: &Vertex<P::Sums>, stream: &mut Stream) {
        let Scene { lights, geometry, .. } = self.estimator.scene;
        let t = vertex.subpath.edges + 1;
        self.recorder.start();
        if let Some(sample) = lights.sample_emitter(geometry, vertex.position(), stream) {
            let joined = self.join_emitter(vertex, &sample, stream);
            self.recorder.contribute(1, t, Meeting::Emitter(&sample), joined.as_ref());
        }
        self.recorder.stop(1, t);
    }

    /// The join with an emitter point picked by next-event estimation.
    #[inline]
    pub fn join_emitter(
        &self,
        vertex: &Vertex<P::Sums>,
        sample: &EmitterSample,
        stream: &mut Stream,
    ) -> Option<Joined> {
        let (scene, counts) = (self.estimator.scene, &self.estimator.counts);
        let (direction, distance_squared) = sample.point.seen_from(vertex.position())?;
        let eye = connect::vertex_end(scene, vertex, direction, Transport::Radiance)?;
        let light = connect::emitter_end::<P>(scene, sample, eye.medium, -direction, counts.hit);
        let strategy = self.estimator.strategy(1.0);
        if P::INFINITE && sample.point.is_infinite() {
            let ray = Ray { origin: eye.origin?, direction, t_max: f32::INFINITY };
            let span = Span { ray, cut: 0.0, distance_squared, hidden: false };
            connect::join_along::<P>(scene, &span, &eye, &light, strategy, stream)
        } else {
            connect::join::<P>(scene, &eye, &light, distance_squared, strategy, false, stream)
        }
    }

    /// s >= 2: vertices drawn from the cache of light walks.
    #[inline]
    fn join(&mut self, vertex: &Vertex<P::Sums>, stream: &mut Stream) {
        let estimator = self.estimator;
        let Some((pool, scale)) = self.cache.pool(self.hero, estimator.joins_per_vertex) else { return };
        for _ in 0..estimator.joins_per_vertex {
            let index = stream.below(pool.len());
            let other = &pool[index];
            if vertex.subpath.edges + other.subpath.edges < estimator.max_edges {
                let (s, t) = (other.subpath.edges + 1, vertex.subpath.edges + 1);
                self.recorder.start();
                let joined = self.join_with(vertex, other, stream).map(|joined| joined * scale);
                self.recorder.contribute(s, t, Meeting::Light(index, other), joined.as_ref());
                self.recorder.stop(s, t);
            }
        }
    }

    /// The join with a vertex of a light walk.
    #[inline]
    pub fn join_with(
        &self,
        vertex: &Vertex<P::Sums>,
        other: &Vertex<P::Sums>,
        stream: &mut Stream,
    ) -> Option<Joined> {
        let scene = self.estimator.scene;
        let (direction, _, distance_squared) = measure::between(vertex.position(), other.position())?;
        let eye = connect::vertex_end(scene, vertex, direction, Transport::Radiance)?;
        let light = connect::vertex_end(scene, other, -direction, Transport::Importance)?;
        let strategy = self.estimator.strategy(self.estimator.counts.join);
        connect::join::<P>(scene, &eye, &light, distance_squared, strategy, false, stream)
    }
}
