//! Instruments: what is measured about renders, and how it is told.

pub mod chi_square;
pub mod convergence;
pub mod coverage;
pub mod difference;
pub mod flights;
pub mod interval;
pub mod metrics;
pub mod outcome;
pub mod page;
pub mod picture;
pub mod pixel;
pub mod scatter;
pub mod strategies;
