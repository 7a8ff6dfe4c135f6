//! The vertices of walks and of the paths that they make, from which a guide learns directions.

use crate::{
    bsdf::Transport,
    guide::{Guide, Lesson},
    math::{Vec2, Vec3},
    scene::Scene,
    transport::{
        Event, Interaction, Scattering, Strategies,
        observer::{Meeting, put},
        profiles::Everything,
        strategy::StrategyKind,
    },
};

/// Camera subpaths, which go towards the light, and light subpaths.
const WALKS: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// A vertex of a walk.
#[derive(Clone, Copy, Debug)]
struct Site {
    /// Of the walk.
    transport: Transport,
    position: Vec3,
    /// See [`Lesson::normal`].
    normal: Option<Vec3>,
    /// Unit direction to the vertex before.
    incoming: Vec3,
    /// The vertex before, none if that is where the walk set out.
    before: Option<u32>,
    /// See [`Event::is_connectible`]; from other vertices walks go on as they must.
    connectible: bool,
    /// Densities of the direction in which the walk went on.
    onward: Onward,
}

impl Site {
    /// The directions to the light and to the camera, of a path that leaves this vertex in unit direction `outgoing`.
    fn directions(&self, outgoing: Vec3) -> [Vec3; 2] {
        match self.transport {
            Transport::Radiance => [outgoing, self.incoming],
            Transport::Importance => [self.incoming, outgoing],
        }
    }
}

/// Densities without a guide: of a camera subpath towards the light, and of a light subpath towards the camera (1/sr);
/// 0 where unknown.
type Onward = [f32; 2];

/// The densities where a walk by `transport` came from `incoming` and its path leaves to `outgoing`.
fn onward(
    scene: &Scene,
    interaction: &Interaction,
    incoming: Vec3,
    outgoing: Vec3,
    transport: Transport,
) -> Onward {
    let Scattering { pdf_fwd, pdf_rev, .. } =
        interaction.scatter::<Everything>(scene, incoming, outgoing, transport);
    match transport {
        Transport::Radiance => [pdf_fwd, pdf_rev],
        Transport::Importance => [pdf_rev, pdf_fwd],
    }
}

/// The vertices of all walks of a block.
#[derive(Default)]
pub(super) struct Tracks {
    sites: Vec<Site>,
    /// The last vertex of the walk at hand.
    last: Option<u32>,
    at: Option<(Interaction, Vec3)>,
    /// The vertices in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<u32>>,
}

/// A path, by the last vertices of the walks that made it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    camera: Option<u32>,
    light: Option<u32>,
    /// Of both ends.
    onward: [Onward; 2],
    /// Unit direction from the last camera vertex to the other end of the connection.
    towards_light: Vec3,
}

impl Tracks {
    pub(super) fn new(heroes: usize) -> Self {
        Self { kept: vec![Vec::new(); heroes], ..Self::default() }
    }

    /// A walk sets out.
    pub(super) fn begin(&mut self) {
        (self.last, self.at) = (None, None);
    }

    pub(super) fn arrive(&mut self, scene: &Scene, transport: Transport, event: &Event<'_>) {
        if let (Some(last), Some((before, incoming))) = (self.last, self.at) {
            let outgoing = -event.arrival.incoming;
            self.sites[last as usize].onward = onward(scene, &before, incoming, outgoing, transport);
        }
        let normal = event.interaction.normal();
        let (incoming, connectible) = (event.arrival.incoming, event.is_connectible(scene));
        self.sites.push(Site {
            transport,
            position: event.position(),
            normal,
            incoming,
            before: self.last,
            connectible,
            onward: [0.0; 2],
        });
        self.at = Some((*event.interaction, incoming));
        self.last = Some(self.sites.len() as u32 - 1);
    }

    /// The last vertex was added to the cache of `hero`.
    pub(super) fn keep(&mut self, hero: usize, place: usize) {
        if let Some(last) = self.last {
            put(&mut self.kept[hero], place, last);
        }
    }

