//! Pilots: a few samples by all strategies, which forecast the efficiency of other choices.
//!
//! No race between the best choices follows. Over 29 scenes drawn at random, 10,000 samples of each decided no better
//! than the forecast from 3,000 samples of all strategies, which sees the rare bright paths of each strategy through
//! the others.

mod forecast;
mod moments;
mod record;

pub use forecast::Error;

use super::training;
use crate::{
    film::{Film, sharing::FilmSamples},
    passes::{Settings, compiled},
    sampling::Sampler,
    scene::Scene,
    settings::options::{Effort, Guiding, LightStarts, Sky, Survival},
    transport::{Options, Strategies, coverage, equiangular_applies, strategy::StrategyKind},
};
use forecast::{Forecast, PIXELS_PER_BLOCK};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Seed of its random numbers; the same for all images of a scene, so that all of them are made alike.
const SEED: u64 = 0x7079_6c6f_7473;
/// A pilot takes this part of an image's samples...
const SHARE: f64 = 1.0 / 128.0;
/// ... but at least so many: choices from fewer do no better than all strategies equally...
const LEAST: f64 = 768.0;
/// ... and at most so many: more tell hardly more.
const MOST: f64 = 16384.0;
/// It is left out where it would take a greater part of an image's samples.
const LARGEST_SHARE: f64 = 1.0 / 32.0;
/// Noise of rare bright paths, over what a pilot sees of it. Measured in 40 scenes, half of them drawn at random: with
/// 1 or more, a scene with a caustic takes 3 times as long.
const UNSEEN: f64 = 0.5;
/// Samples of each pixel that takes part: enough for a variance.
const PASSES: usize = 4;
/// Connections of a vertex: two, so that pairs of them are seen. More connections do not average out what they have in
/// common.
const CONNECTIONS: u32 = 2;
/// Longest path. Where walks hardly ever end, later vertices would take most of the time and bring little of the light.
const DEEPEST: u32 = 256;
/// Uncommon choices must be better by this factor: pilots are noisy, and some do not see that light subpaths are spread
/// less evenly.
pub const WORTHWHILE: f64 = 1.1;
/// Learnt starts must be better by this factor. Light subpaths that reach the image, and connections to them, take
/// longer than counts say; and a pilot with learnt starts finds other choices somewhat too noisy. Measured in 35 scenes
/// drawn at random: the true gain was 0.7 of the forecast where that was above 1.1, training apart.
pub const LEARNT: f64 = 1.6;
/// Light subpaths must be better by this factor in images for a denoiser, which removes less of their noise.
/// Measured in five scenes: error x time by `pt` over that by all strategies was 0.7 (`cumulus`), 1.0 (`studio_smoke`), 1.7
/// (`pine_wood`), 8 (`fog_room`) and 9 (`candles`); once denoised 0.6, 0.7, 0.7, 1.8 and 1.6.
pub const DENOISED: f64 = 2.5;
/// Starts are learnt if the lens sees at most this part of the light subpaths. Measured in the same scenes: starts paid
/// where it saw 0 to 0.09 of them.
const REMOTE: f64 = 0.1;
/// The part of an image's time that the first rounds of training may take, for starts.
const STARTS_SHARE: f64 = 0.2;
/// Starts are learnt where the squared relative error of a pixel sample is greater than this: elsewhere there is little
/// to gain. Measured in 80 scenes drawn at random: 2 to 5 in four where starts paid, and 0.6 in one more, which this
/// makes 1.6 times worse. In `glass_fog_sky`, `nested_media` and `plume` it is less than 1: learning took a fifth of an
/// image of half a second for nothing, or led to a choice that cost more time than it gained.
const STARTS_NOISE: f64 = 1.0;
/// Squared relative errors of a pixel sample where light is seen, and the part of an image's time that the first rounds
/// of a guide may take above each. Below the first error, trying takes longer than a guide could gain. Above the
/// second, guides that paid gained 1.8 to 45 times. Measured: a guide pays for all strategies in a room lit through its
/// keyhole (error 61), under a skylight (40) and in two rooms drawn at random that are lit by a sky through a hole (15
/// to 30). It does not pay in others lit through openings and round corners (4 to 160). Elsewhere the error is 0.1 to
/// 4. Where a guide is learnt in vain, it takes half as much again as these rounds.
const GUIDE_SHARES: [(f64, f64); 2] = [(2.0, 0.05), (15.0, 0.4)];

