//! Who takes part in a study: ways of rendering of this program, and other renderers.

use super::{clock::CpuClock, external::External};
use crate::{
    error::Result,
    render::Settings,
    scene::{Kept, Scene, build::Setup},
    transport::{Options, Strategies},
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A contender as it was requested.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub struct Contender {
    /// As shown.
    pub name: String,
    /// What renders.
    #[serde(flatten)]
    pub how: How,
}

/// What renders a scene.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum How {
    /// This program, by options of `tyndall render` that say how paths are made.
    Options(String),
    /// Another renderer, by its command line (see [`super::external`]).
    Command(String),
}

impl Contender {
    /// What its files are called.
    pub fn slug(&self) -> String {
        slug(&self.name)
    }
}

/// `name` without what a file's name should not hold, nor begin with.
pub fn slug(name: &str) -> String {
    let kept = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_' | '+' | '=' | '.');
    let slug: String = name.trim().chars().map(|c| if kept(c) { c } else { '_' }).collect();
    if slug.is_empty() || slug.starts_with('.') { format!("_{slug}") } else { slug }
}

/// A contender ready to render a scene.
#[derive(Clone)]
pub struct Entry {
    /// The scene, which contenders share where they can.
    pub setup: Arc<Setup>,
    /// What renders it.
    pub renderer: Renderer,
    /// What must be said of it.
    pub notes: Vec<String>,
}

/// What precedes the first sample of every render and is done only once: the pilot.
#[derive(Clone, Debug, Default)]
pub struct Head {
    /// Its processor time (s); its time is in the settings' budget.
    pub cpu_seconds: f64,
    /// What it learnt; renders begin with that, and learn the rest themselves, each at its own expense.
    pub learnt: Kept,
    /// The same of radiance.
    pub radiance: Kept,
    /// What renders do, in a line.
    pub plan: String,
}

impl Head {
    /// Does what precedes renders of `scene`, from nothing.
    pub fn of<T>(scene: &Scene, pilot: impl FnOnce() -> Result<(T, String)>) -> Result<(T, Self)> {
        let lights = &scene.lights;
        Self::default().put_back(scene);
        let clock = CpuClock::start(0.0);
        let (found, plan) = pilot()?;
        let cpu_seconds = clock.seconds().unwrap_or(0.0);
        Ok((found, Self { cpu_seconds, learnt: lights.learnt.kept(), radiance: lights.endings.kept(), plan }))
    }

    /// Restores in `scene` what the pilot learnt, and nothing else: the next render is as the first.
    pub fn put_back(&self, scene: &Scene) {
        scene.lights.learnt.put_back(&self.learnt);
        scene.lights.endings.put_back(&self.radiance);
    }
}

/// What renders a scene, ready to do so.
#[derive(Clone)]
pub enum Renderer {
    /// This program.
    Own {
        /// How; the study sets budget and seed.
        settings: Settings,
        /// Time of reading and building the scene (s).
        load_seconds: f64,
        /// What the pilot left to renders.
        head: Head,
    },
    /// Another one.
    External(External),
}

impl Entry {
    /// Width and height of its images (pixels).
    pub fn size(&self) -> (usize, usize) {
        (self.setup.film.width as usize, self.setup.film.height as usize)
    }

    /// The scene and how this program makes its paths; none of other renderers, of which nothing is known.
    pub fn estimator(&self) -> Option<(&Scene, &Options)> {
        match &self.renderer {
            Renderer::Own { settings, .. } => Some((&self.setup.scene, &settings.options)),
            Renderer::External(_) => None,
        }
    }

    /// Strategies that make its paths, where that is known.
    pub fn strategies(&self) -> Option<Strategies> {
        self.estimator().map(|(_, options)| options.strategies)
    }
}

/// Makes an entry for a scene (by its index). An error says why it cannot render that scene.
pub type Enter<'a> = dyn FnMut(usize, &How) -> Result<Entry> + Send + 'a;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_names_of_files() {
        for (name, expected) in [
            ("bdpt hit+next-event", "bdpt_hit+next-event"),
            ("../a/b\\c", "_.._a_b_c"),
            ("..", "_.."),
            (".lock", "_.lock"),
            ("", "_"),
            ("\u{3b1}=0.5", "\u{3b1}=0.5"),
        ] {
            assert_eq!(slug(name), expected);
        }
    }
}
