//! The outline of a scene, from its tree and from what reading replaced.

use super::{
    super::{
        json::{below, index, key},
        origins::Origins,
        parameters::Parameters,
        tags,
    },
    outline::{Entry, Item, Key, Leaf, Node, Numbers, Step, Texts, made_up},
    paths,
};
use crate::{
    description::{Keyframes, Location, Object, Position, Property, TransformStep, Value, keyframes},
    error::{Error, Result},
};
use std::{
    cell::{Cell, RefCell},
    collections::{HashMap, HashSet},
    path::Path,
};

/// Draws the outline of `root` for a file in `folder`. Says as well how many names of files have changed.
pub(super) fn draw(root: &Object, origins: &Origins, folder: &Path) -> Result<(Node, usize)> {
    let (tags, referred, moved) = (HashMap::new(), HashSet::new(), Cell::new(0));
    let is_keyed = root.tag.is_none();
    let parameters = RefCell::new(Parameters::of(&origins.declarations));
    let mut pen = Pen { origins, parameters, folder, is_keyed, tags, referred, moved };
    pen.survey(root, "scene")?;
    Ok((pen.node(root, "scene", true)?, pen.moved.get()))
}

struct Pen<'a> {
    origins: &'a Origins,
    parameters: RefCell<Parameters>,
    folder: &'a Path,
    /// The scene was read from JSON, where everything has a key.
    is_keyed: bool,
    /// The tag of each object with an id.
    tags: HashMap<&'a str, String>,
    /// Ids that are referred to.
    referred: HashSet<&'a str>,
    /// How many names of files have changed.
    moved: Cell<usize>,
}

impl<'a> Pen<'a> {
    fn survey(&mut self, object: &'a Object, tag: &str) -> Result<()> {
        if let Some(id) = &object.id {
            self.tags.insert(id, tag.to_owned());
        }
        for property in &object.properties {
            match &property.value {
                Value::Object(child) => self.survey(child, &tag_of(child, &property.name, tag)?)?,
                Value::Reference(id) => drop(self.referred.insert(id)),
                _ => {}
            }
        }
        Ok(())
    }

    fn node(&self, object: &'a Object, tag: &str, outermost: bool) -> Result<Node> {
        let mut seen = HashMap::new();
        let entries = object.properties.iter().map(|property| {
            let mut entry = self.entry(property, tag)?;
            if self.is_keyed {
                self.drop_made_up(&mut entry, outermost, &mut seen);
            }
            Ok(entry)
        });
        let leaf = |value: &String, name| Leaf {
            value: value.clone(),
            text: self.origins.attribute(&object.location, name).map(str::to_owned),
        };
        Ok(Node {
            tag: tag.to_owned(),
            plugin: leaf(&object.plugin, "type"),
            id: object.id.as_ref().map(|id| leaf(id, "id")),
            entries: entries.collect::<Result<_>>()?,
            location: object.location.clone(),
        })
    }

    /// JSON gives a key to everything. What is called after its tag has no name, and at the top what is called
    /// after its id has none either.
    fn drop_made_up(&self, entry: &mut Entry, outermost: bool, seen: &mut HashMap<String, usize>) {
        let id = match &entry.item {
            Item::Object(node) => node.id.as_ref().map(|id| id.value.as_str()),
            Item::Reference(_) => None,
            _ => return,
        };
        let count = seen.entry(entry.tag.clone()).or_default();
        let of_id = outermost && id == Some(&entry.name);
        if entry.name == made_up(&entry.tag, *count)
            && !(of_id && self.referred.contains(entry.name.as_str()))
        {
            *count += 1;
            entry.name.clear();
            if let (true, Item::Object(node)) = (of_id, &mut entry.item) {
                node.id = None;
            }
        } else if of_id {
            entry.name.clear();
        }
    }

    fn entry(&self, property: &'a Property, parent: &str) -> Result<Entry> {
        let Property { name, value, location } = property;
        let tag = match value {
            Value::Object(child) => tag_of(child, name, parent)?,
            Value::Reference(id) => self.tags.get(id.as_str()).cloned().unwrap_or_else(|| "ref".into()),
            _ => String::new(),
        };
        let item = self.item(property, &tag)?;
        Ok(Entry { name: name.clone(), tag, item, location: location.clone() })
    }

    fn item(&self, property: &'a Property, tag: &str) -> Result<Item> {
        let place = &property.location;
        let text = self.origins.value(place).map(str::to_owned);
        Ok(match &property.value {
            Value::Boolean(value) => Item::Boolean(Leaf { value: *value, text }),
            Value::Integer(value) => Item::Integer(Leaf { value: *value, text }),
            Value::Float(value) => {
                let text = text.or_else(|| self.origins.attribute(place, "value").map(str::to_owned));
                Item::Float(Leaf { value: *value, text })
            }
            Value::String(value) if property.name.ends_with("filename") => {
                Item::String(self.file_name(value, text, place)?)
            }
            Value::String(value) => Item::String(Leaf { value: value.clone(), text }),
            Value::Rgb(values) => Item::Rgb(self.numbers(place, "value", values).shortened()),
            Value::Vector(values) => Item::Vector(match self.origins.item(place, 0) {
                _ if (0..3).any(|i| self.origins.item(place, i).is_some()) => self.listed(place, values),
                _ => self.numbers(place, "value", values),
            }),
            Value::Spectrum(value) => {
                let text = self.origins.attribute(place, "value").map(str::to_owned);
                Item::Spectrum(Leaf { value: value.clone(), text })
            }
            Value::Transform(steps) => {
                Item::Transform(steps.iter().enumerate().map(|(i, step)| self.step(place, i, step)).collect())
            }
            Value::Object(object) => Item::Object(self.node(object, tag, false)?),
            Value::Reference(id) => {
                // An alias has given way to its id, and the parameter that named it must too.
                let is_id =
                    |text: &&str| self.parameters.borrow_mut().substitute(text).is_ok_and(|t| t == *id);
                let text = self.origins.attribute(place, "id").filter(is_id).map(str::to_owned);
                Item::Reference(Leaf { value: id.clone(), text })
            }
            Value::Keyframes(keyframes) => {
                Item::Keyframes(keyframes.interpolation(), self.keys(keyframes, place)?)
            }
        })
    }

