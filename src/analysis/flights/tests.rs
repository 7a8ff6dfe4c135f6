//! Unbiased methods agree with each other and with printed slabs; constant steps do not, by the same test.

use super::*;
use crate::phase::{HenyeyGreenstein, Isotropic};
use tally::{ABSORBED, DIRECT, REFLECTED, SCATTERED, TRANSMITTED};

/// Optical thickness `b` over 2 m.
fn slab(albedo: f64, b: f64, g: f64) -> Experiment {
    let sigma_t = 0.5 * b;
    let (sigma_a, sigma_s) = (sigma_t * (1.0 - albedo), sigma_t * albedo);
    let phase = HenyeyGreenstein::new(g).into();
    Experiment { shape: Shape::Slab, size: 2.0, sigma_a, sigma_s, phase, angle: 0.0 }
}

fn effort(photons: u64) -> Effort {
    Effort { photons, truth_photons: 4 * photons, seed: 11 }
}

/// Reflected and transmitted, the unscattered part included, of van de Hulst's tables.
const PRINTED: &[(f64, f64, f64, f64, f64)] =
    &[(0.9, 2.0, 0.75, 0.097_39, 0.660_96), (0.5, 1.0, 0.0, 0.0991, 0.4461)];

#[test]
fn printed_slabs_are_met_by_unbiased_methods_and_missed_by_constant_steps() {
    for (albedo, b, g, reflected, transmitted) in PRINTED {
        let experiment = slab(*albedo, *b, *g);
        let mean_free_path = 2.0 / b;
        let study = study(&experiment, &[mean_free_path], effort(100_000));
        for found in &study.methods {
            let of = |quantity: usize| found.estimates[quantity].estimate;
            let pair = [(REFLECTED, *reflected, 0.0), (TRANSMITTED, *transmitted, of(DIRECT).mean)];
            let off = pair.map(|(quantity, printed, direct)| {
                let Estimate { mean, standard_error } = of(quantity);
                // Printed digits are rounded at the fourth place.
                ((mean + direct - printed).abs() - 5e-5) / standard_error
            });
            let worst = off[0].max(off[1]);
            let is_constant = found.method.starts_with("CDS");
            assert_eq!(worst > 4.0, is_constant, "{albedo} {b} {g}: {found:?}");
            assert_eq!(found.agrees, !is_constant, "{albedo} {b} {g}: {found:?}");
        }
    }
}

/// In a cube, obliquely, with sides to leave by.
#[test]
fn all_unbiased_methods_agree_in_a_cube() {
    let phase = HenyeyGreenstein::new(-0.3).into();
    let cube = Experiment { shape: Shape::Cube, size: 1.5, sigma_a: 0.3, sigma_s: 1.7, phase, angle: 0.3 };
    let study = study(&cube, &[0.5], effort(60_000));
    assert_eq!(study.methods.iter().map(|found| found.agrees).collect::<Vec<_>>(), [true, true, true, false]);
    for found in &study.methods {
        let all: f64 =
            [SCATTERED, DIRECT, DIRECT + 1, ABSORBED].iter().map(|q| found.estimates[*q].estimate.mean).sum();
        assert!((all - 1.0).abs() < 1e-4, "{found:?}");
        assert!(found.estimates[2].estimate.mean > 0.05 && found.estimates[5].estimate.mean == 0.0);
    }
    // At 46 degrees the beam hits a side: nothing unscattered reaches the far face.
    let steep = Experiment { angle: 0.8, ..cube };
    assert_eq!(steep.closed_forms()[DIRECT], Some(0.0));
    assert!((steep.closed_forms()[DIRECT + 1].unwrap() - (-2.0 * 0.75 / 0.8f64.sin()).exp()).abs() < 1e-6);
}

/// Power that is nearly gone ends by chance, and is not lost in the mean: here nearly every photon comes to that.
#[test]
fn all_power_leaves_or_stays() {
    let study = study(&slab(0.5, 40.0, 0.0), &[], effort(20_000));
    for found in &study.methods {
        let all: f64 = [SCATTERED, DIRECT, ABSORBED].iter().map(|q| found.estimates[*q].estimate.mean).sum();
        // Of at most 1e-3 one in ten survives tenfold: 3e-3 / sqrt(20 000) is the standard error at most.
        assert!((all - 1.0).abs() < 8e-5, "{found:?}");
    }
}

