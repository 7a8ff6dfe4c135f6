//! OpenVDB's maps from indices to the world.

use super::super::{Problem, Result, choice::shown, input::Input};
use crate::math::{DAffine3, DMat3, DVec3};
use std::io::{Read, Seek};

/// Reads a map. What a file holds beside scales and shifts follows from these.
pub(super) fn read<R: Read + Seek>(input: &mut Input<R>) -> Result<DAffine3> {
    let kind = input.text()?;
    let map = match kind.as_str() {
        "UniformScaleMap" | "ScaleMap" => {
            let map = DAffine3::from_scale(vector(input)?);
            derived(input)?;
            map
        }
        "UniformScaleTranslateMap" | "ScaleTranslateMap" => {
            let shift = vector(input)?;
            let map = DAffine3 { matrix3: DMat3::from_diagonal(vector(input)?), translation: shift };
            derived(input)?;
            map
        }
        "TranslationMap" => DAffine3::from_translation(vector(input)?),
        "AffineMap" | "UnitaryMap" => matrix(input)?,
        _ => {
            let remedy = "resample the grid onto voxels of one size, all alike";
            return Err(Problem::new("an affine map of the grid", format!("a {}", shown(&kind)), remedy));
        }
    };
    Ok(map)
}

fn vector<R: Read + Seek>(input: &mut Input<R>) -> Result<DVec3> {
    let mut number = || input.array().map(f64::from_le_bytes);
    Ok(DVec3::new(number()?, number()?, number()?))
}

/// Passes over the voxel size, 1 / scale, 1 / scale^2 and 1 / (2 scale).
fn derived<R: Read + Seek>(input: &mut Input<R>) -> Result<()> {
    input.skip(4 * 3 * 8)
}

/// Points are rows there: each row is where an axis goes, the last one where the origin does.
fn matrix<R: Read + Seek>(input: &mut Input<R>) -> Result<DAffine3> {
    let mut row = || {
        let row = vector(input)?;
        input.skip(8).map(|()| row)
    };
    Ok(DAffine3 { matrix3: DMat3::from_cols(row()?, row()?, row()?), translation: row()? })
}
