//! What a render will do, in one line, and what light it does not reach.

use super::{console, progress::percent};
use crate::{
    learning::pilot::Choice,
    math::Spectrum,
    medium::{DistanceMethod, Medium},
    passes::{Settings, budget::Budget},
    render::progressive::Progressive,
    scene::build::Setup,
    transport::coverage::{self, Share, Unreached, list},
    transport::{Algorithm, Connections, Effort, LightStarts, Options, Sky, Survival},
};
use serde_json::{Value, json};
use std::path::Path;

/// What a render will do.
pub(super) struct Plan {
    /// Name of the integrator, some of whose strategies may be left out.
    pub integrator: &'static str,
    strategies: Vec<&'static str>,
    settings: Settings,
    /// What a pilot chose.
    chosen: Option<Choice>,
    /// Free-flight sampling methods in use.
    flights: Vec<DistanceMethod>,
    size: [u32; 2],
    /// Relative error at which the render stops.
    error: Option<f64>,
    /// Not all pixels are shaded.
    progressive: Option<Progressive>,
    /// Smooth glass and metal are as rough as this.
    softened: Option<f64>,
    unreached: Vec<Unreached>,
}

/// What of it connections by way of smooth surfaces find.
const FOLLOWED: &str = "but for what a rectangle, disk, cube, sphere or cylinder sends on by itself, at up to 3 points (--soften 0.01 reaches it by dielectric and conductor, with a bias)";

impl Plan {
    /// That of a render of `setup` by `settings`, as a pilot has `chosen` if there was one.
    pub(super) fn new(setup: &Setup, settings: Settings, chosen: Option<Choice>, error: Option<f64>) -> Self {
        let Options { algorithm, strategies, .. } = settings.options;
        Self {
            integrator: algorithm.name(),
            strategies: strategies.names(),
            flights: if algorithm == Algorithm::Fog { Vec::new() } else { flights(&setup.scene.media) },
            size: [setup.film.width, setup.film.height],
            unreached: coverage::unreached(&setup.scene, &settings.options),
            softened: setup.scene.softened,
            chosen,
            settings,
            error,
            progressive: None,
        }
    }

    /// The same of a progressive picture.
    pub(super) fn of_pixels(self, progressive: Option<Progressive>) -> Self {
        Self { progressive, ..self }
    }

    /// In one line: integrator and strategies, sampler, free flights, size, limits, profile.
    pub(super) fn line(&self) -> String {
        let [width, height] = self.size;
        let mut parts = self.manner();
        parts.extend([format!("{width}x{height}"), self.limits()]);
        parts.extend(self.bias());
        parts.push(self.profile());
        parts.join(", ")
    }

    /// The same without size and limits: what is equal at all budgets.
    pub(super) fn words(&self) -> String {
        [self.manner(), vec![self.profile()]].concat().join(", ")
    }

    fn profile(&self) -> String {
        format!("profile {}", self.settings.profile.name())
    }

    /// How paths are made.
    fn manner(&self) -> Vec<String> {
        let integrator = match self.strategies.as_slice() {
            [] => format!("{}, a preview of first surfaces", self.integrator),
            strategies => format!("{} ({}{})", self.integrator, strategies.join(", "), self.effort()),
        };
        let mut parts = vec![integrator, format!("{} samples", self.settings.sampler.name())];
        if !self.flights.is_empty() {
            parts.push(list(&self.flights.iter().map(|method| in_words(*method)).collect::<Vec<_>>()));
        }
        parts.extend(self.softened.map(|alpha| format!("glass and metal softened (biased, alpha {alpha})")));
        parts
    }

    /// What a progressive picture is.
    fn bias(&self) -> Option<String> {
        self.progressive.map(|Progressive { method, fraction }| {
            format!("a biased preview by {} of the pixels ({})", percent(fraction), method.name())
        })
    }

    /// How often strategies run that do not all run equally often.
    fn effort(&self) -> String {
        let Options { strategies, effort, .. } = self.settings.options;
        let mut text = String::new();
        if self.settings.options.connections == Connections::All {
            text += "; each vertex connects to a whole light subpath";
        }
        efforts(effort).iter().for_each(|part| text += &format!("; {part}"));
        let Some(Choice { among, gain, .. }) = self.chosen else { return text };
        let mut left_out = among.names();
        left_out.retain(|name| !strategies.names().contains(name));
        if !left_out.is_empty() {
            text += &format!("; without {}", list(&left_out));
        }
        if text.is_empty() {
            text
        } else {
            format!("{text}: {gain:.1} times as efficient as all strategies equally")
        }
    }

