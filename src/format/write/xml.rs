//! A scene as Mitsuba's XML.

use super::{
    Known, constant,
    outline::{Entry, Item, Key, Leaf, Node, Numbers, Step, Texts},
    plain, unspeakable,
};
use crate::{
    description::{Location, keyframes::Interpolation},
    error::Result,
    format::parameters::escaped,
};

/// The text of a file that holds `root`.
pub(super) fn file(root: &Node, known: &mut Known<'_>) -> Result<String> {
    let mut writer = Writer { known, out: String::new() };
    let mut attributes = vec![("version", "3.0.0".to_owned())];
    if root.plugin.value != "scene" {
        attributes.push(("type", spelled(&root.plugin)));
    }
    attributes.extend(root.id.as_ref().map(|id| ("id", spelled(id))));
    let declarations = writer.known.declarations;
    writer.element("scene", &attributes, &root.location, 0, |writer| {
        for declaration in declarations {
            let attributes = [("name", escaped(&declaration.name)), ("value", declaration.text.clone())];
            writer.element("default", &attributes, &root.location, 1, |_| Ok(()))?;
        }
        root.entries.iter().try_for_each(|entry| writer.entry(entry, 1))
    })?;
    Ok(writer.out)
}

struct Writer<'k, 'a> {
    known: &'k mut Known<'a>,
    out: String,
}

type Attribute<'a> = (&'a str, String);

/// A string as an attribute spells it.
fn spelled(leaf: &Leaf<String>) -> String {
    leaf.text.clone().unwrap_or_else(|| escaped(&leaf.value))
}

fn written<T>(leaf: &Leaf<T>, literal: impl Fn(&T) -> String) -> String {
    leaf.text.clone().unwrap_or_else(|| literal(&leaf.value))
}

