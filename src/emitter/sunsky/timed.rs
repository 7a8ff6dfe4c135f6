//! Sun and sky on the mean over the same hours of many days: Mitsuba's `timed_sunsky`.
//!
//! One map holds both, the sun smeared along its paths. The sky depends on the sun's elevation and on the azimuth from it
//! alone: one table for each elevation, turned to all azimuths that the sun has there.

use super::{
    LIGHT, Light, MAP, Sun, SunSky, TO_MAP,
    hosek::{Sky, sun_irradiance},
    position::{PLACE, Place, days_of, whole_day},
};
use crate::{
    description::{Params, Table, table},
    emitter::{
        COMMON, InfiniteModel as _,
        envmap::{EnvMap, of_pixel},
    },
    error::{Error, Result},
    math::{DVec3, Frame, Spectrum, Vec3, vec2, warp},
    texture::image::Image,
};
use std::f64::consts::{PI, TAU};

/// Moments of the mean.
const MOMENTS: usize = 1 << 18;

/// Elevations of the sun, from the horizon to the zenith, and azimuths for which the sky is computed: between them it is
/// off by 0.5 % at most, beside the sun.
const ELEVATIONS: usize = 91;
const AZIMUTHS: usize = 180;

/// Rows of the map from the zenith to the horizon.
const ROWS: usize = MAP[1] / 2 + 1;

/// Roberts' sequence in three dimensions: powers of the positive root of x^4 = x + 1.
const STEPS: [f64; 3] = [0.819_172_513_396_164_5, 0.671_043_606_703_789_2, 0.549_700_477_901_970_2];

/// When, and where on earth.
struct Window {
    place: Place,
    /// Days since 2000 of the first, and how many.
    first: f64,
    days: f64,
    /// Of each day (h).
    hours: [f64; 2],
}

impl SunSky {
    pub(in crate::emitter) const TIMED_TABLE: Table = table! {
        "The mean of sun and sky over the same hours of many days. x is south, y west. The sun is smeared along its paths.";
        integer("start_year", within(1.0, 9999.0), Is(2025.0), "Year of the first day."),
        integer("start_month", within(1.0, 12.0), Is(1.0), "Month of the first day."),
        integer("start_day", within(1.0, 31.0), Is(1.0), "First day."),
        integer("end_year", within(1.0, 9999.0), Said("`start_year` + 1"), "Year of the day after the last."),
        integer("end_month", within(1.0, 12.0), Said("`start_month`"), "Month of the day after the last."),
        integer("end_day", within(1.0, 31.0), Said("`start_day`"), "The day after the last. The first day itself stands for that one day."),
        number("window_start_time", "h", within(0.0, 24.0), Is(7.0), "Hour at which the mean begins each day."),
        number("window_end_time", "h", within(0.0, 24.0), Is(19.0), "Hour at which it ends."),
        silent("shutter_open", "the mean is over all of the time, as where the sensor has the same shutter"),
        silent("shutter_close", "the mean is over all of the time, as where the sensor has the same shutter");
        LIGHT, PLACE, COMMON
    };

    /// On the mean over a window.
    pub(in crate::emitter) fn timed(params: &Params<'_>) -> Result<Self> {
        let light = Light::read(params)?;
        let (window, to_local) = (Window::read(params)?, light.to_local);
        let map = window.map(&light);
        if map.pixels.iter().all(|pixel| *pixel == Spectrum::ZERO) {
            let text = "this sky is black: the sun is below the horizon all the time, or nothing shines. Change its hours, its dates or its scales";
            params.library.warn(params.location(), text);
        }
        let sky = EnvMap::new(map, (TO_MAP * to_local).as_mat3(), 1.0, false);
        let sun = Sun::new(Frame::around(Vec3::Z), light.half_aperture, Spectrum::ZERO);
        let up = (to_local.transpose() * DVec3::Z).as_vec3();
        let fluence = sky.fluence();
        Ok(Self { sky, sun, share: 0.0, up, fluence })
    }
}

