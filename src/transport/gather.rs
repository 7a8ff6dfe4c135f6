//! Previews that look up a first pass: path tracing whose camera subpaths end at their second scattering (`gather`,
//! P03T sec. 5.3) or at their first (`first-pass`, sec. 4.3.3), with the radiance that the first pass has there.
//! Scattering by mirrors and glass does not count. Glossy surfaces end no path. Where a dull surface also has a mirror
//! lobe, the mirrored path goes on.

use super::{
    cache::Partners,
    camera_path::{CameraPath, depart},
    estimator::Estimator,
    mis,
    observer::Observer,
    profile::Profile,
    segment::{Passed, sample_free_flight},
    strategy::StrategyKind,
    vertex::{Subpath, Vertex},
    walk::{Departure, Kind, Visitor, go_on},
};
use crate::{
    guide::solution::Ending,
    math::{Vec2, Vec3},
    sampling::Stream,
};

/// One camera subpath; the rest as in [`super::camera_path::sample`].
pub(super) fn sample<P: Profile, R: Observer>(
    estimator: &Estimator<'_, P>,
    ending: &Ending,
    [film, aperture]: [Vec2; 2],
    hero: usize,
    observer: R,
    stream: &mut Stream,
) -> R {
    let (scene, max_edges) = (estimator.scene, estimator.max_edges);
    let kind = Kind::of_camera(estimator, hero);
    let path = CameraPath::new(estimator, Partners::NONE, hero, observer);
    let mut gather = Gather { path, ending, has_scattered: ending.view.at_once, is_done: false };
    let mut next = Some(depart(estimator, film, aperture)).filter(|_| max_edges > 0);
    while let Some(departure) = next.filter(|departure| departure.dirac || !gather.is_done) {
        gather.is_done = false;
        gather.depart(&departure);
        let mut along =
            |passed: &Passed<P::Channels>, stream: &mut Stream| gather.pass(&departure, passed, stream);
        let flight = sample_free_flight::<P>(departure.segment(scene), hero, stream, &mut along);
        next = go_on(scene, kind, &departure, &flight, &mut gather, stream, |_| ());
    }
    gather.path.into_observer()
}

/// A camera subpath on its way to the place where it ends.
struct Gather<'a, P: Profile, R> {
    path: CameraPath<'a, P, R>,
    ending: &'a Ending,
    has_scattered: bool,
    is_done: bool,
}

impl<P: Profile, R: Observer> Visitor<P> for Gather<'_, P, R> {
    #[inline]
    fn kind(edges: u32) -> StrategyKind {
        <CameraPath<'_, P, R> as Visitor<P>>::kind(edges)
    }

    #[inline]
    fn connections(&self, edges: u32, position: Vec3) -> f32 {
        self.path.connections(edges, position)
    }

    #[inline]
    fn depart(&mut self, departure: &Departure<P::MisSums>) {
        self.path.depart(departure);
    }

    #[inline]
    fn reach(&mut self, vertex: &Vertex<P::MisSums>) {
        self.path.reach(vertex);
    }

    #[inline]
    fn arrive(&mut self, vertex: &Vertex<P::MisSums>, stream: &mut Stream) {
        let Estimator { scene, max_edges, .. } = *self.path.estimator;
        if !(self.has_scattered && vertex.event().is_dull(scene)) {
            self.has_scattered |= vertex.is_connectible(scene);
            return self.path.arrive(vertex, stream);
        }
        if vertex.subpath.edges < max_edges {
            let Subpath { throughput, pdf_over_hero, .. } = vertex.subpath;
            let radiance = self.ending.at(&vertex.event().place(scene), stream);
            self.path.observer.gather(throughput * radiance * mis::weight_alone(pdf_over_hero));
        }
        self.is_done = true;
    }

    #[inline]
    fn pass(&mut self, departure: &Departure<P::MisSums>, passed: &Passed<P::Channels>, stream: &mut Stream) {
        self.path.pass(departure, passed, stream);
    }

    fn escape(&mut self, subpath: &Subpath<P::MisSums>) {
        self.path.escape(subpath);
    }
}
