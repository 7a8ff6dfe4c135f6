//! Headings that `--help` groups options by.

/// What is written, and where.
pub const OUTPUT: &str = "Output";
/// When a render ends, and what it may use.
pub const BUDGET: &str = "Budget";
/// Checkpoints, and parts for other machines.
pub const SHARE: &str = "Continue and share";
/// How pictures look.
pub const LOOK: &str = "Look";
/// How paths are sampled.
pub const METHOD: &str = "Method";
/// What those need who compare methods.
pub const STUDIES: &str = "For studies";
