//! Where the sun stands, by date, time and place: Blanco-Muriel et al. 2001, "Computing the solar vector", good to half a
//! minute of arc from 1999 to 2015.

use crate::{
    description::{Params, parameter::Parameter, rows},
    error::Result,
    math::DVec3,
};
use std::f64::consts::PI;

/// The parameters of the place.
pub(super) const PLACE: &[Parameter] = rows! {
    number("latitude", "degrees", within(-90.0, 90.0), Is(35.6894), "Latitude, north of the equator."),
    number("longitude", "degrees", within(-180.0, 180.0), Is(139.6917), "Longitude, east of Greenwich."),
    number("timezone", "h", within(-24.0, 24.0), Is(9.0), "What the clock is ahead of universal time."),
};

/// The parameters of date and time.
pub(super) const WHEN: &[Parameter] = rows! {
    integer("year", within(1.0, 9999.0), Is(2010.0), "Year."),
    integer("month", within(1.0, 12.0), Is(7.0), "Month."),
    integer("day", within(1.0, 31.0), Is(10.0), "Day of the month."),
    number("hour", "h", within(0.0, 24.0), Is(15.0), "Hour of the day."),
    number("minute", "min", within(0.0, 60.0), Is(0.0), "Minute."),
    number("second", "s", within(0.0, 60.0), Is(0.0), "Second."),
};

/// The names of all.
pub(super) const NAMES: [&str; 9] =
    ["latitude", "longitude", "timezone", "year", "month", "day", "hour", "minute", "second"];

/// Where on earth.
pub(super) struct Place {
    /// Radians.
    latitude: f64,
    /// Degrees.
    longitude: f64,
    /// What the clock is ahead of universal time (h).
    timezone: f64,
}

impl Place {
    /// At so many degrees, where the clock is `timezone` hours ahead of universal time.
    pub(super) fn new(latitude: f64, longitude: f64, timezone: f64) -> Self {
        Self { latitude: latitude.to_radians(), longitude, timezone }
    }

    pub(super) fn read(params: &Params<'_>) -> Result<Self> {
        Ok(Self::new(params.float("latitude")?, params.float("longitude")?, params.float("timezone")?))
    }

    /// The unit vector to the sun where the `clock` shows so many hours, `day` days after the 1st of January 2000: x south, y
    /// west, z up.
    pub(super) fn sun(&self, day: f64, clock: f64) -> DVec3 {
        let universal = clock - self.timezone;
        local(day + universal / 24.0 - 0.5, universal, self.latitude, self.longitude)
    }
}

/// The unit vector to the sun: x south, y west, z up.
pub(super) fn towards_sun(params: &Params<'_>) -> Result<DVec3> {
    let clock = params.float("hour")? + (params.float("minute")? + params.float("second")? / 60.0) / 60.0;
    let date = [params.integer("year")?, params.integer("month")?, params.integer("day")?];
    Ok(Place::read(params)?.sun(whole_day(params, "day", date)?, clock))
}

/// Whole days from the 1st of January 2000 to a date; the parameter `name` is its day.
pub(super) fn whole_day(params: &Params<'_>, name: &str, [year, month, day]: [i64; 3]) -> Result<f64> {
    let length = days_of(year, month);
    if day > length {
        let expected = format!("a day of that month, from 1 to {length}");
        return Err(params.complain(name, expected, day.to_string()));
    }
    Ok(days_since_2000([year, month, day]))
}

/// How many days a month has.
pub(super) fn days_of(year: i64, month: i64) -> i64 {
    let next = if month == 12 { [year + 1, 1, 1] } else { [year, month + 1, 1] };
    (days_since_2000(next) - days_since_2000([year, month, 1])) as i64
}

/// Whole days from the 1st of January 2000, in the Gregorian calendar. A year from March to February has its leap day last.
fn days_since_2000([year, month, day]: [i64; 3]) -> f64 {
    let (year, month) = if month < 3 { (year - 1, month + 9) } else { (year, month - 3) };
    let before = 365 * year + year / 4 - year / 100 + year / 400 + (153 * month + 2) / 5;
    (before + day - 1 - 730_425) as f64
}

/// `days` since noon of that day, of which `universal` hours are those since midnight; `longitude` in degrees.
fn local(days: f64, universal: f64, latitude: f64, longitude: f64) -> DVec3 {
    let node = 2.1429 - 0.001_039_459_4 * days;
    let mean_longitude = 4.895_063_0 + 0.017_202_791_698 * days;
    let anomaly = 6.240_060_0 + 0.017_201_969_9 * days;
    let centre = 0.033_416_07 * anomaly.sin() + 0.000_348_94 * (2.0 * anomaly).sin();
    let ecliptic = mean_longitude + centre - 0.000_113_4 - 0.000_020_3 * node.sin();
    let obliquity = 0.409_092_8 - 6.214e-9 * days + 0.000_039_6 * node.cos();
    let ascension = (obliquity.cos() * ecliptic.sin()).atan2(ecliptic.cos());
    let declination = (obliquity.sin() * ecliptic.sin()).asin();
    let sidereal = 6.697_424_324_2 + 0.065_709_828_3 * days + universal;
    let hour_angle = (15.0 * sidereal + longitude).to_radians() - ascension;
    let zenith = (latitude.cos() * hour_angle.cos() * declination.cos() + declination.sin() * latitude.sin())
        .clamp(-1.0, 1.0)
        .acos();
    // From the centre of the earth to its surface, over the distance of the sun.
    let zenith = zenith + 6371.01 / 149_597_890.0 * zenith.sin();
    let from_north =
        (-hour_angle.sin()).atan2(declination.tan() * latitude.cos() - latitude.sin() * hour_angle.cos());
    let azimuth = from_north - PI;
    DVec3::new(zenith.sin() * azimuth.cos(), zenith.sin() * azimuth.sin(), zenith.cos())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_counted() {
        for (date, days) in
            [([2000, 1, 1], 0.0), ([2000, 3, 1], 60.0), ([1999, 12, 31], -1.0), ([2100, 3, 1], 36_584.0)]
        {
            assert_eq!(days_since_2000(date), days, "{date:?}");
        }
    }

    /// Values of Mitsuba 3.9.1, in f32.
    #[test]
    fn the_sun_stands_where_mitsuba_has_it() {
        for (date, clock, zone, [latitude, longitude], expected) in [
            ([2010, 7, 10], 15.0, 9.0, [35.6894, 139.6917], [0.051_385, 0.691_748, 0.720_309]),
            ([2024, 6, 21], 13.675, 2.0, [50.85, 4.35], [0.460_321, -0.016_097, 0.887_606]),
            ([1999, 12, 1], 9.0, 10.0, [-33.9, 151.2], [-0.084_442, -0.609_317, 0.788_418]),
        ] {
            let universal = clock - zone;
            let days = days_since_2000(date) + universal / 24.0 - 0.5;
            let found = local(days, universal, f64::to_radians(latitude), longitude);
            assert!(found.distance(DVec3::from(expected)) < 2e-3, "{date:?}: {found}");
        }
    }
}
