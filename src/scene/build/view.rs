//! The camera, its film and its sampler.

use super::Builder;
use crate::{
    description::{Location, Object},
    error::Result,
    film::Film,
    math::{Vec2, Vec3},
    medium::MediumIndex,
    scene::shutter,
    sensor::{self, Crop, Sensor, Site},
    settings::{
        Overrides, film, only_one,
        sampler::{self, Sampling},
    },
};

/// The camera with its film.
pub(super) struct View<'a> {
    pub(super) camera: Camera<'a>,
    pub(super) film: Film,
    pub(super) sampling: Sampling,
}

/// The camera as the file places it.
pub(super) struct Camera<'a> {
    pub(super) sensor: Sensor,
    pub(super) crop: Crop,
    /// Where the ray through the middle of the image starts: on the near plane.
    pub(super) start: Vec3,
    /// Width and height of the image (pixels).
    pub(super) size: Vec2,
    /// The medium that the file says it is in.
    pub(super) stated: Option<MediumIndex>,
    pub(super) location: &'a Location,
}

impl<'a> Builder<'a> {
    pub(super) fn view(&mut self, object: &'a Object, overrides: Overrides) -> Result<View<'a>> {
        let (params, build) = sensor::ROWS.read(object, self.library)?;
        let films = params.children("film", film::is_film)?;
        let film = match films.as_slice() {
            [] => film::default(overrides),
            [one] => film::build(one.object, self.library, overrides)?,
            [_, second, ..] => return Err(only_one(second, "film")),
        };
        let is_sized = !films.is_empty() || overrides.size.is_some();
        let film = match sensor::is_meter(&object.plugin) {
            true => film::of_one_pixel(&film, object, is_sized)?,
            false => film,
        };
        let film = film::cropped(film, overrides.crop)?;
        let sampling = match params.children("sampler", |child| sampler::ROWS.has(child.object))?.as_slice() {
            [] => Sampling::default(),
            [one] => sampler::build(one.object, self.library)?,
            [_, second, ..] => return Err(only_one(second, "sampler")),
        };
        let stated = self.stated_medium(&params)?;
        let crop = Crop { film: film.window.full_size, offset: film.window.offset };
        let (shapes, places) = (self.shapes.as_slice(), &self.parts.shapes);
        let sensor = build(&params, &Site { recentre: self.recentre, crop, shapes, places })?;
        shutter::check(&params)?;
        params.finish()?;
        let size = Vec2::from(film.window.size.map(|pixels| pixels as f32));
        let start = sensor.ray(0.5 * size, Vec2::ZERO).ray.origin;
        Ok(View {
            camera: Camera { sensor, crop, start, size, stated, location: &object.location },
            film,
            sampling,
        })
    }
}
