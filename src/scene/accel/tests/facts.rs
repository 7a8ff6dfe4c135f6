//! What Mitsuba 3.9.1 (scalar_rgb) says of its shapes: `ray_intersect`'s n, uv, sh_frame.n, sh_frame.s.

use super::*;

/// Shape, transform, flip_normals, and per ray: origin, direction, normal, uv, shading normal.
struct Fact {
    plugin: &'static str,
    steps: fn() -> Vec<TransformStep>,
    flip: bool,
    origin: [f32; 3],
    direction: [f32; 3],
    normal: [f32; 3],
    uv: [f32; 2],
    shading: [f32; 3],
}

fn check(fact: &Fact) {
    let properties =
        [("to_world", Value::Transform((fact.steps)())), ("flip_normals", Value::Boolean(fact.flip))];
    let geometry = Geometry::build(vec![shape_of(fact.plugin, &properties, DVec3::ZERO).unwrap()]);
    let ray = ray(fact.origin.into(), fact.direction.into());
    let point = geometry.surface(&ray, &geometry.closest(&ray).unwrap());
    let told =
        format!("{} {:?} flip {} from {:?}: {point:?}", fact.plugin, (fact.steps)(), fact.flip, fact.origin);
    assert!((point.normal - Vec3::from(fact.normal)).length() < 1e-4, "normal: {told}");
    assert!((point.uv - Vec2::from(fact.uv)).length() < 1e-4, "uv: {told}");
    assert!((point.shading.normal - Vec3::from(fact.shading)).length() < 1e-4, "shading: {told}");
}

const DOWN: [f32; 3] = [0.0, 0.0, -1.0];
const UP: [f32; 3] = [0.0, 0.0, 1.0];
const ABOVE: [f32; 3] = [0.3, 0.2, 5.0];

fn none() -> Vec<TransformStep> {
    vec![]
}
fn mirror() -> Vec<TransformStep> {
    vec![scale(-1.0, 1.0, 1.0)]
}
fn shear() -> Vec<TransformStep> {
    vec![TransformStep::Matrix([
        1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.3, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ])]
}

#[test]
fn rectangles_are_as_in_mitsuba() {
    let fact = |steps, flip, normal, uv, shading| Fact {
        plugin: "rectangle",
        steps,
        flip,
        origin: ABOVE,
        direction: DOWN,
        normal,
        uv,
        shading,
    };
    check(&fact(none, false, UP, [0.65, 0.6], UP));
    check(&fact(none, true, DOWN, [0.65, 0.6], DOWN));
    check(&fact(mirror, false, DOWN, [0.35, 0.6], UP));
    check(&fact(mirror, true, UP, [0.35, 0.6], DOWN));
    check(&fact(|| vec![scale(1.0, 1.0, -1.0)], false, UP, [0.65, 0.6], DOWN));
    check(&fact(|| vec![scale(2.0, 2.0, 2.0)], false, UP, [0.575, 0.55], UP));
}

#[test]
fn cubes_are_as_in_mitsuba() {
    let fact = |steps, flip, (origin, direction), normal, uv, shading| Fact {
        plugin: "cube",
        steps,
        flip,
        origin,
        direction,
        normal,
        uv,
        shading,
    };
    let rays = [
        (ABOVE, DOWN),
        ([0.3, 0.2, -5.0], UP),
        ([5.0, 0.2, 0.3], [-1.0, 0.0, 0.0]),
        ([-5.0, 0.2, 0.3], [1.0, 0.0, 0.0]),
        ([0.2, 5.0, 0.3], [0.0, -1.0, 0.0]),
        ([0.2, -5.0, 0.3], [0.0, 1.0, 0.0]),
    ];
    let plain = [[0.6, 0.65], [0.4, 0.65], [0.6, 0.35], [0.6, 0.65], [0.4, 0.35], [0.65, 0.6]];
    let mirrored = [[0.6, 0.35], [0.4, 0.35], [0.6, 0.65], [0.6, 0.35], [0.6, 0.35], [0.65, 0.4]];
    for (i, (origin, direction)) in rays.into_iter().enumerate() {
        let (out, back) = (direction.map(|d: f32| -d), direction);
        check(&fact(none, false, (origin, direction), out, plain[i], out));
        check(&fact(none, true, (origin, direction), back, plain[i], back));
        check(&fact(mirror, false, (origin, direction), back, mirrored[i], out));
        check(&fact(mirror, true, (origin, direction), out, mirrored[i], back));
    }
    let side = [0.88648, -0.44324, 0.13297];
    check(&fact(shear, false, rays[2], side, [0.555, 0.35], side));
    check(&fact(shear, false, rays[0], UP, [0.45, 0.675], UP));
}

#[test]
fn spheres_are_as_in_mitsuba() {
    let fact = |steps, flip, normal: [f32; 3], uv| Fact {
        plugin: "sphere",
        steps,
        flip,
        origin: ABOVE,
        direction: DOWN,
        normal,
        uv,
        shading: normal,
    };
    let out = [0.3, 0.2, 0.93274];
    check(&fact(none, false, out, [0.09358, 0.11741]));
    check(&fact(none, true, out.map(|x: f32| -x), [0.09358, 0.11741]));
    check(&fact(mirror, false, out.map(|x: f32| -x), [0.40642, 0.11741]));
    check(&fact(mirror, true, out, [0.40642, 0.11741]));
    let turned = || vec![scale(2.0, 2.0, 2.0), turn([1.0, 0.0, 0.0], 50.0), turn([0.0, 0.0, 1.0], 30.0)];
    check(&fact(turned, false, [0.15, 0.1, 0.98362], [0.21305, 0.28576]));
}

#[test]
fn frames_point_along_u_as_in_mitsuba() {
    let turned = vec![scale(2.0, 2.0, 2.0), turn([1.0, 0.0, 0.0], 50.0), turn([0.0, 0.0, 1.0], 30.0)];
    let geometry = Geometry::build(vec![placed("sphere", turned)]);
    let ray = ray(ABOVE.into(), DOWN.into());
    let point = geometry.surface(&ray, &geometry.closest(&ray).unwrap());
    assert!((point.shading.tangent - vec3(-0.9167, -0.3585, 0.1762)).length() < 1e-3, "{point:?}");
}

#[test]
fn a_sphere_takes_centre_radius_and_transform_together() {
    let properties = [
        ("center", Value::Vector([1.0, 0.0, 0.0])),
        ("radius", Value::Float(0.5)),
        ("to_world", Value::Transform(vec![scale(2.0, 2.0, 2.0), shift(0.0, 0.0, 1.0)])),
    ];
    let geometry = Geometry::build(vec![shape_of("sphere", &properties, DVec3::ZERO).unwrap()]);
    let ray = ray(vec3(2.1, 0.1, 9.0), -Vec3::Z);
    let hit = geometry.closest(&ray).unwrap();
    assert!((hit.t - 7.010_05).abs() < 1e-4);
    assert!((geometry.surface(&ray, &hit).uv - vec2(0.125, 0.045_17)).length() < 1e-4);
}

#[test]
fn what_is_no_sphere_is_refused() {
    for steps in [vec![scale(1.0, 2.0, 1.0)], shear(), vec![scale(1e-30, 1e-30, 1e-30)]] {
        assert!(shape_of("sphere", &[("to_world", Value::Transform(steps))], DVec3::ZERO).is_err());
    }
    assert!(shape_of("sphere", &[("radius", Value::Float(0.0))], DVec3::ZERO).is_err());
    let error = shape_of("rectangel", &[], DVec3::ZERO).unwrap_err();
    assert!(error.remedy.contains("rectangle"), "{error}");
}
