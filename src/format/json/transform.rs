//! The steps of a transform.

use super::{
    super::{
        steps,
        text::{self, one_or_triple},
    },
    Json, Node,
};
use crate::{
    description::{TransformStep, nearest},
    error::{Error, Result},
};

/// One step.
pub(super) fn step(node: &Node) -> Result<TransformStep> {
    match node.type_name()? {
        "translate" => Ok(TransformStep::Translate(vector(node, &[], "value", 0.0)?)),
        "scale" => Ok(TransformStep::Scale(vector(node, &[], "value", 1.0)?)),
        "rotate" => {
            let axis = vector(node, &["angle"], "axis", 0.0)?;
            node.check(steps::rotate(axis, node.require("angle")?.number()?))
        }
        "lookat" => look_at(node),
        "matrix" => {
            node.allow(&["value"])?;
            matrix(&node.require("value")?)
        }
        word => {
            let remedy = format!("{}known: {}", nearest(word, &steps::WORDS), steps::WORDS.join(", "));
            let place = node.require("type")?.location;
            Err(Error::new(place, "a step of a transform", format!("\"{word}\""), remedy))
        }
    }
}

/// A matrix: its numbers in one list, or each row in a list of its own.
pub(super) fn matrix(value: &Node) -> Result<TransformStep> {
    let items = value.items()?;
    let numbers = match items.iter().all(|item| matches!(item.json, Json::Array(_))) {
        true => items.iter().map(Node::numbers).collect::<Result<Vec<_>>>()?.concat(),
        false => value.numbers()?,
    };
    value.check(text::matrix(&numbers)).map(TransformStep::Matrix)
}

/// `whole` with one or three numbers; or any of `x`, `y`, `z`, where what is left out is `default`.
fn vector(node: &Node, more: &[&str], whole: &str, default: f64) -> Result<[f64; 3]> {
    node.allow(&[&[whole, "x", "y", "z"], more].concat())?;
    let component = |name| node.get(name).map_or(Ok(default), |node| node.number());
    let any = ["x", "y", "z"].iter().any(|name| node.get(name).is_some());
    match node.get(whole) {
        None if !any => Err(node.require(whole).err().unwrap_or_else(|| node.wrong("a vector"))),
        None => Ok([component("x")?, component("y")?, component("z")?]),
        Some(_) if any => {
            let expected = format!("either \"{whole}\" or \"x\", \"y\", \"z\"");
            Err(Error::new(&node.location, expected, "both", "remove one of the two"))
        }
        Some(value) => value.check(one_or_triple(&value.one_or_more()?)),
    }
}

fn look_at(node: &Node) -> Result<TransformStep> {
    node.allow(&["origin", "target", "up"])?;
    let origin = node.require("origin")?.vector()?;
    let target = node.require("target")?.vector()?;
    let up = node.get("up").map(|up| up.vector()).transpose()?;
    node.check(steps::look_at(origin, target, up))
}
