//! `noise`: turbulence, max(0, bias + amplitude s), s being a mean of octaves of Perlin's gradient noise.
//!
//! Octave i has `frequency` lacunarity^i (in cells per metre) and the weight gain^i. The `style` `turbulence` takes
//! absolute values, so that s is from 0 to 1 with creases; with `fractal` it is from -1 to 1 and smooth. Where the sum
//! is below 0 the value is 0, which makes clouds with clear air between them. The same `seed` gives the same noise
//! everywhere.
//!
//! There is no closed form along a line.

use super::{
    perlin::Perlin,
    placed::{COMMON, Function, Line, Placed},
};
use crate::{
    description::{Params, Table, table},
    error::Result,
    math::DVec3,
};
use std::sync::Arc;

/// Turbulence.
pub type Noise = Placed<Turbulence>;

/// The function itself.
#[derive(Clone, Debug)]
pub struct Turbulence {
    bias: f64,
    amplitude: f64,
    /// Octaves are taken as absolute values.
    creases: bool,
    octaves: Arc<[Octave]>,
}

#[derive(Debug)]
struct Octave {
    noise: Perlin,
    frequency: f64,
    /// All sum to 1.
    weight: f64,
    /// (cells) All octaves are 0 at the corners of their cells; those must not fall together.
    shift: DVec3,
}

impl Octave {
    #[inline]
    fn at(&self, position: DVec3) -> f64 {
        self.noise.at(position * self.frequency + self.shift)
    }

    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        self.noise.range(low * self.frequency + self.shift, high * self.frequency + self.shift)
    }
}

impl Turbulence {
    fn new(
        [bias, amplitude]: [f64; 2],
        creases: bool,
        frequencies: &[f64],
        weights: &[f64],
        seed: u32,
    ) -> Self {
        let total: f64 = weights.iter().sum();
        let octave = |(i, (frequency, weight)): (u32, (&f64, &f64))| Octave {
            noise: Perlin::new(seed.wrapping_add(i)),
            frequency: *frequency,
            weight: weight / total,
            // Multiples of irrational numbers (the plastic number's powers) never meet.
            shift: DVec3::new(0.819_172_5, 0.671_043_6, 0.549_700_5) * f64::from(i + 1) % 1.0,
        };
        let octaves = (0..).zip(frequencies.iter().zip(weights)).map(octave).collect();
        Self { bias, amplitude, creases, octaves }
    }

    fn value(&self, mean: f64) -> f64 {
        (self.bias + self.amplitude * mean).max(0.0)
    }
}

impl Function for Turbulence {
    const TABLE: Table = table! {
        "Turbulence: max(0, bias + amplitude s), where s is a weighted mean of octaves of Perlin noise.";
        number("frequency", "cells/m", above(0.0, 1e30), Is(1.0), "Frequency of the first octave."),
        integer("octaves", within(1.0, 16.0), Is(4.0), "Number of octaves."),
        number("lacunarity", "", within(0.0, 100.0), Is(2.0), "Frequency ratio of successive octaves."),
        number("gain", "", within(0.0, 100.0), Is(0.5), "Weight ratio of successive octaves."),
        choice("style", &["turbulence", "fractal"], "turbulence",
            "`turbulence`: absolute values, with creases, s from 0 to 1. `fractal`: smooth, s from -1 to 1."),
        number("amplitude", "", within(-1e30, 1e30), Is(1.0), "Scales s."),
        number("bias", "", within(-1e30, 1e30), Is(0.0), "Added to it; negative values leave clear air between clouds."),
        integer("seed", within(0.0, u32::MAX as f64), Is(0.0), "Seed of the noise.");
        COMMON
    };

    fn read(params: &Params<'_>) -> Result<Self> {
        let count = params.integer("octaves")? as i32;
        let frequency = params.float("frequency")?;
        let lacunarity = params.float("lacunarity")?;
        let gain = params.float("gain")?;
        let seed = params.integer("seed")? as u32;
        let creases = params.choice("style", &[("turbulence", true), ("fractal", false)])?;
        let [frequencies, weights] = [(frequency, lacunarity), (1.0, gain)]
            .map(|(first, ratio)| (0..count).map(|i| first * ratio.powi(i)).collect::<Vec<_>>());
        let levels = [params.float("bias")?, params.float("amplitude")?];
        Ok(Self::new(levels, creases, &frequencies, &weights, seed))
    }

    fn eval(&self, position: DVec3) -> f64 {
        let octave = |octave: &Octave| {
            let noise = octave.at(position);
            octave.weight * if self.creases { noise.abs() } else { noise }
        };
        self.value(self.octaves.iter().map(octave).sum())
    }

    /// The sum of the octaves' bounds.
    fn range(&self, low: DVec3, high: DVec3) -> [f64; 2] {
        let mut mean = [0.0; 2];
        for octave in self.octaves.iter() {
            let [mut least, mut most] = octave.range(low, high);
            if self.creases {
                (least, most) = (least.max(-most).max(0.0), most.max(-least));
            }
            mean = [mean[0] + octave.weight * least, mean[1] + octave.weight * most];
        }
        let (a, b) = (self.value(mean[0] - 1e-12), self.value(mean[1] + 1e-12));
        let (c, d) = (self.value(mean[0] + 1e-12), self.value(mean[1] - 1e-12));
        [a.min(b).min(c).min(d), a.max(b).max(c).max(d)]
    }

    fn has_integral(&self) -> bool {
        false
    }

    /// Never called: there is none.
    fn integral(&self, _: &Line, _: f64, _: f64) -> f64 {
        0.0
    }

    #[cfg(test)]
    fn examples() -> Vec<Self> {
        let halves = [1.0, 0.5, 0.25, 0.125];
        vec![
            Self::new([0.0, 1.0], true, &[1.0, 2.0, 4.0, 8.0], &halves, 0),
            Self::new([0.2, 1.5], false, &[0.3, 0.6, 1.2, 2.4], &halves, 7),
            Self::new([0.8, -1.5], true, &[0.1], &[1.0], u32::MAX),
            Self::new([0.1, 1.0], false, &[1e6, 1e9], &[1.0, 0.0], 3),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The same on every machine and for every release: what the crate gave when this was written.
    #[test]
    fn the_seed_decides() {
        let make = |seed| Turbulence::new([0.0, 1.0], false, &[1.0, 2.0], &[1.0, 0.5], seed);
        let at = DVec3::new(0.3, -7.2, 1e5 + 0.7);
        assert_ne!(make(0).eval(at), make(1).eval(at));
        assert_eq!(make(5).eval(at), make(5).eval(at));
    }
}
