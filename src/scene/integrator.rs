//! Which integrator a scene asks for. All are one estimator with strategies left out.

use crate::{
    description::{Library, Object, Params, Row, build_by_row},
    error::Result,
};

/// How paths are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Bidirectional path tracing.
    Bdpt,
    /// Eye walks with next-event estimation.
    Pt,
    /// Light walks joined to the lens.
    Lt,
}

/// An integrator as a scene file asks for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Integrator {
    /// How paths are made.
    pub method: Method,
    /// Most segments of a path, null boundaries not counted; none for no limit.
    pub max_depth: Option<u32>,
    /// Leave out emitters seen directly.
    pub hide_emitters: bool,
}

impl Default for Integrator {
    fn default() -> Self {
        Self { method: Method::Bdpt, max_depth: None, hide_emitters: false }
    }
}

/// Every integrator.
pub const ROWS: &[Row<Integrator>] = &[
    Row { name: "bdpt", build: |p| build_as(p, Method::Bdpt) },
    Row { name: "path", build: |p| build_as(p, Method::Pt) },
    Row { name: "volpath", build: |p| build_as(p, Method::Pt) },
    Row { name: "volpathmis", build: |p| build_as(p, Method::Pt) },
    Row { name: "ptracer", build: |p| build_as(p, Method::Lt) },
];

/// Builds the integrator that `object` describes.
pub fn build(object: &Object, library: &Library) -> Result<Integrator> {
    build_by_row(object, library, "integrator", ROWS)
}

/// True if `object` is an integrator.
pub fn is_integrator(object: &Object) -> bool {
    ROWS.iter().any(|row| row.name == object.plugin)
}

fn build_as(params: &Params<'_>, method: Method) -> Result<Integrator> {
    let depth = params.integer("max_depth", -1)?;
    let max_depth = match depth {
        -1 => None,
        0..=0xffff_fffe => Some(depth as u32),
        _ => return Err(params.complain("max_depth", "-1 (no limit) or an integer >= 0", depth.to_string())),
    };
    params.accept_unused(&["rr_depth"], "walks end by absorption, which is exact at any depth");
    params.accept_unused(&["samples_per_pass", "block_size", "timeout"], "work is divided by Tyndall itself");
    Ok(Integrator { method, max_depth, hide_emitters: params.boolean("hide_emitters", false)? })
}
