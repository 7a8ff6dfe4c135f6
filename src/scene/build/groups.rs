//! Groups of shapes and their instances, and merged shapes.

use super::Builder;
use crate::{
    description::{Library, Object, Params, Value, params::Child},
    error::{Error, Result},
    format::references,
    math::{DAffine3, DMat4, DVec3},
    memory,
    scene::accel::Geometry,
    shape::{self, BuildShape, Composed, Instance, Shape, ShapeModel as _},
};
use std::{collections::HashMap, sync::Arc};

/// Up to so many instances of a mesh, with so many primitives in all (30 MB), are copies. Copies are faster, and their
/// touching faces are set apart.
const COPIES: u64 = 256;
const COPIED: u64 = 1 << 16;

/// What an instance of a shape takes (bytes).
const MEMORY_PER_INSTANCE: u64 = 1500;

/// What instances share.
#[derive(Default)]
pub(super) struct Bases {
    /// By the shape in the group.
    built: HashMap<*const Object, Base>,
    /// How many shapes instances add to the scene; groups in groups are multiplied out.
    instances: u64,
}

/// A shape centred at the origin; its centre in the group is `middle`.
#[derive(Clone, Debug)]
pub(in crate::scene) struct Base {
    geometry: Arc<Geometry>,
    middle: DVec3,
    is_mesh: bool,
}

/// The instance that a shape is built for.
#[derive(Clone, Copy)]
pub(super) struct Copying<'a> {
    instance: &'a Object,
    /// Takes the group's coordinates to the file's.
    to_file: DMat4,
}

impl Copying<'_> {
    /// The same for volumes.
    pub(super) fn of_volumes(&self) -> DAffine3 {
        DAffine3::from_mat4(self.to_file)
    }
}

impl Bases {
    /// How many primitives all of them have.
    pub(super) fn primitives(&self) -> u64 {
        self.built.values().map(Base::primitives).sum()
    }
}

impl Base {
    fn build(params: &Params<'_>, build: BuildShape) -> Result<Self> {
        let there = build(params, DMat4::IDENTITY)?;
        let bounds = there.bounds();
        let middle = 0.5 * (bounds.low.as_dvec3() + bounds.high.as_dvec3());
        let shape = match middle.length() > f64::from(bounds.size().length()) {
            true => build(params, DMat4::from_translation(-middle))?,
            false => return Ok(Self::new(there, DVec3::ZERO)),
        };
        Ok(Self::new(shape, middle))
    }

    fn new(shape: Shape, middle: DVec3) -> Self {
        let is_mesh = matches!(shape, Shape::Mesh(_));
        Self { geometry: Arc::new(Geometry::build(vec![shape])), middle, is_mesh }
    }

    fn primitives(&self) -> u64 {
        self.geometry.shapes().iter().map(|shape| shape.primitive_count() as u64).sum()
    }

    fn instance(&self, world: DMat4) -> Option<Shape> {
        let world = world * DMat4::from_translation(self.middle);
        Instance::new(self.geometry.clone(), world).map(Shape::Instance)
    }
}

