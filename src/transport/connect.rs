//! Connections: the segment between the end of a camera subpath and the end of a light subpath, with
//! contribution (LW96 eq. 10) and weight (eq. 14).

use super::{
    estimator::Estimator,
    mis::{self, End, MisSums, Strategy, Weight},
    observer::Contribution,
    profile::Profile,
    segment,
    strategy::StrategyKind,
    vertex::Vertex,
};
use crate::{
    bsdf::Transport,
    math::{Channels, Vec3, measure, offset::Lift},
    medium::MediumIndex,
    sampling::Stream,
    scene::{
        Scene,
        lights::{EmitterPoint, EmitterSample},
    },
    shape::Ray,
};

/// The end of a walk at `vertex`, looking in unit direction `towards`; none where nothing scatters that way.
#[inline]
pub(super) fn vertex_end<P: Profile>(
    estimator: &Estimator<'_, P>,
    vertex: &Vertex<P::MisSums>,
    towards: Vec3,
    transport: Transport,
) -> Option<End<P::MisSums>> {
    let scene = estimator.scene;
    let scattering = vertex.scatter_towards::<P>(scene, estimator.guide.as_deref(), towards, transport);
    let value = vertex.subpath.throughput * scattering.value;
    if value.max_element() <= 0.0 {
        return None;
    }
    let (origin, medium) = vertex.depart(scene, towards);
    Some(End {
        origin: Some(origin),
        lift: vertex.lift(towards),
        medium,
        within: false,
        value,
        pdf_fwd: scattering.pdf_fwd,
        cosine: vertex.cosine::<P>(scene, towards),
        inv_pdf: vertex.subpath.inv_pdf,
        sigma_t: vertex.sigma_t(),
        pdf_over_hero: vertex.subpath.pdf_over_hero,
        others_before: vertex.others_before(scattering.pdf_rev),
        beside: None,
    })
}

/// The end at an emitter point picked by next-event estimation (s = 1), which connects to `reference` in `medium`, in
/// unit direction `towards`. `pdf_fwd` is the density of a light subpath's start over that of `sample`: weights here
/// are in units of the density of s = 1.
#[inline]
pub(super) fn emitter_end<P: Profile>(
    estimator: &Estimator<'_, P>,
    sample: &EmitterSample,
    medium: MediumIndex,
    reference: Vec3,
    towards: Vec3,
) -> End<P::MisSums> {
    let light = &estimator.scene.lights.all[sample.light as usize];
    let within = P::EMISSIVE && sample.point.is_volume();
    let emitter_hits = if light.emitter.is_hittable() { estimator.counts.emitter_hit } else { 0.0 };
    End {
        origin: sample.point.ray_origin(towards),
        lift: lift(&sample.point, towards),
        medium: if within { light.medium } else { estimator.scene.medium_of(sample, towards, medium) },
        within,
        value: sample.value / sample.pdf,
        pdf_fwd: estimator.pdf_start(sample, reference, towards) / sample.pdf,
        cosine: sample.cosine,
        inv_pdf: 1.0 / sample.pdf,
        sigma_t: rate_at::<P>(&sample.point),
        pdf_over_hero: P::Channels::splat(1.0),
        others_before: P::MisSums::of(StrategyKind::EmitterHit, P::Channels::splat(emitter_hits)),
        beside: None,
    }
}

/// What replaces sigma_t at an emitter's point: the rate at which emission is sampled in a medium, 1
/// elsewhere.
#[inline]
pub(super) fn rate_at<P: Profile>(point: &EmitterPoint) -> P::Channels {
    match point {
        EmitterPoint::Volume { rate, .. } if P::EMISSIVE => P::Channels::from_spectrum(*rate),
        _ => P::Channels::splat(1.0),
    }
}

/// See [`End::lift`].
#[inline]
fn lift(point: &EmitterPoint, towards: Vec3) -> Lift {
    match point {
        EmitterPoint::Surface(point) => point.lift(towards),
        _ => Lift::NONE,
    }
}

/// The segment of a connection.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// From the first end, to just before the second.
    pub ray: Ray,
    /// How much further away the second end lies.
    pub cut: f32,
    /// Squared distance of the ends; 1 where one is at infinity.
    pub distance_squared: f32,
    /// Emitters do not block the connection.
    pub hidden: bool,
}

/// Connects `a` and `b` by `strategy`; none where the segment is blocked; emitters that are `hidden` do not
/// block it. The caller divides by the number of samples it took.
#[inline(always)]
pub(super) fn connect<P: Profile>(
    scene: &Scene,
    a: &End<P::MisSums>,
    b: &End<P::MisSums>,
    distance_squared: f32,
    strategy: Strategy,
    hidden: bool,
    stream: &mut Stream,
) -> Option<Contribution> {
    let (origin, other) = (a.origin?, b.origin?);
    let end = b.lift.clear(origin, other);
    let (direction, distance, _) = measure::between(origin, end)?;
    let ray = Ray { origin, direction, t_max: distance };
    // An end nearer than the step away from its surface: nothing is between.
    let cut = (other - end).dot(direction).max(-distance);
    connect_along::<P>(scene, &Span { ray, cut, distance_squared, hidden }, a, b, strategy, stream)
}

/// The same along a given span from `a`: for ends at infinity.
///
/// LW96 eq. 10 over eq. 11, times eq. 14: each end holds the contribution of its own walk over its density.
#[inline(always)]
pub(super) fn connect_along<P: Profile>(
    scene: &Scene,
    span: &Span,
    a: &End<P::MisSums>,
    b: &End<P::MisSums>,
    strategy: Strategy,
    stream: &mut Stream,
) -> Option<Contribution> {
    let Span { ray, cut, distance_squared, hidden } = *span;
    let between = segment::transmittance::<P>(scene, ray, cut, a.medium, hidden, stream)?;
    if P::EMISSIVE && b.within && !scene.components(&between.medium).contains(&b.medium) {
        return None;
    }
    if P::NULLS && !b.within && !scene.agree(between.medium, b.medium) {
        return None;
    }
    // Where nothing comes through, weights may be 0 times an overflowed ratio of densities: no numbers.
    if P::MEDIA && between.transmittance.max_element() <= 0.0 {
        return None;
    }
    let geometry = 1.0 / distance_squared;
    let Weight { value: weight, shares } = mis::connection_weight::<P>(a, b, between.pdf, geometry, strategy);
    let value = a.value * b.value * between.transmittance * (geometry * weight);
    let weight_alone = mis::weight_alone(strategy.own::<P>(a.pdf_over_hero * b.pdf_over_hero));
    let alone = a.value * b.value * between.transmittance * (geometry * weight_alone);
    let (transmittance, expected) = (between.transmittance, between.pdf.to_spectrum());
    Some(Contribution { value, weight, alone, weight_alone, transmittance, expected, shares })
}
