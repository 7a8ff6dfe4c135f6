//! Forced interaction (P03T sec. A.2.2): a primary ray that crosses media makes two walks, one from a collision in them
//! and one from what lies behind. Thin media are seen by every sample, not by the few that chance has collide.
//!
//! Forcing makes collisions in thin media denser by 1 / (1 - T), T the transmittance of all media that the ray crosses.
//! The balance heuristic is told: that factor multiplies the density of every strategy that makes the first segment from
//! the eye, which all but the lens joins do. It depends on the primary ray alone, so that it is the same function of
//! the path in every strategy, and the weights sum to one. On surfaces and where media shine the factor is left at 1:
//! the weights there are not the best, but right.

use super::{
    Estimator,
    cache::LightCache,
    eye::{Eye, depart},
    profile::Profile,
    record::Recorder,
    segment::{self, FlightPart, ForcedEnd, Interaction, Segment},
    walk::{Kind, Visitor, go_on, walk},
};
use crate::{
    bsdf::Transport,
    math::{Lanes, Vec2},
    sampling::Stream,
    shape::Ray,
};

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
    let mut along = |part: &FlightPart<P::Lanes>, stream: &mut Stream| eye.pass(&departure, part, stream);
    let forced = segment::force::<P>(departure.segment(scene), hero, stream, &mut along);
    for ForcedEnd { flight, share } in forced.ends.into_iter().flatten() {
        eye.restart(departure.position);
        eye.depart(&departure);
        let next = go_on(scene, kind, &departure, &flight, &mut eye, stream, |subpath| {
            subpath.throughput = departure.throughput * share;
            if let Some(Interaction::Medium(..)) = flight.interaction {
                let gain = gain_of(forced.sure_depth);
                subpath.inverse /= gain.hero(hero);
                subpath.reach = subpath.reach * gain.scaled(1.0 / gain.hero(hero));
            }
        });
        if let Some(next) = next {
            walk(scene, kind, next, &mut eye, stream);
        }
    }
    eye.into_recorder()
}

/// By how much more densely forcing makes the first vertex from the eye in a medium, per lane, where primary ray `ray`
/// sees it.
pub fn gain<P: Profile>(estimator: &Estimator<'_, P>, ray: Ray) -> P::Lanes {
    let Estimator { scene, hide_emitters, .. } = *estimator;
    gain_of(segment::sure_depth::<P>(Segment::along(scene, ray, scene.sensor_medium, hide_emitters)))
}

/// No gain is taken to be more than this: thinner media are seen by eye walks alone as it is.
const MOST: f32 = 1e4;

/// 1 / (1 - exp(-depth)); where nothing is sure to be crossed nothing is known, and nothing gained.
fn gain_of<L: Lanes>(depth: L) -> L {
    let lane = |depth: f32| if depth > 0.0 { (-1.0 / (-depth).exp_m1()).min(MOST) } else { 1.0 };
    L::from_spectrum(depth.to_spectrum().map(lane))
}