impl<'a> Builder<'a> {
    /// All shapes of the scene.
    pub(super) fn add_shapes(&mut self, root: &'a Object, children: &[Child<'a>]) -> Result<()> {
        self.bases.instances = instances(root, self.library, &mut HashMap::new());
        let size = format!("{} instances of shapes", self.bases.instances);
        let needed = self.bases.instances.checked_mul(MEMORY_PER_INSTANCE);
        memory::check("the scene", "instances", &size, needed, "give fewer instances, or more memory")?;
        let referred = references::referred(root);
        for child in children {
            let is_idle = child.object.id.as_deref().is_none_or(|id| !referred.contains(id));
            if is_idle && is_group(child.object) {
                let text = "this shapegroup is not seen: no instance refers to it";
                self.library.warn(child.location, text);
            }
            self.shape(child, None)?;
        }
        Ok(())
    }

    /// One shape, or all that it is composed of.
    fn shape(&mut self, child: &Child<'a>, at: Option<Copying<'a>>) -> Result<()> {
        match shape::COMPOSED.get(&child.object.plugin).map(|plugin| plugin.build) {
            None | Some(Composed::Smoke) => self.plain(child, at),
            Some(Composed::Group) => Ok(()),
            Some(Composed::Merge) => self.members(child.object, at),
            Some(Composed::Instance) => self.instance(child.object, at),
        }
    }

    fn members(&mut self, object: &'a Object, at: Option<Copying<'a>>) -> Result<()> {
        let (params, _) = shape::COMPOSED.read(object, self.library)?;
        let members = params.children("shape", |child| shape::is_shape(child.object))?;
        params.finish()?;
        if members.is_empty() {
            let expected = format!("shapes in the {}", object.plugin);
            return Err(Error::new(&object.location, expected, "none", "put one or more shapes into it"));
        }
        members.iter().try_for_each(|member| self.shape(member, at))
    }

    fn instance(&mut self, object: &'a Object, at: Option<Copying<'a>>) -> Result<()> {
        let (params, _) = shape::COMPOSED.read(object, self.library)?;
        let to_world = params.transform("to_world")?;
        let children = params.children("shape", |_| true)?;
        params.finish()?;
        if let Some(other) = children.iter().find(|child| !is_group(child.object)) {
            let found = format!("\"{}\"", other.object.plugin);
            let remedy = "put shapes with all that is theirs into a shapegroup, and refer to that";
            return Err(Error::new(other.location, "a shapegroup", found, remedy));
        }
        let [group] = children.as_slice() else {
            let found = format!("{} of them", children.len());
            let remedy = "refer to one shapegroup by its id";
            return Err(Error::new(&object.location, "one shapegroup in the instance", found, remedy));
        };
        let to_file = at.map_or(DMat4::IDENTITY, |at| at.to_file) * to_world;
        self.members(group.object, Some(Copying { instance: object, to_file }))
    }

    /// A shape of a group as one of its instances has it, and whether its parameters were read for that. Meshes that
    /// only scatter are shared where copies would be large. Other shapes are shared where they cannot be copied: a
    /// sphere that is no sphere there.
    pub(super) fn copied(
        &mut self,
        params: &Params<'a>,
        build: BuildShape,
        at: Copying<'a>,
    ) -> Result<(Shape, bool)> {
        let world = self.world() * at.to_file;
        let stays = ["interior", "exterior"].iter().any(|side| params.has(side))
            || !params.children("emitter", |child| crate::emitter::ROWS.has(child.object))?.is_empty();
        if stays {
            let shape = build(params, world).map_err(|error| match build(params, DMat4::IDENTITY) {
                Ok(_) => distorted(at.instance, error),
                Err(error) => error,
            });
            return shape.map(|shape| (shape, true));
        }
        let (base, is_new) = self.base(params, build)?;
        let instances = self.bases.instances;
        let is_large = instances > COPIES || base.primitives().saturating_mul(instances) > COPIED;
        let copy = if base.is_mesh && is_large { None } else { build(params, world).ok() };
        let is_read = is_new || copy.is_some();
        copy.or_else(|| base.instance(world)).map(|shape| (shape, is_read)).ok_or_else(|| {
            let expected = "a transform that can be undone and that f32 can hold";
            Error::new(&at.instance.location, expected, "none", "change \"to_world\" of the instance")
        })
    }

    /// What instances share, and whether it was built now.
    fn base(&mut self, params: &Params<'a>, build: BuildShape) -> Result<(Base, bool)> {
        let key = std::ptr::from_ref(params.object);
        if let Some(known) = self.bases.built.get(&key) {
            return Ok((known.clone(), false));
        }
        let old = self.before.and_then(|before| before.base(params.object)).cloned();
        let is_new = old.is_none();
        let base = old.map_or_else(|| Base::build(params, build), Ok)?;
        self.bases.built.insert(key, base.clone());
        self.parts.bases.insert(params.object.location.clone(), base.clone());
        Ok((base, is_new))
    }
}

/// `error` of a shape with a medium or an emitter that only its `instance` makes wrong.
fn distorted(instance: &Object, error: Error) -> Error {
    let found = format!("{}; it is seen in the instance at {}", error.found, instance.location);
    let remedy =
        format!("{}. Only shapes without medium and emitter may be distorted in an instance", error.remedy);
    Error { found, remedy, ..error }
}

fn is_group(object: &Object) -> bool {
    shape::COMPOSED.get(&object.plugin).is_some_and(|plugin| plugin.build == Composed::Group)
}

