//! How paths are made: what a scene's integrator says, unless the command line says otherwise.

use super::heuristic::Heuristic;
use crate::{
    description::{Params, parameter::Parameter, rows},
    error::{Error, Result},
    sampling::Basis,
};
use serde_json::{Map, Value};
use std::fmt::Display;

/// Which strategies run. Their weights sum to one over those that do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Strategies {
    /// s = 0: camera subpaths hit emitters.
    pub emitter_hit: bool,
    /// s = 1, t >= 2: next-event estimation.
    pub next_event: bool,
    /// s >= 2, t >= 2: connections of camera and light subpaths.
    pub connection: bool,
    /// t = 1: light subpaths connect to the lens.
    pub lens: bool,
    /// s = 1, t = 2 in media: next-event estimation where the primary ray is near an emitter.
    pub equiangular: bool,
}

impl Strategies {
    /// None at all.
    pub const NONE: Self =
        Self { emitter_hit: false, next_event: false, connection: false, lens: false, equiangular: false };
    /// Bidirectional path tracing.
    pub const BDPT: Self = Self { connection: true, lens: true, ..Self::PT };
    /// Path tracing with next-event estimation.
    pub const PT: Self = Self { emitter_hit: true, next_event: true, ..Self::NONE };
    /// Light tracing.
    pub const LT: Self = Self { lens: true, ..Self::NONE };
}

/// Light transport algorithms, which scenes and the command line call integrators.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Algorithm {
    /// Bidirectional path tracing.
    #[default]
    Bdpt,
    /// Path tracing with next-event estimation.
    Pt,
    /// Light tracing.
    Lt,
    /// A preview by path tracing: camera subpaths end where they scatter for the second time, in the first pass.
    Gather,
    /// A preview of the first pass itself: camera subpaths end where they scatter first.
    FirstPass,
    /// A preview of first surfaces, which makes no paths.
    Fog,
}

impl Algorithm {
    /// As printed and as typed.
    pub const NAMES: [(&'static str, Self); 6] = [
        ("bdpt", Self::Bdpt),
        ("pt", Self::Pt),
        ("lt", Self::Lt),
        ("gather", Self::Gather),
        ("first-pass", Self::FirstPass),
        ("fog", Self::Fog),
    ];

    /// Mitsuba's names of what they do, which may be typed too.
    pub const ALIASES: [(&'static str, Self); 4] =
        [("path", Self::Pt), ("volpath", Self::Pt), ("volpathmis", Self::Pt), ("ptracer", Self::Lt)];

    /// As printed and as typed.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

    /// All that may run.
    pub fn strategies(self) -> Strategies {
        match self {
            Self::Bdpt => Strategies::BDPT,
            Self::Pt | Self::Gather | Self::FirstPass => Strategies::PT,
            Self::Lt => Strategies::LT,
            Self::Fog => Strategies::NONE,
        }
    }

    /// True if its image is not what it should be on average.
    pub fn is_preview(self) -> bool {
        matches!(self, Self::Gather | Self::FirstPass | Self::Fog)
    }

    /// True if camera subpaths end in the first pass.
    pub fn ends_in_first_pass(self) -> bool {
        matches!(self, Self::Gather | Self::FirstPass)
    }
}

/// The probability that a walk goes on from a vertex (LW96 eq. 8 and 9), as a function of its albedo: a function of the vertex
/// alone, so that it can be part of all densities. Camera subpaths that run alone need not keep to it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Survival {
    /// The albedo.
    #[default]
    Albedo,
    /// The fourth root of the albedo, by which fewer walks end and those that go on weigh less. It pays where walks soon leave
    /// the scene anyway.
    FourthRoot,
}

impl Survival {
    /// At a vertex of `albedo`, in [0, 1].
    #[inline]
    pub fn of(self, albedo: f32) -> f32 {
        match self {
            Self::Albedo => albedo,
            Self::FourthRoot => albedo.sqrt().sqrt(),
        }
    }

    /// The power of the albedo that it is.
    pub fn exponent(self) -> f32 {
        match self {
            Self::Albedo => 1.0,
            Self::FourthRoot => 0.25,
        }
    }

    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::FourthRoot => "fourth root of albedo",
        }
    }
}

