//! What Mitsuba 3.9.1 (scalar_rgb) makes of everything that represents a colour, read from its parameters
//! after loading.

use super::*;
use crate::testing::{nowhere, object};

fn property(value: Value) -> Property {
    Property { name: "v".into(), value, location: nowhere() }
}

/// The colour, and whether a warning came with it.
fn reported(value: Value, role: Role) -> Result<(DVec3, bool)> {
    let library = Library::default();
    let color = read(&property(value), &library, role)?;
    Ok((color.as_dvec3(), !library.take_warnings().is_empty()))
}

/// Pairs, what they are of, their colour, and whether a warning comes with it.
type SpectrumFact = (&'static [(f64, f64)], Role, [f64; 3], bool);

/// A plugin, its parameters and its colour.
type PluginFact<'a> = (&'a str, &'a [(&'a str, Value)], [f64; 3]);

const RAMP: [(f64, f64); 2] = [(400.0, 0.1), (700.0, 0.4)];
const GREEN: [(f64, f64); 2] = [(500.0, 3.0), (520.0, 3.0)];
const TWO: [(f64, f64); 2] = [(400.0, 2.0), (700.0, 2.0)];
const NEGATIVE: [(f64, f64); 2] = [(400.0, -2.0), (700.0, 2.0)];
const SIX: [(f64, f64); 2] = [(400.0, 1.0), (700.0, 6.0)];

#[test]
fn spectra_are_other_colours_as_matter_and_as_light() {
    use Role::{Index, Light, Matter};
    // A reflectance, an albedo, an extinction; eta or k; an intensity, radiance or irradiance.
    let facts: [SpectrumFact; 15] = [
        (&RAMP, Matter, [0.340_778_68, 0.242_912_31, 0.140_303_52], false),
        (&RAMP, Index, [0.340_778_68, 0.242_912_31, 0.140_303_52], false),
        (&RAMP, Light, [0.402_061_4, 0.231_368_21, 0.124_453_23], false),
        (&[(0.0, 0.3)], Matter, [0.3; 3], false),
        (&[(0.0, 0.3)], Light, [0.361_438_18, 0.284_487_31, 0.272_674_83], false),
        (&[(0.0, 2.0)], Index, [2.0; 3], false),
        (&GREEN, Matter, [0.0, 0.581_305_27, 0.043_758_23], true),
        (&GREEN, Index, [0.0, 0.581_305_27, 0.043_758_23], true),
        (&GREEN, Light, [0.0, 0.537_143_29, 0.039_748_3], true),
        (&TWO, Matter, [1.0; 3], true),
        (&TWO, Index, [1.990_684_03, 1.999_512_79, 1.989_818_22], false),
        (&TWO, Light, [2.399_387_12, 1.899_040_7, 1.806_886_67], false),
        (&NEGATIVE, Matter, [1.0, 0.0, 0.0], true),
        (&NEGATIVE, Light, [1.361_839_89, 0.0, 0.0], true),
        (&SIX, Index, [5.016_083_24, 3.382_034_06, 1.675_119_4], false),
    ];
    for (pairs, role, color, warns) in facts {
        let (found, warned) = reported(Value::Spectrum(pairs.into()), role).unwrap();
        let color = DVec3::from(color);
        assert!(
            (found - color).abs().max_element() < 3e-6 * color.max_element(),
            "{pairs:?} {role:?}: {found}"
        );
        assert_eq!(warned, warns, "{pairs:?} {role:?}");
    }
}

#[test]
fn numbers_and_rgb_are_the_same_in_every_role() {
    for role in [Role::Matter, Role::Index, Role::Light] {
        assert_eq!(reported(Value::Float(0.3), role).unwrap().0, DVec3::splat(f64::from(0.3f32)));
        assert_eq!(reported(Value::Integer(2), role).unwrap().0, DVec3::splat(2.0));
        assert_eq!(reported(Value::Rgb([1.0, 0.5, 0.0]), role).unwrap().0, DVec3::new(1.0, 0.5, 0.0));
        for bad in [Value::Float(-1.0), Value::Float(f64::NAN), Value::Float(1e300), Value::Boolean(true)] {
            assert!(reported(bad, role).unwrap_err().expected.contains("\"v\""));
        }
        assert!(reported(Value::Rgb([-2.0, 0.5, 0.1]), role).is_err());
        assert!(reported(Value::Spectrum(vec![(0.0, -1.0)]), role).is_err());
    }
}

