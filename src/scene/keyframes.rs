//! The description of a scene at its own time: whatever is keyframed in it has the value of that moment, so that no
//! builder knows of keyframes (BMA02 sec. 5).

use crate::{
    description::{Keyframes, Object, Value},
    volume::WIND,
};
use std::borrow::Cow;

/// `root` at `time` (s). Its own time does not change.
pub fn resolve(root: &Object, time: f64) -> Cow<'_, Object> {
    if !has_any(root) {
        return Cow::Borrowed(root);
    }
    let mut resolved = root.clone();
    for property in resolved.properties.iter_mut().filter(|property| property.name != "time") {
        fill(&mut property.value, time, Keyframes::at);
    }
    Cow::Owned(resolved)
}

/// True if something in `root` changes in time by keyframes.
pub fn has_any(root: &Object) -> bool {
    root.properties.iter().any(|property| match &property.value {
        Value::Object(child) => has_any(child),
        Value::Keyframes(_) => true,
        _ => false,
    })
}

/// Adds when something in `root` is at its least or greatest from `begin` to `end` (s) to `times`.
pub fn extremes(root: &Object, [begin, end]: [f64; 2], times: &mut Vec<f64>) {
    for property in &root.properties {
        match &property.value {
            Value::Object(child) => extremes(child, [begin, end], times),
            Value::Keyframes(keyframes) => times.extend(keyframes.extremes([begin, end])),
            _ => {}
        }
    }
}

/// Puts what `of` makes of keyframes in place of them.
fn fill(value: &mut Value, time: f64, of: fn(&Keyframes, f64) -> Value) {
    match value {
        Value::Object(object) => {
            for property in &mut object.properties {
                // A wind takes things as far as its velocity adds up to since the time 0.
                let is_rate = object.plugin == WIND && property.name == "velocity";
                fill(&mut property.value, time, if is_rate { Keyframes::mean } else { Keyframes::at });
            }
        }
        Value::Keyframes(keyframes) => *value = of(keyframes, time),
        _ => {}
    }
}

#[cfg(test)]
mod tests;
