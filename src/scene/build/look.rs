//! A scene seen from elsewhere: only its camera is built again.

use super::Setup;
use crate::{
    description::{Library, Location, Object, Property, TransformStep, Value},
    error::{Error, Result},
    film::Film,
    math::{DVec3, Vec2, Vec3, offset::ROUNDOFF, vec2},
    medium::MediumIndex,
    scene::{
        media::media_before,
        memo::Memo,
        sensors::{sensors, without_sensor},
    },
    sensor::{self, Crop, Sensor, Site},
    shape::Ray,
};
use std::collections::HashMap;

/// Cameras that look from wherever they are put.
const MOVABLE: [&str; 3] = ["perspective", "thinlens", "orthographic"];

/// The parameter by which they are put there.
const PLACEMENT: &str = "to_world";

impl Setup {
    /// The transform of the scene's camera, in the file's coordinates; an error for a sensor that cannot be moved.
    pub fn placement(&self) -> Result<&[TransformStep]> {
        let camera = self.camera()?;
        let given = camera.properties.iter().find(|property| property.name == PLACEMENT);
        match given.map(|property| &property.value) {
            Some(Value::Transform(steps)) => Ok(steps),
            _ => Ok(&[]),
        }
    }

    /// Where the scene is described.
    pub fn location(&self) -> &Location {
        &self.root.location
    }

    /// The sensor as the scene describes it.
    fn camera(&self) -> Result<&Object> {
        let camera = sensors(&self.root).next().ok_or_else(|| without_sensor(&self.root))?;
        if MOVABLE.contains(&camera.plugin.as_str()) {
            return Ok(camera);
        }
        let expected = format!("a camera that can be moved: {}", MOVABLE.join(", "));
        let remedy = "choose another sensor by --sensor, or render this one";
        Err(Error::new(&camera.location, expected, format!("\"{}\"", camera.plugin), remedy))
    }

    /// Places the camera by `steps`, in the file's coordinates, with `film`. Its surroundings decide which medium it is
    /// in; what the scene states for its old place does not count.
    pub fn look(&mut self, steps: &[TransformStep], film: Film) -> Result<()> {
        // What a camera is built from refers to nothing.
        let (camera, library) = (placed(self.camera()?, steps), Library::default());
        let (params, build) = sensor::ROWS.read(&camera, &library)?;
        let crop = Crop { film: film.window.full_size, offset: film.window.offset };
        let (shapes, places) = (self.scene.geometry.shapes(), &HashMap::new());
        let sensor = build(&params, &Site { recentre: self.scene.recentre, crop, shapes, places })?;
        let start = sensor.ray(middle(&film), Vec2::ZERO).ray.origin;
        let medium = self.scene.medium_at(start).unwrap_or(self.scene.media_map.outside);
        let overlaps = self.scene.media_map.overlaps.as_deref();
        let size = Vec2::from(film.window.size.map(|pixels| pixels as f32));
        let media = media_before(&self.scene.locator(), overlaps, &sensor, size);
        (self.scene.sensor, self.scene.crop, self.film) = (sensor, crop, film);
        // What was learnt from another viewpoint does not apply here.
        (self.scene.lights.learnt, self.scene.lights.endings) = (Memo::default(), Memo::default());
        self.enter(medium);
        media.iter().for_each(|medium| self.scene.media_map.shut_in[medium.0 as usize] = false);
        self.scene.media_map.sensor_media = media;
        Ok(())
    }

    /// Puts the camera into `medium`, which then no longer counts as shut in.
    pub fn enter(&mut self, medium: MediumIndex) {
        self.scene.media_map.sensor = medium;
        self.scene.media_map.sensor_media.clear();
        self.scene.media_map.shut_in[medium.0 as usize] = false;
    }

    /// Distance from the camera to the first opaque surface in the middle of the image (m); none without one.
    pub fn distance_ahead(&self) -> Option<f64> {
        let ray = self.scene.sensor.ray(middle(&self.film), Vec2::ZERO).ray;
        let met = self.scene.geometry.march(ray).find(|point| !self.scene.surface(point.shape).transmits)?;
        Some(f64::from((met.position - self.scene.sensor.position()).dot(ray.direction)))
    }

    /// The ray through the middle of the image: its point nearest to the camera, relative to it (m), and its direction.
    pub fn ahead(&self) -> (DVec3, DVec3) {
        let Ray { origin, direction, .. } = self.scene.sensor.ray(middle(&self.film), Vec2::ZERO).ray;
        let position = self.scene.sensor.position();
        let aside = (origin - position).reject_from_normalized(direction);
        // Less than this is rounding.
        let is_aside = aside.length() > 16.0 * ROUNDOFF * position.abs().max_element();
        (if is_aside { aside.as_dvec3() } else { DVec3::ZERO }, direction.as_dvec3().normalize())
    }

    /// Distance from the camera to the middle of all shapes (m); none without shapes, or with endless ones.
    pub fn distance_to_middle(&self) -> Option<f64> {
        let bounds = self.scene.geometry.bounds();
        let middle = 0.5 * (bounds.low + bounds.high);
        bounds.is_finite().then(|| f64::from((middle - self.scene.sensor.position()).length()))
    }

    /// Width of the image 1 m from the camera (m); for parallel rays, at any distance.
    pub fn breadth(&self) -> f64 {
        let [width, height] = [self.film.width, self.film.height].map(|pixels| pixels as f32);
        let [left, right] =
            [0.0, width].map(|x| at_one_metre(&self.scene.sensor, vec2(x, 0.5 * height), &self.film));
        f64::from((right - left).length())
    }
}

