//! The random walk (LW96 sec. 3), one for eye and light: flights, collisions, reflections, absorption, and the
//! running sums of the weights.

use super::{
    profile::Profile,
    segment::{FlightPart, FlightState, FreeFlight, Interaction, Segment, sample_free_flight},
    vertex::{Subpath, Vertex, shading_correction},
    weight::Sums,
};
use crate::{
    bsdf::{BsdfModel, Transport},
    math::{Lanes, Spectrum, Vec3, measure, offset},
    medium::{Matter, MediumIndex},
    phase::{Deflection, PhaseModel},
    sampling::Stream,
    scene::Scene,
    shape::{Ray, SurfacePoint},
};

/// A walk about to fly: everything known before the next vertex is.
#[derive(Clone, Copy, Debug)]
pub struct Departure<S: Sums> {
    /// The vertex left behind.
    pub position: Vec3,
    /// The ray out of it.
    pub ray: Ray,
    /// The medium it starts in.
    pub medium: MediumIndex,
    /// True where the vertex is a direction of an emitter at infinity: the next vertex's density has no 1/d^2.
    pub from_infinity: bool,
    /// Segments so far.
    pub edges: u32,
    /// True where emitters do not stand in the way: before a camera that does not see them.
    pub hidden: bool,
    /// True if the direction was sampled by a Dirac lobe.
    pub dirac: bool,
    /// Contribution over density, this vertex's scattering included.
    pub throughput: Spectrum,
    /// Density of the direction, survival included [1/sr] (or of the start on the disk [1/m^2]).
    pub forward: f32,
    /// This vertex's D without what the next segment completes: tail x sigma_t x |cos| / p>^h.
    pub carried: S,
    /// reach of this vertex.
    pub reach: S::Lanes,
}

impl<S: Sums> Departure<S> {
    /// The segment ahead, which has no end yet.
    #[inline(always)]
    pub fn segment<'a>(&self, scene: &'a Scene) -> Segment<'a> {
        Segment::along(scene, self.ray, self.medium, self.hidden)
    }
}

/// What happens at the vertices of a walk.
pub trait Visitor<P: Profile> {
    /// n of the strategy that joins across the segment to the vertex at `position`, `edges` segments from the
    /// start.
    fn joins(&self, edges: u32, position: Vec3) -> f32;

    /// The walk sets out for the next vertex.
    #[inline]
    fn depart(&mut self, _departure: &Departure<P::Sums>) {}

    /// A vertex was reached; it may scatter on.
    fn arrive(&mut self, vertex: &Vertex<P::Sums>, stream: &mut Stream);

    /// A part of a flight from `departure` lies behind; only in profiles where media shine.
    fn pass(&mut self, _departure: &Departure<P::Sums>, _part: &FlightPart<P::Lanes>, _stream: &mut Stream) {}

    /// The walk left the scene, in the direction that the `incoming` of `subpath` is the reverse of; its density is per
    /// solid angle.
    fn escape(&mut self, _subpath: &Subpath<P::Sums>) {}
}

/// Which walk this is and how far it may go.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Eye or light.
    pub transport: Transport,
    /// The channel that samples distances.
    pub hero: usize,
    /// Most segments.
    pub max_edges: u32,
}

/// Walks from `departure` until absorption, escape or the depth limit, showing every vertex to `visitor`.
///
/// LW96 eq. 4: the recursion by which L is estimated.
#[inline]
pub fn walk<P: Profile>(
    scene: &Scene,
    kind: Kind,
    mut departure: Departure<P::Sums>,
    visitor: &mut impl Visitor<P>,
    stream: &mut Stream,
) {
    while departure.edges < kind.max_edges {
        visitor.depart(&departure);
        let mut along =
            |part: &FlightPart<P::Lanes>, stream: &mut Stream| visitor.pass(&departure, part, stream);
        let flight = sample_free_flight::<P>(departure.segment(scene), kind.hero, stream, &mut along);
        let Some(next) = go_on(scene, kind, &departure, &flight, visitor, stream, |_| ()) else { return };
        departure = next;
    }
}

