//! When a study was made, and what else its machine did: written down as it goes, so that it holds for one that was stopped.

use super::{outcome::Conditions, store::Store};
use crate::error::Result;
use std::time::{SystemTime, UNIX_EPOCH};
use sysinfo::System;

/// Beside the runs.
const FILE: &str = "runs/conditions.json";

impl Conditions {
    /// Of a study that begins now.
    fn now() -> Self {
        let since = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        Self { started: utc(since.as_secs()), load_before: load(), load_after: None }
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

/// Days of 400 years, after which dates repeat.
const ERA: u64 = 146_097;

/// Date and time of day, so many `seconds` after 1970 began: 2026-11-27 13:20 UTC.
fn utc(seconds: u64) -> String {
    let is_leap =
        |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let (mut year, mut day) = (1970 + seconds / 86_400 / ERA * 400, seconds / 86_400 % ERA);
    let days_of = |year| if is_leap(year) { 366 } else { 365 };
    while day >= days_of(year) {
        day -= days_of(year);
        year += 1;
    }
    let february = days_of(year) - 337;
    let months = [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 0;
    while day >= months[month] {
        day -= months[month];
        month += 1;
    }
    let (hour, minute) = (seconds / 3600 % 24, seconds / 60 % 60);
    format!("{year}-{:02}-{:02} {hour:02}:{minute:02} UTC", month + 1, day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, date) in [
            (0, "1970-01-01 00:00 UTC"),
            (951_782_399, "2000-02-28 23:59 UTC"),
            (951_782_400, "2000-02-29 00:00 UTC"),
            (1_795_785_599, "2026-11-27 13:19 UTC"),
            (1_798_761_599, "2026-12-31 23:59 UTC"),
            (4_107_542_400, "2100-03-01 00:00 UTC"),
            (12_622_780_800, "2370-01-01 00:00 UTC"),
        ] {
            assert_eq!(utc(seconds), date, "{seconds}");
        }
        assert!(utc(u64::MAX).ends_with("UTC"));
    }

    #[test]
    fn what_is_not_known_is_not_said() {
        let silent = Conditions { started: "then".into(), load_before: None, load_after: None };
        assert_eq!(silent.sentence(), "then.");
        let loaded = Conditions { load_before: Some([0.5, 1.0, 2.0]), ..silent };
        assert!(loaded.sentence().contains("0.50, 1.00, 2.00 before"), "{}", loaded.sentence());
    }
}
