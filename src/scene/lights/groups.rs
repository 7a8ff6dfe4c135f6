//! Groups of emitters, for images of what each contributes.

use super::{Lights, light::Light};

/// The group of the emitters that name none.
const REST: &str = "rest";

impl Lights {
    /// The group of `light`.
    pub fn group_of(light: &Light) -> &str {
        light.emitter.group.as_deref().unwrap_or(REST)
    }

    /// All groups that have an emitter, in file order; that of the emitters that name none last.
    pub fn groups(&self) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        for name in self.all.iter().map(Self::group_of) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names.sort_by_key(|name| *name == REST);
        names
    }
}
