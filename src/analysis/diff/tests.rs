//! Numbers worked out by hand, and what FLIP must say of equal and of opposite images.

use super::*;
use crate::math::vec3;

fn picture(width: usize, pixels: &[Spectrum]) -> Picture {
    let height = pixels.len() / width;
    Picture { width, height, pixels: pixels.to_vec(), channels: 3, is_colour: true }
}

fn view(tolerance: Tolerance) -> View {
    View { tolerance, curve: Some(ToneCurve::Scale(1.0)), pixels_per_degree: 67.0 }
}

fn files() -> [&'static Path; 2] {
    ["a.exr", "b.exr"].map(Path::new)
}

#[test]
fn every_number_is_that_worked_out_by_hand() {
    let image =
        picture(2, &[vec3(1.0, 0.5, 0.25), vec3(1.0, 1.0, 1.0), vec3(0.0, 0.0, 0.0), vec3(0.5, 0.5, 3.0)]);
    let reference =
        picture(2, &[vec3(1.0, 0.5, 0.25), vec3(1.0, 1.0, 0.9), vec3(0.0, 0.0, 0.001), vec3(0.5, 0.5, 1.0)]);
    let d = compare(&image, &reference, files(), &view(Tolerance::Absolute(0.05))).unwrap();
    let most = d.radiance.largest;
    assert_eq!((most.column, most.row, most.channel, most.difference), (1, 1, 2, 2.0));
    assert_eq!((most.image, most.reference), (3.0, 1.0));
    assert_eq!(d.radiance.beyond, 50.0);
    assert_eq!(d.radiance.mean_image, [0.625, 0.5, 1.0625]);
    assert!((d.radiance.ratio[2] - 4.25 / 2.151).abs() < 1e-6);
    let relative = compare(&image, &reference, files(), &view(Tolerance::Relative(0.2))).unwrap();
    assert_eq!(relative.radiance.beyond, 50.0);
    // A screen shows 3 and 1 alike; of 0.9 it shows 1.055 0.9^(1/2.4) - 0.055, and of 0.001 12.92 times as much.
    let shown = &d.display.as_ref().unwrap().comparison;
    let off = [1.0 - (1.055 * 0.9f64.powf(1.0 / 2.4) - 0.055), 0.012_92];
    let mse = off.iter().map(|x| x * x).sum::<f64>() / 12.0;
    assert!((shown.measures.mse / mse - 1.0).abs() < 1e-4, "{shown:?}");
    assert_eq!(d.measure("display.mse"), Some(shown.measures.mse));
    assert_eq!(MEASURES.iter().filter(|name| d.measure(name).is_none()).count(), 0);
}

#[test]
fn both_images_have_the_curve_of_the_reference() {
    let image = picture(1, &[Spectrum::splat(9.0)]);
    let reference = picture(1, &[Spectrum::splat(4.0)]);
    let view = View { curve: None, ..view(Tolerance::Absolute(0.0)) };
    let d = compare(&image, &reference, files(), &view).unwrap().display.unwrap();
    assert_eq!(d.curve, ToneCurve::White(Spectrum::splat(4.0).dot(crate::math::spectrum::LUMINANCE)));
    let means = [d.comparison.mean_image[0], d.comparison.mean_reference[0]];
    assert!(means.iter().all(|mean| (mean - 1.0).abs() < 1e-5), "{means:?}");
}

#[test]
fn pictures_that_do_not_match_are_explained() {
    let (one, two) = (picture(1, &[Spectrum::ONE]), picture(2, &[Spectrum::ONE; 2]));
    let view = view(Tolerance::Absolute(0.0));
    let error = compare(&one, &two, files(), &view).unwrap_err();
    assert!(
        error.place == "a.exr" && error.found == "1 x 1 pixels" && error.expected.contains("2 x 1"),
        "{error}"
    );
    let uv = Picture { channels: 2, is_colour: false, ..one.clone() };
    assert!(compare(&uv, &one, files(), &view).unwrap_err().expected.contains("3 channels"));
    let broken = picture(2, &[Spectrum::ONE, vec3(1.0, f32::NAN, 1.0)]);
    let error = compare(&broken, &two, files(), &view).unwrap_err();
    assert!(error.found.contains("column 1, row 0 (1 such"), "{error}");
    assert!(compare(&two, &broken, files(), &view).unwrap_err().place == "b.exr");
    let depth = Picture { is_colour: false, ..one.clone() };
    assert!(compare(&depth, &depth, files(), &view).unwrap().display.is_none());
}

#[test]
fn flip_is_nothing_for_equal_and_nearly_one_for_opposite_images() {
    let flat = |value: f32| picture(16, &[Spectrum::splat(value); 256]);
    let flip = |a: &Picture, b: &Picture| {
        compare(a, b, files(), &view(Tolerance::Absolute(0.0))).unwrap().measure("flip").unwrap()
    };
    assert!(flip(&flat(0.3), &flat(0.3)) < 1e-6);
    let (small, large) = (flip(&flat(0.3), &flat(0.31)), flip(&flat(0.0), &flat(1.0)));
    assert!(0.0 < small && small < 0.1 && large > 0.9, "{small} {large}");
}

#[test]
fn maps_show_their_values_and_where_the_scale_ends() {
    let mut pixels = vec![Spectrum::ONE; 200];
    pixels[7] = vec3(0.0, 1.0, 1.0);
    pixels[8] = Spectrum::splat(4.0);
    let (image, reference) = (picture(20, &pixels), picture(20, &[Spectrum::ONE; 200]));
    let d = compare(&image, &reference, files(), &view(Tolerance::Absolute(0.0))).unwrap();
    let mapped = |of, most| map(of, &image, &reference, &d, most).unwrap();
    let signed = mapped(MapOf::Signed, None);
    assert!((signed.values[7] + 1.0 / 3.0).abs() < 1e-6 && signed.values[8] == 3.0);
    assert_eq!(signed.range, (-1.0 / 3.0, 1.0 / 3.0));
    assert_eq!(mapped(MapOf::Absolute, Some(2.0)).range, (0.0, 2.0));
    assert!((mapped(MapOf::Relative, None).values[8] - 9.0 / 1.01).abs() < 1e-5);
    let same = compare(&image, &image, files(), &view(Tolerance::Absolute(0.0))).unwrap();
    assert_eq!(map(MapOf::Relative, &image, &image, &same, None).unwrap().range, (0.0, 1.0));
}
