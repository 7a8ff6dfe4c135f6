//! One pixel sample made again, with everything that its walks hit: what one pass adds to one pixel.

use crate::{
    film::Film,
    math::{Spectrum, Vec2, Vec3},
    passes::{blocks::CameraStart, compiled::Compiled, observe::BlockObserver},
    render::instrument::Instrument,
    scene::lights::{EmissionSample, EmitterSample, Lights, Starts},
    transport::{
        Arrival, Contribution, Event, Interaction, Leg,
        observer::{Meeting, Observer, put},
        strategy::StrategyKind,
    },
};
use std::collections::BTreeMap;

/// What one pass adds to one pixel, and how.
#[derive(Clone, Debug)]
pub struct PixelSample {
    /// Where on the film the camera subpath starts (pixels).
    pub film: Vec2,
    /// Through which point of the aperture, as the sensor samples it.
    pub aperture: Vec2,
    /// The filter's factor for a sample there: 1, but for filters with negative lobes.
    pub factor: f32,
    /// The channel that samples distances, where extinction differs between channels.
    pub hero: Option<usize>,
    /// The camera subpath; where an interaction is forced the walk from that collision, then that from what lies
    /// behind.
    pub camera: Vec<Walk>,
    /// What the strategies tried from its vertices contributed, in order; values before `factor`.
    pub tries: Vec<Try>,
    /// What light subpaths contributed to the pixel, in order.
    pub splats: Vec<Splat>,
    /// The light subpaths that the others name by number.
    pub light: BTreeMap<u64, Walk>,
    /// The sum: what the pass adds to the pixel, if pixels have samples of their own.
    pub value: Spectrum,
}

/// A walk of either kind.
#[derive(Clone, Debug, Default)]
pub struct Walk {
    /// The emitter that a light subpath starts at.
    pub emitter: Option<EmissionSample>,
    /// Where it starts; none where nothing left the emitter.
    pub start: Option<Leg>,
    /// Its vertices after the start.
    pub stops: Vec<Stop>,
    /// The direction in which a camera subpath left the scene.
    pub escaped: Option<Vec3>,
}

/// A vertex of a walk.
#[derive(Clone, Copy, Debug)]
pub struct Stop {
    /// Where, and what is there.
    pub interaction: Interaction,
    /// How the walk came here.
    pub arrival: Arrival,
    /// How the walk went on; none where it ended here.
    pub onward: Option<Leg>,
}

/// A strategy tried from the camera subpath.
#[derive(Clone, Debug)]
pub struct Try {
    /// Which of the camera subpaths.
    pub walk: usize,
    /// Of which kind the strategy is.
    pub kind: StrategyKind,
    /// Light vertices.
    pub s: u32,
    /// Camera vertices, the lens among them.
    pub t: u32,
    /// What the last of the camera vertices was connected to.
    pub partner: Partner,
    /// What it contributed; none where it was blocked or nothing scatters along it.
    pub contribution: Option<Contribution>,
}

/// What a camera vertex was connected to.
#[derive(Clone, Debug)]
pub enum Partner {
    /// The camera subpath hit an emitter here.
    Met(Arrival, EmitterSample),
    /// A point of an emitter.
    Emitter(EmitterSample),
    /// A vertex of light subpath `walk`, `edges` segments from its start.
    Light {
        /// Number of the walk in its pass.
        walk: u64,
        /// Segments from the emitter.
        edges: u32,
        /// Where the vertex is.
        position: Vec3,
    },
}

impl Partner {
    /// Gives an emitter's point its density as the start of light subpaths that begin at learnt `starts`.
    fn start_at(&mut self, starts: &Starts, lights: &Lights) {
        if let Self::Met(_, sample) | Self::Emitter(sample) = self {
            sample.pdf_start = starts.pdf_point(lights, sample.light, &sample.point, sample.pdf_start);
        }
    }
}

