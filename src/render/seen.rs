//! What pixels see of emitters: looked up once per pixel, where an estimate of the noise asks for it.

use super::{fog, instrument::Instrument};
use crate::{
    math::SpectrumExt,
    sampling::{Stream, stream::Purpose},
};
use std::{cell::RefCell, collections::HashMap};

/// Rays through a pixel: a lamp that covers a hundredth of it is hit.
const RAYS: u64 = 256;

/// The pixels that were looked at.
pub(super) struct Seen<'a, 's> {
    instrument: &'a Instrument<'s>,
    known: RefCell<HashMap<usize, f64>>,
}

impl<'a, 's> Seen<'a, 's> {
    /// None yet.
    pub(super) fn new(instrument: &'a Instrument<'s>) -> Self {
        Self { instrument, known: RefCell::default() }
    }

    /// The luminance of emitters that `pixel` sees directly or by way of smooth surfaces.
    pub(super) fn of(&self, pixel: usize) -> f64 {
        *self.known.borrow_mut().entry(pixel).or_insert_with(|| self.look(pixel))
    }

    fn look(&self, pixel: usize) -> f64 {
        let Instrument { scene, film, settings, .. } = self.instrument;
        let hidden = settings.options.hide_emitters;
        let sample = |index| {
            let mut stream = Stream::new(settings.seed, pixel as u64, index, Purpose::Study);
            let (position, weight) = film.sample(pixel, &mut stream);
            let aperture = scene.sensor.sample_aperture(&mut stream);
            let ray = scene.sensor.ray(position, aperture).ray;
            f64::from(weight * fog::seen(scene, hidden, ray, &mut stream).luminance())
        };
        (0..RAYS).map(sample).sum::<f64>() / RAYS as f64
    }
}
