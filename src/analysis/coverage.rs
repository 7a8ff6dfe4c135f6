//! Which paths of a scene a set of strategies can make: those that it cannot are black in its images, not noisy.
//!
//! What decides is how a path scatters, not where: an emitter of some kind, then vertices that scatter by a Dirac lobe
//! or not. Five vertices show all there is to see of the ends and of two neighbours between them.

use crate::{
    bsdf::BsdfModel,
    emitter::Kind,
    math::{Spectrum, Vec2, Vec3},
    medium::{Medium, distance::DistanceSampler},
    scene::Scene,
    transport::{Options, Strategies, observer::StrategyKind},
};

/// Most vertices between emitter and lens that are looked at.
const VERTICES: u32 = 5;

/// What bounds the paths of an image.
#[derive(Clone, Copy, Debug)]
pub struct Paths {
    /// Most segments; none for no limit.
    pub max_depth: Option<u32>,
    /// The camera does not see emitters.
    pub hide_emitters: bool,
}

impl From<&Options> for Paths {
    fn from(options: &Options) -> Self {
        Self { max_depth: options.max_depth, hide_emitters: options.hide_emitters }
    }
}

/// What of a scene decides which strategies can make its paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Traits {
    /// One of every kind of emitters that differ in this.
    emitters: Vec<EmitterTraits>,
    /// Something scatters by Dirac lobes.
    smooth: bool,
    /// Something scatters otherwise.
    rough: bool,
    /// Most segments of a path.
    max_depth: u32,
}

/// What of an emitter decides which strategies can start or end at it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EmitterTraits {
    /// Camera subpaths can hit it.
    hittable: bool,
    /// Next-event estimation can find it.
    connectible: bool,
    /// It is seen directly, so that there are paths of one segment.
    seen: bool,
    /// The lens can be connected to the emitter itself.
    to_lens: bool,
}

impl Traits {
    /// Those of `scene`. Unless `seen`, no emitter is in direct view.
    pub fn of(scene: &Scene, options: Paths, seen: bool) -> Self {
        let mut emitters = Vec::new();
        for light in &scene.lights.all {
            let emitter = &light.emitter;
            let hidden = options.hide_emitters && !matches!(emitter.kind, Kind::Medium(_));
            let traits = EmitterTraits {
                hittable: emitter.is_hittable(),
                connectible: emitter.is_connectible(),
                seen: seen && !hidden && emitter.is_hittable(),
                // Parallel rays see one direction of what is at infinity, which no light subpath starts in.
                to_lens: emitter.is_hittable() && !(emitter.is_infinite() && scene.sensor.is_parallel()),
            };
            if !emitters.contains(&traits) {
                emitters.push(traits);
            }
        }
        let bsdfs = || scene.surfaces.iter().map(|surface| &scene.bsdfs[surface.bsdf as usize]);
        let mut bounds = scene.media.iter().map(Medium::bound);
        let scatters = bounds.any(|m| m.sigma_t != Spectrum::ZERO && m.albedo != Spectrum::ZERO);
        Self {
            emitters,
            smooth: bsdfs().any(|bsdf| bsdf.has_dirac() && bsdf.survival(Vec2::ZERO, Vec3::Z) > 0.0),
            rough: scatters || bsdfs().any(BsdfModel::is_connectible),
            max_depth: options.max_depth.unwrap_or(u32::MAX),
        }
    }

    /// All kinds of paths that `set` cannot make, in words.
    pub fn unreachable(&self, set: Strategies) -> Vec<String> {
        let mut kinds = Vec::new();
        for (emitter, dirac) in self.paths() {
            let kind = in_words(emitter, &dirac);
            if !makers(emitter, &dirac).iter().any(|kind| set.has(*kind)) && !kinds.contains(&kind) {
                kinds.push(kind);
            }
        }
        kinds
    }

    /// A path that `all` can make and `some` cannot, in words; none where there is no such.
    pub fn missing(&self, some: Strategies, all: Strategies) -> Option<String> {
        self.paths().find_map(|(emitter, dirac)| {
            let makers = makers(emitter, &dirac);
            let made = |set: Strategies| makers.iter().any(|kind| set.has(*kind));
            (made(all) && !made(some)).then(|| in_words(emitter, &dirac))
        })
    }

