//! `smoke`: a volume file as a user of Blender or Houdini has it, put into a scene like a shape.
//!
//! It is no model of its own. Before anything is built, it is replaced by twenty lines of ordinary scene: a `cube` of
//! `null` around the grid's box, whose interior is a medium made of `gridvolume`s. Nothing else knows of it.

mod parameters;
mod parts;
mod taken;
#[cfg(test)]
mod tests;

use super::shutter::Shutter;
use crate::{
    description::{Kept, Library, Object, Params, Property, Value},
    error::Result,
    math::{DMat4, DVec3},
    sensor,
    shape::{SMOKE, SMOKE_TABLE},
    volume::{
        files::{
            Label,
            roles::Roles,
            sequence::{Clock, Sequence},
        },
        grid::{Catalogue, FARTHEST, Held, Velocities, too_far},
    },
};
use parameters::{Parameters, Up};
use std::borrow::Cow;
pub use taken::{Glow, Taken};

/// True if some smoke in `root` is of numbered files, and so depends on the time.
pub fn has_sequence(root: &Object) -> bool {
    smokes(root).any(|smoke| {
        let named = smoke.properties.iter().find(|property| property.name == "filename");
        let path = named.and_then(|property| match &property.value {
            Value::String(name) => Some(Library::default().file(name, &property.location)),
            _ => None,
        });
        path.is_some_and(|path| Sequence::new(&path, Clock::of(smoke)).is_some())
    })
}

/// When the scene is seen, as it says itself (s).
pub fn time_of(root: &Object) -> f64 {
    root.number("time").unwrap_or(0.0)
}

/// All smoke, that in groups too.
fn smokes(object: &Object) -> Box<dyn Iterator<Item = &Object> + '_> {
    Box::new(object.properties.iter().flat_map(|property| match &property.value {
        Value::Object(child) if child.plugin == SMOKE => Box::new(std::iter::once(child)),
        Value::Object(child) => smokes(child),
        _ => Box::new(std::iter::empty()),
    }))
}

/// `root` with all smoke in it replaced, and what the smoke was made of. Smoke has room to move while the `shutter` is
/// open. Contents of files are `kept`.
pub(super) fn expand<'a>(
    root: &'a Object,
    shutter: Shutter,
    kept: &Kept,
) -> Result<(Cow<'a, Object>, Vec<Taken>)> {
    if smokes(root).next().is_none() {
        return Ok((Cow::Borrowed(root), vec![]));
    }
    let mut library = Library::new(root)?;
    library.kept = kept.clone();
    let time = Params::new(root, &library, &super::TABLE).float("time")?;
    let replaced = Replaced { is_y_up: is_y_up(root), shutter, ..Replaced::default() };
    let (mut expanded, mut replaced) = (root.clone(), replaced);
    replaced.below(&mut expanded, &library, time)?;
    expanded.properties.extend(replaced.media);
    Ok((Cow::Owned(expanded), replaced.all))
}

/// What smoke was replaced by.
#[derive(Default)]
struct Replaced {
    /// +y is up in the scene.
    is_y_up: bool,
    shutter: Shutter,
    /// The media in it: children of the scene.
    media: Vec<Property>,
    /// What it was made of.
    all: Vec<Taken>,
}

impl Replaced {
    /// Replaces all smoke below `object`.
    fn below(&mut self, object: &mut Object, library: &Library, time: f64) -> Result<()> {
        for property in &mut object.properties {
            let Value::Object(child) = &mut property.value else { continue };
            if child.plugin != SMOKE {
                self.below(child, library, time)?;
                continue;
            }
            let (object, medium, taken) = container(child, library, time, self)?;
            *child = object;
            let of_medium = |medium| Property { value: Value::Object(medium), ..property.clone() };
            self.media.extend(medium.map(of_medium));
            self.all.push(taken);
        }
        Ok(())
    }
}

/// True unless the first camera has +z up, as in scenes from Blender, which take Blender's files unturned.
fn is_y_up(root: &Object) -> bool {
    let sensor = root.properties.iter().find_map(|property| match &property.value {
        Value::Object(child) => Some(child).filter(|child| sensor::ROWS.has(child)),
        _ => None,
    });
    let given = sensor.and_then(|sensor| sensor.properties.iter().find(|given| given.name == "to_world"));
    let Some(Value::Transform(steps)) = given.map(|property| &property.value) else { return true };
    let to_world = steps.iter().fold(DMat4::IDENTITY, |before, step| step.matrix() * before);
    let up = to_world.transform_vector3(DVec3::Y);
    up.z.abs() <= up.y.abs()
}

/// The shape that `smoke` stands for, its medium, and what they were made of. A file with +z up is turned where
/// necessary, unless the scene turns it.
fn container(
    smoke: &Object,
    library: &Library,
    time: f64,
    around: &Replaced,
) -> Result<(Object, Option<Object>, Taken)> {
    let params = Params::new(smoke, library, &SMOKE_TABLE);
    let mut given = Parameters::read(&params, time)?;
    params.finish()?;
    let moves = around.shutter != Shutter::default();
    let key = format!("{} {:?} {moves}", given.file.path.display(), given.wanted);
    let read = library.kept.recall(key, || Read::of(&given, moves))?;
    let Read { labels, held, velocities, .. } = &*read;
    let Held { roles, density, fire, empty } = held;
    let boxes = density.iter().chain(fire).map(|contents| contents.domain);
    let Some([low, high]) = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) else {
        return Err(given.nothing_left());
    };
    let hottest = roles.temperature.zip(fire.as_ref()).map(|(number, fire)| (number, fire.hottest()));
    let glow = hottest.map(|(number, hottest)| given.glow(&labels[number], hottest));
    if given.up == Up::Auto && read.is_z_up && around.is_y_up && !given.is_turned() {
        given.up = Up::Z;
    }
    given.velocity_scale = given.velocity_scale.or(velocities.unit);
    let scale = given.velocity_scale.unwrap_or(1.0);
    let room = around.shutter.ways(velocities.bounds.map(|bound| scale * bound));
    let times = (room[1].max(-room[0]) / (high - low)).max_element();
    if times > FARTHEST {
        return Err(too_far(times).at(given.location));
    }
    let taken = Taken::new(smoke, &given, labels, roles, empty, glow);
    let (object, medium) = parts::container(smoke, &given, &taken, [low + room[0], high + room[1]]);
    Ok((object, medium, taken))
}

/// What a file holds.
struct Read {
    labels: Vec<Label>,
    is_z_up: bool,
    held: Held,
    /// Its velocities, where it `moves`.
    velocities: Velocities,
}

impl Read {
    fn of(given: &Parameters<'_>, moves: bool) -> Result<Self> {
        let mut file = Catalogue::open(&given.file.path)?;
        let roles =
            Roles::of_file(&file.labels, given.wanted).map_err(|problem| problem.at(given.location))?;
        let mut held = file.held(roles)?;
        if !moves {
            held.roles.velocity.clear();
        }
        let velocities = file.velocities(&held.roles.velocity)?;
        Ok(Self { is_z_up: file.is_z_up(), labels: file.labels, held, velocities })
    }
}
