use super::*;
use std::{fs, path::PathBuf};

/// A file that goes with its folder.
fn file(name: &str, text: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, text).unwrap();
    (folder, path)
}

fn load(name: &str, text: &[u8], more: &[(&str, Value)]) -> crate::error::Result<Geometry> {
    let (_folder, path) = file(name, text);
    let mut properties = vec![("filename", Value::String(path.to_str().unwrap().into()))];
    properties.extend_from_slice(more);
    let plugin = name.rsplit('.').next().unwrap();
    shape_of(plugin, &properties, DVec3::ZERO).map(|shape| Geometry::build(vec![shape]))
}

fn at(geometry: &Geometry, x: f32, y: f32) -> SurfacePoint {
    let ray = ray(vec3(x, y, 5.0), -Vec3::Z);
    geometry.surface(&ray, &geometry.closest(&ray).unwrap())
}

/// `normal`, `uv` and `shading.normal` as Mitsuba 3.9.1 gives them.
fn check(point: &SurfacePoint, normal: [f32; 3], uv: [f32; 2], shading: [f32; 3]) {
    assert!((point.normal - Vec3::from(normal)).length() < 1e-4, "{point:?}");
    assert!((point.uv.get() - Vec2::from(uv)).length() < 1e-4, "{point:?}");
    assert!((point.shading.normal - Vec3::from(shading)).length() < 1e-4, "{point:?}");
}

const UP: [f32; 3] = [0.0, 0.0, 1.0];
const DOWN: [f32; 3] = [0.0, 0.0, -1.0];
const QUAD: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
const BENT: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\nf 1 3 4\n";
const FULL: &[u8] = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0.6 -0.8\n\
    f 1/1/1 2/2/1 3/3/1 4/4/1\n";
const YES: Value = Value::Boolean(true);
const NO: Value = Value::Boolean(false);

#[test]
fn obj_meshes_are_as_in_mitsuba() {
    let plain = |more: &[(&str, Value)]| load("a.obj", QUAD, more).unwrap();
    check(&at(&plain(&[]), 0.2, 0.3), UP, [0.2, 0.1], UP);
    check(&at(&plain(&[]), 0.7, 0.6), UP, [0.1, 0.6], UP);
    check(&at(&plain(&[("flip_normals", YES)]), 0.2, 0.3), DOWN, [0.2, 0.1], DOWN);
    let mirrored = Value::Transform(vec![scale(-1.0, 1.0, 1.0), shift(1.0, 0.0, 0.0)]);
    check(&at(&plain(&[("to_world", mirrored)]), 0.2, 0.3), DOWN, [0.5, 0.3], DOWN);
    let full = |more: &[(&str, Value)]| at(&load("a.obj", FULL, more).unwrap(), 0.2, 0.3);
    check(&full(&[]), UP, [0.2, 0.7], [0.0, 0.6, -0.8]);
    check(&full(&[("face_normals", YES)]), UP, [0.2, 0.7], UP);
    check(&full(&[("flip_normals", YES)]), DOWN, [0.2, 0.7], [0.0, -0.6, 0.8]);
    check(&full(&[("flip_tex_coords", NO)]), UP, [0.2, 0.3], [0.0, 0.6, -0.8]);
    let flat = Value::Transform(vec![scale(1.0, 2.0, 1.0)]);
    check(&full(&[("to_world", flat)]), UP, [0.2, 0.85], [0.0, 0.35112, -0.93633]);
}

#[test]
fn missing_normals_are_smooth_as_in_mitsuba() {
    let bent = load("a.obj", BENT, &[]).unwrap();
    let slope = [0.57735, -0.57735, 0.57735];
    check(&at(&bent, 0.2, 0.3), slope, [0.2, 0.1], [0.39403, -0.39403, 0.83035]);
    check(&at(&bent, 0.7, 0.6), UP, [0.1, 0.6], [0.33797, -0.33797, 0.87838]);
    let faces = load("a.obj", BENT, &[("face_normals", YES)]).unwrap();
    check(&at(&faces, 0.2, 0.3), slope, [0.2, 0.1], slope);
}

