//! Reconstruction filters. Camera subpaths either use filter importance sampling (Ernst et al. 2006), so that every sample
//! counts fully for one pixel, or are shared by all pixels that the filter reaches, see [`super::sharing`]. Light
//! subpaths are splatted onto all these pixels.
//!
//! Where a filter has negative lobes, camera subpaths are distributed by its magnitude. They carry its sign, times the
//! integral of |f| over that of f.

use super::lobes::{self, Lobes};
use crate::{
    description::{Build, Plugin, Registry, Table, table},
    sampling::Stream,
};
use std::f32::consts::PI;

/// A separable filter, by its profile along one axis, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// 1 within half a pixel.
    Box,
    /// Falls linearly to 0 at `radius`.
    Tent {
        /// Where it ends (pixels).
        radius: f32,
    },
    /// A Gaussian less its value at four standard deviations, 0 beyond.
    Gaussian {
        /// Standard deviation (pixels).
        stddev: f32,
    },
    /// The cubic splines of Mitchell and Netravali 1988 (eq. 8), which end at 2 pixels; Catmull and Rom's is
    /// that of (0, 1/2).
    Cubic {
        /// Their B, in [0, 1]: more blurs.
        b: f32,
        /// Their C, in [0, 1]: more rings.
        c: f32,
    },
    /// sinc(x) sinc(x / lobes), sinc(x) = sin(pi x) / (pi x).
    Lanczos {
        /// Where it ends (pixels), from 1.
        lobes: u32,
    },
}

/// Filter names and how each reads its parameters.
pub const ROWS: Registry<Plugin<Build<Filter>>> = Registry::new(
    "a reconstruction filter",
    &[
        ("box", plugin(BOX, |_| Ok(Filter::Box))),
        ("tent", plugin(TENT, |p| Ok(Filter::Tent { radius: p.float("radius")? as f32 }))),
        ("gaussian", plugin(GAUSSIAN, |p| Ok(Filter::Gaussian { stddev: p.float("stddev")? as f32 }))),
        (
            "mitchell",
            plugin(MITCHELL, |p| Ok(Filter::Cubic { b: p.float("B")? as f32, c: p.float("C")? as f32 })),
        ),
        ("catmullrom", plugin(CATMULL_ROM, |_| Ok(Filter::Cubic { b: 0.0, c: 0.5 }))),
        ("lanczos", plugin(LANCZOS, |p| Ok(Filter::Lanczos { lobes: p.integer("lobes")? as u32 }))),
    ],
);

const fn plugin(table: Table, build: Build<Filter>) -> Plugin<Build<Filter>> {
    Plugin { table, build }
}

const BOX: Table = table! { "The mean over the pixel."; };

const TENT: Table = table! {
    "A linear falloff to 0.";
    number("radius", "pixels", within(1e-3, 1e3), Is(1.0), "Distance at which it reaches 0."),
};

const GAUSSIAN: Table = table! {
    "A Gaussian, cut at four standard deviations.";
    number("stddev", "pixels", within(1e-3, 1e3), Is(0.5), "Standard deviation."),
};

const MITCHELL: Table = table! {
    "The cubic splines of Mitchell and Netravali 1988.";
    number("B", "", within(0.0, 1.0), Is(1.0 / 3.0), "Greater values blur."),
    number("C", "", within(0.0, 1.0), Is(1.0 / 3.0), "Greater values ring."),
};

const CATMULL_ROM: Table = table! { "The Catmull-Rom spline: `mitchell` with B = 0 and C = 1/2."; };

const LANCZOS: Table = table! {
    "A windowed sinc: sharp, but it rings.";
    integer("lobes", within(1.0, 32.0), Is(3.0), "Lobes on each side."),
};

