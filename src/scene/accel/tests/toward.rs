use super::*;

/// Expected: the sampled points' distribution over the surface is the density. Checked by the means of
/// 1 / density (the area where it is positive) and of moments of the position against uniform samples.
struct Agreement {
    area: f64,
    moments: [f64; 6],
}

fn moments_by(
    geometry: &Geometry,
    n: usize,
    draw: impl Fn(&mut Stream) -> Option<(SurfacePoint, f64)>,
) -> (Agreement, Agreement) {
    let Bounds { low, high } = geometry.bounds();
    let mut stream = stream(11);
    let (mut sums, mut squares) = ([0.0; 7], [0.0; 7]);
    for _ in 0..n {
        let Some((point, weight)) = draw(&mut stream) else { continue };
        let p = ((point.position - low) / (high - low).max(Vec3::splat(1e-6))).as_dvec3();
        for (i, f) in [1.0, p.x, p.y, p.z, p.x * p.x, p.y * p.y, p.z * p.x].into_iter().enumerate() {
            sums[i] += f * weight;
            squares[i] += (f * weight).powi(2);
        }
    }
    let n = n as f64;
    let mean = sums.map(|s| s / n);
    let error: [f64; 7] = std::array::from_fn(|i| ((squares[i] / n - mean[i] * mean[i]).max(0.0) / n).sqrt());
    let split = |a: [f64; 7]| Agreement { area: a[0], moments: std::array::from_fn(|i| a[i + 1]) };
    (split(mean), split(error))
}

/// Largest deviation in standard errors between integrals of 1 / d^2-weighted moments by sampling towards
/// `reference` and the same by uniform area, with the density scaled by `fault`.
fn deviation(geometry: &Geometry, reference: Vec3, fault: f64) -> f64 {
    let n = 200_000;
    let kernel = |p: &SurfacePoint| {
        let d = reference - p.position;
        f64::from(d.dot(p.normal).abs() / d.length_squared().powf(1.5).max(1e-12))
    };
    let visible = |p: &SurfacePoint| geometry.pdf_area_toward(0, reference, p) > 0.0;
    let (a, ea) = moments_by(geometry, n, |s| {
        let (p, pdf) = geometry.sample_toward(0, reference, s)?;
        assert!((geometry.pdf_area_toward(0, reference, &p) / pdf - 1.0).abs() < 1e-5);
        Some((p, kernel(&p) / (f64::from(pdf) * fault)))
    });
    let (b, eb) = moments_by(geometry, n, |s| {
        let p = geometry.sample_area(0, s);
        visible(&p).then(|| (p, kernel(&p) * f64::from(geometry.area(0))))
    });
    let z = |x: f64, y: f64, ex: f64, ey: f64| (x - y).abs() / (ex * ex + ey * ey + 1e-10 * x * x).sqrt();
    let all = (0..6).map(|i| z(a.moments[i], b.moments[i], ea.moments[i], eb.moments[i]));
    all.fold(z(a.area, b.area, ea.area, eb.area), f64::max)
}

fn shapes() -> Vec<Shape> {
    let turned = || vec![scale(0.7, 1.4, 0.9), turn([1.0, 2.0, 3.0], 40.0), shift(0.2, -0.3, 0.4)];
    let skewed = TransformStep::Matrix([
        1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.3, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ]);
    vec![
        placed("rectangle", turned()),
        placed("rectangle", vec![skewed]),
        placed("cube", turned()),
        placed("sphere", vec![scale(0.8, 0.8, 0.8), shift(0.2, -0.3, 0.4)]),
        placed("disk", turned()),
        placed("cylinder", vec![scale(0.7, 0.7, 1.4), turn([1.0, 2.0, 3.0], 40.0)]),
    ]
}

#[test]
fn sampling_toward_a_point_has_the_density_it_claims() {
    let references = [vec3(2.0, 1.0, 3.0), vec3(0.2, 0.3, -1.9), vec3(9.0, -4.0, 0.1), vec3(0.25, -0.2, 0.6)];
    for (index, shape) in shapes().into_iter().enumerate() {
        let geometry = Geometry::build(vec![shape]);
        for reference in references {
            let z = deviation(&geometry, reference, 1.0);
            assert!(z < 4.5, "shape {index} from {reference}: {z} standard errors");
        }
    }
}

#[test]
fn a_wrong_density_would_be_seen() {
    for index in [0, 3] {
        let geometry = Geometry::build(vec![shapes().swap_remove(index)]);
        assert!(deviation(&geometry, vec3(2.0, 1.0, 3.0), 1.03) > 4.5);
    }
}

#[test]
fn rectangles_and_spheres_are_sampled_uniformly_in_solid_angle() {
    // The sampled weight cos / d^2 / density is the solid angle, the same for every sample.
    for (index, reference, solid_angle) in
        [(0, vec3(0.0, 0.0, 1.0), 2.0943951), (1, vec3(0.0, 0.0, 2.0), 0.841787)]
    {
        let plugin = ["rectangle", "sphere"][index];
        let geometry = Geometry::build(vec![placed(plugin, vec![])]);
        let mut stream = stream(3);
        for _ in 0..1000 {
            let (p, pdf) = geometry.sample_toward(0, reference, &mut stream).unwrap();
            let d = reference - p.position;
            let weight = d.dot(p.normal) / d.length().powi(3) / pdf;
            assert!((weight - solid_angle).abs() < 1e-3, "{plugin}: {weight}");
        }
    }
}

#[test]
fn far_small_and_coplanar_rectangles_fall_back_to_area() {
    let geometry = Geometry::build(vec![placed("rectangle", vec![])]);
    for reference in [vec3(0.0, 0.0, 1e4), vec3(3.0, 0.5, 0.0), vec3(0.2, 0.1, 0.0)] {
        let (_, pdf) = geometry.sample_toward(0, reference, &mut stream(1)).unwrap();
        assert_eq!(pdf, 0.25);
    }
    for height in [1e-5, 1e-3, 1e2, 1.9e3] {
        let (p, pdf) = geometry.sample_toward(0, vec3(0.3, 0.2, height), &mut stream(1)).unwrap();
        assert!(pdf.is_finite() && p.position.is_finite() && pdf != 0.25, "{height}: {pdf}");
    }
}

#[test]
fn area_sampling_is_uniform() {
    let geometry = Geometry::build(vec![placed("cube", vec![scale(1.0, 2.0, 3.0)])]);
    assert!((geometry.area(0) - 88.0).abs() < 1e-3);
    let mut stream = stream(5);
    let n = 600_000;
    let mut faces = [0.0; 3];
    for _ in 0..n {
        let point = geometry.sample_area(0, &mut stream);
        for (face, along) in faces.iter_mut().zip(point.normal.abs().to_array()) {
            *face += f64::from(along);
        }
    }
    for (count, share) in faces.into_iter().zip([48.0 / 88.0, 24.0 / 88.0, 16.0 / 88.0]) {
        let expected = share * f64::from(n);
        assert!((count - expected).abs() < 4.0 * expected.sqrt(), "{faces:?}");
    }
}