    fn keys(&self, keyframes: &'a Keyframes, place: &Location) -> Result<Vec<Key>> {
        let list = below(place, &key("value"));
        let draw = |(i, of): (usize, &'a keyframes::Key)| {
            let location = of.value.location.clone();
            let text = self.origins.item(&below(&list, &index(i)), 0);
            let text = text.or_else(|| self.origins.attribute(&location, "time")).map(str::to_owned);
            Ok(Key { time: Leaf { value: of.time, text }, item: self.item(&of.value, "")?, location })
        };
        keyframes.keys().iter().enumerate().map(draw).collect()
    }

    /// The numbers that the items of the list at `place` are.
    fn listed(&self, place: &Location, values: &[f64]) -> Numbers {
        let texts: Vec<_> =
            (0..values.len()).map(|i| self.origins.item(place, i).map(str::to_owned)).collect();
        // A matrix of 9 numbers has become one of 16.
        let is_linear = |rows: &[f64]| [3, 7, 11].iter().all(|i| rows[*i] == 0.0);
        let text = match texts.iter().flatten().next() {
            Some(first)
                if values.len() == 16 && is_linear(values) && texts[9..].iter().all(Option::is_none) =>
            {
                Texts::Lost(first.clone())
            }
            _ => some(texts),
        };
        Numbers { values: values.to_vec(), text }
    }

    /// The numbers that the attribute `whole` of what is at `place` holds, or its attributes `x`, `y`, `z`.
    fn numbers(&self, place: &Location, whole: &str, values: &[f64]) -> Numbers {
        if let Some(text) = self.origins.attribute(place, whole) {
            return Numbers { values: values.to_vec(), text: Texts::Whole(text.to_owned()) };
        }
        if let Position::Path(_) = place.position {
            let list = below(place, &key(whole));
            if (0..values.len()).any(|i| self.origins.item(&list, i).is_some()) {
                return self.listed(&list, values);
            }
        }
        let component = |name| self.origins.attribute(place, name).map(str::to_owned);
        let text = if values.len() == 3 { some(["x", "y", "z"].map(component).into()) } else { Texts::None };
        Numbers { values: values.to_vec(), text }
    }

    fn step(&self, transform: &Location, index: usize, step: &TransformStep) -> Step {
        let place = self.origins.step(transform, index);
        let part = |name: &'static str, attribute: &str, values: &[f64]| {
            let numbers = place.as_ref().map(|place| self.numbers(place, attribute, values));
            (name, numbers.unwrap_or_else(|| Numbers { values: values.to_vec(), text: Texts::None }))
        };
        // What JSON calls the axis, XML calls the value.
        let axis = match place.as_ref().map(|place| &place.position) {
            Some(Position::Path(_)) => "axis",
            _ => "value",
        };
        let (word, parts) = match step {
            TransformStep::Translate(value) => ("translate", vec![part("value", "value", value)]),
            TransformStep::Scale(value) => {
                let (name, numbers) = part("value", "value", value);
                ("scale", vec![(name, numbers.shortened())])
            }
            TransformStep::Rotate { axis: value, angle } => {
                ("rotate", vec![part("axis", axis, value), part("angle", "angle", &[*angle])])
            }
            TransformStep::LookAt { origin, target, up } => (
                "lookat",
                [("origin", origin), ("target", target), ("up", up)].map(|(n, v)| part(n, n, v)).into(),
            ),
            TransformStep::Matrix(rows) => ("matrix", vec![part("value", "value", rows)]),
        };
        Step { word, parts }
    }

    /// A relative name starts at the folder of the scene that gives it.
    fn file_name(&self, value: &str, text: Option<String>, place: &Location) -> Result<Leaf<String>> {
        let home = paths::folder(&place.file);
        let elsewhere = self.origins.was_found_elsewhere(place);
        if Path::new(value).is_absolute() && !elsewhere {
            return Ok(Leaf { value: value.to_owned(), text });
        }
        if !elsewhere && paths::relative(home, self.folder, place)? == "." {
            return Ok(Leaf { value: value.to_owned(), text });
        }
        self.moved.set(self.moved.get() + 1);
        let text = match text {
            Some(text) if !elsewhere && !text.starts_with(['$', '/']) => {
                let way = super::super::parameters::escaped(&paths::relative(home, self.folder, place)?);
                Some(format!("{way}/{text}"))
            }
            _ => None,
        };
        Ok(Leaf { value: paths::relative(&home.join(value), self.folder, place)?, text })
    }
}

fn some(texts: Vec<Option<String>>) -> Texts {
    if texts.iter().all(Option::is_none) { Texts::None } else { Texts::Each(texts) }
}

fn tag_of(object: &Object, name: &str, parent: &str) -> Result<String> {
    if let Some(tag) = &object.tag {
        return Ok(tag.clone());
    }
    tags::derive(&object.plugin, name, parent).map(str::to_owned).ok_or_else(|| {
        let known = tags::of_plugin(&object.plugin);
        let choice = if known.is_empty() { &tags::TAGS[1..] } else { &known };
        Error::new(
            &object.location,
            "a plugin whose tag in XML is known",
            format!("\"{}\"", object.plugin),
            format!("correct the type, or add \"$tag\" with one of {}", choice.join(", ")),
        )
    })
}
