//! What holds for every emitter that chooses directions, and values of Mitsuba 3.9.1.

use super::*;
use crate::{
    description::Value,
    math::{vec2, vec3, warp},
    sampling::stream::Purpose,
    testing::{chi_square, object, significance},
};
use std::path::Path;

/// Bands of equal cosine and sectors, and points in each along either side.
const BANDS: usize = 32;
const FINE: usize = 64;

fn direction(band: f32, sector: f32) -> Vec3 {
    warp::spherical(1.0 - 2.0 * band / BANDS as f32, std::f32::consts::TAU * sector / BANDS as f32)
}

/// Integrals of `f` over all cells (times sr).
fn integrals(f: impl Fn(Vec3) -> f32) -> Vec<f64> {
    let area = 4.0 * std::f64::consts::PI / (BANDS * BANDS * FINE * FINE) as f64;
    let place = |cell: usize, i: usize| cell as f32 + (i as f32 + 0.5) / FINE as f32;
    let cell = |band: usize, sector: usize| {
        let points = (0..FINE * FINE).map(|i| direction(place(band, i / FINE), place(sector, i % FINE)));
        points.map(|d| f64::from(f(d)) * area).sum()
    };
    (0..BANDS * BANDS).map(|i| cell(i / BANDS, i % BANDS)).collect()
}

fn cell_of(d: Vec3) -> usize {
    let band = (0.5 * (1.0 - d.z) * BANDS as f32) as usize;
    let turn = (d.y.atan2(d.x) / std::f32::consts::TAU).rem_euclid(1.0);
    band.min(BANDS - 1) * BANDS + ((turn * BANDS as f32) as usize).min(BANDS - 1)
}

/// Samples follow their density, the density integrates to one, and light comes only from where it is positive.
fn check(
    name: &str,
    sample: impl Fn(&mut Stream) -> Vec3,
    pdf: impl Fn(Vec3) -> f32,
    value: impl Fn(Vec3) -> Spectrum,
) {
    let expected = integrals(&pdf);
    let total: f64 = expected.iter().sum();
    assert!((total - 1.0).abs() < 5e-3, "{name}: the density integrates to {total}");
    let mut stream = Stream::new(3, 0, 0, Purpose::Study);
    let n = 100_000;
    let mut counts = vec![0; BANDS * BANDS];
    for _ in 0..n {
        let d = sample(&mut stream);
        assert!((d.length() - 1.0).abs() < 1e-5, "{name}: {d}");
        counts[cell_of(d)] += 1;
    }
    let expected: Vec<f64> = expected.iter().map(|p| p / total * f64::from(n)).collect();
    let p = chi_square(&counts, &expected);
    assert!(p > significance(10), "{name}: p = {p}");
    for i in 0..BANDS * BANDS {
        let d = direction((i / BANDS) as f32 + 0.37, (i % BANDS) as f32 + 0.61);
        assert!(pdf(d) > 0.0 || value(d) == Spectrum::ZERO, "{name}: {} from nowhere at {d}", value(d));
    }
}

/// The folder of a small image whose every pixel is different, with one black column.
fn desk() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let pixel = |x: u32, y: u32| {
        if x == 3 { [0.0; 3] } else { [x as f32 + 1.0, y as f32 + 1.0, (10 * (y + 1) + x) as f32] }
    };
    write_exr(&folder.path().join("image.exr"), pixel);
    write_exr(&folder.path().join("full.exr"), |x, y| {
        [x as f32 + 1.0, y as f32 + 1.0, (10 * (y + 1) + x) as f32]
    });
    folder
}

fn write_exr(path: &Path, pixel: impl Fn(u32, u32) -> [f32; 3] + Sync) {
    exr::prelude::write_rgb_file(path, 6, 4, |x, y| <(f32, f32, f32)>::from(pixel(x as u32, y as u32)))
        .unwrap();
}

fn file(folder: &Path, name: &str) -> Value {
    Value::String(folder.join(name).to_string_lossy().into_owned())
}

fn turned() -> Value {
    use crate::description::TransformStep::{Rotate, Translate};
    let rotate = Rotate { axis: [0.3, 1.0, -0.2], angle: 130.0 };
    Value::Transform(vec![rotate, Translate([1.0, 2.0, 3.0])])
}

fn built(plugin: &str, properties: &[(&str, Value)]) -> Result<Emitter> {
    build(&object(plugin, properties), &Library::default())
}

fn picture(folder: &Path, name: &str) -> Value {
    Value::Object(object("bitmap", &[("filename", file(folder, name)), ("raw", Value::Boolean(true))]))
}

