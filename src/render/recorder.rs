//! Recorders that are chosen at run time: instruments need not be fast, and share one compiled estimator.

use crate::{
    math::Vec2,
    scene::lights::EmissionSample,
    transport::{
        Departure, Joined, Subpath, Sums, Vertex,
        record::{Meeting, Recorder},
    },
};

impl<S: Sums> Recorder<S> for &mut (dyn Recorder<S> + '_) {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, joined: Option<&Joined>) {
        (**self).contribute(s, t, meeting, joined);
    }
    fn covers(&self, film: Vec2) -> bool {
        (**self).covers(film)
    }
    fn start(&mut self) {
        (**self).start();
    }
    fn stop(&mut self, s: u32, t: u32) {
        (**self).stop(s, t);
    }
    fn emit(&mut self, start: &EmissionSample) {
        (**self).emit(start);
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
