//! One pixel sample made again, with everything that its walks hit: what one pass adds to one pixel.

use super::{compiled::Ready, instrument::Instrument};
use crate::{
    film::Film,
    math::{Channels, Spectrum, Vec2, Vec3},
    medium::MediumIndex,
    scene::lights::{EmissionSample, EmitterSample, Lights, Starts},
    transport::{
        Contribution, Departure, Interaction, LightCache, MisSums, Subpath, Vertex,
        observer::{Meeting, Observer, StrategyKind},
        profile::Profile,
    },
};
use std::collections::BTreeMap;

/// What one pass adds to one pixel, and how.
#[derive(Clone, Debug)]
pub struct PixelSample {
    /// Where on the film the camera subpath starts [pixels].
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
    /// The sum: what the pass adds to the pixel.
    pub value: Spectrum,
}

/// A walk of either kind.
#[derive(Clone, Debug)]
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

/// How a walk goes on from its start or a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Where it was.
    pub position: Vec3,
    /// Where it goes to, unit.
    pub direction: Vec3,
    /// The medium that it is then in.
    pub medium: MediumIndex,
    /// See [`Departure::pdf_fwd`].
    pub density: f32,
    /// The direction is that of a Dirac lobe.
    pub dirac: bool,
    /// Contribution over density so far.
    pub throughput: Spectrum,
}

/// How a walk reached a point.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// The medium of the segment that ended here.
    pub medium: MediumIndex,
    /// Unit direction towards the vertex before.
    pub incoming: Vec3,
    /// Density of the point by the hero channel: per volume in media [1/m^3], per area on surfaces [1/m^2], per solid
    /// angle at infinity [1/sr].
    pub density: f32,
    /// Contribution over density of all before its own scattering.
    pub throughput: Spectrum,
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
    /// Where it landed on the film [pixels].
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

impl Instrument<'_> {
    /// What `pass` adds to `pixel` (row-major index), and how: all light subpaths of the pass, for any of
    /// them may land on the pixel, the camera subpath, and once more the light subpaths that contributed
    /// something.
    pub fn sample(&self, pass: usize, pixel: usize) -> PixelSample {
        let (blocks, compiled) = (self.compiled.blocks(), self.at(pass));
        let own = (0..blocks.count()).find(|block| blocks.pixels(*block).any(|p| p == pixel)).unwrap_or(0);
        let splats = self.work(0..blocks.count(), |_, block| compiled.splats(pass, block, pixel));
        let EyeSample { film, aperture, factor, hero, camera, tries } = compiled.eye_sample(pass, own, pixel);
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
        let light = light.map(|walk| (walk, compiled.light_walk(pass, walk))).collect();
        PixelSample { film, aperture, factor, hero, camera, tries, splats, light, value }
    }
}

/// The part of a [`PixelSample`] that its camera subpath makes.
pub(super) struct EyeSample {
    film: Vec2,
    aperture: Vec2,
    factor: f32,
    hero: Option<usize>,
    camera: Vec<Walk>,
    tries: Vec<Try>,
}

impl EyeSample {
    /// What the strategies contributed, with their numbers of light and camera vertices.
    pub fn contributions(&self) -> impl Iterator<Item = (u32, u32, Spectrum)> + '_ {
        self.tries.iter().filter_map(|one| Some((one.s, one.t, one.contribution?.value)))
    }
}

