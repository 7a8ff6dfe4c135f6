//! What a file's numbers are made into before a grid is built of them: fog of a level set, light of a temperature.

use super::file::Values;
use crate::{
    description::Params,
    error::Result,
    math::{Spectrum, black_body},
    volume::{
        Mapped,
        files::{Field, Problem, Source},
    },
};

/// What becomes of a file's numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Convert {
    /// They stay what they are.
    No,
    /// Distances to a surface become densities (OpenVDB's sdfToFogVolume): 0 on it and outside, 1 from the greatest
    /// distance that the file holds on, linear between.
    Fog,
    /// Numbers become the radiance of black bodies of the temperature `offset` + `scale` times the number.
    BlackBody {
        /// Temperature that a number of 1 adds (K).
        scale: f64,
        /// Temperature of what is barely above nothing (K).
        offset: f64,
    },
}

/// Numbers up to this are no fire, whatever the offset: what simulations leave behind.
const NOTHING: f32 = 0.01;

/// The hottest that may be asked for (K).
pub const HOTTEST: f64 = 1e9;

/// What `convert` may say.
#[derive(Clone, Copy)]
pub(super) enum Kind {
    No,
    Fog,
    BlackBody,
}

impl Convert {
    /// Names in scene files.
    pub(super) const NAMES: [(&'static str, Kind); 3] =
        [("none", Kind::No), ("fog", Kind::Fog), ("blackbody", Kind::BlackBody)];

    /// Reads `convert` and, for black bodies, `temperature_scale` and `temperature_offset` (K).
    pub(super) fn read(params: &Params<'_>) -> Result<Self> {
        let kind = params.choice("convert", &Self::NAMES)?;
        let (scale, offset) = (params.float("temperature_scale")?, params.float("temperature_offset")?);
        Ok(match kind {
            Kind::No => Self::No,
            Kind::Fog => Self::Fog,
            Kind::BlackBody => Self::BlackBody { scale, offset },
        })
    }

    /// What becomes of the grid `source` of a .vdb or .nvdb file.
    pub(super) fn of_source(self, source: Source) -> std::result::Result<Values, Problem> {
        let source = if self == Self::Fog { source } else { source.no_surface()? };
        let (class, name) = (source.label.class.clone(), source.label.name.clone());
        match source.samples {
            Field::Grey(samples) if self == Self::Fog => {
                let depth = samples.background();
                let is_surface = source.label.is_level_set() || class.is_empty() || class == "unknown";
                if !(is_surface && depth > 0.0) {
                    return Err(no_surface(&name, &class));
                }
                Ok(Values::Grey(Box::new(Mapped::new(samples, move |distance: f32| {
                    (-distance / depth).clamp(0.0, 1.0)
                }))))
            }
            Field::Grey(samples) => self.of(Values::Grey(Box::new(samples))),
            Field::Colour(samples) => self.of(Values::Chromatic(Box::new(samples))),
        }
    }

    /// What becomes of `values`, which are no distances to a surface.
    pub(super) fn of(self, values: Values) -> std::result::Result<Values, Problem> {
        match (self, values) {
            (Self::No, values) => Ok(values),
            (Self::Fog, _) => Err(no_surface("the only grid", "no class")),
            (Self::BlackBody { .. }, Values::Chromatic(_)) => {
                let remedy = "name another grid with the parameter \"grid\", or leave out \"convert\"";
                Err(Problem::new("one number per voxel for a temperature", "three", remedy))
            }
            (Self::BlackBody { scale, offset }, Values::Grey(samples)) => {
                let light = move |number| radiance(number, scale, offset);
                Ok(Values::Chromatic(Box::new(Mapped::new(samples, light))))
            }
        }
    }
}

/// Light of the temperature that `number` stands for (W/(m^2 sr nm)).
fn radiance(number: f32, scale: f64, offset: f64) -> Spectrum {
    if number <= NOTHING {
        return Spectrum::ZERO;
    }
    // What is not a number stays that, to be refused.
    black_body::radiance((offset + scale * f64::from(number)) as f32) + 0.0 * number
}

fn no_surface(name: &str, class: &str) -> Problem {
    let class = if class.is_empty() { "no class" } else { class };
    let remedy = "leave out \"convert\", or name a level set with the parameter \"grid\"";
    Problem::new("a level set to make fog of", format!("\"{name}\" ({class})"), remedy)
}
