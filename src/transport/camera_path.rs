//! The camera subpath's side: emitters hit and emissive media crossed (s = 0), next-event estimation (s = 1),
//! connections to light subpaths (s >= 2).

use super::{
    cache::Partners,
    connect::{self, Span},
    equiangular::FirstCollision,
    estimator::Estimator,
    interaction::Interaction,
    mis::{self, MisSums, Weight},
    observer::{Contribution, Meeting, Observer},
    profile::Profile,
    roulette::Pending,
    segment::{FlightPart, Passed},
    strategy::StrategyKind,
    vertex::{Subpath, Vertex},
    walk::{Arrival, Departure, Kind, Visitor, arrive, cross, walk},
};
use crate::{
    bsdf::Transport,
    math::{Channels, Spectrum, Vec2, Vec3, measure},
    sampling::Stream,
    scene::{Scene, lights::EmitterSample},
    sensor::SensorRay,
    shape::{Ray, SurfacePoint},
};

/// Gathers the radiance of one pixel sample.
pub(super) struct CameraPath<'a, P: Profile, R> {
    pub(super) estimator: &'a Estimator<'a, P>,
    light: Partners<'a, P::MisSums>,
    hero: usize,
    /// The last vertex that the walk left: the one that next-event estimation would connect from.
    previous: Vec3,
    /// Density of the primary ray's direction.
    pdf_fwd: f32,
    /// The first collision, if equiangular sampling could have placed it.
    pub(super) first: Option<FirstCollision>,
    /// True if some strategy connects across a segment of the walk so far.
    pub(super) is_linked: bool,
    pub(super) observer: R,
}

/// One camera subpath through `film` (pixels) and a point of the aperture, connected to vertices of `light` subpaths; its
/// radiance goes to `observer`.
pub(super) fn sample<P: Profile, R: Observer>(
    estimator: &Estimator<'_, P>,
    light: Partners<'_, P::MisSums>,
    film: Vec2,
    aperture: Vec2,
    hero: usize,
    observer: R,
    stream: &mut Stream,
) -> R {
    let kind = Kind::of_camera(estimator, hero);
    let departure = depart(estimator, film, aperture);
    let mut camera = CameraPath::new(estimator, light, hero, observer);
    walk(estimator.scene, kind, departure, &mut camera, stream);
    camera.beside_walk(&departure, stream);
    camera.observer
}

/// Leaves the sensor through a film position and a point of its aperture. No strategy connects before the
/// sensor: its sums are zero.
#[inline]
pub(super) fn depart<P: Profile>(
    estimator: &Estimator<'_, P>,
    film: Vec2,
    aperture: Vec2,
) -> Departure<P::MisSums> {
    let sensor = &estimator.scene.sensor;
    let SensorRay { position, ray, pdf } = sensor.ray(film, aperture);
    Departure {
        position,
        ray,
        medium: estimator.scene.sensor_medium(&ray),
        from_infinity: sensor.is_parallel(),
        edges: 0,
        hidden: estimator.hide_emitters,
        dirac: !sensor.is_connectible(),
        throughput: Spectrum::splat(sensor.response()),
        pdf_fwd: pdf,
        others_before_segment: P::MisSums::none(),
        pdf_over_hero: P::Channels::splat(1.0),
        pending: Pending::NONE,
        left: estimator.thinning.begun(position),
    }
}

