//! When a study was made, and what else its machine did: written down as it goes, so that it holds for one that was stopped.

use super::{outcome::Conditions, store::Store};
use crate::error::Result;
use jiff::Timestamp;
use sysinfo::System;

/// Beside the runs.
const FILE: &str = "runs/conditions.json";

impl Conditions {
    /// Of a study that begins now.
    fn now() -> Self {
        let started = Timestamp::now().strftime("%Y-%m-%d %H:%M UTC").to_string();
        Self { started, load_before: load(), load_after: None }
    }

    /// In a sentence or two.
    pub fn sentence(&self) -> String {
        let Self { started, load_before, load_after } = self;
        let shown = |load: &[f64; 3]| load.map(|mean| format!("{mean:.2}")).join(", ");
        let after = "after the last, the study's own threads among them";
        let loads = [(load_before, "before the first render"), (load_after, after)];
        let loads = loads.iter().filter_map(|(load, when)| Some(format!("{} {when}", shown(load.as_ref()?))));
        let loads: Vec<String> = loads.collect();
        match loads.is_empty() {
            true => format!("{started}."),
            false => format!("{started}. Load average over 1, 5 and 15 minutes: {}.", loads.join("; ")),
        }
    }
}

/// What is known of the study in `store`; of one that begins, what there is to know now.
pub fn open(store: &Store) -> Result<Conditions> {
    match store.has(FILE) {
        true => store.read_json(FILE, "remove the file, or restart the whole study with --restart"),
        false => {
            let conditions = Conditions::now();
            store.write_json(FILE, &conditions)?;
            Ok(conditions)
        }
    }
}

/// Another render is done.
pub fn note(store: &Store, conditions: &mut Conditions) -> Result<()> {
    conditions.load_after = load();
    store.write_json(FILE, conditions)
}

/// Processes that ran or waited to run, over the last 1, 5 and 15 minutes; none where the system does not say.
fn load() -> Option<[f64; 3]> {
    let load = cfg!(unix).then(System::load_average)?;
    Some([load.one, load.five, load.fifteen])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_not_said() {
        let silent = Conditions { started: "then".into(), load_before: None, load_after: None };
        assert_eq!(silent.sentence(), "then.");
        let loaded = Conditions { load_before: Some([0.5, 1.0, 2.0]), ..silent };
        assert!(loaded.sentence().contains("0.50, 1.00, 2.00 before"), "{}", loaded.sentence());
    }
}
