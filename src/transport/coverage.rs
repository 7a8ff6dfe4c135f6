//! Which paths of a scene a set of strategies can make. The others are missing from its images, not noisy.
//!
//! This depends on how a path scatters, not where: on the kind of emitter, and on which vertices scatter by a Dirac
//! lobe. Five vertices cover both ends and two neighbours between them.

use super::{Options, Strategies, manifold::Manifold, strategy::StrategyKind};
use crate::{
    bsdf::{Bsdf, BsdfModel},
    emitter::Kind,
    math::{Spectrum, Vec2, Vec3},
    medium::{Medium, distance::DistanceSampler},
    scene::Scene,
};

/// Most vertices between emitter and lens that are examined.
const VERTICES: u32 = 5;

/// Limits on the paths of an image.
#[derive(Clone, Copy, Debug)]
pub struct Paths {
    /// Most segments; none for no limit.
    pub max_depth: Option<u32>,
    /// Fewest segments.
    pub min_depth: u32,
    /// The camera does not see emitters.
    pub hide_emitters: bool,
}

impl From<&Options> for Paths {
    fn from(options: &Options) -> Self {
        let Options { max_depth, min_depth, hide_emitters, .. } = *options;
        Self { max_depth, min_depth, hide_emitters }
    }
}

/// The properties of a scene that decide which strategies can make its paths.
#[derive(Clone, Debug, PartialEq)]
pub struct Traits {
    /// The emitters, grouped by equal traits, with the names of their plugins.
    emitters: Vec<(EmitterTraits, Vec<&'static str>)>,
    /// What scatters by Dirac lobes, in words; none where nothing does.
    smooth: Option<&'static str>,
    /// Something scatters otherwise.
    rough: bool,
    /// [`Manifold`] connects to lamps over some smooth shapes.
    bent: bool,
    /// Most segments of a path.
    max_depth: u32,
    /// Fewest segments of a path that counts.
    min_depth: u32,
}

/// The properties of an emitter that decide which strategies can start or end at it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct EmitterTraits {
    /// Camera subpaths can hit it.
    hittable: bool,
    /// Next-event estimation can find it.
    connectible: bool,
    /// It is seen directly, so that there are paths of one segment.
    seen: bool,
    /// Light subpaths can be connected to the lens.
    lens: bool,
    /// The lens can be connected to the emitter itself.
    to_lens: bool,
}

impl Traits {
    /// Those of `scene`. Unless `seen`, no emitter is in direct view.
    pub fn of(scene: &Scene, options: Paths, seen: bool) -> Self {
        let mut emitters = Vec::new();
        let lens = scene.sensor.is_connectible();
        for light in &scene.lights.all {
            let emitter = &light.emitter;
            let hidden = options.hide_emitters && !matches!(emitter.kind, Kind::Medium(_));
            let traits = EmitterTraits {
                hittable: emitter.is_hittable(),
                connectible: emitter.is_connectible(),
                seen: seen && !hidden && emitter.is_hittable(),
                // Parallel rays see an emitter at infinity in one direction; no light subpath starts in exactly that.
                lens,
                to_lens: lens
                    && emitter.is_hittable()
                    && !(emitter.is_infinite() && scene.sensor.is_parallel()),
            };
            add(&mut emitters, traits, emitter.name);
        }
        let bsdfs = || scene.surfaces.iter().map(|surface| &scene.bsdfs[surface.bsdf as usize]);
        let mut bounds = scene.media.iter().map(Medium::bound);
        let scatters = bounds.any(|m| m.sigma_t != Spectrum::ZERO && m.albedo != Spectrum::ZERO);
        Self {
            emitters,
            smooth: in_words_smooth(
                bsdfs().filter(|bsdf| bsdf.has_dirac() && bsdf.survival(Vec2::ZERO.into(), Vec3::Z) > 0.0),
            ),
            rough: scatters || scene.moves || bsdfs().any(BsdfModel::is_connectible),
            bent: Manifold::of(scene).is_some(),
            max_depth: options.max_depth.unwrap_or(u32::MAX),
            min_depth: options.min_depth,
        }
    }