impl<P: Profile, R: Observer> Visitor<P> for CameraPath<'_, P, R> {
    #[inline]
    fn kind(edges: u32) -> StrategyKind {
        if edges == 1 { StrategyKind::Lens } else { StrategyKind::Connection }
    }

    #[inline]
    fn connections(&self, edges: u32, _: Vec3) -> f32 {
        if edges == 1 { self.estimator.counts.lens } else { self.estimator.counts.connection }
    }

    #[inline]
    fn depart(&mut self, departure: &Departure<P::MisSums>) {
        self.previous = departure.position;
        self.is_linked &= departure.edges > 0;
        if P::MEDIA && departure.edges == 0 {
            (self.pdf_fwd, self.first) = (departure.pdf_fwd, None);
        }
        self.observer.depart(&departure.leg());
    }

    #[inline]
    fn reach(&mut self, vertex: &Vertex<P::MisSums>) {
        self.observer.arrive(vertex.event());
        // Where nulls exist, flights have already reported the emitters that they reached, passed or not.
        if !P::NULLS
            && let Interaction::Surface(point) = &vertex.interaction
            && let Some(light) = self.estimator.scene.surface(point.shape).emitter
        {
            self.surface_emission(&vertex.subpath, light, point, self.previous);
        }
    }

    #[inline]
    fn arrive(&mut self, vertex: &Vertex<P::MisSums>, stream: &mut Stream) {
        if P::MEDIA && self.estimator.counts.equiangular > 0.0 && vertex.subpath.edges == 1 {
            self.first = FirstCollision::of(vertex, self.previous, self.pdf_fwd);
        }
        let (estimator, edges) = (self.estimator, vertex.subpath.edges);
        if edges < estimator.max_edges && vertex.is_connectible(estimator.scene) {
            let is_found = estimator.counts.next_event > 0.0 && estimator.joins(edges);
            if is_found && !vertex.is_shut_in::<P>(estimator.scene) {
                self.next_event(vertex, stream);
            }
            self.connect_light(vertex, stream);
            if let Some(manifold) = &estimator.manifold {
                self.connect_bent(manifold, vertex, stream);
            }
        }
    }

    #[inline]
    fn pass(&mut self, departure: &Departure<P::MisSums>, passed: &Passed<P::Channels>, stream: &mut Stream) {
        if self.estimator.counts.emitter_hit <= 0.0 || departure.edges < self.estimator.skipped {
            return;
        }
        match passed {
            Passed::Medium(part) => self.medium_emission(departure, part, stream),
            Passed::Emitter(crossing) => {
                if let Some(subpath) = cross::<P>(departure, crossing, self.hero) {
                    self.surface_emission(&subpath, crossing.light, &crossing.point, departure.position);
                }
            }
        }
    }

    fn escape(&mut self, subpath: &Subpath<P::MisSums>) {
        self.observer.escape(&subpath.arrival());
        let (lights, previous, aim) = (&self.estimator.scene.lights, self.previous, self.estimator.aim());
        self.emission(subpath, || lights.infinity_hit(-subpath.incoming, previous, aim));
    }
}

impl<'a, P: Profile, R: Observer> CameraPath<'a, P, R> {
    /// Its contributions go to `observer`.
    pub(super) fn new(
        estimator: &'a Estimator<'a, P>,
        light: Partners<'a, P::MisSums>,
        hero: usize,
        observer: R,
    ) -> Self {
        Self {
            estimator,
            light,
            hero,
            previous: Vec3::ZERO,
            pdf_fwd: 0.0,
            first: None,
            is_linked: false,
            observer,
        }
    }

    /// Equiangular sampling along the primary ray. It follows the walk, which draws the evenly spread numbers.
    #[inline]
    pub(super) fn beside_walk(&mut self, departure: &Departure<P::MisSums>, stream: &mut Stream) {
        if P::MEDIA && self.estimator.counts.equiangular > 0.0 && self.estimator.max_edges >= 2 {
            self.sample_equiangular(departure, stream);
        }
    }

    /// What was gathered.
    pub(super) fn into_observer(self) -> R {
        self.observer
    }

    /// s = 0: the walk has reached an emitter; `found` returns the emitter point, none if it does not emit this way.
    #[inline]
    fn emission(&mut self, subpath: &Subpath<P::MisSums>, found: impl FnOnce() -> Option<EmitterSample>) {
        if self.estimator.counts.emitter_hit <= 0.0 || subpath.edges <= self.estimator.skipped {
            return;
        }
        self.observer.start();
        if let Some(sample) = found() {
            let contribution = self.emitter_hit(subpath, &sample, self.previous);
            self.observer.contribute(
                0,
                subpath.edges + 1,
                Meeting::Met(subpath.arrival(), &sample),
                contribution.as_ref(),
            );
        }
        self.observer.stop(StrategyKind::EmitterHit, 0, subpath.edges + 1);
    }

    /// s = 0 on a shape, whether or not the walk goes on beyond it: the shape's emission adds to the radiance that
    /// comes through it.
    #[inline]
    fn surface_emission(
        &mut self,
        subpath: &Subpath<P::MisSums>,
        light: u32,
        point: &SurfacePoint,
        previous: Vec3,
    ) {
        let (Scene { lights, geometry, .. }, sky) = (self.estimator.scene, self.estimator.sky);
        self.emission(subpath, || lights.surface_hit(geometry, light, point, previous, sky));
    }

