//! What the grids of a file are for, by the names that tools give them.

use super::{
    Label, Problem, Result,
    choice::{choose, list, shown},
};

/// Names of densities: of Houdini, Blender, EmberGen and most others; of Bifrost.
const DENSITIES: [&str; 2] = ["density", "voxel_fog_density"];

/// Names of what makes fire glow. Fire itself comes before the temperature of all the gas, smoke included; Houdini 12
/// to 17 calls fire "heat", and Blender the temperature.
const FIRES: [&str; 3] = ["flame", "flames", "burn"];
const TEMPERATURES: [&str; 2] = ["heat", "temperature"];

/// Names of colours, and what three grids of a component each add to one.
const COLORS: [&str; 2] = ["Cd", "color"];
const COMPONENTS: [[&str; 3]; 3] = [["_r", "_g", "_b"], [".x", ".y", ".z"], ["_x", "_y", "_z"]];

/// Names of velocities, which no still picture shows; alone or with a component's name.
const VELOCITIES: [&str; 5] = ["vel", "velocity", "v", "motion", "voxel_velocity"];

/// What the user says of grids; an empty name takes none.
#[derive(Clone, Copy, Debug, Default)]
pub struct Wanted<'a> {
    /// Name of the density.
    pub density: Option<&'a str>,
    /// Name of the fire or temperature.
    pub temperature: Option<&'a str>,
    /// Name of the colour.
    pub color: Option<&'a str>,
    /// Name of the velocity.
    pub velocity: Option<&'a str>,
    /// True if fog is to be made of level sets.
    pub level_set_to_fog: bool,
}

/// Grids of a file by what they are for, each by its number.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Roles {
    /// How much there is.
    pub density: Option<usize>,
    /// How hot it is.
    pub temperature: Option<usize>,
    /// Of which colour: one grid, or three of a component each.
    pub color: Vec<usize>,
    /// Where it is carried: one grid, or three of a component each.
    pub velocity: Vec<usize>,
}

/// Temperatures above this are in kelvin, not in thousands of it.
const LARGEST_UNIT: f32 = 100.0;

/// Temperature of what is barely fire, and what a flame of 1 adds (K); Blender's defaults for its flames.
const IGNITION: f64 = 1500.0;
const FLAME: f64 = 1500.0;

/// What a temperature of 1 is, where 2 is hot (K); Blender's and Houdini's shaders have the same default.
const UNIT: f64 = 1000.0;

/// What a number of 1 adds to the temperature (K), and the temperature of what is barely above 0 (K), in the grid of fire
/// called `label`, which goes up to `most`: numbers above 100 are kelvin, flames begin at 1500 K and reach 3000 K at 1,
/// other temperatures are in units of 1000 K.
pub fn ramp(label: &Label, most: f32) -> [f64; 2] {
    match (most > LARGEST_UNIT, is_fire(label)) {
        (true, _) => [1.0, 0.0],
        (false, true) => [FLAME, IGNITION],
        (false, false) => [UNIT, 0.0],
    }
}

/// True if `label` is of fire, whose numbers go from 0 to 1, not of a temperature.
fn is_fire(label: &Label) -> bool {
    FIRES.iter().any(|name| label.plain_name().eq_ignore_ascii_case(name))
}

/// True if `label` is of a velocity or a component of one.
pub fn is_velocity(label: &Label) -> bool {
    let name = label.plain_name().to_lowercase();
    let base = COMPONENTS.iter().flatten().find_map(|end| name.strip_suffix(end));
    VELOCITIES.contains(&base.unwrap_or(&name))
}

/// Names of grids that may have been meant in place of grid `number`: those of numbers that are no velocities, or of
/// them the density.
pub fn others(grids: &[Label], number: usize) -> Vec<String> {
    let is_one = |grid: &Label| grid.channels == Some(1) && !grid.is_level_set() && !is_velocity(grid);
    let all = || grids.iter().enumerate().filter(|(other, grid)| *other != number && is_one(grid));
    let is_density = |grid: &Label| DENSITIES.iter().any(|name| grid.plain_name().eq_ignore_ascii_case(name));
    let densities: Vec<_> = all().filter(|(_, grid)| is_density(grid)).collect();
    let best = if densities.is_empty() { all().collect() } else { densities };
    best.into_iter().map(|(_, grid)| shown(&grid.name)).collect()
}

