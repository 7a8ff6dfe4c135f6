//! Recorders that are chosen at run time: instruments need not be fast, and share one compiled estimator.

use crate::{
    math::{Spectrum, Vec2},
    scene::lights::EmissionSample,
    transport::{
        Contribution, Departure, MisSums, Subpath, Vertex,
        observer::{Meeting, Observer, StrategyKind},
    },
};

impl<S: MisSums> Observer<S> for &mut (dyn Observer<S> + '_) {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        (**self).contribute(s, t, meeting, contribution);
    }
    fn covers(&self, film: Vec2) -> bool {
        (**self).covers(film)
    }
    fn gather(&mut self, value: Spectrum) {
        (**self).gather(value);
    }
    fn start(&mut self) {
        (**self).start();
    }
    fn stop(&mut self, kind: StrategyKind, s: u32, t: u32) {
        (**self).stop(kind, s, t);
    }
    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        (**self).emit(start, hero);
    }
    fn depart(&mut self, departure: &Departure<S>) {
        (**self).depart(departure);
    }
    fn arrive(&mut self, vertex: &Vertex<S>) {
        (**self).arrive(vertex);
    }
    fn escape(&mut self, subpath: &Subpath<S>) {
        (**self).escape(subpath);
    }
    fn keep(&mut self) {
        (**self).keep();
    }
}
