use super::*;

/// Every primitive on its own: the reference for the hierarchy.
fn brute_force(geometries: &[Geometry], ray: &Ray) -> Option<(usize, Hit)> {
    let hits = geometries.iter().enumerate().filter_map(|(i, g)| Some((i, g.closest(ray)?)));
    hits.min_by(|a, b| a.1.t.total_cmp(&b.1.t))
}

fn scene(count: usize, stream: &mut Stream) -> Vec<Shape> {
    (0..count).map(|_| any_shape(stream, 0.3, 2.0)).collect()
}

#[test]
fn hierarchy_finds_what_each_shape_alone_finds() {
    let mut stream = stream(1);
    for count in [0, 1, 3, 16, 60, 400] {
        let shapes = scene(count, &mut stream);
        let alone: Vec<_> = shapes.iter().map(|s| Geometry::build(vec![s.clone()])).collect();
        let all = Geometry::build(shapes);
        let mut hits = 0;
        for _ in 0..2000 {
            let origin = within(&mut stream, 3.0).as_vec3();
            let mut ray = ray(origin, warp::to_sphere(stream.square()));
            if stream.below(2) == 0 {
                ray.direction = [Vec3::X, Vec3::Y, -Vec3::Z][stream.below(3)];
            }
            let (found, wanted) = (all.closest(&ray), brute_force(&alone, &ray));
            assert_eq!(found.map(|h| h.t), wanted.map(|w| w.1.t), "{count} shapes, {ray:?}");
            assert_eq!(all.occluded(&ray), found.is_some());
            if let (Some(hit), Some((shape, wanted))) = (found, wanted) {
                hits += 1;
                assert_eq!(hit.shape, shape as u32);
                assert_eq!((hit.u, hit.v), (wanted.u, wanted.v));
                let short = Ray { t_max: hit.t, ..ray };
                assert!(all.closest(&short).is_none() && !all.occluded(&short), "t_max is excluded");
                assert!(all.occluded(&Ray { t_max: hit.t.next_up(), ..ray }));
            }
        }
        assert!(count < 16 || hits > 20, "{count}: {hits}");
    }
}

#[test]
fn bounds_hold_everything_and_are_zero_for_nothing() {
    assert_eq!(Geometry::build(vec![]).bounds(), Bounds::of(Vec3::ZERO));
    let geometry =
        Geometry::build(vec![placed("cube", vec![shift(1.0, 2.0, 3.0)]), placed("sphere", vec![])]);
    let Bounds { low, high } = geometry.bounds();
    assert!((low - vec3(-1.0, -1.0, -1.0)).length() < 1e-5 && (high - vec3(2.0, 3.0, 4.0)).length() < 1e-5);
}

#[test]
fn recentring_is_subtracted_in_f64() {
    let far = DVec3::new(1e7, -3e7, 2e7);
    let to_world =
        Value::Transform(vec![TransformStep::Translate((far + DVec3::new(0.25, 0.0, 0.0)).into())]);
    let shape = shape_of("rectangle", &[("to_world", to_world)], far).unwrap();
    let hit = Geometry::build(vec![shape]).bounds();
    assert!((hit.low - vec3(-0.75, -1.0, 0.0)).length() < 1e-6, "{hit:?}");
}

#[test]
fn spheres_seen_from_afar_keep_their_silhouette() {
    let geometry = Geometry::build(vec![placed("sphere", vec![])]);
    for distance in [10.0, 1e3, 1e4] {
        let start = |x: f32| ray(vec3(x, 0.0, distance), -Vec3::Z);
        assert!(geometry.closest(&start(0.999)).is_some() && geometry.closest(&start(1.001)).is_none());
        let hit = geometry.closest(&start(0.5)).unwrap();
        let truth = distance - 0.75f32.sqrt();
        assert!((hit.t - truth).abs() < 1e-6 * distance, "{} {truth}", hit.t);
    }
}

#[test]
fn coincident_and_very_unequal_primitives_are_found() {
    let mut stream = stream(21);
    let mut shapes: Vec<_> = (0..300).map(|_| placed("rectangle", vec![])).collect();
    shapes.extend((0..300).map(|i| {
        let size = 10f64.powi(i % 10 - 3);
        placed(PLUGINS[i as usize % PLUGINS.len()], vec![scale(size, size, size), shift(0.0, 0.0, -2e7)])
    }));
    let alone: Vec<_> = shapes.iter().map(|s| Geometry::build(vec![s.clone()])).collect();
    let all = Geometry::build(shapes);
    for _ in 0..2000 {
        let ray = ray(within(&mut stream, 1.5).as_vec3(), warp::to_sphere(stream.square()));
        assert_eq!(all.closest(&ray).map(|h| h.t), brute_force(&alone, &ray).map(|w| w.1.t));
        assert_eq!(all.occluded(&ray), all.closest(&ray).is_some());
    }
}

#[test]
fn what_f32_cannot_hold_is_refused() {
    for plugin in PLUGINS {
        for step in [scale(1e20, 1e20, 1e20), scale(1e-25, 1e-25, 1e-25), shift(1e20, 0.0, 0.0)] {
            assert!(shape_of(plugin, &[("to_world", Value::Transform(vec![step]))], DVec3::ZERO).is_err());
        }
    }
}

/// Squares in a cone, each a fiftieth larger than the one before it, make a chain of nodes. Down it a ray from the tip leaves
/// more siblings behind than there is room for at first.
#[test]
fn deep_trees_lose_nothing() {
    let square = |i: i32| {
        let size = 1.02f64.powi(i);
        placed("rectangle", vec![scale(size, size, 1.0), turn([0.0, 0.0, 1.0], 45.0), shift(0.0, 0.0, size)])
    };
    let geometry = Geometry::build((0..1000).map(square).collect());
    for (aside, is_hit) in [(0.1, true), (1.3, false)] {
        // Both pass all boxes, the second one beside the squares in them.
        let ray = ray(Vec3::ZERO, vec3(aside, aside, 1.0));
        let found = geometry.closest(&ray).map(|hit| hit.t * ray.direction.z);
        assert!(geometry.tree.closest_below::<false>(&ray, &mut [(0.0, 0); 64]).is_err(), "not deep enough");
        assert_eq!(found.map(|z| (z - 1.0).abs() < 1e-5), is_hit.then_some(true));
        assert_eq!(geometry.occluded(&ray), is_hit);
        assert_eq!(geometry.tree.occluded_deep::<false>(&ray), is_hit);
    }
}
