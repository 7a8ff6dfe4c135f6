//! The scene around a volume file: smoke on the ground under a sky with a sun, or at dusk where it burns.

use super::{
    escaped,
    levels::{self, Levels},
    smoke::Smoke,
    view::View,
};
use crate::{error::Result, math::DVec3, volume::files::roles::Said};
use std::path::Path;

/// Smoke that is wider than this many times its height hovers over the ground, by a part of its height.
const FLAT: f64 = 2.5;
const HOVERING: f64 = 0.4;

/// The ground's radius, in the smoke's sizes.
const GROUND: f64 = 60.0;

/// Light of the sky and the sun, colour of the ground; by day, and at dusk, when fire is seen.
const DAY: [[f64; 3]; 3] = [[0.14, 0.26, 0.48], [4.2, 3.7, 3.0], [0.22, 0.19, 0.15]];
const DUSK: [[f64; 3]; 3] = [[0.05, 0.075, 0.13], [1.1, 0.65, 0.35], [0.2, 0.17, 0.14]];

/// Direction of the sun's light: from the left, a little from behind the camera, which looks along -z and to the left.
const SUN: [f64; 3] = [0.8, -0.6, -0.35];

/// What is chosen for a volume file.
pub struct Portrait {
    smoke: Smoke,
    view: View,
    levels: Levels,
    ground: f64,
    /// Digits after the point that places need.
    digits: usize,
}

/// That of the file, or the numbered files, at `path`.
pub fn of_file(path: &Path) -> Result<Portrait> {
    let smoke = Smoke::read(path)?;
    let [low, high] = levels::seen(&smoke);
    let size = high - low;
    let is_flat = size.x.min(size.z) > FLAT * size.y;
    let ground = if is_flat { low.y - HOVERING * size.y } else { low.y };
    let view = View::of([DVec3::new(low.x, ground, low.z), high]);
    let levels = Levels::of(&smoke, &view);
    let digits = (3.0 - size.max_element().log10()).ceil().clamp(0.0, 15.0) as usize;
    Ok(Portrait { smoke, view, levels, ground, digits })
}

impl Portrait {
    /// The scene, in which the file is called `name`.
    pub fn text(&self, name: &str) -> String {
        let Self { smoke, view, ground, .. } = self;
        let [sky, sun, earth] = if smoke.fire.is_some() { DUSK } else { DAY };
        let reach = (view.origin - view.target).length();
        let size = 0.5 * reach;
        let [width, height] = view.size;
        let [sky, sun, earth] =
            [sky, sun, earth].map(|colour| format!("{{ \"type\": \"rgb\", \"value\": {colour:?} }}"));
        let (x, z) = (self.number(view.target.x), self.number(view.target.z));
        format!(
            r#"{{
  "type": "scene",
  "$defaults": {{ {} }},
  "smoke": {{ "type": "smoke", "filename": {}{} }},
  "ground": {{
    "type": "disk",
    "to_world": [
      {{ "type": "scale", "value": {} }},
      {{ "type": "rotate", "axis": [1, 0, 0], "angle": -90 }},
      {{ "type": "translate", "value": [{x}, {}, {z}] }}
    ],
    "bsdf": {{ "type": "diffuse", "reflectance": {earth} }}
  }},
  "sky": {{ "type": "constant", "radiance": {sky} }},
  "sun": {{ "type": "directional", "direction": {SUN:?}, "irradiance": {sun} }},
  "camera": {{
    "type": "perspective",
    "fov": {},
    "fov_axis": "larger",
    "near_clip": {},
    "far_clip": {},
    "to_world": [
      {{
        "type": "lookat",
        "origin": {},
        "target": {},
        "up": [0, 1, 0]
      }}
    ],
    "film": {{ "type": "hdrfilm", "width": {width}, "height": {height} }},
    "sampler": {{ "type": "independent", "sample_count": 64 }}
  }}
}}
"#,
            self.defaults(),
            serde_json::Value::from(escaped(name)),
            self.chosen(),
            self.number(GROUND * size),
            self.number(*ground),
            View::FOV,
            self.number(0.01 * reach),
            self.number(3.0 * GROUND * reach),
            self.place(view.origin),
            self.place(view.target),
        )
    }

    fn number(&self, x: f64) -> String {
        format!("{x:.*}", self.digits)
    }

    fn place(&self, place: DVec3) -> String {
        format!("[{}]", place.to_array().map(|x| self.number(x)).join(", "))
    }

    /// Numbers that one would change first.
    fn defaults(&self) -> String {
        let density = format!("\"density_scale\": {:?}", self.levels.density);
        let fire =
            self.smoke.fire.as_ref().map(|_| format!("\"emission_scale\": {:?}", self.levels.emission));
        [density].into_iter().chain(fire).collect::<Vec<_>>().join(", ")
    }

    /// What the smoke is told beside its file.
    fn chosen(&self) -> String {
        let mut all = vec![("up", if self.smoke.is_z_up { "\"z\"" } else { "\"y\"" }.to_owned())];
        match &self.smoke.said {
            None => {}
            Some(Said::Fog) => all.push(("level_set_to_fog", "true".to_owned())),
            Some(Said::Density(name)) => {
                all.push(("density_grid", serde_json::Value::from(escaped(name)).to_string()))
            }
        }
        all.push(("density_scale", "\"$density_scale\"".to_owned()));
        all.extend(self.smoke.fire.as_ref().map(|_| ("emission_scale", "\"$emission_scale\"".to_owned())));
        all.extend((!self.smoke.is_coloured).then(|| ("albedo", "0.9".to_owned())));
        all.iter().map(|(name, value)| format!(", \"{name}\": {value}")).collect()
    }

    /// What was found in the file at `path`, and chosen.
    pub fn told(&self, path: &Path) -> Vec<String> {
        let Smoke { domain: [low, high], is_z_up, frame, .. } = &self.smoke;
        let [x, y, z] = (*high - *low).to_array().map(|length| self.number(length));
        let up = if *is_z_up { "z, as Blender writes it" } else { "y" };
        let mut all = vec![format!("{}: {x} x {y} x {z} (width, height, depth), up is {up}", path.display())];
        all.extend(frame.as_ref().map(|frame| format!("all frames are seen as {} fits", frame.display())));
        if self.smoke.density.is_some() {
            let Levels { density, thickness, .. } = self.levels;
            all.push(match thickness {
                Some(thickness) => {
                    format!("density_scale {density} makes the smoke {thickness} mean free paths thick")
                }
                None => "the smoke is so thin that none of it is seen".to_owned(),
            });
        }
        if self.smoke.fire.is_some() {
            all.push(format!("emission_scale {} makes the fire bright at dusk", self.levels.emission));
        }
        all
    }
}