    /// The path that walks of `hero` made; none where nothing is to be learnt from it.
    pub(super) fn track(&self, scene: &Scene, meeting: &Meeting<'_>, hero: usize) -> Option<Track> {
        let (camera, (here, incoming)) = (self.last, self.at?);
        let from = here.position();
        let towards_light = match meeting {
            Meeting::Lens(_) => {
                let seen = scene.sensor.project(from, Vec2::splat(0.5))?.ray.direction;
                let end = onward(scene, &here, incoming, -seen, Transport::Importance);
                return Some(Track {
                    camera: None,
                    light: camera,
                    onward: [[0.0; 2], end],
                    towards_light: seen,
                });
            }
            Meeting::Met(arrival, _) => -arrival.incoming,
            Meeting::Emitter(sample) => sample.point.seen_from(from)?.0,
            Meeting::Bent { towards, .. } => *towards,
            Meeting::Light(_, other) => (other.position() - from).try_normalize()?,
            Meeting::Pivot(..) => return None,
        };
        let near = onward(scene, &here, incoming, towards_light, Transport::Radiance);
        let (light, far) = match meeting {
            Meeting::Light(index, other) => {
                let (there, back) = (other.interaction, other.arrival.incoming);
                let far = onward(scene, there, back, -towards_light, Transport::Importance);
                (Some(self.kept[hero][*index]), far)
            }
            _ => (None, [0.0; 2]),
        };
        Some(Track { camera, light, onward: [near, far], towards_light })
    }

    /// The lessons, in `fold`, of a path that counts for `weight` and has these `shares` of strategies. `take` gets the
    /// weight of each lesson, and the lesson itself on request.
    pub(super) fn lessons(
        &self,
        track: &Track,
        shares: &Shares,
        (weight, fold): (f32, usize),
        mut take: impl FnMut(f32, &dyn Fn() -> Lesson),
    ) {
        let path = self.path(track);
        for (index, at) in path.iter().enumerate() {
            let site = &self.sites[*at as usize];
            let shares = [shares.camera(index, path.len()), shares.light(index, path.len())];
            for (own, transport) in WALKS.into_iter().enumerate() {
                let weight = weight * shares[own];
                let lesson = || {
                    let Site { position, normal, .. } = *site;
                    let (onward, directions) = self.way(track, *at);
                    let (direction, unguided) = (directions[own], onward[own]);
                    Lesson { position, normal, transport, direction, weight, unguided, fold }
                };
                if site.connectible && weight > 0.0 {
                    take(weight, &lesson);
                }
            }
        }
    }

    /// For each vertex that a walk left: the density of its direction, by `strategies`, without `guide` over that with
    /// it.
    pub(super) fn known<'a>(&self, guide: &'a Guide, strategies: Strategies) -> Known<'a> {
        let by_camera = strategies.emitter_hit || strategies.next_event || strategies.connection;
        let walks = [by_camera, strategies.connection || strategies.lens];
        let mut known = Known { guide, walks, ratios: Vec::new() };
        let goes_on = |index: usize| self.sites.get(index + 1).is_some_and(|next| next.before.is_some());
        let ratios = |(index, site): (usize, &Site)| {
            if goes_on(index) { known.at(site, self.walk(index as u32)) } else { [1.0; 2] }
        };
        known.ratios = self.sites.iter().enumerate().map(ratios).collect();
        known
    }

    /// The density of a path by all strategies without a guide over that with the `known` one, for these `shares` of
    /// strategies.
    pub(super) fn unguided(&self, track: &Track, shares: &Shares, known: &Known<'_>) -> f64 {
        let ratios = |at: u32| {
            let index = at as usize;
            if track.ends_at(at) {
                known.at(&self.sites[index], self.way(track, at))
            } else {
                known.ratios[index]
            }
        };
        shares.made(&self.path(track).into_iter().map(ratios).collect::<Vec<_>>())
    }

    /// The vertices from the emitter to the lens.
    fn path(&self, track: &Track) -> Vec<u32> {
        let back = |last| std::iter::successors(last, |at: &u32| self.sites[*at as usize].before);
        let mut path = Vec::with_capacity(USUAL);
        path.extend(back(track.light));
        path.reverse();
        path.extend(back(track.camera));
        path
    }

    /// At vertex `at` of a path: the densities, and the unit directions to the light and to the camera.
    fn way(&self, track: &Track, at: u32) -> Way {
        let [near, far] = track.onward;
        let site = &self.sites[at as usize];
        match Some(at) {
            end if end == track.camera => (near, site.directions(track.towards_light)),
            end if end == track.light => (far, site.directions(-track.towards_light)),
            _ => self.walk(at),
        }
    }

    /// The same of the walk, which goes on from there to the next vertex.
    fn walk(&self, at: u32) -> Way {
        let [site, next] = [at, at + 1].map(|at| &self.sites[at as usize]);
        (site.onward, site.directions(-next.incoming))
    }
}

