//! The components of a sample, and how files write it.

use super::{Field, Sparse};
use crate::math::Vec3;
use half::f16;

/// How one number is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// 16 bits.
    Half,
    /// 32 bits.
    Float,
    /// 64 bits.
    Double,
}

impl Format {
    /// Length of a number (bytes).
    pub(super) fn size(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// The number number `index` of `bytes`, all of which are written like this; 0 beyond their end.
    fn number(self, bytes: &[u8], index: usize) -> f32 {
        match self {
            Self::Half => f16::from_le_bytes(array(bytes, 2 * index)).to_f32(),
            Self::Float => f32::from_le_bytes(array(bytes, 4 * index)),
            Self::Double => f64::from_le_bytes(array(bytes, 8 * index)) as f32,
        }
    }

    /// The value number `index` of `bytes`.
    pub(super) fn value<V: Value>(self, bytes: &[u8], index: usize) -> V {
        V::from_numbers(|channel| self.number(bytes, V::CHANNELS * index + channel))
    }
}

/// The `N` bytes of `bytes` from `at`; zeros beyond its end.
pub(super) fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    bytes.get(at..at + N).and_then(|slice| slice.try_into().ok()).unwrap_or([0; N])
}

/// What a sample may be.
pub trait Value: Copy + PartialEq + Send + Sync {
    /// Numbers to a value.
    const CHANNELS: usize;
    /// All numbers 0.
    const ZERO: Self;
    /// A value of the number of every channel.
    fn from_numbers(number: impl Fn(usize) -> f32) -> Self;
    /// All numbers with the other sign.
    fn negated(self) -> Self;
    /// The lesser number of every channel.
    fn least(self, other: Self) -> Self;
    /// The greater number of every channel.
    fn greatest(self, other: Self) -> Self;
    /// Samples of unknown type again.
    fn field(samples: Sparse<Self>) -> Field;
}

impl Value for f32 {
    const CHANNELS: usize = 1;
    const ZERO: Self = 0.0;

    fn from_numbers(number: impl Fn(usize) -> f32) -> Self {
        number(0)
    }

    fn negated(self) -> Self {
        -self
    }

    fn least(self, other: Self) -> Self {
        self.min(other)
    }

    fn greatest(self, other: Self) -> Self {
        self.max(other)
    }

    fn field(samples: Sparse<Self>) -> Field {
        Field::Grey(samples)
    }
}

impl Value for Vec3 {
    const CHANNELS: usize = 3;
    const ZERO: Self = Self::ZERO;

    fn from_numbers(number: impl Fn(usize) -> f32) -> Self {
        Self::new(number(0), number(1), number(2))
    }

    fn negated(self) -> Self {
        -self
    }

    fn least(self, other: Self) -> Self {
        self.min(other)
    }

    fn greatest(self, other: Self) -> Self {
        self.max(other)
    }

    fn field(samples: Sparse<Self>) -> Field {
        Field::Colour(samples)
    }
}
