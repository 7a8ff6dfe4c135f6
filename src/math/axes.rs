//! One value an axis.

/// `[f(0), f(1), f(2)]`. The standard library's ways to make and map arrays are compiled once for each half of the crate
/// and called across; this one is inlined.
#[inline(always)]
pub fn axes<T>(mut f: impl FnMut(usize) -> T) -> [T; 3] {
    [f(0), f(1), f(2)]
}