impl Window {
    fn read(params: &Params<'_>) -> Result<Self> {
        let start =
            [params.integer("start_year")?, params.integer("start_month")?, params.integer("start_day")?];
        let year = params.optional_integer("end_year")?.unwrap_or(start[0] + 1);
        let month = params.optional_integer("end_month")?.unwrap_or(start[1]);
        // A year after the 29th of February there is none.
        let day = params.optional_integer("end_day")?.unwrap_or(start[2].min(days_of(year, month)));
        let end = [year, month, day];
        let first = whole_day(params, "start_day", start)?;
        let days = whole_day(params, "end_day", end)? - first;
        let hours = [params.float("window_start_time")?, params.float("window_end_time")?];
        let complain = |expected, found, remedy| Err(Error::new(params.location(), expected, found, remedy));
        if days < 0.0 {
            let found = format!("an end {} days before it", -days);
            return complain("an end that is not before the start", found, "exchange the dates");
        }
        if hours[1] < hours[0] {
            let found = format!("{} to {}", hours[0], hours[1]);
            let remedy = "exchange them; for hours across midnight, change \"timezone\"";
            return complain("\"window_start_time\" up to \"window_end_time\"", found, remedy);
        }
        Ok(Self { place: Place::read(params)?, first, days: days.max(1.0), hours })
    }

    /// The directions to the sun when it is above the horizon, evenly in time, each with a point of the unit square.
    fn suns(&self) -> impl Iterator<Item = (DVec3, [f64; 2])> {
        (0..MOMENTS).filter_map(|moment| {
            let day = (self.days * (moment as f64 + 0.5) / MOMENTS as f64).floor();
            let [hour, u, v] = STEPS.map(|step| (0.5 + moment as f64 * step).fract());
            let sun =
                self.place.sun(self.first + day, self.hours[0] + (self.hours[1] - self.hours[0]) * hour);
            (sun.z >= 0.0).then_some((sun, [u, v]))
        })
    }

    /// Both on a map.
    fn map(&self, light: &Light) -> Image {
        let mut suns = vec![[0.0; AZIMUTHS]; ELEVATIONS];
        let mut pixels = vec![Spectrum::ZERO; MAP[0] * MAP[1]];
        let one_minus_cos = (2.0 * (0.5 * light.half_aperture).sin().powi(2)) as f32;
        for (sun, [u, v]) in self.suns() {
            count(&mut suns, sun);
            let disk = Frame::around(sun.as_vec3());
            let towards = disk.to_world(warp::to_cone(vec2(u as f32, v as f32), one_minus_cos)).as_dvec3();
            if towards.z >= 0.0 {
                let elevation = sun.z.atan2(sun.truncate().length()) as f32;
                let (index, solid_angle) = pixel_at(TO_MAP * towards);
                pixels[index] += sun_irradiance(light.turbidity, elevation)
                    * (light.sun_scale / (MOMENTS as f64 * solid_angle)) as f32;
            }
        }
        if light.sky_scale == 0.0 {
            return Image { width: MAP[0], height: MAP[1], pixels };
        }
        let sky = mean_sky(&suns, light);
        for (index, pixel) in pixels.iter_mut().enumerate().take(ROWS * MAP[0]) {
            let towards = TO_MAP.transpose() * of_pixel(index % MAP[0], index / MAP[0], MAP);
            let (before, after, t) = azimuths(towards);
            let row = &sky[index / MAP[0]];
            *pixel += (row[before] + (row[after] - row[before]) * t as f32) * light.sky_scale as f32;
        }
        Image { width: MAP[0], height: MAP[1], pixels }
    }
}

/// Neighbouring azimuths around that of `towards`, and how far it is from the first to the second.
fn azimuths(towards: DVec3) -> (usize, usize, f64) {
    let place = (towards.y.atan2(towards.x) / TAU).rem_euclid(1.0) * AZIMUTHS as f64;
    let before = (place as usize).min(AZIMUTHS - 1);
    (before, (before + 1) % AZIMUTHS, place - before as f64)
}

/// Adds the part of a moment to the elevations and azimuths around that of `sun`.
fn count(suns: &mut [[f64; AZIMUTHS]], sun: DVec3) {
    let place = sun.z.atan2(sun.truncate().length()) / (0.5 * PI) * (ELEVATIONS - 1) as f64;
    let below = (place as usize).min(ELEVATIONS - 2);
    let (before, after, t) = azimuths(sun);
    for (elevation, part) in [(below, below as f64 + 1.0 - place), (below + 1, place - below as f64)] {
        suns[elevation][before] += part * (1.0 - t) / MOMENTS as f64;
        suns[elevation][after] += part * t / MOMENTS as f64;
    }
}

/// The pixel of the map around a direction, and the solid angle over which it counts (sr).
fn pixel_at(towards: DVec3) -> (usize, f64) {
    let height = PI / (MAP[1] - 1) as f64;
    let around = (towards.x.atan2(-towards.z) / TAU).rem_euclid(1.0);
    let column = ((around * MAP[0] as f64) as usize).min(MAP[0] - 1);
    let row = (towards.y.clamp(-1.0, 1.0).acos() / height).round();
    // Beside the pole, rows are interpolated along triangles.
    let tall = ((row * height).sin() * height).max(height * height / 6.0);
    (row as usize * MAP[0] + column, tall * TAU / MAP[0] as f64)
}

