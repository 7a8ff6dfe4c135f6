//! What a render will do, in one line, and what light it does not reach.

use super::{estimator::Estimator, voice};
use crate::{
    analysis::coverage::{self, Share, Unreached, list},
    math::Spectrum,
    medium::{DistanceMethod, Medium},
    render::{Settings, budget::Budget},
    scene::build::Setup,
    transport::{Options, Strategies, observer::StrategyKind},
};
use serde_json::{Value, json};

/// What a render will do.
pub struct Plan {
    /// Name of the integrator, some of whose strategies may be left out.
    pub integrator: &'static str,
    strategies: Vec<&'static str>,
    settings: Settings,
    /// Free-flight sampling methods in use.
    flights: Vec<DistanceMethod>,
    size: [u32; 2],
    /// Relative error at which the render stops.
    error: Option<f64>,
    unreached: Vec<Unreached>,
}

impl Plan {
    /// That of a render of `setup` by `settings`, which `estimator` gave.
    pub fn new(setup: &Setup, estimator: &Estimator, settings: Settings, error: Option<f64>) -> Self {
        let wanted = estimator.integrator.unwrap_or(setup.integrator.options.strategies);
        let known = Strategies::INTEGRATORS.iter().find(|(_, strategies)| *strategies == wanted);
        let strategies = settings.options.strategies;
        let in_use = StrategyKind::ALL.into_iter().filter(|kind| strategies.has(*kind));
        Self {
            integrator: known.map_or("bdpt", |(name, _)| *name),
            strategies: in_use.map(StrategyKind::name).collect(),
            flights: if strategies == Strategies::NONE { Vec::new() } else { flights(&setup.scene.media) },
            size: [setup.film.width, setup.film.height],
            unreached: coverage::unreached(&setup.scene, &settings.options),
            settings,
            error,
        }
    }

    /// In one line: integrator and strategies, sampler, free flights, size, limits, profile.
    pub fn line(&self) -> String {
        let integrator = match self.strategies.as_slice() {
            [] => format!("{}, a preview of first surfaces", self.integrator),
            strategies => format!("{} ({})", self.integrator, strategies.join(", ")),
        };
        let [width, height] = self.size;
        let mut parts = vec![integrator, format!("{} samples", self.settings.sampler.name())];
        if !self.flights.is_empty() {
            parts.push(list(&self.flights.iter().map(|method| in_words(*method)).collect::<Vec<_>>()));
        }
        parts.extend([format!("{width}x{height}"), self.limits()]);
        parts.push(format!("profile {}", self.settings.profile.name()));
        parts.join(", ")
    }

    /// Says it, to standard error. What is missing from the image is said even when little else is.
    pub fn announce(&self) {
        voice::announce(&self.line());
        self.unreached().iter().for_each(|line| voice::complain(line));
    }

    /// Where the render stops, whichever comes first.
    fn limits(&self) -> String {
        let Budget { samples_per_pixel, time, .. } = self.settings.budget;
        let samples = samples_per_pixel.map(|samples| format!("{samples} samples/pixel"));
        let time = time.map(|time| format!("{} s", time.as_secs_f64()));
        let error = self.error.map(|error| format!("error {error}"));
        [samples, time, error].into_iter().flatten().collect::<Vec<_>>().join(" or ")
    }

    /// Light that does not reach the image, a line each.
    pub fn unreached(&self) -> Vec<String> {
        let whole = Strategies::INTEGRATORS.contains(&(self.integrator, self.settings.options.strategies));
        let by = if whole { self.integrator } else { "these strategies" };
        let line = |Unreached { light, by_bdpt }: &Unreached| {
            let who = match by_bdpt {
                Share::All => "bdpt reaches it",
                Share::Some => "bdpt reaches a part of it",
                Share::None => "no integrator does",
            };
            format!("not reached by {by}: {light}; {who}")
        };
        self.unreached.iter().map(line).collect()
    }

    /// The same facts for scripts.
    pub fn json(&self) -> Value {
        let Settings { options, sampler: points, budget, seed, profile } = self.settings;
        let Options { heuristic, max_depth, hide_emitters, forced_interaction, .. } = options;
        let unreached = self.unreached.iter();
        json!({
            "integrator": self.integrator,
            "strategies": self.strategies,
            "sampler": points.name(),
            "free_flights": self.flights.iter().map(|method| method.name()).collect::<Vec<_>>(),
            "width": self.size[0],
            "height": self.size[1],
            "samples_per_pixel": budget.samples_per_pixel,
            "time_limit_seconds": budget.time.map(|time| time.as_secs_f64()),
            "error": self.error,
            "seed": seed,
            "profile": profile.name(),
            "heuristic": heuristic.to_string(),
            "max_depth": max_depth,
            "hide_emitters": hide_emitters,
            "forced_interaction": forced_interaction,
            "unreached": unreached
                .map(|kind| json!({ "light": kind.light, "reached_by_bdpt": kind.by_bdpt.name() }))
                .collect::<Vec<_>>(),
        })
    }
}

/// How free flights are sampled in media that extinguish, each method once.
fn flights(media: &[Medium]) -> Vec<DistanceMethod> {
    let mut methods = Vec::new();
    for medium in media.iter().filter(|medium| medium.bound().sigma_t != Spectrum::ZERO) {
        let method = flight(medium);
        if !methods.contains(&method) {
            methods.push(method);
        }
    }
    methods
}

/// How free flights are sampled in `medium`.
pub fn flight(medium: &Medium) -> DistanceMethod {
    medium.heterogeneous().map_or(DistanceMethod::ClosedForm, |varying| varying.tracker().choice())
}

fn in_words(method: DistanceMethod) -> &'static str {
    match method {
        DistanceMethod::ClosedForm => "closed-form flights",
        DistanceMethod::RegularTracking => "regular tracking",
        DistanceMethod::RayMarching => "ray marching",
        // The others are what `auto` chooses among.
        DistanceMethod::RatioTracking | DistanceMethod::ResidualRatioTracking | DistanceMethod::Auto => {
            "delta tracking"
        }
    }
}