    /// Every kind of path, the shortest first: its emitter, and of every vertex from there to the lens whether it
    /// scatters by a Dirac lobe.
    fn paths(&self) -> impl Iterator<Item = (EmitterTraits, Vec<bool>)> + '_ {
        let longest = VERTICES.min(self.max_depth.saturating_sub(1));
        let counts = (self.max_depth > 0).then_some(0..=longest).into_iter().flatten();
        counts.flat_map(move |count| {
            let patterns =
                (0..1u32 << count).map(move |bits| (0..count).map(|i| bits >> i & 1 == 1).collect());
            let real =
                move |pattern: &Vec<bool>| pattern.iter().all(|d| if *d { self.smooth } else { self.rough });
            // Of emitters in direct view alone there are paths without vertices between.
            let lit = move |emitter: &&EmitterTraits| count > 0 || emitter.seen;
            patterns.filter(real).flat_map(move |pattern| {
                self.emitters.iter().filter(lit).map(move |emitter| (*emitter, pattern.clone()))
            })
        })
    }
}

/// The kinds of strategies that can make a path.
fn makers(emitter: EmitterTraits, dirac: &[bool]) -> Vec<StrategyKind> {
    let rough = |vertex: Option<&bool>| vertex == Some(&false);
    let can = |kind: &StrategyKind| match kind {
        StrategyKind::EmitterHit => emitter.hittable && (emitter.seen || !dirac.is_empty()),
        StrategyKind::NextEvent => emitter.connectible && rough(dirac.first()),
        StrategyKind::Connection => dirac.windows(2).any(|pair| pair == [false, false]),
        StrategyKind::Lens if dirac.is_empty() => emitter.seen && emitter.to_lens,
        StrategyKind::Lens => rough(dirac.last()),
    };
    StrategyKind::ALL.into_iter().filter(can).collect()
}

/// A kind of path, in words.
fn in_words(emitter: EmitterTraits, dirac: &[bool]) -> String {
    let light = match (emitter.hittable, emitter.connectible) {
        (true, _) => "light of area, sky or medium",
        (false, true) => "light of a point or a single direction",
        (false, false) => "light that leaves along a normal only",
    };
    let smooth = "smooth mirrors or lenses";
    match (dirac.first(), dirac.last()) {
        (Some(true), _) if !dirac.contains(&false) => {
            format!("{light} that {smooth} alone lead to the camera")
        }
        (Some(true), Some(true)) => format!("caustics of {light} seen in or through {smooth}"),
        (Some(true), _) => format!("caustics of {light}"),
        (_, Some(true)) => format!("{light} seen in or through {smooth}"),
        (None, _) => format!("{light} seen directly"),
        _ if dirac.len() == 1 => format!("{light} scattered once"),
        _ => format!("{light} scattered more than once"),
    }
}

/// Kinds of paths of `scene` that no strategy among `strategies` can make.
pub fn unreachable(scene: &Scene, strategies: Strategies, paths: Paths) -> Vec<String> {
    match strategies {
        Strategies::NONE => Vec::new(),
        _ => Traits::of(scene, paths, true).unreachable(strategies),
    }
}

/// What must be known of an estimator's images of `scene`: what is not in them, what is biased, and where error bars
/// mean little.
pub fn notes(scene: &Scene, options: &Options) -> Vec<String> {
    let Strategies { emitter_hit, next_event, lens, .. } = options.strategies;
    let missing = unreachable(scene, options.strategies, options.into());
    let mut notes: Vec<String> = missing.into_iter().map(|kind| format!("does not sample {kind}")).collect();
    let around = &scene.media[scene.sensor_medium.0 as usize];
    if lens && !emitter_hit && !next_event && around.bound().sigma_t != Spectrum::ZERO {
        let why = "light scattered close to the camera is sampled by connections to the lens only";
        notes.push(format!("its variance is infinite: {why}; its error bars are unreliable"));
    }
    let mut trackers = scene.media.iter().filter_map(|medium| Some(medium.heterogeneous()?.tracker()));
    if trackers.any(|tracker| matches!(tracker, DistanceSampler::RayMarching(_))) {
        notes.push("is biased by the step of its ray marching".to_owned());
    }
    notes
}

