//! The light subpath's side: vertices connected to the lens (t = 1) and kept for connections to camera
//! subpaths.

use super::{
    cache::LightCache,
    connect::{self, Span},
    estimator::Estimator,
    forced,
    interaction::Interaction,
    mis::{End, MisSums},
    observer::{Contribution, Meeting, Observer},
    profile::Profile,
    roulette::Pending,
    strategy::StrategyKind,
    vertex::Vertex,
    walk::{Departure, Kind, Visitor, walk},
};
use crate::{
    bsdf::Transport,
    math::{Channels, Spectrum, Vec2, Vec3, offset::Lift},
    sampling::Stream,
    scene::lights::{Densities, EmissionSample, EmitterPoint, Start},
    sensor::Projection,
    settings::options::Connections,
    shape::Ray,
};

/// One light subpath on its way.
pub(super) struct LightPath<'a, P: Profile, R> {
    estimator: &'a Estimator<'a, P>,
    cache: &'a mut LightCache<P::MisSums>,
    observer: &'a mut R,
    start: EmissionSample,
    hero: usize,
}

/// One light subpath: its vertices go to `cache`, its connections to the lens to `observer`.
pub(super) fn trace<P: Profile>(
    estimator: &Estimator<'_, P>,
    cache: &mut LightCache<P::MisSums>,
    observer: &mut impl Observer,
    hero: usize,
    stream: &mut Stream,
) {
    cache.add_walk(hero, estimator.keep);
    let scene = estimator.scene;
    let Some(start) = begin(estimator, stream) else { return };
    observer.emit(&start, hero);
    let departure = depart(estimator, &start);
    let max_edges = estimator.max_edges.saturating_sub(1);
    let kind = Kind { transport: Transport::Importance, max_edges, ..Kind::of_camera(estimator, hero) };
    let mut light = LightPath::new(estimator, cache, observer, start, hero);
    if estimator.starts_seen() {
        let aperture = scene.sensor.sample_aperture(stream);
        light.observer.start();
        let contribution = light.connect_start_to_lens(aperture, stream);
        light.splat(1, contribution);
    }
    if departure.throughput.max_element() <= 0.0 {
        return;
    }
    walk(scene, kind, departure, &mut light, stream);
}

/// Where a light subpath starts; none where nothing leaves.
pub(super) fn begin<P: Profile>(estimator: &Estimator<'_, P>, stream: &mut Stream) -> Option<EmissionSample> {
    let scene = estimator.scene;
    let start = scene.lights.sample_emission(&scene.geometry, estimator.starts.as_deref(), stream)?;
    // Points are sampled in the box around an emissive medium: not all lie in it.
    let Ray { origin, direction, .. } = start.ray;
    let astray = P::EMISSIVE && start.point.is_volume() && !scene.is_lit(start.light, origin, direction);
    (!astray).then_some(start)
}

/// Leaves the emitter. The only strategy before that is s = 0: a camera subpath that hits the emitter.
pub(super) fn depart<P: Profile>(
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
) -> Departure<P::MisSums> {
    let scene = estimator.scene;
    let emitter = &scene.lights.all[start.light as usize].emitter;
    let emitter_hits = if emitter.is_hittable() { estimator.counts.emitter_hit } else { 0.0 };
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
        from_infinity: start.point.is_parallel(),
        edges: 0,
        hidden: false,
        dirac: !emitter.is_connectible(),
        throughput: start.throughput * arriving,
        pdf_fwd: start.pdf_direction,
        others_before_segment: P::MisSums::of(
            StrategyKind::EmitterHit,
            connect::rate_at::<P>(&start.point).scaled(emitter_hits * start.cosine / start.pdf),
        ),
        pdf_over_hero: P::Channels::splat(1.0),
        pending: Pending::NONE,
        left: estimator.thinning.begun(start.position()),
    }
}

impl<P: Profile, R: Observer> Visitor<P> for LightPath<'_, P, R> {
    #[inline]
    fn kind(edges: u32) -> StrategyKind {
        if edges == 1 { StrategyKind::NextEvent } else { StrategyKind::Connection }
    }

    #[inline]
    fn connections(&self, edges: u32, position: Vec3) -> f32 {
        if edges > 1 {
            return self.estimator.counts.connection;
        }
        let scene = self.estimator.scene;
        let ratio =
            scene.lights.connect_over_start(&scene.geometry, &self.start, position, self.estimator.aim());
        self.estimator.counts.next_event * ratio
    }

    #[inline]
    fn depart(&mut self, departure: &Departure<P::MisSums>) {
        self.observer.depart(&departure.leg());
    }

    #[inline]
    fn arrive(&mut self, vertex: &Vertex<P::MisSums>, stream: &mut Stream) {
        self.observer.arrive(vertex.event());
        if !vertex.is_connectible(self.estimator.scene) {
            return;
        }
        let is_seen = self.estimator.counts.lens > 0.0 && self.estimator.joins(vertex.subpath.edges);
        if is_seen && !vertex.is_shut_in::<P>(self.estimator.scene) {
            let aperture = self.estimator.scene.sensor.sample_aperture(stream);
            self.observer.start();
            let contribution = self.connect_to_lens(vertex, aperture, stream);
            self.splat(vertex.subpath.edges + 1, contribution);
        }
        let keep = self.estimator.keep;
        if keep > 0.0 && (keep >= 1.0 || stream.uniform() < keep) {
            let keeps_all = self.estimator.connections == Connections::All;
            if let Some(place) = self.cache.push(self.hero, *vertex, keeps_all, stream) {
                self.observer.keep(place);
            }
        }
    }
}

