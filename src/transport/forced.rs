//! Forced interaction (P03T sec. A.2.2): a primary ray that crosses media makes two walks, one from a collision in them
//! and one from what lies behind. Thin media are seen by every sample, not by the few that chance has collide.
//!
//! The weights are those of walks that are left to chance: functions of the path that sum to one over its strategies,
//! which is all that they must be. Between strategies that make the first segment from the eye, which all but the lens
//! joins do, what forcing does to densities cancels; lens joins are weighted higher than would be best.

use super::{
    Estimator,
    cache::LightCache,
    eye::{Eye, depart},
    profile::Profile,
    record::Recorder,
    segment::{self, Flown},
    walk::{Kind, Visitor, land, visit, walk},
};
use crate::{bsdf::Transport, math::Vec2, sampling::Stream};

/// One eye sample with a forced interaction; the rest as in [`super::eye::sample`].
pub fn sample<P: Profile, R: Recorder<P::Sums>>(
    estimator: &Estimator<'_, P>,
    cache: &LightCache<P::Sums>,
    film: Vec2,
    aperture: Vec2,
    hero: usize,
    recorder: R,
    stream: &mut Stream,
) -> R {
    let (scene, max_edges) = (estimator.scene, estimator.max_edges);
    let kind = Kind { transport: Transport::Radiance, hero, max_edges };
    let departure = depart(estimator, film, aperture);
    let mut eye = Eye::new(estimator, cache, hero, departure.position, recorder);
    if max_edges == 0 {
        return eye.into_recorder();
    }
    let mut along = |flown: &Flown<P::Lanes>, stream: &mut Stream| eye.pass(&departure, flown, stream);
    let (ray, medium, hidden) = (departure.ray, departure.medium, departure.hidden);
    let ends = segment::force::<P>(scene, ray, medium, hidden, hero, stream, &mut along);
    for end in ends.into_iter().flatten() {
        eye.restart(departure.position);
        eye.depart(&departure);
        let Some(mut vertex) = land::<P>(&departure, &end.flight, hero, &eye) else { continue };
        vertex.throughput = departure.throughput * end.share;
        if let Some(next) = visit(scene, kind, &end.flight.landing, &vertex, &mut eye, stream) {
            walk(scene, kind, next, &mut eye, stream);
        }
    }
    eye.into_recorder()
}
