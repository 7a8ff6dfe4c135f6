//! The colour of a black body at any temperature, from a table, as it is evaluated at every point of a flame.

use super::{
    DVec3, Spectrum,
    colour::{Illuminant, black_body, of_spectrum},
};
use std::sync::OnceLock;

/// Below this a body is black to any eye (K): at 250 K its luminance is 1e-37 of that at 2000 K.
const COLDEST: f64 = 250.0;
/// Intervals of the table, even in 1/T.
const INTERVALS: usize = 1024;
/// h c / (k 600 nm) (K): exp(x) - 1 of this over T takes most of the dependence on T out of what is tabulated.
const MIDDLE: f64 = 23_979.6;
/// What Planck's law is evaluated at in place of 1/T = 0 [1/K].
const HOTTEST: f64 = 1e-12;

/// Radiance (W/(m^2 sr nm)) of a black body of `temperature` (K) as linear sRGB, the same as that of the colour
/// plugin `blackbody`: none where it is too cold to be seen, infinite where no f32 holds it.
pub fn radiance(temperature: f32) -> Spectrum {
    static TABLE: OnceLock<Vec<Entry>> = OnceLock::new();
    let temperature = f64::from(temperature);
    if temperature.is_nan() || temperature < COLDEST {
        return Spectrum::ZERO;
    }
    let table = TABLE.get_or_init(|| (0..=INTERVALS).map(Entry::new).collect());
    let place = COLDEST / temperature * INTERVALS as f64;
    let index = (place as usize).min(INTERVALS - 1);
    let (t, [a, b]) = (place - index as f64, [&table[index], &table[index + 1]]);
    let luminance = (a.log + t * (b.log - a.log)).exp() / (MIDDLE / temperature).exp_m1();
    let colour = a.colour + t * (b.colour - a.colour);
    (colour * luminance).max(DVec3::ZERO).as_vec3()
}

/// A row of the table: both entries are smooth in 1/T and far from 0 and infinity, down to the coldest and up without
/// end.
struct Entry {
    /// ln of luminance times exp(MIDDLE / T) - 1.
    log: f64,
    /// Linear sRGB over luminance, out of gamut where it is.
    colour: DVec3,
}

impl Entry {
    fn new(index: usize) -> Self {
        let inverse = (index as f64 / INTERVALS as f64 / COLDEST).max(HOTTEST);
        let rgb = of_spectrum(Illuminant::Equal, |wavelength| black_body(1.0 / inverse, wavelength));
        let luminance = rgb.dot(DVec3::new(0.212_671, 0.715_160, 0.072_169));
        Self { log: (luminance * (MIDDLE * inverse).exp_m1()).ln(), colour: rgb / luminance }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exact(temperature: f64) -> DVec3 {
        of_spectrum(Illuminant::Equal, |wavelength| black_body(temperature, wavelength)).max(DVec3::ZERO)
    }

    #[test]
    fn the_table_is_planck_s_law() {
        // Some between the entries, some where channels leave the gamut.
        for temperature in [600.0, 800.0, 1234.5, 1900.0, 1950.0, 2000.0, 3333.0, 6504.0, 2e4, 1e6, 1e15] {
            let (found, truth) =
                (radiance(temperature as f32).as_dvec3(), exact(f64::from(temperature as f32)));
            let allowed = 1e-4 * truth.max_element();
            assert!((found - truth).abs().max_element() < allowed, "{temperature}: {found} for {truth}");
        }
    }

    #[test]
    fn hotter_is_brighter_and_nothing_is_too_hot_or_too_cold() {
        for cold in [-1.0, 0.0, 1e-30, 249.0, f32::NAN, f32::NEG_INFINITY] {
            assert_eq!(radiance(cold), Spectrum::ZERO);
        }
        let mut before = Spectrum::ZERO;
        for step in 0..4_000 {
            let now = radiance(250.0 * 1.01f32.powi(step));
            assert!(now.cmpge(before * (1.0 - 1e-6)).all(), "{step}: {now} after {before}");
            before = now;
        }
        assert!(radiance(1e30).is_finite() && radiance(f32::MAX).min_element() > 1e30);
        assert_eq!(radiance(f32::INFINITY), Spectrum::INFINITY);
    }
}
