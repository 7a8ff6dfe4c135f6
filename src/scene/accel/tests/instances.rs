//! Instances against copies: the same shape under the same transform.

use super::*;
use crate::shape::Instance;

/// A turned, unevenly scaled place at `far` metres from the origin.
fn place(stream: &mut Stream, size: f64, far: f64) -> DMat4 {
    let scale = (within(stream, 0.4) + 0.6) * size;
    let turn = DMat4::from_axis_angle((within(stream, 1.0) + 1e-3).normalize(), 5.0);
    DMat4::from_translation(within(stream, far)) * turn * DMat4::from_scale(scale)
}

/// An instance of `shape`, which is not where `to_world` takes it yet.
fn instance(shape: Shape, to_world: DMat4) -> Shape {
    Shape::Instance(Instance::new(Arc::new(Geometry::build(vec![shape])), to_world).unwrap())
}

const BUMPS: &str = "v 0 0 1\nv 1 0 -.2\nv 0 1 .1\nv -1 0 -.3\nv 0 -1 0\nv 0 .2 -1\n\
    vt 0 0\nvt 1 0\nvt 0.5 1\nvt 0.2 0.3\nvt 0.9 0.8\nvt 0.4 0.1\n\
    f 1/1 2/2 3/3\nf 1/1 3/3 4/4\nf 1/1 4/4 5/5\nf 1/1 5/5 2/2\nf 6/6 3/3 2/2\nf 6/6 4/4 3/3\nf 6/6 5/5 4/4\nf 6/6 2/2 5/5\n";

/// `plugin` where it stands by itself, copied for an instance that `world` places.
fn copy(plugin: &str, own: DMat4, world: DMat4) -> Shape {
    let steps = vec![TransformStep::Matrix(own.transpose().to_cols_array())];
    let location = Location { file: Arc::default(), position: Position::Path("$".into()) };
    let to_world =
        Property { name: "to_world".into(), value: Value::Transform(steps), location: location.clone() };
    let object = Object { tag: None, plugin: plugin.into(), id: None, properties: vec![to_world], location };
    let library = Library::default();
    let (params, build) = shape::ROWS.read(&object, &library).unwrap();
    build(&params, world).unwrap()
}

/// Which way normals point and texture coordinates run does not depend on how an instance is made.
#[test]
fn mirrored_copies_are_mirrored_instances() {
    let turn = DMat4::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, 0.7);
    let mirror = DMat4::from_scale(DVec3::new(-2.0, 2.0, 2.0));
    let owns = [DMat4::IDENTITY, DMat4::from_scale(DVec3::new(1.0, -1.0, 1.0))];
    let worlds = [turn, turn * mirror, mirror * turn];
    let mut stream = stream(5);
    let mut hits = 0;
    for plugin in PLUGINS {
        for (own, world) in owns.into_iter().flat_map(|own| worlds.map(|world| (own, world))) {
            let copied = Geometry::build(vec![copy(plugin, own, world)]);
            let shape = copy(plugin, own, DMat4::IDENTITY);
            let shared =
                Geometry::build(vec![placed("sphere", vec![shift(1e3, 0.0, 0.0)]), instance(shape, world)]);
            for _ in 0..100 {
                let direction = warp::to_sphere(stream.square());
                let target = world.transform_point3(within(&mut stream, 0.9)).as_vec3();
                let ray = ray(target - direction * 9.0, direction);
                let (Some(a), Some(b)) = (copied.closest(&ray), shared.closest(&ray)) else { continue };
                let [a, b] = [(&copied, a), (&shared, b)].map(|(geometry, hit)| geometry.surface(&ray, &hit));
                if (a.position - b.position).length() > 1e-4 {
                    continue;
                }
                hits += 1;
                assert!(a.normal.dot(b.normal) > 0.999, "{plugin} {own} {world}: {a:?} {b:?}");
                assert!(
                    a.shading.normal.dot(b.shading.normal) > 0.999,
                    "{plugin} {own} {world}: {a:?} {b:?}"
                );
                assert!((a.uv.get() - b.uv.get()).length() < 1e-3, "{plugin} {own} {world}: {a:?} {b:?}");
                let [u, v] = [(&copied, a), (&shared, b)].map(|(geometry, point)| geometry.partials(&point));
                assert!(
                    (u.0 - v.0).length() + (u.1 - v.1).length() < 1e-2,
                    "{plugin} {own} {world}: {u:?} {v:?}"
                );
            }
        }
    }
    assert!(hits > 1000, "{hits}");
}

fn bumps(to_world: DMat4) -> Shape {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("bumps.obj");
    std::fs::write(&path, BUMPS).unwrap();
    let matrix = TransformStep::Matrix(to_world.transpose().to_cols_array());
    let properties = [
        ("filename", Value::String(path.to_str().unwrap().into())),
        ("to_world", Value::Transform(vec![matrix])),
    ];
    shape_of("obj", &properties, DVec3::ZERO).unwrap()
}

