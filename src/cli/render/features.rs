//! Layers by which a denoiser keeps edges: what surfaces reflect, and where they face.

use crate::{
    description::{Object, Property, Value},
    settings::integrator,
};

/// The plugin that adds layers to an integrator, and these.
const AOV: &str = "aov";
const LAYERS: &str = "albedo:first_albedo,normal:first_normal";

/// The integrator of scenes that have none.
const USUAL: &str = "bdpt";

/// `root` with its integrator inside an `aov`, unless it is one.
pub(super) fn added(mut root: Object) -> Object {
    let location = root.location.clone();
    let plugin = |plugin: &str, properties| {
        let location = location.clone();
        Object { tag: None, plugin: plugin.to_owned(), id: None, properties, location }
    };
    let property = |name: &str, value| Property { name: name.to_owned(), value, location: location.clone() };
    let is_one = |property: &&mut Property| matches!(&property.value, Value::Object(object) if integrator::ROWS.has(object));
    let around = |inner: Object| {
        let layers = property("aovs", Value::String(LAYERS.to_owned()));
        Value::Object(plugin(AOV, vec![layers, property("image", Value::Object(inner))]))
    };
    match root.properties.iter_mut().find(is_one) {
        None => {
            let value = around(plugin(USUAL, vec![]));
            root.properties.push(property("integrator", value));
        }
        Some(Property { value, .. }) => {
            if let Value::Object(own) = value
                && own.plugin != AOV
            {
                *value = around(own.clone());
            }
        }
    }
    root
}