/// The film position in the middle of the image.
fn middle(film: &Film) -> Vec2 {
    0.5 * vec2(film.width as f32, film.height as f32)
}

/// Where the ray through a film position passes the plane 1 m before the camera.
fn at_one_metre(sensor: &Sensor, position: Vec2, film: &Film) -> Vec3 {
    let ahead = sensor.ray(middle(film), Vec2::ZERO).ray.direction;
    let ray = sensor.ray(position, Vec2::ZERO).ray;
    let left = 1.0 - (ray.origin - sensor.position()).dot(ahead);
    ray.origin + ray.direction * (left / ray.direction.dot(ahead))
}

/// `camera`, where `steps` put it.
fn placed(camera: &Object, steps: &[TransformStep]) -> Object {
    let mut camera = camera.clone();
    camera.properties.retain(|property| property.name != PLACEMENT);
    let (value, location) = (Value::Transform(steps.to_vec()), camera.location.clone());
    camera.properties.push(Property { name: PLACEMENT.to_owned(), value, location });
    camera
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{format, scene::build::build, settings::Overrides};

    /// A ball of fog in vacuum, and a wall behind the fog.
    const SCENE: &str = r#"{"type": "scene",
        "camera": {"type": "CAMERA", "film": {"type": "hdrfilm", "width": 40, "height": 20}, "fov": 90,
            "to_world": [{"type": "lookat", "origin": [0, 0, 5], "target": [0, 0, 0], "up": [0, 1, 0]}]},
        "fog": {"type": "homogeneous", "sigma_t": 1, "albedo": 0.5},
        "ball": {"type": "sphere", "bsdf": {"type": "null"}, "interior": {"type": "ref", "id": "fog"}},
        "wall": {"type": "rectangle", "to_world": [{"type": "translate", "value": [0, 0, -2]}]},
        "sky": {"type": "constant"}}"#;

    fn setup(text: &str) -> Result<Setup> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("scene.json");
        std::fs::write(&path, text).unwrap();
        build(&format::read(&path, &[])?, Overrides::default())
    }

    fn from(origin: [f64; 3], target: [f64; 3]) -> [TransformStep; 1] {
        [TransformStep::LookAt { origin, target, up: [0.0, 1.0, 0.0] }]
    }

    #[test]
    fn a_camera_elsewhere_sees_and_is_in_what_it_would_be_built_in() {
        let text = SCENE.replace("CAMERA", "perspective");
        let mut moved = setup(&text).unwrap();
        for (origin, target) in
            [("[0, 0.5, 0]", "[0, 0.5, -2]"), ("[3, 0, 0]", "[0, 0.25, 0]"), ("[0, 0, 5]", "[0, 0, 0]")]
        {
            let there = text
                .replace("[0, 0, 5]", origin)
                .replace("target\": [0, 0, 0]", &format!("target\": {target}"));
            let built = setup(&there).unwrap();
            moved.scene.lights.endings.keep("of another camera".to_owned(), 1u32);
            moved.look(built.placement().unwrap(), moved.film.clone()).unwrap();
            assert_eq!(moved.scene.lights.endings.known::<u32>("of another camera"), None);
            assert_eq!(moved.scene.media_map.sensor, built.scene.media_map.sensor, "{origin}");
            let seen = |setup: &Setup| {
                let point = DVec3::new(0.1, 0.2, -2.0) - setup.scene.recentre;
                setup.scene.sensor.project(point.as_vec3(), Vec2::ZERO).map(|seen| seen.film)
            };
            let [a, b] = [&moved, &built].map(seen);
            assert!(a == b || a.unwrap().distance(b.unwrap()) < 1e-3, "{origin}: {a:?} {b:?}");
        }
    }

    #[test]
    fn distances_and_breadths_are_those_of_the_scene() {
        let mut seen = setup(&SCENE.replace("CAMERA", "perspective")).unwrap();
        // Fog is no surface.
        assert!((seen.distance_ahead().unwrap() - 7.0).abs() < 1e-4);
        assert!((seen.distance_to_middle().unwrap() - 5.5).abs() < 1e-4);
        let film = seen.film.coarser(4);
        assert_eq!([film.width, film.height], [10, 5]);
        seen.look(&from([0.0, 0.0, 1.0], [0.0, 1.0, 1.1]), film).unwrap();
        assert_eq!(seen.distance_ahead(), None);
        assert!((seen.breadth() - 2.0).abs() < 1e-5, "{}", seen.breadth());
        let wide = [TransformStep::Scale([3.0; 3]), from([0.0, 0.0, 5.0], [0.0; 3])[0].clone()];
        let mut parallel =
            setup(&SCENE.replace("CAMERA", "orthographic").replace("\"fov\": 90,", "")).unwrap();
        parallel.look(&wide, parallel.film.clone()).unwrap();
        assert!((parallel.breadth() - 6.0).abs() < 1e-5, "{}", parallel.breadth());
    }

    #[test]
    fn a_sensor_that_cannot_be_moved_says_so() {
        let meter = SCENE
            .replace("CAMERA", "radiancemeter")
            .replace("\"width\": 40, \"height\": 20", "\"width\": 1, \"height\": 1");
        let error = setup(&meter.replace("\"fov\": 90,", "")).unwrap().placement().unwrap_err().to_string();
        assert!(
            error.contains("$.camera") && error.contains("radiancemeter") && error.contains("perspective"),
            "{error}"
        );
    }
}
