//! Motion blur: when the shutter is open, and at what time each pass over the image sees the scene.
//!
//! All camera and light subpaths of a pass live at one time, so that every connection between them is one of a scene that
//! stands still. The times of passes are a sequence of the golden ratio, from a random first one: any number of them in a
//! row, from any pass on, is spread evenly, each alone is uniform, and they have nothing to do with the base-2 points of
//! low-discrepancy samplers, which count passes too.

use super::{
    batch,
    build::{self, Setup},
    keyframes, sensors,
};
use crate::{
    description::{Object, Params, Value},
    error::{Error, Result},
    sampling::{Stream, stream::Purpose},
    sensor::SHUTTER,
    volume::WIND,
};

/// When a camera's shutter opens and closes, after the scene's time (s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shutter {
    opens: f64,
    closes: f64,
}

/// 1 over the golden ratio: its multiples, modulo 1, lie as evenly as those of any number.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Shutter {
    /// That of the camera of `root`, which is the first sensor.
    pub fn of(root: &Object) -> Result<Self> {
        let root = batch::expand(root)?;
        let camera = sensors::sensors(&root).next();
        let [opens, closes] = SHUTTER.map(|name| camera.and_then(|camera| camera.number(name)));
        let opens = opens.unwrap_or(0.0);
        Ok(Self { opens, closes: closes.unwrap_or(0.0).max(opens) })
    }

    /// True if it is open no longer than an instant.
    pub fn is_instant(self) -> bool {
        self.opens == self.closes
    }

    /// Halfway between the two (s).
    pub(super) fn middle(self) -> f64 {
        0.5 * (self.opens + self.closes)
    }

    /// When a `pass` of renders with `seed` sees the scene (s).
    fn moment(self, seed: u64, pass: u64) -> f64 {
        let first = Stream::new(seed, 0, 0, Purpose::Shutter).uniform_precisely();
        self.opens + (self.closes - self.opens) * (first + pass as f64 * GOLDEN).fract()
    }
}

/// A scene that moves while the shutter is open.
#[derive(Clone, Debug)]
pub(super) struct Moving {
    /// Its description, at all times.
    pub root: Object,
    pub shutter: Shutter,
}

/// A shutter that closes before it opens is an error.
pub(super) fn check(camera: &Params<'_>) -> Result<()> {
    let [opens, closes] = [camera.float(SHUTTER[0])?, camera.float(SHUTTER[1])?];
    if closes < opens {
        let expected = format!("a time not before \"{}\", {opens} s", SHUTTER[0]);
        return Err(camera.complain(SHUTTER[1], expected, format!("{closes} s")));
    }
    Ok(())
}

/// True if something in `root` drifts or has keyframes.
pub(super) fn moves(root: &Object) -> bool {
    keyframes::has_any(root) || has_wind(root)
}

fn has_wind(object: &Object) -> bool {
    object.properties.iter().any(|property| match &property.value {
        Value::Object(child) => child.plugin == WIND || has_wind(child),
        _ => false,
    })
}

impl Setup {
    /// True if the scene moves while the shutter is open.
    pub fn is_moving(&self) -> bool {
        self.moving.is_some()
    }

    /// The scene as `pass` of renders with `seed` sees it; none if it stands still.
    pub fn moment(&self, seed: u64, pass: u64) -> Option<Result<Self>> {
        let Moving { root, shutter } = self.moving.as_ref()?;
        let after = shutter.moment(seed, pass);
        let explain = |error: Error| {
            let place = format!("{after} s after the scene's time, while the shutter is open: {}", error.place);
            Error { place, ..error }
        };
        Some(build::build_moment(root, self.overrides, self, after).map_err(explain))
    }
}