impl<'a, P: Profile, R: Observer> LightPath<'a, P, R> {
    /// The walk that begins with `start`.
    pub(super) fn new(
        estimator: &'a Estimator<'a, P>,
        cache: &'a mut LightCache<P::MisSums>,
        observer: &'a mut R,
        start: EmissionSample,
        hero: usize,
    ) -> Self {
        Self { estimator, cache, observer, start, hero }
    }

    #[inline]
    fn splat(&mut self, s: u32, contribution: Option<(Vec2, Contribution)>) {
        if let Some((film, contribution)) = contribution {
            let contribution = contribution / self.estimator.counts.lens;
            self.observer.contribute(s, 1, Meeting::Lens(film), Some(&contribution));
        }
        self.observer.stop(StrategyKind::Lens, s, 1);
    }

    /// t = 1: connects a vertex to the sensor through a point of its aperture; the film position (pixels) and the
    /// contribution.
    #[inline]
    pub(super) fn connect_to_lens(
        &self,
        vertex: &Vertex<P::MisSums>,
        aperture: Vec2,
        stream: &mut Stream,
    ) -> Option<(Vec2, Contribution)> {
        let scene = self.estimator.scene;
        let seen = scene.sensor.project(vertex.position(), aperture)?;
        let hidden = self.estimator.hide_emitters && vertex.is_on_emitter(scene);
        if hidden || !self.observer.covers(seen.film) {
            return None;
        }
        let mut end =
            connect::vertex_end(self.estimator, vertex, -seen.ray.direction, Transport::Importance)?;
        if P::MEDIA
            && self.estimator.forced_interaction
            && matches!(vertex.interaction, Interaction::Medium(..))
        {
            end.others_before = end.others_before.times(forced::gain(self.estimator, seen.ray));
        }
        if P::MEDIA
            && self.estimator.counts.equiangular > 0.0
            && let (1, Interaction::Medium(position, _)) = (vertex.subpath.edges, vertex.interaction)
        {
            end.beside = Some(self.estimator.equiangular_seen(&self.start, &end, position, &seen));
        }
        let contribution = self.connect_end(&end, &seen, false, stream)?;
        Some((seen.film, contribution))
    }

    /// s = 1, t = 1: connects the emitter point itself to the sensor, if camera subpaths could hit it but s = 0 does
    /// not run.
    pub(super) fn connect_start_to_lens(
        &self,
        aperture: Vec2,
        stream: &mut Stream,
    ) -> Option<(Vec2, Contribution)> {
        let (estimator, start) = (self.estimator, &self.start);
        let scene = estimator.scene;
        let hidden = estimator.hide_emitters && !(P::EMISSIVE && start.point.is_volume());
        let seen_directly = estimator.max_edges > 0 && !hidden;
        let hittable = scene.lights.all[start.light as usize].emitter.is_hittable();
        if !estimator.starts_seen() || !hittable || !seen_directly {
            return None;
        }
        let seen = match start.point {
            EmitterPoint::Direction(towards) => scene.sensor.project_direction(towards, aperture),
            _ => scene.sensor.project(start.position(), aperture),
        };
        let seen = seen.filter(|seen| self.observer.covers(seen.film))?;
        let end = start_end::<P>(estimator, start, seen.ray.origin, -seen.ray.direction)?;
        let contribution = self.connect_end(&end, &seen, start.point.is_infinite(), stream)?;
        Some((seen.film, contribution))
    }

    #[inline]
    fn connect_end(
        &self,
        end: &End<P::MisSums>,
        seen: &Projection,
        infinite: bool,
        stream: &mut Stream,
    ) -> Option<Contribution> {
        let scene = self.estimator.scene;
        let Projection { ray, pdf, distance_squared, .. } = *seen;
        let hidden = self.estimator.hide_emitters;
        let lens = End {
            origin: Some(ray.origin),
            lift: Lift::NONE,
            medium: scene.sensor_medium(&ray),
            within: false,
            value: Spectrum::splat(pdf * scene.sensor.response()),
            pdf_fwd: pdf,
            cosine: 1.0,
            inv_pdf: 1.0,
            sigma_t: P::Channels::splat(1.0),
            pdf_over_hero: P::Channels::splat(1.0),
            others_before: P::MisSums::none(),
            beside: None,
        };
        let strategy = self.estimator.strategy(StrategyKind::Lens);
        if P::INFINITE && infinite {
            let span = Span { ray, cut: 0.0, distance_squared, hidden };
            connect::connect_along::<P>(scene, &span, &lens, end, strategy, stream)
        } else {
            connect::connect::<P>(scene, end, &lens, distance_squared, strategy, hidden, stream)
        }
    }
}

/// The emitter point of a light subpath as the end of a connection to `other` in unit direction `towards`; none where
/// it does not emit that way.
fn start_end<P: Profile>(
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
    other: Vec3,
    towards: Vec3,
) -> Option<End<P::MisSums>> {
    let emission = estimator.scene.lights.emission(start, towards)?;
    let unlearnt = Densities { point: start.unlearnt.point, direction: emission.pdf_direction };
    let densities = estimator.learnt(|| Start::towards(start.light, &start.point, other, towards), unlearnt);
    let origin = start.point.ray_origin(towards);
    let leaving = origin.unwrap_or(start.ray.origin);
    Some(End {
        origin,
        // This is never the far end of a connection; the lens is.
        lift: Lift::NONE,
        medium: estimator.scene.emission_medium(start.light, leaving, towards),
        within: false,
        value: emission.value / start.pdf,
        pdf_fwd: densities.direction,
        cosine: emission.cosine,
        inv_pdf: 1.0 / start.pdf,
        sigma_t: connect::rate_at::<P>(&start.point),
        pdf_over_hero: P::Channels::splat(1.0),
        others_before: P::MisSums::none(),
        beside: None,
    })
}
