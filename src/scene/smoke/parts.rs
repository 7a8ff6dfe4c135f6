//! The objects that smoke is replaced by, as a user would have written them.

use super::{
    Glow, Taken,
    parameters::{Parameters, Up},
};
use crate::{
    description::{Location, Object, Property, TransformStep, Value},
    math::{DVec3, Spectrum},
};

/// Objects at the place of the smoke that they are a part of.
struct Maker<'a> {
    given: &'a Parameters<'a>,
    taken: &'a Taken,
    location: &'a Location,
}

/// The boundary around the box from `low` to `high` of the file's world; and the medium in it, where that has a name by
/// which the boundary and others may refer to it.
pub(super) fn container(
    smoke: &Object,
    given: &Parameters<'_>,
    taken: &Taken,
    [low, high]: [DVec3; 2],
) -> (Object, Option<Object>) {
    let maker = Maker { given, taken, location: &smoke.location };
    let fit = [
        TransformStep::Scale((0.5 * (high - low)).to_array()),
        TransformStep::Translate((0.5 * (low + high)).to_array()),
    ];
    let steps = fit.into_iter().chain(maker.to_world()).collect();
    let medium = Object { id: smoke.id.clone(), ..maker.medium() };
    let (interior, medium) = match &smoke.id {
        None => (Value::Object(medium), None),
        Some(id) => (Value::Reference(id.clone()), Some(medium)),
    };
    let mut parts = vec![
        maker.property("to_world", Value::Transform(steps)),
        maker.property("bsdf", Value::Object(maker.plugin("null", vec![]))),
        maker.property("interior", interior),
    ];
    parts.extend(given.exterior.cloned());
    let id = smoke.id.as_ref().map(|id| format!("{id} (its box)"));
    (Object { id, ..maker.plugin("cube", parts) }, medium)
}

impl Maker<'_> {
    fn property(&self, name: &str, value: Value) -> Property {
        Property { name: name.to_owned(), value, location: self.location.clone() }
    }

    fn plugin(&self, plugin: &str, properties: Vec<Property>) -> Object {
        Object { tag: None, plugin: plugin.to_owned(), id: None, properties, location: self.location.clone() }
    }

    /// From the file's world to the scene's.
    fn to_world(&self) -> Vec<TransformStep> {
        let turn = (self.given.up == Up::Z).then_some(TransformStep::Z_TO_Y);
        turn.into_iter().chain(self.given.to_world.iter().cloned()).collect()
    }

    fn medium(&self) -> Object {
        let mut parts = match &self.taken.density {
            Some(density) => self.smoke(density),
            None => vec![self.property("sigma_t", Value::Float(0.0))],
        };
        parts.extend(self.given.phase.cloned());
        if let Some(glow) = &self.taken.glow {
            parts.push(self.property("emission", Value::Object(self.light(glow))));
            parts.push(self.property("emission_scale", Value::Float(self.given.emission_scale)));
            let group = self.given.group.clone();
            parts.extend(group.map(|name| self.property("group", Value::String(name))));
        }
        let plugin = if self.taken.density.is_some() { "heterogeneous" } else { "homogeneous" };
        self.plugin(plugin, parts)
    }

    fn smoke(&self, density: &str) -> Vec<Property> {
        let fog = self.taken.is_surface.then(|| self.property("convert", Value::String("fog".to_owned())));
        vec![
            self.property("sigma_t", Value::Object(self.grid(density, fog.into_iter().collect()))),
            self.property("scale", Value::Float(self.given.density_scale)),
            self.property("albedo", self.albedo()),
        ]
    }

    fn light(&self, glow: &Glow) -> Object {
        let convert = vec![
            self.property("convert", Value::String("blackbody".to_owned())),
            self.property("temperature_scale", Value::Float(glow.scale)),
            self.property("temperature_offset", Value::Float(glow.offset)),
        ];
        self.grid(&glow.grid, convert)
    }

    /// The grid called `name`; the only one of a file where grids have no names.
    fn grid(&self, name: &str, convert: Vec<Property>) -> Object {
        let mut parts = vec![
            self.property("filename", Value::String(self.given.file.name.clone())),
            self.property("use_grid_bbox", Value::Boolean(true)),
            self.property("to_world", Value::Transform(self.to_world())),
        ];
        if !name.is_empty() {
            parts.push(self.property("grid", Value::String(name.to_owned())));
        }
        if !self.taken.velocity.is_empty() {
            parts.push(self.property("velocity_grid", Value::String(self.taken.velocity.join(","))));
            let scale = self.given.velocity_scale;
            parts.extend(scale.map(|scale| self.property("velocity_scale", Value::Float(scale))));
        }
        parts.extend(convert);
        self.plugin("gridvolume", parts)
    }

    fn albedo(&self) -> Value {
        let factor = self.given.albedo.unwrap_or(Spectrum::ONE);
        match self.taken.color.as_slice() {
            [] => Value::Rgb(rgb(self.given.albedo.unwrap_or(Spectrum::splat(0.75)))),
            [one] if factor == Spectrum::ONE => Value::Object(self.grid(one, vec![])),
            [one] => Value::Object(self.times(factor, one)),
            several => {
                let channels = [Spectrum::X, Spectrum::Y, Spectrum::Z];
                let terms =
                    channels.iter().zip(several).map(|(channel, name)| self.times(*channel * factor, name));
                let terms = terms.map(|term| self.property("", Value::Object(term))).collect();
                Value::Object(self.plugin("sum", terms))
            }
        }
    }

    /// The grid called `name` times a colour.
    fn times(&self, factor: Spectrum, name: &str) -> Object {
        let factor = self.plugin("constvolume", vec![self.property("value", Value::Rgb(rgb(factor)))]);
        let parts = [factor, self.grid(name, vec![])];
        self.plugin("product", parts.map(|part| self.property("", Value::Object(part))).into())
    }
}

fn rgb(colour: Spectrum) -> [f64; 3] {
    colour.to_array().map(f64::from)
}