    /// s = 0 in a medium: one point of each flight is sampled, in proportion to a bound on the emission. A
    /// flight reaches a point with the probability that radiance from there reaches the start, so the
    /// transmittance up to the point cancels.
    #[inline]
    fn medium_emission(
        &mut self,
        departure: &Departure<P::MisSums>,
        part: &FlightPart<P::Channels>,
        stream: &mut Stream,
    ) {
        let scene = self.estimator.scene;
        for medium in scene.components(&part.medium) {
            if let Some((light, emission)) = scene.lights.of_medium(*medium) {
                let emitting = part.emitting(&scene.media[medium.0 as usize]);
                self.emission_along(departure, part, light, emission.sample_along(&emitting, stream), stream);
            }
        }
    }

    /// s = 0 in a medium that is the emitter `light`; `sampled` is a distance (m) and its density (1/m).
    fn emission_along(
        &mut self,
        departure: &Departure<P::MisSums>,
        part: &FlightPart<P::Channels>,
        light: u32,
        sampled: Option<(f32, f32)>,
        stream: &mut Stream,
    ) {
        self.observer.start();
        if let Some((t, pdf)) = sampled
            && let Some((subpath, sample)) = self.meet(departure, part, light, t, stream)
        {
            let contribution = self.emitter_hit(&subpath, &sample, self.previous).map(|c| c / pdf);
            self.observer.contribute(
                0,
                subpath.edges + 1,
                Meeting::Met(subpath.arrival(), &sample),
                contribution.as_ref(),
            );
        }
        self.observer.stop(StrategyKind::EmitterHit, 0, departure.edges + 2);
    }

    /// The end of a walk at a point of an emissive medium, as the emitter `light`; none where it is dark there.
    pub(super) fn meet(
        &self,
        departure: &Departure<P::MisSums>,
        part: &FlightPart<P::Channels>,
        light: u32,
        t: f32,
        stream: &mut Stream,
    ) -> Option<(Subpath<P::MisSums>, EmitterSample)> {
        let (scene, position) = (self.estimator.scene, part.interval.segment.at(t));
        let sample = scene.lights.volume_hit(light, position, departure.position, self.estimator.sky)?;
        let state = part.until::<P>(scene, t, self.hero, stream);
        let sigma_t = connect::rate_at::<P>(&sample.point);
        let at = Arrival { position: Some(position), cosine: 1.0, sigma_t };
        Some((arrive::<P>(departure, &state, part.medium, &at, self.hero)?, sample))
    }

    /// s = 0: the walk has hit an emitter, on a segment from `previous`.
    ///
    /// LW96 eq. 3: the term L_e, weighted by eq. 14.
    #[inline]
    pub(super) fn emitter_hit(
        &self,
        subpath: &Subpath<P::MisSums>,
        sample: &EmitterSample,
        previous: Vec3,
    ) -> Option<Contribution> {
        let counts = &self.estimator.counts;
        // Media cannot be hidden as emitters: what is behind them is seen through them.
        let hidden = self.estimator.hide_emitters && !(P::EMISSIVE && sample.point.is_volume());
        if counts.emitter_hit <= 0.0 || (subpath.edges == 1 && hidden) {
            return None;
        }
        let (scene, medium) = (self.estimator.scene, subpath.medium);
        if P::NULLS && !scene.agree(medium, scene.medium_of(sample, subpath.incoming, medium)) {
            return None;
        }
        // Both ends of the segment before must be connectible for next-event estimation to connect across it. An
        // emitter that the camera sees is left to this strategy alone, see [`Estimator::starts_seen`].
        let has_other = !subpath.after_dirac && subpath.edges > 1;
        let connections = if has_other { counts.next_event * sample.pdf } else { 0.0 };
        let unit = subpath.inv_pdf / counts.emitter_hit;
        let pdf_start = self.estimator.pdf_start(sample, previous, subpath.incoming);
        let by_light = subpath.others_over_pdf_rev.scaled(pdf_start * unit);
        let next_event = subpath.pdf_over_hero_before.scaled(connections * unit);
        let mut others = P::MisSums::of(StrategyKind::NextEvent, next_event).and(by_light);
        if P::MEDIA
            && subpath.edges == 2
            && let Some(first) = &self.first
        {
            let along = self.estimator.equiangular(first, sample.light).scaled(sample.pdf * unit);
            others = others.and(P::MisSums::of(StrategyKind::Equiangular, along));
        }
        // `value` is radiance x cosine on shapes: the walk's density already contains that cosine. The rate
        // of media is used only in weights.
        let radiance = sample.value / sample.cosine;
        let strategy = self.estimator.strategy(StrategyKind::EmitterHit);
        let Weight { value: weight, shares } = strategy.weight(others, subpath.pdf_over_hero);
        let weight_alone = mis::weight_alone(subpath.pdf_over_hero);
        Some(Contribution {
            value: subpath.throughput * radiance * (weight / counts.emitter_hit),
            weight,
            alone: subpath.throughput * radiance * (weight_alone / counts.emitter_hit),
            weight_alone,
            transmittance: Spectrum::ONE,
            expected: Spectrum::ONE,
            shares,
        })
    }