fn examples(folder: &Path) -> Vec<Emitter> {
    let profile = |text: &str| ("profile", Value::String(text.into()));
    [
        built("point", &[]),
        built("point", &[profile("0:1 30:0.5 60:0 120:0 180:2"), ("to_world", turned())]),
        built("spot", &[("cutoff_angle", Value::Float(50.0)), ("to_world", turned())]),
        built("spot", &[("texture", picture(folder, "image.exr")), ("cutoff_angle", Value::Float(60.0))]),
        built(
            "projector",
            &[
                ("irradiance", picture(folder, "image.exr")),
                ("fov", Value::Float(100.0)),
                ("to_world", turned()),
            ],
        ),
        built("constant", &[]),
        built("envmap", &[("filename", file(folder, "image.exr"))]),
        built(
            "envmap",
            &[("filename", file(folder, "image.exr")), ("mis_compensation", Value::Boolean(false))],
        ),
        built(
            "envmap",
            &[("filename", file(folder, "image.exr")), ("to_world", turned()), ("scale", Value::Float(2.0))],
        ),
        built("sunsky", &[("sun_aperture", Value::Float(40.0)), ("sun_scale", Value::Float(0.002))]),
        built("sunsky", &[("sun_scale", Value::Float(0.0)), ("to_world", turned())]),
        built(
            "sunsky",
            &[
                ("sun_aperture", Value::Float(60.0)),
                ("sky_scale", Value::Float(0.0)),
                ("sun_direction", Value::Vector([1.0, 0.3, 0.3])),
            ],
        ),
    ]
    .into_iter()
    .map(Result::unwrap)
    .collect()
}

