//! A goniometric profile: relative intensity or radiance by the angle to an axis, as lamp makers publish it.

use crate::{
    description::{Params, parameter::Parameter, rows},
    error::Result,
    math::{Vec3, warp},
    sampling::{Discrete, Stream},
};
use std::f64::consts::{FRAC_PI_2, PI};

/// Values at angles in [0, 180] degrees, linear between them and constant beyond the first and last.
#[derive(Clone, Debug)]
pub(super) struct Profile {
    /// Angle to the axis (rad) and value, by increasing angle.
    points: Vec<(f64, f64)>,
    /// All around the axis, uniform in cos within each ring.
    around: Rings,
    /// From a surface across the axis, uniform in sin^2 within each ring.
    surface: Rings,
    integral: f64,
    projected_integral: f64,
}

/// Rings of angles, chosen in proportion to what leaves through each.
#[derive(Clone, Debug)]
struct Rings {
    /// Angles between the rings (rad), from 0 on.
    edges: Vec<f64>,
    chosen: Discrete,
}

/// Rings between two given angles: within each the profile is nearly constant.
const RINGS: u32 = 8;

/// What emitters have that a profile shapes.
pub(super) const PROFILE: &[Parameter] = rows! {
    text("profile", "pairs angle:value such as \"0:1, 30:0.8, 90:0\"", Optional,
        "Relative brightness by the angle to the axis [degrees], linearly interpolated.").ours(),
};

impl Profile {
    pub(super) fn build(params: &Params<'_>) -> Result<Option<Self>> {
        let Some(text) = params.optional_string("profile")? else { return Ok(None) };
        let expected = "pairs angle:value (degrees from 0 to 180, increasing; values 0 or from 1e-30 to 1e30, not all 0)";
        let wrong = || params.complain("profile", expected, format!("\"{text}\""));
        let points = parse(text).ok_or_else(wrong)?;
        let profile = Self::new(&points);
        // Light that only leaves backwards cannot leave a surface, but can leave a point.
        if profile.integral > 0.0 { Ok(Some(profile)) } else { Err(wrong()) }
    }

    /// From angles (degrees) and values.
    fn new(points: &[(f64, f64)]) -> Self {
        let points: Vec<(f64, f64)> = points.iter().map(|(a, v)| (a.to_radians(), *v)).collect();
        let value = |angle: f64| interpolated(&points, angle);
        let around = Rings::new(&points, PI, |a| value(a) * a.sin());
        let surface = Rings::new(&points, FRAC_PI_2, |a| value(a) * a.sin() * a.cos());
        let (integral, projected_integral) =
            (2.0 * PI * around.chosen.total(), 2.0 * PI * surface.chosen.total());
        Self { points, around, surface, integral, projected_integral }
    }

    /// The value at an angle of `cosine` to the axis.
    #[inline]
    pub(super) fn value(&self, cosine: f32) -> f32 {
        interpolated(&self.points, f64::from(cosine).clamp(-1.0, 1.0).acos()) as f32
    }

    /// Integral over all directions (sr).
    pub(super) fn integral(&self) -> f32 {
        self.integral as f32
    }

    /// Integral of value x cosine over the hemisphere around the axis (sr).
    pub(super) fn projected_integral(&self) -> f32 {
        self.projected_integral as f32
    }

    /// A direction around local +z, nearly in proportion to the value.
    #[inline]
    pub(super) fn sample_around(&self, stream: &mut Stream) -> Vec3 {
        let (low, high) = self.around.sample(stream);
        let u = stream.square();
        let (low, high) = (one_minus_cos(low), one_minus_cos(high));
        warp::near_pole((low + f64::from(u.x) * (high - low)) as f32, std::f32::consts::TAU * u.y)
    }

    /// Density of `sample_around` (1/sr).
    #[inline]
    pub(super) fn pdf_sr_around(&self, cosine: f32) -> f32 {
        let (low, high, probability) = self.around.ring(cosine);
        (probability / (2.0 * PI * (one_minus_cos(high) - one_minus_cos(low)))) as f32
    }

