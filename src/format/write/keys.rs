//! Keys for what has no name: JSON gives one to everything.

use super::{
    outline::{Entry, Item, Leaf, Node, made_up},
    unspeakable,
};
use crate::error::Result;
use std::collections::{HashMap, HashSet};

/// Keys of one object's children.
pub(super) struct Keys {
    /// Names that are given, and ids.
    taken: HashSet<String>,
    /// Names given to what is not a plugin: no id can be a key that is one of them.
    values: HashSet<String>,
    ids: HashSet<String>,
    seen: HashMap<String, usize>,
}

impl Keys {
    /// At the top, `ids` are names too, and mean what has them.
    pub(super) fn new(node: &Node, ids: HashSet<String>) -> Result<Self> {
        let (mut taken, mut values) = (ids.clone(), HashSet::new());
        for entry in node.entries.iter().filter(|entry| !entry.name.is_empty()) {
            if !is_key(&entry.name) {
                let found = format!("the name \"{}\"", entry.name);
                let remedy = "rename it: without \".\" or \"$\", and neither \"type\" nor \"id\"";
                return Err(unspeakable(&entry.location, "JSON", found, remedy));
            }
            taken.insert(entry.name.clone());
            if !matches!(entry.item, Item::Object(_)) {
                values.insert(entry.name.clone());
            }
        }
        Ok(Self { taken, values, ids, seen: HashMap::new() })
    }

    /// The key of `entry`, which is in the scene itself if `outermost`.
    pub(super) fn of(&mut self, entry: &Entry, outermost: bool) -> String {
        let id = match &entry.item {
            Item::Object(Node { id: Some(Leaf { value, text: None }), .. }) if outermost => Some(value),
            _ => None,
        };
        let name = Some(&entry.name).filter(|name| !name.is_empty());
        let is_own = |name: &&String| {
            !self.ids.contains(*name) || id == Some(name) || !matches!(entry.item, Item::Object(_))
        };
        if let Some(name) = name.filter(is_own) {
            return name.clone();
        }
        if let Some(id) = id.filter(|id| is_key(id) && !self.values.contains(*id)) {
            return id.clone();
        }
        let count = self.seen.entry(entry.tag.clone()).or_default();
        loop {
            let key = made_up(&entry.tag, *count);
            *count += 1;
            if self.taken.insert(key.clone()) {
                return key;
            }
        }
    }
}

/// True if `name` can be a key in JSON.
pub(super) fn is_key(name: &str) -> bool {
    !name.is_empty() && !name.contains(['.', '$']) && !["type", "id"].contains(&name)
}
