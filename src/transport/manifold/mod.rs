//! Connections by way of smooth surfaces. Smooth glass and mirrors send the light of a point or of a single direction
//! to a vertex along isolated paths, which no walk meets by chance. Where the camera sees this vertex by way of smooth
//! surfaces alone, no other strategy makes the path. This module solves for the paths over one shape: all paths over a
//! plane, a ball or a tube with up to [`chain::MOST`] points there. They count as connections of s >= 2 light vertices,
//! with the weight 1.

mod bodies;
mod chain;
mod circle;
mod flats;
mod search;
#[cfg(test)]
mod tests;
mod tube;

use super::{
    camera_path::CameraPath,
    connect,
    mis::{End, MisSums},
    observer::{Contribution, Meeting, Observer},
    profile::Profile,
    segment,
    strategy::StrategyKind,
    vertex::Vertex,
};
use crate::{
    bsdf::{BsdfModel, Side, Transport},
    emitter::{BeamModel as _, InfiniteModel as _, Kind},
    math::{Spectrum, Vec3, measure},
    medium::MediumIndex,
    sampling::Stream,
    scene::{
        Scene,
        lights::{Aim, EmitterSample, Light},
    },
    shape::{Ray, SurfacePoint},
};
use bodies::Body;
use chain::{Chain, Link, Target};

/// The lamps of a scene that no walk can hit, and the smooth shapes to connect over.
pub(super) struct Manifold {
    bodies: Vec<Body>,
    /// Their indices, and the point or direction that their light comes from.
    lamps: Vec<(usize, Target)>,
}

impl Manifold {
    /// The lamps and shapes of `scene`; none where there are no such lamps or no such shapes.
    pub(super) fn of(scene: &Scene) -> Option<Self> {
        let lamps = scene.lights.all.iter().enumerate();
        let lamps: Vec<_> = lamps.filter_map(|(index, lamp)| Some((index, target(lamp)?))).collect();
        let bodies = if lamps.is_empty() { Vec::new() } else { Body::all(scene) };
        (!bodies.is_empty()).then_some(Self { bodies, lamps })
    }
}

/// The point or the single direction that the light of `lamp` comes from; none for other lamps.
fn target(lamp: &Light) -> Option<Target> {
    match &lamp.emitter.kind {
        Kind::Point(_) => Some(Target::Point(lamp.position.as_dvec3())),
        Kind::Infinite(emitter) => emitter.direction().map(|towards| Target::Direction(towards.as_dvec3())),
        Kind::Beam(emitter) => Some(Target::Direction(-emitter.direction().as_dvec3())),
        Kind::Surface(_) | Kind::Medium(_) => None,
    }
}

/// One of several, uniformly.
fn draw<'a, T>(all: &'a [T], stream: &mut Stream) -> &'a T {
    let number = (stream.uniform() * all.len() as f32) as usize;
    &all[number.min(all.len() - 1)]
}

