//! The tree of a scene as a file in another folder spells it: every object has its tag, only names with a meaning stay,
//! and names of files start at that folder.

use super::{
    super::{paths, tags},
    keys,
};
use crate::{
    description::{Location, Object, Property, Value},
    error::{Error, Result},
};
use std::{collections::HashSet, path::Path};

/// The tree `root` for a file in `folder`, and how many names of files have changed. Files named at the places in `found`
/// lie elsewhere than the file that names them.
pub(super) fn arrange(root: &Object, found: &HashSet<Location>, folder: &Path) -> Result<(Object, usize)> {
    let mut arranged = root.clone();
    let mut target = Target { found, folder, moved: 0 };
    target.fit(&mut arranged, "scene".to_owned())?;
    // It was read from JSON, where everything has a key.
    if root.tag.is_none() {
        keys::drop_made_up(&mut arranged);
    }
    Ok((arranged, target.moved))
}

/// Where a tree is to be written.
struct Target<'a> {
    found: &'a HashSet<Location>,
    folder: &'a Path,
    /// How many names of files have changed.
    moved: usize,
}

impl Target<'_> {
    fn fit(&mut self, object: &mut Object, tag: String) -> Result<()> {
        object.properties.retain(|property| !matches!(property.value, Value::Note(_)));
        for Property { name, value, location } in &mut object.properties {
            match value {
                Value::Object(child) => {
                    let tag = tag_of(child, name, &tag)?;
                    self.fit(child, tag)?;
                }
                Value::String(file) if name.ends_with("filename") => self.name(file, location)?,
                _ => {}
            }
        }
        object.tag = Some(tag);
        Ok(())
    }

    /// A relative name starts at the folder of the scene that gives it.
    fn name(&mut self, file: &mut String, place: &Location) -> Result<()> {
        let home = paths::folder(&place.file);
        let stays = Path::new(file).is_absolute() || paths::relative(home, self.folder, place)? == ".";
        if !stays || self.found.contains(place) {
            *file = paths::relative(&home.join(&*file), self.folder, place)?;
            self.moved += 1;
        }
        Ok(())
    }
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
