//! How paths are made: the options of the command line, put over what the scene says.

mod arguments;

use super::{console::complain, parsers::Size};
use crate::{
    error::{Error, Result},
    film::{
        layer::{Content, Layer},
        sharing::FilmSamples,
    },
    learning::{
        pilot::{self, Choice, Decided, Report},
        training,
    },
    passes::{Settings, budget::Budget},
    sampling::Sampler,
    scene::build::Setup,
    settings::Overrides,
    transport::{
        Algorithm, Connections, Effort, FirstPass, Guiding, Heuristic, LightStarts, Options, Sky, Strategies,
        equiangular_applies, needs::Needs, profiles::ProfileName, strategy::StrategyKind,
    },
};
pub(super) use arguments::{Estimator, Profile};

impl Estimator {
    /// What these options and a `size` override in a scene.
    pub fn overrides(&self, size: Option<Size>) -> Overrides {
        Overrides { size: size.map(Into::into), soften: self.soften, ..self.media.overrides() }
    }

    /// A render of `setup`, its paths made as these options say, or else as the scene says, or else as a pilot chooses.
    pub fn settings(&self, setup: &Setup, seed: u64, budget: Budget) -> Result<Settings> {
        self.chosen(setup, seed, budget).map(|(settings, _)| settings)
    }

    /// The same, and what the pilot chose, if it might choose.
    pub fn chosen(&self, setup: &Setup, seed: u64, budget: Budget) -> Result<(Settings, Option<Choice>)> {
        let (settings, report) = self.reported(setup, seed, budget)?;
        Ok((settings, report.map(|report| report.choice)))
    }

    /// The same, and all that the pilot says.
    pub fn reported(&self, setup: &Setup, seed: u64, budget: Budget) -> Result<(Settings, Option<Report>)> {
        let mut settings = self.without_pilot(setup, seed, budget)?;
        let report = self.pilot(setup, &settings);
        let choice = report.as_ref().map(|report| report.choice);
        let Options { strategies, effort, .. } = settings.options;
        let unchosen = || {
            let follows = training::follows_guide(&setup.scene, &setup.film, &settings);
            let guide = if follows { Guiding::Always } else { Guiding::Never };
            (strategies, Effort { guide, ..effort })
        };
        (settings.options.strategies, settings.options.effort) =
            choice.map_or_else(unchosen, |choice| (choice.strategies, choice.effort));
        self.warn_of_basis(&settings);
        Ok((settings, report))
    }

    /// What a pilot says, if it may choose.
    fn pilot(&self, setup: &Setup, settings: &Settings) -> Option<Report> {
        let Options { algorithm, heuristic, connections, .. } = settings.options;
        let is_judged = heuristic == Heuristic::Balance && connections == Connections::Cached;
        if !self.strategies.is_empty() || algorithm.is_preview() || !is_judged {
            return None;
        }
        Some(pilot::choose(
            &setup.scene,
            &setup.film,
            settings,
            Decided { starts: self.starts, sky: self.sky.map(|_| settings.options.effort.sky) },
        ))
    }

    /// The same without a pilot: all strategies that are not left out.
    pub fn requested(&self, setup: &Setup, seed: u64, budget: Budget) -> Result<Settings> {
        let settings = self.without_pilot(setup, seed, budget)?;
        self.warn_of_basis(&settings);
        Ok(settings)
    }

    fn without_pilot(&self, setup: &Setup, seed: u64, budget: Budget) -> Result<Settings> {
        let options = self.options(setup)?;
        let profile = match self.profile {
            Profile::Everything => ProfileName::Everything,
            Profile::Fitted => ProfileName::leanest(Needs::of(&setup.scene, options.hide_emitters)),
        };
        let (sampler, profile) = (self.sampler(setup), profile.weighing(options.heuristic));
        Ok(Settings { options, sampler, film_samples: self.film_samples(setup), budget, seed, profile })
    }

    /// The same with a guide, whatever the scene says.
    pub fn guided_settings(&self, setup: &Setup, budget: Budget) -> Result<Settings> {
        let guided = Self { guide: Some(Guiding::Always), ..self.clone() };
        guided.requested(setup, 0, budget)
    }

    fn options(&self, setup: &Setup) -> Result<Options> {
        let scene = setup.integrator.options;
        let algorithm = self.algorithm(setup);
        let strategies = self.strategies(setup)?;
        let max_depth = self.max_depth(setup)?;
        let heuristic = self.heuristic.unwrap_or(scene.heuristic);
        if algorithm == Algorithm::Fog {
            self.warn_of_preview();
        } else {
            self.check_depth(heuristic, max_depth)?;
        }
        if strategies.equiangular && !equiangular_applies(&setup.scene) {
            let needs =
                "a medium, an emitter that is neither at infinity nor a medium, and a sensor with a lens";
            complain(&format!("warning: the strategy equiangular has no effect: it needs {needs}"));
        }
        let forced_interaction = self.forced_interaction(setup, algorithm, strategies);
        let connections = self.connections(scene, strategies);
        let hide_emitters = (self.hide_emitters || scene.hide_emitters) && !self.no_hide_emitters;
        let guide = self.guiding(scene, algorithm, heuristic)?;
        let sky = self.sky(setup, strategies).unwrap_or(scene.effort.sky);
        let effort = Effort { guide, starts: self.starts(setup, strategies, sky), sky, ..scene.effort };
        let options = Options {
            algorithm,
            strategies,
            effort,
            basis: self.basis.unwrap_or(scene.basis),
            first_pass: self.first_pass(scene, algorithm),
            flat: self.flat || scene.flat,
            heuristic,
            max_depth,
            min_depth: self.min_depth.unwrap_or(scene.min_depth),
            forced_interaction,
            hide_emitters,
            connections,
        };
        self.check_min_depth(&options)?;
        Ok(options)
    }