/// True if the mean of an estimator's images of `scene` is the truth as far as any integrator's is.
pub fn is_trustworthy(scene: &Scene, options: &Options) -> bool {
    let missing = unreachable(scene, options.strategies, options.into()).len();
    let other_notes = notes(scene, options).len() - missing;
    other_notes == 0 && (missing == 0 || options.strategies == Strategies::BDPT)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMP: EmitterTraits =
        EmitterTraits { hittable: true, connectible: true, seen: true, to_lens: true };
    const POINT: EmitterTraits =
        EmitterTraits { hittable: false, connectible: true, seen: false, to_lens: false };
    const BEAM: EmitterTraits = EmitterTraits { connectible: false, ..POINT };

    fn traits(emitters: &[EmitterTraits], smooth: bool) -> Traits {
        Traits { emitters: emitters.to_vec(), smooth, rough: true, max_depth: u32::MAX }
    }

    fn set(names: &str) -> Strategies {
        let has = |kind: StrategyKind| names.split(',').any(|name| name == kind.name());
        StrategyKind::ALL.into_iter().filter(|kind| !has(*kind)).fold(Strategies::BDPT, Strategies::without)
    }

    /// The sets of one to four kinds that cover what all four do.
    fn covering(traits: &Traits) -> Vec<String> {
        let sets = (1..16u32).map(|bits| {
            let named = StrategyKind::ALL.into_iter().filter(|kind| bits >> *kind as u32 & 1 == 1);
            named.map(StrategyKind::name).collect::<Vec<_>>().join(",")
        });
        sets.filter(|names| traits.missing(set(names), Strategies::BDPT).is_none()).collect()
    }

    /// As `tests/agreement.rs` works them out by hand.
    #[test]
    fn covering_sets_are_as_worked_out_by_hand() {
        assert!(covering(&traits(&[LAMP], false)).iter().all(|s| s.contains("hit") || s.contains("lens")));
        assert_eq!(covering(&traits(&[LAMP], false)).len(), 12);
        assert_eq!(covering(&traits(&[EmitterTraits { seen: false, ..LAMP }], false)).len(), 14);
        assert_eq!(covering(&traits(&[POINT], false)).len(), 12);
        assert_eq!(covering(&traits(&[POINT, LAMP], false)).len(), 10);
        let smooth = covering(&traits(&[LAMP], true));
        assert!(smooth.len() == 8 && smooth.iter().all(|s| s.starts_with("hit")), "{smooth:?}");
    }

    /// For a point light over smooth surfaces, next-event estimation, connections and connections to the lens
    /// each make paths that no other can.
    #[test]
    fn what_a_point_needs_among_smooth_surfaces() {
        let point = traits(&[POINT], true);
        assert_eq!(covering(&point), ["next-event,join,lens", "hit,next-event,join,lens"]);
        let short = Traits { max_depth: 3, ..point };
        assert!(covering(&short).contains(&"next-event,lens".to_owned()), "joins need five segments");
        // Only light subpaths leave along a normal.
        assert!(covering(&traits(&[BEAM], false)).iter().all(|s| s.contains("lens")));
        let missing = traits(&[BEAM], false).missing(Strategies::PT, Strategies::BDPT).unwrap();
        assert_eq!(missing, "light that leaves along a normal only scattered once");
    }

    #[test]
    fn what_a_set_cannot_make_is_named_by_kinds() {
        let lamp = traits(&[LAMP], true);
        assert_eq!(lamp.unreachable(Strategies::BDPT), [""; 0]);
        let light = "light of area, sky or medium";
        let of_light_tracing = ["alone lead to the camera", "seen in or through smooth mirrors or lenses"];
        let found = lamp.unreachable(Strategies::LT);
        assert!(found.len() == 3 && found[2].starts_with("caustics"), "{found:?}");
        for (found, end) in found.iter().zip(of_light_tracing) {
            assert!(found.starts_with(light) && found.ends_with(end), "{found}");
        }
        let point = traits(&[POINT], true).unreachable(Strategies::BDPT);
        assert!(
            point.iter().all(|kind| kind.ends_with("camera") || kind.starts_with("caustics")),
            "{point:?}"
        );
        assert_eq!(traits(&[POINT], false).unreachable(Strategies::PT), [""; 0]);
    }

    /// What no strategy can make is missing from none.
    #[test]
    fn what_all_lack_may_be_lacking() {
        assert_eq!(traits(&[LAMP], false).missing(Strategies::PT, Strategies::PT), None);
        let nothing = Traits { max_depth: 0, ..traits(&[LAMP], true) };
        assert_eq!(nothing.missing(Strategies::NONE, Strategies::BDPT), None);
        let direct = Traits { max_depth: 1, ..traits(&[LAMP], true) };
        assert_eq!(direct.missing(set("lens"), Strategies::BDPT), None);
        assert!(direct.missing(set("next-event,join"), Strategies::BDPT).unwrap().ends_with("seen directly"));
    }
}
