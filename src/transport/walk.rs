//! The random walk (LW96 sec. 3), one for camera and light: flights, collisions, reflections, absorption, and the
//! running sums of the weights.

pub(super) mod scatter;

use super::{
    estimator::Estimator,
    event::Leg,
    interaction::Interaction,
    mis::MisSums,
    profile::Profile,
    roulette::{Pending, Roulette},
    segment::{EmitterCrossing, FlightState, FreeFlight, Passed, Segment, sample_free_flight},
    strategy::StrategyKind,
    thinning::Thinning,
    vertex::{Subpath, Vertex},
};
use crate::{
    bsdf::Transport,
    guide::{Guidance, Guide},
    math::{Channels, Spectrum, Vec3, measure, offset},
    medium::MediumIndex,
    sampling::Stream,
    scene::Scene,
    shape::Ray,
};
use scatter::{ScatterSample, scatter};

/// A walk as it leaves a vertex: everything known before the next one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Departure<S: MisSums> {
    /// The vertex left behind.
    pub position: Vec3,
    /// The ray out of it.
    pub ray: Ray,
    /// The medium it starts in.
    pub medium: MediumIndex,
    /// True where parallel light leaves an emitter, as from infinity: the next vertex's density has no 1/d^2.
    pub from_infinity: bool,
    /// Segments so far.
    pub edges: u32,
    /// True where emitters do not block: before a camera that does not see them.
    pub hidden: bool,
    /// True if the direction was sampled by a Dirac lobe.
    pub dirac: bool,
    /// Contribution over density, this vertex's scattering included.
    pub throughput: Spectrum,
    /// Density of the direction, survival included (1/sr) (or of the start on the disk (1/m^2)).
    pub pdf_fwd: f32,
    /// This vertex's D without what the next segment completes: others_before x sigma_t x |cos| / p>^h.
    pub others_before_segment: S,
    /// pdf_over_hero of this vertex.
    pub pdf_over_hero: S::Channels,
    /// The roulette of this vertex, if it is drawn at the next one.
    pub pending: Pending,
    /// The part of all walks that [`Thinning`] has let come this far.
    pub left: f32,
}

impl<S: MisSums> Departure<S> {
    /// What observers see of it.
    #[inline]
    pub(super) fn leg(&self) -> Leg {
        let Self { position, ray, medium, edges, dirac, pdf_fwd, throughput, pending, .. } = *self;
        let (direction, density, by_albedo) = (ray.direction, pdf_fwd, pending.by_albedo());
        Leg { position, direction, medium, edges, dirac, density, throughput, by_albedo }
    }

    /// The segment ahead, which has no end yet.
    #[inline(always)]
    pub(super) fn segment<'a>(&self, scene: &'a Scene) -> Segment<'a> {
        Segment::along(scene, self.ray, self.medium, self.hidden)
    }
}

/// What happens at the vertices of a walk.
pub(super) trait Visitor<P: Profile> {
    /// The kind of the strategy that connects across segment `edges` of the walk.
    fn kind(edges: u32) -> StrategyKind;

    /// n of the strategy that connects across the segment to the vertex at `position`, `edges` segments from
    /// the start.
    fn connections(&self, edges: u32, position: Vec3) -> f32;

    /// The walk sets out for the next vertex.
    #[inline]
    fn depart(&mut self, _departure: &Departure<P::MisSums>) {}

    /// A vertex was reached; the walk may end there.
    #[inline]
    fn reach(&mut self, _vertex: &Vertex<P::MisSums>) {}

    /// The walk did not end at the vertex and may scatter.
    fn arrive(&mut self, vertex: &Vertex<P::MisSums>, stream: &mut Stream);

    /// The flight from `departure` passes something that may emit.
    fn pass(
        &mut self,
        _departure: &Departure<P::MisSums>,
        _passed: &Passed<P::Channels>,
        _stream: &mut Stream,
    ) {
    }

    /// The walk left the scene, opposite to `incoming` of the subpath; its density is per solid angle.
    fn escape(&mut self, _subpath: &Subpath<P::MisSums>) {}
}

/// Which walk this is and how far it may go.
#[derive(Clone, Copy, Debug)]
pub(super) struct Kind<'a> {
    /// Camera or light.
    pub transport: Transport,
    /// The channel that samples distances.
    pub hero: usize,
    /// Most segments.
    pub max_edges: u32,
    /// Its Russian roulette.
    pub roulette: Roulette,
    /// Its Russian roulette where it is long or far away.
    pub thinning: &'a Thinning,
    /// The guide that it follows.
    pub guide: Option<&'a Guide>,
}

impl<'a> Kind<'a> {
    /// A camera subpath of channel `hero`.
    #[inline]
    pub(super) fn of_camera<P: Profile>(estimator: &'a Estimator<'_, P>, hero: usize) -> Self {
        let Estimator { max_edges, roulette, ref thinning, .. } = *estimator;
        let guide = estimator.guide.as_deref();
        Self { transport: Transport::Radiance, hero, max_edges, roulette, thinning, guide }
    }
}

