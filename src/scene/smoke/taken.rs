//! What smoke was made of, for those who ask.

use super::parameters::{Parameters, Up};
use crate::{
    description::{Location, Object},
    error::Result,
    volume::files::{
        Label,
        roles::{Roles, is_velocity},
        sequence::Sequence,
    },
};
use std::{fmt, path::PathBuf};

/// What of a file became smoke.
#[derive(Clone, Debug)]
pub struct Taken {
    /// The name of the smoke in the scene.
    pub name: String,
    /// The file that was read.
    pub file: PathBuf,
    /// Where the scene names it.
    pub location: Location,
    /// The frames that it is one of.
    pub sequence: Option<Sequence>,
    /// True if +z of the file became +y of the scene.
    pub is_z_up: bool,
    /// The grid of densities; its name is empty in files whose grids have none.
    pub density: Option<String>,
    /// True if it is a level set.
    pub is_surface: bool,
    /// What glows.
    pub glow: Option<Glow>,
    /// The grid of colours, or three of a component each.
    pub color: Vec<String>,
    /// The grid of velocities, or three of a component each, where the smoke moves by them.
    pub velocity: Vec<String>,
    /// What a velocity of 1 stands for (m/s in the file's world); 1 where nobody says.
    pub velocity_scale: Option<f64>,
    /// Grids that are not used, and what they are where that is known.
    pub unused: Vec<String>,
}

/// A grid as the light of black bodies.
#[derive(Clone, Debug, PartialEq)]
pub struct Glow {
    /// Its name.
    pub grid: String,
    /// Temperature that a number of 1 adds (K).
    pub scale: f64,
    /// Temperature of what is barely above nothing (K).
    pub offset: f64,
    /// The highest temperature (K).
    pub most: f64,
}

impl Taken {
    /// What of the grids called `labels` became the smoke that is `given`, by their `roles`; `empty` ones have none.
    pub fn new(
        smoke: &Object,
        given: &Parameters<'_>,
        labels: &[Label],
        roles: &Roles,
        empty: &[usize],
        glow: Option<Glow>,
    ) -> Self {
        let unused = labels.iter().enumerate().filter(|(number, _)| !roles.has(*number));
        Self {
            name: smoke.id.clone().unwrap_or_else(|| smoke.plugin.clone()),
            file: given.file.path.clone(),
            location: given.location.clone(),
            sequence: given.file.sequence.clone(),
            is_z_up: given.up == Up::Z,
            density: roles.density.map(|number| labels[number].name.clone()),
            is_surface: roles.density.is_some_and(|number| labels[number].is_level_set()),
            glow,
            color: roles.color.iter().map(|number| labels[*number].name.clone()).collect(),
            velocity: roles.velocity.iter().map(|number| labels[*number].name.clone()).collect(),
            velocity_scale: given.velocity_scale,
            unused: unused.map(|(number, label)| described(label, empty.contains(&number))).collect(),
        }
    }
}

impl Taken {
    /// The file that is shown at `time` (s).
    pub fn at(&self, time: f64) -> Result<PathBuf> {
        let Some(sequence) = &self.sequence else { return Ok(self.file.clone()) };
        sequence.at(time).map_err(|problem| problem.at(&self.location))
    }
}

/// A grid that is not used.
fn described(label: &Label, is_empty: bool) -> String {
    let what = match is_empty {
        true => " (empty)",
        false if is_velocity(label) => " (a velocity)",
        false => "",
    };
    format!("\"{}\"{what}", label.name)
}

impl fmt::Display for Taken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let up = if self.is_z_up { ", +z up" } else { "" };
        write!(f, "{}: {}{up}", self.name, self.file.display())?;
        match self.density.as_deref() {
            Some("") => write!(f, ", density from its grid")?,
            Some(density) if self.is_surface => write!(f, ", density from the level set \"{density}\"")?,
            Some(density) => write!(f, ", density from \"{density}\"")?,
            None => write!(f, ", no density")?,
        }
        if let Some(Glow { grid, scale, offset, most }) = &self.glow {
            write!(f, ", light from \"{grid}\" ({offset} K + {scale} K x its value, up to {most:.0} K)")?;
        }
        if !self.color.is_empty() {
            write!(f, ", colour from \"{}\"", self.color.join("\", \""))?;
        }
        if !self.velocity.is_empty() {
            write!(f, ", carried along by \"{}\"", self.velocity.join("\", \""))?;
            self.velocity_scale.map_or(Ok(()), |scale| write!(f, " (1 is {scale:.4} m/s)"))?;
        }
        if !self.unused.is_empty() {
            write!(f, "; not used: {}", self.unused.join(", "))?;
        }
        Ok(())
    }
}