    /// Says to standard error what of the scene at `path` is rendered, with `details` if they are wanted. What is missing from
    /// the image is said even when little else is.
    pub(super) fn announce(&self, path: &Path, details: bool) {
        let [width, height] = self.size;
        let (path, limits) = (path.display(), self.limits());
        let bias = self.bias().map_or(String::new(), |bias| format!(", {bias}"));
        console::announce(&format!("{path}: {width} x {height}, {limits}, {}{bias}", self.integrator));
        if details {
            console::announce(&self.line());
        }
        self.unreached().iter().for_each(|line| console::complain(line));
    }

    /// Where the render stops, whichever comes first.
    fn limits(&self) -> String {
        let Budget { samples_per_pixel, time, .. } = self.settings.budget;
        let samples = samples_per_pixel
            .map(|samples| format!("{samples} sample{} per pixel", if samples == 1 { "" } else { "s" }));
        let time = time.map(|time| format!("{} s", time.as_secs_f64()));
        let error = self.error.map(|error| format!("error {error}"));
        [samples, time, error].into_iter().flatten().collect::<Vec<_>>().join(" or ")
    }

    /// Light that does not reach the image, a line each.
    pub(super) fn unreached(&self) -> Vec<String> {
        let Options { algorithm, strategies, .. } = self.settings.options;
        let whole = algorithm.strategies() == strategies;
        let by = if whole { self.integrator } else { "these strategies" };
        let line = |Unreached { light, by_bdpt }: &Unreached| {
            let who = match by_bdpt {
                Share::All => "bdpt reaches it",
                Share::Some if algorithm == Algorithm::Bdpt && whole => FOLLOWED,
                Share::Some => "bdpt reaches a part of it",
                Share::None => {
                    "no integrator does (--soften 0.01 does by dielectric and conductor, with a bias)"
                }
            };
            format!("not reached by {by}: {light}; {who}")
        };
        self.unreached.iter().map(line).collect()
    }

    /// The same facts for scripts.
    pub(super) fn json(&self) -> Value {
        let Settings { options, sampler: points, film_samples, budget, seed, profile } = self.settings;
        let Options { effort, connections, .. } = options;
        let unreached = self.unreached.iter();
        let mut all = json!({
            "words": self.words(),
            "integrator": self.integrator,
            "strategies": self.strategies,
            "survival": effort.survival.name(),
            "light_walks": effort.light_walks,
            "connections": match connections {
                Connections::Cached => Value::from(effort.connections),
                Connections::All => "all".into(),
            },
            "starts": effort.starts.name(),
            "sky": if effort.sky == Sky::Hit { "hit" } else { "next-event" },
            "guided": effort.is_guided(),
            "time_of_all_strategies": self.chosen.map(|choice| choice.gain),
            "sampler": points.name(),
            "film_samples": film_samples.name(),
            "free_flights": self.flights.iter().map(|method| method.name()).collect::<Vec<_>>(),
            "width": self.size[0],
            "height": self.size[1],
            "samples_per_pixel": budget.samples_per_pixel,
            "time_limit_seconds": budget.time.map(|time| time.as_secs_f64()),
            "error": self.error,
            "progressive": self.progressive.map(|wanted| wanted.method.name()),
            "fraction": self.progressive.map(|wanted| wanted.fraction),
            "seed": seed,
            "profile": profile.name(),
            "unreached": unreached
                .map(|kind| json!({ "light": kind.light, "reached_by_bdpt": kind.by_bdpt.name() }))
                .collect::<Vec<_>>(),
        });
        options.json().into_iter().for_each(|(name, value)| all[name] = value);
        all
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
pub(super) fn flight(medium: &Medium) -> DistanceMethod {
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

/// What is out of the common in `effort`.
pub(super) fn efforts(effort: Effort) -> Vec<String> {
    let Effort { survival, light_walks, connections, starts, sky, .. } = effort;
    let parts = [
        (connections != 1, format!("{connections} connections a vertex")),
        (light_walks != 1.0, format!("{light_walks} light subpaths a sample")),
        (sky == Sky::Hit, "the sky by hits".to_owned()),
        (starts != LightStarts::Emitted, format!("{} starts", starts.name())),
        (effort.is_guided(), "guided walks".to_owned()),
        (survival == Survival::FourthRoot, "longer walks".to_owned()),
    ];
    parts.into_iter().filter_map(|(is, part)| is.then_some(part)).collect()
}
