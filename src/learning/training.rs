//! Training of the starts of light subpaths and of the guide, in rounds of a few samples by all strategies. Each round
//! starts its light subpaths, and guides its walks, where the rounds before found that light reaches the image.
//!
//! A path that any strategy found teaches starts with the weight of its contribution over the pixel's mean, times the
//! share of strategies that begin at an emitter. In equilibrium, the density of starts together with all other
//! strategies is in proportion to their light in the image. Next-event estimation finds openings long before light
//! subpaths do. Directions of walks are weighted likewise, by the share of the strategies that have to sample them.
//!
//! No sample of the image teaches, so all samples are independent. Samples of higher numbers follow more rounds: an
//! image of few samples learns little, one of many much, and each part of an image learns what the whole learns for the
//! same samples.

use super::{radiance, trial::Trial};
use crate::{
    bsdf::Transport,
    film::{Film, sharing::FilmSamples},
    first_pass,
    guide::{
        Guide, Learnt, Lesson,
        solution::{Ending, Found, View},
    },
    passes::{
        Settings,
        blocks::{PIXELS_PER_BLOCK, blocks_for},
        budget::Budget,
        compiled,
    },
    sampling::{Basis, Sampler},
    scene::{Scene, lights::Starts},
    settings::options::{Effort, FirstPass, Guiding, LightStarts},
    transport::{Algorithm, Connections, Heuristic, Options, Strategies, profiles::ProfileName},
};
use std::sync::Arc;

/// Seed of its random numbers; the same for all images of a scene, so that all of them are made alike.
const SEED: u64 = 0x7374_6172_7473;
/// Camera subpaths of the first round; each further round has twice as many as the one before.
const FIRST: usize = 2048;
/// Rounds before an image is begun.
pub const ROUNDS: usize = 4;
/// Most rounds before an image for a guide: rounds go on while the guide has untested parts or improves fast.
const FOLLOWED: usize = 6;
/// A guide improves fast if two rounds leave at most this part of the second moment.
const BRINGS: f64 = 0.9;
/// Most rounds in all. A guide learns from the last two.
const MOST_ROUNDS: usize = 8;
/// Most rounds while an image is made.
pub const LATER_ROUNDS: usize = MOST_ROUNDS - ROUNDS;
/// Samples of an image, for each camera subpath of the first rounds made meanwhile, before such rounds are worth their
/// time. A path that teaches takes 3 times as long as one of an image by camera and light subpaths, and some 10 times
/// as long as one by camera subpaths alone.
const PER_SUBPATH: f64 = 8.0;
const PER_CAMERA_SUBPATH: f64 = 24.0;
/// Time of a path that teaches, over that of one of an image.
const TEACHING: f64 = 3.0;
/// Segments after which no further round begins, without a guide and for one.
const SEGMENTS: f64 = 1e6;
const GUIDE_SEGMENTS: f64 = 4e6;
/// A guide that does not seem to pay is given up after this many rounds; where nothing is learnt, after one more.
const JUDGING_ROUNDS: usize = 3;
/// Most that a paying guide leaves of the second moment with camera subpaths alone: look-ups take a sixth of the time,
/// and learning takes some.
const PAYS: f64 = 0.75;
/// The same with light subpaths too: connections look up at both ends, and samples took 1.7 times as long.
const PAYS_CONNECTED: f64 = 0.5;
/// Longest path: later vertices tell little of where light starts.
const DEEPEST: u32 = 32;

/// What renders by `settings` learn before their first sample, if they ask for it: starts of light subpaths, a guide,
/// and the radiance that camera subpaths end in. Kept with the scene.
pub fn learn_for(scene: &Scene, film: &Film, settings: &Settings) -> Learnt {
    learn_rounds(scene, film, settings, ROUNDS)
}

/// The rounds whose guide the samples of `pass` (one per pixel) follow. Learning grows with the root of the number of
/// samples before it, for each round brings less than the one before. The result is the same whatever sample a render
/// begins with.
pub fn rounds_for(film: &Film, settings: &Settings, pass: usize) -> usize {
    let light = settings.options.strategies.need_light_walks();
    let least = FIRST as f64 * if light { PER_SUBPATH } else { PER_CAMERA_SUBPATH };
    let subpaths = film.len() as f64 * pass as f64;
    let is_due = |rounds: &usize| subpaths >= least * (1_usize << (2 * rounds - ROUNDS - 1)) as f64;
    (ROUNDS + 1..=MOST_ROUNDS).take_while(is_due).last().unwrap_or(ROUNDS)
}