/// Walks from `departure` until absorption, escape or the depth limit, showing every vertex to `visitor`.
///
/// LW96 eq. 4: the recursion by which L is estimated.
#[inline(always)]
pub(super) fn walk<P: Profile>(
    scene: &Scene,
    kind: Kind<'_>,
    mut departure: Departure<P::MisSums>,
    visitor: &mut impl Visitor<P>,
    stream: &mut Stream,
) {
    while departure.edges < kind.max_edges {
        visitor.depart(&departure);
        let mut along =
            |passed: &Passed<P::Channels>, stream: &mut Stream| visitor.pass(&departure, passed, stream);
        let flight = sample_free_flight::<P>(departure.segment(scene), kind.hero, stream, &mut along);
        let Some(next) = go_on(scene, kind, &departure, &flight, visitor, stream, |_| ()) else { return };
        departure = next;
    }
}

/// Shows the end of a flight to `visitor`, after `adjusted` has changed the subpath; the next departure, if the walk
/// goes on.
#[inline(always)]
pub(super) fn go_on<P: Profile>(
    scene: &Scene,
    kind: Kind<'_>,
    departure: &Departure<P::MisSums>,
    flight: &FreeFlight<P::Channels>,
    visitor: &mut impl Visitor<P>,
    stream: &mut Stream,
    adjusted: impl FnOnce(&mut Subpath<P::MisSums>),
) -> Option<Departure<P::MisSums>> {
    let Some(interaction) = flight.interaction else {
        if P::INFINITE {
            let mut subpath =
                arrive::<P>(departure, &flight.state, flight.medium, &Arrival::at_infinity(), kind.hero)?;
            adjusted(&mut subpath);
            visitor.escape(&subpath);
        }
        return None;
    };
    let mut vertex = land::<P, _>(scene, kind, departure, flight, interaction, visitor)?;
    adjusted(&mut vertex.subpath);
    visitor.reach(&vertex);
    vertex.subpath.survive(departure.pending.survival, stream)?;
    visitor.arrive(&vertex, stream);
    if vertex.subpath.edges == kind.max_edges {
        return None;
    }
    let next = scatter::<P>(scene, kind, &vertex, stream)?;
    if kind.thinning.spares(departure.left, &next) {
        return Some(next);
    }
    kind.thinning.thin(departure.left, next, stream)
}

/// Where a flight arrives, as far as densities depend on it.
pub(super) struct Arrival<L> {
    /// World position; none at infinity.
    pub position: Option<Vec3>,
    /// See [`Interaction::cosine`]; 1 where there is neither a surface nor a collision.
    pub cosine: f32,
    /// sigma_t per channel at a collision, the rate of [`crate::medium::Emission::rate`] where emission is
    /// sampled in a medium, 1 elsewhere.
    pub sigma_t: L,
}

impl<L: Channels> Arrival<L> {
    /// At no position, but from a direction.
    fn at_infinity() -> Self {
        Self { position: None, cosine: 1.0, sigma_t: L::splat(1.0) }
    }
}

/// The vertex at the end of a flight; none if its density is not finite and positive.
#[inline(always)]
pub(super) fn land<P: Profile, V: Visitor<P>>(
    scene: &Scene,
    kind: Kind<'_>,
    departure: &Departure<P::MisSums>,
    flight: &FreeFlight<P::Channels>,
    interaction: Interaction,
    visitor: &V,
) -> Option<Vertex<P::MisSums>> {
    let position = interaction.position();
    let at = Arrival {
        position: Some(position),
        cosine: interaction.cosine::<P>(scene, departure.ray.direction),
        sigma_t: interaction.sigma_t(),
    };
    let subpath = arrive::<P>(departure, &flight.state, flight.medium, &at, kind.hero)?;
    let connections = if departure.dirac { 0.0 } else { visitor.connections(subpath.edges, position) };
    let albedo = interaction.albedo_bound(scene, subpath.incoming);
    let (survival, pending) = kind.roulette.at(albedo, departure.pending);
    let guidance = match kind.guide {
        Some(guide) if P::GUIDED && interaction.is_connectible(scene) => {
            guide.guidance(position, interaction.normal(), subpath.incoming, kind.transport)
        }
        _ => Guidance::NONE,
    };
    let kind = V::kind(subpath.edges);
    Some(Vertex { interaction, survival, pending, connections, kind, guidance, subpath })
}

