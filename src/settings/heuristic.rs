//! MIS heuristics: rules by which the strategies that can make a path share it, an axis of variance studies. The
//! weights of a path sum to one under each of them. All give the same image; only the noise differs.

use crate::{
    description::{Params, nearest, parameter::Parameter, rows},
    error::{self, Error},
};
use std::fmt;

/// A rule of multiple importance sampling (Veach 1997, sec. 9.2). With q = n p, expected samples times density, of every
/// strategy by every hero channel:
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Heuristic {
    /// Weights proportional to q (LW96 eq. 14).
    #[default]
    Balance,
    /// Weights proportional to q^2.
    Power,
    /// All for the greatest q.
    Maximum,
    /// Proportional to q, but nothing for those below `alpha` times the greatest.
    Cutoff {
        /// Between 0, which would be the balance heuristic, and 1, which would be the maximum heuristic.
        alpha: f32,
    },
    /// The same for every strategy that can make the path; its heroes share it in proportion to q.
    Uniform,
}

/// What integrators have that make paths.
pub(super) const HEURISTIC: &[Parameter] = rows! {
    text("heuristic", "one of balance, power, maximum, cutoff, cutoff:ALPHA, uniform", Word("balance"),
        "Heuristic of multiple importance sampling (Veach 1997, sec. 9.2); the expected image is the same.").ours(),
};

impl Heuristic {
    /// Default alpha of the cutoff heuristic.
    pub const ALPHA: f32 = 0.1;

    /// Most segments of paths that the cutoff heuristic weighs. It has to know every strategy's q separately:
    /// no sum over strategies gives how many of them stay below a maximum that is not known yet.
    pub const CUTOFF_EDGES: u32 = 32;

    /// Every rule as typed.
    pub const NAMES: [(&str, Self); 5] = [
        ("balance", Self::Balance),
        ("power", Self::Power),
        ("maximum", Self::Maximum),
        ("cutoff", Self::Cutoff { alpha: Self::ALPHA }),
        ("uniform", Self::Uniform),
    ];

    /// The rule that is typed as `text`, a name or `cutoff:ALPHA`; else what was expected.
    pub fn parse(text: &str) -> Result<Self, String> {
        let (name, alpha) =
            text.split_once(':').map_or((text, None), |(name, alpha)| (name, Some(alpha.parse::<f32>())));
        let found = Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, heuristic)| *heuristic);
        match (found, alpha) {
            (Some(heuristic), None) => Ok(heuristic),
            (Some(Self::Cutoff { .. }), Some(Ok(alpha))) if alpha > 0.0 && alpha < 1.0 => {
                Ok(Self::Cutoff { alpha })
            }
            (Some(Self::Cutoff { .. }), _) => Err("cutoff:ALPHA with ALPHA above 0 and below 1".to_owned()),
            _ => {
                let names = Self::NAMES.map(|(name, _)| name);
                Err(format!("one of {}, or cutoff:ALPHA", names.join(", ")))
            }
        }
    }

    /// Reads `heuristic`, as [`Self::parse`] does.
    pub(super) fn read(params: &Params<'_>) -> error::Result<Self> {
        let text = params.string("heuristic")?;
        Self::parse(text).map_err(|expected| {
            let names = Self::NAMES.map(|(name, _)| name);
            let name = text.split(':').next().unwrap_or(text);
            let hint = if names.contains(&name) { String::new() } else { nearest(name, &names) };
            let error = params.complain("heuristic", expected, format!("\"{text}\""));
            Error { remedy: format!("{hint}{}", error.remedy), ..error }
        })
    }

    /// Most segments of paths that it can weigh; none for no limit.
    pub fn most_edges(self) -> Option<u32> {
        matches!(self, Self::Cutoff { .. }).then_some(Self::CUTOFF_EDGES)
    }
}

/// As typed.
impl fmt::Display for Heuristic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Balance => f.write_str("balance"),
            Self::Power => f.write_str("power"),
            Self::Maximum => f.write_str("maximum"),
            Self::Cutoff { alpha: Self::ALPHA } => f.write_str("cutoff"),
            Self::Cutoff { alpha } => write!(f, "cutoff:{alpha}"),
            Self::Uniform => f.write_str("uniform"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_printed_is_what_is_typed() {
        let named = Heuristic::NAMES.iter().map(|(name, heuristic)| (*name, *heuristic));
        for (name, heuristic) in named.chain([("cutoff:0.25", Heuristic::Cutoff { alpha: 0.25 })]) {
            assert_eq!(Heuristic::parse(name), Ok(heuristic));
            assert_eq!(heuristic.to_string(), name);
        }
        assert_eq!(Heuristic::default(), Heuristic::Balance);
        assert_eq!(Heuristic::parse("cutoff:0.1"), Heuristic::parse("cutoff"));
    }

    #[test]
    fn what_is_misspelt_is_told() {
        for text in ["cutoff:0", "cutoff:1", "cutoff:-0.1", "cutoff:nan", "cutoff:", "cutoff:x"] {
            assert!(Heuristic::parse(text).unwrap_err().contains("above 0 and below 1"), "{text}");
        }
        for text in ["", "powre", "power:2", "balance:0.1", "Power"] {
            assert!(Heuristic::parse(text).unwrap_err().contains("maximum, cutoff, uniform"), "{text}");
        }
    }
}