/// Shows the end of a flight to `visitor`, the subpath as `adjusted`; how the walk goes on from there, if it does.
#[inline(always)]
pub fn go_on<P: Profile>(
    scene: &Scene,
    kind: Kind,
    departure: &Departure<P::Sums>,
    flight: &FreeFlight<P::Lanes>,
    visitor: &mut impl Visitor<P>,
    stream: &mut Stream,
    adjusted: impl FnOnce(&mut Subpath<P::Sums>),
) -> Option<Departure<P::Sums>> {
    let Some(interaction) = flight.interaction else {
        if P::INFINITE {
            let mut subpath =
                arrive::<P>(departure, &flight.state, flight.medium, &Arrival::at_infinity(), kind.hero)?;
            adjusted(&mut subpath);
            visitor.escape(&subpath);
        }
        return None;
    };
    let mut vertex = land::<P>(departure, flight, interaction, kind.hero, visitor)?;
    adjusted(&mut vertex.subpath);
    visitor.arrive(&vertex, stream);
    if vertex.subpath.edges == kind.max_edges {
        return None;
    }
    let next = scatter(scene, &vertex, kind.transport, stream)?;
    if vertex.subpath.edges < LONG { Some(next) } else { thinned(next, stream) }
}

/// Walks of more segments end by chance: where nothing absorbs and nothing is left to leave, in white fog without end,
/// they would else go on for ever.
const LONG: u32 = 100_000;
/// The chance with which a long walk goes on from a vertex.
const LONG_SURVIVAL: f32 = 0.9999;

/// Roulette that no density knows of, the same for all strategies.
#[cold]
fn thinned<S: Sums>(next: Departure<S>, stream: &mut Stream) -> Option<Departure<S>> {
    let throughput = next.throughput / LONG_SURVIVAL;
    (stream.uniform() < LONG_SURVIVAL).then_some(Departure { throughput, ..next })
}

/// Where a flight comes to, as far as densities depend on it.
pub struct Arrival<L> {
    /// World position; none at infinity.
    pub position: Option<Vec3>,
    /// |cos| on a surface, 1 elsewhere.
    pub cosine: f32,
    /// sigma_t per lane at a collision, the rate of [`crate::medium::Emission::rate`] where emission is met in a medium,
    /// 1 elsewhere.
    pub sigma_t: L,
}

impl<L: Lanes> Arrival<L> {
    /// In no place, but from a direction.
    fn at_infinity() -> Self {
        Self { position: None, cosine: 1.0, sigma_t: L::splat(1.0) }
    }
}

/// The vertex at the end of a flight; none if its density is no number.
#[inline]
pub fn land<P: Profile>(
    departure: &Departure<P::Sums>,
    flight: &FreeFlight<P::Lanes>,
    interaction: Interaction,
    hero: usize,
    visitor: &impl Visitor<P>,
) -> Option<Vertex<P::Sums>> {
    let position = interaction.position();
    let at = Arrival {
        position: Some(position),
        cosine: interaction.cosine(departure.ray.direction),
        sigma_t: interaction.sigma_t(),
    };
    let subpath = arrive::<P>(departure, &flight.state, flight.medium, &at, hero)?;
    let joins = if departure.dirac { 0.0 } else { visitor.joins(subpath.edges, position) };
    Some(Vertex { interaction, joins, subpath })
}

/// The subpath that a flight extends to `at`; none if its density is no number.
///
/// LW96 eq. 13: p' p'' / d^2, the density of the direction (`departure.forward`), that of the flight (eq. 6 in a
/// medium, eq. 7 on a surface) and the geometry; its inverse is what weights need.
#[inline]
pub fn arrive<P: Profile>(
    departure: &Departure<P::Sums>,
    state: &FlightState<P::Lanes>,
    medium: MediumIndex,
    at: &Arrival<P::Lanes>,
    hero: usize,
) -> Option<Subpath<P::Sums>> {
    let distance_squared = match at.position {
        Some(position) if !(P::INFINITE && departure.from_infinity) => {
            squared_distance(position, departure.position)
        }
        _ => 1.0,
    };
    let one = P::Lanes::splat(1.0);
    let attenuates = P::MEDIA || P::NULLS;
    let ratio = if attenuates { state.depth.flight_ratio(at.sigma_t, hero) } else { one };
    let transmitted = if attenuates { state.depth.exp_neg() } else { one };
    let geometry = measure::solid_angle_to_vertex(at.cosine, distance_squared);
    let density = departure.forward * transmitted.hero(hero) * at.sigma_t.hero(hero) * geometry;
    let inverse = 1.0 / density;
    // A density of 0, infinite, or so great or small that its inverse is: no walk in a real scene comes here.
    if !(inverse > 0.0 && inverse < f32::INFINITY) {
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
        inverse,
        reach_before: departure.reach,
        reach: departure.reach * ratio,
        partial: departure.carried.times(transmitted).scaled(1.0 / distance_squared),
    })
}