impl Filter {
    /// Distance from its centre beyond which it is 0 (pixels).
    pub fn radius(&self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Tent { radius } => *radius,
            Self::Gaussian { stddev } => 4.0 * stddev,
            Self::Cubic { .. } => 2.0,
            Self::Lanczos { lobes } => *lobes as f32,
        }
    }

    /// Its value, not normalised.
    #[inline]
    pub fn value(&self, x: f32) -> f32 {
        match self {
            Self::Box => f32::from(u8::from((-0.5..0.5).contains(&x))),
            Self::Tent { radius } => (1.0 - x.abs() / radius).max(0.0),
            Self::Gaussian { stddev } => {
                let x = x / stddev;
                ((-0.5 * x * x).exp() - (-8f32).exp()).max(0.0)
            }
            Self::Cubic { b, c } => cubic(*b, *c, x.abs()),
            Self::Lanczos { lobes } => lanczos(*lobes as f32, x.abs()),
        }
    }

    /// How positions are drawn.
    fn sampler(&self) -> Sampler {
        match *self {
            Self::Box => Sampler::Plain(Plain::Box),
            Self::Tent { radius } => Sampler::Plain(Plain::Tent { radius }),
            Self::Gaussian { stddev } => Sampler::Plain(Plain::Gaussian { stddev }),
            Self::Cubic { .. } | Self::Lanczos { .. } => Sampler::Lobes(Box::new(Lobes::new(*self))),
        }
    }

    /// Integral of `value` from `low` to `high`, within its radius and between two of its
    /// [`knots`](Self::knots).
    pub(super) fn integral(&self, low: f64, high: f64) -> f64 {
        match self {
            Self::Box => high - low,
            Self::Tent { radius } => {
                let below = |x: f64| x - x * x.abs() / (2.0 * f64::from(*radius));
                below(high) - below(low)
            }
            Self::Gaussian { stddev } => {
                let s = f64::from(*stddev);
                let below = |x: f64| {
                    let gauss = s
                        * (0.5 * std::f64::consts::PI).sqrt()
                        * libm::erf(x / (s * std::f64::consts::SQRT_2));
                    gauss - (-8f64).exp() * x
                };
                below(high) - below(low)
            }
            Self::Cubic { .. } | Self::Lanczos { .. } => {
                lobes::simpson(low, high, |x| f64::from(self.value(x as f32)))
            }
        }
    }

    /// Distances from 0 up, its radius the last, between which it is smooth and of one sign.
    pub(super) fn knots(&self) -> Vec<f64> {
        match self {
            Self::Box | Self::Tent { .. } | Self::Gaussian { .. } => vec![0.0, f64::from(self.radius())],
            Self::Cubic { b, c } => {
                let (b, c) = (f64::from(*b), f64::from(*c));
                // The root of the outer piece; without C it has none but its end.
                let root = if c > 0.0 { 2.0 - 6.0 * c / (b + 6.0 * c) } else { 2.0 };
                vec![0.0, 1.0, root, 2.0]
            }
            Self::Lanczos { lobes } => (0..=*lobes).map(f64::from).collect(),
        }
    }

    /// A bound on the magnitude of its derivative [1/pixel], for filters with lobes.
    pub(super) fn steepness(&self) -> f32 {
        match *self {
            Self::Box => f32::INFINITY,
            Self::Tent { radius } => 1.0 / radius,
            Self::Gaussian { stddev } => 1.0 / stddev,
            Self::Cubic { b, c } => {
                let inner = 3.0 * (12.0 - 9.0 * b - 6.0 * c).abs() + 2.0 * (-18.0 + 12.0 * b + 6.0 * c).abs();
                let outer = 3.0 * (b + 6.0 * c) + 12.0 * c;
                inner.max(outer) / 6.0
            }
            // |d sinc / dx| < pi / 2, and both factors are at most 1.
            Self::Lanczos { lobes } => 0.5 * PI * (1.0 + 1.0 / lobes as f32),
        }
    }
}

