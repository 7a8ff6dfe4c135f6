//! Which profile renders a scene, and why: what in the scene asks for its parts, or what forces it.

use crate::{
    passes::Settings,
    scene::build::Setup,
    transport::{
        needs::{Need, Needs, Reason},
        profiles::ProfileName,
    },
};
use serde_json::{Value, json};
use std::fmt;

/// A profile with its reasons.
pub(super) struct Fit {
    profile: ProfileName,
    /// What forces it, and the profile that would do; none where it is the scene.
    forced: Option<(String, ProfileName)>,
    asked: Vec<Asked>,
}

/// A need, the first that asks for it, and how many do.
struct Asked {
    need: Need,
    first: String,
    count: usize,
}

impl Fit {
    /// Of the profile of `settings`.
    pub(super) fn of(setup: &Setup, settings: &Settings) -> Self {
        let Settings { profile, options, .. } = *settings;
        let fitted = ProfileName::leanest(Needs::of(&setup.scene, options.hide_emitters));
        let why = if fitted.weighing(options.heuristic) == fitted {
            "forced by --profile".to_owned()
        } else {
            format!("for the {} heuristic", options.heuristic)
        };
        let forced = (profile != fitted).then_some((why, fitted));
        let asked = Need::ALL.into_iter().filter_map(|need| Asked::of(need, setup, options.hide_emitters));
        Self { profile, forced, asked: asked.collect() }
    }

    /// The same for scripts.
    pub(super) fn json(&self) -> Value {
        let asked = self.asked.iter();
        json!({
            "name": self.profile.name(),
            "forced": self.forced.as_ref().map(|(why, _)| why),
            "fitted": self.forced.as_ref().map_or(self.profile, |(_, fitted)| *fitted).name(),
            "needs": asked
                .map(|Asked { need, first, count }| json!({ "need": need.name(), "first": first, "count": count }))
                .collect::<Vec<_>>(),
            "leaves_out": self.left_out(),
        })
    }

    fn left_out(&self) -> Vec<&'static str> {
        self.profile.left_out().into_iter().map(Need::name).collect()
    }

    /// What asks, in words. That media have extinction goes without saying where they do more.
    fn reasons(&self) -> Vec<String> {
        let of_media = [Need::Heterogeneous, Need::Chromatic, Need::Emissive, Need::Flakes];
        let does_more = self.asked.iter().any(|asked| of_media.contains(&asked.need));
        let told = self.asked.iter().filter(|asked| asked.need != Need::Media || !does_more);
        told.map(Asked::to_string).collect()
    }
}

impl fmt::Display for Fit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.profile.name())?;
        if let Some((why, fitted)) = &self.forced {
            write!(f, ", {why}; fitted would be {}", fitted.name())?;
        }
        let (reasons, left_out) = (self.reasons(), self.left_out());
        if !reasons.is_empty() {
            write!(f, ": {}", reasons.join(", "))?;
        }
        let without = if left_out.is_empty() { "nothing".to_owned() } else { left_out.join(", ") };
        write!(f, "; leaves out {without}")
    }
}

impl Asked {
    /// None if nothing asks.
    fn of(need: Need, setup: &Setup, hide_emitters: bool) -> Option<Self> {
        let mut reasons = need.reasons(&setup.scene, hide_emitters);
        let first = named(setup, reasons.next()?);
        Some(Self { need, first, count: 1 + reasons.count() })
    }
}

impl fmt::Display for Asked {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [one, several] = match self.need {
            Need::Media => ["has extinction", "have extinction"],
            Need::Heterogeneous => ["varies in space", "vary in space"],
            Need::Chromatic => ["has chromatic extinction", "have chromatic extinction"],
            Need::Nulls => ["lets rays pass undeflected", "let rays pass undeflected"],
            Need::Infinite => ["has parallel rays", "have parallel rays"],
            Need::Emissive => ["emits light", "emit light"],
            Need::Flakes => ["has microflakes", "have microflakes"],
        };
        match self.count - 1 {
            0 => write!(f, "{} {one}", self.first),
            more => write!(f, "{} and {more} more {several}", self.first),
        }
    }
}

/// What asks, by its name.
fn named(setup: &Setup, reason: Reason) -> String {
    let shape = |index: u32| &setup.shape_names[index as usize];
    match reason {
        Reason::Medium(medium) => format!("the medium \"{}\"", setup.medium_name(medium)),
        Reason::Overlap => "the overlap of media".to_owned(),
        Reason::Shape(index) => format!("the shape \"{}\"", shape(index)),
        Reason::Hidden(index) => format!("the hidden emitter \"{}\"", shape(index)),
        Reason::Contradiction => "the contradiction of boundaries".to_owned(),
        Reason::Emitter(index) => format!("the emitter \"{}\"", setup.scene.lights.all[index].emitter.name),
        Reason::Sensor => "the sensor".to_owned(),
    }
}
