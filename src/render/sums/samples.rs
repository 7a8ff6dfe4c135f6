//! Which samples an image has: a set of their numbers.

use std::ops::Range;

/// Sample numbers, as ranges in growing order that neither overlap nor touch.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Samples(Vec<Range<u64>>);

impl Samples {
    /// Those of `ranges`; none if some are empty or overlap.
    pub fn of(mut ranges: Vec<Range<u64>>) -> Option<Self> {
        ranges.sort_by_key(|range| range.start);
        let mut samples = Self::default();
        ranges.into_iter().try_for_each(|range| samples.push(range))?;
        Some(samples)
    }

    /// Adds a range behind all others.
    fn push(&mut self, range: Range<u64>) -> Option<()> {
        match self.0.last_mut() {
            _ if range.is_empty() => return None,
            Some(last) if last.end > range.start => return None,
            Some(last) if last.end == range.start => last.end = range.end,
            _ => self.0.push(range),
        }
        Some(())
    }

    /// These and `other`; none if they share some.
    pub fn and(&self, other: &Self) -> Option<Self> {
        Self::of(self.0.iter().chain(&other.0).cloned().collect())
    }

    /// Adds the sample `number`, which is none of them.
    pub fn insert(&mut self, number: u64) {
        match self.0.last_mut() {
            Some(last) if last.end == number => last.end += 1,
            _ => *self = self.and(&Self::from(number..number + 1)).unwrap_or_default(),
        }
    }

    /// How many.
    pub fn count(&self) -> u64 {
        self.0.iter().map(|range| range.end - range.start).sum()
    }

    /// How many of even and of odd number.
    pub fn halves(&self) -> [u64; 2] {
        let odd = self.0.iter().map(|range| range.end / 2 - range.start / 2).sum();
        [self.count() - odd, odd]
    }

    /// The ranges.
    pub fn ranges(&self) -> &[Range<u64>] {
        &self.0
    }

    /// The missing number of this `index` (from 0) among those from `first` on.
    pub fn missing(&self, first: u64, index: u64) -> u64 {
        let mut number = first + index;
        for range in self.0.iter().filter(|range| range.end > first) {
            if range.start <= number {
                number += range.end - range.start.max(first);
            }
        }
        number
    }

    /// How many of `wanted` are missing.
    pub fn missing_of(&self, wanted: &Range<u64>) -> u64 {
        let shared =
            |range: &Range<u64>| range.end.min(wanted.end).saturating_sub(range.start.max(wanted.start));
        (wanted.end - wanted.start) - self.0.iter().map(shared).sum::<u64>()
    }
}

impl From<Range<u64>> for Samples {
    fn from(range: Range<u64>) -> Self {
        let mut samples = Self::default();
        let _ = samples.push(range);
        samples
    }
}

impl std::fmt::Display for Samples {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let ranges: Vec<String> =
            self.0.iter().map(|range| format!("{}..{}", range.start, range.end)).collect();
        f.write_str(if ranges.is_empty() { "none" } else { "" })?;
        f.write_str(&ranges.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_join_and_refuse_what_they_share() {
        let samples = Samples::of(vec![8..9, 0..3, 3..5]).unwrap();
        assert_eq!((samples.ranges(), samples.count()), (&[0..5, 8..9][..], 6));
        assert_eq!(samples.to_string(), "0..5, 8..9");
        assert_eq!((samples.halves(), Samples::from(3..8).halves()), ([4, 2], [2, 3]));
        assert_eq!(samples.and(&Samples::from(4..6)), None);
        assert_eq!(samples.and(&Samples::from(5..8)).unwrap(), Samples::from(0..9));
        assert!(Samples::of(vec![1..2, 3..3]).is_none() && Samples::from(3..3).to_string() == "none");
    }

    /// Against a list of all numbers.
    #[test]
    fn what_is_missing() {
        let samples = Samples::of(vec![2..4, 5..6, 9..12]).unwrap();
        for first in 0..14 {
            let missing: Vec<u64> =
                (first..40).filter(|n| !samples.ranges().iter().any(|r| r.contains(n))).collect();
            let found: Vec<u64> =
                (0..missing.len() as u64).map(|index| samples.missing(first, index)).collect();
            assert_eq!(found, missing, "{first}");
            assert_eq!(samples.missing_of(&(first..40)), missing.len() as u64, "{first}");
        }
        let mut grown = samples.clone();
        (0..12).filter(|n| !samples.ranges().iter().any(|r| r.contains(n))).for_each(|n| grown.insert(n));
        assert_eq!(grown, Samples::from(0..12));
    }
}