/// The rounds whose guide a render to a relative `error` follows after its first look. As within an image, each
/// fourfold number of samples adds one round, counted from an error of 1.
pub fn rounds_to(error: f64) -> usize {
    let halvings = (-error.log2()).ceil() as usize;
    (ROUNDS + halvings).min(MOST_ROUNDS)
}

/// Learns a guide for `settings` by so many `rounds`; false if it `is_over` before.
pub fn learn_until(
    scene: &Scene,
    film: &Film,
    settings: &Settings,
    rounds: usize,
    is_over: &(dyn Fn() -> bool + Sync),
) -> bool {
    Training::recall(scene, film, Wanted::by(settings.options, true)).go_on(rounds, is_over).is_some()
}

/// What renders by `settings` learn by so many `rounds`.
pub fn learn_rounds(scene: &Scene, film: &Film, settings: &Settings, rounds: usize) -> Learnt {
    let Options { algorithm, effort, max_depth, first_pass, flat, .. } = settings.options;
    let wanted = Wanted::by(settings.options, follows_guide(scene, film, settings));
    let after = |rounds| {
        let learnt = match wanted {
            Wanted { starts: None, guide: None, .. } => Learnt::default(),
            _ => Training::recall(scene, film, wanted).go_on(rounds, &|| false).unwrap_or_default(),
        };
        let starts = match effort.starts {
            LightStarts::Emitted => None,
            LightStarts::Aimed => scene.aimed_starts(),
            LightStarts::Learnt => learnt.starts,
        };
        Learnt { starts, ..learnt }
    };
    let first = after(ROUNDS);
    let learnt = if rounds > ROUNDS { after(rounds) } else { first.clone() };
    if !algorithm.ends_in_first_pass() {
        return learnt;
    }
    let view = View { at_once: algorithm == Algorithm::FirstPass, flat };
    // What is scattered where paths end was scattered so many times at most.
    let most = max_depth.map_or(u32::MAX, |most| most.saturating_sub(if view.at_once { 1 } else { 2 }));
    if most == 0 {
        return learnt;
    }
    let method = first_pass.by(algorithm);
    let solve = || {
        let settings = of_learning(wanted.options);
        Arc::new(match method {
            FirstPass::Walks => Found::Walked(radiance::learn(scene, film, &settings, &first, most - 1)),
            _ => Found::Solved(first_pass::solve(scene, method, most)),
        })
    };
    let found = scene.lights.endings.recall(format!("{} {method:?} {most}", wanted.key(film)), solve);
    Learnt { ending: Some(Arc::new(Ending { found, view })), ..learnt }
}

/// True if walks by `settings` follow a guide.
pub fn follows_guide(scene: &Scene, film: &Film, settings: &Settings) -> bool {
    match settings.options.effort.guide {
        Guiding::Usual | Guiding::Never => false,
        Guiding::Always => true,
        Guiding::Auto => guide_pays(scene, film, settings.options),
    }
}

/// True if the first rounds take at most this `share` of the time of an image of so many `samples`.
pub fn is_worth(samples: f64, share: f64) -> bool {
    share * samples >= TEACHING * (FIRST << ROUNDS) as f64
}

/// True if a guide would pay for walks by `options`, as its first rounds forecast.
pub fn guide_pays(scene: &Scene, film: &Film, options: Options) -> bool {
    Training::recall(scene, film, Wanted::by(options, true)).pays()
}

/// What is to be learnt.
#[derive(Clone, Copy, Debug)]
struct Wanted {
    /// Starts of light subpaths: whether they compete with other strategies.
    starts: Option<bool>,
    /// A guide, for these strategies.
    guide: Option<Strategies>,
    /// What it is learnt by.
    options: Options,
}