impl Roles {
    /// Those of all grids of a file; where they have no names, the only one is a density.
    pub fn of_file(grids: &[Label], wanted: Wanted<'_>) -> Result<Self> {
        match grids {
            [only] if only.name.is_empty() && wanted.density.is_none() => {
                Ok(Self { density: Some(0), ..Self::default() })
            }
            _ => Self::of(grids, wanted),
        }
    }

    /// Those that make a picture of any file: what smoke takes by itself, else fog of a level set, else the first grid of
    /// numbers that is no velocity; and how a scene says so, as a parameter of smoke with its value.
    pub fn of_any(grids: &[Label]) -> Result<(Self, Option<Said>)> {
        let usual = match Self::of_file(grids, Wanted::default()) {
            Ok(roles) => return Ok((roles, None)),
            Err(problem) => problem,
        };
        if let Ok(roles) = Self::of(grids, Wanted { level_set_to_fog: true, ..Wanted::default() }) {
            return Ok((roles, Some(Said::Fog)));
        }
        let is_one = |grid: &&Label| grid.channels == Some(1) && !is_velocity(grid);
        let name = grids.iter().find(is_one).map(|grid| grid.name.as_str()).ok_or(usual)?;
        let roles = Self::of(grids, Wanted { density: Some(name), ..Wanted::default() })?;
        Ok((roles, Some(Said::Density(name.to_owned()))))
    }

    /// Those of `grids`.
    fn of(grids: &[Label], wanted: Wanted<'_>) -> Result<Self> {
        let search = Search { grids, fog: wanted.level_set_to_fog };
        let temperature = match wanted.temperature {
            Some(name) => search.named(name, "temperature_grid", &[1])?,
            None => search.first(&FIRES, 1).or_else(|| search.first(&TEMPERATURES, 1)),
        };
        let density = match wanted.density {
            Some(name) => search.named(name, "density_grid", &[1, 3])?,
            None => search.density(temperature),
        };
        if density.is_none() && temperature.is_none() {
            return Err(search.nothing());
        }
        let color = match wanted.color {
            Some(name) => search.named(name, "color_grid", &[1, 3])?.into_iter().collect(),
            // It is smoke that has one.
            None if density.is_none() => vec![],
            None => search.vectors(&COLORS),
        };
        let velocity = match wanted.velocity {
            Some(name) => search.velocity_named(name)?,
            None => search.vectors(&VELOCITIES),
        };
        Ok(Self { density, temperature, color, velocity })
    }

    /// True if grid `number` is for anything.
    pub fn has(&self, number: usize) -> bool {
        let is_one = self.density == Some(number) || self.temperature == Some(number);
        is_one || self.color.contains(&number) || self.velocity.contains(&number)
    }
}

/// What must be said of a file before smoke takes anything.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// `level_set_to_fog`.
    Fog,
    /// `density_grid`.
    Density(String),
}

struct Search<'a> {
    grids: &'a [Label],
    fog: bool,
}

