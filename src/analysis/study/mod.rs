//! Error against run time: contenders take turns at doubling budgets, against a reference (validation level 6).
//!
//! A `question` is what is to be found out, a `plan` how, after pilots; `run` carries out the plan, `unit` by
//! `unit`, and the `store` keeps what is done, so that a study that was stopped goes on; `summary` and
//! `table` report the results. Other renderers take part as `external` commands.

pub mod clock;
pub mod conditions;
pub mod contender;
pub mod external;
pub mod figure;
pub mod outcome;
pub mod page;
pub mod plan;
pub mod question;
pub mod reference;
pub mod run;
pub mod store;
pub mod summary;
pub mod table;
pub mod trust;
pub mod unit;