#[test]
fn obj_files_may_count_backwards_and_mix_corners() {
    let text = b"# caf\xe9\ng x\nv 0 0 0\nv 1 0 0 1 1 1\nv 1 1 0\nvn 0 0 1\nf -3//1 -2//-1 -1\nl 1 2\n";
    assert!(at(&load("a.obj", text, &[]).unwrap(), 0.7, 0.3).shading.normal.z > 0.999);
    let pentagon = b"v 0 0 0\nv 1 0 0\nv 1.2 1 0\nv 0.5 1.4 0\nv 0 1 0\nf 1 2 3 4 5\n";
    let pentagon = load("a.obj", pentagon, &[]).unwrap();
    check(&at(&pentagon, 0.2, 0.3), UP, [0.11017, 0.13559], UP);
    check(&at(&pentagon, 0.5, 1.2), UP, [0.08475, 0.79661], UP);
}

const HEADER: &str = "ply\nformat ascii 1.0\ncomment x\nelement vertex 4\nproperty float x\nproperty double y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n\
    property uchar red\nelement face 2\nproperty list uchar int vertex_indices\nend_header\n";

fn ply_text(names: [&str; 2], faces: &str) -> Vec<u8> {
    let header = HEADER.replace("float u\n", &format!("float {}\n", names[0]));
    let header = header.replace("float v\n", &format!("float {}\n", names[1]));
    let n = "0 0.6 -0.8";
    format!("{header}0 0 0 {n} 0 0 1\n1 0 0 {n} 1 0 2\n1 1 0 {n} 1 1 3\n0 1 0 {n} 0 1 4\n{faces}")
        .into_bytes()
}

#[test]
fn ply_meshes_are_as_in_mitsuba() {
    for names in [["u", "v"], ["s", "t"], ["texture_u", "texture_v"]] {
        let text = ply_text(names, "3 0 1 2\n3 0 2 3\n");
        let at = |more: &[(&str, Value)]| at(&load("a.ply", &text, more).unwrap(), 0.2, 0.3);
        check(&at(&[]), UP, [0.2, 0.3], [0.0, 0.6, -0.8]);
        check(&at(&[("flip_tex_coords", YES)]), UP, [0.2, 0.7], [0.0, 0.6, -0.8]);
        check(&at(&[("face_normals", YES)]), UP, [0.2, 0.3], UP);
        check(&at(&[("flip_normals", YES)]), DOWN, [0.2, 0.3], [0.0, -0.6, 0.8]);
    }
    let quad = ply_text(["u", "v"], "4 0 1 2 3\n").to_vec();
    let quad = String::from_utf8(quad).unwrap().replace("face 2", "face 1");
    assert!((load("a.ply", quad.as_bytes(), &[]).unwrap().area(0) - 1.0).abs() < 1e-6);
}

#[test]
fn binary_ply_of_both_orders_is_read() {
    for little in [true, false] {
        let order = if little { "little" } else { "big" };
        let mut bytes = format!(
            "ply\nformat binary_{order}_endian 1.0\nelement vertex 3\nproperty float x\nproperty float y\n\
             property float z\nelement face 1\nproperty list uchar uint vertex_index\nend_header\n"
        )
        .into_bytes();
        for x in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0, 0.0] {
            bytes.extend(if little { x.to_le_bytes() } else { x.to_be_bytes() });
        }
        bytes.push(3);
        for i in [0u32, 1, 2] {
            bytes.extend(if little { i.to_le_bytes() } else { i.to_be_bytes() });
        }
        check(&at(&load("a.ply", &bytes, &[]).unwrap(), 0.7, 0.3), UP, [0.4, 0.3], UP);
        for cut in 0..bytes.len() {
            assert!(load("a.ply", &bytes[..cut], &[]).is_err(), "cut at {cut}");
        }
    }
}