impl Wanted {
    /// For renders by `options`, with a guide if `guided`.
    fn by(options: Options, guided: bool) -> Self {
        let Options { strategies, effort, .. } = options;
        Self {
            // Camera subpaths that never hit an emitter share nothing with light subpaths. A guide of both kinds of
            // walks is always learnt with starts, so that a pilot that tries starts shares it with its choice. A guide
            // of camera subpaths alone is better learnt without.
            starts: (effort.starts == LightStarts::Learnt || guided && strategies.need_light_walks())
                .then_some(strategies.emitter_hit),
            // What a pilot leaves out later changes nothing.
            guide: guided.then_some(if strategies.need_light_walks() {
                Strategies::BDPT
            } else {
                strategies
            }),
            options: options_of_learning(options),
        }
    }

    /// Equal where the same is learnt.
    fn key(&self, film: &Film) -> String {
        format!("{:?} {self:?}", (film.window, film.border, film.filter))
    }
}

/// What renders by `options` learn by: all strategies alike.
pub fn options_of_learning(options: Options) -> Options {
    Options {
        algorithm: Algorithm::Bdpt,
        strategies: Strategies::BDPT,
        effort: Effort::default(),
        connections: Connections::default(),
        heuristic: Heuristic::Balance,
        max_depth: Some(options.depth_within(DEEPEST)),
        forced_interaction: false,
        ..options
    }
}

/// Samples of `options` that teach.
pub fn of_learning(options: Options) -> Settings {
    Settings {
        options,
        seed: SEED,
        sampler: Sampler::Independent,
        film_samples: FilmSamples::Own,
        budget: Budget::ENDLESS,
        profile: ProfileName::Everything,
    }
}

/// What a scene teaches, round by round.
struct Training<'a> {
    scene: &'a Scene,
    film: &'a Film,
    wanted: Wanted,
    known: Known,
}

/// What is known by now.
#[derive(Clone, Default)]
struct Known {
    /// After each round, for those walks that a render runs.
    learnt: Vec<Learnt>,
    /// After the last, for all walks.
    latest: Learnt,
    /// Of the last round.
    lessons: Arc<Vec<Lesson>>,
    /// Blocks of passes that were traced, and their segments.
    tasks: usize,
    segments: f64,
}

impl<'a> Training<'a> {
    /// The training that is kept with the scene, or none yet.
    fn recall(scene: &'a Scene, film: &'a Film, wanted: Wanted) -> Self {
        let known = scene.lights.learnt.known(&wanted.key(film)).unwrap_or_default();
        Self { scene, film, wanted, known }
    }

    /// What is learnt by so many `rounds`, and by more until the guide is settled; none if it `is_over` before.
    fn go_on(&mut self, rounds: usize, is_over: &(dyn Fn() -> bool + Sync)) -> Option<Learnt> {
        let had = self.known.learnt.len();
        while self.after(rounds).is_none() && self.round(is_over) {}
        if self.known.learnt.len() > had {
            self.keep();
        }
        self.after(rounds).cloned()
    }

    fn keep(&self) {
        self.scene.lights.learnt.keep(self.wanted.key(self.film), self.known.clone());
    }

    fn after(&self, rounds: usize) -> Option<&Learnt> {
        let done = self.known.learnt.len();
        let last = (rounds..=done).find(|rounds| self.is_settled(*rounds));
        self.known.learnt.get(last.or(self.has_ended().then_some(done))? - 1)
    }

    /// True once no further round should begin.
    fn has_ended(&self) -> bool {
        let most = if self.wanted.guide.is_some() { GUIDE_SEGMENTS } else { SEGMENTS };
        self.known.segments > most
    }

    /// True if what so many rounds learnt need not be tested by another.
    fn is_settled(&self, rounds: usize) -> bool {
        rounds >= FOLLOWED || !self.is_new(rounds) && !self.brings_much(rounds)
    }

    /// True if guides get better so fast that an image had better wait for the next.
    fn brings_much(&self, rounds: usize) -> bool {
        let left = |rounds| self.guide(rounds).map_or(1.0, |guide| guide.second_moment);
        self.wanted.guide.is_some() && left(rounds) < BRINGS * left(rounds.saturating_sub(2))
    }

    /// The guide after so many rounds.
    fn guide(&self, rounds: usize) -> Option<&Guide> {
        self.known.learnt.get(rounds.checked_sub(1)?)?.guide.as_deref()
    }

