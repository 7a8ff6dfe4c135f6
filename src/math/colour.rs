//! Colour spaces, and spectra as colours.

use super::{
    DVec3, Vec3,
    cie::{D65, FIRST, LAST, OBSERVER, STEP},
    vec3,
};

/// CIE XYZ to linear sRGB (ITU-R BT.709 primaries, white D65), rounded as Mitsuba rounds it: pictures agree.
pub fn xyz_to_rgb(xyz: DVec3) -> DVec3 {
    DVec3::new(
        xyz.dot(DVec3::new(3.240_479, -1.537_150, -0.498_535)),
        xyz.dot(DVec3::new(-0.969_256, 1.875_991, 0.041_556)),
        xyz.dot(DVec3::new(0.055_648, -0.204_043, 1.057_311)),
    )
}

/// CIELAB (CIE 015:2018) of a colour whose CIE XYZ, each over that of white, are given; 100 is the lightness of white.
pub fn lab(over_white: Vec3) -> Vec3 {
    let root = |t: f32| if t > (6.0f32 / 29.0).powi(3) { t.cbrt() } else { t * 841.0 / 108.0 + 4.0 / 29.0 };
    let [x, y, z] = over_white.to_array().map(root);
    vec3(116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z))
}

/// What a spectrum is multiplied by before an eye sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Illuminant {
    /// Nothing: it is light itself, and 1 at all wavelengths has luminance 1.
    Equal,
    /// Daylight, scaled so that a perfect reflector has luminance 1: it is a property of matter.
    D65,
}

/// The integral of y over all wavelengths (nm), as Mitsuba rounds it: luminance per unit of a spectrum.
const Y_INTEGRAL: f64 = 106.750_259_399_414_06;

/// The luminance of the table of D65 over that of 1 at all wavelengths, as Mitsuba rounds it.
const D65_LUMINANCE: f64 = 98.997_417_518_762_55;

/// Linear sRGB of the spectrum that has `value` at each wavelength (nm); outside the gamut, negative.
///
/// The quadrature is Mitsuba's, one part in 1000 short of the whole: 1000 points with both ends among them,
/// each for a 1000th of the range.
pub fn of_spectrum(illuminant: Illuminant, value: impl Fn(f64) -> f64) -> DVec3 {
    const STEPS: u32 = 1000;
    let xyz: DVec3 = (0..STEPS)
        .map(|i| {
            let wavelength = FIRST + f64::from(i) / f64::from(STEPS - 1) * (LAST - FIRST);
            let light = match illuminant {
                Illuminant::Equal => 1.0,
                Illuminant::D65 => at(wavelength, |i| D65[i]) / D65_LUMINANCE,
            };
            at(wavelength, |i| DVec3::from(OBSERVER[i])) * (light * value(wavelength))
        })
        .sum();
    xyz_to_rgb(xyz * ((LAST - FIRST) / f64::from(STEPS) / Y_INTEGRAL))
}

/// Linear sRGB of light with 1 at all wavelengths: slightly purple, for white is D65.
pub fn of_equal_light() -> DVec3 {
    xyz_to_rgb(DVec3::ONE)
}

/// Between the entries of a table; `wavelength` within it.
fn at<T: std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>>(
    wavelength: f64,
    table: impl Fn(usize) -> T,
) -> T {
    let place = (wavelength - FIRST) / STEP;
    let index = (place as usize).min(OBSERVER.len() - 2);
    let t = place - index as f64;
    table(index) * (1.0 - t) + table(index + 1) * t
}

/// The value at `wavelength` of a spectrum given by (wavelength, value) `pairs` in order of wavelength; 0
/// beyond the first and the last.
pub fn interpolated(pairs: &[(f64, f64)], wavelength: f64) -> f64 {
    let after = pairs.partition_point(|pair| pair.0 <= wavelength).min(pairs.len().saturating_sub(1));
    let Some(((w0, v0), (w1, v1))) = after.checked_sub(1).map(|before| (pairs[before], pairs[after])) else {
        return 0.0;
    };
    if wavelength > w1 {
        return 0.0;
    }
    let t = (wavelength - w0) / (w1 - w0);
    v0 * (1.0 - t) + v1 * t
}

