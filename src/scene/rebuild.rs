//! A scene built again for another moment: parts with unchanged descriptions are reused. Building is deterministic, so
//! that this changes no bit of the scene.

use super::{
    accel::Geometry,
    build::{Base, Setup},
    contact::Apart,
    shutter::drifts,
};
use crate::{
    bsdf::Bsdf,
    description::{Library, Location, Object, Value},
    emitter::Emitter,
    error::Result,
    math::DVec3,
    medium::MediumDescription,
    shape::Shape,
};
use std::{cell::RefCell, collections::HashMap};

/// Numbers of things, by the location of their description.
pub(super) type Numbers = HashMap<Location, usize>;

/// What a scene was built from, and the parts that were built.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// The number of each shape in the geometry,
    pub shapes: Numbers,
    /// of each BSDF in the scene,
    pub bsdfs: Numbers,
    /// of each emitter among its lights.
    pub emitters: Numbers,
    /// Media as they were read.
    pub media: HashMap<Location, MediumDescription>,
    /// What instances share, by the shape in the group.
    pub bases: HashMap<Location, Base>,
}

/// What was built before.
pub(super) struct Before<'a> {
    setup: &'a Setup,
    /// Where the origin is to stay, in the file's coordinates (m); none if it goes with the camera.
    pub recentre: Option<DVec3>,
    /// What it was built from.
    objects: HashMap<Key<'a>, &'a Object>,
    library: Library,
    /// By id, whether the object's description is unchanged.
    known: RefCell<HashMap<String, bool>>,
}

/// Place and plugin: the objects that smoke was replaced by share a place.
type Key<'a> = (&'a Location, &'a str);

fn key(object: &Object) -> Key<'_> {
    (&object.location, &object.plugin)
}

fn collect<'a>(object: &'a Object, all: &mut HashMap<Key<'a>, &'a Object>) {
    all.insert(key(object), object);
    for property in &object.properties {
        if let Value::Object(child) = &property.value {
            collect(child, all);
        }
    }
}

/// What an object says itself, without what it holds or refers to.
fn own(object: &Object) -> impl Iterator<Item = (&String, &Value)> {
    let own = |value: &Value| !matches!(value, Value::Object(_) | Value::Reference(_));
    object
        .properties
        .iter()
        .map(|property| (&property.name, &property.value))
        .filter(move |(_, value)| own(value))
}

impl<'a> Before<'a> {
    /// `setup` was built before.
    pub(super) fn new(setup: &'a Setup) -> Result<Self> {
        let library = Library::new(&setup.root)?;
        let mut objects = HashMap::new();
        collect(&setup.root, &mut objects);
        Ok(Self { setup, recentre: None, objects, library, known: RefCell::default() })
    }

    /// The same for a scene whose origin stays.
    pub(super) fn in_place(self) -> Self {
        Self { recentre: Some(self.setup.scene.recentre), ..self }
    }

    /// The geometry of then, if it has `shapes` shapes, and what was set apart in it.
    pub(super) fn geometry(&self, shapes: usize) -> Option<(&'a Geometry, &'a Apart)> {
        let geometry = &self.setup.scene.geometry;
        (geometry.shapes().len() == shapes).then_some((geometry, &self.setup.apart))
    }