/// Which light vertices the vertices of a camera subpath connect to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Connections {
    /// Draws from the light subpaths of a block of pixels: as many at every vertex, whatever the length of light
    /// subpaths.
    #[default]
    Cached,
    /// All vertices of one light subpath, which no other camera subpath connects to (LW96 sec. 4).
    All,
}

impl Connections {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 2] = [("cached", Self::Cached), ("all", Self::All)];
}

/// How camera subpaths find the light of what surrounds the scene, where there are other emitters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sky {
    /// They hit it, and next-event estimation connects to it.
    #[default]
    NextEvent,
    /// They hit it: next-event estimation is left to other emitters. Walks in white clouds find an even sky with hardly any noise,
    /// and each of their vertices connects to the sun.
    Hit,
}

impl Sky {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 2] = [("next-event", Self::NextEvent), ("hit", Self::Hit)];
}

/// How a first pass is solved (P03T ch. 4).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FirstPass {
    /// Default: walks where paths of the image end in it, particles where it is the image.
    #[default]
    Usual,
    /// By walks from the camera, in cells where they came.
    Walks,
    /// Hierarchical Monte Carlo radiosity: by particles (P03T sec. 4.3).
    Particles,
    /// Radiance clustering: by links between elements and clusters (P03T sec. 4.2).
    Links,
}

impl FirstPass {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 3] =
        [("walks", Self::Walks), ("particles", Self::Particles), ("links", Self::Links)];

    /// The one that previews by `algorithm` use.
    pub fn by(self, algorithm: Algorithm) -> Self {
        match (self, algorithm) {
            (Self::Usual, Algorithm::Gather) => Self::Walks,
            (Self::Usual, _) => Self::Particles,
            (said, _) => said,
        }
    }

    /// As typed.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, method)| *method == self).map_or("usual", |(name, _)| name)
    }
}

/// When walks follow a guide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Guiding {
    /// Default: [`Self::Auto`] where a pilot chooses among all strategies of bdpt, else [`Self::Never`].
    #[default]
    Usual,
    /// Never.
    Never,
    /// Where a few samples predict that it lowers the error by more than it costs.
    Auto,
    /// Always.
    Always,
}

impl Guiding {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 3] =
        [("never", Self::Never), ("auto", Self::Auto), ("always", Self::Always)];
}

/// Where light subpaths start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightStarts {
    /// As emitters emit.
    #[default]
    Emitted,
    /// A part of them aims at shapes that bend light and at media.
    Aimed,
    /// Where training found that light reaches the image. Next-event estimation aims at the environment through the
    /// same openings.
    Learnt,
}

impl LightStarts {
    /// Each as typed.
    pub const NAMES: [(&'static str, Self); 3] =
        [("emitted", Self::Emitted), ("aimed", Self::Aimed), ("learnt", Self::Learnt)];

    /// As typed.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }
}

/// How many samples the strategies take, for each pixel sample, and how long walks are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effort {
    /// When walks end.
    pub survival: Survival,
    /// Light subpaths, above 0.
    pub light_walks: f32,
    /// Connections from each vertex of the camera subpath to vertices of light subpaths, above 0.
    pub connections: u32,
    /// Where light subpaths start.
    pub starts: LightStarts,
    /// How the environment is found.
    pub sky: Sky,
    /// When walks follow a guide, which is learnt.
    pub guide: Guiding,
}

impl Effort {
    /// One sample of each, nothing learnt.
    pub const EQUAL: Self = Self {
        survival: Survival::Albedo,
        light_walks: 1.0,
        connections: 1,
        starts: LightStarts::Emitted,
        sky: Sky::NextEvent,
        guide: Guiding::Never,
    };

