//! What builders take and refuse.

use super::*;
use crate::math::vec2;

fn squares() -> Value {
    Value::Object(object("checkerboard", &[]))
}

#[test]
fn parameters_out_of_range_are_errors() {
    let nested = |plugin: &str| ("", Value::Object(object(plugin, &[])));
    let cases: Vec<(&str, Vec<(&str, Value)>)> = vec![
        ("diffuse", vec![("reflectance", number(1.5))]),
        ("diffuse", vec![("reflectanse", number(0.5))]),
        ("dielectric", vec![("int_ior", number(0.0))]),
        ("dielectric", vec![("int_ior", text("watter"))]),
        ("dielectric", vec![("specular_reflectance", number(-0.5))]),
        ("conductor", vec![("material", text("gold"))]),
        ("conductor", vec![("material", text("Au")), ("eta", number(1.0))]),
        ("roughconductor", vec![("alpha_u", number(0.1))]),
        ("roughconductor", vec![("alpha", number(0.1)), ("alpha_u", number(0.1)), ("alpha_v", number(0.1))]),
        ("roughconductor", vec![("alpha", number(-0.1))]),
        ("roughdielectric", vec![("distribution", text("phong"))]),
        ("roughdielectric", vec![("alpha", number(11.0))]),
        ("conductor", vec![("material", text("Au")), ("k", number(1.0))]),
        ("plastic", vec![("diffuse_reflectance", number(1.5))]),
        ("plastic", vec![("alpha", number(0.1))]),
        ("roughplastic", vec![("alpha", squares())]),
        ("roughplastic", vec![("alpha_u", number(0.1)), ("alpha_v", number(0.2))]),
        ("mask", vec![]),
        ("mask", vec![("opacity", number(1.5)), nested("diffuse")]),
        ("mask", vec![nested("diffuse"), nested("diffuse")]),
        ("blendbsdf", vec![nested("diffuse"), nested("diffuse")]),
        ("blendbsdf", vec![("weight", number(0.5)), nested("diffuse")]),
        ("blendbsdf", vec![("weight", number(1.5)), nested("diffuse"), nested("diffuse")]),
        ("difftrans", vec![("transmittance", number(1.5))]),
        ("translucent", vec![("directional", number(1.5))]),
        ("translucent", vec![("exponent", number(-1.0))]),
        ("twosided", vec![("", Value::Object(object("mask", &[nested("diffuse")])))]),
        ("twosided", vec![nested("translucent")]),
        ("twosided", vec![]),
        ("twosided", vec![nested("dielectric")]),
        ("twosided", vec![nested("diffuse"), nested("null")]),
        ("twosided", vec![nested("diffuse"), nested("diffuse"), nested("diffuse")]),
    ];
    for (plugin, properties) in cases {
        assert!(built(plugin, &properties).is_err(), "{plugin} {properties:?}");
    }
}

#[test]
fn a_rough_interface_of_equal_indices_is_a_smooth_one() {
    for index in [1.0, 1.0 + 1e-6, 1.0 - 1e-6] {
        let indices = [("int_ior", number(index)), ("ext_ior", number(1.0))];
        let bsdf = built("roughdielectric", &indices).unwrap();
        assert!(matches!(bsdf, Bsdf::Dielectric(_)), "{bsdf:?}");
    }
}

#[test]
fn parameters_may_be_textures() {
    let rough =
        built("roughconductor", &[("alpha", squares()), ("specular_reflectance", squares())]).unwrap();
    let at = |uv: Vec2| rough.evaluate(uv.into(), Vec3::Z, Vec3::Z, Transport::Radiance);
    // The checkerboard's 0.4 and 0.2, for Beckmann and a perfect mirror: reflectance / (4 pi alpha^2).
    let expected = |x: f32| x / (4.0 * PI * x * x);
    assert!(close(at(vec2(0.2, 0.2)).value.x, expected(0.4), 1e-4));
    assert!(close(at(vec2(0.7, 0.2)).value.x, expected(0.2), 1e-4));
}

#[test]
fn what_mitsuba_allows_is_allowed() {
    let nested = |plugin: &str, properties: &[(&str, Value)]| ("", Value::Object(object(plugin, properties)));
    let opaque = nested(
        "blendbsdf",
        &[("weight", squares()), nested("plastic", &[]), nested("roughplastic", &[("alpha", number(0.2))])],
    );
    let cases: Vec<(&str, Vec<(&str, Value)>)> = vec![
        ("conductor", vec![("material", text("none")), ("k", number(1.5))]),
        ("roughplastic", vec![("alpha_u", number(0.2)), ("alpha_v", number(0.2))]),
        ("twosided", vec![opaque.clone()]),
        ("twosided", vec![nested("twosided", std::slice::from_ref(&opaque)), nested("plastic", &[])]),
        ("mask", vec![("opacity", squares()), nested("mask", std::slice::from_ref(&opaque))]),
        ("mask", vec![nested("roughdielectric", &[])]),
        ("blendbsdf", vec![("weight", number(0.5)), nested("null", &[]), nested("mask", &[opaque])]),
    ];
    for (plugin, properties) in cases {
        let found = built(plugin, &properties);
        assert!(found.is_ok(), "{plugin}: {}", found.err().map_or(String::new(), |error| error.to_string()));
    }
}
