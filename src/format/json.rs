//! The JSON format: the dictionary that `mitsuba.load_dict` takes, written as JSON.
//!
//! ```json
//! {
//!   "type": "scene",
//!   "$defaults": { "res": 48, "maps": "textures" },
//!   "fog": { "type": "homogeneous", "sigma_t": 0.5, "albedo": { "type": "rgb", "value": [0.9, 0.8, 0.7] } },
//!   "camera": {
//!     "type": "perspective",
//!     "to_world": [{ "type": "lookat", "origin": [0, 1, 4], "target": [0, 1, 0], "up": [0, 1, 0] }],
//!     "film": { "type": "hdrfilm", "width": "$res", "height": "$res" },
//!     "medium": { "type": "ref", "id": "fog" }
//!   }
//! }
//! ```
//!
//! | JSON | is |
//! |---|---|
//! | a number, `true`, `false`, a string | itself |
//! | `[x, y, z]` | a point or vector |
//! | `[{step}, ...]` | a transform; steps in order, in XML's words: `translate`, `rotate`, `scale`, `lookat`, `matrix` |
//! | `[[...], ...]` | a transform by its matrix, row by row |
//! | `{"type": "rgb", "value": ...}` | a linear colour: a number, three, or `"#rrggbb"` (sRGB-encoded) |
//! | `{"type": "spectrum", "value": ...}` | a number or `[[wavelength in nm, value], ...]`; or a `"filename"` |
//! | `{"type": "keyframes", "value": [[time in s, value], ...]}` | a value of numbers that changes in time: a number, vector, colour, transform, or string of numbers; with `"interpolation": "smooth"` it eases in and out |
//! | `{"type": "ref", "id": ...}` | a reference to the object with that id |
//! | `{"type": ..., ...}` | a plugin |
//!
//! A plugin that Tyndall does not know may state its XML tag in `"$tag"`, which converting needs.
//!
//! The outermost object is a `scene`. Its direct children have their key as id; where one has an `"id"` of its
//! own, either name leads to it. Objects further in have an id only if they say so.
//!
//! Keys that begin with `//`, and `$schema`, are comments.
//!
//! `$defaults`, at the top of the scene only, is Tyndall's own: parameters with their defaults, each a number,
//! a boolean or a string. A value that is just `"$name"` becomes what the parameter is, number or not; inside a
//! longer string the parameter's text is put in its place (`"$maps/brick.png"`). `-D name=value` on the command
//! line overrides a default, with a value of the same kind (a number with a point stays one: `-D x=3` for
//! `"x": 0.5` is 3.0). `\$` (in JSON: `"\\$"`) is a dollar sign.

mod document;
mod node;
mod transform;
mod values;

use super::{
    draft::{Alias, Draft},
    parameters::Parameters,
    tags::TAGS,
    text,
};
use crate::{
    description::{Object, Property, Value, nearest},
    error::{Error, Result},
};
use document::Json;
use node::Node;
use std::{
    collections::{BTreeSet, HashSet},
    path::Path,
    sync::Arc,
};

/// Reads the scene at `path`.
pub(super) fn read(path: &Path, parameters: &mut Parameters) -> Result<Draft> {
    let file = Arc::new(path.to_owned());
    let mut json = document::parse(&file, &text::of_file(path)?)?;
    document::substitute(&mut json, &file, parameters)?;
    let node = Node::root(file, &json);
    if node.type_name()? != "scene" {
        let found = format!("\"{}\"", node.type_name()?);
        let remedy = "wrap everything in {\"type\": \"scene\", ...}";
        return Err(Error::new(&node.location, "the type \"scene\" outermost", found, remedy));
    }
    scene(&node)
}

/// The outermost object, whose children have their keys as ids.
fn scene(node: &Node) -> Result<Draft> {
    let mut root = object(node)?;
    let mut aliases = Vec::new();
    for Property { name, value, location } in &mut root.properties {
        let Value::Object(child) = value else { continue };
        match &child.id {
            None => child.id = Some(name.clone()),
            Some(id) if id == name => {}
            Some(id) => {
                let (name, target) = (name.clone(), id.clone());
                aliases.push(Alias { name, target, location: location.clone() });
            }
        }
    }
    Ok(Draft { root, aliases, included: BTreeSet::new(), found: HashSet::new() })
}

/// A plugin with all that is in it.
fn object(node: &Node) -> Result<Object> {
    let plugin = node.type_name()?.to_owned();
    let mut object =
        Object { tag: None, plugin, id: None, properties: Vec::new(), location: node.location.clone() };
    for child in node.entries()? {
        match child.name.as_str() {
            "type" => {}
            TAG => object.tag = Some(tag(&child.node)?),
            "id" => object.id = Some(child.node.string()?.to_owned()),
            name => {
                let value = value(&child.node)?;
                object.properties.push(Property { name: name.into(), value, location: child.node.location });
            }
        }
    }
    Ok(object)
}

/// The key of an object's tag in XML.
const TAG: &str = "$tag";

fn tag(node: &Node) -> Result<String> {
    let word = node.string()?;
    if TAGS[1..].contains(&word) {
        return Ok(word.to_owned());
    }
    let remedy = format!("{}known: {}", nearest(word, &TAGS[1..]), TAGS[1..].join(", "));
    Err(Error::new(&node.location, "a tag of Mitsuba's XML", format!("\"{word}\""), remedy))
}

/// Whatever can serve as a key.
fn value(node: &Node) -> Result<Value> {
    match node.json {
        Json::Boolean(b) => Ok(Value::Boolean(*b)),
        Json::Integer(i) => Ok(Value::Integer(*i)),
        Json::Float(x) => Ok(Value::Float(*x)),
        Json::String(s) => Ok(Value::String(s.clone())),
        Json::Array(items) if items.iter().all(|item| matches!(item, Json::Object(_))) => {
            node.items()?.iter().map(transform::step).collect::<Result<_>>().map(Value::Transform)
        }
        Json::Array(items) if items.iter().all(|item| matches!(item, Json::Array(_))) => {
            transform::matrix(node).map(|step| Value::Transform(vec![step]))
        }
        Json::Array(_) => node.vector().map(Value::Vector),
        Json::Object(_) => match node.type_name()? {
            "ref" => values::reference(node),
            "rgb" => values::rgb(node),
            "spectrum" => values::spectrum(node),
            "keyframes" => values::keyframes(node),
            step if super::steps::WORDS.contains(&step) => {
                let found = format!("one step, a {step}");
                let remedy = "put [ and ] around it";
                Err(Error::new(&node.location, "a list of transform steps", found, remedy))
            }
            _ => object(node).map(Value::Object),
        },
        Json::Null => {
            let remedy = "remove the key to use the default";
            Err(Error::new(&node.location, "a value", "null", remedy))
        }
    }
}
