//! Plugins that go where shapes go but are none of their own: the scene composes them of others.

use super::smoke::{SMOKE, SMOKE_TABLE};
use crate::description::{Plugin, Registry, Table, table};

/// How the scene reads one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Composed {
    /// A volume file with a container.
    Smoke,
    /// Shapes that are seen where instances of them are.
    Group,
    /// One place of a group.
    Instance,
    /// Shapes, as if each stood in the scene.
    Merge,
}

/// All of them.
pub const COMPOSED: Registry<Plugin<Composed>> = Registry::new(
    "a shape",
    &[
        (SMOKE, Plugin { table: SMOKE_TABLE, build: Composed::Smoke }),
        ("shapegroup", Plugin { table: GROUP, build: Composed::Group }),
        ("instance", Plugin { table: INSTANCE, build: Composed::Instance }),
        ("merge", Plugin { table: MERGE, build: Composed::Merge }),
    ],
);

const GROUP: Table = table! {
    "Shapes for `instance` to put into the scene, as often as wanted. They are not seen by themselves.";
    nested("shape", Required, "The shapes. In Tyndall they may emit, bound media and be instances."),
};

const INSTANCE: Table = table! {
    "The shapes of a `shapegroup` in one more place. Large meshes need memory once, however many instances there are.";
    transform("to_world", "Position, orientation and size; it follows the shapes' own."),
    nested("shape", Required, "The `shapegroup`."),
};

const MERGE: Table = table! {
    "Several shapes, rendered as if each stood in the scene itself.";
    nested("shape", Required, "The shapes."),
};