    /// The shape that `object` describes, whatever its surface and the media beside it.
    pub(super) fn shape(&self, object: &Object, recentre: DVec3) -> Option<&'a Shape> {
        let before = self.objects.get(&key(object))?;
        let index = *self.setup.parts.shapes.get(&object.location)?;
        let is_same = self.setup.scene.recentre == recentre && own(before).eq(own(object));
        let given = self.setup.apart.given.get(&(index as u32));
        is_same.then(|| given.or_else(|| self.setup.scene.geometry.shapes().get(index)))?
    }

    /// What instances of the shape that `object` describes share.
    pub(super) fn base(&self, object: &Object) -> Option<&'a Base> {
        let before = self.objects.get(&key(object))?;
        own(before).eq(own(object)).then(|| self.setup.parts.bases.get(&object.location))?
    }

    /// The BSDF that it describes.
    pub(super) fn bsdf(&self, object: &Object, library: &Library) -> Option<&'a Bsdf> {
        let index = *self.setup.parts.bsdfs.get(&object.location)?;
        self.is_same(object, library).then(|| self.setup.scene.bsdfs.get(index))?
    }

    /// The emitter.
    pub(super) fn emitter(&self, object: &Object, library: &Library) -> Option<&'a Emitter> {
        let index = *self.setup.parts.emitters.get(&object.location)?;
        let light = self.is_same(object, library).then(|| self.setup.scene.lights.all.get(index))?;
        light.map(|light| &light.emitter)
    }

    /// The medium.
    pub(super) fn medium(
        &self,
        object: &Object,
        library: &Library,
        recentre: DVec3,
    ) -> Option<&'a MediumDescription> {
        let medium = self.setup.parts.media.get(&object.location)?;
        (self.setup.scene.recentre == recentre && self.is_same(object, library)).then_some(medium)
    }

    fn is_same(&self, object: &Object, library: &Library) -> bool {
        let before = self.objects.get(&key(object));
        before.is_some_and(|before| self.says_same(before, object, library))
    }

    /// True if `now`, with all that it refers to, says the same as `before`, and nothing in it drifts.
    fn says_same(&self, before: &Object, now: &Object, library: &Library) -> bool {
        let is_same = |a: &Value, b: &Value| match (a, b) {
            (Value::Object(a), Value::Object(b)) => self.says_same(a, b, library),
            (Value::Reference(a), Value::Reference(b)) => a == b && self.refers_to_same(b, library),
            (a, b) => a == b,
        };
        let (a, b) = (&before.properties, &now.properties);
        let are_same = || a.iter().zip(b).all(|(a, b)| a.name == b.name && is_same(&a.value, &b.value));
        before.plugin == now.plugin && !drifts(now) && a.len() == b.len() && are_same()
    }

    fn refers_to_same(&self, id: &str, library: &Library) -> bool {
        if let Some(known) = self.known.borrow().get(id) {
            return *known;
        }
        let is_same = match (self.library.find(id), library.find(id)) {
            (Some(before), Some(now)) => self.says_same(before, now, library),
            _ => false,
        };
        self.known.borrow_mut().insert(id.to_owned(), is_same);
        is_same
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        emitter::InfiniteModel,
        format,
        scene::build::{Setup, build_again},
        settings::Overrides,
    };
    use std::{fs, path::Path};

    const SCENE: &str = r#"{"type": "scene", "$defaults": {"when": 0.0}, "time": "$when",
        "camera": {"type": "perspective",
            "to_world": {"type": "keyframes", "value": [
                [2, [{"type": "translate", "value": [0, 0, -5]}]], [3, [{"type": "translate", "value": [0, 1, -5]}]]]}},
        "mesh": {"type": "ply", "filename": "mesh.ply", "interior": {"type": "ref", "id": "fog"}},
        "fog": {"type": "heterogeneous", "sigma_t": {"type": "equipotential",
            "c": {"type": "keyframes", "value": [[0, 1], [2, 2]]}}},
        "sky": {"type": "constant", "radiance": {"type": "keyframes", "value": [[0, 1], [2, 3]]}}}"#;

    const MESH: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
        property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n\
        0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";

    fn frame(scene: &Path, time: &str, before: Option<&Setup>) -> crate::error::Result<Setup> {
        let root = format::read(scene, &[("when".into(), time.into())])?;
        build_again(&root, Overrides::default(), before)
    }

    #[test]
    fn what_stands_still_is_not_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("scene.json");
        fs::write(&scene, SCENE).unwrap();
        fs::write(folder.path().join("mesh.ply"), MESH).unwrap();
        let first = frame(&scene, "0", None).unwrap();
        fs::remove_file(folder.path().join("mesh.ply")).unwrap();
        assert!(frame(&scene, "1", None).is_err());
        let second = frame(&scene, "1", Some(&first)).unwrap();
        let third = frame(&scene, "2", Some(&second)).unwrap();
        let sky = |setup: &Setup| setup.scene.lights.all[0].emitter.environment().unwrap().even_radiance();
        assert!(sky(&first) != sky(&second) && sky(&second) != sky(&third));
        let most = |setup: &Setup| setup.scene.media[1].bound().sigma_t.x;
        assert!(most(&first) > most(&second) && most(&second) > most(&third));
        // Seen from elsewhere, all positions are others.
        assert!(frame(&scene, "2.5", Some(&third)).is_err());
    }
}
