//! What is written is read back; what cannot be read is explained; colours represent what they should.

use super::*;
use crate::film::{self, Channel, format::Format};
use std::path::PathBuf;
use tempfile::TempDir;

fn channel(name: &str, values: &[f32]) -> Channel {
    Channel { name: name.into(), values: values.to_vec() }
}

/// A 2 x 1 OpenEXR file of these channels, named as they come.
fn exr(folder: &TempDir, names: &[&str]) -> PathBuf {
    let path = folder.path().join("image.exr");
    let values = |i: usize| [i as f32 + 0.5, -(i as f32)];
    let channels = names.iter().enumerate().map(|(i, name)| channel(name, &values(i))).collect();
    film::exr::write(&path, 2, 1, channels, Format::default()).unwrap();
    path
}

#[test]
fn layers_and_channels_are_found_by_their_names() {
    let folder = TempDir::new().unwrap();
    let names = ["B", "G", "R", "n.X", "n.Y", "n.Z", "d.T", "uv.V", "uv.U", "A"];
    let path = exr(&folder, &names);
    let value = |name: &str| names.iter().position(|n| *n == name).unwrap() as f32 + 0.5;
    let first = |layer| {
        let picture = read_layer(&path, layer).unwrap();
        assert_eq!((picture.width, picture.height, picture.pixels.len()), (2, 1, 2));
        (picture.pixels[0].to_array(), picture.channels)
    };
    assert_eq!(first(None), (["R", "G", "B"].map(value), 3));
    assert_eq!(first(Some("n")), (["n.X", "n.Y", "n.Z"].map(value), 3));
    assert_eq!(first(Some("d")), ([value("d.T"); 3], 1));
    assert_eq!(first(Some("uv")), ([value("uv.U"), value("uv.V"), 0.0], 2));
    assert_eq!(first(Some("A")), ([value("A"); 3], 1));
    assert_eq!(first(Some("n.Y")), ([value("n.Y"); 3], 1));
}

#[test]
fn a_missing_layer_is_explained_by_those_there_are() {
    let folder = TempDir::new().unwrap();
    let error = read_layer(&exr(&folder, &["R", "G", "B", "depth.T"]), Some("dept")).unwrap_err();
    assert!(error.found.contains("depth (T)") && error.remedy.contains("did you mean \"depth\""), "{error}");
    let error = read(&exr(&folder, &["depth.T", "n.X", "n.Y", "n.Z"])).unwrap_err();
    assert!(error.remedy.contains("depth, n"), "{error}");
    let error = read(&exr(&folder, &["Y", "RY", "BY"])).unwrap_err();
    assert!(error.found.contains("RY"), "{error}");
    let png = folder.path().join("image.png");
    film::png::write(&png, 1, 1, &[Spectrum::ONE]).unwrap();
    assert!(read_layer(&png, Some("depth")).unwrap_err().found.contains("without layers"));
}

/// XYZ of the white D65 is R = G = B; in a layer the same channels are a position or anything else.
#[test]
fn x_y_z_are_colours_only_without_a_layer() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("image.exr");
    let white = film::format::to_xyz(Spectrum::ONE);
    let channels = ["X", "Y", "Z", "p.X", "p.Y", "p.Z"];
    let values = |i: usize| [white[i % 3]];
    let channels = channels.iter().enumerate().map(|(i, name)| channel(name, &values(i))).collect();
    film::exr::write(&path, 1, 1, channels, Format::default()).unwrap();
    assert!(read(&path).unwrap().pixels[0].distance(Spectrum::ONE) < 1e-5);
    assert_eq!(read_layer(&path, Some("p")).unwrap().pixels[0], white);
}