    /// Where nothing is connected, a pilot may judge all there is.
    fn connections(&self, scene: Options, strategies: Strategies) -> Connections {
        if self.connections.is_some() && !strategies.connection {
            complain("warning: --connections has no effect: the strategy join is not in use");
        }
        let wanted = self.connections.unwrap_or(scene.connections);
        if strategies.connection { wanted } else { Connections::default() }
    }

    /// What --sky says, where that means anything.
    fn sky(&self, setup: &Setup, strategies: Strategies) -> Option<Sky> {
        let applies =
            strategies.emitter_hit && strategies.next_event && setup.scene.lights.has_lamps_besides_sky();
        if self.sky.is_some() && !applies {
            complain(
                "warning: --sky has no effect: it needs the strategies hit and next-event, and an emitter besides the sky",
            );
        }
        self.sky.filter(|_| applies)
    }

    fn starts(&self, setup: &Setup, strategies: Strategies, sky: Sky) -> LightStarts {
        let applies = match self.starts {
            Some(LightStarts::Aimed) => strategies.need_light_walks() && setup.scene.aimed_starts().is_some(),
            _ => strategies.use_starts(&setup.scene, sky),
        };
        if self.starts.is_some() && !applies {
            let why = match self.starts {
                Some(LightStarts::Aimed) if strategies.need_light_walks() => {
                    "no light sets out for glass, smooth metal or a medium in a shape less than half as wide as the scene"
                }
                _ => "no strategy in use traces light subpaths or, for learnt starts, connects to a sky",
            };
            complain(&format!("warning: --starts has no effect: {why}"));
        }
        self.starts.filter(|_| applies).unwrap_or_default()
    }

    fn first_pass(&self, scene: Options, algorithm: Algorithm) -> FirstPass {
        let needless = [
            (
                self.first_pass.is_some() && !algorithm.ends_in_first_pass(),
                "--first-pass",
                "no path ends in a first pass",
            ),
            (
                self.flat && algorithm != Algorithm::FirstPass,
                "--flat",
                "only the integrator first-pass shows elements",
            ),
        ];
        for (_, flag, why) in needless.iter().filter(|(is_needless, ..)| *is_needless) {
            complain(&format!("warning: {flag} has no effect: {why}"));
        }
        self.first_pass.unwrap_or(scene.first_pass)
    }

    fn warn_of_basis(&self, settings: &Settings) {
        if self.basis.is_some() && !settings.options.effort.is_guided() {
            complain("warning: --basis has no effect: walks follow no guide");
        }
    }

    fn guiding(&self, scene: Options, algorithm: Algorithm, heuristic: Heuristic) -> Result<Guiding> {
        let guide = match (algorithm, self.guide.unwrap_or(scene.effort.guide)) {
            (Algorithm::Fog, _) => Guiding::Never,
            (Algorithm::Gather, Guiding::Usual) => Guiding::Auto,
            (Algorithm::FirstPass, Guiding::Usual) => Guiding::Never,
            (_, said) => said,
        };
        let gathers = algorithm.ends_in_first_pass();
        let place = format!("--integrator {}", algorithm.name());
        let (place, remedy) = match gathers {
            true => (place.as_str(), "choose --heuristic balance"),
            false => ("--guide", "choose --heuristic balance, or give --guide never"),
        };
        let is_wanted = matches!(guide, Guiding::Auto | Guiding::Always);
        if heuristic != Heuristic::Balance && (gathers || is_wanted) {
            let found = format!("the heuristic {heuristic}");
            return Err(Error::new(place, "the heuristic balance", found, remedy));
        }
        Ok(guide)
    }

    fn film_samples(&self, setup: &Setup) -> FilmSamples {
        let has = |is_such: fn(&Layer) -> bool| setup.integrator.layers.iter().any(is_such);
        let usual = match () {
            _ if has(Layer::is_for_denoisers) => FilmSamples::Apart,
            _ if has(Layer::needs_squares) => FilmSamples::Own,
            _ => FilmSamples::Shared,
        };
        let asked = self.film_samples.unwrap_or(usual);
        if setup.film.can_share() { asked } else { asked.unshared() }
    }

