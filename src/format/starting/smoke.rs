//! A volume file as smoke: what of it is shown, and where it stands.

use crate::{
    description::{Library, Location, Object, Position, Property, TransformStep, Value},
    error::{Error, Result},
    math::{DAffine3, DMat4, DVec3, boxes::image},
    volume::{
        self, Place, Volume,
        files::{
            Label,
            roles::{self, Roles, Said},
            sequence::{Clock, Sequence},
        },
        grid::{Catalogue, Contents, Held},
    },
};
use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

/// What a file holds, as it stands in a scene: +y is up.
pub(super) struct Smoke {
    /// The box around all of it.
    pub domain: [DVec3; 2],
    /// The origin of the coordinates of the volumes.
    pub centre: DVec3,
    pub density: Option<Volume>,
    /// Radiance of black bodies (W/(m^2 sr nm)).
    pub fire: Option<Volume>,
    /// True if it has colours of its own.
    pub is_coloured: bool,
    pub is_z_up: bool,
    /// What must be said of the file for smoke to be made of it.
    pub said: Option<Said>,
    /// Its number, where it is one of many.
    pub frame: Option<PathBuf>,
}

impl Smoke {
    /// What is in the file at `path`; of numbered files in the last, which has most.
    pub(super) fn read(path: &Path) -> Result<Self> {
        let sequence = Sequence::new(path, Clock { fps: Clock::FPS, first: None });
        let last = sequence.map(|numbered| numbered.last()).transpose();
        let frame = last.map_err(|problem| problem.at(path.display()))?;
        let path = frame.as_deref().unwrap_or(path);
        let mut file = Catalogue::open(path)?;
        let (roles, said) = Roles::of_any(&file.labels).map_err(|problem| problem.at(path.display()))?;
        let Held { roles, density, fire, .. } = file.held(roles)?;
        let is_z_up = file.is_z_up();
        let domain = extent(path, is_z_up, density.iter().chain(&fire))?;
        let stand = Stand { path, is_z_up, centre: 0.5 * (domain[0] + domain[1]) };
        let label = |number: usize| &file.labels[number];
        let fog = (said == Some(Said::Fog)).then_some(("fog", [1.0, 0.0]));
        let density = roles.density.map(|number| stand.grid(label(number), fog));
        let ramp = |(number, fire): (usize, Contents)| {
            stand.grid(label(number), Some(("blackbody", roles::ramp(label(number), fire.hottest()))))
        };
        let fire = roles.temperature.zip(fire).map(ramp);
        Ok(Self {
            domain,
            centre: stand.centre,
            density: density.transpose()?,
            fire: fire.transpose()?,
            is_coloured: !roles.color.is_empty(),
            is_z_up,
            said,
            frame,
        })
    }
}

/// The box around all active voxels of `grids`, as they stand in a scene.
fn extent<'a>(path: &Path, is_z_up: bool, grids: impl Iterator<Item = &'a Contents>) -> Result<[DVec3; 2]> {
    let boxes = grids.filter_map(Contents::active_world);
    let Some(ends) = boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) else {
        let remedy = "export the volume again, or another frame of it";
        return Err(Error::new(path.display(), "a volume with something in it", "no active voxel", remedy));
    };
    let turn = if is_z_up { TransformStep::Z_TO_Y.matrix() } else { DMat4::IDENTITY };
    Ok(image(&DAffine3::from_mat4(turn), ends))
}

/// Where grids of a file are looked at.
struct Stand<'a> {
    path: &'a Path,
    centre: DVec3,
    is_z_up: bool,
}

impl Stand<'_> {
    /// A grid, its numbers converted with a scale and an offset.
    fn grid(&self, label: &Label, convert: Option<(&str, [f64; 2])>) -> Result<Volume> {
        let file = self.path.to_string_lossy().into_owned();
        let turn = self.is_z_up.then_some(TransformStep::Z_TO_Y);
        let mut given = vec![
            ("filename", Value::String(file)),
            ("use_grid_bbox", Value::Boolean(true)),
            ("to_world", Value::Transform(turn.into_iter().collect())),
        ];
        given.extend((!label.name.is_empty()).then(|| ("grid", Value::String(label.name.clone()))));
        if let Some((word, [scale, offset])) = convert {
            given.push(("convert", Value::String(word.to_owned())));
            given.push(("temperature_scale", Value::Float(scale)));
            given.push(("temperature_offset", Value::Float(offset)));
        }
        // Names of files start at the folder of the file that they stand in: here they stand in none.
        let location = Location { file: Arc::default(), position: Position::Path("$".to_owned()) };
        let property = |(name, value): (&str, Value)| Property {
            name: name.to_owned(),
            value,
            location: location.clone(),
        };
        let properties = given.into_iter().map(property).collect();
        let grid = Object { tag: None, plugin: "gridvolume".to_owned(), id: None, properties, location };
        volume::build(&grid, &Library::default(), &Place::new(self.centre, 0.0))
    }
}
