//! Reconstruction filters. Eye walks are distributed by the filter, so every sample counts fully for one
//! pixel; what light walks bring is spread over the pixels that the filter reaches.

use crate::{description::Params, error::Result, sampling::Stream};

/// A separable filter, by its profile along one axis, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    /// 1 within half a pixel.
    Box,
    /// Falls linearly to 0 at `radius`.
    Tent {
        /// Where it ends [pixels].
        radius: f32,
    },
    /// A Gaussian less its value at four standard deviations, 0 beyond.
    Gaussian {
        /// Standard deviation [pixels].
        stddev: f32,
    },
}

/// Filter names and how each reads its parameters.
pub const ROWS: &[crate::description::Row<Filter>] = &[
    crate::description::Row { name: "box", build: |_| Ok(Filter::Box) },
    crate::description::Row {
        name: "tent",
        build: |p| Ok(Filter::Tent { radius: positive(p, "radius", 1.0)? }),
    },
    crate::description::Row {
        name: "gaussian",
        build: |p| Ok(Filter::Gaussian { stddev: positive(p, "stddev", 0.5)? }),
    },
];

fn positive(params: &Params<'_>, name: &'static str, default: f64) -> Result<f32> {
    Ok(params.float_within(name, default, 1e-3, 1e3)? as f32)
}

impl Filter {
    /// Distance from its centre beyond which it is 0 [pixels].
    pub fn radius(&self) -> f32 {
        match self {
            Self::Box => 0.5,
            Self::Tent { radius } => *radius,
            Self::Gaussian { stddev } => 4.0 * stddev,
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
        }
    }

    /// A position distributed by the filter.
    #[inline]
    fn sample(&self, stream: &mut Stream) -> f32 {
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

    /// Integral of `value` from `low` to `high`.
    fn integral(&self, low: f64, high: f64) -> f64 {
        let radius = f64::from(self.radius());
        let (low, high) = (low.clamp(-radius, radius), high.clamp(-radius, radius));
        match self {
            Self::Box => high - low,
            Self::Tent { .. } => {
                let below = |x: f64| x - x * x.abs() / (2.0 * radius);
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
        }
    }
}

/// A filter along one axis of a film: near the ends it is cut off and normalised anew.
#[derive(Clone, Debug)]
pub struct Axis {
    filter: Filter,
    size: u32,
    /// 1 / integral over the film, per pixel.
    scales: Vec<f32>,
}

impl Axis {
    /// An axis of `size` pixels.
    pub fn new(filter: Filter, size: u32) -> Self {
        let scale = |i: u32| {
            let centre = f64::from(i) + 0.5;
            (1.0 / filter.integral(-centre, f64::from(size) - centre)) as f32
        };
        Self { filter, size, scales: (0..size).map(scale).collect() }
    }

    /// A position on the axis distributed by the filter of `pixel`.
    #[inline]
    pub fn sample(&self, pixel: usize, stream: &mut Stream) -> f32 {
        loop {
            let x = pixel as f32 + 0.5 + self.filter.sample(stream);
            if x >= 0.0 && x < self.size as f32 {
                break x;
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream::Purpose;

    const FILTERS: [Filter; 4] = [
        Filter::Box,
        Filter::Tent { radius: 1.0 },
        Filter::Tent { radius: 1.7 },
        Filter::Gaussian { stddev: 0.5 },
    ];

    /// Every pixel's weights integrate to one over the film, borders included.
    #[test]
    fn weights_are_normalised_on_the_film() {
        for filter in FILTERS {
            let (size, steps) = (5, 20_000);
            let axis = Axis::new(filter, size);
            let mut sums = vec![0.0; size as usize];
            for i in 0..steps * size {
                let x = (i as f32 + 0.5) / steps as f32;
                axis.weights(x).for_each(|(pixel, w)| sums[pixel] += f64::from(w) / f64::from(steps));
            }
            for sum in sums {
                assert!((sum - 1.0).abs() < 1e-3, "{filter:?}: {sum}");
            }
        }
    }

    /// Sampled positions follow the weights: mean and mean square agree with quadrature.
    #[test]
    fn samples_follow_the_weights() {
        for filter in FILTERS {
            for pixel in [0, 2] {
                let axis = Axis::new(filter, 5);
                let mut stream = Stream::new(7, pixel as u64, 0, Purpose::Study);
                let n = 400_000;
                let (mut first, mut second) = (0.0, 0.0);
                for _ in 0..n {
                    let x = f64::from(axis.sample(pixel, &mut stream));
                    first += x / f64::from(n);
                    second += x * x / f64::from(n);
                }
                let moment = |power: i32| {
                    (0..50_000)
                        .map(|i| (i as f32 + 0.5) * 1e-4)
                        .map(|x| {
                            let w = axis.weights(x).find(|(i, _)| *i == pixel).map_or(0.0, |(_, w)| w);
                            f64::from(w * x.powi(power)) * 1e-4
                        })
                        .sum::<f64>()
                };
                let deviation = (moment(2) - moment(1).powi(2)).sqrt();
                let z = (first - moment(1)) / (deviation / f64::from(n).sqrt());
                assert!(z.abs() < 4.5, "{filter:?} pixel {pixel}: z {z}");
                assert!((second / moment(2) - 1.0).abs() < 0.01, "{filter:?} pixel {pixel}");
            }
        }
    }
}