    /// All kinds of paths that `set` cannot make.
    pub fn unreached(&self, set: Strategies) -> Vec<Unreached> {
        let mut kinds: Vec<Unreached> = Vec::new();
        for path in self.paths().filter(|path| !path.is_made_by(set)) {
            let share = match path.is_made_by(Strategies::BDPT) {
                false if self.bent && path.is_bent() => Share::Some,
                all => Share::of(all),
            };
            let light = path.in_words();
            match kinds.iter_mut().find(|kind| kind.light == light) {
                Some(kind) => kind.by_bdpt = kind.by_bdpt.with(share),
                None => kinds.push(Unreached { light, by_bdpt: share }),
            }
        }
        kinds
    }

    /// A path that `all` can make and `some` cannot, in words; none if there is no such path.
    pub fn missing(&self, some: Strategies, all: Strategies) -> Option<String> {
        let mut missing = self.paths().filter(|path| path.is_made_by(all) && !path.is_made_by(some));
        missing.next().map(|path| path.in_words())
    }

    fn path<'a>(
        &'a self,
        (emitter, names): &'a (EmitterTraits, Vec<&'static str>),
        dirac: &[bool],
    ) -> Path<'a> {
        Path { emitter: *emitter, names, smooth: self.smooth.unwrap_or_default(), dirac: dirac.to_vec() }
    }

    /// Every kind of path, the shortest first.
    fn paths(&self) -> impl Iterator<Item = Path<'_>> + '_ {
        let longest = VERTICES.min(self.max_depth.saturating_sub(1));
        let shortest = longest.min(self.min_depth.saturating_sub(1));
        let counts = (self.max_depth > 0).then_some(shortest..=longest).into_iter().flatten();
        counts.flat_map(move |count| {
            let patterns =
                (0..1u32 << count).map(move |bits| (0..count).map(|i| bits >> i & 1 == 1).collect());
            let real = move |pattern: &Vec<bool>| {
                pattern.iter().all(|d| if *d { self.smooth.is_some() } else { self.rough })
            };
            // Only emitters in direct view have paths without vertices between.
            let lit = move |(emitter, _): &&(EmitterTraits, Vec<_>)| count > 0 || emitter.seen;
            patterns.filter(real).flat_map(move |pattern| {
                self.emitters.iter().filter(lit).map(move |kind| self.path(kind, &pattern))
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
        StrategyKind::Lens => emitter.lens && rough(dirac.last()),
        // Never for more than single scattering.
        StrategyKind::Equiangular => false,
    };
    StrategyKind::ALL.into_iter().filter(can).collect()
}

/// A kind of path.
struct Path<'a> {
    emitter: EmitterTraits,
    /// The plugins of such emitters.
    names: &'a [&'static str],
    /// What scatters by Dirac lobes, in words.
    smooth: &'static str,
    /// For each vertex from the emitter to the lens: whether it scatters by a Dirac lobe.
    dirac: Vec<bool>,
}

impl Path<'_> {
    fn is_made_by(&self, set: Strategies) -> bool {
        makers(self.emitter, &self.dirac).iter().any(|kind| set.has(*kind))
    }

    /// True for light of a lamp that no walk can hit, by way of smooth surfaces to a vertex that [`Manifold`] may
    /// connect from.
    fn is_bent(&self) -> bool {
        !self.emitter.hittable
            && self.emitter.connectible
            && self.dirac.first() == Some(&true)
            && self.dirac.contains(&false)
    }

    fn in_words(&self) -> String {
        let (dirac, smooth) = (&self.dirac, self.smooth);
        let light = format!("light of {} emitters", list(self.names));
        match (dirac.first(), dirac.last()) {
            (Some(true), _) if !dirac.contains(&false) => {
                format!("{light} that comes to the camera by way of {smooth} alone")
            }
            (Some(true), Some(true)) => {
                format!("{light} by way of {smooth} (caustics), seen by way of {smooth}")
            }
            (Some(true), _) => format!("{light} by way of {smooth} (caustics)"),
            (_, Some(true)) => format!("{light} seen by way of {smooth}"),
            (None, _) => format!("{light} seen directly"),
            _ if dirac.len() == 1 => format!("{light} scattered once"),
            _ => format!("{light} scattered more than once"),
        }
    }
}

