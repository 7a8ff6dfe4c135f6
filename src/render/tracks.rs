//! Where walks went: the vertices of the paths that they make, so that it can be learnt which way walks should go.

use crate::{
    bsdf::Transport,
    guide::{Guide, Lesson},
    math::{Vec2, Vec3},
    scene::Scene,
    transport::{
        Interaction, MisSums, Scattering, Strategies, Vertex,
        observer::{Meeting, StrategyKind},
    },
};

/// The camera's, which go towards the light, and the light's.
const WALKS: [Transport; 2] = [Transport::Radiance, Transport::Importance];

/// A vertex of a walk.
#[derive(Clone, Copy, Debug)]
struct Site {
    position: Vec3,
    /// See [`Lesson::normal`].
    normal: Option<Vec3>,
    /// Unit direction to the vertex before.
    incoming: Vec3,
    /// The vertex before, none if that is where the walk set out.
    before: Option<u32>,
    /// See [`Vertex::is_connectible`]; walks go on from others as they must.
    connectible: bool,
    /// Where the walk went on.
    onward: Onward,
}

/// Densities without a guide: of the camera's walk towards the light, and of the light's towards the camera [1/sr]; 0 where they
/// are not known.
type Onward = [f32; 2];

/// Those between `incoming` and `outgoing` where a walk by `transport` came.
fn onward(
    scene: &Scene,
    interaction: &Interaction,
    incoming: Vec3,
    outgoing: Vec3,
    transport: Transport,
) -> Onward {
    let Scattering { pdf_fwd, pdf_rev, .. } = interaction.scatter(scene, incoming, outgoing, transport);
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
    /// Those of the vertices in the cache, per hero channel in the cache's order.
    kept: Vec<Vec<u32>>,
}

/// A path, by the last vertices of the walks that made it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Track {
    camera: Option<u32>,
    light: Option<u32>,
    /// Of both ends.
    onward: [Onward; 2],
    /// Unit direction from the camera's last vertex to what it was connected with.
    towards_light: Vec3,
}

impl Tracks {
    pub fn new(heroes: usize) -> Self {
        Self { kept: vec![Vec::new(); heroes], ..Self::default() }
    }

    /// A walk sets out.
    pub fn begin(&mut self) {
        (self.last, self.at) = (None, None);
    }

    pub fn arrive<S: MisSums>(&mut self, scene: &Scene, transport: Transport, vertex: &Vertex<S>) {
        if let (Some(last), Some((before, incoming))) = (self.last, self.at) {
            let outgoing = -vertex.subpath.incoming;
            self.sites[last as usize].onward = onward(scene, &before, incoming, outgoing, transport);
        }
        let normal = vertex.interaction.normal();
        let (incoming, connectible) = (vertex.subpath.incoming, vertex.is_connectible(scene));
        self.sites.push(Site {
            position: vertex.position(),
            normal,
            incoming,
            before: self.last,
            connectible,
            onward: [0.0; 2],
        });
        self.at = Some((vertex.interaction, incoming));
        self.last = Some(self.sites.len() as u32 - 1);
    }

    /// The last vertex was added to the cache of `hero`.
    pub fn keep(&mut self, hero: usize) {
        self.kept[hero].extend(self.last);
    }

