//! A clear sky with the sun: Mitsuba's `sunsky`, and on the mean over hours and days its `timed_sunsky`.

mod hosek;
mod position;
mod timed;

use super::{
    COMMON, InfiniteModel, Seen,
    envmap::{EnvMap, of_pixel, to_local},
};
use crate::{
    description::{Params, Table, parameter::Parameter, rows, table},
    error::Result,
    math::{DMat3, DVec3, Frame, Spectrum, SpectrumExt, Vec3, vec2, vec3, warp},
    sampling::Stream,
    texture::image::Image,
};
use hosek::{Sky, sun_irradiance};
use position::{NAMES, PLACE, WHEN, towards_sun};
use std::f32::consts::{FRAC_PI_2, TAU};

/// Columns and rows of the map of the sky: a third of a degree, so that interpolation is off by 0.1 % at most.
const MAP: [usize; 2] = [1024, 513];

/// From the sky's own axes, z up, to those of the map, y up.
const TO_MAP: DMat3 = DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y);

/// Where both shine, sun and sky are sampled at least so often.
const LEAST_SHARE: f64 = 0.1;

/// A smaller sun (rad) counts as of this size: directions in f32 could not tell its inside from its edge.
const LEAST_HALF_APERTURE: f64 = 1e-4;

/// The parameters of what shines.
const LIGHT: &[Parameter] = rows! {
    number("turbidity", "", within(1.0, 10.0), Is(3.0), "Haze: 2 is very clear, 10 hazy."),
    colour("albedo", "", 1.0, Is(0.3), "Albedo of the ground, which lights the sky."),
    number("sun_scale", "", within(0.0, MAX), Is(1.0), "Scales the sun's radiance; 0: none."),
    number("sky_scale", "", within(0.0, MAX), Is(1.0), "Scales the sky's radiance; 0: none."),
    number("sun_aperture", "degrees", between(0.0, 90.0), Is(0.5358), "Angle that the sun spans. Its irradiance stays the same."),
    ignored("complex_sun", "the sun's disk is even, at the same irradiance"),
    transform("to_world", "Rotates or mirrors it; before that, z is up."),
};

/// Their values.
struct Light {
    turbidity: f32,
    albedo: Spectrum,
    sun_scale: f64,
    sky_scale: f64,
    half_aperture: f64,
    to_local: DMat3,
}

impl Light {
    fn read(params: &Params<'_>) -> Result<Self> {
        Ok(Self {
            turbidity: params.float("turbidity")? as f32,
            albedo: params.color("albedo")?,
            sun_scale: params.float("sun_scale")?,
            sky_scale: params.float("sky_scale")?,
            half_aperture: (0.5 * params.float("sun_aperture")?.to_radians()).max(LEAST_HALF_APERTURE),
            to_local: to_local(params)?,
        })
    }
}

/// The sky as a map, and the sun as an even disk in it. Nothing shines from below the horizon.
#[derive(Clone, Debug)]
pub struct SunSky {
    sky: EnvMap,
    sun: Sun,
    /// The fraction of samples that the sun gets.
    share: f32,
    /// Unit vector to the zenith.
    up: Vec3,
    /// Integral of radiance over all directions (W/m^2).
    fluence: DVec3,
}

#[derive(Clone, Copy, Debug)]
struct Sun {
    frame: Frame,
    /// 1 - cos of the angle from its centre to its edge, and the squared sine.
    one_minus_cos: f32,
    sine_squared: f32,
    /// Radiance (W/(m^2 sr)).
    radiance: Spectrum,
}

impl SunSky {
    pub(super) const TABLE: Table = table! {
        "A clear sky with the sun: the models of Hosek and Wilkie 2012 and 2013. Without `sun_direction`, the sun stands where it does at that date, time and place; x is south, y west.";
        vector("sun_direction", "", Said("by date, time and place"), "Direction to the sun in the world.");
        LIGHT, PLACE, WHEN, COMMON
    };

    pub(super) fn build(params: &Params<'_>) -> Result<Self> {
        let Light { turbidity, albedo, sun_scale, sky_scale, half_aperture, to_local } = Light::read(params)?;
        let sun = sun_direction(params, to_local)?;
        let is_day = sun.z >= 0.0;
        if !is_day {
            let text = "the sun is below the horizon, so that this sky is black. Change its date and time or its direction";
            params.library.warn(params.location(), text);
        }
        let shines = |scale: f64| if is_day { scale as f32 } else { 0.0 };
        let elevation = FRAC_PI_2 - (sun.truncate().length().atan2(sun.z)) as f32;
        let map = sky_map(&Sky::new(turbidity, albedo, elevation), sun);
        let to_map = (TO_MAP * to_local).as_mat3();
        let sky = EnvMap::new(map, to_map, shines(sky_scale), false);
        let irradiance = sun_irradiance(turbidity, elevation) * shines(sun_scale);
        let frame = Frame::around((to_local.transpose() * sun).as_vec3());
        let sun = Sun::new(frame, half_aperture, irradiance);
        let up = (to_local.transpose() * DVec3::Z).as_vec3();
        let risen = irradiance.as_dvec3() * sun.risen(up);
        let share = share([risen, sky.fluence()]);
        let fluence = risen + sky.fluence();
        Ok(Self { sky, sun, share, up, fluence })
    }

