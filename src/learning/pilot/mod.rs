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
    settings::options::{Effort, Guiding, Sky, Survival},
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
/// Noise of rare bright paths, over what a pilot sees of it. Measured: 2 to 4 do equally well, 0 chooses 10 % worse.
const UNSEEN: f64 = 3.0;
/// Samples of each pixel that takes part: enough for a variance.
const PASSES: usize = 4;
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
/// 4.
const GUIDE_SHARES: [(f64, f64); 2] = [(2.0, 0.1), (15.0, 0.4)];

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
    let learnt_starts = decided.starts == Some(true) && all.need_light_walks();
    let sky = decided.sky.unwrap_or_default();
    let effort = Effort { learnt_starts, guide, sky, ..Effort::default() };
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
    /// Whether light subpaths begin at learnt starts.
    pub starts: Option<bool>,
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
        let pilot = self.fly(self.base.effort.learnt_starts);
        let asks = asks && self.may_guide(pilot.error_where_lit(&self.base));
        if asks && training::guide_pays(self.scene, self.film, self.settings.options) {
            let effort = Effort { guide: Guiding::Always, ..self.base.effort };
            return Self { base: Choice { effort, ..self.base }, ..*self }.choose(false);
        }
        let report = self.report(&pilot);
        let is_remote =
            self.decided.starts.is_none() && pilot.seen_subpaths().is_some_and(|seen| seen <= REMOTE);
        let may_gain = || pilot.error_where_lit(&self.base) > STARTS_NOISE;
        if is_remote && training::is_worth(self.work, STARTS_SHARE) && may_gain() {
            self.report(&self.fly(true))
        } else {
            report
        }
    }

    /// True if learning a guide is a small part of the time of an image with such an `error` of a pixel sample.
    fn may_guide(&self, error: f64) -> bool {
        let is_worth = |(noisy, share): &(f64, f64)| error > *noisy && training::is_worth(self.work, *share);
        GUIDE_SHARES.iter().any(is_worth)
    }

    /// A few samples of all strategies.
    fn fly(&self, learnt_starts: bool) -> Forecast {
        let Choice { effort, .. } = self.base;
        let effort = Effort { survival: self.survivals()[0], learnt_starts, ..effort };
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
        Forecast::fly(&*compiled, effort.survival, [passes, samples / passes], left)
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
        let mut choices = self.candidates(pilot.is_learnt);
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
        let rare = [is_spread_less, strategies.equiangular && !all.equiangular];
        let burden = WORTHWHILE.powi(rare.into_iter().filter(|is| *is).count() as i32);
        let learnt = effort.learnt_starts && !self.base.effort.learnt_starts;
        let burden = burden * if learnt { LEARNT } else { 1.0 } * self.for_denoiser(&foretold.choice);
        burden * (foretold.error.usual + UNSEEN * least) * foretold.time
    }

    /// How much more the error of `choice` counts if a denoiser is to see the image.
    fn for_denoiser(&self, choice: &Choice) -> f64 {
        let is_denoised = self.settings.film_samples == FilmSamples::Apart;
        if is_denoised && choice.strategies.need_light_walks() { DENOISED } else { 1.0 }
    }

    /// The choices that leave no light out and keep to earlier decisions; with learnt starts too if the pilot knows
    /// them. Either all strategies that need light subpaths run, or none: in 29 scenes drawn at random, only some of
    /// them were never much better, and a short pilot may not see what they miss.
    fn candidates(&self, knows_starts: bool) -> Vec<Choice> {
        let all = self.strategies();
        let camera = Strategies { connection: false, lens: false, ..all };
        let hits = camera.without(StrategyKind::NextEvent).without(StrategyKind::Equiangular);
        let mut sets = vec![all, all.without(StrategyKind::Equiangular), camera];
        sets.extend([camera.without(StrategyKind::Equiangular), hits]);
        sets.sort_unstable_by_key(|set| set.names());
        sets.dedup();
        sets.retain(|set| coverage::is_complete(self.scene, &self.settings.options, *set));
        sets.into_iter().flat_map(|set| self.efforts(set, knows_starts)).collect()
    }

    /// The same of one set of strategies.
    fn efforts(&self, strategies: Strategies, knows_starts: bool) -> Vec<Choice> {
        let walks = strategies.need_light_walks();
        let differ = |(light_walks, connections): &(f32, u32)| {
            (walks || *light_walks == 1.0) && (strategies.connection || *connections == 1)
        };
        let starts: &[bool] = match self.decided.starts {
            _ if !walks => &[false],
            Some(true) => &[true],
            None if knows_starts => &[false, true],
            _ => &[false],
        };
        let is_open = self.decided.sky.is_none() && strategies.emitter_hit && strategies.next_event;
        let skies: &[Sky] = match is_open && self.scene.lights.has_lamps_besides_sky() {
            true => &[Sky::NextEvent, Sky::Hit],
            false => &[self.base.effort.sky],
        };
        let mut choices = Vec::new();
        for (light_walks, connections) in COUNTS.into_iter().filter(differ) {
            for survival in self.survivals().iter().copied() {
                for (learnt_starts, sky) in
                    starts.iter().flat_map(|starts| skies.iter().map(move |sky| (*starts, *sky)))
                {
                    let effort =
                        Effort { survival, light_walks, connections, learnt_starts, sky, ..self.base.effort };
                    choices.push(Choice { strategies, effort, ..self.base });
                }
            }
        }
        choices
    }
}