    /// s = 1: a freshly sampled emitter point.
    #[inline]
    fn next_event(&mut self, vertex: &Vertex<P::MisSums>, stream: &mut Stream) {
        let Scene { lights, geometry, .. } = self.estimator.scene;
        let t = vertex.subpath.edges + 1;
        self.observer.start();
        if let Some(sample) = lights.sample_emitter(geometry, vertex.position(), self.estimator.aim(), stream)
        {
            let contribution = self.join_emitter(vertex, &sample, stream);
            self.observer.contribute(1, t, Meeting::Emitter(&sample), contribution.as_ref());
        }
        self.observer.stop(StrategyKind::NextEvent, 1, t);
    }

    /// The connection with an emitter point picked by next-event estimation.
    #[inline]
    pub(super) fn join_emitter(
        &self,
        vertex: &Vertex<P::MisSums>,
        sample: &EmitterSample,
        stream: &mut Stream,
    ) -> Option<Contribution> {
        let scene = self.estimator.scene;
        let (direction, distance_squared) = sample.point.seen_from(vertex.position())?;
        let mut camera = connect::vertex_end(self.estimator, vertex, direction, Transport::Radiance)?;
        if P::MEDIA
            && vertex.subpath.edges == 1
            && let Some(first) = &self.first
        {
            let along = self.estimator.equiangular(first, sample.light);
            camera.beside = Some(P::MisSums::of(StrategyKind::Equiangular, along));
        }
        let light =
            connect::emitter_end(self.estimator, sample, camera.medium, vertex.position(), -direction);
        let strategy = self.estimator.strategy(StrategyKind::NextEvent);
        if P::INFINITE && sample.point.is_infinite() {
            let ray = Ray { origin: camera.origin?, direction, t_max: f32::INFINITY };
            let span = Span { ray, cut: 0.0, distance_squared, hidden: false };
            connect::connect_along::<P>(scene, &span, &camera, &light, strategy, stream)
        } else {
            connect::connect::<P>(scene, &camera, &light, distance_squared, strategy, false, stream)
        }
    }

    /// s >= 2: vertices of light subpaths.
    #[inline]
    fn connect_light(&mut self, vertex: &Vertex<P::MisSums>, stream: &mut Stream) {
        let light = self.light;
        for turn in 0..light.count {
            let (index, other) = light.pick(turn, stream);
            if self.estimator.joins(vertex.subpath.edges + other.subpath.edges) {
                let (s, t) = (other.subpath.edges + 1, vertex.subpath.edges + 1);
                self.observer.start();
                let contribution =
                    self.connect_with(vertex, other, stream).map(|contribution| contribution * light.scale);
                self.observer.contribute(s, t, Meeting::Light(index, other.event()), contribution.as_ref());
                self.observer.stop(StrategyKind::Connection, s, t);
            }
        }
    }

    /// The connection with a vertex of a light subpath.
    #[inline]
    pub(super) fn connect_with(
        &self,
        vertex: &Vertex<P::MisSums>,
        other: &Vertex<P::MisSums>,
        stream: &mut Stream,
    ) -> Option<Contribution> {
        let scene = self.estimator.scene;
        let (direction, _, distance_squared) = measure::between(vertex.position(), other.position())?;
        let camera = connect::vertex_end(self.estimator, vertex, direction, Transport::Radiance)?;
        let light = connect::vertex_end(self.estimator, other, -direction, Transport::Importance)?;
        let strategy = self.estimator.strategy(StrategyKind::Connection);
        connect::connect::<P>(scene, &camera, &light, distance_squared, strategy, false, stream)
    }
}
