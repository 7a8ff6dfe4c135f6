use super::*;

/// Statistics of rays that leave surface points to both sides.
#[derive(Default, Debug)]
struct Leaving {
    rays: usize,
    /// Hits of the very primitive that was left, other than a sphere's far side from inside.
    own_hits: usize,
    /// Rays into a closed shape that never came out.
    leaks: usize,
}

/// Points all over shapes of sizes 1e-3 to 1e3, `far` sizes (but at most 1e4) from the origin, left to both
/// sides.
fn leave(plugin: &str, far: f64, rounds: u64) -> Leaving {
    let mut counts = Leaving::default();
    for round in 0..rounds {
        let mut stream = stream(round);
        let size = 10f64.powf(f64::from(stream.uniform()) * 6.0 - 3.0);
        let mut shape = any_shape(&mut stream, size, (far * size).min(1e4));
        while !matches(&shape, plugin) {
            shape = any_shape(&mut stream, size, (far * size).min(1e4));
        }
        let geometry = Geometry::build(vec![shape]);
        for _ in 0..2500 {
            leave_once(&geometry, plugin, &mut stream, &mut counts);
        }
    }
    counts
}

fn matches(shape: &Shape, plugin: &str) -> bool {
    match plugin {
        "rectangle" => shape.primitive_count() == 1 && !matches!(shape, Shape::Sphere(_)),
        "cube" => shape.primitive_count() == 6,
        _ => matches!(shape, Shape::Sphere(_)),
    }
}

fn leave_once(geometry: &Geometry, plugin: &str, stream: &mut Stream, counts: &mut Leaving) {
    let point = geometry.sample_area(0, stream);
    let mut direction = warp::to_sphere(stream.square());
    if stream.below(2) == 0 {
        // Grazing.
        direction = (direction - point.normal * point.normal.dot(direction) * 0.999_999).normalize();
    }
    let outwards = direction.dot(point.normal) * outside(geometry, plugin, &point) >= 0.0;
    let start = leave_surface(point.position, point.error, point.normal, direction);
    let ray = Ray { origin: start, direction, t_max: f32::INFINITY };
    let hit = geometry.closest(&ray);
    let same_face = hit.is_some_and(|h| geometry.surface(&ray, &h).normal == point.normal);
    counts.rays += 1;
    counts.own_hits += usize::from(if plugin == "sphere" { outwards && hit.is_some() } else { same_face });
    counts.leaks += usize::from(plugin != "rectangle" && !outwards && hit.is_none());
}

/// 1 where the normal points out of a closed shape.
fn outside(geometry: &Geometry, plugin: &str, point: &SurfacePoint) -> f32 {
    if plugin == "rectangle" {
        return 1.0;
    }
    let (low, high) = geometry.bounds();
    (point.position - (low + high) * 0.5).dot(point.normal).signum()
}

#[test]
fn no_ray_hits_the_primitive_it_leaves() {
    for plugin in ["rectangle", "cube", "sphere"] {
        for far in [0.0, 10.0, 1e3, 1e7] {
            let counts = leave(plugin, far, 100);
            eprintln!("{plugin} {far} {counts:?}");
            assert_eq!(counts.own_hits, 0, "{plugin} {far}: {counts:?}");
            // Points at a cube's edges are on one face or the other up to rounding; and what is smaller than
            // a unit in the last place of its position is left through its far side.
            let share = match plugin {
                "cube" => (1e-5 + 2e-7 * far).min(0.1),
                _ if far > 1e5 => 0.01,
                _ => 0.0,
            };
            assert!(counts.leaks as f64 <= share * counts.rays as f64, "{plugin} {far}: {counts:?}");
        }
    }
}

#[test]
fn unmoved_rays_do_hit_their_own_primitive() {
    // The test above can fail: without the error bound it does.
    let mut stream = stream(0);
    let geometry = Geometry::build(vec![placed(
        "rectangle",
        vec![turn([1.0, 2.0, 3.0], 40.0), shift(30.0, 50.0, 70.0)],
    )]);
    let own_hit = |stream: &mut Stream| {
        let point = geometry.sample_area(0, stream);
        geometry.occluded(&ray(point.position, warp::to_sphere(stream.square())))
    };
    assert!((0..10_000).filter(|_| own_hit(&mut stream)).count() > 1000);
}
