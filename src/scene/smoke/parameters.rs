//! What a user may say of smoke. Each parameter's default, unit and range stand where it is read.

use super::taken::Glow;
use crate::{
    description::{Location, Params, Property, TransformStep, Value},
    error::{Error, Result},
    math::Spectrum,
    medium, phase,
    settings::only_one,
    volume::files::{
        Label,
        roles::{self, Wanted},
        sequence::{Clock, Sequence},
    },
};
use std::path::PathBuf;

/// What has been read.
pub struct Parameters<'a> {
    /// What is shown.
    pub file: Shown,
    /// Where the file is named.
    pub location: &'a Location,
    /// Grids that the user chooses.
    pub wanted: Wanted<'a>,
    /// Which axis of the file points up.
    pub up: Up,
    /// Size and place: from the file's world, turned so that +y is up, to the scene's.
    pub to_world: Vec<TransformStep>,
    /// Extinction of a density of 1 (1/m).
    pub density_scale: f64,
    /// Brightness: 1 m of fire radiates so much of what a black body of its temperature does (1/m).
    pub emission_scale: f64,
    /// Single-scattering albedo; a factor of it where a grid gives a colour.
    pub albedo: Option<Spectrum>,
    /// What a velocity of 1 stands for (m/s in the file's world); 1 where nobody says.
    pub velocity_scale: Option<f64>,
    /// The group of its light.
    pub group: Option<String>,
    /// How light scatters.
    pub phase: Option<&'a Property>,
    /// The medium around it.
    pub exterior: Option<&'a Property>,
    temperature_scale: Option<f64>,
    temperature_offset: Option<f64>,
}

/// A file: of numbered ones, that of the scene's time.
pub struct Shown {
    /// The file itself.
    pub path: PathBuf,
    /// The same as the scene would name it.
    pub name: String,
    /// The files that it is one of.
    pub sequence: Option<Sequence>,
}

/// An axis of the file that points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Up {
    /// That of whoever wrote the file, as far as it says that.
    Auto,
    /// As in scenes.
    Y,
    /// As in Blender.
    Z,
}

const UPS: [(&str, Up); 3] = [("auto", Up::Auto), ("y", Up::Y), ("z", Up::Z)];

impl<'a> Parameters<'a> {
    /// Reads all of them; the scene is seen at `time` (s).
    pub fn read(params: &Params<'a>, time: f64) -> Result<Self> {
        let file = read_file(params, time)?;
        let location = params.given("filename").map_or(params.location(), |property| &property.location);
        let emission_scale = params.float("emission_scale")?;
        Ok(Self {
            file,
            location,
            wanted: wanted(params, emission_scale)?,
            up: params.choice("up", &UPS)?,
            to_world: to_world(params)?,
            density_scale: params.float("density_scale")?,
            emission_scale,
            albedo: params.optional_color("albedo")?,
            velocity_scale: params.optional_float("velocity_scale")?,
            group: medium::group(params)?,
            phase: phase_of(params)?,
            exterior: params.child("exterior")?.and_then(|_| params.given("exterior")),
            temperature_scale: params.optional_float("temperature_scale")?,
            temperature_offset: params.optional_float("temperature_offset")?,
        })
    }

    /// True if `to_world` may turn it: whoever wrote that knows which way is up.
    pub fn is_turned(&self) -> bool {
        let turns =
            |step: &TransformStep| !matches!(step, TransformStep::Scale(_) | TransformStep::Translate(_));
        self.to_world.iter().any(turns)
    }

    /// How the grid called `label`, which goes up to `most`, glows.
    pub fn glow(&self, label: &Label, most: f32) -> Glow {
        let [scale, offset] = roles::ramp(label, most);
        let scale = self.temperature_scale.unwrap_or(scale);
        let offset = self.temperature_offset.unwrap_or(offset);
        Glow { grid: label.name.clone(), scale, offset, most: offset + scale * f64::from(most) }
    }

    /// The error where no grid is left.
    pub fn nothing_left(&self) -> Error {
        let remedy = "name a grid with \"density_grid\" or \"temperature_grid\", or leave one of them out";
        Error::new(self.location, "smoke or fire", "neither", remedy)
    }
}

/// `filename`: a .vdb, .nvdb or .vol file, or numbered ones (`smoke_####.vdb`, `smoke_%04d.vdb`). Of these, frame
/// `first_frame` (by default the first that exists) is shown at time 0, and `fps` (24) frames a second.
fn read_file(params: &Params<'_>, time: f64) -> Result<Shown> {
    let fps = params.float("fps")?;
    let first = params.optional_integer("first_frame")?;
    let text = params.string("filename")?;
    let location = params.given("filename").map_or(params.location(), |property| &property.location);
    let sequence = Sequence::new(&params.library.file(text, location), Clock { fps, first });
    let Some(sequence) = sequence.filter(|_| !text.is_empty()) else {
        let meant = [("fps", fps != Clock::FPS), ("first_frame", first.is_some())];
        if let Some((name, _)) = meant.into_iter().find(|(_, meant)| *meant) {
            let remedy = "write # or %04d in place of the number in the name of the file, or remove it";
            let expected = format!("numbered files for \"{name}\"");
            return Err(Error::new(location, expected, format!("\"{text}\""), remedy));
        }
        return Ok(Shown { path: params.file("filename")?, name: text.to_owned(), sequence: None });
    };
    let path = sequence.at(time).map_err(|problem| problem.at(location))?;
    let folder = text.rfind(['/', std::path::MAIN_SEPARATOR]).map_or("", |end| &text[..=end]);
    let name = format!("{folder}{}", path.file_name().unwrap_or_default().to_string_lossy());
    Ok(Shown { path, name, sequence: Some(sequence) })
}

/// `density_grid`, `temperature_grid`, `color_grid`, `velocity_grid`: names of grids that are not known by their names;
/// "" takes none. `level_set_to_fog` (false): fills surfaces. Nothing glows where `emission_scale` is 0.
fn wanted<'a>(params: &Params<'a>, emission_scale: f64) -> Result<Wanted<'a>> {
    let temperature = params.optional_string("temperature_grid")?;
    Ok(Wanted {
        density: params.optional_string("density_grid")?,
        temperature: if emission_scale > 0.0 { temperature } else { Some("") },
        color: params.optional_string("color_grid")?,
        velocity: params.optional_string("velocity_grid")?,
        level_set_to_fog: params.boolean("level_set_to_fog")?,
    })
}

/// `scale` (1): size, about the origin of the file's world; then `to_world`.
fn to_world(params: &Params<'_>) -> Result<Vec<TransformStep>> {
    let scale = params.float("scale")?;
    params.transform("to_world")?;
    let mut steps = vec![];
    if scale != 1.0 {
        steps.push(TransformStep::Scale([scale; 3]));
    }
    if let Some(Value::Transform(given)) = params.given("to_world").map(|property| &property.value) {
        steps.extend_from_slice(given);
    }
    Ok(steps)
}

/// The phase function (isotropic), as it was given: it may be a reference.
fn phase_of<'a>(params: &Params<'a>) -> Result<Option<&'a Property>> {
    let phases = params.children("phase", |child| phase::ROWS.has(child.object))?;
    if let [_, second, ..] = phases.as_slice() {
        return Err(only_one(second, "phase function"));
    }
    let location = phases.first().map(|child| child.location);
    let is_it =
        |property: &&Property| location.is_some_and(|location| std::ptr::eq(&property.location, location));
    Ok(params.object.properties.iter().find(is_it))
}