/// Short steps err little: the bias shrinks with the step, and the time grows.
#[test]
fn shorter_steps_err_less() {
    let study = study(&slab(0.9, 2.0, 0.0), &[1.0, 0.25], effort(100_000));
    let bias = |found: &Found| found.estimates[SCATTERED].bias.abs();
    let [.., long, short] = &study.methods[..] else { panic!("{study:?}") };
    assert!(bias(short) < 0.5 * bias(long), "{long:?} {short:?}");
}

#[test]
fn the_law_of_constant_steps_is_reproduced() {
    let laws: Vec<Law> =
        [0.02, 0.3, 1.0, 4.0].into_iter().filter_map(|step| Law::measure(step, 1.3, 200_000, 5, 0)).collect();
    assert_eq!(laws.len(), 4);
    for law in &laws {
        assert!(law.z.abs() < most_z(4), "{law:?}");
        // Longer than the mean free path: seen by all but the shortest steps, whose error is 1.3 %.
        assert!(law.z_of_mean_free_path > if law.step < 0.1 { 2.0 } else { 10.0 }, "{law:?}");
    }
    assert!(Law::measure(1.0, 0.0, 1000, 0, 0).is_none());
    let path = FreePath::measure("RDS_s", 1.3, 200_000, 5, 0).unwrap();
    assert!(path.z.abs() < most_z(4) && (path.expected - 1.0 / 1.3).abs() < 1e-12, "{path:?}");
    // The variance of an exponential flight is the square of its mean.
    assert!((path.measured.standard_error * 1.3 * 200_000f64.sqrt() - 1.0).abs() < 0.02, "{path:?}");
}

/// delta / (1 - exp(-sigma_s delta)) - 1 / sigma_s: of 1 and 1 it is 1 / (e - 1); of nearly nothing half a step.
#[test]
fn the_law_is_that_of_theory_for_short_and_long_steps() {
    assert!((law::error(1.0, 1.0) - 1.0 / (1f64.exp() - 1.0)).abs() < 1e-12);
    assert!((law::error(1e-9, 2.0) / 0.5e-9 - 1.0).abs() < 1e-6);
    let [below, above] = [0.999_999e-3, 1.000_001e-3].map(|step| law::error(step, 1.0));
    assert!((above / below - 1.0).abs() < 1e-5);
    assert_eq!(law::mean_length(1e6, 1.0), 1e6);
}

#[test]
fn matter_that_only_absorbs_or_only_scatters_is_known() {
    let absorbing = Experiment { sigma_s: 0.0, sigma_a: 0.7, ..slab(0.5, 1.0, 0.0) };
    let study = study(&absorbing, &[0.3], effort(2000));
    for found in &study.methods {
        assert!(found.agrees, "{found:?}");
        assert!((found.estimates[ABSORBED].estimate.mean + (-1.4f64).exp() - 1.0).abs() < 0.04, "{found:?}");
    }
    assert!(study.laws.is_empty());
    let phase = Isotropic.into();
    let scattering = Experiment { sigma_a: 0.0, sigma_s: 2.0, phase, ..absorbing };
    let study = super::study(&scattering, &[0.5], effort(20_000));
    assert_eq!(study.methods.iter().map(|found| found.agrees).collect::<Vec<_>>(), [true, true, true, false]);
    assert!(study.methods.iter().all(|found| found.estimates[ABSORBED].estimate == Estimate::exact(0.0)));
}

#[test]
fn the_drawing_is_a_picture_without_broken_numbers() {
    let laws: Vec<Law> =
        [0.1, 1.0].into_iter().filter_map(|step| Law::measure(step, 1.0, 1000, 5, 0)).collect();
    for laws in [&laws[..], &laws[..1]] {
        let svg = drawing::svg(laws, 1.0).unwrap();
        assert!(svg.starts_with("<svg") && svg.contains("sigma_s") && !svg.contains("NaN"));
    }
}
