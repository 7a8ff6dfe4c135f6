//! What the samples of one block bring: contributions, and the work that they took.

use super::{End, WALKS_END};
use crate::{
    film::{Film, sharing::FilmSamples},
    learning::follower::Follower,
    math::{Spectrum, SpectrumExt, Vec2},
    passes::{blocks::CameraStart, compiled::Compiled, observe::BlockObserver},
    scene::lights::EmissionSample,
    settings::options::Survival,
    transport::{
        Contribution, Event, Leg,
        observer::{Meeting, Observer, put},
        roulette,
        strategy::StrategyKind,
    },
};

/// One for each of [`WALKS_END`].
pub(super) type BySurvival<T> = [T; WALKS_END.len()];

/// A contribution to a pixel.
#[derive(Clone, Copy)]
pub(super) struct Found {
    pub pixel: u32,
    /// Squared luminance; from [`super::forecast::Forecast`] on, its part in the second moment of a pixel sample in a tile.
    pub square: f64,
    pub shares: [f32; StrategyKind::ALL.len()],
    pub route: Route,
    /// How often light subpaths would start there without learnt starts, over how often they do.
    pub unlearnt: f32,
    /// How often next-event estimation would find its light without learnt starts, over how often it does.
    pub unaimed: f32,
    /// Probability that next-event estimation finds its light if it leaves out the environment, over that with it.
    pub without_sky: f32,
    /// The kind of the strategy that brought it.
    pub kind: StrategyKind,
    /// Transmittance of its connection as the weights use it, over the estimate found.
    pub expected: f32,
    /// Number of its camera subpath in the block. Contributions of one subpath follow each other, the shortest paths
    /// first.
    pub sample: u32,
    /// Of a connection, its vertex on the camera subpath; else 0.
    pub vertex: u32,
}

/// Where walks could end between the sensor and the emitter of a path.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Route {
    pub all: Ends,
    /// The part of these on the light subpath of a connection.
    pub light: Ends,
    /// The logarithms of the albedos next to the sensor and next to the emitter.
    pub outermost: [f32; 2],
    /// Those of the two vertices that are connected, on the camera subpath and on the light subpath; 0 without them.
    pub connected: [f32; 2],
}

/// The vertices that a walk scatters at.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Ends {
    pub vertices: u32,
    /// The sum of the logarithms of their albedos.
    albedo: f32,
    /// The logarithm of the first one's albedo.
    first: f32,
    /// The same of the last one.
    last: f32,
}

/// Least survival probability: what comes after a lesser one does not count.
const LEAST: f32 = 1e-3;

impl Ends {
    /// A vertex that walks with roulette by `survival` survive with this `probability`.
    pub(super) fn at(probability: f32, survival: Survival) -> Self {
        let albedo = probability.max(LEAST).ln() / survival.exponent();
        Self { vertices: 1, albedo, first: albedo, last: albedo }
    }

    pub(super) fn and(self, other: Self) -> Self {
        if other.vertices == 0 {
            return self;
        }
        let first = if self.vertices == 0 { other.first } else { self.first };
        let (vertices, albedo) = (self.vertices + other.vertices, self.albedo + other.albedo);
        Self { vertices, albedo, first, last: other.last }
    }

    /// Probability that walks survive these vertices if they end by `now`, over that by the survival `before`.
    pub(super) fn passed(self, now: End, before: Survival) -> f32 {
        let now = match now {
            End::AtOnce(survival) => survival.exponent() * self.albedo,
            End::Late if self.vertices == 0 => 0.0,
            // The roulette of the last vertex comes after all that is found from there.
            End::Late => roulette::late(self.vertices as f32 - 1.0, self.of_one()),
        };
        (now - before.exponent() * self.albedo).exp()
    }

    /// The mean logarithm of the albedo.
    pub(super) fn of_one(self) -> f32 {
        self.albedo / self.vertices.max(1) as f32
    }
}

/// Probability that walks survive one vertex more, the logarithm of whose albedo is `log_albedo`, over that before.
pub(super) fn passed_one(log_albedo: f32, now: End, before: Survival) -> f32 {
    let now = match now {
        End::AtOnce(survival) => survival.exponent(),
        End::Late => 0.0,
    };
    ((now - before.exponent()) * log_albedo).exp()
}

/// How often something was done.
#[derive(Clone, Copy, Default)]
pub(super) struct Work {
    pub walks: f64,
    /// Walks that set out.
    pub begun: f64,
    pub segments: f64,
    pub tries: [f64; StrategyKind::ALL.len()],
    /// Vertices of light subpaths that are kept for connections.
    pub kept: f64,
    /// Light subpaths that the lens sees.
    pub reaching: f64,
}

