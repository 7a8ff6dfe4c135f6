//! A scene as JSON.

use super::{
    Known, constant,
    keys::Keys,
    kinds::{kinds, split},
    layout::Json,
    outline::{Entry, Item, Key, Leaf, Node, Numbers, Step, Texts},
    plain, unspeakable,
};
use crate::{
    description::{Location, keyframes::Interpolation},
    error::Result,
    format::{
        origins::{Declaration, Kind},
        parameters::escaped,
        tags,
    },
};
use std::collections::{HashMap, HashSet};

/// The text of a file that holds `root`.
pub(super) fn file(root: &Node, known: &mut Known<'_>) -> Result<String> {
    if root.plugin.value != "scene" {
        let found = format!("\"{}\" as the type of the scene", root.plugin.value);
        return Err(unspeakable(&root.location, "JSON", found, "remove the type"));
    }
    let kinds = kinds(root, known);
    let mut writer = Writer { known, kinds, ids: HashSet::new() };
    writer.collect_ids(root);
    let Json::Map(mut entries) = writer.node(root, None)? else { return Ok(String::new()) };
    let declarations = writer.declarations();
    if !declarations.is_empty() {
        entries.insert(1, ("$defaults".into(), Json::Map(declarations)));
    }
    Ok(Json::Map(entries).file())
}

struct Writer<'k, 'a> {
    known: &'k mut Known<'a>,
    kinds: HashMap<String, Kind>,
    /// All ids: no key at the top may be one that is not its object's.
    ids: HashSet<String>,
}

/// Why a number, a truth value or a colour cannot be a text with parameters in it.
const WHOLE: &str = "in JSON a parameter is a whole value or part of a string";

impl Writer<'_, '_> {
    fn collect_ids(&mut self, node: &Node) {
        self.ids.extend(node.id.as_ref().map(|id| id.value.clone()));
        for entry in &node.entries {
            if let Item::Object(child) = &entry.item {
                self.collect_ids(child);
            }
        }
    }

    /// `key` is that by which the outermost object leads to it: no need to say the id again.
    fn node(&mut self, node: &Node, key: Option<&str>) -> Result<Json> {
        let outermost = node.tag == "scene";
        let mut entries = vec![("type".to_owned(), self.string(&node.plugin, &node.location))];
        if let Some(id) = node.id.as_ref().filter(|id| key != Some(&id.value) || id.text.is_some()) {
            entries.push(("id".to_owned(), self.string(id, &node.location)));
        }
        let ids = if outermost { self.ids.clone() } else { HashSet::new() };
        let mut keys = Keys::new(node, ids)?;
        for entry in &node.entries {
            let key = keys.of(entry, outermost);
            let top = outermost.then_some(key.as_str());
            let mut value = self.item(&entry.item, &entry.location, top)?;
            self.add_tag(&mut value, entry, &key, &node.tag);
            entries.push((key, value));
        }
        Ok(Json::Map(entries))
    }

    /// Writes the tag where it cannot be derived.
    fn add_tag(&self, value: &mut Json, entry: &Entry, key: &str, parent: &str) {
        if let (Json::Map(entries), Item::Object(node)) = (value, &entry.item)
            && tags::derive(&node.plugin.value, key, parent) != Some(&node.tag)
        {
            entries.insert(1, ("$tag".into(), Json::string(&node.tag)));
        }
    }

    fn item(&mut self, item: &Item, place: &Location, key: Option<&str>) -> Result<Json> {
        Ok(match item {
            Item::Boolean(leaf) => self.whole(leaf, Kind::Boolean, place, bool::to_string),
            Item::Integer(leaf) => self.whole(leaf, Kind::Integer, place, i64::to_string),
            Item::Float(leaf) => self.whole(leaf, Kind::Float, place, |x| format!("{x:?}")),
            Item::String(leaf) => self.string(leaf, place),
            Item::Rgb(numbers) => value("rgb", self.rgb(numbers, place)),
            Item::Vector(numbers) => self.numbers(numbers, place),
            Item::Spectrum(leaf) => value("spectrum", self.spectrum(leaf, place)),
            Item::Transform(steps) => Json::List(steps.iter().map(|step| self.step(step, place)).collect()),
            Item::Object(node) => self.node(node, key)?,
            Item::Reference(leaf) => {
                let id = self.string(leaf, place);
                Json::Map(vec![("type".into(), Json::string("ref")), ("id".into(), id)])
            }
            Item::Keyframes(interpolation, keys) => self.keyframes(*interpolation, keys)?,
        })
    }

    fn keyframes(&mut self, interpolation: Interpolation, keys: &[Key]) -> Result<Json> {
        let pair = |Key { time, item, location }: &Key| {
            let time = self.whole(time, Kind::Float, location, |x| plain(*x));
            Ok(Json::List(vec![time, self.item(item, location, None)?]))
        };
        let keys = Json::List(keys.iter().map(pair).collect::<Result<_>>()?);
        let mut entries = vec![("type".to_owned(), Json::string("keyframes"))];
        if interpolation != Interpolation::default() {
            entries.push(("interpolation".into(), Json::string(interpolation.name())));
        }
        entries.push(("value".into(), keys));
        Ok(Json::Map(entries))
    }

    fn spectrum(&mut self, leaf: &Leaf<Vec<(f64, f64)>>, place: &Location) -> Json {
        if let Some(value) = constant(&leaf.value) {
            let leaf = Leaf { value, text: leaf.text.clone() };
            return self.whole(&leaf, Kind::Float, place, |x| plain(*x));
        }
        if let Some(text) = &leaf.text {
            self.known.note(place, text, WHOLE);
        }
        let pair = |(nm, x): &(f64, f64)| Json::List([nm, x].map(|x| Json::Word(plain(*x))).into());
        Json::List(leaf.value.iter().map(pair).collect())
    }