/// The cubic of parameters `b` and `c` at distance `x` >= 0. Like the next kept apart, so that simpler filters do
/// not carry its code along.
#[inline(never)]
fn cubic(b: f32, c: f32, x: f32) -> f32 {
    if x < 1.0 {
        (((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)) / 6.0
    } else if x < 2.0 {
        // Written from its end, where it touches 0.
        let t = 2.0 - x;
        t * t * ((b + 6.0 * c) * t - 6.0 * c) / 6.0
    } else {
        0.0
    }
}

/// The windowed sinc with the given number of lobes at distance `x` >= 0.
#[inline(never)]
fn lanczos(lobes: f32, x: f32) -> f32 {
    let angle = PI * x;
    if x >= lobes {
        0.0
    } else if angle < 1e-3 {
        // Beyond this the series' next term is below the last place.
        1.0 - angle * angle * (1.0 + 1.0 / (lobes * lobes)) / 6.0
    } else {
        angle.sin() * (angle / lobes).sin() * lobes / (angle * angle)
    }
}

/// Draws distances from a pixel's centre, distributed by the magnitude of a filter.
#[derive(Clone, Debug)]
enum Sampler {
    Plain(Plain),
    Lobes(Box<Lobes>),
}

/// A filter that is nowhere negative.
#[derive(Clone, Copy, Debug)]
enum Plain {
    Box,
    Tent { radius: f32 },
    Gaussian { stddev: f32 },
}

impl Plain {
    /// A distance (pixels).
    #[inline]
    fn sample(self, stream: &mut Stream) -> f32 {
        match self {
            Self::Box => stream.uniform() - 0.5,
            Self::Tent { radius } => radius * (stream.uniform() - stream.uniform()),
            Self::Gaussian { stddev } => loop {
                // The pedestal is taken off by rejection: exact, and one draw in 10 000 is rejected.
                let x = stream.normal();
                let gauss = (-0.5 * x * x).exp();
                if stream.uniform() * gauss >= (-8f32).exp() && x.abs() < 4.0 {
                    break x * stddev;
                }
            },
        }
    }
}

/// A filter along one axis of a film: where samples end it is cut off, and normalised again.
#[derive(Clone, Debug)]
pub struct Axis {
    pub(super) filter: Filter,
    sampler: Sampler,
    pub(super) size: u32,
    /// Positions from here...
    low: f32,
    /// ...to here are sampled.
    high: f32,
    /// 1 / integral over those positions, per pixel.
    pub(super) scales: Vec<f32>,
    /// Integral of the magnitude over that of the filter, per pixel; empty where they are the same.
    cancelled: Vec<f32>,
}

impl Axis {
    /// An axis of `size` pixels, sampled up to so many pixels `before` and `after` them.
    pub fn new(filter: Filter, size: u32, [before, after]: [u32; 2]) -> Self {
        let (low, high) = (-f64::from(before), f64::from(size) + f64::from(after));
        let radius = f64::from(filter.radius());
        let parts = |from: f64, to: f64| {
            let parts = lobes::integrals(&filter, from, to);
            (parts.iter().sum::<f64>(), parts.iter().map(|part| part.abs()).sum::<f64>())
        };
        let whole = parts(-radius, radius);
        let of_pixel = |i: u32| {
            let (before, after) = (f64::from(i) + 0.5 - low, high - (f64::from(i) + 0.5));
            if before >= radius && after >= radius { whole } else { parts(-before, after) }
        };
        let sums: Vec<(f64, f64)> = (0..size).map(of_pixel).collect();
        let sampler = filter.sampler();
        let cancelled = match sampler {
            Sampler::Lobes(_) => sums.iter().map(|(sum, magnitude)| (magnitude / sum) as f32).collect(),
            Sampler::Plain(_) => Vec::new(),
        };
        let scales = sums.iter().map(|(sum, _)| (1.0 / sum) as f32).collect();
        Self { filter, sampler, size, low: low as f32, high: high as f32, scales, cancelled }
    }

    /// True if samples are taken at `x`.
    #[inline]
    pub fn covers(&self, x: f32) -> bool {
        x >= self.low && x < self.high
    }

    /// A position on the axis distributed by the magnitude of the filter of `pixel`, and the weight that a
    /// sample there counts with: 1, or where the filter has negative lobes, of its sign.
    #[inline]
    pub fn sample(&self, pixel: usize, stream: &mut Stream) -> (f32, f32) {
        match &self.sampler {
            Sampler::Plain(plain) => loop {
                let x = pixel as f32 + 0.5 + plain.sample(stream);
                if self.covers(x) {
                    break (x, 1.0);
                }
            },
            Sampler::Lobes(lobes) => self.sample_lobes(lobes, pixel, stream),
        }
    }

    /// Kept apart, so that filters without lobes do not carry its code along.
    #[inline(never)]
    fn sample_lobes(&self, lobes: &Lobes, pixel: usize, stream: &mut Stream) -> (f32, f32) {
        loop {
            let (distance, sign) = lobes.sample(stream);
            let x = pixel as f32 + 0.5 + distance;
            if self.covers(x) {
                break (x, sign * self.cancelled[pixel]);
            }
        }
    }

    /// The pixels whose filter reaches `x`, each with its normalised value there.
    #[inline]
    pub fn weights(&self, x: f32) -> impl Iterator<Item = (usize, f32)> + Clone + '_ {
        let radius = self.filter.radius();
        let first = (x - radius - 0.5).ceil().max(0.0) as usize;
        let last = ((x + radius - 0.5).floor() as isize).min(self.size as isize - 1);
        (first..(last + 1).max(0) as usize)
            .map(move |i| (i, self.filter.value(x - (i as f32 + 0.5)) * self.scales[i]))
    }

    /// One of these pixels, drawn by the magnitude of its value, and the weight that it then counts with.
    #[inline]
    pub fn pick(&self, x: f32, stream: &mut Stream) -> Option<(usize, f32)> {
        let sum: f32 = self.weights(x).map(|(_, weight)| weight.abs()).sum();
        let mut left = stream.uniform() * sum;
        let is_it = |(_, weight): &(usize, f32)| {
            left -= weight.abs();
            left < 0.0
        };
        let drawn = self.weights(x).find(is_it).or_else(|| self.weights(x).last());
        drawn.map(|(pixel, weight)| (pixel, sum.copysign(weight)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream::Purpose;
    use crate::testing::{chi_square, significance};

    const THIRD: f32 = 1.0 / 3.0;
    const FILTERS: [Filter; 10] = [
        Filter::Box,
        Filter::Tent { radius: 1.0 },
        Filter::Tent { radius: 1.7 },
        Filter::Gaussian { stddev: 0.5 },
        Filter::Cubic { b: THIRD, c: THIRD },
        Filter::Cubic { b: 0.0, c: 0.5 },
        Filter::Cubic { b: 1.0, c: 0.0 },
        Filter::Cubic { b: 0.0, c: 1.0 },
        Filter::Lanczos { lobes: 3 },
        Filter::Lanczos { lobes: 1 },
    ];
    /// Films as narrow as a pixel too, with and without samples beyond their ends.
    const AXES: [(u32, [u32; 2]); 5] = [(5, [0, 0]), (1, [0, 0]), (2, [0, 0]), (2, [3, 3]), (2, [1, 3])];

    /// Mitsuba 3.9.1's own values (`eval` of its plugins).
    #[test]
    fn values_are_those_of_mitsuba() {
        let at = [0.0, 0.25, 0.5, 0.75, 1.5, 1.9, 2.5];
        let sixth = Filter::Cubic { b: 0.2, c: 0.6 };
        for (filter, expected) in [
            (FILTERS[2], [1.0, 0.852_941, 0.705_882, 0.558_824, 0.117_647, 0.0, 0.0]),
            (FILTERS[4], [0.888_889, 0.782_118, 0.534_722, 0.256_076, -0.034_722, -0.002_944, 0.0]),
            (FILTERS[5], [1.0, 0.867_188, 0.5625, 0.226_562, -0.0625, -0.0045, 0.0]),
            (sixth, [0.933_333, 0.825_521, 0.570_833, 0.272_396, -0.070_833, -0.005_367, 0.0]),
            (FILTERS[8], [1.0, 0.890_067, 0.607_927, 0.270_19, -0.135_095, -0.023_77, 0.024_317]),
            (
                Filter::Lanczos { lobes: 2 },
                [1.0, 0.877_354, 0.573_159, 0.235_347, -0.063_684, -0.002_714, 0.0],
            ),
        ] {
            for (x, expected) in at.into_iter().zip(expected) {
                for x in [x, -x] {
                    let found = filter.value(x);
                    assert!((found - expected).abs() < 1e-6, "{filter:?} at {x}: {found}, not {expected}");
                }
            }
        }
        // Mitsuba's Gaussian is a polynomial that is off by up to 4e-4.
        for (x, expected) in [(0.0, 0.999_247), (0.5, 0.606_423), (1.0, 0.134_96), (1.5, 0.010_758)] {
            assert!((FILTERS[3].value(x) - expected).abs() < 5e-4, "at {x}");
        }
    }

    /// Every pixel's weights integrate to one over the film, borders included.
    #[test]
    fn weights_are_normalised_on_the_film() {
        for (filter, (size, border)) in FILTERS.into_iter().flat_map(|f| AXES.map(|axis| (f, axis))) {
            let steps = 20_000;
            let axis = Axis::new(filter, size, border);
            let mut sums = vec![0.0; size as usize];
            for i in 0..steps * (size + border[0] + border[1]) {
                let x = (i as f32 + 0.5) / steps as f32 - border[0] as f32;
                assert!(axis.covers(x));
                axis.weights(x).for_each(|(pixel, w)| sums[pixel] += f64::from(w) / f64::from(steps));
            }
            for sum in sums {
                assert!((sum - 1.0).abs() < 1e-3, "{filter:?}: {sum}");
            }
        }
    }

    /// Sampled positions follow the magnitude of the weights, and carry their sign and size.
    #[test]
    fn samples_follow_the_weights() {
        const CELLS: usize = 160;
        let cases: Vec<_> = FILTERS.into_iter().flat_map(|f| AXES.map(|axis| (f, axis))).collect();
        let level = significance(2 * cases.len());
        for (filter, (size, border)) in cases {
            for pixel in [0, size as usize / 2] {
                let axis = Axis::new(filter, size, border);
                let mut stream = Stream::new(7, pixel as u64, 0, Purpose::Study);
                let (n, width) = (200_000, f64::from(size + border[0] + border[1]) / CELLS as f64);
                // Of the magnitude, per cell; the weight of every sample.
                let pdf = |x: f64| {
                    let weight = axis.weights(x as f32).find(|(i, _)| *i == pixel).map_or(0.0, |(_, w)| w);
                    f64::from(weight)
                };
                let start = |cell: usize| cell as f64 * width - f64::from(border[0]);
                let mass = |cell: usize| {
                    (0..400)
                        .map(|k| pdf(start(cell) + (f64::from(k) + 0.5) / 400.0 * width).abs())
                        .sum::<f64>()
                        * width
                        / 400.0
                };
                let masses: Vec<f64> = (0..CELLS).map(mass).collect();
                let magnitude: f64 = masses.iter().sum();
                let mut observed = vec![0; CELLS];
                for _ in 0..n {
                    let (x, weight) = axis.sample(pixel, &mut stream);
                    observed[((f64::from(x) + f64::from(border[0])) / width) as usize] += 1;
                    let expected = magnitude.copysign(pdf(f64::from(x)));
                    // At a root rounding decides the sign.
                    let at_root = pdf(f64::from(x)).abs() < 1e-5;
                    assert!(
                        at_root || (f64::from(weight) - expected).abs() < 2e-3 * magnitude,
                        "{filter:?} at {x}: {weight}, not {expected}"
                    );
                }
                let expected: Vec<f64> = masses.iter().map(|m| m / magnitude * f64::from(n)).collect();
                let p = chi_square(&observed, &expected);
                assert!(p > level, "{filter:?} pixel {pixel} of {size} + {border:?}: p {p}");
            }
        }
    }

    /// What a sample of one pixel counts for is on average what its filter makes of the image.
    #[test]
    fn signed_samples_average_to_the_filtered_image() {
        // exp(-x) represents the image.
        for (filter, (size, border)) in FILTERS.into_iter().flat_map(|f| AXES.map(|axis| (f, axis))) {
            let axis = Axis::new(filter, size, border);
            let mut stream = Stream::new(8, 0, 0, Purpose::Study);
            let (n, steps) = (100_000, 100_000);
            let (mut sum, mut squares) = (0.0, 0.0);
            for _ in 0..n {
                let (x, weight) = axis.sample(0, &mut stream);
                let value = f64::from(weight) * (-f64::from(x)).exp();
                sum += value;
                squares += value * value;
            }
            let step = f64::from(size + border[0] + border[1]) / f64::from(steps);
            let truth: f64 = (0..steps)
                .map(|i| (f64::from(i) + 0.5) * step - f64::from(border[0]))
                .map(|x| {
                    let weight = axis.weights(x as f32).find(|(i, _)| *i == 0).map_or(0.0, |(_, w)| w);
                    f64::from(weight) * (-x).exp() * step
                })
                .sum();
            let mean = sum / f64::from(n);
            let error = ((squares / f64::from(n) - mean * mean) / f64::from(n)).sqrt();
            assert!((mean - truth).abs() < 4.5 * error, "{filter:?} {size}: {mean} +- {error}, not {truth}");
        }
    }
}
