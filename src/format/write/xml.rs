//! A scene as Mitsuba's XML.

use super::{constant, parts, plain, shortened, unspeakable};
use crate::{
    description::{
        Keyframes, Location, Object, Property, TransformStep, Value,
        keyframes::{Interpolation, Key},
        parameter::{Kind, Parameter},
    },
    error::Result,
    format::{parameters::escaped, tags},
};
use std::borrow::Cow;

/// The text of a file that holds `root`, in which all objects have their tags.
pub(super) fn file(root: &Object) -> Result<String> {
    let mut writer = Writer { out: String::new() };
    let mut attributes = vec![("version", "3.0.0".to_owned())];
    if root.plugin != "scene" {
        attributes.push(("type", escaped(&root.plugin)));
    }
    writer.object(root, attributes, None, 0)?;
    Ok(writer.out)
}

/// The element of a `property` without objects in it.
pub(super) fn property(property: &Property) -> Result<String> {
    let mut writer = Writer { out: String::new() };
    writer.property(property, 0)?;
    Ok(writer.out)
}

/// `property` by the element that Mitsuba takes for the `row` of its parameter. It refuses `<integer>` where any number
/// may stand, and takes an `<rgb>` where a volume may stand for a reflectance: above 1 it has to be a `constvolume`.
fn typed<'a>(property: &'a Property, row: Option<&Parameter>) -> Cow<'a, Property> {
    let value = match (&property.value, row.map(|row| &row.kind)) {
        (Value::Integer(whole), Some(kind)) if is_real(kind) => Value::Float(*whole as f64),
        (Value::Rgb(values), Some(Kind::Volume(..))) if values.iter().any(|x| *x > 1.0) => {
            Value::Object(constvolume(property))
        }
        _ => return Cow::Borrowed(property),
    };
    Cow::Owned(Property { value, ..property.clone() })
}

/// The volume that has the value of `property` everywhere.
fn constvolume(property: &Property) -> Object {
    let [tag, plugin, name] = ["volume", "constvolume", "value"].map(str::to_owned);
    let properties = vec![Property { name, ..property.clone() }];
    Object { tag: Some(tag), plugin, id: None, properties, location: property.location.clone() }
}

fn is_real(kind: &Kind) -> bool {
    matches!(
        kind,
        Kind::Number(_)
            | Kind::NumberOrName(_)
            | Kind::Channels
            | Kind::Colour(..)
            | Kind::Texture(..)
            | Kind::Volume(..)
    )
}

struct Writer {
    out: String,
}

type Attribute<'a> = (&'a str, String);

impl Writer {
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

    /// An object with these attributes, its id, and its name if it has one.
    fn object<'a>(
        &mut self,
        object: &Object,
        mut attributes: Vec<Attribute<'a>>,
        name: Option<Attribute<'a>>,
        depth: usize,
    ) -> Result<()> {
        attributes.extend(object.id.as_ref().map(|id| ("id", escaped(id))));
        attributes.extend(name);
        let tag = object.tag.as_deref().unwrap_or_default();
        let table = tags::table(tag, &object.plugin);
        self.element(tag, &attributes, &object.location, depth, |writer| {
            object.properties.iter().try_for_each(|property| {
                let row = table.and_then(|table| table.find(&property.name));
                writer.property(&typed(property, row), depth + 1)
            })
        })
    }

    fn property(&mut self, Property { name, value, location }: &Property, depth: usize) -> Result<()> {
        let attribute = (!name.is_empty()).then(|| ("name", escaped(name)));
        self.value(value, attribute, vector_tag(name), (location, depth))
    }

    /// `known` is the attribute by which it is known: its name, if it has one, or its time. Vectors are written with
    /// the tag `vector`.
    fn value(
        &mut self,
        value: &Value,
        known: Option<Attribute<'_>>,
        vector: &str,
        (location, depth): (&Location, usize),
    ) -> Result<()> {
        let (tag, text) = match value {
            Value::Boolean(value) => ("boolean", value.to_string()),
            Value::Integer(value) => ("integer", value.to_string()),
            Value::Float(value) => ("float", plain(*value)),
            Value::String(value) | Value::Note(value) => ("string", escaped(value)),
            Value::Spectrum(pairs) => ("spectrum", spectrum(pairs)),
            Value::Rgb(values) => ("rgb", listed(shortened(values))),
            Value::Vector(values) => (vector, listed(values)),
            Value::Transform(steps) => return self.transform(steps, known, location, depth),
            Value::Object(object) => {
                return self.object(object, vec![("type", escaped(&object.plugin))], known, depth);
            }
            Value::Reference(id) => {
                let attributes: Vec<_> = known.into_iter().chain([("id", escaped(id))]).collect();
                return self.element("ref", &attributes, location, depth, |_| Ok(()));
            }
            Value::Keyframes(keyframes) => {
                return self.keyframes(keyframes, known, vector, (location, depth));
            }
        };
        let attributes: Vec<_> = known.into_iter().chain([("value", text)]).collect();
        self.element(tag, &attributes, location, depth, |_| Ok(()))
    }

    fn keyframes(
        &mut self,
        keyframes: &Keyframes,
        known: Option<Attribute<'_>>,
        vector: &str,
        (location, depth): (&Location, usize),
    ) -> Result<()> {
        let interpolation = keyframes.interpolation();
        let linear = interpolation == Interpolation::default();
        let how = (!linear).then(|| ("interpolation", interpolation.name().to_owned()));
        let attributes: Vec<_> = known.into_iter().chain(how).collect();
        self.element("keyframes", &attributes, location, depth, |writer| {
            keyframes.keys().iter().try_for_each(|Key { time, value }| {
                let time = Some(("time", plain(*time)));
                writer.value(&value.value, time, vector, (&value.location, depth + 1))
            })
        })
    }

    fn transform(
        &mut self,
        steps: &[TransformStep],
        name: Option<Attribute<'_>>,
        place: &Location,
        depth: usize,
    ) -> Result<()> {
        let attributes: Vec<_> = name.into_iter().collect();
        self.element("transform", &attributes, place, depth, |writer| {
            steps.iter().try_for_each(|step| {
                let (word, parts) = parts(step);
                // What JSON calls the axis, XML calls the value.
                let attribute =
                    |(name, values)| (if name == "axis" { "value" } else { name }, listed(values));
                let attributes: Vec<_> = parts.into_iter().map(attribute).collect();
                writer.element(word, &attributes, place, depth + 1, |_| Ok(()))
            })
        })
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
