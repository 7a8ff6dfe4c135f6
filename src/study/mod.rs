//! Instruments: what is measured about renders, and how it is told.

pub mod outcome;
pub mod page;
pub mod pixel;
pub mod strategies;