/// The subpath that a flight extends to `at`; none if its density is not finite and positive.
///
/// LW96 eq. 13: p' p'' / d^2, that is, the density of the direction (`departure.pdf_fwd`), the density of the flight
/// (eq. 6 in a medium, eq. 7 on a surface) and the geometry. Weights need its inverse.
#[inline]
pub(super) fn arrive<P: Profile>(
    departure: &Departure<P::MisSums>,
    state: &FlightState<P::Channels>,
    medium: MediumIndex,
    at: &Arrival<P::Channels>,
    hero: usize,
) -> Option<Subpath<P::MisSums>> {
    let distance_squared = match at.position {
        Some(position) if !(P::INFINITE && departure.from_infinity) => {
            squared_distance(position, departure.position)
        }
        _ => 1.0,
    };
    let one = P::Channels::splat(1.0);
    let attenuates = P::MEDIA || P::NULLS;
    let ratio = if attenuates { state.depth.flight_ratio(at.sigma_t, hero) } else { one };
    let transmitted = if attenuates { state.depth.exp_neg() } else { one };
    let geometry = measure::solid_angle_to_vertex(at.cosine, distance_squared);
    let pdf = departure.pdf_fwd * transmitted.hero(hero) * at.sigma_t.hero(hero) * geometry;
    let inv_pdf = 1.0 / pdf;
    // The density or its inverse is 0 or infinite: no walk in a real scene reaches this.
    if !(inv_pdf > 0.0 && inv_pdf < f32::INFINITY) {
        return None;
    }
    let sampled = if P::HETEROGENEOUS { state.ratio } else { ratio };
    let mut throughput = departure.throughput * sampled.to_spectrum();
    if P::NULLS {
        throughput *= state.tint;
    }
    Some(Subpath {
        incoming: -departure.ray.direction,
        medium,
        edges: departure.edges + 1,
        after_dirac: departure.dirac,
        throughput,
        inv_pdf,
        pdf_over_hero_before: departure.pdf_over_hero,
        pdf_over_hero: departure.pdf_over_hero * ratio,
        others_over_pdf_rev: departure
            .others_before_segment
            .times(transmitted)
            .scaled(1.0 / distance_squared),
    })
}

/// The subpath to a point of an emitter that a flight passes.
pub(super) fn cross<P: Profile>(
    departure: &Departure<P::MisSums>,
    crossing: &EmitterCrossing<P::Channels>,
    hero: usize,
) -> Option<Subpath<P::MisSums>> {
    let EmitterCrossing { point, medium, before, .. } = crossing;
    let at = Arrival {
        position: Some(point.position),
        cosine: point.normal.dot(departure.ray.direction).abs(),
        sigma_t: P::Channels::splat(1.0),
    };
    let mut subpath = arrive::<P>(departure, before, *medium, &at, hero)?;
    if crossing.certain {
        subpath.throughput = departure.throughput * before.ratio.to_spectrum() * before.tint;
    }
    Some(subpath)
}

/// Squared distance of two vertices one flight apart, never 0. In dense media many flights are shorter than a rounding
/// error of positions. They count as one rounding error: ending them would lose the light of walks of thousands of
/// collisions.
#[inline]
fn squared_distance(a: Vec3, b: Vec3) -> f32 {
    let squared = a.distance_squared(b);
    // NaN is not 0: it is returned.
    if squared != 0.0 {
        return squared;
    }
    let rounding = offset::ROUNDOFF * a.abs().max_element();
    (rounding * rounding).max(f32::MIN_POSITIVE)
}

/// Leaves `vertex` in the direction of `scattered`.
///
/// LW96 eq. 12: the densities of the subpath, with p'(x_i+1) of the next vertex.
#[inline]
pub(super) fn set_out<P: Profile>(
    scene: &Scene,
    vertex: &Vertex<P::MisSums>,
    scattered: &ScatterSample,
) -> Departure<P::MisSums> {
    let subpath = &vertex.subpath;
    let (origin, medium) = vertex.depart(scene, scattered.direction);
    let others_before = if scattered.dirac {
        subpath.others_over_pdf_rev.scaled(scattered.pdf_rev)
    } else {
        vertex.others_before(scattered.pdf_rev)
    };
    Departure {
        position: vertex.position(),
        ray: Ray { origin, direction: scattered.direction, t_max: f32::INFINITY },
        medium,
        from_infinity: false,
        edges: subpath.edges,
        hidden: false,
        dirac: scattered.dirac,
        throughput: subpath.throughput * scattered.weight,
        pdf_fwd: scattered.pdf_fwd,
        others_before_segment: others_before
            .times(vertex.sigma_t())
            .scaled(vertex.cosine::<P>(scene, scattered.direction) * subpath.inv_pdf),
        pdf_over_hero: subpath.pdf_over_hero,
        pending: vertex.pending,
        left: 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vertices_are_never_without_distance() {
        let place = Vec3::new(3.0, -4.0, 1.0);
        assert!(squared_distance(place, place) > 1e-14);
        assert!(squared_distance(place, place) < 1e-12);
        assert!(squared_distance(Vec3::ZERO, Vec3::ZERO) > 0.0);
        assert_eq!(squared_distance(place, Vec3::new(3.0, -4.0, 3.0)), 4.0);
    }
}