/// Spectral radiance of a black body (W/(m^2 sr nm)) at `wavelength` (nm) and `temperature` (K): Planck's law
/// with the constants of the SI (2019).
pub fn black_body(temperature: f64, wavelength: f64) -> f64 {
    const H: f64 = 6.626_070_15e-34;
    const C: f64 = 299_792_458.0;
    const K: f64 = 1.380_649e-23;
    let metres = wavelength * 1e-9;
    let photon = H * C / (metres * K * temperature);
    1e-9 * 2.0 * H * C * C / metres.powi(5) / photon.exp_m1()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pairs, under D65, and the colour before clamping to the gamut.
    type Fact = (&'static [(f64, f64)], bool, [f64; 3]);

    /// What Mitsuba 3.9.1 makes of them (`spectrum_list_to_srgb` in f32, not bounded by 1).
    const FACTS: [Fact; 14] = [
        (&[(400.0, 0.1), (700.0, 0.4)], true, [0.340_778_71, 0.242_912_28, 0.140_303_49]),
        (&[(400.0, 0.1), (700.0, 0.4)], false, [0.402_061_55, 0.231_367_98, 0.124_453_29]),
        (&[(360.0, 1.0), (830.0, 1.0)], true, [0.998_983_44, 0.998_872_28, 0.998_802_19]),
        (&[(360.0, 1.0), (830.0, 1.0)], false, [1.204_882_62, 0.948_228_9, 0.909_266_77]),
        (&[(400.0, 0.3), (700.0, 0.3)], true, [0.298_602_4, 0.299_926_97, 0.298_472_82]),
        (&[(500.0, 3.0), (520.0, 3.0)], true, [-0.494_858, 0.581_305_27, 0.043_758_22]),
        (&[(500.0, 3.0), (520.0, 3.0)], false, [-0.456_724, 0.537_143_35, 0.039_748_3]),
        (&[(400.0, -2.0), (700.0, 2.0)], true, [1.225_909_11, -0.093_690_7, -1.445_65]),
        (
            &[(300.0, 0.2), (450.0, 0.9), (451.0, 0.1), (600.0, 0.5), (900.0, 0.7)],
            true,
            [0.618_677_68, 0.302_250_89, 0.465_831_28],
        ),
        (
            &[(300.0, 0.2), (450.0, 0.9), (451.0, 0.1), (600.0, 0.5), (900.0, 0.7)],
            false,
            [0.714_059_83, 0.287_075_52, 0.447_967_56],
        ),
        (&[(400.0, 20.0), (500.0, 3.0), (700.0, 1.0)], false, [2.471_428_39, 1.809_966_68, 11.084_326_74]),
        (&[(380.0, 1.0), (780.0, 1.0)], true, [0.998_931_47, 0.998_910_96, 0.998_544_93]),
        (&[(400.0, 2.0), (700.0, 2.0)], false, [2.399_387_12, 1.899_040_7, 1.806_886_67]),
        (&[(900.0, 1.0), (1000.0, 2.0)], false, [0.0; 3]),
    ];

    #[test]
    fn spectra_become_the_colours_of_mitsuba() {
        for (pairs, under_d65, color) in FACTS {
            let illuminant = if under_d65 { Illuminant::D65 } else { Illuminant::Equal };
            let found = of_spectrum(illuminant, |wavelength| interpolated(pairs, wavelength));
            let tolerance = 2e-5 * DVec3::from(color).abs().max_element();
            assert!((found - DVec3::from(color)).abs().max_element() <= tolerance, "{pairs:?}: {found}");
        }
    }

    #[test]
    fn light_of_one_at_all_wavelengths_is_that_of_mitsuba() {
        let color = DVec3::new(1.204_793_95, 0.948_291_02, 0.908_916_07);
        assert!((of_equal_light() - color).abs().max_element() < 1e-6, "{}", of_equal_light());
    }

    #[test]
    fn black_bodies_shine_as_in_mitsuba() {
        // Mitsuba's own spot check (5000 K), and the mean of 262144 samples of a picture in scalar_spectral of a
        // constant environment, with the standard error of the mean.
        let spots = [(456.0, 10_997.9), (700.0, 11_812.0)];
        for (wavelength, value) in spots {
            assert!((black_body(5000.0, wavelength) / value - 1.0).abs() < 1e-4);
        }
        let means = [
            (5000.0, [15_277.226, 12_094.978, 9_582.503], [4.67, 0.465, 10.2]),
            (2000.0, [16.037_539, 4.114_326, 0.129_228], [0.006, 0.001_1, 0.000_6]),
        ];
        for (temperature, mean, error) in means {
            let found = of_spectrum(Illuminant::Equal, |wavelength| black_body(temperature, wavelength));
            let deviation = (found - DVec3::from(mean)).abs();
            // The quadrature is one part in 1000 short.
            let allowed = 4.0 * DVec3::from(error) + 1e-3 * DVec3::from(mean);
            assert!(deviation.cmple(allowed).all(), "{temperature}: {found} for {mean:?}");
        }
    }
}