    /// True if the latest guide is untested: there is none yet, or it is the first, or the first with portals.
    fn is_new(&self, rounds: usize) -> bool {
        let has_portals = |guide: &Guide| !guide.portals().is_empty();
        let is_first = |guide| {
            self.guide(rounds - 1).is_none_or(|followed| has_portals(guide) && !has_portals(followed))
        };
        self.wanted.guide.is_some() && self.guide(rounds).is_none_or(is_first)
    }

    /// True if a guide pays; what is learnt is kept then.
    fn pays(&mut self) -> bool {
        for rounds in 1.. {
            while self.known.learnt.len() < rounds {
                self.round(&|| false);
            }
            let is_last = rounds >= ROUNDS && self.is_settled(rounds)
                || self.has_ended() && rounds == self.known.learnt.len();
            if !self.may_pay(rounds, is_last) {
                return false;
            }
            if is_last {
                break;
            }
        }
        self.keep();
        true
    }

    /// False if the guide after so many rounds leaves too much of the second moment to pay: untested or early guides
    /// are given the benefit of the doubt, but not the last one. The gain of portals shows one round after they are
    /// found.
    fn may_pay(&self, rounds: usize, is_last: bool) -> bool {
        let Some(guide) = self.guide(rounds) else { return rounds <= JUDGING_ROUNDS };
        let connects = self.wanted.guide.is_some_and(|strategies| strategies.need_light_walks());
        let bound = if connects { PAYS_CONNECTED } else { PAYS };
        guide.second_moment < bound || !is_last && (self.is_new(rounds) || rounds < JUDGING_ROUNDS)
    }

    /// One more round; false if it `is_over` before it ends.
    fn round(&mut self, is_over: &(dyn Fn() -> bool + Sync)) -> bool {
        let Self { scene, film, wanted, known } = self;
        let subpaths = FIRST << known.learnt.len();
        let tasks = known.tasks..known.tasks + blocks_for(film.len(), subpaths);
        let end = tasks.end;
        let settings = of_learning(wanted.options);
        let mut followed = known.latest.clone();
        if wanted.starts.is_some() && known.learnt.is_empty() {
            // Where light hardly meets what focuses it, there would be nothing to learn from.
            followed.starts = scene.aimed_starts();
        }
        let compiled = compiled::by_kind(scene, film, &settings, followed, PIXELS_PER_BLOCK);
        let trial = Trial::run(&*compiled, tasks, wanted.guide.is_some(), is_over);
        let Some(trial) = trial else { return false };
        (known.tasks, known.segments) = (end, known.segments + trial.segments);
        if let Some(compete) = wanted.starts {
            known.latest.starts =
                Starts::learn(&scene.lights, trial.weights(compete), trial.arriving()).map(Arc::new);
        }
        let mut learnt = known.latest.clone();
        if let Some(strategies) = wanted.guide {
            let lessons = trial.lessons(strategies, subpaths as f64);
            let left = |guide: &Arc<Guide>| trial.second_moment(strategies, guide);
            let second_moment = known.latest.guide.as_ref().map_or(1.0, left);
            let links = || Arc::new(first_pass::links(scene));
            let basis = wanted.options.basis;
            let links = (basis == Basis::Links).then(|| scene.lights.endings.recall("links".into(), links));
            let guide = Guide::learn([&known.lessons[..], &lessons].concat(), basis, links.as_deref());
            let guide = guide.map(|guide| Arc::new(guide.judged(second_moment)));
            known.lessons = Arc::new(lessons);
            known.latest.guide.clone_from(&guide);
            // Light subpaths found paths for camera subpaths, which go on alone.
            learnt.guide = match strategies.need_light_walks() {
                true => guide,
                false => guide.map(|guide| Arc::new(Guide::clone(&guide).only(Transport::Radiance))),
            };
        }
        known.learnt.push(learnt);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smaller_errors_are_worth_more_learning() {
        let of = [1.0, 0.7, 0.5, 0.25, 0.02, f64::MIN_POSITIVE].map(rounds_to);
        assert_eq!(of, [ROUNDS, ROUNDS + 1, ROUNDS + 1, ROUNDS + 2, MOST_ROUNDS, MOST_ROUNDS]);
    }
}
