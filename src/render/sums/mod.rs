//! What a render knows, whichever way it goes.

mod batches;
pub mod file;
mod half;
pub mod halves;
pub mod passes;
pub mod samples;
pub mod tiles;

pub use halves::Halves;
pub use passes::Sums;

use super::image::{Image, Precision};
use crate::film::{Film, layer::Layer};
use file::Stored;
use samples::Samples;

/// What a render can show before it ends.
pub trait Picture {
    /// The image so far, without alpha and layers.
    fn image(&self) -> Image;
    /// Pixels across and down.
    fn size(&self) -> (usize, usize);
}

/// The state of a render, from which it can resume.
pub trait Kept: Picture {
    /// Samples of pixels; in a render to a precision some pixels have fewer.
    fn samples(&self) -> Samples;
    /// What a file of it holds.
    fn store(&self) -> Stored;
}

/// The state of a render of either kind.
#[derive(Clone, Debug)]
#[expect(clippy::large_enum_variant, reason = "a render has one, whose arrays are far larger")]
pub enum AnySums {
    /// By samples or time.
    Samples(Sums),
    /// To a precision.
    Adaptive(Halves),
}

impl AnySums {
    /// Nothing yet of `film` and `layers`.
    pub fn new(film: &Film, layers: &[Layer], precision: Option<Precision>) -> Self {
        let sorted = layers.iter().filter(|layer| layer.is_sorted()).count();
        match precision {
            Some(precision) => Self::Adaptive(Halves::new(film, precision, sorted)),
            None => {
                let with_products = layers.iter().any(Layer::needs_squares);
                Self::Samples(Sums::new(film, with_products, sorted))
            }
        }
    }

    /// What is known, of whichever kind.
    pub fn kept(&self) -> &dyn Kept {
        match self {
            Self::Samples(sums) => sums,
            Self::Adaptive(halves) => halves,
        }
    }
}