/// The sky where the sun is as often at each elevation and azimuth as `suns` say, row by row from the zenith, by azimuth.
fn mean_sky(suns: &[[f64; AZIMUTHS]], light: &Light) -> Vec<[Spectrum; AZIMUTHS]> {
    let mut mean = vec![[Spectrum::ZERO; AZIMUTHS]; ROWS];
    for (elevation, shares) in suns.iter().enumerate() {
        let shares: Vec<_> =
            (0..AZIMUTHS).filter(|k| shares[*k] > 0.0).map(|k| (k, shares[k] as f32)).collect();
        if shares.is_empty() {
            continue;
        }
        let (sine, cosine) = (0.5 * PI * elevation as f64 / (ELEVATIONS - 1) as f64).sin_cos();
        let sky = Sky::new(light.turbidity, light.albedo, sine.atan2(cosine) as f32);
        for (row, sum) in mean.iter_mut().enumerate() {
            let (far, high) = (PI * row as f64 / (MAP[1] - 1) as f64).sin_cos();
            let half: [Spectrum; AZIMUTHS / 2 + 1] = std::array::from_fn(|k| {
                let turn = (TAU * k as f64 / AZIMUTHS as f64).cos();
                let gamma = (sine * high + cosine * far * turn).clamp(-1.0, 1.0).acos();
                sky.radiance(high.max(0.0) as f32, gamma as f32)
            });
            let from_sun: [Spectrum; AZIMUTHS] = std::array::from_fn(|k| half[k.min(AZIMUTHS - k)]);
            for (k, share) in &shares {
                let (first, last) = sum.split_at_mut(*k);
                let beside = last.iter_mut().chain(first).zip(&from_sun);
                beside.for_each(|(sum, radiance)| *sum += *radiance * *share);
            }
        }
    }
    mean
}

#[cfg(test)]
mod tests {
    use super::super::sky_map;
    use super::*;
    use crate::math::DMat3;

    fn window(days: f64, hours: [f64; 2]) -> Window {
        Window { place: Place::new(35.7, 139.7, 9.0), first: 9368.0, days, hours }
    }

    fn light([sun_scale, sky_scale]: [f64; 2]) -> Light {
        let (turbidity, albedo, to_local) = (3.0, Spectrum::splat(0.3), DMat3::IDENTITY);
        Light { turbidity, albedo, sun_scale, sky_scale, half_aperture: 0.005, to_local }
    }

    /// Integral over all directions.
    fn whole(map: &Image) -> DVec3 {
        let solid_angle = |index: usize| pixel_at(of_pixel(index % MAP[0], index / MAP[0], MAP)).1;
        map.pixels.iter().enumerate().map(|(index, pixel)| pixel.as_dvec3() * solid_angle(index)).sum()
    }

    fn off(found: DVec3, expected: DVec3) -> f64 {
        (found / expected - 1.0).abs().max_element()
    }

    #[test]
    fn the_mean_over_a_moment_is_that_moment() {
        let window = window(1.0, [9.0, 9.0]);
        let sun = window.place.sun(window.first, 9.0);
        let elevation = sun.z.asin() as f32;
        let expected = sky_map(&Sky::new(3.0, Spectrum::splat(0.3), elevation), sun);
        let found = window.map(&light([0.0, 1.0]));
        for (index, (found, expected)) in found.pixels.iter().zip(&expected.pixels).enumerate() {
            assert!(
                off(found.as_dvec3() + 1e-3, expected.as_dvec3() + 1e-3) < 0.02,
                "{index}: {found} {expected}"
            );
        }
        assert!(off(whole(&found), whole(&expected)) < 2e-3);
        let risen = whole(&window.map(&light([1.0, 0.0])));
        assert!(off(risen, sun_irradiance(3.0, elevation).as_dvec3()) < 2e-3, "{risen}");
    }

    #[test]
    fn the_mean_is_that_of_the_parts() {
        let light = light([1e-3, 1.0]);
        let of = |days, hours| whole(&window(days, hours).map(&light));
        let halves = 0.5 * (of(1.0, [4.0, 10.0]) + of(1.0, [10.0, 16.0]));
        assert!(off(of(1.0, [4.0, 16.0]), halves) < 2e-3);
        let later = Window { first: 9369.0, ..window(1.0, [4.0, 16.0]) };
        let days = 0.5 * (of(1.0, [4.0, 16.0]) + whole(&later.map(&light)));
        assert!(off(of(2.0, [4.0, 16.0]), days) < 2e-3);
    }
}
