//! Who takes part in a study.

use crate::{error::Result, render::Settings, scene::build::Setup};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// One way of rendering, as it was asked for.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub struct Contender {
    /// As shown.
    pub name: String,
    /// Options of `tyndall render` that say how paths are made.
    pub words: String,
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
    /// How it is rendered; the study sets budget and seed.
    pub settings: Settings,
    /// Time of reading and building the scene [s].
    pub load_seconds: f64,
    /// What must be said of it.
    pub notes: Vec<String>,
}

/// Makes an entry for a scene (by its index) of a contender's words. An error says why it cannot render that scene.
pub type Enter<'a> = dyn FnMut(usize, &str) -> Result<Entry> + Send + 'a;

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
