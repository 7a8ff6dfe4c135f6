//! What one asks first of a scene: how large it is, where the camera stands, and how thick its media are.

use super::volumes::numbers;
use crate::{
    math::{Bounds, DVec3, Spectrum},
    medium::MediumIndex,
    render::progressive::optical_depths,
    scene::{build::Setup, media::MediaMap},
};
use serde_json::{Value, json};

/// Rays along each side of the image.
const RAYS: u32 = 24;

/// What is found.
pub(super) struct Overview {
    /// The box around all shapes, if there are any.
    size: Option<[DVec3; 2]>,
    camera: DVec3,
    camera_in: String,
    /// Media by their names with their greatest extinction (1/m), and whether that is the same everywhere and in all directions.
    media: Vec<(String, Spectrum, bool)>,
    /// Optical depths across the view, the least first.
    depths: Vec<f32>,
    /// While the scene moves: from when to when, after its time, the shutter is open (s).
    exposure: Option<[f64; 2]>,
}

impl Overview {
    /// That of `setup`.
    pub(super) fn of(setup: &Setup) -> Self {
        let scene = &setup.scene;
        let place = |position: crate::math::Vec3| position.as_dvec3() + scene.recentre;
        let Bounds { low, high } = scene.geometry.bounds();
        let medium = |index: usize| {
            let (medium, name) = (&scene.media[index], setup.medium_name(MediumIndex(index as u32)));
            (name, medium.densest(), medium.heterogeneous().is_none() && !medium.depends_on_direction())
        };
        let mut depths = optical_depths(scene, &setup.film, RAYS);
        depths.sort_by(f32::total_cmp);
        Self {
            size: low.cmple(high).all().then(|| [low, high].map(place)),
            camera: place(scene.sensor.position()),
            camera_in: camera_in(setup),
            media: (1..=setup.medium_names.len()).map(medium).collect(),
            depths,
            exposure: setup.exposure(),
        }
    }

    /// The least, the middle and the greatest optical depth across the view.
    fn thickness(&self) -> Option<[f32; 3]> {
        let middle = self.depths.get(self.depths.len() / 2)?;
        Some([*self.depths.first()?, *middle, *self.depths.last()?])
    }

    /// In lines.
    pub(super) fn lines(&self) -> Vec<String> {
        let mut lines = vec![];
        if let Some([low, high]) = self.size {
            let [x, y, z] = (high - low).to_array().map(brief);
            let ends = [low, high].map(|end| numbers(rounded(end, (high - low).max_element())));
            lines.push(format!("size        {x} x {y} x {z} m, from {} to {}", ends[0], ends[1]));
        }
        lines.push(format!("camera      in {}, at {}", self.camera_in, numbers(self.camera)));
        let path = |(name, extinction, is_everywhere): &(String, Spectrum, bool)| {
            let at_least = if *is_everywhere { "" } else { "at least " };
            format!("free path   {name}: {at_least}{}", free_path(*extinction))
        };
        lines.extend(self.media.iter().map(path));
        if let Some([least, middle, most]) = self.thickness().filter(|[_, _, most]| *most > 0.0) {
            let [least, middle, most] = [least, middle, most].map(|depth| brief(f64::from(depth)));
            lines.push(format!(
                "thickness   {middle} mean free paths lie before what is seen, from {least} to {most} across the view"
            ));
        }
        if let Some([opens, closes]) = self.exposure {
            lines.push(format!(
                "exposure    from {opens} to {closes} s after the scene's time: every sample of a pixel sees another moment. \
                 The other lines describe the scene halfway"
            ));
        }
        lines
    }

    /// For scripts.
    pub(super) fn json(&self) -> Value {
        json!({
            "exposure": self.exposure,
            "box": self.size.map(|ends| ends.map(|end| end.to_array())),
            "camera": { "medium": self.camera_in, "position": self.camera.to_array() },
            "thickness": self.thickness().map(|[least, middle, most]| json!({ "least": least, "median": middle, "greatest": most })),
        })
    }
}

/// The medium around the camera, or all those that its rays start in.
fn camera_in(setup: &Setup) -> String {
    let MediaMap { sensor, sensor_media, .. } = &setup.scene.media_map;
    match sensor_media.as_slice() {
        [] => setup.medium_name(*sensor),
        several => {
            let names: Vec<String> = several.iter().map(|medium| setup.medium_name(*medium)).collect();
            names.join(" and ")
        }
    }
}

/// 1 over an extinction, in metres: of every channel where they differ.
fn free_path(extinction: Spectrum) -> String {
    let paths = extinction.to_array().map(|sigma| brief(1.0 / f64::from(sigma)));
    match &paths {
        [r, g, b] if r == g && g == b => format!("{r} m"),
        _ => format!("{} m", paths.join(" ")),
    }
}

/// A place to a part in 10,000 or more of a `length`, without what single precision adds.
fn rounded(place: DVec3, length: f64) -> DVec3 {
    let step = 10_f64.powi(length.log10().floor() as i32 - 4);
    DVec3::from(place.to_array().map(|x| (x / step).round() * step + 0.0))
}

/// Three digits.
pub(super) fn brief(x: f64) -> String {
    let rounded: f64 = format!("{x:.2e}").parse().unwrap_or(x);
    if rounded.is_infinite() { "endless".to_owned() } else { rounded.to_string() }
}
