//! Headings that `--help` groups options by.

/// What is written, and where.
pub(super) const OUTPUT: &str = "Output";
/// When a render ends, and what it may use.
pub(super) const BUDGET: &str = "Budget";
/// Checkpoints, and parts for other machines.
pub(super) const SHARE: &str = "Continue and share";
/// How pictures look.
pub(super) const LOOK: &str = "Look";
/// How paths are sampled.
pub(super) const METHOD: &str = "Method";
/// What those need who compare methods.
pub(super) const STUDIES: &str = "For studies";