impl Choice {
    /// Samples of every kind of strategy, over those at equal effort.
    fn counts(&self) -> [f64; StrategyKind::ALL.len()] {
        StrategyKind::each(|kind| match kind {
            _ if !self.strategies.has(kind) => 0.0,
            StrategyKind::Connection => f64::from(self.effort.connections),
            StrategyKind::Lens => f64::from(self.effort.light_walks),
            _ => 1.0,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{
        forecast::Tile,
        record::{Ends, Found, Work},
        *,
    };
    use crate::{
        format,
        math::SpectrumExt,
        passes::budget::Budget,
        render::instrument::Instrument,
        scene::build::{self, Setup},
        settings::Overrides,
        transport::profiles::ProfileName,
    };
    use std::path::Path;

    /// A small image of a scene, by `strategies`.
    fn small(scene: &str, strategies: Strategies) -> (Setup, Settings) {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        let overrides = Overrides { size: Some((24, 24)), ..Overrides::default() };
        let setup = build::build(&format::read(&path, &[]).unwrap(), overrides).unwrap();
        let options = Options { strategies, ..setup.integrator.options };
        let (sampler, budget) = (Sampler::Independent, Budget::ENDLESS);
        (
            setup,
            Settings {
                options,
                sampler,
                film_samples: FilmSamples::Own,
                budget,
                seed: 0,
                profile: ProfileName::Everything,
            },
        )
    }

    /// The pilot of an image without end, with learnt starts or without.
    fn flown(setup: &Setup, settings: &Settings, learnt_starts: bool) -> Forecast {
        let among = settings.options.strategies;
        let base = Choice { among, strategies: among, effort: Effort::default(), gain: 1.0 };
        let Setup { scene, film, .. } = setup;
        Pilots { scene, film, settings, decided: Decided::default(), base, work: f64::INFINITY }
            .fly(learnt_starts)
    }

    #[test]
    fn light_subpaths_must_be_better_for_a_denoiser() {
        let (Setup { scene, film, .. }, settings) = &small("efficiency/glass_fog_sky.xml", Strategies::BDPT);
        let judgement = |film_samples, strategies| {
            let choice = Choice { among: Strategies::BDPT, strategies, effort: Effort::default(), gain: 1.0 };
            let (settings, decided) = (&Settings { film_samples, ..*settings }, Decided::default());
            let pilots = Pilots { scene, film, settings, decided, base: choice, work: f64::INFINITY };
            let error = Error { usual: 1.0, few: 0.0 };
            pilots.judge(&Foretold { choice, error, time: 1.0, judgement: f64::INFINITY }, 0.0)
        };
        let ratio =
            |strategies| judgement(FilmSamples::Apart, strategies) / judgement(FilmSamples::Own, strategies);
        assert_eq!([Strategies::BDPT, Strategies::PT].map(ratio), [DENOISED, 1.0]);
    }

    #[test]
    fn path_tracing_has_no_light_starts_to_learn() {
        let (setup, settings) = small("efficiency/glass_fog_sky.xml", Strategies::PT);
        assert_eq!(flown(&setup, &settings, false).seen_subpaths(), None);
    }

    /// What takes longer than it can gain is left out; what it takes else is a small part of the samples to come.
    #[test]
    fn pilots_are_sized_by_the_work_to_come() {
        let (setup, settings) = small("efficiency/glass_fog_sky.xml", Strategies::BDPT);
        let samples = |each: u64| {
            let settings = Settings { budget: Budget::samples(each), ..settings };
            choose(&setup.scene, &setup.film, &settings, Decided::default()).samples
        };
        let pixels = setup.film.len() as f64;
        assert_eq!(samples(16), 0.0);
        for each in [64, 256, 1024] {
            let (found, work) = (samples(each), each as f64 * pixels);
            assert!(found > 0.0 && found <= 1.5 * (SHARE * work).max(LEAST), "{each}: {found}");
        }
        assert!(samples(1 << 20) <= MOST);
    }

    /// Relative variance of pixel samples, as their images show it, but in the few pixels with the greatest.
    fn measured(instrument: &Instrument<'_>) -> f64 {
        let mut sums = vec![(0.0, 0.0); instrument.film.len()];
        let n = 400.0;
        instrument.passes(0..n as usize, &mut |image| {
            for ((sum, square), value) in sums.iter_mut().zip(image) {
                let luminance = f64::from(value.luminance());
                *sum += luminance;
                *square += luminance * luminance;
            }
        });
        let mean = sums.iter().map(|(sum, _)| sum / n).sum::<f64>() / sums.len() as f64;
        let relative = |(sum, square): &(f64, f64)| {
            let of_pixel = sum / n;
            (square / n - of_pixel * of_pixel) / (of_pixel * of_pixel + 0.01 * mean * mean)
        };
        let mut all: Vec<f64> = sums.iter().map(relative).collect();
        all.sort_unstable_by(f64::total_cmp);
        all[..(0.98 * sums.len() as f64) as usize].iter().sum::<f64>() / sums.len() as f64
    }

    /// A corner of the image that other strategies do not see decides against them, however small.
    #[test]
    fn what_a_choice_leaves_out_is_no_outlier() {
        let found = |sample, kind, shares| Found {
            pixel: 0,
            square: 1.0,
            shares,
            ends: Ends::default(),
            unlearnt: 1.0,
            without_sky: 1.0,
            kind,
            expected: 1.0,
            sample,
        };
        let tile = Tile { pixels: 1.0, samples: 1.0, mean: 0.7 };
        let alone = |kind| StrategyKind::each(|one| if one == kind { 1.0 } else { 0.0 });
        let corner = |tile| if tile == 7 { StrategyKind::Lens } else { StrategyKind::EmitterHit };
        let found = (0..100).map(|tile| (tile, found(tile, corner(tile), alone(corner(tile))))).collect();
        let work = [Work { walks: 1.0, ..Work::default() }; WALKS_END.len()];
        let forecast = Forecast {
            tiles: vec![tile; 100],
            pixels: Vec::new(),
            found,
            camera: work,
            light: work,
            light_unlearnt: work,
            is_learnt: false,
            survival: Survival::Albedo,
        };
        let effort = Effort::default();
        let all = Choice { among: Strategies::BDPT, strategies: Strategies::BDPT, effort, gain: 1.0 };
        let [whole, part] = [Strategies::BDPT, Strategies::PT]
            .map(|strategies| forecast.judge(&[Choice { strategies, ..all }])[0].all());
        assert!(whole < 10.0);
        assert_eq!(part, f64::INFINITY);
    }

    /// From the samples of all strategies, the noise of others is known before they run, and of walks that end sooner.
    #[test]
    fn pilots_foresee_the_noise_of_other_counts() {
        for scene in ["lampbox_down.xml", "efficiency/glass_fog_sky.xml"] {
            let (setup, settings) = small(scene, Strategies::BDPT);
            let forecast = flown(&setup, &settings, true);
            let (among, effort) = (Strategies::BDPT, Effort::default());
            let all = Choice { among, strategies: among, effort, gain: 1.0 };
            let four = Effort { connections: 4, ..all.effort };
            let longer = Effort { survival: Survival::FourthRoot, ..all.effort };
            let choices = [
                all,
                Choice { strategies: Strategies::PT, ..all },
                Choice { effort: four, ..all },
                Choice { effort: longer, ..all },
                Choice { strategies: Strategies::PT, effort: longer, ..all },
                Choice { effort: Effort { connections: 4, ..longer }, ..all },
            ];
            let relative: Vec<f64> = choices
                .iter()
                .zip(forecast.judge(&choices))
                .map(|(Choice { strategies, effort, .. }, error)| {
                    let options = Options { strategies: *strategies, effort: *effort, ..settings.options };
                    let settings = Settings { options, ..settings };
                    error.usual / measured(&Instrument::new(&setup.scene, &setup.film, &settings))
                })
                .collect();
            let near = relative.iter().all(|one| (0.6..1.7).contains(&(one / relative[0])));
            assert!(near, "{scene}: {relative:?}");
        }
    }
}
