//! The random walk (LW96 sec. 3), one for eye and light: flights, collisions, reflections, absorption, and the
//! running sums of the weights.

use super::{
    profile::Profile,
    segment::{self, Flight, Flown, Landing},
    vertex::{Site, Vertex, shading_correction},
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
    fn pass(&mut self, _departure: &Departure<P::Sums>, _flown: &Flown<P::Lanes>, _stream: &mut Stream) {}

    /// The walk left the scene: `vertex` stands for the direction it left in (its `incoming` reversed), its
    /// density per solid angle.
    fn escape(&mut self, vertex: &Vertex<P::Sums>);
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
        let Departure { ray, medium, .. } = departure;
        let mut along =
            |flown: &Flown<P::Lanes>, stream: &mut Stream| visitor.pass(&departure, flown, stream);
        let flight = segment::fly::<P>(scene, ray, medium, departure.hidden, kind.hero, stream, &mut along);
        let Some(vertex) = land::<P>(&departure, &flight, kind.hero, visitor) else { return };
        let Some(next) = visit(scene, kind, &flight.landing, &vertex, visitor, stream) else { return };
        departure = next;
    }
}

/// Shows the end of a flight to `visitor`; how the walk goes on from there, if it does.
#[inline(always)]
pub fn visit<P: Profile>(
    scene: &Scene,
    kind: Kind,
    landing: &Landing,
    vertex: &Vertex<P::Sums>,
    visitor: &mut impl Visitor<P>,
    stream: &mut Stream,
) -> Option<Departure<P::Sums>> {
    if matches!(landing, Landing::Escape) {
        if P::INFINITE {
            visitor.escape(vertex);
        }
        return None;
    }
    visitor.arrive(vertex, stream);
    if vertex.edges == kind.max_edges {
        return None;
    }
    let next = scatter(scene, vertex, kind.transport, stream)?;
    if vertex.edges < LONG { Some(next) } else { thinned(next, stream) }
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

/// The vertex at the end of a flight; none if its density is no number.
#[inline]
pub fn land<P: Profile>(
    departure: &Departure<P::Sums>,
    flight: &Flight<P::Lanes>,
    hero: usize,
    visitor: &impl Visitor<P>,
) -> Option<Vertex<P::Sums>> {
    let direction = departure.ray.direction;
    let (position, site) = match flight.landing {
        Landing::Surface(point) => (point.position, Site::Surface(point)),
        Landing::Medium(position, matter) => (position, Site::Medium(matter)),
        Landing::Escape => (direction, Site::Medium(Matter::NOTHING)),
    };
    let escaped = matches!(flight.landing, Landing::Escape);
    let distance_squared = if (P::INFINITE && departure.from_infinity) || escaped {
        1.0
    } else {
        squared_distance(position, departure.position)
    };
    let mut vertex = Vertex {
        position,
        site,
        incoming: -direction,
        medium: flight.medium,
        edges: departure.edges + 1,
        after_dirac: departure.dirac,
        throughput: departure.throughput,
        joins: 0.0,
        inverse: 0.0,
        reach_before: departure.reach,
        reach: departure.reach,
        partial: departure.carried,
    };
    let sigma_t = if escaped { P::Lanes::splat(1.0) } else { vertex.sigma_t() };
    let one = P::Lanes::splat(1.0);
    let attenuates = P::MEDIA || P::NULLS;
    let ratio = if attenuates { flight.depth.flight_ratio(sigma_t, hero) } else { one };
    let transmitted = if attenuates { flight.depth.exp_neg() } else { one };
    let geometry = measure::solid_angle_to_vertex(vertex.cosine(direction), distance_squared);
    let density = departure.forward * transmitted.hero(hero) * sigma_t.hero(hero) * geometry;
    vertex.inverse = 1.0 / density;
    // A density of 0, infinite, or so great or small that its inverse is: no walk in a real scene comes here.
    if !(vertex.inverse > 0.0 && vertex.inverse < f32::INFINITY) {
        return None;
    }
    vertex.partial = departure.carried.times(transmitted).scaled(1.0 / distance_squared);
    vertex.reach = departure.reach * ratio;
    let sampled = if P::HETEROGENEOUS { flight.ratio } else { ratio };
    vertex.throughput *= sampled.to_spectrum();
    if P::NULLS {
        vertex.throughput *= flight.tint;
    }
    vertex.joins = if departure.dirac { 0.0 } else { visitor.joins(vertex.edges, position) };
    Some(vertex)
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

/// Scatters at `vertex`; none if the walk is absorbed there (LW96 eq. 8 and 9).
#[inline]
fn scatter<S: Sums>(
    scene: &Scene,
    vertex: &Vertex<S>,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Departure<S>> {
    let turn = match &vertex.site {
        Site::Medium(matter) => collide(scene, vertex, matter, stream)?,
        Site::Surface(point) => reflect(scene, vertex, point, transport, stream)?,
    };
    Some(set_out(scene, vertex, &turn))
}

/// Leaves `vertex` in the direction of `turn`.
#[inline]
pub fn set_out<S: Sums>(scene: &Scene, vertex: &Vertex<S>, turn: &Turn) -> Departure<S> {
    let (origin, medium) = vertex.depart(scene, turn.direction);
    let tail = if turn.dirac { vertex.partial.scaled(turn.backward) } else { vertex.tail(turn.backward) };
    Departure {
        position: vertex.position,
        ray: Ray { origin, direction: turn.direction, t_max: f32::INFINITY },
        medium,
        from_infinity: false,
        edges: vertex.edges,
        hidden: false,
        dirac: turn.dirac,
        throughput: vertex.throughput * turn.weight,
        forward: turn.forward,
        carried: tail.times(vertex.sigma_t()).scaled(vertex.cosine(turn.direction) * vertex.inverse),
        reach: vertex.reach,
    }
}

#[inline]
fn collide<S: Sums>(scene: &Scene, vertex: &Vertex<S>, matter: &Matter, stream: &mut Stream) -> Option<Turn> {
    let medium = &scene.media[vertex.medium.0 as usize];
    let survival = matter.survival();
    if stream.uniform() >= survival {
        return None;
    }
    let direction = medium.phase.sample(-vertex.incoming, stream);
    let density = medium.phase.density(Deflection::between(-vertex.incoming, direction)) * survival;
    let weight = matter.albedo / survival;
    Some(Turn { direction, weight, forward: density, backward: density, dirac: false })
}

#[inline]
fn reflect<S: Sums>(
    scene: &Scene,
    vertex: &Vertex<S>,
    point: &SurfacePoint,
    transport: Transport,
    stream: &mut Stream,
) -> Option<Turn> {
    let bsdf = scene.bsdf(point.shape);
    let wi = point.shading.to_local(vertex.incoming);
    let survival = bsdf.survival(point.uv, wi);
    if stream.uniform() >= survival {
        return None;
    }
    let sample = bsdf.sample(point.uv, wi, transport, stream)?;
    let direction = point.shading.to_world(sample.wo).normalize();
    let correction = shading_correction(point, vertex.incoming, direction, wi, sample.wo, transport);
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