/// A guide must be better by this factor, as pilots judge all strategies alike. Samples that follow one take up to twice
/// as long: connections look it up at both ends. Measured: where pilots saw factors of 2 to 20, guides gained 2 to 30
/// times (a room lit through a tube, `skylight`, a hole in chromatic smoke); where they saw 0.7 to 1.6, guides lost.
pub const GUIDED: f64 = 1.8;

/// When walks end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// At a vertex.
    AtOnce(Survival),
    /// Of camera subpaths that run alone, see [`crate::transport::roulette`].
    Late,
}

/// The roulettes that may be requested.
const SURVIVALS: [Survival; 2] = [Survival::FourthRoot, Survival::Albedo];
/// The roulettes that may result.
const WALKS_END: [End; 3] = [End::AtOnce(Survival::FourthRoot), End::AtOnce(Survival::Albedo), End::Late];
/// The choices of light subpaths per sample and connections per vertex.
const COUNTS: [(f32, u32); 5] = [(1.0, 1), (0.5, 1), (2.0, 1), (1.0, 2), (1.0, 4)];

/// What was chosen, and how much it is worth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// Strategies to choose among, without equiangular sampling, which may be added.
    pub among: Strategies,
    /// Strategies that run.
    pub strategies: Strategies,
    /// How often.
    pub effort: Effort,
    /// Error x time by all strategies at equal effort, over that of this choice, as the pilot judges both.
    pub gain: f64,
}

/// A choice as a pilot sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Foretold {
    /// Which.
    pub choice: Choice,
    /// Squared relative error of a pixel sample.
    pub error: Error,
    /// Time of a pixel sample, over that of a segment of a walk.
    pub time: f64,
    /// What it is judged by: the least is best.
    pub judgement: f64,
}

/// What a pilot says.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// What was chosen.
    pub choice: Choice,
    /// All that it could choose, the best first; empty without a pilot.
    pub candidates: Vec<Foretold>,
    /// Samples that it took.
    pub samples: f64,
}

/// The strategies of `settings` that are worth their time on `film`, how often each runs, when walks end, and whether
/// they follow a guide; for the number of samples that the budget allows.
pub fn choose(scene: &Scene, film: &Film, settings: &Settings, decided: Decided) -> Report {
    let all = settings.options.strategies;
    let asks = match settings.options.effort.guide {
        Guiding::Usual => all == Strategies::BDPT,
        said => said == Guiding::Auto,
    };
    let guide = if asks { Guiding::Never } else { settings.options.effort.guide };
    let sky = decided.sky.unwrap_or_default();
    let starts = decided.starts.filter(|_| all.use_starts(scene, sky)).unwrap_or_default();
    let effort = Effort { starts, guide, sky, ..Effort::default() };
    let base = Choice { among: all, strategies: all, effort, gain: 1.0 };
    let work = settings.budget.samples_of(film.len());
    let none = Report { choice: base, candidates: Vec::new(), samples: 0.0 };
    if scene.lights.is_empty() || LARGEST_SHARE * work < LEAST {
        return none;
    }
    let pilots = Pilots { scene, film, settings, decided, base, work };
    let fly = || pilots.choose(asks);
    // Renders survive a panic and say where it was.
    catch_unwind(AssertUnwindSafe(fly)).unwrap_or(none)
}

/// Decisions made before the pilot.
#[derive(Clone, Copy, Debug, Default)]
pub struct Decided {
    /// Where light subpaths start.
    pub starts: Option<LightStarts>,
    /// How the environment is found.
    pub sky: Option<Sky>,
}

