//! The XML format: Mitsuba scene files, versions 2 and 3, and older ones, which are upgraded as in Mitsuba 3.
//!
//! All of Mitsuba's tags are read: objects, values, `transform`, `ref`, `include`, `default`, `alias`, `path`.
//! What Mitsuba would refuse is refused here, except in older files, which are read as Mitsuba 0.6 did. Beyond that, a
//! `path` that is no folder is an error too, an `alias` may precede what it names, and colours may be written `#rrggbb`.
//!
//! `keyframes` are Tyndall's own: a value of numbers that changes in time is
//! `<keyframes name="..."><float time="0" value="1"/><float time="2.5" value="3"/></keyframes>`, with elements for any
//! kind of number, or `transform`s; with `interpolation="smooth"` it eases in and out.

mod blank;
mod element;
mod files;
mod transform;
mod upgrade;
mod values;

use super::{
    draft::{Alias, DEEPEST, Draft},
    parameters::Parameters,
    tags::TAGS,
    text,
};
use crate::{
    description::{
        Keyframes, Location, Object, Property, TransformStep, Value, keyframes::Key, nearest, substitutes,
    },
    error::{Error, Result},
};
use element::Element;
use files::{Folders, Source};
use std::{
    collections::{BTreeSet, HashSet},
    path::{Path, PathBuf},
};

/// Tags that direct the reading.
const DIRECTIONS: [&str; 7] = ["ref", "transform", "keyframes", "include", "default", "alias", "path"];

/// As in Mitsuba.
const DEEPEST_INCLUDE: usize = 15;

/// Files that include others twice each could be read without end.
const MOST_INCLUDES: usize = 10_000;

/// Reads the scene at `path`.
pub(super) fn read(path: &Path, parameters: &mut Parameters) -> Result<Draft> {
    let mut reader = Reader {
        parameters,
        aliases: Vec::new(),
        included: BTreeSet::new(),
        found: HashSet::new(),
        open: Vec::new(),
        includes: 0,
    };
    let root = reader.file(path, Folders::default())?;
    if root.tag.as_deref() != Some("scene") {
        let found = format!("<{}>", root.tag.unwrap_or_default());
        return Err(Error::new(
            root.location,
            "<scene> as the outermost element",
            found,
            "wrap it in <scene>",
        ));
    }
    let Reader { aliases, included, found, .. } = reader;
    Ok(Draft { root, aliases, included, found })
}

/// What all files of one scene share.
struct Reader<'p> {
    parameters: &'p mut Parameters,
    aliases: Vec<Alias>,
    included: BTreeSet<PathBuf>,
    found: HashSet<Location>,
    /// The files being read, outermost first, under names that no two spellings of a path share.
    open: Vec<PathBuf>,
    /// How many files have been included.
    includes: usize,
}

/// What all elements of one file share.
struct Page<'s> {
    source: &'s Source,
    folders: Folders,
    /// True if it is for Mitsuba before version 2.
    is_old: bool,
}

impl Page<'_> {
    /// What `child` is called in `parent`; empty where it has no name.
    fn name(&self, child: &Element, parent: &Object) -> Result<String> {
        let name = child.optional_name("name")?.unwrap_or_default();
        Ok(if self.is_old { upgrade::name(&name, &parent.plugin) } else { name })
    }
}

