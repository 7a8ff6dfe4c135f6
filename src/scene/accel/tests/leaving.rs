use super::*;
use crate::shape::CurvedModel;

/// Statistics of rays that leave surface points to both sides.
#[derive(Default, Debug)]
struct Leaving {
    rays: usize,
    /// Hits of the very primitive that was left, other than the far side of a sphere or tube from inside.
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
        "rectangle" => matches!(shape, Shape::Parallelograms(_)) && shape.primitive_count() == 1,
        "cube" => shape.primitive_count() == 6,
        "disk" => matches!(shape, Shape::Disk(_)),
        "cylinder" => matches!(shape, Shape::Cylinder(_)),
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
    let round = matches!(plugin, "sphere" | "cylinder");
    counts.own_hits += usize::from(if round { outwards && hit.is_some() } else { same_face });
    counts.leaks += usize::from(matches!(plugin, "cube" | "sphere") && !outwards && hit.is_none());
}

/// 1 where the normal points out of a closed shape.
fn outside(geometry: &Geometry, plugin: &str, point: &SurfacePoint) -> f32 {
    if matches!(plugin, "rectangle" | "disk" | "cylinder") {
        // Of a cylinder: as it was placed.
        return 1.0;
    }
    let Bounds { low, high } = geometry.bounds();
    (point.position - (low + high) * 0.5).dot(point.normal).signum()
}

#[test]
fn no_ray_hits_the_primitive_it_leaves() {
    for plugin in PLUGINS {
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

#[test]
fn a_box_of_separate_rectangles_holds_its_rays() {
    let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    for (size, at) in
        [(1.0, DVec3::Y), (1e-3, DVec3::Y), (0.37, DVec3::new(11.3, -7.1, 3.9)), (1e3, DVec3::ZERO)]
    {
        let side = |axis, angle| {
            let steps = vec![
                shift(0.0, 0.0, -1.0),
                turn(axis, angle),
                scale(size, size, size),
                TransformStep::Translate(at.into()),
            ];
            placed("rectangle", steps)
        };
        let sides =
            [side(x, 0.0), side(x, 90.0), side(x, 180.0), side(x, 270.0), side(y, 90.0), side(y, -90.0)];
        let geometry = Geometry::build(sides.into());
        let mut stream = stream(8);
        let mut leaks = 0;
        for i in 0..250_000 {
            let point = geometry.sample_area(i % 6, &mut stream);
            let direction = warp::to_sphere(stream.square());
            let direction = direction * direction.dot(point.normal).signum();
            let origin = leave_surface(point.position, point.error, point.normal, direction);
            leaks += usize::from(!geometry.occluded(&Ray { origin, direction, t_max: f32::INFINITY }));
        }
        eprintln!("box of size {size} at {at}: {leaks} leaks of 250000");
        assert!(leaks <= 25, "{size} {at}: {leaks}");
    }
}

/// f64 recomputation: the point where the ray hits the exact f32 primitive.
#[test]
fn positions_are_within_their_error_bound() {
    for round in 0..600 {
        let mut stream = stream(round);
        let size = 10f64.powf(f64::from(stream.uniform()) * 6.0 - 3.0);
        let shape = any_shape(&mut stream, size, (size * 1e3).min(1e4));
        let geometry = Geometry::build(vec![shape]);
        let mut largest = 0f64;
        for _ in 0..300 {
            let aim = geometry.sample_area(0, &mut stream);
            let origin = aim.position + (warp::to_sphere(stream.square()) * 3.0 * size as f32);
            let ray = ray(origin, aim.position - origin);
            let Some(hit) = geometry.closest(&ray) else { continue };
            let point = geometry.surface(&ray, &hit);
            let distance = distance_from_primitive(&geometry, &hit, point.position.as_dvec3());
            let bound = f64::from(point.normal.abs().dot(point.error));
            largest = largest.max(distance / bound);
            let moved = (point.position - (ray.origin + ray.direction * hit.t)).length();
            assert!(moved < 1e-4 * size as f32 + 1e-6 * origin.length(), "{moved} {point:?} {ray:?}");
        }
        assert!(largest < 1.0, "round {round}: {largest} of the bound");
    }
}

fn distance_from_primitive(geometry: &Geometry, hit: &Hit, p: DVec3) -> f64 {
    match geometry.shapes()[0].primitive(hit.primitive as usize) {
        Primitive::Flat(flat) => {
            let normal = flat.edge_u.as_dvec3().cross(flat.edge_v.as_dvec3()).normalize();
            (p - flat.corner.as_dvec3()).dot(normal).abs()
        }
        Primitive::Ball { center, radius } => (p.distance(center.as_dvec3()) - f64::from(radius)).abs(),
        Primitive::Curved(curved) => curved.distance(p),
    }
}