impl Search<'_> {
    /// The grid that the user calls `name` by `parameter`, whose samples must be of one of so many numbers.
    fn named(&self, name: &str, parameter: &str, channels: &[usize]) -> Result<Option<usize>> {
        if name.is_empty() {
            return Ok(None);
        }
        let explain = |problem: Problem| Problem {
            expected: format!("{} for \"{parameter}\"", problem.expected),
            ..problem
        };
        let number = choose(self.grids, Some(name)).map_err(explain)?;
        let label = &self.grids[number];
        let found = format!("\"{}\" of type {}", shown(&label.name), shown(&label.kind));
        if label.is_level_set() && !self.fog {
            let remedy = "set \"level_set_to_fog\" to true, or name another grid";
            let found = format!("\"{}\", a level set (distances to a surface)", shown(&label.name));
            return Err(Problem::new(format!("a grid of densities for \"{parameter}\""), found, remedy));
        }
        if label.channels.is_none_or(|count| !channels.contains(&count)) {
            let kind = match channels {
                [1] => "real numbers",
                [3] => "vectors",
                _ => "real numbers or colours",
            };
            let remedy = format!("name another of the file's grids: {}", list(self.grids));
            return Err(Problem::new(format!("a grid of {kind} for \"{parameter}\""), found, remedy));
        }
        Ok(Some(number))
    }

    /// The first grid of the first of `names` that a grid has.
    fn first(&self, names: &[&str], channels: usize) -> Option<usize> {
        names.iter().find_map(|name| {
            let fits = |grid: &Label| grid.channels == Some(channels) && (self.fog || !grid.is_level_set());
            self.grids.iter().position(|grid| fits(grid) && grid.plain_name().eq_ignore_ascii_case(name))
        })
    }

    /// The grid of three numbers that one of `names` names, or else three of a component each; none where there is neither.
    fn vectors(&self, names: &[&str]) -> Vec<usize> {
        let component = |name: &str, end: &str| self.first(&[&format!("{name}{end}")], 1);
        let three = |name: &str| -> Option<Vec<usize>> {
            COMPONENTS.iter().find_map(|ends| ends.iter().map(|end| component(name, end)).collect())
        };
        let one = self.first(names, 3).map(|number| vec![number]);
        one.or_else(|| names.iter().find_map(|name| three(name))).unwrap_or_default()
    }

    /// The velocity that the user calls `name`: a grid, or the beginning of the names of three.
    fn velocity_named(&self, name: &str) -> Result<Vec<usize>> {
        let found = self.vectors(&[name]);
        if name.is_empty() || !found.is_empty() {
            return Ok(found);
        }
        self.named(name, "velocity_grid", &[3]).map(|one| one.into_iter().collect())
    }

    /// By its name; or the only grid of numbers that could be one; or the first level set, if fog is made of such.
    fn density(&self, temperature: Option<usize>) -> Option<usize> {
        let surface = || self.grids.iter().position(|grid| grid.is_level_set() && grid.channels == Some(1));
        let only = || match self.grids {
            [only] if only.channels.is_some() && !only.is_level_set() && temperature.is_none() => Some(0),
            _ => None,
        };
        let named = self.first(&DENSITIES, 1).or_else(|| self.first(&DENSITIES, 3));
        named.or_else(only).or_else(|| surface().filter(|_| self.fog))
    }

    fn nothing(&self) -> Problem {
        let surface = self.grids.iter().find(|grid| grid.is_level_set());
        let fog = surface.map_or_else(String::new, |grid| {
            format!(", or set \"level_set_to_fog\" to true to make fog of \"{}\"", shown(&grid.name))
        });
        let names: Vec<_> = DENSITIES.iter().chain(&FIRES).chain(&TEMPERATURES).copied().collect();
        let expected = format!("a grid of smoke or fire, called {} or so", names.join(", "));
        let found = if self.grids.is_empty() { "none".to_owned() } else { list(self.grids) };
        let remedy = format!("name one with \"density_grid\" or \"temperature_grid\"{fog}");
        Problem::new(expected, found, remedy)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(names: &[&str]) -> Vec<Label> {
        let one = |name: &&str| {
            let (name, kind) = name.split_once(':').unwrap_or((name, "1"));
            let class = if kind == "surface" { "level set" } else { "fog volume" }.to_owned();
            let channels = if kind == "surface" { Some(1) } else { kind.parse().ok() };
            Label { name: name.to_owned(), kind: "any".to_owned(), class, channels, ..Label::default() }
        };
        names.iter().map(one).collect()
    }

    fn roles(names: &[&str], wanted: Wanted<'_>) -> Result<(Option<usize>, Option<usize>, Vec<usize>)> {
        Roles::of(&labels(names), wanted).map(|roles| (roles.density, roles.temperature, roles.color))
    }

    #[test]
    fn tools_grids_are_known_by_their_names() {
        let none = Wanted::default();
        let of = |names: &[&str]| roles(names, none).unwrap();
        // Blender 2.8 to 5, Houdini 13 to 17, Houdini 18 to 21, EmberGen, Bifrost; and three more ways to give a colour.
        let blender = ["density", "heat", "flame", "fuel", "color_r", "color_g", "color_b", "velocity:3"];
        assert_eq!(of(&blender), (Some(0), Some(2), vec![4, 5, 6]));
        assert_eq!(of(&["heat", "temperature", "density", "vel.x"]), (Some(2), Some(0), vec![]));
        assert_eq!(of(&["density", "temperature", "burn", "Cd:3", "vel:3"]), (Some(0), Some(2), vec![3]));
        assert_eq!(of(&["flames", "density", "temperature"]), (Some(1), Some(0), vec![]));
        assert_eq!(of(&["voxel_fog_density"]), (Some(0), None, vec![]));
        assert_eq!(of(&["color.x", "color.y", "color.z", "Density"]), (Some(3), None, vec![0, 1, 2]));
        assert_eq!(of(&["density", "color_r", "color_g"]), (Some(0), None, vec![]));
        assert_eq!(of(&["density[0]", "density[1]"]), (Some(0), None, vec![]));
        assert_eq!(of(&["anything"]), (Some(0), None, vec![]));
        assert_eq!(of(&["flame", "Cd:3"]), (None, Some(0), vec![]));
        // What is of no type that is read has no role.
        assert_eq!(of(&["density:points", "density[0]", "Cd"]), (Some(1), None, vec![]));
    }

    #[test]
    fn the_user_s_names_come_first_and_empty_ones_take_none() {
        let names = ["density", "soot", "flame", "tint:3", "Cd:3"];
        let wanted =
            Wanted { density: Some("soot"), temperature: Some(""), color: Some("tint"), ..Wanted::default() };
        assert_eq!(roles(&names, wanted).unwrap(), (Some(1), None, vec![3]));
        let problem = roles(&names, Wanted { density: Some("sot"), ..Wanted::default() }).unwrap_err();
        assert!(problem.expected.contains("density_grid") && problem.remedy.contains("soot"), "{problem:?}");
        let wrong = |names: &[&str], wanted| roles(names, wanted).unwrap_err();
        let of_tint = wrong(&names, Wanted { temperature: Some("tint"), ..Wanted::default() });
        assert!(
            of_tint.expected.contains("temperature_grid") && of_tint.remedy.contains("flame"),
            "{of_tint:?}"
        );
        let of_points = wrong(&["p:points", "density"], Wanted { density: Some("p"), ..Wanted::default() });
        assert!(of_points.expected.contains("real numbers or colours"), "{of_points:?}");
        let of_surface = wrong(&["s:surface"], Wanted { density: Some("s"), ..Wanted::default() });
        assert!(of_surface.remedy.contains("level_set_to_fog"), "{of_surface:?}");
    }

    #[test]
    fn level_sets_are_fog_on_request_only() {
        let names = ["surface:surface", "vel:3"];
        let problem = roles(&names, Wanted::default()).unwrap_err();
        assert!(
            problem.found.contains("surface") && problem.remedy.contains("level_set_to_fog"),
            "{problem:?}"
        );
        let fog = Wanted { level_set_to_fog: true, ..Wanted::default() };
        assert_eq!(roles(&names, fog).unwrap(), (Some(0), None, vec![]));
        assert_eq!(roles(&["density:surface", "density"], Wanted::default()).unwrap().0, Some(1));
    }

    #[test]
    fn velocities_are_told_from_the_rest() {
        let is = |name: &str| is_velocity(&labels(&[name])[0]);
        assert!(is("vel") && is("vel.x") && is("velocity_z") && is("Velocity") && is("v[0]"));
        assert!(!is("density") && !is("color.x") && !is("heat"));
    }
}