    /// True where a guide is followed, or may be.
    pub fn is_guided(&self) -> bool {
        matches!(self.guide, Guiding::Auto | Guiding::Always)
    }
}

impl Default for Effort {
    fn default() -> Self {
        Self::EQUAL
    }
}

/// How paths are sampled and weighted. A new option is a field here, with the parameter of a scene that it is read
/// from, and a flag of the command line (`cli/estimator/arguments.rs`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// What makes the image.
    pub algorithm: Algorithm,
    /// Which strategies run.
    pub strategies: Strategies,
    /// How often.
    pub effort: Effort,
    /// How a guide keeps directions.
    pub basis: Basis,
    /// How a first pass is solved.
    pub first_pass: FirstPass,
    /// Each of its elements is shown as it is, not interpolated.
    pub flat: bool,
    /// With [`Connections::All`] there is one light subpath a pixel sample, whatever `effort` says.
    pub connections: Connections,
    /// The MIS heuristic by which strategies share paths. All but [`Heuristic::Balance`] run on the profile
    /// `everything`.
    pub heuristic: Heuristic,
    /// Most segments of a path, null boundaries not counted; none for no limit. Paths beyond
    /// [`Heuristic::most_edges`] are never made.
    pub max_depth: Option<u32>,
    /// Fewest segments of a path that counts; 0 and 1 leave none out.
    pub min_depth: u32,
    /// The camera does not see emitters, but what is behind them.
    pub hide_emitters: bool,
    /// Primary rays that cross media are followed both from a collision in them and from what lies behind.
    pub forced_interaction: bool,
}

impl Options {
    /// What a scene or the command line says and no pilot chooses, for reports and checkpoints.
    pub fn json(&self) -> Map<String, Value> {
        let Self { heuristic, max_depth, min_depth, hide_emitters, forced_interaction, .. } = *self;
        let all = [
            ("heuristic", heuristic.to_string().into()),
            ("max_depth", max_depth.into()),
            ("hide_emitters", hide_emitters.into()),
            ("forced_interaction", forced_interaction.into()),
        ];
        // Only where it is one: earlier sums, which know nothing of it, can go on.
        let least = (min_depth > 1).then(|| ("min_depth", min_depth.into()));
        all.into_iter().chain(least).map(|(name, value): (&str, Value)| (name.to_owned(), value)).collect()
    }

    /// The limit of paths, no more than `most` or than the shortest that count.
    pub fn depth_within(&self, most: u32) -> u32 {
        let most = most.max(self.min_depth);
        self.max_depth.map_or(most, |depth| depth.min(most))
    }

    /// An error at `place` unless some paths count.
    pub fn check_depths(&self, place: impl Display) -> Result<()> {
        let Self { max_depth: Some(most), min_depth, .. } = *self else { return Ok(()) };
        if min_depth <= most.max(1) {
            return Ok(());
        }
        let expected = format!("a number of segments up to the maximum of {most}");
        Err(Error::new(place, expected, min_depth.to_string(), "make min_depth smaller, or max_depth larger"))
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            algorithm: Algorithm::default(),
            strategies: Strategies::BDPT,
            effort: Effort { guide: Guiding::default(), ..Effort::default() },
            basis: Basis::default(),
            first_pass: FirstPass::default(),
            flat: false,
            connections: Connections::default(),
            heuristic: Heuristic::default(),
            max_depth: None,
            min_depth: 0,
            hide_emitters: false,
            forced_interaction: false,
        }
    }
}

/// What integrators have that make paths; `max_depth` besides.
pub(super) const PATHS: &[Parameter] = rows! {
    boolean("hide_emitters", false, "Emitters are invisible to the camera; emissive media stay visible."),
    silent("rr_depth", "Russian roulette acts at any depth, or later where paths soon leave the scene"),
};

/// What those have that sample paths.
pub(super) const GUIDE: &[Parameter] = rows! {
    choice("guide", &words::<3, _>(&Guiding::NAMES), "never",
        "Path guiding: sample directions learnt from earlier paths.")
        .said("auto for bdpt, else never").ours(),
    choice("guide_basis", &words::<4, _>(&Basis::NAMES), "quadtree",
        "Directions in the guide: an adaptive `quadtree`, equal `bins`, `haar` wavelets (P03T sec. 5.2.1, A.1), or `links` of a first pass (sec. 5.2.3).").ours(),
};