#[test]
fn broken_obj_files_are_errors_with_their_line() {
    let start = "v 0 0 0\nv 1 0 0\nv 1 1 0\n";
    for (bad, line) in [
        ("f 1 2 9\n", ":4"),
        ("f 1 2 0\n", ":4"),
        ("f 1 2 -4\n", ":4"),
        ("f 1 2 -9223372036854775808\n", ":4"),
        ("f 1/1 2 3\n", ":4"),
        ("f 1/-7 2 3\n", ":4"),
        ("f 1 2\n", ":4"),
        ("f 1/2/3/4 2 3\n", ":4"),
        ("f /1 2 3\n", ":4"),
        ("f a b c\n", ":4"),
        ("\nv 1 nan 2\n", ":5"),
        ("v 1 1e999 2\n", ":4"),
        ("v 1 2\n", ":4"),
        ("vt 1\n", ":4"),
        ("", ""),
        ("f 1 1 2\n", ""),
        ("v 1e38 0 0\nv 0 1e38 0\nf 1 4 5\n", ""),
    ] {
        let error = load("a.obj", format!("{start}{bad}").as_bytes(), &[]).unwrap_err();
        assert!(error.place.ends_with(&format!("a.obj{line}")), "{bad}: {error}");
    }
}

#[test]
fn broken_ply_files_are_errors() {
    let good = String::from_utf8(ply_text(["u", "v"], "3 0 1 2\n3 0 2 3\n")).unwrap();
    assert!(load("a.ply", good.as_bytes(), &[]).is_ok());
    for (from, to) in [
        ("ply\n", "plyx\n"),
        ("3 0 2 3\n", "3 0 2 4\n"),
        ("3 0 2 3\n", "3 0 2 -1\n"),
        ("3 0 2 3\n", "2 0 2\n"),
        ("3 0 2 3\n", "4294967295 0 2 3\n"),
        ("vertex 4", "vertex 99999999999999"),
        ("face 2", "face 18446744073709551615"),
        ("face 2", "face 184467440737095516150"),
        ("face 2", "face -1"),
        ("vertex 4", "vertex 3"),
        ("float x", "list uchar int x"),
        ("property float x\n", "property float xx\n"),
        ("1 0 0 0 0.6", "1 nan 0 0 0.6"),
        ("1 0 0 0 0.6", "1 inf 0 0 0.6"),
        ("int vertex_indices", "float vertex_indices"),
        ("element face 2", "element nothing 99999999999999\nelement face 2"),
        ("element face 2", "element vertex 2\nelement face 2"),
    ] {
        let text = good.replacen(from, to, 1);
        assert_ne!(text, good, "{from}");
        let error = load("a.ply", text.as_bytes(), &[]);
        assert!(error.is_err(), "{from} -> {to}");
        assert!(error.unwrap_err().place.contains("a.ply"));
    }
}

/// The shape in a file, and what its reader warned of.
fn warned(name: &str, text: &[u8]) -> (Shape, Vec<String>) {
    let (_folder, path) = file(name, text);
    let location = Location { file: Arc::default(), position: Position::Path("$".into()) };
    let filename = Property {
        name: "filename".into(),
        value: Value::String(path.to_str().unwrap().into()),
        location: location.clone(),
    };
    let plugin = name.rsplit('.').next().unwrap().into();
    let object = Object { tag: None, plugin, id: None, properties: vec![filename], location };
    let library = Library::default();
    let (params, build) = shape::ROWS.read(&object, &library).unwrap();
    let shape = build(&params, DMat4::IDENTITY).unwrap();
    (shape, library.take_warnings())
}

#[test]
fn triangles_without_area_are_dropped_with_a_warning() {
    let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\nf 1 1 2\nf 1 2 2\n";
    let (shape, warnings) = warned("a.obj", text);
    assert_eq!(shape.primitive_count(), 1);
    assert!(warnings.len() == 1 && warnings[0].contains("2 of 3"), "{warnings:?}");
}

#[test]
fn what_a_ply_has_beyond_its_mesh_is_told() {
    let text = String::from_utf8(ply_text(["u", "v"], "3 0 1 2\n3 0 2 3\n5 6\n")).unwrap();
    let text = text.replace("end_header", "element edge 1\nproperty int a\nproperty int b\nend_header");
    let (shape, warnings) = warned("a.ply", text.as_bytes());
    assert_eq!(shape.primitive_count(), 2);
    assert!(warnings.len() == 1 && warnings[0].contains("\"red\" of \"vertex\", \"edge\""), "{warnings:?}");
    let (_, warnings) = warned("a.serialized", &serialized(4));
    assert!(warnings.is_empty());
}