impl Writer<'_, '_> {
    /// `inside` writes the contents of the element, if there are any.
    fn element(
        &mut self,
        tag: &str,
        attributes: &[Attribute<'_>],
        place: &Location,
        depth: usize,
        inside: impl FnOnce(&mut Self) -> Result<()>,
    ) -> Result<()> {
        let indent = "    ".repeat(depth);
        self.out.push_str(&format!("{indent}<{tag}"));
        for (name, value) in attributes {
            self.out.push_str(&format!(" {name}=\"{}\"", attribute(value, place)?));
        }
        let open = self.out.len();
        self.out.push_str(">\n");
        let inner = self.out.len();
        inside(self)?;
        if self.out.len() == inner {
            self.out.truncate(open);
            self.out.push_str("/>\n");
        } else {
            self.out.push_str(&format!("{indent}</{tag}>\n"));
        }
        Ok(())
    }

    fn entry(&mut self, entry: &Entry, depth: usize) -> Result<()> {
        let Entry { name, item, location, .. } = entry;
        let attribute = (!name.is_empty()).then(|| ("name", escaped(name)));
        self.item(item, attribute, vector_tag(name), (location, depth))
    }

    /// `known` is the attribute by which it is known: its name, if it has one, or its time. Vectors are written with
    /// the tag `vector`.
    fn item(
        &mut self,
        item: &Item,
        known: Option<Attribute<'_>>,
        vector: &str,
        (location, depth): (&Location, usize),
    ) -> Result<()> {
        let value = |writer: &mut Self, tag: &str, value: String| {
            let attributes: Vec<_> = known.clone().into_iter().chain([("value", value)]).collect();
            writer.element(tag, &attributes, location, depth, |_| Ok(()))
        };
        match item {
            Item::Boolean(leaf) => value(self, "boolean", written(leaf, bool::to_string)),
            Item::Integer(leaf) => value(self, "integer", written(leaf, i64::to_string)),
            Item::Float(leaf) => value(self, "float", written(leaf, |x| plain(*x))),
            Item::String(leaf) => value(self, "string", spelled(leaf)),
            Item::Spectrum(leaf) => value(self, "spectrum", written(leaf, |pairs| spectrum(pairs))),
            Item::Rgb(numbers) => {
                let text = self.numbers(numbers, location);
                value(self, "rgb", text)
            }
            Item::Vector(numbers) => {
                let text = self.numbers(numbers, location);
                value(self, vector, text)
            }
            Item::Transform(steps) => {
                let attributes: Vec<_> = known.into_iter().collect();
                self.element("transform", &attributes, location, depth, |writer| {
                    steps.iter().try_for_each(|step| writer.step(step, location, depth + 1))
                })
            }
            Item::Object(node) => self.node(node, known, depth),
            Item::Reference(leaf) => {
                let attributes: Vec<_> = known.into_iter().chain([("id", spelled(leaf))]).collect();
                self.element("ref", &attributes, location, depth, |_| Ok(()))
            }
            Item::Keyframes(interpolation, keys) => {
                let linear = *interpolation == Interpolation::default();
                let how = (!linear).then(|| ("interpolation", interpolation.name().to_owned()));
                let attributes: Vec<_> = known.into_iter().chain(how).collect();
                self.element("keyframes", &attributes, location, depth, |writer| {
                    keys.iter().try_for_each(|key| writer.key(key, vector, depth + 1))
                })
            }
        }
    }

    fn key(&mut self, Key { time, item, location }: &Key, vector: &str, depth: usize) -> Result<()> {
        let time = written(time, |x| plain(*x));
        self.item(item, Some(("time", time)), vector, (location, depth))
    }

    fn node(&mut self, node: &Node, name: Option<Attribute<'_>>, depth: usize) -> Result<()> {
        let mut attributes = vec![("type", spelled(&node.plugin))];
        attributes.extend(node.id.as_ref().map(|id| ("id", spelled(id))));
        attributes.extend(name);
        self.element(&node.tag, &attributes, &node.location, depth, |writer| {
            node.entries.iter().try_for_each(|entry| writer.entry(entry, depth + 1))
        })
    }

    fn step(&mut self, step: &Step, place: &Location, depth: usize) -> Result<()> {
        let attributes: Vec<_> = step
            .parts
            .iter()
            .map(|(name, numbers)| {
                (if *name == "axis" { "value" } else { name }, self.numbers(numbers, place))
            })
            .collect();
        self.element(step.word, &attributes, place, depth, |_| Ok(()))
    }

    fn numbers(&mut self, numbers: &Numbers, place: &Location) -> String {
        match &numbers.text {
            Texts::None => listed(&numbers.values),
            Texts::Whole(text) => text.clone(),
            Texts::Each(texts) => {
                let word = |(x, text): (&f64, &Option<String>)| text.clone().unwrap_or_else(|| plain(*x));
                numbers.values.iter().zip(texts).map(word).collect::<Vec<_>>().join(", ")
            }
            Texts::Lost(text) => {
                self.known.note(place, text, "the numbers around it were completed with defaults");
                listed(&numbers.values)
            }
        }
    }
}

fn listed(values: &[f64]) -> String {
    values.iter().map(|x| plain(*x)).collect::<Vec<_>>().join(", ")
}

/// The same value everywhere is one number.
fn spectrum(pairs: &[(f64, f64)]) -> String {
    if let Some(value) = constant(pairs) {
        return plain(value);
    }
    let pair = |(nm, value): &(f64, f64)| format!("{}:{}", plain(*nm), plain(*value));
    pairs.iter().map(pair).collect::<Vec<_>>().join(", ")
}

/// Mitsuba takes either tag for either; the reader of the file would rather see the right one.
fn vector_tag(name: &str) -> &'static str {
    if ["direction", "axis", "velocity", "up"].iter().any(|word| name.contains(word)) {
        "vector"
    } else {
        "point"
    }
}

/// The value of an attribute. XML 1.0 cannot represent some control characters.
fn attribute(value: &str, place: &Location) -> Result<String> {
    let mut out = String::new();
    for c in value.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push_str(&format!("&#{};", c as u32)),
            '\0'..'\x20' | '\u{fffe}' | '\u{ffff}' => {
                let found = format!("the character U+{:04X} in a text", c as u32);
                return Err(unspeakable(place, "XML", found, "remove the character"));
            }
            _ => out.push(c),
        }
    }
    Ok(out)
}