/// Words with "and" before the last.
pub fn list(words: &[&str]) -> String {
    match words {
        [] => String::new(),
        [one] => (*one).to_owned(),
        [others @ .., last] => format!("{} and {last}", others.join(", ")),
    }
}

/// Adds an emitter to those of its kind.
fn add(emitters: &mut Vec<(EmitterTraits, Vec<&'static str>)>, traits: EmitterTraits, name: &'static str) {
    match emitters.iter_mut().find(|(known, _)| *known == traits) {
        None => emitters.push((traits, vec![name])),
        Some((_, names)) if names.contains(&name) => {}
        Some((_, names)) => names.push(name),
    }
}

/// The kinds of these smooth surfaces, in words; none where there are none.
fn in_words_smooth<'a>(bsdfs: impl Iterator<Item = &'a Bsdf>) -> Option<&'static str> {
    let (glass, mirrors): (Vec<_>, Vec<_>) = bsdfs.partition(|bsdf| bsdf.transmits());
    match (glass.is_empty(), mirrors.is_empty()) {
        (true, true) => None,
        (false, true) => Some("smooth glass"),
        (true, false) => Some("smooth mirrors"),
        (false, false) => Some("smooth glass or mirrors"),
    }
}

/// Light that strategies do not reach.
#[derive(Clone, Debug, PartialEq)]
pub struct Unreached {
    /// Which, in words.
    pub light: String,
    /// How much of it bidirectional path tracing reaches.
    pub by_bdpt: Share,
}

/// How much of some light is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// All of it.
    All,
    /// Not all paths.
    Some,
    /// None of it.
    None,
}

impl Share {
    fn of(is_reached: bool) -> Self {
        if is_reached { Self::All } else { Self::None }
    }

    /// The share of this and other paths together.
    fn with(self, other: Self) -> Self {
        if self == other { self } else { Self::Some }
    }

    /// The name in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Self::All => "all",
            Self::Some => "some",
            Self::None => "none",
        }
    }
}

/// True if `set` reaches all light of `scene` that the strategies of `options` do.
pub fn is_complete(scene: &Scene, options: &Options, set: Strategies) -> bool {
    Traits::of(scene, options.into(), true).missing(set, options.strategies).is_none()
}

/// Light of `scene` that an estimator does not reach; nothing for a preview without strategies, which is no estimate.
pub fn unreached(scene: &Scene, options: &Options) -> Vec<Unreached> {
    match options.strategies {
        Strategies::NONE => Vec::new(),
        strategies => Traits::of(scene, options.into(), true).unreached(strategies),
    }
}

/// Caveats about an estimator's images of `scene`: missing light, bias, and unreliable error bars.
pub fn notes(scene: &Scene, options: &Options) -> Vec<String> {
    let Strategies { emitter_hit, next_event, lens, .. } = options.strategies;
    let missing = unreached(scene, options).into_iter();
    let mut notes: Vec<String> = missing.map(|kind| format!("does not sample {}", kind.light)).collect();
    let around = scene.media_map.sensor_media.iter().chain([&scene.media_map.sensor]);
    let mut around = around.map(|medium| scene.media[medium.0 as usize].bound().sigma_t);
    if lens && !emitter_hit && !next_event && around.any(|sigma_t| sigma_t != Spectrum::ZERO) {
        let why = "light scattered close to the camera is sampled by connections to the lens only";
        notes.push(format!("its variance is infinite: {why}; its error bars are unreliable"));
    }
    let mut trackers = scene.media.iter().filter_map(|medium| Some(medium.heterogeneous()?.tracker()));
    if trackers.any(|tracker| matches!(tracker, DistanceSampler::RayMarching(_))) {
        notes.push("is biased by the step of its ray marching".to_owned());
    }
    if let Some(alpha) = scene.softened {
        notes.push(format!("is biased: smooth glass and metal are rough (alpha {alpha})"));
    }
    notes
}