    /// The path that walks of `hero` made; none where nothing is to be learnt from it.
    pub fn track<S: MisSums>(&self, scene: &Scene, meeting: &Meeting<'_, S>, hero: usize) -> Option<Track> {
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
            Meeting::Met(subpath, _) => -subpath.incoming,
            Meeting::Emitter(sample) => sample.point.seen_from(from)?.0,
            Meeting::Light(_, other) => (other.position() - from).try_normalize()?,
            Meeting::Pivot(..) => return None,
        };
        let near = onward(scene, &here, incoming, towards_light, Transport::Radiance);
        let (light, far) = match meeting {
            Meeting::Light(index, other) => {
                let (there, back) = (&other.interaction, other.subpath.incoming);
                let far = onward(scene, there, back, -towards_light, Transport::Importance);
                (Some(self.kept[hero][*index]), far)
            }
            _ => (None, [0.0; 2]),
        };
        Some(Track { camera, light, onward: [near, far], towards_light })
    }

    /// The vertices between `last` and where its walk set out, from `last` on.
    fn back(&self, last: Option<u32>) -> impl Iterator<Item = &Site> {
        let site = |index: u32| &self.sites[index as usize];
        std::iter::successors(last.map(site), move |at| at.before.map(site))
    }

    /// What a path tells that counts for `weight`, shared between `strategies` as `shares` say, as one of the lessons of `fold`.
    pub fn lessons(
        &self,
        track: &Track,
        shares: &Shares,
        (weight, fold): (f32, usize),
        mut take: impl FnMut(Lesson),
    ) {
        let sites = self.sites(track);
        let count = sites.len();
        for (index, (site, onward, directions)) in sites.into_iter().enumerate() {
            let Site { position, normal, .. } = *site;
            let shares = [shares.camera(index, count), shares.light(index, count)];
            for (own, transport) in WALKS.into_iter().enumerate() {
                let (direction, unguided, weight) = (directions[own], onward[own], weight * shares[own]);
                if site.connectible && weight > 0.0 {
                    take(Lesson { position, normal, transport, direction, weight, unguided, fold });
                }
            }
        }
    }

    /// How often strategies make a path without `guide`, over how often they do with it, as `shares` of them say.
    pub fn unguided(&self, track: &Track, shares: &Shares, guide: &Guide) -> f64 {
        let sites = self.sites(track);
        let Shares { hit, next_event, connection, lens, .. } = *shares;
        let by = [hit + next_event + connection, connection + lens];
        let ratios = |(site, onward, directions): (&Site, Onward, [Vec3; 2])| {
            if !site.connectible {
                return [1.0; 2];
            }
            let cell = guide.cell(site.position, site.normal);
            [0, 1].map(|own| {
                let ratio = || guide.ratio(cell, WALKS[own], (site.position, directions[own]), onward[own]);
                if by[own] > 0.0 { 1.0 / f64::from(ratio()) } else { 1.0 }
            })
        };
        shares.made(&sites.into_iter().map(ratios).collect::<Vec<_>>())
    }

    /// From the emitter to the lens, each with the directions to the light and to the camera.
    fn sites(&self, track: &Track) -> Vec<(&Site, Onward, [Vec3; 2])> {
        let mut sites: Vec<(&Site, Onward, [Vec3; 2])> = Vec::new();
        let [near, far] = track.onward;
        let mut next = (-track.towards_light, Some(far));
        for site in self.back(track.light) {
            sites.push((site, next.1.unwrap_or(site.onward), [site.incoming, next.0]));
            next = (-site.incoming, None);
        }
        sites.reverse();
        let mut next = (track.towards_light, Some(near));
        for site in self.back(track.camera) {
            sites.push((site, next.1.unwrap_or(site.onward), [next.0, site.incoming]));
            next = (-site.incoming, None);
        }
        sites
    }
}

/// What kinds of strategies make of a path, together 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shares {
    hit: f32,
    next_event: f32,
    connection: f32,
    lens: f32,
    /// What they make of it, over what all strategies do.
    pub of_all: f32,
}

impl Shares {
    /// Those of `strategies` among `shares` in the weights; none where they make nothing of it.
    pub fn of(shares: &[f32; StrategyKind::ALL.len()], strategies: Strategies) -> Option<Self> {
        let of = |kind| if strategies.has(kind) { shares[kind as usize] } else { 0.0 };
        let [hit, next_event, connection, lens, _] = StrategyKind::each(of);
        let sum = hit + next_event + connection + lens;
        let [hit, next_event, connection, lens] =
            [hit, next_event, connection, lens].map(|share| share / sum);
        (sum > 0.0).then_some(Self { hit, next_event, connection, lens, of_all: sum })
    }

    /// By how much the strategies together make a path more often if walks leave each of its vertices, from the emitter to the
    /// lens, so much more often: those of the camera towards the light, and those of the light.
    fn made(&self, ratios: &[[f64; 2]]) -> f64 {
        let count = ratios.len();
        let by_camera =
            |from: usize| ratios[from.min(count)..].iter().map(|[camera, _]| camera).product::<f64>();
        let by_light = |to: usize| ratios[..to].iter().map(|[_, light]| light).product::<f64>();
        let connections: f64 = (1..count).map(|index| by_light(index - 1) * by_camera(index + 1)).sum();
        let last = count.saturating_sub(1);
        f64::from(self.hit) * by_camera(0)
            + f64::from(self.next_event) * by_camera(1)
            + f64::from(self.connection) * connections / last.max(1) as f64
            + f64::from(self.lens) * by_light(last)
    }

    /// Of the strategies by which a camera subpath goes on from vertex `index` to the one before it, if there are so many
    /// between emitter and lens. Connections are taken to be alike.
    fn camera(&self, index: usize, vertices: usize) -> f32 {
        match index {
            0 => self.hit,
            _ => self.hit + self.next_event + self.connection * (index - 1) as f32 / (vertices - 1) as f32,
        }
    }

    /// The same of light subpaths that go on to the next vertex.
    fn light(&self, index: usize, vertices: usize) -> f32 {
        match vertices - 1 - index {
            0 => 0.0,
            after => self.lens + self.connection * (after - 1) as f32 / (vertices - 1) as f32,
        }
    }
}
