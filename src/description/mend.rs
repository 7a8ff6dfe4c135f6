//! Numbers of files that are a hair out of range, as resampling, half precision and colour spaces leave them: how they
//! are mended, and what the user is told, for every kind of file.
//!
//! Densities, colours and light are finite and at least 0; shares of light are at most 1. Numbers below become 0,
//! numbers above the limit become the limit, and infinite ones the greatest finite number of the file. A file is
//! refused where that would change its meaning: where a number is NaN, or where more than one in a hundred of its
//! non-zero numbers would change by more than a fifth of the greatest. The rings of a cubic interpolation stay below
//! that; a velocity taken for a density does not.

use super::Library;
use crate::error::{Error, Result};
use std::path::Path;

/// The share of non-zero numbers that may change grossly.
const SHARE: f64 = 0.01;

/// A change is gross above this part of the greatest finite number, whatever its sign.
const GROSS: f32 = 0.2;

/// Relative excess over the limit that is taken for rounding.
const ROUNDING: f32 = 1e-6;

/// A number of a file.
#[derive(Clone, Copy, Debug)]
pub struct Number {
    /// The number itself.
    pub value: f32,
    /// Its voxel, or its pixel's column and row.
    pub at: [usize; 3],
    /// Its channel.
    pub channel: usize,
    /// So many numbers of the file are this one.
    pub count: u64,
}

/// What the numbers of a file are like.
#[derive(Clone, Copy, Debug)]
pub struct Survey {
    most: f32,
    /// How many are not 0, NaN among them.
    counted: u64,
    /// How many are out of range.
    wrong: u64,
    /// The greatest finite number, and the greatest without its sign.
    greatest: [f32; 2],
    /// The number that is farthest out of range.
    worst: Option<Number>,
}

impl Survey {
    /// Of all that `numbers` shows its argument; 0 to `most` is valid.
    pub fn of(numbers: impl Fn(&mut dyn FnMut(Number)), most: f32) -> Self {
        let mut survey = Self { most, counted: 0, wrong: 0, greatest: [0.0; 2], worst: None };
        numbers(&mut |number| survey.add(number));
        survey
    }

    fn add(&mut self, number: Number) {
        let Number { value, count, .. } = number;
        self.counted += if value == 0.0 { 0 } else { count };
        if value.is_finite() {
            self.greatest = [self.greatest[0].max(value), self.greatest[1].max(value.abs())];
        }
        let excess = self.excess(value);
        if excess > 0.0 {
            self.wrong += count;
            // Of several, the one with the least index: sparse files are read in any order.
            let before = |worst: Number| {
                excess.total_cmp(&self.excess(worst.value)).then(worst.at.cmp(&number.at)).is_gt()
            };
            if self.worst.is_none_or(before) {
                self.worst = Some(number);
            }
        }
    }

    /// How far a number is out of range: infinitely far if it is infinite, and all the more if it is NaN.
    fn excess(&self, value: f32) -> f64 {
        match value {
            _ if value.is_nan() => f64::INFINITY,
            f32::INFINITY => f64::MAX,
            _ if value < 0.0 => (-f64::from(value)).min(f64::MAX),
            _ if value > self.most * (1.0 + ROUNDING) => f64::from(value) - f64::from(self.most),
            _ => 0.0,
        }
    }

    /// True if all numbers are 0.
    pub fn is_nothing(&self) -> bool {
        self.counted == 0
    }

    /// The greatest finite number, at least 0.
    pub fn greatest(&self) -> f32 {
        self.greatest[0]
    }

    fn mend(&self) -> Mend {
        Mend { most: self.most, greatest: self.greatest[0].min(self.most) }
    }

    /// True if mending would change the meaning of the numbers.
    fn is_else(&self, numbers: impl Fn(&mut dyn FnMut(Number))) -> bool {
        let (mend, gross, mut count) = (self.mend(), GROSS * self.greatest[1], 0);
        let is_gross = |value: f32| value.is_infinite() || (mend.of(value) - value).abs() > gross;
        numbers(&mut |number| count += if is_gross(number.value) { number.count } else { 0 });
        self.worst.is_some_and(|worst| worst.value.is_nan()) || count as f64 > SHARE * self.counted as f64
    }
}

/// What becomes of numbers that are out of range.
#[derive(Clone, Copy, Debug)]
pub struct Mend {
    most: f32,
    greatest: f32,
}

impl Mend {
    /// What becomes of `value`; NaN stays that.
    #[inline]
    pub fn of(self, value: f32) -> f32 {
        match value {
            f32::INFINITY => self.greatest,
            _ if value < 0.0 => 0.0,
            _ if value > self.most => self.most,
            _ => value,
        }
    }
}

/// A file, or what is meant of it.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The file.
    pub path: &'a Path,
    /// The name of what is meant, among several; else empty.
    pub part: &'a str,
    /// What its numbers are of.
    pub what: &'a str,
    /// Where in it a number is.
    pub place: fn(&Number) -> String,
    /// What to do where it is refused.
    pub remedy: &'a str,
}

impl Source<'_> {
    /// How to mend `numbers`, valid from 0 to `most`; none if all of them are. The user is told once.
    pub fn mend(
        &self,
        numbers: impl Fn(&mut dyn FnMut(Number)) + Copy,
        most: f32,
        library: &Library,
    ) -> Result<Option<Mend>> {
        let survey = Survey::of(numbers, most);
        let Some(worst) = survey.worst else { return Ok(None) };
        if survey.is_else(numbers) {
            return Err(self.refused(&survey, &worst, self.remedy));
        }
        if library.is_strict {
            let remedy = "leave out --strict to have this mended, or correct the file";
            return Err(self.refused(&survey, &worst, remedy));
        }
        let (value, becomes) = (worst.value, survey.mend().of(worst.value));
        let (part, several) = (self.part, if survey.wrong == 1 { "is" } else { "are" });
        let of = if part.is_empty() { String::new() } else { format!(" of \"{part}\"") };
        let count = counted(survey.wrong, "value");
        let text = format!(
            "{count}{of} {several} out of range and changed: the worst, {value:?}, becomes {becomes:?}"
        );
        library.note(self.path, &text);
        Ok(Some(survey.mend()))
    }

    fn refused(&self, survey: &Survey, worst: &Number, remedy: &str) -> Error {
        let range =
            if survey.most.is_finite() { format!("from 0 to {}", survey.most) } else { ">= 0".into() };
        let others = match survey.wrong - 1 {
            0 => String::new(),
            others => format!(", and {} out of range", counted(others, "other value")),
        };
        let found = format!("{:?} in {}{others}", worst.value, (self.place)(worst));
        let expected = format!("{} that are finite numbers {range}", self.what);
        Error::new(self.path.display(), expected, found, remedy)
    }
}

/// `1 value`, `2 values`.
fn counted(count: u64, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

#[cfg(test)]
mod tests;