/// An obj sphere of 2 * rings * segments triangles or so.
pub(super) fn sphere_mesh(rings: usize, segments: usize, size: f64, center: DVec3) -> Geometry {
    use std::fmt::Write;
    let mut text = String::new();
    for i in 0..=rings {
        for j in 0..segments {
            let (theta, phi) = (
                std::f64::consts::PI * i as f64 / rings as f64,
                std::f64::consts::TAU * j as f64 / segments as f64,
            );
            let p = center + size * DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos());
            writeln!(text, "v {} {} {}", p.x, p.y, p.z).unwrap();
        }
    }
    for i in 0..rings {
        for j in 0..segments {
            let at = |i: usize, j: usize| i * segments + j % segments + 1;
            writeln!(text, "f {} {} {} {}", at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)).unwrap();
        }
    }
    load("a.obj", text.as_bytes(), &[]).unwrap()
}

#[test]
fn meshes_are_found_as_triangle_by_triangle() {
    let geometry = sphere_mesh(30, 40, 1.0, DVec3::ZERO);
    let shape = &geometry.shapes()[0];
    let packs: Vec<_> =
        (0..shape.primitive_count()).map(|i| Tree::build(&[([0, i as u32], shape.primitive(i))])).collect();
    let mut stream = stream(2);
    for _ in 0..2000 {
        let ray = ray(within(&mut stream, 1.5).as_vec3(), warp::to_sphere(stream.square()));
        let wanted = packs.iter().filter_map(|p| p.closest(&ray)).map(|h| h.t).min_by(f32::total_cmp);
        assert_eq!(geometry.closest(&ray).map(|h| h.t), wanted);
        assert_eq!(geometry.occluded(&ray), wanted.is_some());
    }
}

#[test]
fn closed_meshes_hold_their_rays() {
    for (size, center) in [(1.0, DVec3::ZERO), (1e-3, DVec3::new(0.3, -0.5, 0.4)), (1e3, DVec3::splat(1e3))] {
        let geometry = sphere_mesh(100, 200, size, center);
        let mut stream = stream(4);
        let (mut own, mut leaks) = (0, 0);
        for _ in 0..300_000 {
            let point = geometry.sample_area(0, &mut stream);
            let direction = warp::to_sphere(stream.square());
            let origin = leave_surface(point.position, point.error, point.normal, direction);
            let ray = Ray { origin, direction, t_max: f32::INFINITY };
            let hit = geometry.closest(&ray);
            let inwards = direction.dot(point.normal) < 0.0;
            own += usize::from(hit.is_some_and(|h| geometry.surface(&ray, &h).normal == point.normal));
            leaks += usize::from(inwards && hit.is_none());
        }
        eprintln!("mesh {size}: own hits {own}, leaks {leaks} of 300000");
        assert!(own == 0 && leaks <= 3, "{size}: {own} {leaks}");
    }
}

#[test]
fn meshes_are_sampled_uniformly_by_area() {
    // Triangles of very different sizes: each gets its share, and the whole is flat in x and y.
    let text = b"v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.9 0.05 0\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5\n";
    let geometry = load("a.obj", text, &[]).unwrap();
    assert!((geometry.area(0) - 1.0).abs() < 1e-6);
    let mut stream = stream(6);
    let mut cells = [0u32; 64];
    let n = 640_000;
    for _ in 0..n {
        let p = geometry.sample_area(0, &mut stream).position * 8.0;
        cells[(p.x as usize).min(7) + 8 * (p.y as usize).min(7)] += 1;
    }
    let expected = f64::from(n) / 64.0;
    let chi2: f64 = cells.iter().map(|c| (f64::from(*c) - expected).powi(2) / expected).sum();
    // 63 degrees of freedom: mean 63, deviation 11.2.
    assert!((25.0..125.0).contains(&chi2), "{chi2}");
}

/// Written by a few lines of Python after Mitsuba's documentation, and read by Mitsuba 3.9.1: the bent square;
/// the same with normals and texture coordinates; and again in double precision, with colours too.
fn serialized(version: u32) -> Vec<u8> {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/shape/samples");
    fs::read(folder.join(format!("three_v{version}.serialized"))).unwrap()
}

fn index(number: i64) -> (&'static str, Value) {
    ("shape_index", Value::Integer(number))
}