/// The pilots for one choice, and what they may choose.
#[derive(Clone, Copy)]
struct Pilots<'a> {
    scene: &'a Scene,
    film: &'a Film,
    settings: &'a Settings,
    decided: Decided,
    /// All strategies, with the guide and the starts given before any pilot.
    base: Choice,
    /// Samples to come.
    work: f64,
}

impl Pilots<'_> {
    /// The best choice; with a guide if one `asks` for it and it pays.
    fn choose(&self, asks: bool) -> Report {
        let first = self.fly(self.starts_without_training());
        let error = self.alike(&first, |choice| first.error_where_lit(choice));
        let pilot = if self.may_learn_starts(&first, error) { self.fly(LightStarts::Learnt) } else { first };
        let guided = || if asks && self.may_guide(error) { self.guided(&pilot) } else { None };
        guided().unwrap_or_else(|| self.report(&pilot))
    }

    /// The best choice with a guide, if it pays. Beside light subpaths, a pilot that follows it must do better than the
    /// `usual` one. A guide of camera subpaths alone makes paths brighter that it did not foresee, and pilots see too
    /// few of these: training judges it.
    fn guided(&self, usual: &Forecast) -> Option<Report> {
        let effort = Effort { guide: Guiding::Always, ..self.base.effort };
        let guided = Self { base: Choice { effort, ..self.base }, ..*self };
        if !self.base.strategies.need_light_walks() {
            let pays = training::guide_pays(self.scene, self.film, self.settings.options);
            return pays.then(|| guided.choose(false));
        }
        let follower = guided.fly(self.decided.starts.unwrap_or(LightStarts::Learnt));
        let pays = GUIDED * guided.cost(&follower) < self.cost(usual);
        pays.then(|| guided.report(&follower))
    }

    /// The starts of the first pilot: those of the base, or those that need no training and find more.
    fn starts_without_training(&self) -> LightStarts {
        match self.decided.starts {
            None if self.base.strategies.need_light_walks() => LightStarts::Aimed,
            _ => self.base.effort.starts,
        }
    }

    /// Error x time of all strategies alike as `pilot` saw them.
    fn cost(&self, pilot: &Forecast) -> f64 {
        self.alike(pilot, |choice| pilot.error_where_lit(choice) * pilot.time(choice))
    }

    /// The `cost` of all strategies alike, with the starts of `pilot` where these are better. No other choice is made that
    /// chance could favour: where light is rare, a few paths are all that is known.
    fn alike(&self, pilot: &Forecast, cost: impl Fn(&Choice) -> f64) -> f64 {
        let effort = Effort { starts: pilot.starts, ..self.base.effort };
        cost(&self.base).min(cost(&Choice { effort, ..self.base }))
    }

    /// True if starts may pay for what learning them costs in an image with such an `error` of a pixel sample.
    fn may_learn_starts(&self, pilot: &Forecast, error: f64) -> bool {
        let is_remote = || pilot.seen_subpaths().is_some_and(|seen| seen <= REMOTE);
        let is_open = self.decided.starts.is_none() && error > STARTS_NOISE;
        is_open && is_remote() && training::is_worth(self.work, STARTS_SHARE)
    }

    /// True if learning a guide is a small part of the time of an image with such an `error` of a pixel sample.
    fn may_guide(&self, error: f64) -> bool {
        let is_worth = |(noisy, share): &(f64, f64)| error > *noisy && training::is_worth(self.work, *share);
        GUIDE_SHARES.iter().any(is_worth)
    }

    /// A few samples of all strategies.
    fn fly(&self, starts: LightStarts) -> Forecast {
        let Choice { effort, .. } = self.base;
        let effort = Effort { survival: self.survivals()[0], starts, connections: CONNECTIONS, ..effort };
        let options = Options {
            strategies: self.strategies(),
            effort,
            max_depth: Some(self.settings.options.depth_within(DEEPEST)),
            ..self.settings.options
        };
        let settings = Settings {
            options,
            seed: SEED,
            sampler: Sampler::Independent,
            film_samples: self.settings.film_samples.unshared(),
            ..*self.settings
        };
        let samples = (SHARE * self.work).clamp(LEAST, MOST) as usize;
        let passes = PASSES.max(samples / self.film.len());
        let learnt = training::learn_for(self.scene, self.film, &settings);
        let compiled = compiled::by_kind(self.scene, self.film, &settings, learnt, PIXELS_PER_BLOCK);
        let left = match self.settings.film_samples {
            FilmSamples::Shared => self.film.variance_left(),
            FilmSamples::Own | FilmSamples::Apart => 1.0,
        };
        Forecast::fly(&*compiled, effort, [passes, samples / passes], left)
    }

    /// The roulettes to choose from. The pilot uses the first and forecasts those that end walks sooner. Endless fog
    /// needs the one by the albedo.
    fn survivals(&self) -> &'static [Survival] {
        if self.scene.is_endless() { &[Survival::Albedo] } else { &SURVIVALS }
    }

    /// All that may run: equiangular sampling, too, where it applies.
    fn strategies(&self) -> Strategies {
        let all = self.base.among;
        let equiangular = all == Strategies::BDPT && equiangular_applies(self.scene);
        Strategies { equiangular, ..all }
    }

    /// What `pilot` makes of all that may be chosen.
    fn report(&self, pilot: &Forecast) -> Report {
        let mut choices = self.candidates(pilot.starts);
        choices.retain(|choice| !self.is_second(pilot, choice));
        let errors = pilot.judge(&choices);
        let foretell = |(choice, error): (Choice, Error)| Foretold {
            choice,
            error,
            time: pilot.time(&choice),
            judgement: f64::INFINITY,
        };
        let mut candidates: Vec<Foretold> = choices.into_iter().zip(errors).map(foretell).collect();
        let least = candidates.iter().map(|one| one.error.few).fold(f64::INFINITY, f64::min);
        candidates.iter_mut().for_each(|one| one.judgement = self.judge(one, least));
        let base = candidates.iter().find(|one| one.choice == self.base).copied();
        if candidates.iter().all(|one| !one.judgement.is_finite()) {
            return Report { choice: self.base, candidates, samples: pilot.samples() };
        }
        candidates.sort_by(|a, b| a.judgement.total_cmp(&b.judgement));
        let best = candidates[0];
        // With the same allowance for rare bright paths in both: what few samples saw of these would decide the ratio.
        let cost =
            |one: &Foretold| self.for_denoiser(&one.choice) * (one.error.usual + UNSEEN * least) * one.time;
        let gain = base.map_or(1.0, |base| cost(&base) / cost(&best));
        Report { choice: Choice { gain, ..best.choice }, candidates, samples: pilot.samples() }
    }

    /// True if `choice` is redundant: its walks end as with the common survival.
    fn is_second(&self, pilot: &Forecast, choice: &Choice) -> bool {
        let survival = self.base.effort.survival;
        let common = Choice { effort: Effort { survival, ..choice.effort }, ..*choice };
        *choice != common && pilot.end(choice) == pilot.end(&common)
    }

    /// Error x time. The error in the few worst tiles is chance, and any choice has more of it than a short pilot sees:
    /// [`UNSEEN`] times the `least` of all choices replaces it. Uncommon choices must be worth more.
    fn judge(&self, foretold: &Foretold, least: f64) -> f64 {
        let Choice { strategies, effort, .. } = foretold.choice;
        let all = self.base.strategies;
        let is_spread_less = strategies.need_light_walks() && effort.survival != self.base.effort.survival;
        let starts = Some(effort.starts).filter(|starts| *starts != self.base.effort.starts);
        let is_aimed = starts == Some(LightStarts::Aimed);
        let rare = [is_spread_less, strategies.equiangular && !all.equiangular, is_aimed];
        let burden = WORTHWHILE.powi(rare.into_iter().filter(|is| *is).count() as i32);
        let is_learnt = starts == Some(LightStarts::Learnt);
        let burden = burden * if is_learnt { LEARNT } else { 1.0 } * self.for_denoiser(&foretold.choice);
        burden * (foretold.error.usual + UNSEEN * least) * foretold.time
    }

    /// How much more the error of `choice` counts if a denoiser is to see the image.
    fn for_denoiser(&self, choice: &Choice) -> f64 {
        let is_denoised = self.settings.film_samples == FilmSamples::Apart;
        if is_denoised && choice.strategies.need_light_walks() { DENOISED } else { 1.0 }
    }

    /// The choices that leave no light out and keep to earlier decisions; with the starts that the pilot `knows`, too.
    /// Either all strategies that need light subpaths run, or none: in 29 scenes drawn at random, only some of them were
    /// never much better, and a short pilot may not see what they miss.
    fn candidates(&self, knows: LightStarts) -> Vec<Choice> {
        let all = self.strategies();
        let camera = Strategies { connection: false, lens: false, ..all };
        let hits = camera.without(StrategyKind::NextEvent).without(StrategyKind::Equiangular);
        let mut sets = vec![all, all.without(StrategyKind::Equiangular), camera];
        sets.extend([camera.without(StrategyKind::Equiangular), hits]);
        sets.sort_unstable_by_key(|set| set.names());
        sets.dedup();
        sets.retain(|set| coverage::is_complete(self.scene, &self.settings.options, *set));
        sets.into_iter().flat_map(|set| self.efforts(set, knows)).collect()
    }

    /// The same of one set of strategies.
    fn efforts(&self, strategies: Strategies, knows: LightStarts) -> Vec<Choice> {
        let walks = strategies.need_light_walks();
        let differ = |(light_walks, connections): &(f32, u32)| {
            (walks || *light_walks == 1.0) && (strategies.connection || *connections == 1)
        };
        let starts = |sky: Sky| match (self.decided.starts, knows) {
            _ if !strategies.use_starts(self.scene, sky) => vec![LightStarts::Emitted],
            (Some(LightStarts::Aimed), _) | (None, LightStarts::Aimed) if !walks => {
                vec![LightStarts::Emitted]
            }
            (Some(starts), _) => vec![starts],
            (None, LightStarts::Emitted) => vec![LightStarts::Emitted],
            (None, other) => vec![LightStarts::Emitted, other],
        };
        let is_open = self.decided.sky.is_none() && strategies.emitter_hit && strategies.next_event;
        let skies: &[Sky] = match is_open && self.scene.lights.has_lamps_besides_sky() {
            true => &[Sky::NextEvent, Sky::Hit],
            false => &[self.base.effort.sky],
        };
        let mut choices = Vec::new();
        for (light_walks, connections) in COUNTS.into_iter().filter(differ) {
            for survival in self.survivals().iter().copied() {
                for (sky, starts) in
                    skies.iter().flat_map(|sky| starts(*sky).into_iter().map(move |starts| (*sky, starts)))
                {
                    let effort =
                        Effort { survival, light_walks, connections, starts, sky, ..self.base.effort };
                    choices.push(Choice { strategies, effort, ..self.base });
                }
            }
        }
        choices
    }
}

impl Choice {
    /// Samples of every kind of strategy, over those of a pilot.
    fn counts(&self) -> [f64; StrategyKind::ALL.len()] {
        StrategyKind::each(|kind| match kind {
            _ if !self.strategies.has(kind) => 0.0,
            StrategyKind::Connection => f64::from(self.effort.connections) / f64::from(CONNECTIONS),
            StrategyKind::Lens => f64::from(self.effort.light_walks),
            _ => 1.0,
        })
    }
}

#[cfg(test)]
mod tests;
