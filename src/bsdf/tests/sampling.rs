//! Samples against densities, by chi-square tests over the sphere.

use super::*;
use crate::testing::{chi_square, significance};
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Cells of the sphere: rows even in cosine to the y axis, columns even in azimuth around it.
const ROWS_OF_CELLS: usize = 24;
const COLUMNS: usize = 48;

/// Points of the quadratures across a cell, either way.
const STEPS: [usize; 4] = [8, 12, 48, 128];

/// The probability that `sample` gives a direction in `cell`, by quadrature of the forward density over
/// `steps` by `steps` points.
fn expected_share((bsdf, transport): (&Bsdf, Transport), wi: Vec3, cell: usize, steps: usize) -> f64 {
    let (row, column) = (cell / COLUMNS, cell % COLUMNS);
    let pdf = |i: usize| {
        let along = (row as f32 + ((i / steps) as f32 + 0.5) / steps as f32) / ROWS_OF_CELLS as f32;
        let around = (column as f32 + ((i % steps) as f32 + 0.5) / steps as f32) / COLUMNS as f32;
        // The poles of the grid, where its cells are long and thin, lie in the horizon, away from all lobes.
        let turned = warp::spherical(2.0 * along - 1.0, TAU as f32 * around);
        let wo = vec3(turned.y, turned.z, turned.x);
        f64::from(bsdf.evaluate(UV, wi, wo, transport).pdf_fwd)
    };
    let area = 2.0 * TAU / (ROWS_OF_CELLS * COLUMNS * steps * steps) as f64;
    (0..steps * steps).map(pdf).sum::<f64>() * area
}

/// Counts expected of `samples` samples in each cell, by quadratures that are finer until that makes next to no
/// difference beside the noise; a cell that a lobe may only touch, as it lies beside one with some of it, has the finest.
fn expected_counts(model: (&Bsdf, Transport), wi: Vec3, samples: f64) -> Vec<f64> {
    let by = |steps, cell| samples * expected_share(model, wi, cell, steps);
    let first: Vec<f64> = (0..ROWS_OF_CELLS * COLUMNS).map(|cell| by(STEPS[0], cell)).collect();
    let count = |cell: usize| {
        let mut count = first[cell];
        if count == 0.0 && beside(cell).any(|other| first[other] > 0.0) {
            return by(STEPS[3], cell);
        }
        for steps in &STEPS[1..] {
            let coarse = std::mem::replace(&mut count, by(*steps, cell));
            if (count - coarse).abs() < 0.02 * count.max(1.0).sqrt() {
                break;
            }
        }
        count
    };
    (0..first.len()).map(count).collect()
}

/// The cells around one, itself included.
fn beside(cell: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (cell / COLUMNS, cell % COLUMNS);
    let rows = row.saturating_sub(1)..=(row + 1).min(ROWS_OF_CELLS - 1);
    rows.flat_map(move |row| (0..3).map(move |side| row * COLUMNS + (column + COLUMNS + side - 1) % COLUMNS))
}

fn cell_of(w: Vec3) -> usize {
    let around = (f64::from(w.x).atan2(f64::from(w.z)) / TAU).rem_euclid(1.0);
    let index = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
    index(0.5 + 0.5 * f64::from(w.y), ROWS_OF_CELLS) * COLUMNS + index(around, COLUMNS)
}

/// Both ways where they differ.
fn both_ways(bsdf: Bsdf) -> Vec<(Bsdf, Transport)> {
    let ways = if is_one_way(&bsdf) { &BOTH[..] } else { &BOTH[..1] };
    ways.iter().map(|transport| (bsdf.clone(), *transport)).collect()
}

#[test]
fn every_model_samples_its_density() {
    let models: Vec<(Bsdf, Transport)> = connectible().into_iter().flat_map(both_ways).collect();
    let incoming = incoming();
    let level = significance(models.len() * incoming.len());
    let samples = 50_000;
    models.par_iter().for_each(|(bsdf, transport)| {
        for (number, wi) in incoming.iter().enumerate() {
            let mut stream = stream(number as u64);
            let expected = expected_counts((bsdf, *transport), *wi, f64::from(samples));
            let mut observed = vec![0; expected.len()];
            for _ in 0..samples {
                let sample = bsdf.sample(UV, *wi, *transport, &mut stream);
                if let Some(sample) = sample.filter(|sample| !sample.dirac) {
                    observed[cell_of(sample.wo)] += 1;
                }
            }
            let (found, total) = (observed.iter().sum::<u64>() as f64, expected.iter().sum::<f64>());
            let slack = 5.0 * (f64::from(samples) - total).max(1.0).sqrt() + 2e-3 * f64::from(samples);
            assert!((found - total).abs() < slack, "{bsdf:?} from {wi}: {found} samples for {total}");
            let p = chi_square(&observed, &expected);
            assert!(p > level, "{bsdf:?} from {wi}: p-value {p}");
        }
    });
}

/// What smooth surfaces do is what they sample, and how likely that is.
#[test]
fn dirac_lobes_are_those_that_are_sampled() {
    let mut met = 0;
    for bsdf in examples().into_iter().filter(|bsdf| bsdf.smooth().is_some()) {
        for (wi, transport) in incoming().into_iter().flat_map(|wi| BOTH.map(|transport| (wi, transport))) {
            for index in 0..20 {
                let Some(sample) = bsdf.sample(UV, wi, transport, &mut stream(index)) else { continue };
                let side = if sample.wo.z * wi.z > 0.0 { Side::Reflected } else { Side::Transmitted };
                let (wo, coefficient) = bsdf.dirac(UV, wi, side, transport).unwrap();
                assert!(wo.distance(sample.wo) < 1e-6, "{bsdf:?} from {wi}: {wo}, not {}", sample.wo);
                assert!(
                    close_colors(coefficient, sample.weight * sample.pdf_fwd, 1e-5),
                    "{bsdf:?} from {wi}"
                );
                met += 1;
            }
        }
    }
    assert!(met > 1000, "{met}");
}