impl Work {
    pub(super) fn and(mut self, other: &Self) -> Self {
        self.walks += other.walks;
        self.begun += other.begun;
        self.segments += other.segments;
        self.kept += other.kept;
        self.reaching += other.reaching;
        self.tries.iter_mut().zip(other.tries).for_each(|(tries, other)| *tries += other);
        self
    }
}

pub(super) type Works = BySurvival<Work>;

/// What the samples of one kind of walk bring.
#[derive(Default)]
pub(super) struct Recorded {
    pub found: Vec<Found>,
    /// By each of [`WALKS_END`], in place of that of the pilot.
    pub work: Works,
    /// The work of light subpaths that start as emitters emit.
    pub emitted: Works,
}

/// Sees the walks of a block and what they contribute; those of the camera to the last of its pixels.
struct Recorder<'a> {
    film: &'a Film,
    film_samples: FilmSamples,
    pass: u64,
    survival: Survival,
    follower: Follower<'a>,
    weight: f32,
    /// Pixels with what camera subpaths contribute to them.
    sums: Vec<(u32, f64)>,
    /// The light subpath at hand is seen.
    is_seen: bool,
    /// Of the walk at hand, up to each of its vertices.
    ends: Vec<Ends>,
    /// The same up to the vertices in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<Ends>>,
    /// How often the walk at hand would have gone on so far, by each of [`WALKS_END`].
    reached: BySurvival<f64>,
    /// Of light subpaths.
    light: Recorded,
    /// Of walks of the kind at hand.
    recorded: Recorded,
}

impl<'a> Recorder<'a> {
    fn new(compiled: &'a dyn Compiled, survival: Survival, pass: usize) -> Self {
        let heroes = compiled.heroes();
        let follower = Follower::new(&compiled.scene().lights, compiled.starts(), heroes);
        Self {
            film: compiled.film(),
            film_samples: compiled.film_samples(),
            pass: pass as u64,
            survival,
            follower,
            weight: 1.0,
            sums: Vec::new(),
            is_seen: false,
            ends: vec![Ends::default()],
            kept: vec![Vec::new(); heroes],
            reached: Default::default(),
            light: Recorded::default(),
            recorded: Recorded::default(),
        }
    }

    /// Counts some work of the walk at hand.
    fn count(&mut self, counter: impl Fn(&mut Work) -> &mut f64) {
        let unlearnt = f64::from(self.follower.unlearnt());
        let Recorded { work, emitted: works, .. } = &mut self.recorded;
        for ((reached, work), works) in self.reached.iter().zip(work).zip(works) {
            *counter(work) += reached;
            *counter(works) += reached * unlearnt;
        }
    }

    /// The walk at hand up to so many `vertices`.
    fn own(&self, vertices: u32) -> Ends {
        self.ends.get(vertices as usize).copied().unwrap_or_default()
    }

    /// The route of `s` light and `t` camera vertices that met so.
    fn route(&self, s: u32, t: u32, meeting: &Meeting<'_>) -> Route {
        let light = match meeting {
            Meeting::Light(index, _) => self.kept[self.follower.hero][*index],
            _ => Ends::default(),
        };
        let walk = match meeting {
            // All vertices must be survived. By way of smooth surfaces, the last one need not.
            Meeting::Met(..) | Meeting::Bent { .. } => self.own(t.saturating_sub(2)),
            Meeting::Emitter(_) | Meeting::Light(..) => self.own(t - 1),
            Meeting::Lens(_) => self.own(s - 1),
            Meeting::Pivot(_, event, _) => Ends::at(event.survival, self.survival),
        };
        let all = walk.and(light);
        let (outermost, connected) = match meeting {
            Meeting::Lens(_) => ([walk.last, walk.first], [0.0; 2]),
            Meeting::Light(..) => ([walk.first, light.first], [walk.last, light.last]),
            _ => ([walk.first, walk.last], [0.0; 2]),
        };
        Route { all, light, outermost, connected }
    }

    /// What a contribution says of other counts of strategies.
    fn counted(&self, s: u32, t: u32, meeting: &Meeting<'_>, contribution: &Contribution) -> Counted {
        let Contribution { shares, transmittance, expected, .. } = contribution;
        // By way of smooth surfaces, every vertex is connected once, however many other connections it has.
        if matches!(meeting, Meeting::Bent { .. }) {
            let kind = StrategyKind::EmitterHit;
            let all = shares.iter().sum();
            let shares = StrategyKind::each(|one| if one == kind { all } else { 0.0 });
            return Counted { kind, shares, expected: 1.0, starts: [1.0; 3], vertex: 0 };
        }
        let starts = self.follower.start(s, t, meeting).map_or([1.0; 3], |one| {
            [one.unlearnt, self.follower.unaimed(&one), self.follower.without_sky(one.start.light)]
        });
        let kind = meeting.kind(s, t);
        let vertex = if kind == StrategyKind::Connection { t } else { 0 };
        let expected = expected.luminance() / transmittance.luminance();
        Counted { kind, shares: *shares, expected, starts, vertex }
    }
}