impl Reader<'_> {
    /// The outermost object of a file.
    fn file(&mut self, path: &Path, mut folders: Folders) -> Result<Object> {
        let source = Source::read(path)?;
        let document = source.parse()?;
        folders.enter(path);
        let mut page = Page { source: &source, folders, is_old: false };
        let root = self.element(&page, document.root_element())?;
        page.is_old = is_old(&root)?;
        let mut object = self.object(&mut page, &root, &["version"], 1)?;
        object.properties.append(&mut source.notes.borrow_mut());
        page.folders.settle(&mut object, &source.file, &mut self.found);
        Ok(object)
    }

    fn element<'s>(&mut self, page: &Page<'s>, node: roxmltree::Node<'s, 's>) -> Result<Element<'s>> {
        let mut element = Element::new(page.source, node, self.parameters)?;
        element.tag = if page.is_old { upgrade::tag(element.tag) } else { element.tag };
        Ok(element)
    }

    /// A plugin with all its children. `more` are attributes beyond `type`, `id` and `name`.
    fn object(&mut self, page: &mut Page, element: &Element, more: &[&str], depth: usize) -> Result<Object> {
        if depth > DEEPEST {
            let expected = format!("elements at most {DEEPEST} deep");
            return Err(Error::new(&element.location, expected, "deeper nesting", "flatten the scene"));
        }
        element.allow(&[&["type", "id", "name"], more].concat())?;
        let written = match element.tag {
            "scene" => element.get("type").map_or("scene", |a| a.value.as_str()),
            _ => element.require("type")?.nonempty()?,
        };
        let plugin = if page.is_old { upgrade::plugin(written) } else { written }.to_owned();
        let mut object = Object {
            tag: Some(element.object_tag().to_owned()),
            plugin,
            id: element.optional_name("id")?,
            properties: Vec::new(),
            location: element.location.clone(),
        };
        for node in element.children() {
            let child = self.element(page, node)?;
            self.child(page, &child, &mut object, depth)?;
        }
        if page.is_old {
            upgrade::object(&mut object, written)?;
        }
        Ok(object)
    }

    /// One child element of a plugin.
    fn child(&mut self, page: &mut Page, child: &Element, parent: &mut Object, depth: usize) -> Result<()> {
        let value = match child.tag {
            "include" => return self.include(page, child, parent),
            "default" => return self.default(child),
            "alias" => return self.alias(child),
            "path" if depth == 1 => return page.folders.add(child),
            "path" => return Err(misplaced(child, "directly in the outermost element")),
            "scene" => return Err(misplaced(child, "only as the outermost element of a file")),
            "ref" => {
                child.allow(&["id", "name"])?;
                Value::Reference(child.require("id")?.nonempty()?.to_owned())
            }
            "transform" => {
                child.allow(&["name"])?;
                child.require("name")?.nonempty()?;
                Value::Transform(self.steps(page, child)?)
            }
            "keyframes" => Value::Keyframes(self.keyframes(page, child)?),
            "spectrum" if page.is_old && values::is_rgb(child) => {
                values::read(&values::RGB, child, "name", &page.folders)?
            }
            "blackbody" if page.is_old => values::blackbody(child)?,
            "srgb" if page.is_old => values::srgb(child)?,
            tag if TAGS.contains(&tag) || child.is_spectrum_plugin() => {
                Value::Object(self.object(page, child, &[], depth + 1)?)
            }
            tag => match values::ROWS.get(tag) {
                Some(row) => values::read(row, child, "name", &page.folders)?,
                None => return Err(unknown(child)),
            },
        };
        let name = page.name(child, parent)?;
        add(parent, Property { name, value, location: child.location.clone() })
    }

    fn keyframes(&mut self, page: &Page, element: &Element) -> Result<Keyframes> {
        element.allow(&["name", "interpolation"])?;
        element.require("name")?.nonempty()?;
        let interpolation = element.get("interpolation").map(values::interpolation).transpose()?;
        let mut keys = Vec::new();
        for node in element.children() {
            let key = self.element(page, node)?;
            keys.push(self.key(page, key)?);
        }
        Keyframes::new(interpolation.unwrap_or_default(), keys, &element.location)
    }

    fn key(&mut self, page: &Page, element: Element) -> Result<Key> {
        let value = match values::ROWS.get(element.tag) {
            Some(row) => values::read(row, &element, "time", &page.folders)?,
            None if element.tag == "transform" => {
                element.allow(&["time"])?;
                Value::Transform(self.steps(page, &element)?)
            }
            None => {
                let found = format!("<{}>", element.tag);
                let remedy = "write it like <float time=\"0\" value=\"1.5\"/>";
                return Err(Error::new(element.location, "a value at a time in <keyframes>", found, remedy));
            }
        };
        let time = element.require("time")?.parse(text::float)?;
        Ok(Key { time, value: Property { name: String::new(), value, location: element.location } })
    }

    fn steps(&mut self, page: &Page, transform: &Element) -> Result<Vec<TransformStep>> {
        let step = |node| transform::step(&self.element(page, node)?);
        transform.children().into_iter().map(step).collect()
    }

    fn default(&mut self, element: &Element) -> Result<()> {
        element.allow(&["name", "value"])?;
        element.childless()?;
        let name = element.require("name")?.nonempty()?;
        self.parameters.declare(name, &element.require("value")?.value);
        Ok(())
    }

    fn alias(&mut self, element: &Element) -> Result<()> {
        element.allow(&["id", "as"])?;
        element.childless()?;
        let target = element.require("id")?.nonempty()?.to_owned();
        let name = element.require("as")?.nonempty()?.to_owned();
        self.aliases.push(Alias { name, target, location: element.location.clone() });
        Ok(())
    }

    /// Another file in place of the element: all that its scene holds, or its one object.
    fn include(&mut self, page: &Page, element: &Element, parent: &mut Object) -> Result<()> {
        element.allow(&["filename", "name"])?;
        element.childless()?;
        let name = element.require("filename")?;
        let path = page.folders.find(&name.value).ok_or_else(|| page.folders.missing(name))?;
        self.open.push(page.source.identity.clone());
        if self.open.contains(&files::identity(&path)) {
            return Err(name.wrong("a file that is not being read already", "break the circle of includes"));
        }
        if self.open.len() >= DEEPEST_INCLUDE {
            let expected = format!("includes at most {DEEPEST_INCLUDE} deep");
            return Err(name.wrong(expected, "include fewer files from included files"));
        }
        self.includes += 1;
        if self.includes > MOST_INCLUDES {
            let expected = format!("at most {MOST_INCLUDES} includes in all");
            return Err(name.wrong(expected, "include fewer files from included files"));
        }
        let included = self.file(&path, page.folders.clone())?;
        self.included.insert(path);
        self.open.pop();
        if included.tag.as_deref() == Some("scene") {
            return included.properties.into_iter().try_for_each(|property| add(parent, property));
        }
        let (name, location) = (page.name(element, parent)?, included.location.clone());
        add(parent, Property { name, value: Value::Object(included), location })
    }
}

