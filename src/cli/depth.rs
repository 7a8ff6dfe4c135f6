//! The lengths of paths that count, as the command line and the scene say.

use super::estimator::Estimator;
use crate::{
    error::{Error, Result},
    scene::build::Setup,
    settings::integrator::Restriction,
    transport::{Algorithm, Heuristic, Options},
};

/// A bound on the length of paths.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum MaxDepth {
    /// At most this number of segments.
    Edges(u32),
    /// No bound (-1, as in Mitsuba).
    Unbounded,
}

pub(super) fn max_depth(text: &str) -> std::result::Result<MaxDepth, String> {
    match text.parse::<i64>().map(u32::try_from) {
        Ok(Ok(edges)) => Ok(MaxDepth::Edges(edges)),
        _ if text == "-1" => Ok(MaxDepth::Unbounded),
        _ => Err("expected a number of edges from 0 to 4294967295, or -1 for no limit".into()),
    }
}

pub(super) fn min_depth(text: &str) -> std::result::Result<u32, String> {
    text.parse().map_err(|_| "expected a number of edges from 0 to 4294967295".into())
}

impl Estimator {
    /// Some heuristics need a bound on the length of paths.
    pub(super) fn check_depth(&self, heuristic: Heuristic, edges: Option<u32>) -> Result<()> {
        let too_deep = |most: &u32| edges.is_none_or(|edges| edges > *most);
        let Some(most) = heuristic.most_edges().filter(too_deep) else { return Ok(()) };
        let place = if self.max_depth.is_some() { "--max-depth" } else { "the scene's max_depth" };
        Err(Error::new(
            place,
            format!("a number from 0 to {most}, for the heuristic {heuristic}"),
            edges.map_or("-1 (no limit)".to_owned(), |edges| edges.to_string()),
            format!(
                "give --max-depth {most}, or choose another --heuristic: balance, power, maximum or uniform"
            ),
        ))
    }

    /// Some paths must count; and what a preview learns is of paths of all lengths.
    pub(super) fn check_min_depth(&self, options: &Options) -> Result<()> {
        let place = if self.min_depth.is_some() { "--min-depth" } else { "the scene's min_depth" };
        match options.algorithm {
            Algorithm::Fog => Ok(()),
            Algorithm::Gather | Algorithm::FirstPass if options.min_depth > 1 => {
                let (expected, remedy) =
                    ("0 or 1, for the preview gather", "choose --integrator bdpt, pt or lt");
                Err(Error::new(place, expected, options.min_depth.to_string(), remedy))
            }
            _ => options.check_depths(place),
        }
    }

    /// The most segments of a path; none for no limit.
    pub(super) fn max_depth(&self, setup: &Setup) -> Result<Option<u32>> {
        let edges = match self.max_depth {
            Some(MaxDepth::Edges(edges)) => Some(edges),
            Some(MaxDepth::Unbounded) => None,
            None => setup.integrator.options.max_depth,
        };
        let single = matches!(setup.integrator.restriction, Restriction::SingleScattering { .. });
        if single && edges.is_none_or(|edges| edges > Restriction::SINGLE) {
            return Err(Error::new(
                "--max-depth",
                "0, 1 or 2, for single_scattering",
                edges.map_or("-1".to_owned(), |edges| edges.to_string()),
                "leave it out, or let light scatter more often by --scattering multiple",
            ));
        }
        Ok(edges)
    }
}
