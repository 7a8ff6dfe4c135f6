//! What lies beyond samples on the unit interval: Mitsuba's `wrap_mode`.

/// How samples beyond the first and the last of an axis are found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    /// The samples are a tile of an endless pattern.
    Repeat,
    /// So, but every other tile is mirrored.
    Mirror,
    /// The outermost sample goes on for ever.
    Clamp,
}

impl Wrap {
    /// As typed.
    pub const NAMES: [(&'static str, Self); 3] =
        [("repeat", Self::Repeat), ("mirror", Self::Mirror), ("clamp", Self::Clamp)];

    /// The index below `size` of the sample that represents `index`.
    #[inline]
    pub fn index(self, index: i64, size: usize) -> usize {
        let n = size as i64;
        let wrapped = match self {
            Self::Repeat => index.rem_euclid(n),
            Self::Clamp => index.clamp(0, n - 1),
            Self::Mirror => {
                let twice = index.rem_euclid(2 * n);
                twice.min(2 * n - 1 - twice)
            }
        };
        wrapped as usize
    }
}
