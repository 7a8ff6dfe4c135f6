//! Which of a scene's sensors is rendered: the first, unless another is chosen.

use super::batch;
use crate::{
    description::{Library, Object, Position, Value, params::Child, suggest},
    error::{Error, Result},
    sensor,
};

/// `root` with the one sensor that `wanted` names, by its id or by its number from 0 in file order.
pub fn only(root: &Object, wanted: &str) -> Result<Object> {
    let mut root = batch::expand(root)?.into_owned();
    let ids: Vec<Option<String>> = sensors(&root).map(|sensor| sensor.id.clone()).collect();
    let by_id = ids.iter().position(|id| id.as_deref() == Some(wanted));
    let by_number = || wanted.parse().ok().filter(|number| *number < ids.len());
    let Some(chosen) = by_id.or_else(by_number) else { return Err(unknown(&root, wanted, &ids)) };
    let mut number = 0;
    root.properties.retain(|property| {
        let Some(_) = sensor_in(&property.value) else { return true };
        number += 1;
        number == chosen + 1
    });
    Ok(root)
}

/// What `--sensor` calls each sensor of `root`, which has one or more: its id, or its number.
pub fn names(root: &Object) -> Result<Vec<String>> {
    let root = batch::expand(root)?;
    let name = |(number, sensor): (usize, &Object)| sensor.id.clone().unwrap_or_else(|| number.to_string());
    let names: Vec<String> = sensors(&root).enumerate().map(name).collect();
    if names.is_empty() { Err(without_sensor(&root)) } else { Ok(names) }
}

/// Says which of several `sensors` is rendered.
pub fn tell(sensors: &[Child<'_>], library: &Library) {
    let name = |(number, child): (usize, &Child<'_>)| match &child.object.id {
        Some(id) => format!("{number} (\"{id}\")"),
        None => number.to_string(),
    };
    let names: Vec<String> = sensors.iter().enumerate().map(name).collect();
    if let ([first, _, ..], [name, others @ ..]) = (sensors, names.as_slice()) {
        let (count, others) = (names.len(), others.join(", "));
        let text = format!(
            "this scene has {count} sensors. Sensor {name} is rendered; --sensor chooses another: {others}"
        );
        library.warn(first.location, &text);
    }
}

/// The sensors of `root`, in file order.
pub(super) fn sensors(root: &Object) -> impl Iterator<Item = &Object> {
    root.properties.iter().filter_map(|property| sensor_in(&property.value))
}

fn sensor_in(value: &Value) -> Option<&Object> {
    if let Value::Object(object) = value {
        Some(object).filter(|child| sensor::ROWS.has(child))
    } else {
        None
    }
}

fn unknown(root: &Object, wanted: &str, ids: &[Option<String>]) -> Error {
    let expected = match ids.len() {
        0 => "a scene with a sensor".to_owned(),
        1 => "the id of a sensor of this scene, or 0".to_owned(),
        count => format!("the id of a sensor of this scene, or its number from 0 to {}", count - 1),
    };
    let known: Vec<&str> = ids.iter().flatten().map(String::as_str).collect();
    let remedy = match known.as_slice() {
        [] => "give the number of a sensor, from 0 in the order of the file".to_owned(),
        known => suggest(wanted, "known ids", known),
    };
    Error::new(&root.location, expected, format!("--sensor {wanted}"), remedy)
}

/// Says that `root` has no sensor.
pub(super) fn without_sensor(root: &Object) -> Error {
    let remedy = match root.location.position {
        Position::Text { .. } => "add <sensor type=\"perspective\">...</sensor>",
        Position::Path(_) => "add \"camera\": {\"type\": \"perspective\", ...}",
    };
    Error::new(&root.location, "a sensor in the scene", "none", remedy)
}