/// How many shapes the instances in `object` add to the scene. `known` keeps the counts of groups.
fn instances(object: &Object, library: &Library, known: &mut HashMap<*const Object, u64>) -> u64 {
    let below = object.properties.iter().filter_map(|property| match &property.value {
        Value::Object(child) => Some(child),
        Value::Reference(id) => library.find(id),
        _ => None,
    });
    let is_instance = object.plugin == "instance";
    let mut all = 0u64;
    for child in below.filter(|child| shape::is_shape(child)) {
        let inside = match (is_group(child), is_instance) {
            (true, true) => shapes_of(child, library, known),
            (true, false) => 0,
            (false, _) => instances(child, library, known),
        };
        all = all.saturating_add(inside);
    }
    all
}

/// How many shapes an instance of `group` puts into the scene.
fn shapes_of(group: &Object, library: &Library, known: &mut HashMap<*const Object, u64>) -> u64 {
    let key = std::ptr::from_ref(group);
    if let Some(count) = known.get(&key) {
        return *count;
    }
    let own = group.properties.iter().filter(|property| match &property.value {
        Value::Object(child) => shape::ROWS.has(child),
        _ => false,
    });
    let count = (own.count() as u64).saturating_add(instances(group, library, known));
    known.insert(key, count);
    count
}

#[cfg(test)]
mod tests {
    use crate::{
        format,
        scene::build::{Setup, build},
        settings::Overrides,
        shape::Shape,
    };

    fn built(inside: &str) -> crate::error::Result<Setup> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.json");
        let text = format!(
            r#"{{"type": "scene", "camera": {{"type": "perspective", "to_world": [{{"type": "translate", "value": [0, 0, -30]}}]}}, "sky": {{"type": "constant"}}, {inside}}}"#
        );
        std::fs::write(&path, text).unwrap();
        build(&format::read(&path, &[])?, Overrides::default())
    }

    const FOG: &str = r#"{"type": "cube", "bsdf": {"type": "null"}, "to_world": [{"type": "scale", "value": 2}, $],
        "interior": {"type": "heterogeneous", "sigma_t": {"type": "equipotential", "to_world": [$]}}}"#;

    /// Where a medium is dense tells where it lies.
    #[test]
    fn media_move_with_their_instances() {
        let turn = r#"{"type": "rotate", "axis": [0, 0, 1], "angle": 30}, {"type": "translate", "value": [5, 0, 20]}"#;
        let still = FOG.replace(", $]", "]").replace("$", "");
        let group = format!(
            r#""g": {{"type": "shapegroup", "id": "g", "fog": {still}}},
               "a": {{"type": "instance", "to_world": [{turn}], "x": {{"type": "ref", "id": "g"}}}},
               "b": {{"type": "instance", "x": {{"type": "ref", "id": "g"}}}}"#
        );
        let alone = format!(r#""fog": {}, "b": {}"#, FOG.replace('$', turn), still);
        let extents = |inside: &str| {
            let setup = built(inside).unwrap();
            assert!(setup.warnings.is_empty(), "{:?}", setup.warnings);
            setup.scene.media.iter().map(|medium| medium.extent()).collect::<Vec<_>>()
        };
        let (instanced, alone) = (extents(&group), extents(&alone));
        assert_eq!(instanced.len(), 3);
        assert_eq!(instanced, alone);
    }

    #[test]
    fn groups_may_hold_lamps_and_instances() {
        let setup = built(
            r#""lamp": {"type": "shapegroup", "id": "lamp", "s": {"type": "sphere", "radius": 0.1, "e": {"type": "area"}}},
               "row": {"type": "shapegroup", "id": "row",
                   "a": {"type": "instance", "x": {"type": "ref", "id": "lamp"}},
                   "b": {"type": "instance", "to_world": [{"type": "translate", "value": [1, 0, 0]}], "x": {"type": "ref", "id": "lamp"}}},
               "far": {"type": "instance", "to_world": [{"type": "translate", "value": [0, 0, 9]}], "x": {"type": "ref", "id": "row"}}"#,
        )
        .unwrap();
        let balls = setup.scene.geometry.shapes();
        let at = |shape: &Shape| shape.bounds().low + shape.bounds().high;
        let middles: Vec<_> = balls.iter().map(|ball| (0.5 * at(ball)).round().to_array()).collect();
        assert_eq!(middles, [[0.0, 0.0, 39.0], [1.0, 0.0, 39.0]]);
        assert_eq!(setup.scene.lights.all.len(), 3);
    }
}