    fn step(&mut self, step: &Step, place: &Location) -> Json {
        let mut entries = vec![("type".to_owned(), Json::string(step.word))];
        for (name, numbers) in &step.parts {
            entries.push(((*name).to_owned(), self.one_or_more(numbers, place)));
        }
        Json::Map(entries)
    }

    /// A value that is not text.
    fn whole<T>(
        &mut self,
        leaf: &Leaf<T>,
        kind: Kind,
        place: &Location,
        literal: impl Fn(&T) -> String,
    ) -> Json {
        let Some(text) = &leaf.text else { return Json::Word(literal(&leaf.value)) };
        match self.known.whole(text).and_then(|name| self.kinds.get(name)) {
            Some(known) if *known == kind || (*known == Kind::Integer && kind == Kind::Float) => {
                Json::string(text.trim())
            }
            _ => {
                self.known.note(place, text, WHOLE);
                Json::Word(literal(&leaf.value))
            }
        }
    }

    /// A text. Where it is all one parameter, that must be text too; where it only contains some, they must be
    /// spelled as they were.
    fn string(&mut self, leaf: &Leaf<String>, place: &Location) -> Json {
        let Some(text) = &leaf.text else { return Json::string(&escaped(&leaf.value)) };
        if self.is_string(text) {
            return Json::string(text);
        }
        self.known.note(place, text, "in JSON its parameter is a number or a truth value");
        Json::string(&escaped(&leaf.value))
    }

    fn is_string(&self, text: &str) -> bool {
        if let Some(name) = text.strip_prefix('$').filter(|name| self.known.parameters.is_name(name)) {
            return self.kinds.get(name) == Some(&Kind::String);
        }
        self.known.parameters.names_in(text).iter().all(|name| {
            let declaration = self.known.declarations.iter().find(|known| known.name == *name);
            declaration.is_some_and(|declaration| self.keeps_text(declaration))
        })
    }

    /// True if the parameter's text is the same after it has been a value of its kind in JSON.
    fn keeps_text(&self, Declaration { name, value, .. }: &Declaration) -> bool {
        match self.kinds.get(name) {
            Some(Kind::Float) => value.parse().is_ok_and(|x: f64| format!("{x:?}") == *value),
            Some(Kind::Integer) => value.parse().is_ok_and(|i: i64| i.to_string() == *value),
            Some(Kind::Boolean) => matches!(value.as_str(), "true" | "false"),
            Some(Kind::String) => true,
            None => false,
        }
    }

    fn numbers(&mut self, numbers: &Numbers, place: &Location) -> Json {
        let texts = self.texts(numbers);
        let mut items = Vec::new();
        for (value, text) in numbers.values.iter().zip(texts) {
            let is_number = |known: &&Kind| matches!(known, Kind::Integer | Kind::Float);
            items.push(match text {
                None => Json::Word(plain(*value)),
                Some(text)
                    if self
                        .known
                        .whole(&text)
                        .and_then(|n| self.kinds.get(n))
                        .filter(is_number)
                        .is_some() =>
                {
                    Json::string(text.trim())
                }
                Some(text) => {
                    self.known.note(place, &text, WHOLE);
                    Json::Word(plain(*value))
                }
            });
        }
        Json::List(items)
    }

    /// The text that represents each number.
    fn texts(&mut self, numbers: &Numbers) -> Vec<Option<String>> {
        let count = numbers.values.len();
        match &numbers.text {
            Texts::None => vec![None; count],
            Texts::Each(texts) => texts.clone(),
            Texts::Whole(text) => {
                split(text, count, self.known).unwrap_or_else(|| vec![Some(text.clone()); count])
            }
            Texts::Lost(text) => vec![Some(text.clone()); count],
        }
    }

    /// A colour may be a text as in XML, where it is nothing else.
    fn rgb(&mut self, numbers: &Numbers, place: &Location) -> Json {
        match &numbers.text {
            Texts::Whole(text) if split(text, 3, self.known).is_none() && self.is_string(text) => {
                Json::string(text)
            }
            _ => self.one_or_more(numbers, place),
        }
    }

    fn one_or_more(&mut self, numbers: &Numbers, place: &Location) -> Json {
        match self.numbers(numbers, place) {
            Json::List(mut items) if items.len() == 1 => items.remove(0),
            list => list,
        }
    }

    fn declarations(&mut self) -> Vec<(String, Json)> {
        let declarations = self.known.declarations;
        let declared = declarations.iter().filter_map(|declaration| {
            let kind = *self.kinds.get(&declaration.name)?;
            Some((declaration.name.clone(), self.default(declaration, kind)))
        });
        declared.collect()
    }

    fn default(&self, declaration: &Declaration, kind: Kind) -> Json {
        let Declaration { text, value, .. } = declaration;
        let same_kind = |name: &str| self.kinds.get(name) == Some(&kind);
        if self.known.whole(text).is_some_and(same_kind) {
            return Json::string(text.trim());
        }
        match kind {
            Kind::String if self.is_string(text) => Json::string(text),
            Kind::String => Json::string(&escaped(value)),
            Kind::Boolean => Json::Word(value.to_ascii_lowercase()),
            Kind::Integer => Json::Word(value.trim().parse::<i64>().map_or(value.clone(), |i| i.to_string())),
            Kind::Float => {
                Json::Word(value.trim().parse::<f64>().map_or(value.clone(), |x| format!("{x:?}")))
            }
        }
    }
}

fn value(kind: &str, value: Json) -> Json {
    Json::Map(vec![("type".into(), Json::string(kind)), ("value".into(), value)])
}