#[test]
fn instances_are_hit_as_copies_are() {
    let mut stream = stream(3);
    let mut hits = 0;
    for (size, far) in [(1.0, 0.0), (1e-3, 1.0), (1e3, 1e3), (2.0, 300.0)] {
        let to_world = place(&mut stream, size, far);
        let shared = Geometry::build(vec![instance(bumps(DMat4::IDENTITY), to_world)]);
        let copied = Geometry::build(vec![bumps(to_world)]);
        for _ in 0..2000 {
            let target = to_world.transform_point3(within(&mut stream, 1.0)).as_vec3();
            let direction = warp::to_sphere(stream.square());
            let ray = ray(target - direction * (3.0 * size as f32), direction);
            let (one, other) = (shared.closest(&ray), copied.closest(&ray));
            assert_eq!(one.is_some(), shared.occluded(&ray));
            // Rounding decides at edges.
            let (Some(one), Some(other)) = (one, other) else { continue };
            let near = 1e-5 * (size + far) as f32;
            let to_edge = other.u.min(other.v).min(1.0 - other.u - other.v);
            if (one.t - other.t).abs() > near || to_edge < 1e-3 {
                continue;
            }
            let [a, b] =
                [(&shared, one), (&copied, other)].map(|(geometry, hit)| geometry.surface(&ray, &hit));
            hits += 1;
            assert!((a.position - b.position).length() < near, "{a:?} {b:?}");
            assert!(
                a.normal.dot(b.normal) > 1.0 - 1e-4 * (1.0 + far as f32 / size as f32 / 100.0),
                "{a:?} {b:?}"
            );
            let [u, v] = [(&shared, a), (&copied, b)].map(|(geometry, point)| geometry.partials(&point));
            assert!(
                (u.0 - v.0).length() < 1e-3 * v.0.length() + near
                    && (u.1 - v.1).length() < 1e-3 * v.1.length() + near
            );
            assert!((a.uv.get() - b.uv.get()).length() < 1e-3 + 1e-6 * (far / size) as f32, "{a:?} {b:?}");
        }
    }
    assert!(hits > 3000, "{hits}");
}

#[test]
fn a_stretched_sphere_is_an_ellipsoid() {
    let ball = placed("sphere", vec![]);
    let geometry = Geometry::build(vec![instance(ball, DMat4::from_scale(DVec3::new(3.0, 1.0, 0.5)))]);
    for (from, direction, t, normal) in [
        (vec3(-9.0, 0.0, 0.0), Vec3::X, 6.0, Vec3::NEG_X),
        (vec3(0.0, 0.0, 4.0), Vec3::NEG_Z, 3.5, Vec3::Z),
        // x = 3 cos a, y = sin a at 45 degrees: the normal is along (cos a / 3, sin a).
        (
            vec3(3.0 * 0.5f32.sqrt(), 9.0, 0.0),
            Vec3::NEG_Y,
            9.0 - 0.5f32.sqrt(),
            vec3(1.0, 3.0, 0.0).normalize(),
        ),
    ] {
        let ray = ray(from, direction);
        let hit = geometry.closest(&ray).unwrap();
        assert!((hit.t - t).abs() < 1e-5, "{hit:?}");
        assert!((geometry.surface(&ray, &hit).normal - normal).length() < 1e-5);
        assert!(geometry.closest(&Ray { t_max: t - 1e-3, ..ray }).is_none());
    }
}

#[test]
fn no_ray_hits_the_face_of_an_instance_that_it_leaves() {
    let mut stream = stream(4);
    for (size, far) in [(1.0, 0.0), (1e-3, 10.0), (1e3, 1e4), (1.0, 1e3)] {
        let to_world = place(&mut stream, size, far);
        let geometry = Geometry::build(vec![instance(bumps(DMat4::IDENTITY), to_world)]);
        let mut own = 0;
        for _ in 0..20_000 {
            let point = geometry.sample_area(0, &mut stream);
            let mut direction = warp::to_sphere(stream.square());
            if stream.below(2) == 0 {
                direction = (direction - point.normal * point.normal.dot(direction) * 0.999_99).normalize();
            }
            let ray = point.leaving(direction);
            let hit = geometry.closest(&ray);
            own += usize::from(
                hit.is_some_and(|hit| geometry.surface(&ray, &hit).normal.dot(point.normal) > 0.999_999),
            );
        }
        assert_eq!(own, 0, "{size} {far}");
    }
}

#[test]
fn what_cannot_be_undone_is_no_place() {
    let geometry = Arc::new(Geometry::build(vec![placed("sphere", vec![])]));
    for matrix in
        [DMat4::ZERO, DMat4::from_scale(DVec3::new(1.0, 0.0, 1.0)), DMat4::from_scale(DVec3::splat(1e17))]
    {
        assert!(Instance::new(geometry.clone(), matrix).is_none(), "{matrix}");
    }
}