/// True if the mean of an estimator's images of `scene` is as close to the truth as any integrator's.
pub fn is_trustworthy(scene: &Scene, options: &Options) -> bool {
    let missing = unreached(scene, options).len();
    let other_notes = notes(scene, options).len() - missing;
    other_notes == 0
        && (missing == 0 || options.strategies.without(StrategyKind::Equiangular) == Strategies::BDPT)
}

#[cfg(test)]
mod tests {
    use super::*;

    const LAMP: EmitterTraits =
        EmitterTraits { hittable: true, connectible: true, seen: true, lens: true, to_lens: true };
    const POINT: EmitterTraits =
        EmitterTraits { hittable: false, connectible: true, seen: false, lens: true, to_lens: false };
    const BEAM: EmitterTraits = EmitterTraits { connectible: false, ..POINT };

    fn traits(emitters: &[EmitterTraits], smooth: bool) -> Traits {
        let named = |traits: &EmitterTraits| match (traits.hittable, traits.connectible) {
            (true, _) => (*traits, vec!["area", "constant"]),
            (_, true) => (*traits, vec!["point", "spot"]),
            _ => (*traits, vec!["directionalarea"]),
        };
        let smooth = smooth.then_some("smooth glass");
        Traits {
            emitters: emitters.iter().map(named).collect(),
            smooth,
            rough: true,
            bent: false,
            max_depth: u32::MAX,
            min_depth: 0,
        }
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

    /// As `tests/transport/agreement.rs` works them out by hand.
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
        assert_eq!(missing, "light of directionalarea emitters scattered once");
    }

    fn unreached(traits: &Traits, set: Strategies) -> Vec<(String, Share)> {
        traits.unreached(set).into_iter().map(|kind| (kind.light, kind.by_bdpt)).collect()
    }

    #[test]
    fn what_a_set_does_not_reach_is_named_by_kinds() {
        let (all, some, none) = (Share::All, Share::Some, Share::None);
        let lamp = traits(&[LAMP], true);
        assert_eq!(unreached(&lamp, Strategies::BDPT), []);
        let light = "light of area and constant emitters";
        let expected = [
            (format!("{light} that comes to the camera by way of smooth glass alone"), all),
            (format!("{light} seen by way of smooth glass"), all),
            (format!("{light} by way of smooth glass (caustics), seen by way of smooth glass"), all),
        ];
        assert_eq!(unreached(&lamp, Strategies::LT), expected);
        let light = "light of point and spot emitters";
        let alone = (format!("{light} that comes to the camera by way of smooth glass alone"), none);
        let caustics = format!("{light} by way of smooth glass (caustics)");
        let seen = (format!("{caustics}, seen by way of smooth glass"), some);
        let point = traits(&[POINT], true);
        assert_eq!(unreached(&point, Strategies::PT), [alone.clone(), (caustics, all), seen.clone()]);
        let caustics_seen = seen.0.clone();
        assert_eq!(unreached(&point, Strategies::BDPT), [alone.clone(), (seen.0, none)]);
        assert_eq!(unreached(&traits(&[POINT], false), Strategies::PT), []);
        let followed = Traits { bent: true, ..point };
        assert_eq!(unreached(&followed, Strategies::BDPT), [(alone.0, none), (caustics_seen, some)]);
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
        let long = |min_depth| Traits { min_depth, ..traits(&[LAMP], false) };
        assert_eq!(long(2).missing(set("next-event"), Strategies::BDPT), None);
        assert_eq!(long(100).missing(set("next-event"), Strategies::BDPT), None);
        assert!(long(3).missing(Strategies::NONE, set("join")).is_some());
        assert_eq!(Traits { max_depth: 2, ..long(0) }.missing(Strategies::NONE, set("join")), None);
    }
}
