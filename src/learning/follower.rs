//! Where the light of each contribution starts, and how often light subpaths start there.

use crate::{
    math::Vec3,
    scene::lights::{Densities, EmissionSample, EmitterSample, Lights, Start, Starts},
    transport::{
        Event, Leg,
        observer::{Meeting, put},
    },
};

/// Follows walks, to tell where the light of each contribution starts.
pub(super) struct Follower<'a> {
    lights: &'a Lights,
    starts: Option<&'a Starts>,
    /// The last vertex of the walk at hand, or where it set out from.
    last: Vec3,
    /// Channel of the walk at hand.
    pub hero: usize,
    walks: u32,
    /// The start of the light subpath at hand.
    current: Option<Followed>,
    /// The starts of the vertices in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<Followed>>,
}

/// Where light starts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Followed {
    pub start: Start,
    /// Where its light first arrives: next-event estimation would connect from there.
    pub arrives: Vec3,
    /// Density of light subpaths' starts there without learnt starts, over that with them.
    pub unlearnt: f32,
    /// The number of the light subpath that started there.
    pub walk: Option<u32>,
}

impl<'a> Follower<'a> {
    pub(super) fn new(lights: &'a Lights, starts: Option<&'a Starts>, heroes: usize) -> Self {
        Self {
            lights,
            starts,
            last: Vec3::ZERO,
            hero: 0,
            walks: 0,
            current: None,
            kept: vec![Vec::new(); heroes],
        }
    }

    /// Camera subpaths follow, which begin at no emitter.
    pub(super) fn leave_light(&mut self) {
        self.current = None;
    }

    /// A camera subpath of channel `hero` follows.
    pub(super) fn begin(&mut self, hero: usize) {
        self.hero = hero;
    }

    pub(super) fn emit(&mut self, sample: &EmissionSample, hero: usize) {
        self.hero = hero;
        let start = sample.start();
        let learnt = Densities { point: sample.pdf, direction: sample.pdf_direction };
        let walk = Some(self.walks);
        self.walks += 1;
        let unlearnt = ratio(sample.unlearnt, learnt);
        self.current = Some(Followed { start, arrives: start.position, unlearnt, walk });
    }

    pub(super) fn depart(&mut self, leg: &Leg) {
        self.last = leg.position;
    }

    pub(super) fn arrive(&mut self, event: &Event<'_>) {
        self.last = event.position();
        if let (1, Some(current)) = (event.arrival.edges, &mut self.current) {
            current.arrives = self.last;
        }
    }

    pub(super) fn keep(&mut self, place: usize) {
        if let Some(current) = self.current {
            put(&mut self.kept[self.hero], place, current);
        }
    }

    /// Density of the current light subpath's start without learnt starts, over that with them.
    pub(super) fn unlearnt(&self) -> f32 {
        self.current.map_or(1.0, |followed| followed.unlearnt)
    }

    /// Where the light of a contribution starts; none where it comes straight from the emitter to the lens.
    pub(super) fn start(&self, s: u32, t: u32, meeting: &Meeting<'_>) -> Option<Followed> {
        match meeting {
            _ if s + t < 3 => None,
            Meeting::Light(index, _) => Some(self.kept[self.hero][*index]),
            Meeting::Lens(_) => self.current,
            Meeting::Met(arrival, sample) => Some(self.found(sample, self.last, arrival.incoming)),
            Meeting::Emitter(sample) => self.joined(sample, self.last),
            Meeting::Bent { sample, last, .. } => self.joined(sample, *last),
            Meeting::Pivot(_, event, sample) => self.joined(sample, event.position()),
        }
    }

    /// See [`Lights::unaimed`].
    pub(super) fn unaimed(&self, followed: &Followed) -> f32 {
        self.lights.unaimed(self.starts, &followed.start, followed.arrives)
    }

    /// See [`Lights::without_sky`], from the last vertex.
    pub(super) fn without_sky(&self, light: u32) -> f32 {
        self.lights.without_sky(light, self.last)
    }

    fn joined(&self, sample: &EmitterSample, reference: Vec3) -> Option<Followed> {
        let (direction, _) = sample.point.seen_from(reference)?;
        Some(self.found(sample, reference, -direction))
    }

    fn found(&self, sample: &EmitterSample, reference: Vec3, direction: Vec3) -> Followed {
        let start = Start::towards(sample.light, &sample.point, reference, direction);
        let unlearnt = Densities { point: sample.pdf_start, direction: sample.pdf_direction };
        let learnt = self.starts.map(|starts| starts.densities(self.lights, &start, unlearnt));
        let unlearnt = learnt.map_or(1.0, |learnt| ratio(unlearnt, learnt));
        Followed { start, arrives: reference, unlearnt, walk: None }
    }
}

fn ratio(unlearnt: Densities, learnt: Densities) -> f32 {
    let ratio = unlearnt.both() / learnt.both();
    if ratio.is_finite() { ratio } else { 1.0 }
}
