//! References in either format: aliases are resolved, every id refers to one object, and none to itself.

use super::draft::{Alias, DEEPEST, Draft};
use crate::{
    description::{Library, Location, Object, Value, suggest},
    error::{Error, Result},
};
use std::collections::{HashMap, HashSet};

/// More objects than this, every reference counted as a copy, is a scene that could never be built.
const LARGEST: u64 = 100_000_000;

/// Replaces second names by ids in all references, then checks the whole tree.
pub(super) fn settle(draft: &mut Draft) -> Result<()> {
    let names = targets(&draft.root, std::mem::take(&mut draft.aliases))?;
    rename(&mut draft.root, &names);
    let library = Library::new(&draft.root)?;
    Survey { library: &library, open: Vec::new(), extents: HashMap::new() }.object(&draft.root)?;
    Ok(())
}

/// What each second name finally refers to.
fn targets(root: &Object, aliases: Vec<Alias>) -> Result<HashMap<String, String>> {
    let mut names = HashMap::new();
    if aliases.is_empty() {
        return Ok(names);
    }
    let mut ids = HashSet::new();
    collect_ids(root, &mut ids);
    for Alias { name, target, location } in aliases {
        if names.contains_key(&name) || ids.contains(name.as_str()) {
            let found = format!("\"{name}\" again");
            return Err(Error::new(location, "a name not used before", found, "choose another name"));
        }
        let Some(id) = names.get(&target).map(String::as_str).or(ids.get(target.as_str()).copied()) else {
            let mut ids: Vec<_> = ids.into_iter().collect();
            ids.sort_unstable();
            let remedy = suggest(&target, "known ids", &ids);
            return Err(Error::new(location, "the id of an object", format!("\"{target}\""), remedy));
        };
        let id = id.to_owned();
        names.insert(name, id);
    }
    Ok(names)
}

fn collect_ids<'a>(object: &'a Object, ids: &mut HashSet<&'a str>) {
    ids.extend(object.id.as_deref());
    for property in &object.properties {
        if let Value::Object(child) = &property.value {
            collect_ids(child, ids);
        }
    }
}

/// All ids that something in `root` refers to.
pub(crate) fn referred(root: &Object) -> HashSet<&str> {
    let mut ids = HashSet::new();
    let mut open = vec![root];
    while let Some(object) = open.pop() {
        for property in &object.properties {
            match &property.value {
                Value::Object(child) => open.push(child),
                Value::Reference(id) => drop(ids.insert(id.as_str())),
                _ => {}
            }
        }
    }
    ids
}

fn rename(object: &mut Object, names: &HashMap<String, String>) {
    for property in &mut object.properties {
        match &mut property.value {
            Value::Object(child) => rename(child, names),
            Value::Reference(id) => {
                if let Some(target) = names.get(id) {
                    id.clone_from(target);
                }
            }
            _ => {}
        }
    }
}

/// What hangs below an object, every reference counted as a copy of what it leads to.
#[derive(Clone, Copy)]
struct Extent {
    depth: usize,
    size: u64,
}

/// One walk along all children and references.
struct Survey<'a> {
    library: &'a Library,
    /// The ids of the objects that the walk is in.
    open: Vec<&'a str>,
    extents: HashMap<&'a str, Extent>,
}

impl<'a> Survey<'a> {
    fn object(&mut self, object: &'a Object) -> Result<Extent> {
        if let Some(known) = object.id.as_deref().and_then(|id| self.extents.get(id)) {
            return Ok(*known);
        }
        self.open.extend(object.id.as_deref());
        let mut extent = Extent { depth: 1, size: 1 };
        for property in &object.properties {
            let below = match &property.value {
                Value::Object(child) => self.object(child)?,
                Value::Reference(id) => self.reference(id, &property.location)?,
                _ => continue,
            };
            extent.depth = extent.depth.max(below.depth + 1);
            extent.size = extent.size.saturating_add(below.size);
            check(extent, &property.location)?;
        }
        if let Some(id) = object.id.as_deref() {
            self.open.pop();
            self.extents.insert(id, extent);
        }
        Ok(extent)
    }

    fn reference(&mut self, id: &str, location: &Location) -> Result<Extent> {
        let target = self.library.resolve(id, location)?;
        if let Some(first) = self.open.iter().position(|open| *open == id) {
            let circle = format!("the circular reference {} -> {id}", self.open[first..].join(" -> "));
            let remedy = "give one of them what it needs without referring back";
            return Err(Error::new(location, "an object that does not contain itself", circle, remedy));
        }
        // Each open id is one step of the way here, so this bounds the walk's own recursion.
        check(Extent { depth: self.open.len(), size: 1 }, location)?;
        self.object(target)
    }
}

fn check(extent: Extent, location: &Location) -> Result<()> {
    if extent.depth > DEEPEST {
        let expected = format!("objects and references at most {DEEPEST} deep");
        return Err(Error::new(location, expected, "deeper nesting", "flatten the scene"));
    }
    if extent.size > LARGEST {
        let expected = format!("at most {LARGEST} objects, each reference counted as a copy");
        return Err(Error::new(location, expected, "more", "refer to fewer objects that refer to others"));
    }
    Ok(())
}