/// Makes the camera subpath of `pixel` in `pass` again, connected to the light subpaths of `block`.
pub(super) fn camera<P: Profile>(ready: &Ready<'_, P>, pass: usize, block: usize, pixel: usize) -> EyeSample {
    let lit = light(ready, pass, block, pixel);
    let start = ready.blocks.camera_start(ready.scene, ready.film, ready.seed, pass, pixel);
    let (film, aperture, factor, hero) = (start.position, start.aperture, start.weight, start.hero);
    let mut camera = CameraPathObserver {
        trail: Trail::new(),
        done: Vec::new(),
        kept: &lit.kept[hero],
        tries: Vec::new(),
    };
    let observer: &mut dyn Observer<P::MisSums> = &mut camera;
    start.trace(&ready.estimator, &lit.cache, observer);
    let CameraPathObserver { trail: Trail { walk: last, .. }, done: mut camera, mut tries, .. } = camera;
    camera.push(last);
    if let Some(starts) = ready.estimator.starts() {
        tries.iter_mut().for_each(|one| one.partner.start_at(starts, &ready.scene.lights));
    }
    EyeSample { film, aperture, factor, hero: (P::Channels::COUNT > 1).then_some(hero), camera, tries }
}

fn sum(values: impl Iterator<Item = Spectrum>) -> Spectrum {
    values.fold(Spectrum::ZERO, |sum, value| sum + value)
}

/// The light subpaths of a block.
pub(super) struct Lit<S: MisSums> {
    cache: LightCache<S>,
    /// Walk and segments from its start of every vertex in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<(u64, u32)>>,
    pub splats: Vec<Splat>,
}

/// Traces the light subpaths of `block`; of what they contribute to the film, the splats on `pixel`.
pub(super) fn light<P: Profile>(
    ready: &Ready<'_, P>,
    pass: usize,
    block: usize,
    pixel: usize,
) -> Lit<P::MisSums> {
    let Ready { estimator, blocks, film, .. } = ready;
    let heroes = P::Channels::COUNT;
    let (mut cache, mut kept, mut splats) = (LightCache::new(heroes), vec![Vec::new(); heroes], Vec::new());
    if estimator.needs_light_walks() {
        for walk in blocks.light_paths(block) {
            let mut seen = LightPathObserver::new(film, pixel, walk);
            let hero = trace(ready, pass, walk, &mut cache, &mut seen);
            kept[hero].extend(seen.kept.iter().map(|edges| (walk, *edges)));
            splats.append(&mut seen.splats);
        }
    }
    Lit { cache, kept, splats }
}

/// Light subpath number `walk` of `pass`, seen by `observer`; its hero channel.
fn trace<P: Profile>(
    ready: &Ready<'_, P>,
    pass: usize,
    walk: u64,
    cache: &mut LightCache<P::MisSums>,
    observer: &mut dyn Observer<P::MisSums>,
) -> usize {
    let Ready { estimator, blocks, seed, .. } = ready;
    let mut stream = blocks.light_stream(*seed, pass, walk);
    let hero = blocks.hero(*seed, pass, walk);
    let mut observer = observer;
    estimator.trace_light(cache, &mut observer, hero, &mut stream);
    hero
}

/// All vertices of a light subpath.
pub(super) fn light_walk<P: Profile>(ready: &Ready<'_, P>, pass: usize, walk: u64) -> Walk {
    let mut trail = Trail::of_light(ready.film);
    trace(ready, pass, walk, &mut LightCache::new(P::Channels::COUNT), &mut trail);
    trail.walk
}

/// Remembers where a walk went.
struct Trail<'a> {
    /// Of light subpaths: they must do as they did.
    film: Option<&'a Film>,
    walk: Walk,
}

impl<'a> Trail<'a> {
    fn new() -> Self {
        let walk = Walk { emitter: None, start: None, stops: Vec::new(), escaped: None };
        Self { film: None, walk }
    }

    fn of_light(film: &'a Film) -> Self {
        Self { film: Some(film), ..Self::new() }
    }
}

