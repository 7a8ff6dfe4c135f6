//! `smoke`: a volume file as a user of Blender or Houdini has it, put into a scene like a shape.
//!
//! It is no model of its own: before anything is built, it is replaced by what twenty lines of a scene would say, a
//! `cube` of `null` around the grid's box whose interior is a medium made of `gridvolume`s. Nothing else knows of it.

mod parameters;
mod parts;
mod taken;

use crate::{
    description::{Library, Object, Params, Value},
    error::Result,
    volume::{
        files::roles::{self, Roles},
        grid::{Catalogue, Contents},
    },
};
use parameters::Parameters;
use std::borrow::Cow;
pub use taken::{Glow, Taken};

/// The name of the plugin.
pub const PLUGIN: &str = "smoke";

/// `root` with all smoke in it replaced, and what that was made of.
pub fn expand(root: &Object) -> Result<(Cow<'_, Object>, Vec<Taken>)> {
    let is_smoke = |value: &Value| matches!(value, Value::Object(child) if child.plugin == PLUGIN);
    if !root.properties.iter().any(|property| is_smoke(&property.value)) {
        return Ok((Cow::Borrowed(root), vec![]));
    }
    let library = Library::new(root)?;
    let time = Params::new(root, &library).float("time", 0.0)?;
    let (mut expanded, mut all) = (root.clone(), vec![]);
    for property in &mut expanded.properties {
        let Value::Object(child) = &mut property.value else { continue };
        if child.plugin == PLUGIN {
            let (object, taken) = container(child, &library, time)?;
            *child = object;
            all.push(taken);
        }
    }
    Ok((Cow::Owned(expanded), all))
}

/// The shape that `smoke` stands for, and what is in it.
fn container(smoke: &Object, library: &Library, time: f64) -> Result<(Object, Taken)> {
    let params = Params::new(smoke, library);
    let given = Parameters::read(&params, time)?;
    params.finish()?;
    let mut file = Catalogue::open(&given.file)?;
    let roles = Roles::of_file(&file.labels, given.wanted).map_err(|problem| problem.at(given.location))?;
    let density = contents(&mut file, roles.density)?;
    let fire = contents(&mut file, roles.temperature)?;
    let boxes = density.iter().chain(&fire).map(|contents| contents.domain);
    let Some([low, high]) = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) else {
        return Err(given.nothing_left());
    };
    let glow = roles.temperature.zip(fire).map(|(number, fire)| {
        let label = &file.labels[number];
        given.glow(label, fire.range[1][0], roles::is_fire(label))
    });
    let taken = Taken::new(smoke, &given, &file, &roles, glow);
    Ok((parts::container(smoke, &given, &taken, [low, high]), taken))
}

fn contents(file: &mut Catalogue, number: Option<usize>) -> Result<Option<Contents>> {
    number.map(|number| file.contents(number)).transpose()
}
