//! Shared by the integration tests: scenes as JSON, renders of them, and claims that are judged together.
#![allow(dead_code, reason = "every test program uses its own part of this")]
#![allow(clippy::unwrap_used, reason = "a test that cannot go on stops loudly")]

pub(crate) mod claims;
pub(crate) mod pieces;
pub(crate) mod studies;

use serde_json::Value;
use tempfile::TempDir;
use tyndall::{
    film::sharing::FilmSamples,
    format,
    math::Spectrum,
    passes::{Settings, budget::Budget, faults::Faults},
    render::{self, Image},
    sampling::Sampler,
    scene::build::{self, Setup},
    settings::Overrides,
    transport::{Options, Strategies, needs::Needs, profiles::ProfileName},
};

/// A scene that is loaded and ready to be rendered again and again.
pub(crate) struct Stage {
    /// What the library made of it.
    pub setup: Setup,
    /// The code that renders it.
    pub profile: ProfileName,
    /// Which samples pixels take.
    pub film_samples: FilmSamples,
}

impl Stage {
    /// Loads a scene given as JSON.
    pub(crate) fn new(scene: &Value) -> Self {
        Self::with_files(scene, &[])
    }

    /// The same, with layers of its groups of emitters.
    pub(crate) fn with_groups(scene: &Value) -> Self {
        Self::overridden(scene, &[], Overrides { groups: true, ..Overrides::default() })
    }

    /// The same, with layers of the components of radiance.
    pub(crate) fn with_components(scene: &Value) -> Self {
        Self::overridden(scene, &[], Overrides { components: true, ..Overrides::default() })
    }

    /// The same, with those of each group of emitters.
    pub(crate) fn with_groups_and_components(scene: &Value) -> Self {
        let overrides = Overrides { groups: true, components: true, ..Overrides::default() };
        Self::overridden(scene, &[], overrides)
    }

    /// Loads a scene given as JSON, with the files it names beside it.
    pub(crate) fn with_files(scene: &Value, files: &[(&str, &str)]) -> Self {
        Self::overridden(scene, files, Overrides::default())
    }

    fn overridden(scene: &Value, files: &[(&str, &str)], overrides: Overrides) -> Self {
        let folder = TempDir::new().unwrap();
        for (name, text) in files {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let path = folder.path().join("scene.json");
        std::fs::write(&path, scene.to_string()).unwrap();
        let root = format::read(&path, &[]).unwrap_or_else(|error| panic!("{error}"));
        let setup = build::build(&root, overrides).unwrap_or_else(|error| panic!("{error}"));
        let profile = ProfileName::leanest(Needs::of(&setup.scene, setup.integrator.options.hide_emitters));
        Self { setup, profile, film_samples: FilmSamples::default() }
    }

    /// The same with the code that has everything.
    pub(crate) fn with_everything(self) -> Self {
        Self { profile: ProfileName::Everything, ..self }
    }

    /// Renders an image; depth and visibility of emitters are the scene's.
    pub(crate) fn render(&self, strategies: Strategies, samples_per_pixel: u64, seed: u64) -> Vec<Spectrum> {
        self.render_layers(strategies, samples_per_pixel, seed).pixels
    }

    /// The same with all layers that the scene's integrator asks for.
    pub(crate) fn render_layers(&self, strategies: Strategies, samples_per_pixel: u64, seed: u64) -> Image {
        let Setup { film, integrator, .. } = &self.setup;
        let settings = self.settings(strategies, samples_per_pixel, seed);
        let image =
            render::render_layers(&self.setup, film, &settings, &integrator.layers, &mut |_| {}).unwrap();
        assert_eq!(image.faults, Faults::default());
        image
    }

    /// How it is rendered.
    pub(crate) fn settings(&self, strategies: Strategies, samples_per_pixel: u64, seed: u64) -> Settings {
        let options = Options { strategies, ..self.setup.integrator.options };
        // Tests of means want batches whose errors are what their own variance says.
        let sampler = self.setup.sampler.unwrap_or(Sampler::Independent);
        let budget = Budget::samples(samples_per_pixel);
        Settings { options, sampler, film_samples: self.film_samples, budget, seed, profile: self.profile }
    }

    /// Renders one image per seed.
    pub(crate) fn renders(
        &self,
        strategies: Strategies,
        samples_per_pixel: u64,
        seeds: std::ops::Range<u64>,
    ) -> Vec<Vec<Spectrum>> {
        seeds.map(|seed| self.render(strategies, samples_per_pixel, seed)).collect()
    }

    /// Pixels in a row.
    pub(crate) fn width(&self) -> usize {
        self.setup.film.width as usize
    }
}

/// Renders one image of a scene given as JSON.
pub(crate) fn render(
    scene: &Value,
    strategies: Strategies,
    samples_per_pixel: u64,
    seed: u64,
) -> Vec<Spectrum> {
    Stage::new(scene).render(strategies, samples_per_pixel, seed)
}

/// The strategies named in `names`, such as "hit+lens".
pub(crate) fn strategies(names: &str) -> Strategies {
    let has = |name| names.split('+').any(|n| n == name);
    let chosen = Strategies {
        emitter_hit: has("hit"),
        next_event: has("next-event"),
        connection: has("join"),
        lens: has("lens"),
        equiangular: has("equiangular"),
    };
    assert_eq!(name_of(chosen).split('+').count(), names.split('+').count(), "misspelt: {names}");
    chosen
}

/// The reverse of [`strategies`].
pub(crate) fn name_of(strategies: Strategies) -> String {
    let Strategies { emitter_hit, next_event, connection, lens, equiangular } = strategies;
    let all = [
        (emitter_hit, "hit"),
        (next_event, "next-event"),
        (connection, "join"),
        (lens, "lens"),
        (equiangular, "equiangular"),
    ];
    let names: Vec<&str> = all.iter().filter(|(on, _)| *on).map(|(_, name)| *name).collect();
    names.join("+")
}