    /// What both have in a direction in which the sky is as `seen`.
    #[inline]
    fn with_sun(&self, towards: Vec3, seen: Seen) -> Seen {
        let is_up = self.up.dot(towards) >= 0.0;
        let (sun, pdf) = if self.sun.is_at(towards) {
            (self.sun.radiance, warp::cone_pdf(self.sun.one_minus_cos))
        } else {
            (Spectrum::ZERO, 0.0)
        };
        let of_both = |sky: f32| self.share * pdf + (1.0 - self.share) * sky;
        let radiance = if is_up { seen.radiance + sun } else { Spectrum::ZERO };
        Seen { radiance, pdf_sr: of_both(seen.pdf_sr), aimed_sr: of_both(seen.aimed_sr) }
    }
}

impl Sun {
    fn new(frame: Frame, half_aperture: f64, irradiance: Spectrum) -> Self {
        let one_minus_cos = 2.0 * (0.5 * half_aperture).sin().powi(2);
        Self {
            frame,
            one_minus_cos: one_minus_cos as f32,
            sine_squared: half_aperture.sin().powi(2) as f32,
            radiance: irradiance / (TAU * one_minus_cos as f32),
        }
    }

    /// By the sine, whose digits tell directions in a small disk apart.
    #[inline]
    fn is_at(&self, towards: Vec3) -> bool {
        let axis = self.frame.normal;
        axis.dot(towards) > 0.0 && axis.cross(towards).length_squared() <= self.sine_squared
    }

    /// The fraction of the disk that is above the horizon, to a thousandth.
    fn risen(&self, up: Vec3) -> f64 {
        const FINE: usize = 128;
        let place = |i: usize| (i as f32 + 0.5) / FINE as f32;
        let towards = |i: usize| warp::to_cone(vec2(place(i / FINE), place(i % FINE)), self.one_minus_cos);
        let is_up = |i: &usize| self.frame.to_world(towards(*i)).dot(up) >= 0.0;
        (0..FINE * FINE).filter(is_up).count() as f64 / (FINE * FINE) as f64
    }

    #[inline]
    fn sample(&self, stream: &mut Stream) -> Vec3 {
        self.frame.to_world(warp::to_cone(stream.square(), self.one_minus_cos)).normalize()
    }
}

impl InfiniteModel for SunSky {
    fn radiance(&self, towards: Vec3) -> Spectrum {
        self.seen(towards).radiance
    }

    fn sample(&self, stream: &mut Stream) -> Vec3 {
        self.aim(stream).0
    }

    fn pdf_sr(&self, towards: Vec3) -> f32 {
        self.seen(towards).pdf_sr
    }

    fn aim(&self, stream: &mut Stream) -> (Vec3, Seen) {
        if stream.uniform() < self.share {
            let towards = self.sun.sample(stream);
            return (towards, self.seen(towards));
        }
        let (towards, seen) = self.sky.aim(stream);
        (towards, self.with_sun(towards, seen))
    }

    fn seen(&self, towards: Vec3) -> Seen {
        self.with_sun(towards, self.sky.seen(towards))
    }

    fn fluence(&self) -> DVec3 {
        self.fluence
    }
}

/// The unit vector to the sun in the sky's own axes.
fn sun_direction(params: &Params<'_>, to_local: DMat3) -> Result<DVec3> {
    let Some(given) = params.optional_vector("sun_direction")? else { return towards_sun(params) };
    if let Some(name) = NAMES.into_iter().find(|name| params.has(name)) {
        let expected = "a sun_direction or date, time and place, not both";
        return Err(params.complain(name, expected, "both"));
    }
    if given == DVec3::ZERO {
        return Err(params.complain("sun_direction", "a non-zero vector", "0, 0, 0"));
    }
    Ok(to_local * (given / given.abs().max_element()).normalize())
}

/// The fraction of samples that the sun gets: by its part of the fluence, but both are found.
fn share(fluences: [DVec3; 2]) -> f32 {
    let [sun, sky] = fluences.map(|fluence| f64::from(fluence.as_vec3().luminance()));
    match (sun > 0.0, sky > 0.0) {
        (true, true) => (sun / (sun + sky)).clamp(LEAST_SHARE, 1.0 - LEAST_SHARE) as f32,
        (true, false) => 1.0,
        (false, _) => 0.0,
    }
}

/// The sky with the sun in direction `sun`; the row of the horizon belongs to it, those below are black.
fn sky_map(sky: &Sky, sun: DVec3) -> Image {
    let [width, height] = MAP;
    let pixel = |index: usize| {
        let towards = TO_MAP.transpose() * of_pixel(index % width, index / width, MAP);
        if index / width > height / 2 {
            return vec3(0.0, 0.0, 0.0);
        }
        let gamma = towards.cross(sun).length().atan2(towards.dot(sun));
        sky.radiance(towards.z.max(0.0) as f32, gamma as f32)
    };
    Image { width, height, pixels: (0..width * height).map(pixel).collect() }
}
