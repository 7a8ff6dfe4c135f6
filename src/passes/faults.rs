//! Faults inside a render cost as little as possible, and are reported. A contribution that is not finite is left out;
//! a panic costs the pixel sample at hand.

use super::pass::Outcome;
use serde::{Deserialize, Serialize};
use std::{
    cell::Cell,
    fmt,
    panic::{AssertUnwindSafe, catch_unwind},
};

/// What went wrong.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub enum Cause {
    /// The strategy of `s` light and `t` camera vertices, the lens among these, contributed NaN or infinity.
    NotFinite {
        /// Light vertices.
        s: u32,
        /// Camera vertices.
        t: u32,
    },
    /// The code panicked, with this message.
    Panic(String),
}

/// Something that went wrong, and where.
#[derive(Clone, Debug, Deserialize, PartialEq, Eq, Serialize)]
pub struct Fault {
    /// What.
    pub cause: Cause,
    /// Number of the sample.
    pub sample: u64,
    /// The pixel (row-major index); none where a light subpath was at work.
    pub pixel: Option<u32>,
}

/// All that went wrong.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Eq, Serialize)]
pub struct Faults {
    /// How often.
    pub count: u64,
    /// The first ones.
    pub first: Vec<Fault>,
}

/// Number of faults that are described.
const DESCRIBED: usize = 8;

impl Faults {
    /// Adds some.
    pub fn add(&mut self, faults: &[Fault]) {
        self.count += faults.len() as u64;
        let room = DESCRIBED.saturating_sub(self.first.len());
        self.first.extend(faults.iter().take(room).cloned());
    }

    /// Adds those of others.
    pub fn merge(&mut self, other: &Self) {
        let count = self.count + other.count;
        self.add(&other.first);
        self.count = count;
    }
}

impl Fault {
    /// In words, for an image of `width` pixels across.
    pub fn describe(&self, width: usize) -> String {
        let place = match self.pixel {
            Some(pixel) => format!("pixel {} {}, ", pixel as usize % width, pixel as usize / width),
            None => "a light subpath, ".to_owned(),
        };
        format!("{place}sample {}: {}", self.sample, self.cause)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite { s, t } => {
                write!(f, "NaN or infinity by the strategy of {s} light and {t} camera vertices (left out)")
            }
            Self::Panic(message) => write!(f, "the program failed (\"{message}\"); the sample is left out"),
        }
    }
}

/// Pixels of a block that may fail before all of it is given up.
const MOST_FAILURES: usize = 64;

/// Runs `render` on a block. It gets the pixels to leave out, and reports the pixel that it is at. A pixel where it
/// panics is left out, and the others are rendered again. If a panic belongs to no pixel, the block adds nothing.
pub fn guarded(sample: usize, render: impl Fn(&[u32], &Cell<Option<u32>>) -> Outcome) -> Outcome {
    let (mut failed, mut faults) = (Vec::new(), Vec::new());
    loop {
        let at = Cell::new(None);
        let attempt = AssertUnwindSafe(|| render(&failed, &at));
        match catch_unwind(attempt) {
            Ok(mut outcome) => {
                outcome.faults.append(&mut faults);
                return outcome;
            }
            Err(panic) => {
                let message = panic.downcast_ref::<String>().map(String::as_str);
                let message = message.or_else(|| panic.downcast_ref::<&str>().copied());
                let cause = Cause::Panic(message.unwrap_or("no message").to_owned());
                faults.push(Fault { cause, sample: sample as u64, pixel: at.get() });
            }
        }
        match faults.last().and_then(|fault| fault.pixel) {
            Some(pixel) if failed.len() < MOST_FAILURES => failed.push(pixel),
            _ => return Outcome::of_faults(faults),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_costs_the_pixel_that_it_was_at() {
        let hook = std::panic::take_hook();
        std::panic::set_hook(Box::new(|_| {}));
        let outcome = |bad: &'static [u32]| {
            guarded(5, move |failed, at| {
                let wants = |pixel: &usize| !failed.contains(&(*pixel as u32));
                for pixel in (0..9).filter(wants) {
                    at.set(Some(pixel as u32));
                    assert!(!bad.contains(&(pixel as u32)), "bad {pixel}");
                }
                Outcome::of((0..9).filter(wants).map(|pixel| (pixel, 1.0)), std::iter::empty())
            })
        };
        let (whole, some) = (outcome(&[]), outcome(&[2, 7]));
        let all: &'static [u32] = Box::leak((0..9).collect::<Vec<_>>().into_boxed_slice());
        let none = outcome(all);
        let light = guarded(3, |_, _| panic!("light"));
        std::panic::set_hook(hook);
        assert_eq!((whole.pixels(), whole.faults.len()), (9, 0));
        assert_eq!((some.pixels(), none.pixels(), none.faults.len()), (7, 0, 9));
        assert_eq!(
            some.faults[1].describe(3),
            "pixel 1 2, sample 5: the program failed (\"bad 7\"); the sample is left out"
        );
        assert_eq!((light.faults.len(), light.faults[0].pixel), (1, None));
    }

    #[test]
    fn faults_are_counted_and_the_first_described() {
        let fault = Fault { cause: Cause::NotFinite { s: 1, t: 2 }, sample: 0, pixel: None };
        let (mut all, mut more) = (Faults::default(), Faults::default());
        all.add(&vec![fault.clone(); 5]);
        more.add(&vec![fault; 100]);
        all.merge(&more);
        assert_eq!((all.count, all.first.len()), (105, DESCRIBED));
    }
}
