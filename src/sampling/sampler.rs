//! Where the numbers of a stream come from.

use super::{Stream, stream::Purpose};

/// How the random numbers of an image's samples are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampler {
    /// Independent random numbers.
    #[default]
    Independent,
    /// The first of every stream are the coordinates of a point of an Owen-scrambled Sobol sequence: those of
    /// consecutive samples are spread evenly.
    Sobol,
}

impl Sampler {
    /// Name in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 2] = [("independent", Self::Independent), ("sobol", Self::Sobol)];

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, sampler)| *sampler == self).map_or("", |(name, _)| name)
    }

    /// The stream of (`seed`, `index`, `sample`, `purpose`). Samples of one index are spread evenly together.
    #[inline]
    pub fn stream(self, seed: u64, index: u64, sample: u64, purpose: Purpose) -> Stream {
        match self {
            Self::Independent => Stream::new(seed, index, sample, purpose),
            Self::Sobol => Stream::sobol(seed, index, sample, purpose),
        }
    }
}
