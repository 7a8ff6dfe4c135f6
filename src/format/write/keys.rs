//! Keys for what has no name: JSON gives one to everything.

use super::{super::references::referred, unspeakable};
use crate::{
    description::{Object, Property, Value},
    error::Result,
    format::tags::table,
};
use std::collections::{HashMap, HashSet};

/// The key that JSON gives to the unnamed child that `before` children of the same tag precede.
fn made_up(tag: &str, before: usize) -> String {
    if before == 0 { tag.to_owned() } else { format!("{tag}_{}", before + 1) }
}

/// The tags of all objects that have an id.
pub(super) type Tags = HashMap<String, String>;

/// Those of the objects in `root`, which all have their tags.
pub(super) fn tags(root: &Object) -> Tags {
    let mut tags = HashMap::new();
    let mut open = vec![root];
    while let Some(object) = open.pop() {
        tags.extend(object.id.clone().zip(object.tag.clone()));
        open.extend(object.properties.iter().filter_map(|property| match &property.value {
            Value::Object(child) => Some(child),
            _ => None,
        }));
    }
    tags
}

/// The tag of what `value` is or refers to; none where it is neither.
fn tag_in<'a>(value: &'a Value, tags: &'a Tags) -> Option<&'a str> {
    match value {
        Value::Object(child) => child.tag.as_deref(),
        Value::Reference(id) => Some(tags.get(id).map_or("ref", String::as_str)),
        _ => None,
    }
}

/// Drops names in the scene `root` that only JSON needs: those made up from a tag, and at the top those that repeat the
/// id.
pub(super) fn drop_made_up(root: &mut Object) {
    let tags = tags(root);
    let referred = referred(root).into_iter().map(str::to_owned).collect();
    drop_below(root, &tags, &referred, true);
}

fn drop_below(object: &mut Object, tags: &Tags, referred: &HashSet<String>, outermost: bool) {
    let mut seen: HashMap<String, usize> = HashMap::new();
    let table = table(object.tag.as_deref().unwrap_or_default(), &object.plugin);
    for Property { name, value, .. } in &mut object.properties {
        let Some(tag) = tag_in(value, tags) else { continue };
        let count = seen.entry(tag.to_owned()).or_default();
        // Some have a parameter that is called after its tag: the `texture` of a spot, the `shape` of an irradiance meter.
        let is_parameter = table.is_some_and(|table| table.find(name).is_some());
        let is_made_up = *name == made_up(tag, *count) && !is_parameter;
        let of_id = outermost && matches!(value, Value::Object(child) if child.id.as_ref() == Some(name));
        let is_dropped = is_made_up && !(of_id && referred.contains(name));
        *count += usize::from(is_dropped);
        if is_dropped || of_id {
            name.clear();
        }
        if let Value::Object(child) = value {
            child.id = child.id.take().filter(|_| !(is_dropped && of_id));
            drop_below(child, tags, referred, false);
        }
    }
}

/// Keys of one object's children.
pub(super) struct Keys<'t> {
    /// Names that are given, and ids.
    taken: HashSet<String>,
    /// Names given to what is not a plugin: no id can be a key that is one of them.
    values: HashSet<String>,
    tags: &'t Tags,
    outermost: bool,
    seen: HashMap<String, usize>,
}

impl<'t> Keys<'t> {
    /// Keys in `object`. At the top, ids are names too, and mean what has them.
    pub(super) fn new(object: &Object, tags: &'t Tags, outermost: bool) -> Result<Self> {
        let (mut taken, mut values) = (HashSet::new(), HashSet::new());
        if outermost {
            taken.extend(tags.keys().cloned());
        }
        for Property { name, value, location } in object.properties.iter().filter(|p| !p.name.is_empty()) {
            if !is_key(name) {
                let found = format!("the name \"{name}\"");
                let remedy = "rename it: without \".\" or \"$\", and neither \"type\" nor \"id\"";
                return Err(unspeakable(location, "JSON", found, remedy));
            }
            taken.insert(name.clone());
            if !matches!(value, Value::Object(_)) {
                values.insert(name.clone());
            }
        }
        Ok(Self { taken, values, tags, outermost, seen: HashMap::new() })
    }

    /// The key of `property`.
    pub(super) fn of(&mut self, Property { name, value, .. }: &Property) -> String {
        let id = match value {
            Value::Object(child) if self.outermost => child.id.as_ref(),
            _ => None,
        };
        let is_id = self.outermost && self.tags.contains_key(name);
        let is_own = !is_id || id == Some(name) || !matches!(value, Value::Object(_));
        if !name.is_empty() && is_own {
            return name.clone();
        }
        if let Some(id) = id.filter(|id| is_key(id) && !self.values.contains(*id)) {
            return id.clone();
        }
        let tag = tag_in(value, self.tags).unwrap_or_default();
        let count = self.seen.entry(tag.to_owned()).or_default();
        loop {
            let key = made_up(tag, *count);
            *count += 1;
            if self.taken.insert(key.clone()) {
                return key;
            }
        }
    }
}

/// True if `name` can be a key in JSON.
fn is_key(name: &str) -> bool {
    !name.is_empty() && !name.contains(['.', '$']) && !["type", "id"].contains(&name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        description::{Location, Position, parameter::Kind},
        format::tags::{TAGS, tables},
    };
    use std::sync::Arc;

    fn object(tag: &str, plugin: &str, properties: Vec<Property>) -> Object {
        let location = Location { file: Arc::new("scene".into()), position: Position::Path(String::new()) };
        Object { tag: Some(tag.to_owned()), plugin: plugin.to_owned(), id: None, properties, location }
    }

    /// No reader could tell what an unnamed child is for.
    #[test]
    fn names_of_parameters_are_never_dropped() {
        let rows = TAGS.iter().flat_map(|tag| tables(tag).into_iter().map(move |row| (*tag, row)));
        let mut tested = Vec::new();
        for (tag, (plugin, table)) in rows {
            for row in table.rows() {
                let of = match row.kind {
                    Kind::Object(tag) => tag,
                    Kind::Texture(..) => "texture",
                    Kind::Volume(..) => "volume",
                    _ => continue,
                };
                let child = object(of, "anything", Vec::new());
                let location = child.location.clone();
                let child = Property { name: row.name.to_owned(), value: Value::Object(child), location };
                let mut root = object(
                    "scene",
                    "scene",
                    vec![Property {
                        name: tag.to_owned(),
                        location: child.location.clone(),
                        value: Value::Object(object(tag, plugin, vec![child])),
                    }],
                );
                drop_made_up(&mut root);
                let Value::Object(parent) = &root.properties[0].value else { panic!() };
                assert_eq!(parent.properties[0].name, row.name, "of {plugin}");
                tested.extend((row.name == of).then_some(plugin));
            }
        }
        for plugin in ["spot", "irradiancemeter", "volume"] {
            assert!(tested.contains(&plugin), "{plugin}: {tested:?}");
        }
    }
}
