//! Of what kind each parameter is: JSON must say so, XML leaves it to where the parameter is used.

use super::{
    Known,
    keys::is_key,
    outline::{Item, Key, Node, Numbers, Texts},
};
use crate::format::{
    origins::{Declaration, Kind},
    text,
};
use std::collections::HashMap;

/// What each parameter is used as. One that is nowhere a whole value is text.
pub(super) fn kinds(root: &Node, known: &mut Known<'_>) -> HashMap<String, Kind> {
    let mut uses = Uses { known, of: HashMap::new() };
    uses.node(root);
    let Uses { mut of, known } = uses;
    let mut kinds = HashMap::new();
    for Declaration { name, text, value, kind } in known.declarations.iter().rev().filter(|d| is_key(&d.name))
    {
        let used = of.remove(name.as_str()).unwrap_or_default();
        let chosen = kind.unwrap_or_else(|| choose(&used, value));
        if let (Some(other), true) = (known.whole(text), chosen != Kind::String) {
            of.entry(other.to_owned()).or_default().push(chosen);
        }
        kinds.insert(name.clone(), chosen);
    }
    kinds
}

/// The kind that serves most uses; `value` is the value of the parameter.
fn choose(used: &[Kind], value: &str) -> Kind {
    let is_integer = text::integer(value).is_ok();
    let is_number = text::float(value).is_ok();
    let is_boolean = text::boolean(value).is_ok();
    let is_used = |kind| used.contains(&kind);
    if is_used(Kind::Integer) && is_integer {
        Kind::Integer
    } else if is_used(Kind::Float) && is_number {
        Kind::Float
    } else if is_used(Kind::Boolean) && is_boolean {
        Kind::Boolean
    } else {
        Kind::String
    }
}

/// A walk that finds what parameters are used as.
struct Uses<'k, 'a> {
    known: &'k mut Known<'a>,
    of: HashMap<String, Vec<Kind>>,
}

impl Uses<'_, '_> {
    fn node(&mut self, node: &Node) {
        node.entries.iter().for_each(|entry| self.item(&entry.item));
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Boolean(leaf) => self.add(leaf.text.as_deref(), Kind::Boolean),
            Item::Integer(leaf) => self.add(leaf.text.as_deref(), Kind::Integer),
            Item::Float(leaf) => self.add(leaf.text.as_deref(), Kind::Float),
            Item::Rgb(numbers) | Item::Vector(numbers) => self.numbers(numbers),
            Item::Transform(steps) => {
                steps.iter().flat_map(|step| &step.parts).for_each(|(_, numbers)| self.numbers(numbers));
            }
            Item::Object(node) => self.node(node),
            Item::Spectrum(leaf) => self.add(leaf.text.as_deref(), Kind::Float),
            Item::String(_) | Item::Reference(_) => {}
            Item::Keyframes(_, keys) => {
                for Key { time, item, .. } in keys {
                    self.add(time.text.as_deref(), Kind::Float);
                    self.item(item);
                }
            }
        }
    }

    fn numbers(&mut self, numbers: &Numbers) {
        let texts = match &numbers.text {
            Texts::None | Texts::Lost(_) => return,
            Texts::Each(texts) => texts.clone(),
            Texts::Whole(text) => split(text, numbers.values.len(), self.known).unwrap_or_default(),
        };
        texts.iter().for_each(|text| self.add(text.as_deref(), Kind::Float));
    }

    fn add(&mut self, text: Option<&str>, kind: Kind) {
        if let Some(name) = text.and_then(|text| self.known.whole(text)) {
            self.of.entry(name.to_owned()).or_default().push(kind);
        }
    }
}

/// The text of each of `count` numbers, which together are `written`; none if its words are not that.
pub(super) fn split(written: &str, count: usize, known: &mut Known<'_>) -> Option<Vec<Option<String>>> {
    let words: Vec<&str> = text::words(written).collect();
    for word in &words {
        text::float(&known.value_of(word)?).ok()?;
    }
    let texts = |word: &&str| word.contains('$').then(|| (*word).to_owned());
    match words.len() {
        1 if count == 3 => Some(vec![texts(&words[0]); 3]),
        found if found == count => Some(words.iter().map(texts).collect()),
        _ => None,
    }
}