/// Squared distance of two vertices one flight apart, never 0. In dense media many a flight is shorter than a rounding
/// error of positions; it counts as one, for its walk goes on: ended there, walks of thousands of collisions would lose
/// their light.
#[inline]
fn squared_distance(a: Vec3, b: Vec3) -> f32 {
    let squared = a.distance_squared(b);
    // What is no number is none of these.
    if squared != 0.0 {
        return squared;
    }
    let rounding = offset::ROUNDOFF * a.abs().max_element();
    (rounding * rounding).max(f32::MIN_POSITIVE)
}

/// A direction after scattering.
pub struct Turn {
    /// Where the walk goes on to, unit.
    pub direction: Vec3,
    /// Factor on the throughput.
    pub weight: Spectrum,
    /// Density of `direction`, survival included [1/sr], or the probability of the Dirac lobe.
    pub forward: f32,
    /// The same for the way back.
    pub backward: f32,
    /// True if a Dirac lobe was sampled.
    pub dirac: bool,
}

/// Scatters at `vertex`; none if the walk is absorbed there (LW96 eq. 8 and 9 are subcritical).
#[inline]
fn scatter<S: Sums>(
    scene: &Scene,
    vertex: &Vertex<S>,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Departure<S>> {
    let turn = match &vertex.interaction {
        Interaction::Medium(_, matter) => collide(scene, vertex, matter, stream)?,
        Interaction::Surface(point) => reflect(scene, vertex, point, transport, stream)?,
    };
    Some(set_out(scene, vertex, &turn))
}

/// Leaves `vertex` in the direction of `turn`.
///
/// LW96 eq. 12: the densities of the subpath, with p'(x_i+1) of the next vertex.
#[inline]
pub fn set_out<S: Sums>(scene: &Scene, vertex: &Vertex<S>, turn: &Turn) -> Departure<S> {
    let subpath = &vertex.subpath;
    let (origin, medium) = vertex.depart(scene, turn.direction);
    let tail = if turn.dirac { subpath.partial.scaled(turn.backward) } else { vertex.tail(turn.backward) };
    Departure {
        position: vertex.position(),
        ray: Ray { origin, direction: turn.direction, t_max: f32::INFINITY },
        medium,
        from_infinity: false,
        edges: subpath.edges,
        hidden: false,
        dirac: turn.dirac,
        throughput: subpath.throughput * turn.weight,
        forward: turn.forward,
        carried: tail.times(vertex.sigma_t()).scaled(vertex.cosine(turn.direction) * subpath.inverse),
        reach: subpath.reach,
    }
}

/// LW96 eq. 8: p_scattering, sigma/kappa being the probability of survival.
#[inline]
fn collide<S: Sums>(scene: &Scene, vertex: &Vertex<S>, matter: &Matter, stream: &mut Stream) -> Option<Turn> {
    let medium = &scene.media[vertex.subpath.medium.0 as usize];
    let survival = matter.survival();
    if stream.uniform() >= survival {
        return None;
    }
    let direction = medium.phase.sample(-vertex.subpath.incoming, stream);
    let density = medium.phase.density(Deflection::between(-vertex.subpath.incoming, direction)) * survival;
    let weight = matter.albedo / survival;
    Some(Turn { direction, weight, forward: density, backward: density, dirac: false })
}

/// LW96 eq. 9: p_reflection, or whatever the bsdf samples by.
#[inline]
fn reflect<S: Sums>(
    scene: &Scene,
    vertex: &Vertex<S>,
    point: &SurfacePoint,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Turn> {
    let bsdf = scene.bsdf(point.shape);
    let wi = point.shading.to_local(vertex.subpath.incoming);
    let survival = bsdf.survival(point.uv, wi);
    if stream.uniform() >= survival {
        return None;
    }
    let sample = bsdf.sample(point.uv, wi, transport, stream)?;
    let direction = point.shading.to_world(sample.wo).normalize();
    let correction = shading_correction(point, vertex.subpath.incoming, direction, wi, sample.wo, transport);
    let weight = sample.weight * (correction / survival);
    if weight.max_element() <= 0.0 {
        return None;
    }
    let (forward, backward) = (sample.forward * survival, sample.backward * survival);
    Some(Turn { direction, weight, forward, backward, dirac: sample.dirac })
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
