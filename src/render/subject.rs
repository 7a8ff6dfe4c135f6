//! What is rendered: a still scene, or one that moves while the shutter is open. Every pass sees a moving scene at a
//! time of its own.

use super::{image::Precision, instrument::Instrument};
use crate::{
    error::Result,
    film::{Film, layer::Layer},
    passes::Settings,
    scene::{Scene, build::Setup},
};

/// What is rendered.
#[derive(Clone, Copy)]
pub enum Subject<'a> {
    /// A scene at one time.
    Still(&'a Scene),
    /// One that moves.
    Moving(&'a Setup),
}

impl<'a> From<&'a Scene> for Subject<'a> {
    fn from(scene: &'a Scene) -> Self {
        Self::Still(scene)
    }
}

impl<'a> From<&'a Setup> for Subject<'a> {
    fn from(setup: &'a Setup) -> Self {
        if setup.exposure().is_some() { Self::Moving(setup) } else { Self::Still(&setup.scene) }
    }
}

/// Makes the passes of a render.
pub struct Stage<'a> {
    /// The instrument of the scene halfway through the exposure, on which everything is learnt.
    pub instrument: Instrument<'a>,
    moving: Option<&'a Setup>,
    layers: &'a [Layer],
}

impl<'a> Stage<'a> {
    /// The stage of `subject` on `film`, for a render to a `precision` if there is one.
    pub(super) fn new(
        subject: Subject<'a>,
        film: &'a Film,
        settings: &Settings,
        layers: &'a [Layer],
        precision: Option<Precision>,
    ) -> Self {
        let (scene, moving) = match subject {
            Subject::Still(scene) => (scene, None),
            Subject::Moving(setup) => (&setup.scene, Some(setup)),
        };
        let instrument = Instrument::new(scene, film, settings).sorting(layers);
        let instrument = precision.into_iter().fold(instrument, Instrument::with_precision);
        Self { instrument, moving, layers }
    }

    /// The stage of `subject` without layers.
    pub fn of(subject: impl Into<Subject<'a>>, film: &'a Film, settings: &Settings) -> Self {
        Self::new(subject.into(), film, settings, &[], None)
    }

    /// A stage whose scene stands still.
    pub(super) fn still(instrument: Instrument<'a>) -> Self {
        Self { instrument, moving: None, layers: &[] }
    }

    /// Has `make` make `pass` and passes after it, by an instrument that sees the scene at their time. `make` gets the
    /// most passes that it may make.
    pub fn show<T>(&self, pass: u64, make: impl FnOnce(&Instrument<'_>, usize) -> T) -> Result<T> {
        let moment = self.moving.and_then(|setup| setup.moment(self.instrument.settings.seed, pass));
        let Some(moment) = moment.transpose()? else { return Ok(make(&self.instrument, usize::MAX)) };
        let instrument = self.instrument.seeing(&moment.scene, pass as usize).sorting(self.layers);
        Ok(make(&instrument, 1))
    }
}
