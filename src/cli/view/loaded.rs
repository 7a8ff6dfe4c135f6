//! A scene as it was read, and how it is to be rendered.

use super::{
    Arguments,
    camera::{Camera, Frame},
};
use crate::{
    cli::scene,
    description::{Location, Position, Property, TransformStep, Value},
    error::{Error, Result},
    film::Film,
    format::{self, Spelling},
    medium::MediumIndex,
    passes::{Settings, budget::Budget},
    scene::{build::Setup, media::MediaMap},
    settings::options::Guiding,
};
use std::sync::Arc;

/// Numbers of four bytes that a view keeps of every pixel, at least: those of a render, the picture, and what a page gets of it.
const NUMBERS: usize = 16;

/// A scene that can be looked at.
pub(super) struct Loaded {
    /// The scene, its camera wherever it was put last.
    pub setup: Setup,
    /// How it is rendered, without a pilot.
    pub settings: Settings,
    /// The film of the scene's own camera.
    pub film: Film,
    /// The steps by which the scene places its camera; none of one that cannot be moved.
    pub placement: Option<Vec<TransformStep>>,
    /// What that camera is in, as the scene states it or its boundaries say; none where its rays start in several media.
    pub medium: Option<MediumIndex>,
    /// Its camera; why it cannot be moved.
    pub home: std::result::Result<Camera, Error>,
}

impl Loaded {
    /// Reads the scene that `arguments` name.
    pub(super) fn new(arguments: &Arguments) -> Result<Self> {
        let setup = scene::load(&arguments.scene, arguments.overrides())?;
        setup.film.check_memory(NUMBERS)?;
        let mut settings = arguments.estimator.requested(&setup, 0, Budget::ENDLESS)?;
        // What was learnt for one view would have to be learnt again for the next.
        if arguments.estimator.guide.is_none() {
            settings.options.effort.guide = Guiding::Never;
        }
        let placement = setup.placement().map(<[TransformStep]>::to_vec);
        let home = placement.clone().map(|steps| home(&setup, &steps));
        let MediaMap { sensor, sensor_media, .. } = &setup.scene.media_map;
        let (film, medium) = (setup.film.clone(), sensor_media.is_empty().then_some(*sensor));
        Ok(Self { setup, settings, film, placement: placement.ok(), medium, home })
    }

    /// The lines of a scene file that place `camera`, and true; or why nothing moves it.
    pub(super) fn lines(&self, camera: Option<&Camera>) -> (String, bool) {
        let lines = match (camera, &self.home) {
            (Some(camera), _) => self.spelled(camera),
            (None, Err(error)) => Err(error.clone()),
            (None, Ok(home)) => self.spelled(home),
        };
        match lines {
            Ok(lines) => (lines, true),
            Err(error) => (format!("This sensor can only be looked at. {error}"), false),
        }
    }

    fn spelled(&self, camera: &Camera) -> Result<String> {
        let Location { file, position } = self.setup.location();
        let spelling = if matches!(position, Position::Text { .. }) { Spelling::Xml } else { Spelling::Json };
        let location = Location { file: Arc::clone(file), position: Position::Path("$".to_owned()) };
        let value = Value::Transform(camera.rounded(self.film.width));
        format::transform(&Property { name: "to_world".to_owned(), value, location }, spelling)
    }
}

/// The camera that `steps` place in a scene, turning about what is in the middle of its image.
fn home(setup: &Setup, steps: &[TransformStep]) -> Camera {
    let mut camera = Camera::placed(steps, setup.scene.sensor.is_parallel());
    let (origin, direction) = setup.ahead();
    camera.frame(Frame { origin, direction, breadth: setup.breadth() });
    let distance = setup.distance_ahead().or_else(|| setup.distance_to_middle());
    distance.into_iter().for_each(|distance| camera.grip(distance));
    camera
}