fn text(text: &str) -> Value {
    Value::String(text.into())
}

fn float(x: f64) -> Value {
    Value::Float(x)
}

fn plugin(name: &str, properties: &[(&str, Value)], role: Role) -> Result<(DVec3, bool)> {
    reported(Value::Object(object(name, properties)), role)
}

#[test]
fn plugins_stand_for_the_colours_of_mitsuba() {
    let rgb = ("color", Value::Rgb([0.125, 0.25, 0.5]));
    let facts: [PluginFact<'_>; 9] = [
        ("uniform", &[("value", float(0.25))], [0.25; 3]),
        ("rawconstant", &[("value", float(0.25))], [0.25; 3]),
        ("rawconstant", &[("value", Value::Vector([0.125, 0.25, 0.5]))], [0.125, 0.25, 0.5]),
        ("srgb", std::slice::from_ref(&rgb), [0.125, 0.25, 0.5]),
        (
            "srgb",
            &[("color", Value::Rgb([3.0, 0.25, 0.5])), ("unbounded", Value::Boolean(true))],
            [3.0, 0.25, 0.5],
        ),
        ("d65", &[], [1.0; 3]),
        ("d65", &[("scale", float(2.0))], [2.0; 3]),
        ("d65", std::slice::from_ref(&rgb), [0.125, 0.25, 0.5]),
        ("d65", &[("scale", float(2.0)), rgb.clone()], [0.25, 0.5, 1.0]),
    ];
    for (name, properties, color) in facts {
        for role in [Role::Matter, Role::Light] {
            let found = plugin(name, properties, role).unwrap();
            assert_eq!(found, (DVec3::from(color), false), "{name} {properties:?}");
        }
    }
}

#[test]
fn spectral_plugins_are_as_plain_spectra() {
    let regular = [
        ("wavelength_min", float(400.0)),
        ("wavelength_max", float(700.0)),
        ("values", text("0.1, 0.25 0.4")),
    ];
    let irregular = [("wavelengths", text("400, 450, 700")), ("values", text("0.1, 0.15, 0.4"))];
    let inner = [("value", Value::Spectrum(RAMP.into()))];
    for role in [Role::Matter, Role::Light] {
        let (plain, _) = reported(Value::Spectrum(RAMP.into()), role).unwrap();
        for (name, properties) in
            [("regular", &regular[..]), ("irregular", &irregular), ("regular", &inner), ("irregular", &inner)]
        {
            let (found, _) = plugin(name, properties, role).unwrap();
            assert!((found - plain).abs().max_element() < 1e-6, "{name} {properties:?}: {found} for {plain}");
        }
    }
}

#[test]
fn black_bodies_are_light_only() {
    let properties = [("temperature", float(5000.0))];
    let (found, _) = plugin("blackbody", &properties, Role::Light).unwrap();
    // The mean of a picture by scalar_spectral: see the test of the spectrum itself.
    assert!(
        (found / DVec3::new(15_277.226, 12_094.978, 9_582.503) - 1.0).abs().max_element() < 5e-3,
        "{found}"
    );
    assert!(plugin("blackbody", &properties, Role::Matter).unwrap_err().remedy.contains("radiance"));
    let part =
        [&properties[..], &[("wavelength_min", float(600.0)), ("wavelength_max", float(700.0))]].concat();
    let (red, _) = plugin("blackbody", &part, Role::Light).unwrap();
    assert!(red.x > 0.2 * found.x && red.z == 0.0, "{red}");
    // Too cold to emit, and too hot for f32.
    let of = |t| plugin("blackbody", &[("temperature", float(t))], Role::Light);
    assert_eq!(of(1.0).unwrap().0, DVec3::ZERO);
    assert!(of(1e300).is_err() && of(0.0).is_err() && of(-5.0).is_err());
}

