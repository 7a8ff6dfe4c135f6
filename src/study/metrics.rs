//! How far an image is from another.

use crate::math::Spectrum;

/// Keeps black pixels from deciding everything [radiance^2, or radiance].
const FLOOR: f64 = 0.01;
/// The part of the values, the worst, that the trimmed measure leaves out.
const TRIM: f64 = 0.001;

/// Measures of difference over all pixels and channels, as `outcome.rs` defines them; NaN where an image holds numbers
/// that are not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measures {
    /// Mean squared error.
    pub mse: f64,
    /// Its root.
    pub rmse: f64,
    /// mean((x - r)^2 / (r^2 + 0.01)).
    pub relmse: f64,
    /// The same without the worst 0.1 % of values.
    pub trimmed_relmse: f64,
    /// mean(|x - r| / (|r| + 0.01)).
    pub mape: f64,
    /// mean(2 |x - r| / (|x| + |r| + 0.01)).
    pub smape: f64,
}

/// Measures `image` against `reference`, two images of the same size.
pub fn measures(image: &[Spectrum], reference: &[Spectrum]) -> Measures {
    let values = |image: &[Spectrum]| -> Vec<f64> {
        image.iter().flat_map(|pixel| pixel.to_array()).map(f64::from).collect()
    };
    let (x, r) = (values(image), values(reference));
    if !x.iter().chain(&r).all(|value| value.is_finite()) {
        let nan = f64::NAN;
        return Measures { mse: nan, rmse: nan, relmse: nan, trimmed_relmse: nan, mape: nan, smape: nan };
    }
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        x.iter().zip(&r).map(|(x, r)| of(*x, *r)).sum::<f64>() / x.len().max(1) as f64
    };
    let mse = mean(&|x, r| (x - r).powi(2));
    let relative = |x: f64, r: f64| (x - r).powi(2) / (r * r + FLOOR);
    let mut all: Vec<f64> = x.iter().zip(&r).map(|(x, r)| relative(*x, *r)).collect();
    all.sort_by(f64::total_cmp);
    let kept = &all[..((1.0 - TRIM) * all.len() as f64) as usize];
    Measures {
        mse,
        rmse: mse.sqrt(),
        relmse: mean(&relative),
        trimmed_relmse: kept.iter().sum::<f64>() / kept.len().max(1) as f64,
        mape: mean(&|x, r| (x - r).abs() / (r.abs() + FLOOR)),
        smape: mean(&|x, r| 2.0 * (x - r).abs() / (x.abs() + r.abs() + FLOOR)),
    }
}