#[test]
fn broken_and_negative_values_are_read_as_they_are() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("image.exr");
    let channels = vec![channel("Y", &[f32::NAN, f32::NEG_INFINITY])];
    film::exr::write(&path, 2, 1, channels, Format::default()).unwrap();
    let picture = read(&path).unwrap();
    assert!(picture.pixels[0].is_nan() && picture.pixels[1].y == f32::NEG_INFINITY && picture.channels == 1);
}

#[test]
fn float_maps_of_either_byte_order_are_read_from_the_bottom() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("image.pfm");
    let pixels: Vec<Spectrum> = (0..6).map(|i| vec3(i as f32, -1.0, 0.5)).collect();
    film::raster::write_pfm(&path, 3, 2, &Format::default().channels(&pixels, &[])).unwrap();
    let picture = read(&path).unwrap();
    assert_eq!((picture.width, picture.height, picture.pixels), (3, 2, pixels));
    // Mitsuba 3.9.1 reads 2 and 4 from this: big-endian, all times 2.
    let data = [1f32, 2.0].map(f32::to_be_bytes).concat();
    std::fs::write(&path, [b"Pf 2 1\n2.0\n", &data[..]].concat()).unwrap();
    let picture = read(&path).unwrap();
    assert_eq!((picture.pixels, picture.channels), (vec![Spectrum::splat(2.0), Spectrum::splat(4.0)], 1));
}

#[test]
fn cut_or_absurd_float_maps_are_refused() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("image.pfm");
    for text in [
        "PF",
        "PF\n2 2\n-1\nabc",
        "PF\n99999999 99999999\n-1\n",
        "PF\n2 2\n0\n",
        "PF\n-2 2\n1\n",
        "PFM 1 1 1 ",
    ] {
        std::fs::write(&path, text).unwrap();
        assert!(read(&path).unwrap_err().expected.contains("float map"), "{text}");
    }
    assert!(read(Path::new("nowhere.exr")).unwrap_err().expected.contains("a file to read"));
    std::fs::write(&path, "").unwrap();
    assert!(read(&path).is_err());
}

#[test]
fn radiance_and_png_files_are_read() {
    let folder = TempDir::new().unwrap();
    let [hdr, png] = ["image.hdr", "image.png"].map(|name| folder.path().join(name));
    let pixels = [vec3(0.5, 0.25, 1.0), vec3(0.0, 1.0, 0.125)];
    film::raster::write_rgbe(&hdr, 2, 1, &pixels).unwrap();
    film::png::write(&png, 2, 1, &pixels).unwrap();
    for path in [hdr, png] {
        let picture = read(&path).unwrap();
        let off = picture.pixels.iter().zip(pixels).map(|(a, b)| a.distance(b)).fold(0.0, f32::max);
        assert!(off < 0.01 && picture.channels == 3, "{}: {off}", path.display());
    }
}

#[test]
fn false_colours_run_from_dark_to_bright_and_from_blue_to_red() {
    let sum = |colour: &[u8]| colour.iter().map(|c| u32::from(*c)).sum::<u32>();
    let error = false_colour(&[0.0, 0.5, 1.0, 7.0, f32::INFINITY, f32::NAN], (0.0, 1.0));
    let error: Vec<_> = error.chunks(3).collect();
    assert!(sum(error[0]) < 20 && sum(error[0]) < sum(error[1]) && sum(error[1]) < sum(error[2]));
    assert_eq!((error[2], error[2], error[5]), (error[3], error[4], &BROKEN[..]));
    let signed = false_colour(&[-2.0, -1.0, 0.0, 1.0], (-1.0, 1.0));
    let signed: Vec<_> = signed.chunks(3).collect();
    assert_eq!(signed[0], signed[1]);
    assert!(signed[1][2] > signed[1][0] && signed[3][0] > signed[3][2], "{signed:?}");
    assert!(sum(signed[2]) > 700, "{:?}", signed[2]);
    let empty = false_colour(&[0.0, 1.0], (0.0, 0.0));
    assert!(sum(&empty[..3]) < 20 && sum(&empty[3..]) > 300);
}