/// See the fields of [`Found`].
struct Counted {
    kind: StrategyKind,
    shares: [f32; StrategyKind::ALL.len()],
    expected: f32,
    /// Unlearnt, unaimed, and without the sky.
    starts: [f32; 3],
    vertex: u32,
}

impl BlockObserver for Recorder<'_> {
    fn light(&mut self, _: u64) -> &mut dyn Observer {
        let Recorded { work, emitted, .. } = &mut self.recorded;
        work.iter_mut().chain(emitted).for_each(|work| work.walks += 1.0);
        self
    }

    fn lit(&mut self) {
        self.light = std::mem::take(&mut self.recorded);
        self.follower.leave_light();
        self.ends.truncate(1);
    }

    fn camera(&mut self, pixel: usize, start: &CameraStart) -> &mut dyn Observer {
        self.follower.begin(start.hero);
        self.weight = start.weight;
        self.sums.push((pixel as u32, 0.0));
        self.recorded.work.iter_mut().for_each(|work| work.walks += 1.0);
        self
    }
}

impl Observer for Recorder<'_> {
    fn covers(&self, film: Vec2) -> bool {
        self.film.covers(film)
    }

    fn emit(&mut self, start: &EmissionSample, hero: usize) {
        self.follower.emit(start, hero);
        self.is_seen = false;
    }

    fn depart(&mut self, leg: &Leg) {
        self.follower.depart(leg);
        self.ends.truncate(leg.edges as usize + 1);
        let ends = self.ends[self.ends.len() - 1];
        self.reached = WALKS_END.map(|end| f64::from(ends.passed(end, self.survival)));
        self.count(|work| &mut work.segments);
        if leg.edges == 0 {
            self.count(|work| &mut work.begun);
        }
    }

    fn arrive(&mut self, event: Event<'_>) {
        self.follower.arrive(&event);
        self.ends.truncate(event.arrival.edges as usize);
        let before = self.ends[self.ends.len() - 1];
        self.ends.push(before.and(Ends::at(event.survival, self.survival)));
    }

    fn keep(&mut self, place: usize) {
        self.follower.keep(place);
        if let Some(ends) = self.ends.last() {
            put(&mut self.kept[self.follower.hero], place, *ends);
        }
        self.count(|work| &mut work.kept);
    }

    fn stop(&mut self, kind: StrategyKind, _: u32, _: u32) {
        self.count(|work| &mut work.tries[kind as usize]);
    }

    fn contribute(&mut self, s: u32, t: u32, meeting: Meeting<'_>, contribution: Option<&Contribution>) {
        let Some(found) = contribution.filter(|c| c.value.is_finite()) else { return };
        let value = found.value;
        let Counted { kind, shares, expected, starts: [unlearnt, unaimed, without_sky], vertex } =
            self.counted(s, t, &meeting, found);
        let (route, sample) = (self.route(s, t, &meeting), self.sums.len() as u32);
        let found = &mut self.recorded.found;
        let mut add = |pixel: u32, value: Spectrum| {
            let luminance = f64::from(value.luminance());
            let square = luminance * luminance;
            found.push(Found {
                pixel,
                square,
                shares,
                route,
                unlearnt,
                unaimed,
                without_sky,
                kind,
                expected,
                sample,
                vertex,
            });
        };
        if let Meeting::Lens(film) = meeting {
            if !self.is_seen {
                let emitted = f64::from(self.follower.unlearnt());
                self.recorded.work.iter_mut().for_each(|work| work.reaching += 1.0);
                self.recorded.emitted.iter_mut().for_each(|work| work.reaching += emitted);
                self.is_seen = true;
            }
            let add = |pixel, value| add(pixel as u32, value);
            return self.film_samples.splat(self.film, self.pass, film, value, add);
        }
        let value = value * self.weight;
        if let Some((pixel, sum)) = self.sums.last_mut() {
            add(*pixel, value);
            *sum += f64::from(value.luminance());
        }
    }
}

/// What one block of one pass brings.
pub(super) struct Part {
    pub camera: Recorded,
    pub light: Recorded,
    /// Pixels with what camera subpaths contribute to them.
    pub sums: Vec<(u32, f64)>,
}

impl Part {
    /// Segments of all walks, which ended by this one of [`WALKS_END`].
    pub(super) fn segments(&self, run: usize) -> f64 {
        self.camera.work[run].segments + self.light.work[run].segments
    }
}

/// The samples of `block` in `pass` of `compiled`, whose walks end by `survival`.
pub(super) fn part(compiled: &dyn Compiled, survival: Survival, pass: usize, block: usize) -> Part {
    let mut recorder = Recorder::new(compiled, survival, pass);
    compiled.observe(pass, block, &|_| true, &mut recorder);
    Part { camera: recorder.recorded, light: recorder.light, sums: recorder.sums }
}
