//! Forced interaction (P03T sec. A.2.2): a primary ray that crosses media starts two walks, one from a
//! collision in them and one from what lies behind. Every sample sees thin media, not only the few that
//! happen to collide.
//!
//! Forcing makes collisions in thin media denser by 1 / (1 - T), T the transmittance of all media that the ray crosses.
//! The balance heuristic accounts for this factor: it multiplies the density of every strategy that samples the first
//! segment from the camera, that is, of all but connections to the lens. The factor depends on the primary ray alone:
//! it is the same function of the path in every strategy, and the weights sum to one. On surfaces and where media emit
//! it is left at 1: the weights there are not optimal, but correct.

use super::{
    cache::Partners,
    camera_path::{CameraPath, depart},
    estimator::Estimator,
    interaction::Interaction,
    observer::Observer,
    profile::Profile,
    segment::{self, ForcedEnd, Passed, Segment},
    walk::{Kind, Visitor, go_on, walk},
};
use crate::{
    math::{Channels, Vec2},
    sampling::Stream,
    shape::Ray,
};

/// One camera sample with a forced interaction; the rest as in [`super::camera_path::sample`].
pub(super) fn sample<P: Profile, R: Observer>(
    estimator: &Estimator<'_, P>,
    light: Partners<'_, P::MisSums>,
    film: Vec2,
    aperture: Vec2,
    hero: usize,
    observer: R,
    stream: &mut Stream,
) -> R {
    let (scene, max_edges) = (estimator.scene, estimator.max_edges);
    let kind = Kind::of_camera(estimator, hero);
    let departure = depart(estimator, film, aperture);
    let mut camera = CameraPath::new(estimator, light, hero, observer);
    if max_edges == 0 {
        return camera.into_observer();
    }
    let mut along =
        |passed: &Passed<P::Channels>, stream: &mut Stream| camera.pass(&departure, passed, stream);
    let forced = segment::force::<P>(departure.segment(scene), hero, stream, &mut along);
    for ForcedEnd { flight, share } in forced.ends.into_iter().flatten() {
        camera.depart(&departure);
        let next = go_on(scene, kind, &departure, &flight, &mut camera, stream, |subpath| {
            subpath.throughput = departure.throughput * share;
            if let Some(Interaction::Medium(..)) = flight.interaction {
                let gain = gain_of(forced.sure_depth);
                subpath.inv_pdf /= gain.hero(hero);
                subpath.pdf_over_hero = subpath.pdf_over_hero * gain.scaled(1.0 / gain.hero(hero));
            }
        });
        if let Some(next) = next {
            walk(scene, kind, next, &mut camera, stream);
        }
    }
    camera.beside_walk(&departure, stream);
    camera.into_observer()
}

/// Factor per channel by which forcing raises the density of the first collision along the primary ray `ray`.
pub(super) fn gain<P: Profile>(estimator: &Estimator<'_, P>, ray: Ray) -> P::Channels {
    let Estimator { scene, hide_emitters, .. } = *estimator;
    gain_of(segment::sure_depth::<P>(Segment::along(scene, ray, scene.sensor_medium(&ray), hide_emitters)))
}

/// Largest gain: in thinner media the weights already leave nearly everything to camera subpaths.
const MOST: f32 = 1e4;

/// 1 / (1 - exp(-depth)); 1 where no medium is certain to be crossed.
fn gain_of<L: Channels>(depth: L) -> L {
    let channel = |depth: f32| if depth > 0.0 { (-1.0 / (-depth).exp_m1()).min(MOST) } else { 1.0 };
    L::from_spectrum(depth.to_spectrum().map(channel))
}
