//! The question that a study answers: written down first, so that what goes on later is the same study.

use super::contender::{Contender, How};
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

/// All that decides about the numbers of a study.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Question {
    /// The program and its version.
    pub program: String,
    /// Every scene.
    pub scenes: Vec<SceneQuestion>,
    /// `name=value` pairs for all scenes.
    pub definitions: Vec<(String, String)>,
    /// Width and height in place of the scenes' own (pixels).
    pub size: Option<[u32; 2]>,
    /// Everybody, in the order of their turns.
    pub contenders: Vec<Contender>,
    /// Renders of each contender, two at least.
    pub seeds: u64,
    /// The first of them.
    pub first_seed: u64,
    /// Most budgets, each twice the one before.
    pub doublings: u32,
    /// The largest budget.
    pub effort: Effort,
    /// Threads that render.
    pub threads: usize,
    /// What errors are measured against.
    pub reference: Wanted,
}

/// A scene of a study.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct SceneQuestion {
    /// As in file names.
    pub name: String,
    /// Of all that the scene is read from: its file, those it includes, meshes, images, grids, spectra.
    pub fingerprint: String,
}

/// How long to render.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Effort {
    /// Samples per pixel.
    Samples(u64),
    /// Time (s).
    Seconds(f64),
}

impl Effort {
    /// So many times as much.
    pub fn times(self, factor: u64) -> Self {
        match self {
            Self::Samples(samples) => Self::Samples(samples.saturating_mul(factor)),
            Self::Seconds(seconds) => Self::Seconds(seconds * factor as f64),
        }
    }

    /// So many times less.
    pub fn over(self, divisor: u64) -> Self {
        match self {
            Self::Samples(samples) => Self::Samples(samples.div_ceil(divisor)),
            Self::Seconds(seconds) => Self::Seconds(seconds / divisor as f64),
        }
    }
}

/// A reference as it is requested.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wanted {
    /// Read from files, one a scene.
    Files(Vec<ReferenceFile>),
    /// Made here.
    Made {
        /// By the first of these that is not among the contenders and covers the scene.
        others: Vec<How>,
        /// True if all of them make it together, whatever they are.
        is_given: bool,
        /// For how long, all batches together; none for several times a contender's whole effort.
        effort: Option<Effort>,
    },
}

/// A reference in a file.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct ReferenceFile {
    /// Where it lies.
    pub file: String,
    /// Of its content.
    pub fingerprint: String,
    /// Its relMSE, where somebody knows it.
    pub own_relmse: Option<f64>,
}

/// The first thing that two questions do not share: where, the old and the new.
pub fn first_difference(old: &Question, new: &Question) -> Option<(String, String, String)> {
    let value = |question: &Question| serde_json::to_value(question).unwrap_or_default();
    differ("", &value(old), &value(new))
}

/// The first difference between two JSON values: where, the old and the new.
pub fn differ(place: &str, old: &Value, new: &Value) -> Option<(String, String, String)> {
    let inside = |name: &str| if place.is_empty() { name.to_owned() } else { format!("{place}.{name}") };
    match (old, new) {
        _ if old == new => None,
        // What is not there is null; unless all is other.
        (Value::Object(a), Value::Object(b)) if a.keys().any(|name| b.contains_key(name)) => {
            let value = |of: &Map<String, Value>, name| of.get(name).cloned().unwrap_or_default();
            a.keys().chain(b.keys()).find_map(|name| differ(&inside(name), &value(a, name), &value(b, name)))
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            (0..a.len()).find_map(|i| differ(&format!("{place}[{i}]"), &a[i], &b[i]))
        }
        _ => Some((place.to_owned(), old.to_string(), new.to_string())),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(crate) fn question() -> Question {
        let contender =
            |name: &str| Contender { name: name.into(), how: How::Options(format!("--integrator {name}")) };
        Question {
            program: "tyndall".into(),
            scenes: vec![SceneQuestion { name: "fog".into(), fingerprint: "f06".into() }],
            definitions: Vec::new(),
            size: None,
            contenders: vec![contender("bdpt"), contender("pt")],
            seeds: 2,
            first_seed: 0,
            doublings: 3,
            effort: Effort::Samples(4),
            threads: 1,
            reference: Wanted::Made {
                others: vec![How::Options("--integrator lt".into())],
                is_given: false,
                effort: None,
            },
        }
    }

    #[test]
    fn the_first_difference_is_named() {
        let old = question();
        assert_eq!(first_difference(&old, &old), None);
        let mut new = question();
        new.contenders[1].how = How::Options("--integrator pt --max-depth 3".into());
        let (place, before, after) = first_difference(&old, &new).unwrap();
        assert_eq!(place, "contenders[1].options");
        assert!(before.ends_with("pt\"") && after.ends_with("3\""), "{before} {after}");
        new = Question { effort: Effort::Seconds(4.0), ..question() };
        assert_eq!(first_difference(&old, &new).unwrap().0, "effort");
        new.effort = Effort::Samples(4);
        new.contenders.pop();
        assert_eq!(first_difference(&old, &new).unwrap().0, "contenders");
    }
}
