//! Times of what samples consist of, by divan: `cargo bench`, or `cargo bench -- rays` for a part.

mod rays;
mod samples;
mod smoke;

use std::path::Path;
use tyndall::{
    film::sharing::FilmSamples,
    format,
    passes::{Settings, budget::Budget},
    sampling::Sampler,
    scene::build::{self, Setup},
    settings::Overrides,
    transport::{needs::Needs, profiles::ProfileName},
};

fn main() {
    divan::main();
}

/// The scene in a file, as it is rendered at 64 x 48.
fn read(path: &Path, overrides: Overrides) -> Setup {
    let overrides = Overrides { size: Some((64, 48)), ..overrides };
    let built = format::read(path, &[]).and_then(|scene| build::build(&scene, overrides));
    built.unwrap_or_else(|error| panic!("{error}"))
}

/// The scene's own.
fn settings(Setup { scene, integrator, .. }: &Setup) -> Settings {
    let options = integrator.options;
    let profile = ProfileName::leanest(Needs::of(scene, options.hide_emitters));
    Settings {
        options,
        sampler: Sampler::Independent,
        film_samples: FilmSamples::default(),
        budget: Budget::ENDLESS,
        seed: 0,
        profile,
    }
}
