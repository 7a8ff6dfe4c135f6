//! What a set of strategies cannot do in a scene: paths that it leaves out are black, not noisy.

use crate::{
    bsdf::BsdfModel,
    emitter::Emitter,
    math::{Spectrum, Vec2, Vec3},
    medium::tracker::Tracker,
    scene::Scene,
    transport::{Options, Strategies},
};

/// Kinds of paths that no strategy among `strategies` can make.
pub fn unreachable(scene: &Scene, strategies: Strategies, hide_emitters: bool) -> Vec<String> {
    if strategies == Strategies::NONE {
        return Vec::new();
    }
    let Strategies { hit, next_event, join, lens } = strategies;
    let smooth = has_smooth_surfaces(scene);
    let any = |is: fn(&Emitter) -> bool| scene.lights.all.iter().any(|light| is(&light.emitter));
    let (hittable, points) = (any(Emitter::is_hittable), any(|emitter| !emitter.is_hittable()));
    let beams = any(|emitter| !emitter.is_connectible());
    let surrounded = scene.lights.environment.is_some() && !hide_emitters;
    let parallel = scene.sensor.is_parallel();
    let kinds = [
        (!hit && !next_event && !lens, "the shortest paths, which have nothing to join"),
        (
            points && !next_event && !lens,
            "light of point, spot and directional emitters that is scattered once",
        ),
        (beams && !lens, "light of emitters that shine along a single direction"),
        (surrounded && parallel && !hit, "surroundings that a sensor of parallel rays sees directly"),
        (
            smooth && points && !lens,
            "light of point, spot and directional emitters over smooth mirrors or lenses",
        ),
        (
            smooth && points && lens,
            "light of point, spot and directional emitters that smooth mirrors or lenses alone lead to the eye",
        ),
        (smooth && !hit && !next_event && !join, "anything seen in or through smooth mirrors or lenses"),
        (
            smooth && hittable && !hit && (next_event || join),
            "emitters that smooth mirrors or lenses alone lead to the eye",
        ),
        (smooth && points && lens && join, "caustics of those emitters seen in smooth mirrors or lenses"),
        (hittable && !hide_emitters && !hit && !lens, "emitters that are seen directly"),
    ];
    kinds.into_iter().filter(|(is_missing, _)| *is_missing).map(|(_, kind)| kind.to_owned()).collect()
}

/// True if some surface mirrors or refracts by a single direction.
fn has_smooth_surfaces(scene: &Scene) -> bool {
    let mut bsdfs = scene.surfaces.iter().map(|surface| &scene.bsdfs[surface.bsdf as usize]);
    bsdfs.any(|bsdf| bsdf.has_dirac() && bsdf.survival(Vec2::ZERO, Vec3::Z) > 0.0)
}

/// What must be known of an estimator's images of `scene`: what is not in them, what is biased, and where error bars
/// mean little.
pub fn notes(scene: &Scene, options: &Options) -> Vec<String> {
    let Strategies { hit, next_event, lens, .. } = options.strategies;
    let missing = unreachable(scene, options.strategies, options.hide_emitters);
    let mut notes: Vec<String> = missing.into_iter().map(|kind| format!("leaves out {kind}")).collect();
    let around = &scene.media[scene.sensor_medium.0 as usize];
    if lens && !hit && !next_event && around.bound().sigma_t != Spectrum::ZERO {
        let why = "light scattered close to the camera, which only joins with the lens bring";
        notes.push(format!("its variance is infinite: {why}; errors grow with luck"));
    }
    let mut trackers = scene.media.iter().filter_map(|medium| Some(medium.heterogeneous()?.tracker()));
    if trackers.any(|tracker| matches!(tracker, Tracker::March(_))) {
        notes.push("is biased by the step of its ray marching".to_owned());
    }
    notes
}

/// True if the mean of an estimator's images of `scene` is the truth as far as any integrator's is.
pub fn is_trustworthy(scene: &Scene, options: &Options) -> bool {
    let missing = unreachable(scene, options.strategies, options.hide_emitters).len();
    let other_notes = notes(scene, options).len() - missing;
    other_notes == 0 && (missing == 0 || options.strategies == Strategies::BDPT)
}