/// Channels over the value at 550 nm, by numpy from the tables of CIE 018 under D65: 1 / lambda^4 and 1 / lambda^1.3.
#[test]
fn powers_of_the_wavelength_have_their_colours() {
    let of = |value: f64, wavelength: f64, exponent: f64, role| {
        let numbers =
            [("value", float(value)), ("wavelength", float(wavelength)), ("exponent", float(exponent))];
        plugin("inverse_power", &numbers, role).unwrap()
    };
    let near = |found: DVec3, truth: DVec3| (found / truth - 1.0).abs().max_element() < 2e-6;
    let rayleigh = DVec3::new(0.493_680_74, 1.024_496_03, 2.357_694_08);
    let haze = DVec3::new(0.807_737_85, 1.013_821_27, 1.325_658_82);
    let role = Role::Matter;
    assert!(near(plugin("inverse_power", &[], role).unwrap().0, rayleigh));
    assert!(near(of(0.25, 550.0, 1.3, role).0, 0.25 * haze));
    // Ten times the coefficient is no reflectance: nothing is clamped to 1.
    assert!(near(of(10.0, 550.0, 4.0, role).0, 10.0 * rayleigh));
    // Stated at another wavelength.
    assert!(near(of(1.0, 680.0, 4.0, role).0, (680.0f64 / 550.0).powi(4) * rayleigh));
    for role in [Role::Matter, Role::Index, Role::Light] {
        let one = reported(Value::Spectrum(vec![(0.0, 0.3)]), role).unwrap().0;
        assert!(near(of(0.3, 550.0, 0.0, role).0, one), "{role:?}");
        assert_eq!(of(0.0, 550.0, 4.0, role).0, DVec3::ZERO);
        let extremes = [-8.0, 8.0].map(|exponent| of(1.0, 550.0, exponent, role).0.min_element());
        assert!(extremes.iter().all(|least| *least > 0.0), "{role:?}: {extremes:?}");
        // As the same spectrum in pairs, which is one part in 1000 short where it is of matter.
        let pairs: Vec<_> = (360..=830).map(f64::from).map(|w| (w, (550.0 / w).powi(4))).collect();
        let (sampled, power) =
            (reported(Value::Spectrum(pairs), Role::Index).unwrap().0, of(1.0, 550.0, 4.0, Role::Index).0);
        assert!((sampled / power - 1.0).abs().max_element() < 1.5e-3, "{sampled} for {power}");
    }
}

#[test]
fn broken_plugins_are_errors() {
    let pairs = Value::Spectrum(vec![(0.0, 0.5)]);
    let range = |low, high| [("wavelength_min", float(low)), ("wavelength_max", float(high))];
    let cases: [(&str, Vec<(&str, Value)>); 18] = [
        ("uniform", vec![]),
        ("inverse_power", vec![("exponent", float(9.0))]),
        ("inverse_power", vec![("wavelength", float(0.0))]),
        ("inverse_power", vec![("value", float(-1.0))]),
        ("inverse_power", vec![("value", float(3e38))]),
        ("uniform", vec![("value", float(-1.0))]),
        ("uniform", vec![("value", Value::Rgb([0.5; 3]))]),
        ("rawconstant", vec![]),
        ("srgb", vec![]),
        ("srgb", vec![("color", Value::Rgb([2.0, 0.0, 0.0]))]),
        ("d65", vec![("colour", Value::Rgb([0.5; 3]))]),
        ("regular", vec![("value", pairs)]),
        ("regular", [&range(400.0, 700.0)[..], &[("values", text("0.1"))]].concat()),
        ("regular", [&range(700.0, 400.0)[..], &[("values", text("0.1 0.2"))]].concat()),
        ("regular", vec![("values", text("0.1 0.2"))]),
        ("irregular", vec![("wavelengths", text("400 500")), ("values", text("0.1 0.2 0.3"))]),
        ("irregular", vec![("wavelengths", text("500 400")), ("values", text("0.1 0.2"))]),
        ("checkerboard", vec![]),
    ];
    for (name, properties) in cases {
        assert!(plugin(name, &properties, Role::Light).is_err(), "{name} {properties:?}");
    }
}
