//! How thick smoke looks, and how bright fire, from where it is seen.

use super::{smoke::Smoke, view::View};
use crate::{
    math::{DVec3, Spectrum, boxes::narrowed},
    volume::Volume,
};

/// Optical thickness of most of the smoke, as the camera sees it; less where fire shall shine through.
const THICKNESS: f64 = 5.0;
const THICKNESS_OF_FIRE: f64 = 3.0;

/// Radiance of most of a fire at dusk.
const RADIANCE: f64 = 0.6;

/// Rays along each side of the image, and points on each of them.
const RAYS: u32 = 48;
const POINTS: u32 = 96;

/// Points along each side of the box in which smoke is looked for, and the part of the maximum that counts as smoke.
const CELLS: u32 = 48;
const SOME: f32 = 0.01;

/// What smoke is like on a line from the camera.
struct Ray {
    /// Distance of its points.
    step: f64,
    /// Density and light at each of them.
    points: Vec<[f64; 2]>,
}

/// What makes it look like smoke and fire.
pub(super) struct Levels {
    /// How thick smoke looks, in mean free paths; none where the camera sees none.
    pub thickness: Option<f64>,
    /// Extinction of a density of 1 (1/m).
    pub density: f64,
    /// Brightness of fire (1/m).
    pub emission: f64,
}

/// Largest channel of a volume at a point of its coordinates.
fn amount(volume: Option<&Volume>, at: DVec3) -> f32 {
    volume.map_or(0.0, |volume| volume.inside::<Spectrum>(at.as_vec3()).max_element())
}

/// The part of the smoke's box that holds some, as it stands.
pub(super) fn seen(smoke: &Smoke) -> [DVec3; 2] {
    let [low, high] = smoke.domain;
    let cell = (high - low) / f64::from(CELLS);
    let at = |n: u32| {
        let index = DVec3::from([n % CELLS, n / CELLS % CELLS, n / CELLS / CELLS].map(f64::from));
        low + (index + 0.5) * cell
    };
    let parts = [&smoke.density, &smoke.fire].map(|part| part.as_ref());
    let amounts =
        parts.map(|part| (0..CELLS.pow(3)).map(|n| amount(part, at(n) - smoke.centre)).collect::<Vec<_>>());
    let most = [0, 1].map(|part| amounts[part].iter().fold(0.0_f32, |a, b| a.max(*b)));
    let is_some = |n: &u32| (0..2).any(|part| amounts[part][*n as usize] > SOME * most[part]);
    let points = (0..CELLS.pow(3)).filter(is_some).map(at);
    let found =
        points.map(|point| [point - cell, point + cell]).reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]);
    found.map_or([low, high], |[a, b]| [a.max(low), b.min(high)])
}

impl Levels {
    /// Those of `smoke`, seen by `view`.
    pub(super) fn of(smoke: &Smoke, view: &View) -> Self {
        let rays: Vec<Ray> =
            view.directions(RAYS).filter_map(|direction| ray(smoke, view, direction)).collect();
        let thickness = if smoke.fire.is_some() { THICKNESS_OF_FIRE } else { THICKNESS };
        let found = typical(
            rays.iter().map(|ray| ray.step * ray.points.iter().map(|[density, _]| density).sum::<f64>()),
        );
        let chosen = three_digits(thickness / found);
        let (thickness, density) = (chosen.map(|_| thickness), chosen.unwrap_or(1.0));
        let emission =
            three_digits(RADIANCE / typical(rays.iter().map(|ray| ray.light(density)))).unwrap_or(0.01);
        Self { thickness, density, emission }
    }
}

impl Ray {
    /// Light that comes to the camera if a density of 1 has this extinction.
    fn light(&self, extinction: f64) -> f64 {
        let mut thickness = 0.0;
        let seen = |[density, light]: &[f64; 2]| {
            thickness += density * extinction * self.step;
            light * self.step * (-thickness).exp()
        };
        self.points.iter().map(seen).sum()
    }
}

/// What smoke is like along `direction`, if there is any.
fn ray(smoke: &Smoke, view: &View, direction: DVec3) -> Option<Ray> {
    let origin = view.origin - smoke.centre;
    let domain = smoke.domain.map(|corner| corner - smoke.centre);
    let [first, last] = narrowed(origin, direction, domain, [0.0, f64::INFINITY]);
    let step = (last - first) / f64::from(POINTS);
    let point = |n: u32| origin + (first + (f64::from(n) + 0.5) * step) * direction;
    let values =
        |n: u32| [&smoke.density, &smoke.fire].map(|part| f64::from(amount(part.as_ref(), point(n))));
    (step > 0.0).then(|| Ray { step, points: (0..POINTS).map(values).collect() })
}

/// The mean of values, each weighted by itself: zeros do not count, and small values hardly.
fn typical(values: impl Iterator<Item = f64>) -> f64 {
    let [sum, squares] =
        values.fold([0.0, 0.0], |[sum, squares], value| [sum + value, squares + value * value]);
    squares / sum
}

/// Rounded; none if it is not a positive number.
fn three_digits(value: f64) -> Option<f64> {
    format!("{value:.2e}").parse().ok().filter(|value: &f64| value.is_normal() && *value > 0.0)
}