impl<S: MisSums> Observer<S> for Trail<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.is_none_or(|all| all.covers(film))
    }
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_, S>, _: Option<&Contribution>) {}
    fn emit(&mut self, start: &EmissionSample, _: usize) {
        self.walk.emitter = Some(*start);
    }
    fn depart(&mut self, departure: &Departure<S>) {
        let leg = Some(Leg {
            position: departure.position,
            direction: departure.ray.direction,
            medium: departure.medium,
            density: departure.pdf_fwd,
            dirac: departure.dirac,
            throughput: departure.throughput,
        });
        match self.walk.stops.last_mut() {
            Some(stop) => stop.onward = leg,
            None => self.walk.start = leg,
        }
    }
    fn arrive(&mut self, vertex: &Vertex<S>) {
        let Vertex { interaction, subpath, .. } = vertex;
        self.walk.stops.push(Stop { interaction: *interaction, arrival: arrival(subpath), onward: None });
    }
    fn escape(&mut self, subpath: &Subpath<S>) {
        self.walk.escaped = Some(-subpath.incoming);
    }
}

fn arrival<S: MisSums>(subpath: &Subpath<S>) -> Arrival {
    let Subpath { medium, incoming, throughput, inv_pdf, .. } = *subpath;
    Arrival { medium, incoming, density: 1.0 / inv_pdf, throughput }
}

/// Sees the camera subpath.
struct CameraPathObserver<'a> {
    trail: Trail<'a>,
    /// Walks before the one at hand.
    done: Vec<Walk>,
    kept: &'a [(u64, u32)],
    tries: Vec<Try>,
}

impl<S: MisSums> Observer<S> for CameraPathObserver<'_> {
    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let kind = meeting.kind(s, t);
        let partner = match meeting {
            Meeting::Met(subpath, sample) => Partner::Met(arrival(subpath), *sample),
            Meeting::Emitter(sample) => Partner::Emitter(*sample),
            Meeting::Light(index, vertex) => {
                let (walk, edges) = self.kept[index];
                Partner::Light { walk, edges, position: vertex.position() }
            }
            Meeting::Pivot(departure, vertex, sample) => {
                self.depart(departure);
                self.arrive(vertex);
                Partner::Emitter(*sample)
            }
            Meeting::Lens(_) => return,
        };
        let walk = self.done.len();
        self.tries.push(Try { walk, kind, s, t, partner, contribution: contribution.copied() });
    }
    fn depart(&mut self, departure: &Departure<S>) {
        if departure.edges == 0 && self.trail.walk.start.is_some() {
            self.done.push(std::mem::replace(&mut self.trail, Trail::new()).walk);
        }
        self.trail.depart(departure);
    }
    fn arrive(&mut self, vertex: &Vertex<S>) {
        self.trail.arrive(vertex);
    }
    fn escape(&mut self, subpath: &Subpath<S>) {
        self.trail.escape(subpath);
    }
}

/// Sees one light subpath.
struct LightPathObserver<'a> {
    film: &'a Film,
    pixel: usize,
    walk: u64,
    /// Segments from the start to the last vertex.
    edges: u32,
    /// The same of all vertices that the cache keeps.
    kept: Vec<u32>,
    splats: Vec<Splat>,
}

impl<'a> LightPathObserver<'a> {
    fn new(film: &'a Film, pixel: usize, walk: u64) -> Self {
        Self { film, pixel, walk, edges: 0, kept: Vec::new(), splats: Vec::new() }
    }
}

impl<S: MisSums> Observer<S> for LightPathObserver<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }
    fn contribute(&mut self, s: u32, _: u32, meeting: Meeting<'_, S>, contribution: Option<&Contribution>) {
        let (Meeting::Lens(film), Some(contribution)) = (meeting, contribution) else { return };
        let (walk, contribution) = (self.walk, *contribution);
        self.film.spread(film, Spectrum::ONE, |pixel, share| {
            if pixel == self.pixel {
                self.splats.push(Splat { walk, s, film, share: share.x, contribution });
            }
        });
    }
    fn arrive(&mut self, vertex: &Vertex<S>) {
        self.edges = vertex.subpath.edges;
    }
    fn keep(&mut self) {
        self.kept.push(self.edges);
    }
}
