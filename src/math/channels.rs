//! Quantities per extinction channel: one channel in grey scenes, three in chromatic ones. The balance heuristic
//! sums over channels; a grey scene pays nothing for that.

use super::{Spectrum, vec3};
use std::ops::{Add, Mul};

/// One value per channel whose extinction can differ.
pub trait Channels:
    Copy + Send + Sync + Add<Output = Self> + Mul<Output = Self> + std::fmt::Debug + 'static
{
    /// How many there are; each is hero equally often.
    const COUNT: usize;
    /// The same value in every channel.
    fn splat(value: f32) -> Self;
    /// The channels of a colour (the first one where there is one channel).
    fn from_spectrum(spectrum: Spectrum) -> Self;
    /// What `channel` gives for the index of every channel.
    fn from_fn(channel: impl Fn(usize) -> f32) -> Self;
    /// Back to a colour.
    fn to_spectrum(self) -> Spectrum;
    /// The channel by which distances are sampled.
    fn hero(self, hero: usize) -> f32;
    /// Every channel times `factor`.
    fn scaled(self, factor: f32) -> Self;
    /// exp(-x) of every channel.
    fn exp_neg(self) -> Self;
    /// Ratio of the flight densities of every channel to the hero's, for optical depths `self` and the
    /// extinction coefficients `sigma_t` at the end of the flight: exp(-(tau_c - tau_h)) sigma_c / sigma_h.
    /// From the difference of depths, so that it exists where the transmittances underflow.
    fn flight_ratio(self, sigma_t: Self, hero: usize) -> Self;
    /// Every channel, but no more than `most`.
    fn at_most(self, most: f32) -> Self;
    /// Sum over channels.
    fn sum(self) -> f32;
}

impl Channels for f32 {
    const COUNT: usize = 1;
    #[inline]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline]
    fn from_spectrum(spectrum: Spectrum) -> Self {
        spectrum.x
    }
    #[inline]
    fn from_fn(channel: impl Fn(usize) -> f32) -> Self {
        channel(0)
    }
    #[inline]
    fn to_spectrum(self) -> Spectrum {
        Spectrum::splat(self)
    }
    #[inline]
    fn hero(self, _: usize) -> f32 {
        self
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        self * factor
    }
    #[inline]
    fn exp_neg(self) -> Self {
        (-self).exp()
    }
    #[inline]
    fn flight_ratio(self, _: Self, _: usize) -> Self {
        1.0
    }
    #[inline]
    fn at_most(self, most: f32) -> Self {
        self.min(most)
    }
    #[inline]
    fn sum(self) -> f32 {
        self
    }
}

impl Channels for Spectrum {
    const COUNT: usize = 3;
    #[inline]
    fn splat(value: f32) -> Self {
        Spectrum::splat(value)
    }
    #[inline]
    fn from_spectrum(spectrum: Spectrum) -> Self {
        spectrum
    }
    #[inline]
    fn from_fn(channel: impl Fn(usize) -> f32) -> Self {
        vec3(channel(0), channel(1), channel(2))
    }
    #[inline]
    fn to_spectrum(self) -> Spectrum {
        self
    }
    #[inline]
    fn hero(self, hero: usize) -> f32 {
        self[hero]
    }
    #[inline]
    fn scaled(self, factor: f32) -> Self {
        self * factor
    }
    #[inline]
    fn exp_neg(self) -> Self {
        vec3((-self.x).exp(), (-self.y).exp(), (-self.z).exp())
    }
    #[inline]
    fn flight_ratio(self, sigma_t: Self, hero: usize) -> Self {
        let channel = |c: usize| {
            if c == hero { 1.0 } else { (self[hero] - self[c]).exp() * (sigma_t[c] / sigma_t[hero]) }
        };
        vec3(channel(0), channel(1), channel(2))
    }
    #[inline]
    fn at_most(self, most: f32) -> Self {
        self.min(Self::splat(most))
    }
    #[inline]
    fn sum(self) -> f32 {
        self.x + self.y + self.z
    }
}
