//! The children of a scene by kind.

use super::sensors;
use crate::{
    bsdf,
    description::{Library, Object, Params, Table, params::Child, substitutes, table},
    emitter,
    error::{Error, Result},
    format::{plugins, references, tags},
    math::DVec3,
    medium, sensor,
    settings::{integrator, only_one},
    shape,
    volume::{self, Place},
};

/// The scene's children by kind.
pub(super) struct Sections<'a> {
    /// Who renders it, if the file says.
    pub integrator: Option<&'a Object>,
    /// The one that is rendered: the first.
    pub sensor: &'a Object,
    /// In file order.
    pub shapes: Vec<Child<'a>>,
    /// Those beside the shapes, in file order.
    pub emitters: Vec<Child<'a>>,
    /// When it is seen (s): what drifts in a wind has drifted since 0.
    pub time: f64,
}

/// What a scene holds.
pub(crate) const TABLE: Table = table! {
    "What is rendered.";
    number("time", "s", ANY, Is(0.0), "Time of the image; keyframes and `wind` count from 0.").ours(),
    nested("sensor", Required, "The camera. Of several, the first or the one that `--sensor` names."),
    nested("integrator", Optional, "The integrator; default: `bdpt`."),
    nested("shape", Optional, "Surfaces, and boundaries of media."),
    nested("emitter", Optional, "Emitters that are not on a shape."),
    nested("bsdf", Optional, "For references to its `id`."),
    nested("medium", Optional, "For references to its `id`."),
    nested("phase", Optional, "For references to its `id`."),
    nested("texture", Optional, "For references to its `id`."),
    nested("volume", Optional, "For references to its `id`."),
};

/// True if `object` only waits to be referred to.
fn is_definition(object: &Object) -> bool {
    bsdf::ROWS.has(object)
        || medium::ROWS.has(object)
        || crate::phase::ROWS.has(object)
        || crate::texture::ROWS.has(object)
        || volume::ROWS.has(object)
}

impl<'a> Sections<'a> {
    /// Sorts the children of `root`; one that no scene can hold is an error.
    pub(super) fn sort(root: &'a Object, library: &'a Library) -> Result<Self> {
        let params = Params::new(root, library, &TABLE);
        let time = params.float("time")?;
        let shapes = params.children("shape", |child| shape::is_shape(child.object))?;
        let emitters = params.children("emitter", |child| emitter::ROWS.has(child.object))?;
        let children = params.children("sensor", |child| sensor::ROWS.has(child.object))?;
        let integrators = params.children("integrator", |child| integrator::ROWS.has(child.object))?;
        let definitions = params.children("bsdf", |child| is_definition(child.object))?;
        check_idle(&definitions, root, library, time)?;
        if let Some(unknown) = params.children("bsdf", |_| true)?.iter().find(|child| {
            !(shape::is_shape(child.object)
                || emitter::ROWS.has(child.object)
                || sensor::ROWS.has(child.object)
                || integrator::ROWS.has(child.object)
                || is_definition(child.object))
        }) {
            return Err(misplaced(unknown));
        }
        params.finish()?;
        let sensor = match children.as_slice() {
            [] => return Err(sensors::without_sensor(root)),
            [sensor, ..] => sensor.object,
        };
        sensors::tell(&children, library);
        if let [_, second, ..] = integrators.as_slice() {
            return Err(only_one(second, "integrator"));
        }
        let integrator = integrators.first().map(|child| child.object);
        Ok(Self { integrator, sensor, shapes, emitters, time })
    }

    /// The camera's position in the file's coordinates: it becomes the origin, so that f32 geometry is most
    /// precise where it is seen from nearest, however far from the file's origin that is.
    pub(super) fn viewpoint(&self, library: &Library) -> Result<DVec3> {
        sensor::viewpoint(self.sensor, library)
    }
}

/// Builds a definition that nothing refers to, so that its mistakes are reported. Its position does not matter for
/// that.
fn check_definition(object: &Object, library: &Library, time: f64) -> Result<()> {
    let place = Place::new(DVec3::ZERO, time);
    if bsdf::ROWS.has(object) {
        bsdf::build(object, library).map(drop)
    } else if medium::ROWS.has(object) {
        medium::build(object, library, &place).map(drop)
    } else if crate::phase::ROWS.has(object) {
        crate::phase::build(object, library, &place).map(drop)
    } else if volume::ROWS.has(object) {
        volume::build(object, library, &place).map(drop)
    } else {
        crate::texture::build(object, library, f32::INFINITY).map(drop)
    }
}

/// A plugin that does not exist, that a scene cannot hold, or a sensor that only Mitsuba has.
fn misplaced(child: &Child<'_>) -> Error {
    let plugin = &child.object.plugin;
    let tags = tags::of_plugin(plugin);
    if tags.is_empty() {
        return plugins::unknown_in(child.object, "scene");
    }
    if tags.contains(&"sensor") {
        let found = format!("\"{plugin}\", which only Mitsuba has");
        return Error::new(
            child.location,
            "a sensor of Tyndall",
            found,
            format!("replace it by one of {}", sensor::ROWS.names().join(", ")),
        );
    }
    let found = format!("\"{plugin}\", {}", plugins::kind(tags[0]));
    let moved = "move it into the object that it belongs to (films and samplers into the sensor)";
    let remedy = match substitutes::of_plugin(plugin, None) {
        Some(instead) => format!("{instead}, or {moved}"),
        None => moved.to_owned(),
    };
    Error::new(child.location, "a plugin that belongs in the scene itself", found, remedy)
}

/// Warns about definitions without effect, and checks them. Definitions that are referred to are built elsewhere.
fn check_idle(definitions: &[Child<'_>], root: &Object, library: &Library, time: f64) -> Result<()> {
    let referred = references::referred(root);
    for Child { object, location, .. } in definitions {
        if object.id.as_deref().is_none_or(|id| !referred.contains(id)) {
            let name = object.id.as_deref().unwrap_or(&object.plugin);
            check_definition(object, library, time)?;
            let remedy = if medium::ROWS.has(object) {
                ". Refer to it from a shape (\"interior\" or \"exterior\"), the sensor or an emitter, or remove it"
            } else {
                ""
            };
            library.warn(location, &format!("\"{name}\" is not used: it is never referred to{remedy}"));
        }
    }
    Ok(())
}