/// What those have that end in a first pass.
pub(super) const FIRST_PASS: &[Parameter] = rows! {
    choice("first_pass", &words::<3, _>(&FirstPass::NAMES), "particles",
        "How the first pass is solved: by `walks` from the camera, by `particles` or by `links` between clusters (P03T sec. 4.3, 4.2).")
        .said("walks for gather, particles for first_pass").ours(),
};

/// The limit of paths.
pub(super) const MAX_DEPTH: &[Parameter] = rows! {
    integer("max_depth", within(-1.0, MAX), Is(-1.0), "Maximum number of segments of a path; -1: no limit."),
};

/// What counts below it.
pub(super) const MIN_DEPTH: &[Parameter] = rows! {
    integer("min_depth", within(0.0, MAX), Is(0.0),
        "Minimum number of segments of a path; shorter ones do not count. 2 leaves out emitters in direct view.").ours(),
};

/// What those have besides that connect camera and light subpaths.
pub(super) const CONNECTIONS: &[Parameter] = rows! {
    choice("connections", &words::<2, _>(&Connections::NAMES), "cached",
        "Light vertices to connect to: `cached`, drawn from many light subpaths; `all` of the sample's own subpath (LW96).").ours(),
};

/// What those have besides that follow primary rays.
pub(super) const FORCED: &[Parameter] = rows! {
    boolean("forced_interaction", false,
        "Primary rays through media continue twice: from a forced collision and from the surface behind.").ours(),
};

impl Options {
    /// The usual ones of an algorithm.
    pub fn of(algorithm: Algorithm) -> Self {
        Self { algorithm, strategies: algorithm.strategies(), ..Self::default() }
    }

    /// Reads the parameters of integrators that make paths.
    pub(super) fn read(params: &Params<'_>, algorithm: Algorithm) -> Result<Self> {
        let samples = algorithm != Algorithm::Fog;
        let options = Self {
            algorithm,
            strategies: algorithm.strategies(),
            effort: Effort {
                guide: match samples {
                    true if params.has("guide") => params.choice("guide", &Guiding::NAMES)?,
                    true => Guiding::Usual,
                    false => Guiding::Never,
                },
                ..Effort::default()
            },
            basis: if samples { params.choice("guide_basis", &Basis::NAMES)? } else { Basis::default() },
            first_pass: FirstPass::default(),
            flat: false,
            connections: Connections::default(),
            // Limits that u32 does not hold are none.
            max_depth: u32::try_from(params.integer("max_depth")?).ok(),
            min_depth: u32::try_from(params.integer("min_depth")?).unwrap_or(u32::MAX),
            hide_emitters: params.boolean("hide_emitters")?,
            forced_interaction: algorithm != Algorithm::Lt && params.boolean("forced_interaction")?,
            heuristic: Heuristic::read(params)?,
        };
        options.check_depths(params.given("min_depth").map_or(params.location(), |given| &given.location))?;
        Ok(options)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_learnt_from_has_paths_that_count() {
        let of = |min_depth, max_depth| Options { min_depth, max_depth, ..Options::default() };
        let within = |min_depth, max_depth| of(min_depth, max_depth).depth_within(50);
        assert_eq!([within(0, None), within(0, Some(3)), within(0, Some(70))], [50, 3, 50]);
        assert_eq!([within(3, Some(3)), within(60, None), within(60, Some(90))], [3, 60, 60]);
        for (least, most, is_good) in [(0, 0, true), (1, 0, true), (2, 1, false), (3, 3, true), (4, 3, false)]
        {
            assert_eq!(of(least, Some(most)).check_depths("").is_ok(), is_good, "{least} {most}");
        }
        assert!(of(u32::MAX, None).check_depths("").is_ok());
        assert!(!of(1, None).json().contains_key("min_depth") && of(2, None).json()["min_depth"] == 2);
    }
}
