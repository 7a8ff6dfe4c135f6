use super::*;
use crate::math::{SpectrumExt, vec3};

fn shown_as(view: View, stops: f64, pixel: Spectrum) -> [u8; 3] {
    Display { view, stops }.bytes(&[pixel]).try_into().unwrap()
}

#[test]
fn greys_have_the_values_of_the_curves() {
    // sRGB bytes of 0.18; of 0.5^2.2, as Sobotka's curve has it; of 0.18 (2.51 0.18 + 0.03) / (...) = 0.2671; of 0.18.
    let known = [(View::Standard, 118), (View::Agx, 128), (View::Aces, 141), (View::Linear, 118)];
    for (view, grey) in known {
        assert_eq!(shown_as(view, 0.0, Spectrum::splat(0.18)), [grey; 3], "{view:?}");
        assert_eq!(shown_as(view, 0.0, Spectrum::ZERO), [0; 3], "{view:?}");
        assert_eq!(shown_as(view, -3.0, Spectrum::splat(1.44)), [grey; 3], "{view:?}");
        assert_eq!(shown_as(view, 2.0, Spectrum::splat(0.045)), [grey; 3], "{view:?}");
    }
}

/// Sobotka's table of the curve, by way of the polynomial that Wrensch fitted to it (rms error 0.002).
#[test]
fn agx_is_near_the_fit_of_others() {
    let fit =
        |x: f64| ((((15.5 * x - 40.14) * x + 31.96) * x - 6.868) * x + 0.4298) * x * x + 0.1191 * x - 0.00232;
    for k in 0..=33 {
        let x = f64::from(k) / 33.0;
        let grey = (0.18 * (16.5 * x - 10.0).exp2()) as f32;
        let linear = Agx::new().map(Spectrum::splat(grey));
        let encoded = f64::from(linear.y.max(0.0)).powf(1.0 / 2.2);
        assert!((encoded - fit(x)).abs() < 0.006, "{x}: {encoded}, {}", fit(x));
    }
}

#[test]
fn brighter_is_never_shown_darker_and_ends_white() {
    for &(_, view) in View::NAMES {
        let levels: Vec<Spectrum> =
            (0..400).map(|k| Spectrum::splat((0.1 * k as f32 - 20.0).exp2())).collect();
        let bytes = Display { view, stops: 0.0 }.bytes(&levels);
        assert!(bytes.windows(6).all(|two| two[3] >= two[0]), "{view:?}");
        assert_eq!(bytes[bytes.len() - 3..], [255; 3], "{view:?}");
        assert!(bytes.chunks(3).all(|grey| grey[0] == grey[1] && grey[1] == grey[2]), "{view:?}");
    }
}

#[test]
fn pure_colours_keep_the_order_of_their_channels() {
    for &(_, view) in View::NAMES {
        for k in -12..=16 {
            let light = (k as f32).exp2();
            for pure in [0, 1, 2] {
                let mut pixel = Spectrum::ZERO;
                pixel[pure] = light;
                let bytes = shown_as(view, 0.0, pixel);
                let others = [bytes[(pure + 1) % 3], bytes[(pure + 2) % 3]];
                assert!(others.iter().all(|other| *other <= bytes[pure]), "{view:?} {pixel}: {bytes:?}");
            }
        }
    }
}

#[test]
fn broken_channels_are_black_or_white_at_any_exposure() {
    for &(_, view) in View::NAMES {
        for stops in [-MOST_STOPS, 0.0, MOST_STOPS] {
            let show = |value| shown_as(view, stops, Spectrum::splat(value));
            assert_eq!([show(f32::NAN), show(f32::NEG_INFINITY), show(-1.0)], [[0; 3]; 3], "{view:?}");
            assert_eq!(show(f32::INFINITY), [255; 3], "{view:?} {stops}");
            shown_as(view, stops, vec3(f32::MAX, 0.0, f32::MIN_POSITIVE));
        }
    }
}

#[test]
fn the_exposure_chosen_shows_the_average_as_middle_grey() {
    let auto = |pixels: &[Spectrum]| Exposure::Auto.stops(pixels);
    let grey = |luminance: f32| Spectrum::ONE * (luminance / Spectrum::ONE.luminance());
    assert_eq!(auto(&[grey(0.18); 7]), 0.0);
    assert_eq!(auto(&[grey(0.0225); 7]), 3.0);
    let mut image = vec![grey(0.02); 500];
    image.extend([grey(0.08); 500]);
    assert_eq!(auto(&image), 2.17);
    // A lamp, what is dark and what is broken change nothing.
    image.extend([grey(1e6); 5]);
    image.extend([Spectrum::ZERO, Spectrum::splat(f32::NAN), Spectrum::splat(-1.0), grey(1e-5)]);
    assert_eq!(auto(&image), 2.17);
}

#[test]
fn an_exposure_is_chosen_for_any_image() {
    let auto = |pixels: &[Spectrum]| Exposure::Auto.stops(pixels);
    for none in [vec![], vec![Spectrum::ZERO; 3], vec![Spectrum::splat(f32::NAN); 3]] {
        assert_eq!(auto(&none).to_bits(), 0);
    }
    let mut lone = vec![Spectrum::ZERO; 1000];
    lone[3] = Spectrum::splat(0.09);
    assert_eq!(auto(&lone), 1.0);
    assert_eq!(auto(&[Spectrum::splat(f32::MIN_POSITIVE)]), MOST_STOPS);
    assert_eq!(auto(&[Spectrum::splat(f32::INFINITY)]), -MOST_STOPS);
}