/// A contribution of a light subpath to the pixel.
#[derive(Clone, Copy, Debug)]
pub struct Splat {
    /// Number of the walk in its pass.
    pub walk: u64,
    /// Light vertices; t = 1.
    pub s: u32,
    /// Where it landed on the film (pixels).
    pub film: Vec2,
    /// The share of it that the filter gives the pixel.
    pub share: f32,
    /// All of it.
    pub contribution: Contribution,
}

impl Splat {
    /// What the pixel gets.
    pub fn value(&self) -> Spectrum {
        self.contribution.value * self.share
    }
}

impl PixelSample {
    /// What `pass` adds to `pixel` (row-major index), and how: all light subpaths of the pass, for any of
    /// them may land on the pixel, the camera subpath, and once more the light subpaths that contributed
    /// something.
    pub fn of(instrument: &Instrument<'_>, pass: usize, pixel: usize) -> Self {
        let (compiled, count) = (instrument.at(pass), instrument.compiled.blocks().count());
        let blocks = instrument.work(0..count, |_, block| {
            let mut seen = Block::new(compiled, pixel);
            compiled.observe(pass, block, &|one| one == pixel, &mut seen);
            (seen.light.splats, seen.camera)
        });
        let (splats, mut camera): (Vec<_>, Vec<_>) = blocks.into_iter().unzip();
        let own = camera.iter().position(|camera| camera.start.is_some()).unwrap_or(0);
        let CameraPathObserver { trail, done, mut tries, start, .. } = camera.swap_remove(own);
        let (film, aperture, factor, hero) = start.unwrap_or_default();
        if let Some(starts) = compiled.starts() {
            tries.iter_mut().for_each(|one| one.partner.start_at(starts, &instrument.scene.lights));
        }
        let radiance =
            sum(tries.iter().filter_map(|one| one.contribution.map(|contribution| contribution.value)));
        let splats: Vec<Splat> = splats.into_iter().flatten().collect();
        // The order in which a pass adds up.
        let value = radiance * factor + sum(splats.iter().map(Splat::value));
        let contribution = tries.iter().filter_map(|one| match one.partner {
            Partner::Light { walk, .. } => Some(walk),
            _ => None,
        });
        let light = splats.iter().map(|splat| splat.walk).chain(contribution);
        let light = light.map(|walk| (walk, light_walk(compiled, pass, walk))).collect();
        let hero = (compiled.heroes() > 1).then_some(hero);
        let camera = [done, vec![trail.walk]].concat();
        Self { film, aperture, factor, hero, camera, tries, splats, light, value }
    }
}

fn sum(values: impl Iterator<Item = Spectrum>) -> Spectrum {
    values.fold(Spectrum::ZERO, |sum, value| sum + value)
}

/// All vertices of a light subpath.
fn light_walk(compiled: &dyn Compiled, pass: usize, walk: u64) -> Walk {
    let mut trail = Trail::of_light(compiled.film());
    compiled.light_walk(pass, walk, &mut trail);
    trail.walk
}

/// Sees the light subpaths of a block, and the camera subpath of the pixel if it is one of its own.
struct Block<'a> {
    light: LightPathObserver<'a>,
    camera: CameraPathObserver<'a>,
}

impl<'a> Block<'a> {
    fn new(compiled: &'a dyn Compiled, pixel: usize) -> Self {
        let light = LightPathObserver::new(compiled.film(), pixel, compiled.heroes());
        Self { light, camera: CameraPathObserver::default() }
    }
}

impl BlockObserver for Block<'_> {
    fn light(&mut self, walk: u64) -> &mut dyn Observer {
        self.light.walk = walk;
        &mut self.light
    }

    fn camera(&mut self, _: usize, start: &CameraStart) -> &mut dyn Observer {
        let CameraStart { position, aperture, weight, hero, .. } = *start;
        self.camera.start = Some((position, aperture, weight, hero));
        self.camera.kept = std::mem::take(&mut self.light.kept[hero]);
        &mut self.camera
    }
}

/// Remembers where a walk went.
#[derive(Default)]
struct Trail<'a> {
    /// Of light subpaths: they must do as they did.
    film: Option<&'a Film>,
    walk: Walk,
}