    /// A direction above local z = 0, nearly in proportion to value x cosine.
    #[inline]
    pub(super) fn sample_from_surface(&self, stream: &mut Stream) -> Vec3 {
        let (low, high) = self.surface.sample(stream);
        let u = stream.square();
        let (s, c) = (std::f32::consts::TAU * u.y).sin_cos();
        // Either by itself: as the complement of the other, cosines of grazing directions would be 0.
        let between = |low: f64, high: f64| {
            let share = f64::from(u.x);
            (low.powi(2) * (1.0 - share) + high.powi(2) * share).sqrt() as f32
        };
        let sine = between(low.sin(), high.sin());
        Vec3::new(sine * c, sine * s, between(low.cos(), high.cos()))
    }

    /// Density of `sample_from_surface` (1/sr).
    #[inline]
    pub(super) fn pdf_sr_from_surface(&self, cosine: f32) -> f32 {
        if cosine <= 0.0 || self.surface.chosen.is_empty() {
            return 0.0;
        }
        let (low, high, probability) = self.surface.ring(cosine);
        (probability * f64::from(cosine) / (PI * (high.sin().powi(2) - low.sin().powi(2)))) as f32
    }
}

impl Rings {
    /// Rings from 0 to `end` whose edges include the angles of `points`, weighted by the integral of `f`.
    fn new(points: &[(f64, f64)], end: f64, f: impl Fn(f64) -> f64) -> Self {
        let inside = points.iter().map(|(angle, _)| *angle).filter(|angle| *angle > 0.0 && *angle < end);
        let corners: Vec<f64> = std::iter::once(0.0).chain(inside).chain([end]).collect();
        let mut edges = vec![0.0];
        for pair in corners.windows(2) {
            let step = (pair[1] - pair[0]) / f64::from(RINGS);
            edges.extend((1..RINGS).map(|i| pair[0] + f64::from(i) * step).chain([pair[1]]));
        }
        let chosen = Discrete::new(edges.windows(2).map(|ring| integral(ring[0], ring[1], &f)));
        Self { edges, chosen }
    }

    /// The angles that bound a sampled ring.
    #[inline]
    fn sample(&self, stream: &mut Stream) -> (f64, f64) {
        let (ring, _) = self.chosen.sample_precisely(stream.uniform_precisely());
        (self.edges[ring], self.edges[ring + 1])
    }

    /// The ring that holds the angle of `cosine` to the axis: its bounds and its probability.
    #[inline]
    fn ring(&self, cosine: f32) -> (f64, f64, f64) {
        let angle = f64::from(cosine).clamp(-1.0, 1.0).acos();
        let last = self.edges.len() - 2;
        let ring = self.edges.partition_point(|edge| *edge <= angle).saturating_sub(1).min(last);
        (self.edges[ring], self.edges[ring + 1], self.chosen.probability_precisely(ring))
    }
}

fn one_minus_cos(angle: f64) -> f64 {
    2.0 * (0.5 * angle).sin().powi(2)
}

/// Integral of a smooth function >= 0 by three Gauss nodes, all of positive weight: 0 only where it is.
fn integral(low: f64, high: f64, f: impl Fn(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let offset = half * 0.6f64.sqrt();
    half * (5.0 * f(middle - offset) + 8.0 * f(middle) + 5.0 * f(middle + offset)) / 9.0
}

fn interpolated(points: &[(f64, f64)], angle: f64) -> f64 {
    let next = points.partition_point(|(a, _)| *a <= angle);
    match (next.checked_sub(1).map(|last| points[last]), points.get(next)) {
        (Some((a, v)), Some((b, w))) => v + (w - v) * ((angle - a) / (b - a)),
        (Some((_, v)), None) => v,
        (None, next) => next.map_or(0.0, |(_, v)| *v),
    }
}

fn parse(text: &str) -> Option<Vec<(f64, f64)>> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let pair = |word: &str| {
        let (angle, value) = word.split_once(':')?;
        let (angle, value) = (angle.parse::<f64>().ok()?, value.parse::<f64>().ok()?);
        // Values that f32 would round to 0 or to infinity are errors.
        let fits = value == 0.0 || (1e-30..=1e30).contains(&value);
        ((0.0..=180.0).contains(&angle) && fits).then_some((angle, value))
    };
    let points = words.map(pair).collect::<Option<Vec<_>>>()?;
    let increasing = points.windows(2).all(|pair| pair[0].0 < pair[1].0);
    (!points.is_empty() && increasing).then_some(points)
}
