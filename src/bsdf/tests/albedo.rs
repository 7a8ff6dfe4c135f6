//! What surfaces give back of the light they get, against closed forms.

use super::*;
use std::f64::consts::TAU;

/// The part of light from `wi` that is scattered other than by Dirac lobes, by the midpoint rule in the square
/// of the cosine and in the azimuth.
fn albedo(bsdf: &Bsdf, wi: Vec3) -> DVec3 {
    let n = 400;
    let middle = |i: usize| (i as f32 + 0.5) / n as f32;
    let scattered = |i: usize| {
        let up = warp::spherical(middle(i / n).sqrt(), TAU as f32 * middle(i % n));
        let at = |wo| bsdf.evaluate(UV, wi, wo, Transport::Importance).value.as_dvec3();
        at(up) + at(vec3(up.x, up.y, -up.z))
    };
    (0..n * n).map(scattered).sum::<DVec3>() * (0.5 * TAU / (n * n) as f64)
}

fn checked(bsdf: &Bsdf, wi: Vec3, expected: f64, tolerance: f64) {
    let found = albedo(bsdf, wi).x;
    assert!((found - expected).abs() < tolerance, "{bsdf:?} from {wi}: {found} for {expected}");
}

/// A base that absorbs nothing gives all that the coat lets in back, however often the coat returns it, but
/// for the error of the fit.
#[test]
fn a_white_plastic_absorbs_nothing() {
    for nonlinear in [false, true] {
        let white = [("diffuse_reflectance", number(1.0)), ("nonlinear", Value::Boolean(nonlinear))];
        let bsdf = built("plastic", &[&white[..], &[("ext_ior", number(1.0))]].concat()).unwrap();
        for wi in incoming().into_iter().filter(|wi| wi.z > 0.0) {
            let inside = (1.0 - (1.0 - f64::from(wi.z).powi(2)) / 1.49f64.powi(2)).sqrt();
            let c = f64::from(wi.z);
            let (s, p) =
                ((c - 1.49 * inside) / (c + 1.49 * inside), (1.49 * c - inside) / (1.49 * c + inside));
            checked(&bsdf, wi, 1.0 - 0.5 * (s * s + p * p), 2e-3);
        }
    }
}

#[test]
fn a_diffuse_transmitter_shines_on_the_far_side_alone() {
    let bsdf = built("difftrans", &[("transmittance", number(0.6))]).unwrap();
    for (wi, wo, value) in [
        (Vec3::Z, -Vec3::Z, 0.6),
        (-Vec3::Z, vec3(0.6, 0.0, 0.8), 0.6),
        (Vec3::Z, Vec3::Z, 0.0),
        (-Vec3::Z, vec3(0.6, 0.0, -0.8), 0.0),
    ] {
        let found = bsdf.evaluate(UV, wi, wo, Transport::Radiance).value.x;
        assert!(close(found, value * std::f32::consts::FRAC_1_PI, 1e-6), "{wi} to {wo}: {found}");
    }
    incoming().into_iter().for_each(|wi| checked(&bsdf, wi, 0.6, 1e-3));
}

/// Seen straight on, a lobe over a cosine of 1 keeps (n + 1) / (n + 2). As it narrows, all comes through.
#[test]
fn a_translucent_pane_gives_back_what_it_should() {
    let pane = |more: &[(&str, Value)]| {
        built("translucent", &[&[("transmittance", number(0.8))], more].concat()).unwrap()
    };
    for n in [0.0, 1.0, 10.0, 100.0] {
        let lobe = pane(&[("directional", number(0.75)), ("exponent", number(n))]);
        checked(&lobe, Vec3::Z, 0.8 * (0.25 + 0.75 * (n + 1.0) / (n + 2.0)), 2e-3);
    }
    let narrow = pane(&[("directional", number(1.0)), ("exponent", number(3_000.0))]);
    for (cosine, least) in [(-0.9, 0.79), (0.5, 0.78), (0.2, 0.7)] {
        let found = albedo(&narrow, warp::spherical(cosine, 0.4)).x;
        assert!((least..0.802).contains(&found), "{cosine}: {found}");
    }
    // Of light from everywhere, what the table says.
    for (n, lost) in [(0.0, 0.33), (20.0, 0.12), (3_000.0, 0.01)] {
        let lobe = pane(&[("directional", number(1.0)), ("exponent", number(n))]);
        let at = |i: usize| albedo(&lobe, warp::spherical(((i as f32 + 0.5) / 16.0).sqrt(), 0.4)).x;
        let kept = (0..16).map(at).sum::<f64>() / 16.0 / 0.8;
        assert!((1.0 - kept - lost).abs() < 0.006, "{n}: {kept}");
    }
    let clear = pane(&[("directional", number(0.75))]);
    assert!(close(clear.null_transmission(UV, 0.3).x, 0.6, 1e-6));
    incoming().into_iter().for_each(|wi| checked(&clear, wi, 0.2, 1e-3));
}
