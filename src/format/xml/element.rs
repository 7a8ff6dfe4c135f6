//! An XML element with its parameters substituted, its place, and its attributes by name.

use super::{
    super::{
        parameters::Parameters,
        text::{Parsed, quoted},
    },
    files::Source,
};
use crate::{
    description::{Location, nearest},
    error::{Error, Result},
};
use roxmltree::Node;

/// One element of a scene file.
pub(super) struct Element<'s> {
    /// Its tag.
    pub tag: &'s str,
    /// Where it starts.
    pub location: Location,
    attributes: Vec<Attribute<'s>>,
    node: Node<'s, 's>,
    source: &'s Source,
}

/// One attribute of an element.
pub(super) struct Attribute<'s> {
    name: &'s str,
    /// Its value, every `$name` replaced.
    pub value: String,
    written: &'s str,
    /// Where it starts.
    pub location: Location,
}

impl<'s> Element<'s> {
    /// The element at `node`; an undefined `$name` in an attribute is an error.
    pub(super) fn new(source: &'s Source, node: Node<'s, 's>, parameters: &mut Parameters) -> Result<Self> {
        let location = source.location(node.range().start);
        let tag = node.tag_name().name();
        if node.tag_name().namespace().is_some() || node.namespaces().len() > 0 {
            let found = format!("<{tag}> in a namespace");
            return Err(Error::new(location, "an element without namespaces", found, "remove the xmlns"));
        }
        let attributes = node.attributes().map(|a| {
            let location = source.location(a.range().start);
            let value = match parameters.substitute(a.value()) {
                Ok(value) => value,
                Err(unfit) => return Err(Error::new(location, unfit.expected, unfit.found, unfit.remedy)),
            };
            Ok(Attribute { name: a.name(), value, written: a.value(), location })
        });
        Ok(Self { tag, location, attributes: attributes.collect::<Result<_>>()?, node, source })
    }

    /// The attribute called `name`.
    pub(super) fn get(&self, name: &str) -> Option<&Attribute<'s>> {
        self.attributes.iter().find(|attribute| attribute.name == name)
    }

    /// The attribute called `name`, which must be there.
    pub(super) fn require(&self, name: &str) -> Result<&Attribute<'s>> {
        self.get(name).ok_or_else(|| {
            let expected = format!("the attribute \"{name}\" of <{}>", self.tag);
            let remedy = format!("write <{} {name}=\"...\">", self.tag);
            Error::new(&self.location, expected, self.attribute_names(), remedy)
        })
    }

    fn attribute_names(&self) -> String {
        let names: Vec<_> = self.attributes.iter().map(|attribute| attribute.name).collect();
        if names.is_empty() { "no attributes".into() } else { format!("only {}", names.join(", ")) }
    }

    /// The attribute called `name`, where given; if so, not empty.
    pub(super) fn optional_name(&self, name: &str) -> Result<Option<String>> {
        self.get(name).map(|attribute| attribute.nonempty().map(str::to_owned)).transpose()
    }

    /// Attributes other than these are errors.
    pub(super) fn allow(&self, names: &[&str]) -> Result<()> {
        let Some(odd) = self.attributes.iter().find(|a| !names.contains(&a.name)) else { return Ok(()) };
        let expected = format!("an attribute of <{}>", self.tag);
        let mut remedy = format!("{}known here: {}", nearest(odd.name, names), names.join(", "));
        if names.contains(&"type") {
            let element = format!("<float name=\"{}\" value=\"...\"/>", odd.name);
            remedy = format!("{remedy}; a parameter is an element, such as {element}");
        }
        Err(Error::new(&odd.location, expected, format!("\"{}\"", odd.name), remedy))
    }

    /// The elements in this one. Text between them means nothing, as in Mitsuba; the user is told.
    pub(super) fn children(&self) -> Vec<Node<'s, 's>> {
        for node in self.node.children().filter(Node::is_text) {
            let text = node.text().unwrap_or_default();
            if !text.trim().is_empty() {
                let start = node.range().start + text.len() - text.trim_start().len();
                self.source.note(start, format!("the text {} is ignored", quoted(text.trim())));
            }
        }
        self.node.children().filter(Node::is_element).collect()
    }

    /// An element in this one is an error.
    pub(super) fn childless(&self) -> Result<()> {
        let Some(child) = self.children().first().copied() else { return Ok(()) };
        let expected = format!("nothing in <{}>", self.tag);
        let found = format!("<{}>", child.tag_name().name());
        Err(Error::new(self.source.location(child.range().start), expected, found, "move it out"))
    }

    /// A `spectrum` with a `type` is a plugin, not a value.
    pub(super) fn is_spectrum_plugin(&self) -> bool {
        self.tag == "spectrum" && self.get("type").is_some()
    }

    /// The kind of plugin it holds: its tag, but spectra are textures.
    pub(super) fn object_tag(&self) -> &'s str {
        if self.is_spectrum_plugin() { "texture" } else { self.tag }
    }

    /// A mistake in the element as a whole.
    pub(super) fn check<T>(&self, parsed: Parsed<T>) -> Result<T> {
        parsed.map_err(|m| {
            let remedy = format!("give <{}> {}", self.tag, m.expected);
            Error::new(&self.location, m.expected, m.found, remedy)
        })
    }
}

impl Attribute<'_> {
    /// Its value, which must not be empty.
    pub(super) fn nonempty(&self) -> Result<&str> {
        if self.value.is_empty() {
            return Err(self.wrong("some text", format!("fill or remove \"{}\"", self.name)));
        }
        Ok(&self.value)
    }

    /// Its value as `parse` reads it.
    pub(super) fn parse<T>(&self, parse: impl FnOnce(&str) -> Parsed<T>) -> Result<T> {
        let quoted = quoted(&self.value);
        parse(&self.value).map_err(|m| {
            let found = if m.found == quoted { quoted } else { format!("{} in {quoted}", m.found) };
            let remedy = match self.written == self.value {
                true => format!("change \"{}\" to {}", self.name, m.expected),
                false => {
                    format!("change {} (in \"{}\") so that it is {}", self.written, self.name, m.expected)
                }
            };
            Error::new(&self.location, m.expected, found, remedy)
        })
    }

    /// The error for a value that is not as `expected`.
    pub(super) fn wrong(&self, expected: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::new(&self.location, expected, format!("{}={}", self.name, quoted(&self.value)), remedy)
    }
}
