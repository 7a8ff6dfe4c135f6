//! Instruments: what is measured about renders, and how it is told.

pub mod contender;
pub mod coverage;
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
pub mod store;
pub mod strategies;
pub mod summary;
pub mod table;
pub mod unit;