#[test]
fn serialized_meshes_are_as_in_mitsuba() {
    let slope = [0.57735, -0.57735, 0.57735];
    let down = slope.map(|x: f32| -x);
    for version in [3, 4] {
        let text = serialized(version);
        let at = |more: &[(&str, Value)]| at(&load("a.serialized", &text, more).unwrap(), 0.2, 0.3);
        check(&at(&[]), slope, [0.2, 0.1], [0.39403, -0.39403, 0.83035]);
        for number in [1, 2] {
            let at = |more: &[(&str, Value)]| at(&[&[index(number)], more].concat());
            check(&at(&[]), slope, [0.2, 0.3], [0.0, 0.6, -0.8]);
            check(&at(&[("flip_normals", YES)]), down, [0.2, 0.3], [0.0, -0.6, 0.8]);
            check(&at(&[("face_normals", YES)]), slope, [0.2, 0.3], slope);
        }
        for number in [-1, 3, 4, 1 << 40] {
            assert!(load("a.serialized", &text, &[index(number)]).is_err());
        }
    }
}

/// A version 4 file of one mesh.
fn packed(flags: u32, vertices: u64, triangles: u64, data: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut file = vec![0x1c, 0x04, 4, 0];
    let mut zip = flate2::write::ZlibEncoder::new(&mut file, flate2::Compression::fast());
    let header = [&flags.to_le_bytes()[..], b"name\0", &vertices.to_le_bytes(), &triangles.to_le_bytes()];
    zip.write_all(&[&header.concat(), data].concat()).unwrap();
    zip.finish().unwrap();
    file
}

#[test]
fn broken_serialized_files_are_errors() {
    let corners = |x: f32| [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, x, 1.0, 0.0].map(f32::to_le_bytes).concat();
    let face = |c: u32| [0, 1, c].map(u32::to_le_bytes).concat();
    let good = |x, c| [corners(x), face(c)].concat();
    assert!(load("a.serialized", &packed(0x1000, 3, 1, &good(0.0, 2)), &[]).is_ok());
    // No flag at all means single precision (found by fuzzing: its positions were taken for absent).
    assert!(load("a.serialized", &packed(0, 3, 1, &good(0.0, 2)), &[]).is_ok());
    for bad in [
        packed(0x1000, 4_000_000_000, 1, &good(0.0, 2)),
        packed(0x1000, 3, 4_000_000_000, &good(0.0, 2)),
        packed(0x1000, u64::MAX, 1, &good(0.0, 2)),
        packed(0x1000, 3, u64::MAX / 3, &good(0.0, 2)),
        packed(0x1000, 3, 1, &good(0.0, 3)),
        packed(0x1000, 3, 1, &good(f32::NAN, 2)),
        packed(0x1000, 3, 0, &good(0.0, 2)),
        packed(0x1000, 0, 0, &[]),
        packed(0x3000, 3, 1, &good(0.0, 2)),
        packed(0x100f, 3, 1, &good(0.0, 2)),
        vec![0x1c, 0x04, 5, 0, 0],
        vec![0x1d, 0x04, 4, 0, 0],
        vec![0x1c, 0x04, 4, 0, 1, 2, 3, 4, 5],
    ] {
        assert!(load("a.serialized", &bad, &[]).unwrap_err().place.contains("a.serialized"));
    }
    let whole = serialized(4);
    for cut in 0..whole.len() {
        for number in [1, 2] {
            assert!(load("a.serialized", &whole[..cut], &[index(number)]).is_err(), "cut at {cut}");
        }
    }
    // A table that points anywhere.
    for number in 1..256u64 {
        let mut wrong = whole.clone();
        let at = wrong.len() - 12;
        wrong[at..at + 8].copy_from_slice(&number.wrapping_mul(0x0123_4567_89ab_cdef).to_le_bytes());
        assert!(load("a.serialized", &wrong, &[index(2)]).is_err(), "{number}");
    }
    for (count, number) in [(u32::MAX, 7), (1, 1), (0, 1)] {
        let mut wrong = whole.clone();
        let at = wrong.len() - 4;
        wrong[at..].copy_from_slice(&count.to_le_bytes());
        assert!(load("a.serialized", &wrong, &[index(number)]).is_err());
    }
}
