//! The eye walk's side: emitters met and media passed that shine (s = 0), next-event estimation (s = 1), joins with
//! light walks (s >= 2).

use super::{
    Estimator,
    cache::LightCache,
    connect::{self, Joined, Span},
    profile::Profile,
    record::{Meeting, Recorder},
    segment::Flown,
    vertex::{Site, Vertex},
    walk::{Departure, Kind, Visitor, land, walk},
    weight::{self, Sums},
};
use crate::{
    bsdf::Transport,
    math::{Lanes, Spectrum, Vec2, Vec3, measure},
    medium::Matter,
    sampling::Stream,
    scene::lights::Link,
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
        if let Site::Surface(point) = &vertex.site
            && let Some(light) = self.estimator.scene.surface(point.shape).emitter
            && self.estimator.counts.hit > 0.0
        {
            let scene = self.estimator.scene;
            self.recorder.start();
            if let Some(link) = scene.lights.met(&scene.geometry, light, point, self.previous) {
                let hit = self.hit(vertex, &link);
                self.recorder.contribute(0, vertex.edges + 1, Meeting::Met(vertex, &link), hit.as_ref());
            }
            self.recorder.stop(0, vertex.edges + 1);
        }
        if vertex.edges < self.estimator.max_edges && vertex.is_connectible(self.estimator.scene) {
            if self.estimator.counts.next_event > 0.0 {
                self.next_event(vertex, stream);
            }
            self.join(vertex, stream);
        }
        self.previous = vertex.position;
    }

    /// s = 0 in a medium: of all points of a flight one is taken, by where it may shine most. That a flight comes as far
    /// as a point as often as radiance does is what makes up for the transmittance up to there.
    #[inline]
    fn pass(&mut self, departure: &Departure<P::Sums>, flown: &Flown<P::Lanes>, stream: &mut Stream) {
        let Some((light, emission)) = self.estimator.scene.lights.of_medium(flown.medium) else { return };
        if self.estimator.counts.hit <= 0.0 {
            return;
        }
        self.recorder.start();
        if let Some((t, density)) = emission.sample_along(&flown.section, stream)
            && let Some((vertex, link)) = self.meet(departure, flown, light, t, stream)
        {
            let hit = self.hit(&vertex, &link).map(|hit| hit / density);
            self.recorder.contribute(0, vertex.edges + 1, Meeting::Met(&vertex, &link), hit.as_ref());
        }
        self.recorder.stop(0, departure.edges + 2);
    }

    fn escape(&mut self, vertex: &Vertex<P::Sums>) {
        self.recorder.escape(vertex);
        if self.estimator.counts.hit <= 0.0 {
            return;
        }
        self.recorder.start();
        if let Some(link) = self.estimator.scene.lights.met_at_infinity(-vertex.incoming) {
            let hit = self.hit(vertex, &link);
            self.recorder.contribute(0, vertex.edges + 1, Meeting::Met(vertex, &link), hit.as_ref());
        }
        self.recorder.stop(0, vertex.edges + 1);
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

    /// The end of a walk at a point of a medium that shines, as the emitter `light`; none where it is dark there.
    pub fn meet(
        &self,
        departure: &Departure<P::Sums>,
        flown: &Flown<P::Lanes>,
        light: u32,
        t: f32,
        stream: &mut Stream,
    ) -> Option<(Vertex<P::Sums>, Link)> {
        let scene = self.estimator.scene;
        let link = scene.lights.link_within(light, flown.section.at(t))?;
        let matter = Matter { sigma_t: link.rate?, albedo: Spectrum::ZERO };
        let flight = flown.until(scene, t, matter, self.hero, stream);
        Some((land::<P>(departure, &flight, self.hero, self)?, link))
    }

    /// s = 0: the walk has met an emitter.
    #[inline]
    pub fn hit(&self, vertex: &Vertex<P::Sums>, link: &Link) -> Option<Joined> {
        let counts = &self.estimator.counts;
        // Media are no emitters that can be hidden: what is behind them is seen through them.
        let hidden = self.estimator.hide_emitters && !(P::EMISSIVE && link.rate.is_some());
        if counts.hit <= 0.0 || (vertex.edges == 1 && hidden) {
            return None;
        }
        // Both ends of the segment before must be able to join; across it joins s = 1, which from the sensor is
        // a light walk's first vertex and from anywhere else next-event estimation. Parallel rays meet what is
        // at infinity in one direction, which no light walk starts in.
        let unseen = P::INFINITE && link.infinite && self.estimator.scene.sensor.is_parallel();
        let joins = match (vertex.after_dirac, vertex.edges) {
            (true, _) => 0.0,
            (false, 1) if unseen => 0.0,
            (false, 1) => counts.lens * link.start,
            (false, _) => counts.next_event * link.connect,
        };
        let unit = vertex.inverse / counts.hit;
        let by_light = vertex.partial.scaled(link.forward * link.start * unit);
        let others = P::Sums::of(vertex.reach_before.scaled(joins * unit)).and(by_light);
        // `value` is radiance x cosine on shapes: the walk's density already contains that cosine. The rate of media is
        // for weights alone.
        let radiance = link.value / link.cosine;
        let weight = weight::hit(vertex.reach, others, self.estimator.heuristic);
        let weight_alone = weight::alone(vertex.reach);
        Some(Joined {
            value: vertex.throughput * radiance * (weight / counts.hit),
            weight,
            alone: vertex.throughput * radiance * (weight_alone / counts.hit),
            weight_alone,
            transmittance: Spectrum::ONE,
        })
    }

    /// s = 1: a freshly sampled emitter point.
    #[inline]
    fn next_event(&mut self, vertex: &Vertex<P::Sums>, stream: &mut Stream) {
        let scene = self.estimator.scene;
        self.recorder.start();
        if let Some(link) = scene.lights.sample_link(&scene.geometry, vertex.position, stream) {
            let joined = self.link(vertex, &link, stream);
            self.recorder.contribute(1, vertex.edges + 1, Meeting::Emitter(&link), joined.as_ref());
        }
        self.recorder.stop(1, vertex.edges + 1);
    }

    /// The join with an emitter point picked by next-event estimation.
    #[inline]
    pub fn link(&self, vertex: &Vertex<P::Sums>, link: &Link, stream: &mut Stream) -> Option<Joined> {
        let (scene, counts) = (self.estimator.scene, &self.estimator.counts);
        let (direction, distance_squared) = if P::INFINITE && link.infinite {
            (link.position, 1.0)
        } else {
            let (direction, _, d2) = measure::between(vertex.position, link.position)?;
            (direction, d2)
        };
        let eye = connect::vertex_end(scene, vertex, direction, Transport::Radiance)?;
        let light = connect::link_end::<P>(scene, link, eye.medium, -direction, counts.hit);
        let strategy = self.estimator.strategy(1.0);
        if P::INFINITE && link.infinite {
            let ray = Ray { origin: eye.origin, direction, t_max: f32::INFINITY };
            let span = Span { ray, cut: 0.0, distance_squared: 1.0, hidden: false };
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
            if vertex.edges + other.edges < estimator.max_edges {
                let (s, t) = (other.edges + 1, vertex.edges + 1);
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
        let (direction, _, distance_squared) = measure::between(vertex.position, other.position)?;
        let eye = connect::vertex_end(scene, vertex, direction, Transport::Radiance)?;
        let light = connect::vertex_end(scene, other, -direction, Transport::Importance)?;
        let strategy = self.estimator.strategy(self.estimator.counts.join);
        connect::join::<P>(scene, &eye, &light, distance_squared, strategy, false, stream)
    }
}
