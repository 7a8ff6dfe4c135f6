//! The steps inside a `transform` element.

use super::{
    super::{
        steps,
        text::{self, triple},
    },
    element::Element,
    values::components,
};
use crate::{
    description::{TransformStep, nearest},
    error::{Error, Result},
};

/// One step.
pub(super) fn step(element: &Element) -> Result<TransformStep> {
    element.childless()?;
    match element.tag {
        "translate" => Ok(TransformStep::Translate(vector(element, &[], 0.0)?)),
        "scale" => Ok(TransformStep::Scale(vector(element, &[], 1.0)?)),
        "rotate" => {
            let axis = vector(element, &["angle"], 0.0)?;
            element.check(steps::rotate(axis, element.require("angle")?.parse(text::float)?))
        }
        "lookat" => look_at(element),
        "matrix" => {
            element.allow(&["value"])?;
            let value = element.require("value")?;
            value.parse(|t| text::matrix(&text::floats(t)?)).map(TransformStep::Matrix)
        }
        tag => {
            let remedy = format!("{}known: {}", nearest(tag, &steps::WORDS), steps::WORDS.join(", "));
            Err(Error::new(&element.location, "a step of a transform", format!("<{tag}>"), remedy))
        }
    }
}

/// `value` with one or three numbers, or any of `x`, `y`, `z`; the others are as if the step were not there.
fn vector(element: &Element, more: &[&str], default: f64) -> Result<[f64; 3]> {
    element.allow(&[&["value", "x", "y", "z"], more].concat())?;
    components(element, |_| Ok(default))
}

fn look_at(element: &Element) -> Result<TransformStep> {
    element.allow(&["origin", "target", "up"])?;
    let point = |t: &str| triple(&text::floats(t)?);
    let origin = element.require("origin")?.parse(point)?;
    let target = element.require("target")?.parse(point)?;
    let up = element.get("up").map(|up| up.parse(point)).transpose()?;
    element.check(steps::look_at(origin, target, up))
}
