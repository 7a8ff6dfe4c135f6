//! Where the numbers of a stream come from.

use super::{Stream, stream::Purpose};

/// How the random numbers of an image's samples are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampler {
    /// Independent random numbers.
    Independent,
    /// The first numbers of every stream are the coordinates of a point of an Owen-scrambled Sobol sequence. Those of
    /// consecutive samples are spread evenly.
    #[default]
    Sobol,
}

impl Sampler {
    /// Name in scene files and on the command line.
    pub const NAMES: [(&'static str, Self); 2] = [("independent", Self::Independent), ("sobol", Self::Sobol)];

    /// Name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, sampler)| *sampler == self).map_or("", |(name, _)| name)
    }

    /// The stream of walk `walk`, of the `walks` that `index` has in pass `pass`, for `purpose`.
    ///
    /// Walks of one index are spread evenly together, those of even passes apart from those of odd passes. The two
    /// halves of an image are therefore independent, and their difference shows its error.
    #[inline]
    pub fn stream(self, seed: u64, index: u64, pass: u64, walk: u64, walks: u64, purpose: Purpose) -> Stream {
        match self {
            Self::Independent => Stream::new(seed, index * walks + walk, pass, purpose),
            Self::Sobol => Stream::sobol(seed, 2 * index + pass % 2, pass / 2 * walks + walk, purpose),
        }
    }
}