impl<P: Profile, R: Observer> CameraPath<'_, P, R> {
    /// Connects `vertex` to a random lamp by way of a random smooth shape, unless another strategy makes such paths.
    #[inline(never)]
    pub(super) fn connect_bent(
        &mut self,
        manifold: &Manifold,
        vertex: &Vertex<P::MisSums>,
        stream: &mut Stream,
    ) {
        self.is_linked |= vertex.connections > 0.0;
        if self.is_linked {
            return;
        }
        let (lamp, target) = *draw(&manifold.lamps, stream);
        let body = draw(&manifold.bodies, stream);
        let chosen = 1.0 / (manifold.lamps.len() * manifold.bodies.len()) as f32;
        body.chains(vertex.position().as_dvec3(), target, &mut |chain| {
            self.connect_over(body, vertex, (lamp, chosen), target, chain, stream);
        });
    }

    /// Connects `vertex` along a chain to `lamp`; lamp and shape were drawn with probability `chosen`.
    fn connect_over(
        &mut self,
        body: &Body,
        vertex: &Vertex<P::MisSums>,
        (lamp, chosen): (usize, f32),
        target: Target,
        chain: &Chain,
        stream: &mut Stream,
    ) {
        let (edges, links) = (vertex.subpath.edges, chain.links());
        if !self.estimator.joins(edges + links.len() as u32) {
            return;
        }
        let last = links[links.len() - 1].position.as_vec3();
        let Scene { lights, geometry, .. } = self.estimator.scene;
        let Some(sample) = lights.sample_point_of(geometry, (lamp, chosen), last, Aim::default(), stream)
        else {
            return;
        };
        let (s, t) = (1 + links.len() as u32, edges + 1);
        self.observer.start();
        let contribution = self.bent(body, vertex, &sample, target, chain, stream);
        let towards = (links[0].position.as_vec3() - vertex.position()).normalize_or_zero();
        let meeting = Meeting::Bent { towards, last, sample: &sample };
        self.observer.contribute(s, t, meeting, contribution.as_ref());
        self.observer.stop(StrategyKind::Connection, s, t);
    }

    fn bent(
        &self,
        body: &Body,
        vertex: &Vertex<P::MisSums>,
        sample: &EmitterSample,
        target: Target,
        chain: &Chain,
        stream: &mut Stream,
    ) -> Option<Contribution> {
        let (scene, first) = (self.estimator.scene, &chain.links()[0]);
        let spread = chain.spread(vertex.position().as_dvec3(), target)? as f32;
        let (towards, _, _) = measure::between(vertex.position(), first.position.as_vec3())?;
        let start = connect::vertex_end(self.estimator, vertex, towards, Transport::Radiance)?;
        let camera = follow::<P>(scene, body, start, target, chain, stream)?;
        let origin = camera.origin?;
        let towards = target.seen_from(origin.as_dvec3()).as_vec3();
        let light = connect::emitter_end(self.estimator, sample, camera.medium, origin, -towards);
        // No other strategy makes the path.
        let light = End { pdf_fwd: 0.0, others_before: P::MisSums::none(), ..light };
        let strategy = self.estimator.strategy(StrategyKind::Connection);
        if P::INFINITE && sample.point.is_infinite() {
            let ray = Ray { origin, direction: towards, t_max: f32::INFINITY };
            let span = connect::Span { ray, cut: 0.0, distance_squared: 1.0 / spread, hidden: false };
            connect::connect_along::<P>(scene, &span, &camera, &light, strategy, stream)
        } else {
            connect::connect::<P>(scene, &camera, &light, 1.0 / spread, strategy, false, stream)
        }
    }
}

/// The end of a walk extended along a chain to its last point; none where it is blocked.
fn follow<P: Profile>(
    scene: &Scene,
    body: &Body,
    mut end: End<P::MisSums>,
    target: Target,
    chain: &Chain,
    stream: &mut Stream,
) -> Option<End<P::MisSums>> {
    let links = chain.links();
    for (number, link) in links.iter().enumerate() {
        let origin = end.origin?;
        let point = body.surface(scene, link, origin)?;
        let next = links.get(number + 1).map_or(target, |next| Target::Point(next.position));
        let outgoing = next.seen_from(link.position).as_vec3();
        let (incoming, medium, passed) = reach::<P>(scene, origin, &point, &end, stream)?;
        let coefficient = lobe(scene, &point, incoming, outgoing, link)?;
        end.value *= passed * coefficient;
        end.origin = Some(point.leaving(outgoing).origin);
        end.medium = scene.medium_towards(&point, incoming, outgoing, medium);
    }
    let none = P::MisSums::none();
    Some(End { pdf_fwd: 0.0, others_before: none, beside: None, ..end })
}

/// The unit direction from `point` back to `origin`, the medium at `point`, and the transmittance between them.
fn reach<P: Profile>(
    scene: &Scene,
    origin: Vec3,
    point: &SurfacePoint,
    from: &End<P::MisSums>,
    stream: &mut Stream,
) -> Option<(Vec3, MediumIndex, Spectrum)> {
    let (incoming, _, _) = measure::between(point.position, origin)?;
    let end = point.lift(incoming).clear(origin, point.position);
    let (direction, distance, _) = measure::between(origin, end)?;
    let ray = Ray { origin, direction, t_max: distance };
    let cut = (point.position - end).dot(direction).max(-distance);
    let between = segment::transmittance::<P>(scene, ray, cut, from.medium, false, stream)?;
    Some((incoming, between.medium, between.transmittance))
}

/// The fraction of radiance from `outgoing` that the surface sends to `incoming`.
fn lobe(
    scene: &Scene,
    point: &SurfacePoint,
    incoming: Vec3,
    outgoing: Vec3,
    link: &Link,
) -> Option<Spectrum> {
    let side = if link.ratio.is_some() { Side::Transmitted } else { Side::Reflected };
    let wi = point.shading.to_local(incoming);
    let (wo, coefficient) = scene.at(point, |bsdf, uv| bsdf.dirac(uv, wi, side, Transport::Radiance))?;
    // Positions are rounded, which matters at grazing angles. A path on the wrong side is rejected.
    let is_there = point.shading.to_local(outgoing).dot(wo) > 1.0 - ALIKE;
    is_there.then_some(coefficient)
}

/// 1 - cos of the greatest angle between a solution and the ray that the surface reflects or refracts there.
const ALIKE: f32 = 1e-3;