    fn sampler(&self, setup: &Setup) -> Sampler {
        let has_variances = setup.integrator.layers.iter().any(|layer| layer.content == Content::Variance);
        let default = if has_variances { Sampler::Independent } else { Sampler::default() };
        self.sampler.or(setup.sampler).unwrap_or(default)
    }

    fn warn_of_preview(&self) {
        for (is_given, flag) in [
            (self.max_depth.is_some(), "--max-depth"),
            (self.min_depth.is_some(), "--min-depth"),
            (self.heuristic.is_some(), "--heuristic"),
            (self.guide.is_some(), "--guide"),
        ] {
            if is_given {
                let text = "has no effect: the integrator fog does not sample paths";
                complain(&format!("warning: {flag} {text}"));
            }
        }
    }

    fn forced_interaction(&self, setup: &Setup, algorithm: Algorithm, strategies: Strategies) -> bool {
        let gathers = algorithm.ends_in_first_pass();
        let by_camera = strategies.emitter_hit || strategies.next_event || strategies.connection;
        let why_not = match by_camera {
            _ if gathers => Some("previews force none"),
            false => Some("no strategy in use traces camera subpaths"),
            true => (!Needs::of(&setup.scene, false).media).then_some("the scene has no media"),
        };
        if let (true, Some(why)) = (self.forced_interaction, why_not) {
            complain(&format!("warning: --forced-interaction has no effect: {why}"));
        }
        let forced = self.forced_interaction || setup.integrator.options.forced_interaction;
        by_camera && !gathers && forced && !self.no_forced_interaction
    }

    /// That of the scene, unless another is named.
    pub fn algorithm(&self, setup: &Setup) -> Algorithm {
        self.integrator.unwrap_or(setup.integrator.options.algorithm)
    }

    /// Those of the integrator, or the ones of them that are named.
    fn strategies(&self, setup: &Setup) -> Result<Strategies> {
        let all = self.integrator.map_or(setup.integrator.options.strategies, Algorithm::strategies);
        let all = if self.without_lens { all.without(StrategyKind::Lens) } else { all };
        if self.strategies.is_empty() {
            return Ok(all);
        }
        if self.algorithm(setup).ends_in_first_pass() {
            let found = "a preview, which leaves none out";
            return Err(Error::new(
                "--strategies",
                "an integrator whose strategies may be chosen",
                found,
                "give --integrator pt or bdpt",
            ));
        }
        let all = Strategies { equiangular: all.next_event, ..all };
        if !self.strategies.iter().all(|kind| all.has(*kind)) {
            return Err(Error::new(
                "--strategies",
                "strategies that the integrator has",
                "one that it leaves out",
                "use strategies of --integrator bdpt: hit, next-event, join, lens, equiangular",
            ));
        }
        let unnamed = StrategyKind::ALL.into_iter().filter(|kind| !self.strategies.contains(kind));
        Ok(unnamed.fold(all, Strategies::without))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{cli::contenders, format, scene::build};
    use std::path::Path;

    /// True if renders of `scene` by `words`, however long, follow a guide.
    fn is_guided(scene: &str, words: &str) -> bool {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
        let estimator = contenders::parse("test", words).unwrap();
        let medium = [("medium".to_owned(), "0".to_owned())];
        let definitions = if scene.contains("cornell") { &medium[..] } else { &[] };
        let size = Size { width: 32, height: 24 };
        let setup = build::build(&format::read(&path, definitions).unwrap(), estimator.overrides(Some(size)))
            .unwrap();
        estimator.settings(&setup, 0, Budget::ENDLESS).unwrap().options.effort.is_guided()
    }

    /// Path tracing alone has a use for a guide where light comes round corners, all integrators where it comes through a portal.
    /// Through a small opening it finds so few paths that it would weigh those more which it did not foresee.
    #[test]
    fn walks_follow_a_guide_where_it_pays() {
        let [indirect, open] = ["gallery/indirect_room.json", "gallery/cornell_d.json"];
        let [keyhole, ajar, small_opening] =
            ["efficiency/keyhole.xml", "efficiency/door_ajar.xml", "efficiency/small_opening.xml"];
        for (scene, words, follows) in [
            (indirect, "--integrator pt --guide auto", true),
            (indirect, "--strategies hit,next-event --guide auto", true),
            (indirect, "--integrator bdpt --guide auto", false),
            (ajar, "--integrator bdpt --guide auto", false),
            (small_opening, "--integrator pt --guide auto", false),
            (keyhole, "--integrator bdpt --guide auto", true),
            (keyhole, "--integrator bdpt", true),
            (keyhole, "--integrator bdpt --guide never", false),
            (keyhole, "--strategies hit,next-event,join,lens", false),
            (keyhole, "--connections all", false),
            (keyhole, "--heuristic power", false),
            (keyhole, "--integrator pt --guide auto", true),
            (indirect, "--integrator pt", false),
            (open, "--integrator pt --guide auto", false),
            (open, "--integrator pt --guide always", true),
        ] {
            assert_eq!(is_guided(scene, words), follows, "{scene} {words}");
        }
    }
}
