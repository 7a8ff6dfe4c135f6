//! Instruments: what is measured about renders, and how it is told.

pub mod chi_square;
pub mod contender;
pub mod coverage;
pub mod difference;
pub mod flights;
pub mod interval;
pub mod metrics;
pub mod outcome;
pub mod page;
pub mod picture;
pub mod pixel;
pub mod plan;
pub mod question;
pub mod reference;
pub mod run;
pub mod scatter;
pub mod store;
pub mod strategies;
pub mod summary;
pub mod table;
pub mod unit;