impl<'a> Trail<'a> {
    fn of_light(film: &'a Film) -> Self {
        Self { film: Some(film), ..Self::default() }
    }
}

impl Observer for Trail<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.is_none_or(|all| all.covers(film))
    }
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, _: Option<&Contribution>) {}
    fn emit(&mut self, start: &EmissionSample, _: usize) {
        self.walk.emitter = Some(*start);
    }
    fn depart(&mut self, leg: &Leg) {
        match self.walk.stops.last_mut() {
            Some(stop) => stop.onward = Some(*leg),
            None => self.walk.start = Some(*leg),
        }
    }
    fn arrive(&mut self, event: Event<'_>) {
        let Event { interaction, arrival, .. } = event;
        self.walk.stops.push(Stop { interaction: *interaction, arrival, onward: None });
    }
    fn escape(&mut self, arrival: &Arrival) {
        self.walk.escaped = Some(-arrival.incoming);
    }
}

/// Sees the camera subpath.
#[derive(Default)]
struct CameraPathObserver<'a> {
    /// Where on the film and in the aperture it starts, what it counts for, and its hero channel.
    start: Option<(Vec2, Vec2, f32, usize)>,
    trail: Trail<'a>,
    /// Walks before the one at hand.
    done: Vec<Walk>,
    /// Walk and segments from its start of every vertex in the cache of its hero channel.
    kept: Vec<(u64, u32)>,
    tries: Vec<Try>,
}

impl Observer for CameraPathObserver<'_> {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let kind = meeting.kind(s, t);
        let partner = match meeting {
            Meeting::Met(arrival, sample) => Partner::Met(arrival, *sample),
            Meeting::Emitter(sample) | Meeting::Bent { sample, .. } => Partner::Emitter(*sample),
            Meeting::Light(index, event) => {
                let (walk, edges) = self.kept[index];
                Partner::Light { walk, edges, position: event.position() }
            }
            Meeting::Pivot(leg, event, sample) => {
                self.depart(&leg);
                self.arrive(event);
                Partner::Emitter(*sample)
            }
            Meeting::Lens(_) => return,
        };
        let walk = self.done.len();
        self.tries.push(Try { walk, kind, s, t, partner, contribution: contribution.copied() });
    }
    fn depart(&mut self, leg: &Leg) {
        if leg.edges == 0 && self.trail.walk.start.is_some() {
            self.done.push(std::mem::take(&mut self.trail).walk);
        }
        self.trail.depart(leg);
    }
    fn arrive(&mut self, event: Event<'_>) {
        self.trail.arrive(event);
    }
    fn escape(&mut self, arrival: &Arrival) {
        self.trail.escape(arrival);
    }
}

/// Sees light subpaths.
struct LightPathObserver<'a> {
    film: &'a Film,
    pixel: usize,
    walk: u64,
    /// Segments from the start to the last vertex.
    edges: u32,
    hero: usize,
    /// Walk and segments from its start of every vertex in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<(u64, u32)>>,
    splats: Vec<Splat>,
}

impl<'a> LightPathObserver<'a> {
    fn new(film: &'a Film, pixel: usize, heroes: usize) -> Self {
        let kept = vec![Vec::new(); heroes];
        Self { film, pixel, walk: 0, edges: 0, hero: 0, kept, splats: Vec::new() }
    }
}

impl Observer for LightPathObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }
    fn contribute(&mut self, s: u32, _: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(contribution)) = (meeting, contribution) else { return };
        let (walk, contribution) = (self.walk, *contribution);
        self.film.spread(film, Spectrum::ONE, |pixel, share| {
            if pixel == self.pixel {
                self.splats.push(Splat { walk, s, film, share: share.x, contribution });
            }
        });
    }
    fn emit(&mut self, _: &EmissionSample, hero: usize) {
        self.hero = hero;
    }
    fn arrive(&mut self, event: Event<'_>) {
        self.edges = event.arrival.edges;
    }
    fn keep(&mut self, place: usize) {
        put(&mut self.kept[self.hero], place, (self.walk, self.edges));
    }
}