type Way = (Onward, [Vec3; 2]);

/// Vertices of a path for which memory is reserved.
const USUAL: usize = 16;

impl Track {
    /// True if one of the walks that made it ends at vertex `at`.
    fn ends_at(&self, at: u32) -> bool {
        [self.camera, self.light].contains(&Some(at))
    }
}

/// Densities with which walks go on without a guide, over those with it.
pub(super) struct Known<'a> {
    guide: &'a Guide,
    /// Whether camera subpaths matter, and whether light subpaths do.
    walks: [bool; 2],
    /// For each vertex; 1 where no walk goes on.
    ratios: Vec<[f64; 2]>,
}

impl Known<'_> {
    /// The ratios of both walks.
    fn at(&self, site: &Site, (onward, directions): Way) -> [f64; 2] {
        if !site.connectible {
            return [1.0; 2];
        }
        let cell = self.guide.cell(site.position, site.normal);
        let ratio = |own: usize| {
            let way = (site.position, directions[own]);
            1.0 / f64::from(self.guide.ratio(cell, WALKS[own], way, onward[own]))
        };
        [0, 1].map(|own| if self.walks[own] { ratio(own) } else { 1.0 })
    }
}

/// The shares of kinds of strategies in a path; they sum to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    hit: f32,
    next_event: f32,
    connection: f32,
    lens: f32,
    /// Their sum as a share of all strategies.
    pub of_all: f32,
}

impl Shares {
    /// The shares of `strategies` among all `shares` in the weights; none where these are 0.
    pub(super) fn of(shares: &[f32; StrategyKind::ALL.len()], strategies: Strategies) -> Option<Self> {
        let of = |kind| if strategies.has(kind) { shares[kind as usize] } else { 0.0 };
        let [hit, next_event, connection, lens, _] = StrategyKind::each(of);
        let sum = hit + next_event + connection + lens;
        let [hit, next_event, connection, lens] =
            [hit, next_event, connection, lens].map(|share| share / sum);
        (sum > 0.0).then_some(Self { hit, next_event, connection, lens, of_all: sum })
    }

    /// The factor on the density of a path by all strategies, given factors at each of its vertices, from the emitter
    /// to the lens: of camera subpaths towards the light, and of light subpaths towards the camera.
    fn made(&self, ratios: &[[f64; 2]]) -> f64 {
        let count = ratios.len();
        let mut by_camera = vec![1.0; count + 1];
        for (index, [camera, _]) in ratios.iter().enumerate().rev() {
            by_camera[index] = camera * by_camera[index + 1];
        }
        let (mut by_light, mut connections) = (1.0, 0.0);
        for index in 1..count {
            connections += by_light * by_camera[index + 1];
            by_light *= ratios[index - 1][1];
        }
        f64::from(self.hit) * by_camera[0]
            + f64::from(self.next_event) * by_camera[1.min(count)]
            + f64::from(self.connection) * connections / count.saturating_sub(1).max(1) as f64
            + f64::from(self.lens) * by_light
    }

    /// Share of the strategies whose camera subpath goes on from vertex `index` to the one before it, with so many
    /// `vertices` between emitter and lens. All connections are taken to have equal shares.
    fn camera(&self, index: usize, vertices: usize) -> f32 {
        match index {
            0 => self.hit,
            _ => self.hit + self.next_event + self.connection * (index - 1) as f32 / (vertices - 1) as f32,
        }
    }

    /// The same for light subpaths that go on to the next vertex.
    fn light(&self, index: usize, vertices: usize) -> f32 {
        match vertices - 1 - index {
            0 => 0.0,
            after => self.lens + self.connection * (after - 1) as f32 / (vertices - 1) as f32,
        }
    }
}
