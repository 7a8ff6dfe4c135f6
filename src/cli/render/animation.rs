//! The frames of an animation: when each is, and the scene that it shows.

use super::{arguments::Render, features};
use crate::cli::{parsers::Frames, scene::built};
use crate::{
    description::{Object, Property, Value},
    error::{Error, Result},
    scene::{
        build::{self, Setup},
        keyframes,
        shutter::Shutter,
        smoke,
    },
};

/// Default number of frames per second.
const FPS: f64 = 24.0;

/// A scene file as it is read for one frame or many.
pub(super) struct Clip<'a> {
    arguments: &'a Render,
    root: Object,
    /// True if the scene is built again for each frame: its description changes, or frames show different files.
    pub rebuilds: bool,
}

impl<'a> Clip<'a> {
    /// Reads the scene file.
    pub(super) fn read(arguments: &'a Render) -> Result<Self> {
        let root = arguments.scene.read()?;
        let root = if arguments.denoise { features::added(root) } else { root };
        let is_blurred = !Shutter::of(&root)?.is_instant();
        let changes = smoke::has_sequence(&root) || keyframes::has_any(&root) || is_blurred;
        Ok(Self { arguments, root, rebuilds: arguments.frames.is_some() && changes })
    }

    /// Builds the scene at its own time, or where it is built for each frame, as the first shows it.
    pub(super) fn first(&self) -> Result<Setup> {
        match self.arguments.frames.filter(|_| self.rebuilds) {
            None => built(&self.root, self.arguments.overrides()),
            Some(frames) => {
                let setup = built(&self.at(self.time(frames.first)), self.arguments.overrides())?;
                (frames.first..=frames.last).try_for_each(|frame| self.check(&setup, frame))?;
                self.check_extremes(&setup, frames)?;
                Ok(setup)
            }
        }
    }

    /// Builds the scene of `frame`; parts that have not changed since the frame `before` are reused. Warnings were
    /// given for the first.
    pub(super) fn frame(&self, frame: u32, before: &Setup) -> Result<Setup> {
        let root = self.at(self.time(frame));
        let built = build::build_again(&root, self.arguments.overrides(), Some(before));
        built.map_err(|error| self.explain(frame, error))
    }

    /// When a frame is (s).
    pub(super) fn time(&self, frame: u32) -> f64 {
        smoke::time_of(&self.root) + f64::from(frame) / self.arguments.fps.unwrap_or(FPS)
    }

    /// `error` in a frame.
    pub(super) fn explain(&self, frame: u32, error: Error) -> Error {
        Error { place: format!("frame {frame}, at {} s: {}", self.time(frame), error.place), ..error }
    }

    /// Every frame has its files, which is better known before hours of rendering than after.
    fn check(&self, setup: &Setup, frame: u32) -> Result<()> {
        let time = self.time(frame);
        let missing = setup.smoke.iter().find_map(|taken| taken.at(time).err());
        missing.map_or(Ok(()), |error| Err(self.explain(frame, error)))
    }

    /// What changes stays in range: of all frames, the last one and those next to where it is least or greatest leave it
    /// first.
    fn check_extremes(&self, setup: &Setup, frames: Frames) -> Result<()> {
        let mut times = Vec::new();
        keyframes::extremes(
            &self.root,
            [frames.first, frames.last].map(|frame| self.time(frame)),
            &mut times,
        );
        let number = |time: f64| (time - self.time(0)) / (self.time(1) - self.time(0));
        let next_to = |time: f64| [number(time).floor(), number(time).ceil()].map(|number| number as u32);
        let mut next: Vec<u32> = times.into_iter().flat_map(next_to).chain([frames.last]).collect();
        next.sort_unstable();
        next.dedup();
        next.retain(|frame| (frames.first + 1..=frames.last).contains(frame));
        next.into_iter().try_for_each(|frame| self.frame(frame, setup).map(|_| ()))
    }

    /// The scene at `time` (s).
    fn at(&self, time: f64) -> Object {
        let mut root = self.root.clone();
        let (value, location) = (Value::Float(time), root.location.clone());
        match root.properties.iter_mut().find(|property| property.name == "time") {
            None => root.properties.push(Property { name: "time".to_owned(), value, location }),
            Some(own) if matches!(own.value, Value::Float(_) | Value::Integer(_)) => own.value = value,
            // What is no time is refused where the scene is built.
            Some(_) => {}
        }
        root
    }
}
