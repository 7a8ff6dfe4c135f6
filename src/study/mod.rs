//! Instruments: what is measured about renders, and how it is told.

pub mod chi_square;
pub mod difference;
pub mod flights;
pub mod metrics;
pub mod outcome;
pub mod picture;
pub mod scatter;