/// True if the file is for Mitsuba before version 2.
fn is_old(root: &Element) -> Result<bool> {
    let Some(version) = root.get("version") else {
        let remedy = format!("write <{} version=\"3.0.0\" ...>", root.tag);
        return Err(Error::new(&root.location, "the version of Mitsuba the file is for", "none", remedy));
    };
    let mut numbers = version.value.split('.').map(|part| part.trim().parse::<u32>());
    match numbers.next() {
        Some(Ok(first @ 0..=3)) if numbers.all(|part| part.is_ok()) => Ok(first < 2),
        _ => {
            let remedy = "write version=\"3.0.0\" if the scene is for Mitsuba 3";
            let found = format!("\"{}\"", version.value);
            Err(Error::new(&version.location, "a scene of version 0.x to 3.x", found, remedy))
        }
    }
}

/// Adds a property; a name given twice is an error.
fn add(object: &mut Object, property: Property) -> Result<()> {
    let Property { name, location, .. } = &property;
    let first = match name.is_empty() {
        true => None,
        false => object.properties.iter().find(|other| other.name == *name),
    };
    if let Some(first) = first {
        let expected = format!("each parameter once (the first \"{name}\" is at {})", first.location);
        return Err(Error::new(location, expected, format!("\"{name}\" again"), "remove one of the two"));
    }
    object.properties.push(property);
    Ok(())
}

fn misplaced(element: &Element, right: &str) -> Error {
    let tag = element.tag;
    Error::new(&element.location, format!("<{tag}> {right}"), "it elsewhere", format!("move the <{tag}>"))
}

fn unknown(element: &Element) -> Error {
    let tag = element.tag;
    if super::steps::WORDS.contains(&tag) {
        return misplaced(element, "inside <transform>");
    }
    let known: Vec<_> = [&TAGS[1..], &DIRECTIONS, &values::ROWS.names()].concat();
    let instead = substitutes::of_plugin(tag, None).map(|instead| format!("{instead}; "));
    let hint = instead.unwrap_or_else(|| nearest(tag, &known));
    let remedy = format!("{hint}known: {}", known.join(", "));
    Error::new(&element.location, "a tag of Mitsuba's scene format", format!("<{tag}>"), remedy)
}
