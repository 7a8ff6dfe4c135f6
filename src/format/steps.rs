//! Steps of transforms that mean something: no rotation about nothing, no look in no direction.

use super::text::{Mistake, Parsed};
use crate::{
    description::TransformStep,
    math::{DVec3, Frame},
};

/// The words for steps, as both spellings write them.
pub(super) const WORDS: [&str; 5] = ["translate", "rotate", "scale", "lookat", "matrix"];

fn mistake<T>(expected: &str, found: String) -> Parsed<T> {
    Err(Mistake { expected: expected.into(), found })
}

/// A rotation about `axis` by `angle` degrees.
pub(super) fn rotate(axis: [f64; 3], angle: f64) -> Parsed<TransformStep> {
    if DVec3::from(axis).try_normalize().is_none() {
        return mistake("a rotation axis other than zero", format!("{axis:?}"));
    }
    Ok(TransformStep::Rotate { axis, angle })
}

/// Placement at `origin` towards `target`. As in Mitsuba, `up` left out (or zero) is chosen for you.
pub(super) fn look_at(origin: [f64; 3], target: [f64; 3], up: Option<[f64; 3]>) -> Parsed<TransformStep> {
    let Some(direction) = (DVec3::from(target) - DVec3::from(origin)).try_normalize() else {
        return mistake("a target other than the origin", format!("both at {origin:?}"));
    };
    let chosen = || Frame::around(direction.as_vec3()).tangent.as_dvec3().to_array();
    let up = up.filter(|up| *up != [0.0; 3]).unwrap_or_else(chosen);
    if DVec3::from(up).cross(direction).try_normalize().is_none() {
        return mistake("an up that is not along the view", format!("up = {up:?}"));
    }
    Ok(TransformStep::LookAt { origin, target, up })
}
