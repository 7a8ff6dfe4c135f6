//! What a description needs from around it: the objects that carry ids, files, and a place for warnings.

use super::{
    object::{Location, Object, Value},
    registry::suggest,
    warnings::Warnings,
};
use crate::error::{Error, Result};
use crate::math::DVec3;
use std::{
    any::Any,
    cell::{Cell, RefCell},
    collections::HashMap,
    path::{Path, PathBuf},
    sync::{Arc, Mutex, PoisonError},
};

/// All objects with an id, by id, and the warnings gathered while building.
#[derive(Debug, Default)]
pub struct Library {
    objects: HashMap<String, Object>,
    warnings: RefCell<Warnings>,
    /// True if numbers of files that are a hair out of range are refused, not mended.
    pub is_strict: bool,
    /// Smooth glass and metal are as rough as this, if anything.
    pub soften: Option<f64>,
    /// The origin of all positions, in the file's coordinates (m), and the scene's time (s). For parts that are built
    /// from an object and its library alone.
    pub place: Cell<(DVec3, f64)>,
    /// What other moments of the scene read.
    pub kept: Kept,
}

/// What a moving scene has read, by key: shared by all its moments.
#[derive(Clone, Debug, Default)]
pub struct Kept(Arc<Mutex<HashMap<String, Arc<dyn Any + Send + Sync>>>>);

impl Kept {
    /// What there is for `key`, or else what `read` reads.
    pub fn recall<T: Send + Sync + 'static>(
        &self,
        key: String,
        read: impl FnOnce() -> Result<T>,
    ) -> Result<Arc<T>> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let known = kept().get(&key).and_then(|known| Arc::clone(known).downcast().ok());
        if let Some(known) = known {
            return Ok(known);
        }
        let new = Arc::new(read()?);
        kept().insert(key, Arc::clone(&new) as Arc<dyn Any + Send + Sync>);
        Ok(new)
    }
}

impl Library {
    /// Indexes every object under `root` that has an id. Two objects with one id are an error.
    pub fn new(root: &Object) -> Result<Self> {
        let mut library = Self::default();
        library.index(root)?;
        Ok(library)
    }

    fn index(&mut self, object: &Object) -> Result<()> {
        if let Some(id) = &object.id
            && let Some(other) = self.objects.insert(id.clone(), object.clone())
        {
            return Err(Error::new(
                &object.location,
                format!("an id not used before (the first \"{id}\" is at {})", other.location),
                format!("the id \"{id}\" again"),
                "give one of the two another id",
            ));
        }
        object.properties.iter().try_for_each(|property| match &property.value {
            Value::Object(child) => self.index(child),
            Value::Note(text) => {
                self.warn(&property.location, text);
                Ok(())
            }
            _ => Ok(()),
        })
    }

    /// The object called `id`, if there is one.
    pub fn find(&self, id: &str) -> Option<&Object> {
        self.objects.get(id)
    }

    /// The object called `id`, referred to from `location`.
    pub fn resolve(&self, id: &str, location: &Location) -> Result<&Object> {
        self.objects.get(id).ok_or_else(|| {
            let mut known: Vec<&str> = self.objects.keys().map(String::as_str).collect();
            known.sort_unstable();
            Error::new(
                location,
                "the id of an object in this scene",
                format!("\"{id}\""),
                suggest(id, "known ids", &known),
            )
        })
    }

    /// A file named in a scene: relative paths start at the folder of the file that names them.
    pub fn file(&self, name: &str, location: &Location) -> PathBuf {
        location.file.parent().unwrap_or(Path::new("")).join(name)
    }

    /// Informs the user of something that is not an error.
    pub fn warn(&self, location: &Location, text: &str) {
        self.warnings.borrow_mut().add(location.to_string(), text);
    }

    /// Informs the user of something about a file.
    pub fn note(&self, file: &Path, text: &str) {
        self.warnings.borrow_mut().note(file, text);
    }

    /// All warnings so far, in order.
    pub fn take_warnings(&self) -> Vec<String> {
        self.warnings.take().into_lines()
    }
}
