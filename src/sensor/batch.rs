//! `batch`: what may be given to it. It is no sensor of its own; the scene takes it for those in it.

use crate::description::{Table, table};

/// The name of the plugin.
pub const BATCH: &str = "batch";

/// What may be given to it.
pub const BATCH_TABLE: Table = table! {
    "Several cameras. `--sensor` chooses one of them, `--sensor all` renders each into a file of its own.";
    nested("sensor", Required, "The cameras. Their own films and samplers are ignored."),
    nested("film", Optional, "The image: each camera has an equal part of its width."),
    nested("sampler", Optional, "The number of samples per pixel."),
};
