use super::*;
use crate::{
    description::{Library, Location, Object, Position, Property, TransformStep, Value},
    math::{DMat4, DVec3, Vec2, offset::leave_surface, vec2, vec3, warp},
    sampling::stream::Purpose,
    shape,
};
use std::sync::Arc;

mod facts;
mod instances;
mod leaving;
mod meshes;
mod toward;
mod tracing;

/// A shape as a scene would describe it.
fn shape_of(plugin: &str, properties: &[(&str, Value)], recentre: DVec3) -> crate::error::Result<Shape> {
    let location = Location { file: Arc::default(), position: Position::Path("$.shape".into()) };
    let property = |(name, value): &(&str, Value)| Property {
        name: (*name).into(),
        value: value.clone(),
        location: location.clone(),
    };
    let properties = properties.iter().map(property).collect();
    let object =
        Object { tag: None, plugin: plugin.into(), id: None, properties, location: location.clone() };
    let library = Library::default();
    let (params, build) = shape::ROWS.read(&object, &library)?;
    let shape = build(&params, DMat4::from_translation(-recentre))?;
    params.finish()?;
    Ok(shape)
}

fn placed(plugin: &str, steps: Vec<TransformStep>) -> Shape {
    shape_of(plugin, &[("to_world", Value::Transform(steps))], DVec3::ZERO).unwrap()
}

fn scale(x: f64, y: f64, z: f64) -> TransformStep {
    TransformStep::Scale([x, y, z])
}

fn turn(axis: [f64; 3], angle: f64) -> TransformStep {
    TransformStep::Rotate { axis, angle }
}

fn shift(x: f64, y: f64, z: f64) -> TransformStep {
    TransformStep::Translate([x, y, z])
}

fn stream(index: u64) -> Stream {
    Stream::new(7, index, 0, Purpose::Study)
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray { origin, direction: direction.normalize(), t_max: f32::INFINITY }
}

/// Uniform in [-`half`, `half`]^3.
fn within(stream: &mut Stream, half: f64) -> DVec3 {
    let mut one = || (f64::from(stream.uniform()) * 2.0 - 1.0) * half;
    DVec3::new(one(), one(), one())
}

/// All shapes that need no file.
const PLUGINS: [&str; 5] = ["rectangle", "cube", "sphere", "disk", "cylinder"];

/// A shape of any kind, of size about `size`, turned anyhow, within `far` of the origin.
fn any_shape(stream: &mut Stream, size: f64, far: f64) -> Shape {
    let plugin = PLUGINS[stream.below(PLUGINS.len())];
    let uneven = within(stream, 0.45) + 0.55;
    let stretch = match plugin {
        "sphere" => DVec3::ONE,
        "cylinder" => DVec3::new(uneven.x, uneven.x, uneven.z),
        _ => uneven,
    };
    let steps = vec![
        scale(stretch.x * size, stretch.y * size, stretch.z * size),
        turn((within(stream, 1.0) + 1e-3).into(), f64::from(stream.uniform()) * 360.0),
        TransformStep::Translate(within(stream, far).into()),
    ];
    placed(plugin, steps)
}
