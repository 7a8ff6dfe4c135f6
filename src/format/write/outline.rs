//! A scene to be written in either format: every value with the text that represents it where parameters are
//! in it, names only where they mean something, names of files as the target's folder reaches them.

use crate::description::{Location, keyframes::Interpolation};

/// A value, and the text with `$` in it that represents it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Leaf<T> {
    pub value: T,
    pub text: Option<String>,
}

/// Numbers that belong together.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Numbers {
    pub values: Vec<f64>,
    pub text: Texts,
}

impl Numbers {
    /// One number for three that are the same, where that is what the reader makes of one.
    pub(super) fn shortened(self) -> Self {
        match (&self.text, self.values.as_slice()) {
            (Texts::None, [x, y, z]) if x.to_bits() == y.to_bits() && y.to_bits() == z.to_bits() => {
                Self { values: vec![*x], text: Texts::None }
            }
            _ => self,
        }
    }
}

/// Where parameters occur among numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Texts {
    /// Nowhere.
    None,
    /// One text is all of them.
    Whole(String),
    /// A text for some of them.
    Each(Vec<Option<String>>),
    /// One of them, but which one is unknown.
    Lost(String),
}

/// What can serve as a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Item {
    Boolean(Leaf<bool>),
    Integer(Leaf<i64>),
    Float(Leaf<f64>),
    String(Leaf<String>),
    Rgb(Numbers),
    Vector(Numbers),
    Spectrum(Leaf<Vec<(f64, f64)>>),
    Transform(Vec<Step>),
    Object(Node),
    Reference(Leaf<String>),
    Keyframes(Interpolation, Vec<Key>),
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Key {
    pub time: Leaf<f64>,
    pub item: Item,
    pub location: Location,
}

/// A step of a transform: its word, and its parts by name, in JSON's words.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Step {
    pub word: &'static str,
    pub parts: Vec<(&'static str, Numbers)>,
}

/// A plugin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    pub tag: String,
    pub plugin: Leaf<String>,
    pub id: Option<Leaf<String>>,
    pub entries: Vec<Entry>,
    pub location: Location,
}

/// The contents of a plugin.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    /// Empty where there is none, or none that means something.
    pub name: String,
    /// Of an unnamed child, the tag of what it is or refers to.
    pub tag: String,
    pub item: Item,
    pub location: Location,
}

/// The key that JSON gives to the unnamed child that `before` children of the same tag precede.
pub(super) fn made_up(tag: &str, before: usize) -> String {
    if before == 0 { tag.to_owned() } else { format!("{tag}_{}", before + 1) }
}