#[test]
fn directions_follow_their_densities() {
    let folder = desk();
    for emitter in examples(folder.path()) {
        match &emitter.kind {
            Kind::Point(e) => check(emitter.name, |s| e.sample(s), |d| e.pdf_sr(d), |d| e.intensity(d)),
            Kind::Infinite(e) => {
                check(emitter.name, |s| e.sample(s), |d| e.pdf_sr(d), |d| e.radiance(d));
                check(emitter.name, |s| e.aim(s).0, |d| e.seen(d).aimed_sr, |d| e.seen(d).radiance);
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn power_is_what_leaves() {
    let folder = desk();
    for emitter in examples(folder.path()) {
        let (found, reported) = match &emitter.kind {
            Kind::Point(PointEmitter::Spot(_)) => continue, // of a slide the mean counts, and its corners do not
            Kind::Point(e) => (integrals(|d| e.intensity(d).z), e.power().z),
            Kind::Infinite(e) => (integrals(|d| e.radiance(d).z), e.fluence().z),
            other => panic!("{other:?}"),
        };
        let found: f64 = found.iter().sum();
        assert!((found / reported - 1.0).abs() < 1e-2, "{}: {found}, told {reported}", emitter.name);
    }
}

/// A map between its brightest directions and its darkest: the density follows the radiance within the cells too, and that of
/// next-event estimation with compensation more than that, though nowhere down to 0. Light subpaths start as without.
#[test]
fn a_map_is_aimed_at_where_it_is_bright() {
    let folder = desk();
    let sky = |compensated| {
        let given = [
            ("filename", file(folder.path(), "full.exr")),
            ("mis_compensation", Value::Boolean(compensated)),
        ];
        let Kind::Infinite(sky) = built("envmap", &given).unwrap().kind else { panic!() };
        sky
    };
    let (plain, compensated) = (sky(false), sky(true));
    let total = plain.fluence().as_vec3().dot(LUMINANCE);
    let mut stream = Stream::new(3, 0, 0, Purpose::Study);
    let (mut least, mut most) = (f32::INFINITY, 0f32);
    for _ in 0..10_000 {
        let towards = warp::to_sphere(stream.square());
        let Seen { radiance, pdf_sr, aimed_sr } = plain.seen(towards);
        let ratio = pdf_sr * total / radiance.dot(LUMINANCE);
        assert!((ratio - 1.0).abs() < 0.25, "{towards}: {ratio}");
        assert_eq!((aimed_sr, compensated.pdf_sr(towards)), (pdf_sr, pdf_sr));
        let change = compensated.seen(towards).aimed_sr / pdf_sr;
        (least, most) = (least.min(change), most.max(change));
    }
    assert!(least > 0.03 && least < 0.7 && most > 1.25, "{least} to {most}");
}

#[test]
fn a_profile_leaves_surfaces_as_it_says() {
    for text in ["0:1", "0:1 30:0.8 90:0", "10:0 20:5 21:5 80:0", "0:0 89:1e-3 90:1"] {
        let area = built("area", &[("profile", Value::String(text.into()))]).unwrap();
        let Kind::Surface(SurfaceEmitter::Area(area)) = area.kind else { panic!() };
        let radiance = |d: Vec3| area.radiance(vec2(0.5, 0.5).into(), d.z);
        check(text, |s| area.sample_local(s), |d| area.pdf_sr(d.z), radiance);
        let leaving: f64 = integrals(|d| radiance(d).x * d.z.max(0.0)).iter().sum();
        assert!((leaving / area.exitance().x - 1.0).abs() < 1e-2, "{text}: {leaving}");
    }
}

#[test]
fn a_profile_is_linear_in_the_angle() {
    let point = built("point", &[("profile", Value::String("30:1 60:3".into()))]).unwrap();
    let Kind::Point(point) = point.kind else { panic!() };
    for (degrees, value) in [(0.0f32, 1.0), (30.0, 1.0), (45.0, 2.0), (60.0, 3.0), (180.0, 3.0)] {
        let (s, c) = degrees.to_radians().sin_cos();
        let found = point.intensity(vec3(s, 0.0, c)).x;
        assert!((found - value).abs() < 1e-4, "{degrees}: {found}");
    }
}

/// Radiance from, and irradiance times squared distance at, given places; Mitsuba 3.9.1, `scalar_rgb`.
#[test]
fn values_are_those_of_mitsuba() {
    let folder = desk();
    let sky = built("envmap", &[("filename", file(folder.path(), "full.exr"))]).unwrap();
    let Kind::Infinite(sky) = sky.kind else { panic!() };
    for (towards, radiance) in [
        ([0.0, 0.0, 1.0], [3.5, 2.5, 27.5]),
        ([0.0, 0.0, -1.0], [3.5, 2.5, 27.5]),
        ([1.0, 0.0, 0.0], [2.0, 2.5, 26.0]),
        ([-1.0, 0.0, 0.0], [5.0, 2.5, 29.0]),
        ([0.6, 0.48, 0.64], [2.780_79, 2.021_91, 21.999_9]),
        ([-0.6, 0.2, -0.5], [5.663_43, 2.260_61, 27.269_5]),
    ] {
        let found = sky.radiance(Vec3::from(towards).normalize());
        assert!((found - Vec3::from(radiance)).length() < 2e-4, "{towards:?}: {found}");
    }
    let projector = built(
        "projector",
        &[
            ("irradiance", picture(folder.path(), "full.exr")),
            ("scale", Value::Float(2.0)),
            ("fov", Value::Float(60.0)),
        ],
    );
    let Kind::Point(projector) = projector.unwrap().kind else { panic!() };
    for (place, value) in [
        ([0.0, 0.0, 1.0], [21.991_1, 15.708, 172.788]),
        ([0.1, 0.2, 1.0], [19.188_8, 9.404_94, 106.8]),
        ([0.2, 0.4, 2.0], [4.797_19, 2.351_24, 26.7]),
        ([-0.3, 0.1, 0.7], [80.581_1, 24.731_7, 313.828]),
    ] {
        let place = Vec3::from(place);
        let found = projector.intensity(place.normalize()) / place.length_squared();
        assert!((found / Vec3::from(value) - Vec3::ONE).abs().max_element() < 1e-4, "{place}: {found}");
    }
}

#[test]
fn parameters_out_of_range_are_errors() {
    let folder = desk();
    let scaled = Value::Transform(vec![crate::description::TransformStep::Scale([2.0; 3])]);
    let profile = |text: &str| ("profile", Value::String(text.into()));
    for (plugin, properties) in [
        ("envmap", vec![]),
        ("envmap", vec![("filename", file(folder.path(), "image.exr")), ("to_world", scaled)]),
        ("projector", vec![]),
        ("projector", vec![("irradiance", Value::Float(1.0)), ("fov", Value::Float(180.0))]),
        ("point", vec![profile("0")]),
        ("point", vec![profile("0:1, 0:2")]),
        ("point", vec![profile("0:-1")]),
        ("point", vec![profile("200:1")]),
        ("point", vec![profile("0:0")]),
        ("spot", vec![("texture", Value::Float(0.5)), ("cutoff_angle", Value::Float(100.0))]),
    ] {
        assert!(built(plugin, &properties).is_err(), "{plugin} {properties:?}");
    }
}
