//! Real walks, and what the fast code says about every path that their connections make.

use super::path::{APERTURE, Node, Path, Place};
use crate::{
    bsdf::Transport,
    math::{Channels, Vec2, Vec3, vec2},
    sampling::Stream,
    scene::{
        Scene,
        lights::{EmissionSample, EmitterSample},
    },
    transport::{
        Estimator, LightCache,
        cache::Partners,
        camera_path::{self, CameraPath},
        equiangular::FirstCollision,
        interaction::Interaction,
        light_path::{self, LightPath},
        mis::MisSums,
        observer::{Contribution, Meeting, Observer, Sum},
        profile::Profile,
        segment::Passed,
        strategy::StrategyKind,
        vertex::{Subpath, Vertex},
        walk::{Departure, Kind, Visitor, cross, walk},
    },
};

/// A path, and the weight that the fast code gave it.
pub(super) struct Case {
    /// None where the reference cannot determine what lies along it.
    pub path: Option<Path>,
    pub strategy: usize,
    pub hero: usize,
    pub weight: f32,
}

/// A film that reaches a little further than the image.
pub(super) struct WideFilm;

impl Observer for WideFilm {
    fn covers(&self, film: Vec2) -> bool {
        (film - vec2(8.0, 6.0)).abs().max_element() < 12.0
    }
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_>, _: Option<&Contribution>) {}
}

/// Remembers where a walk went.
pub(super) struct Trail<V, S: MisSums> {
    visitor: V,
    pub vertices: Vec<Vertex<S>>,
    pub escaped: Option<Subpath<S>>,
    /// What flights passed, after how many vertices.
    passed: Vec<(usize, Departure<S>, Passed<S::Channels>)>,
}

impl<V, S: MisSums> Trail<V, S> {
    fn new(visitor: V) -> Self {
        Self { visitor, vertices: Vec::new(), escaped: None, passed: Vec::new() }
    }
}

impl<P: Profile, V: Visitor<P>> Visitor<P> for Trail<V, P::MisSums> {
    fn kind(edges: u32) -> StrategyKind {
        V::kind(edges)
    }
    fn connections(&self, edges: u32, position: Vec3) -> f32 {
        self.visitor.connections(edges, position)
    }
    fn reach(&mut self, vertex: &Vertex<P::MisSums>) {
        self.vertices.push(*vertex);
    }
    fn arrive(&mut self, _: &Vertex<P::MisSums>, _: &mut Stream) {}
    fn pass(&mut self, departure: &Departure<P::MisSums>, passed: &Passed<P::Channels>, _: &mut Stream) {
        self.passed.push((self.vertices.len(), *departure, *passed));
    }
    fn escape(&mut self, subpath: &Subpath<P::MisSums>) {
        self.escaped = Some(*subpath);
    }
}

/// A camera subpath through `film`.
pub(super) fn camera_walk<'a, P: Profile>(
    estimator: &'a Estimator<'a, P>,
    film: Vec2,
    hero: usize,
    stream: &mut Stream,
) -> Trail<CameraPath<'a, P, Sum>, P::MisSums> {
    let kind = Kind::of_camera(estimator, hero);
    let departure = camera_path::depart(estimator, film, APERTURE);
    let mut trail = Trail::new(CameraPath::new(estimator, Partners::NONE, hero, Sum::default()));
    walk::<P>(estimator.scene, kind, departure, &mut trail, stream);
    let first = trail.vertices.first();
    trail.visitor.first =
        first.and_then(|vertex| FirstCollision::of(vertex, departure.position, departure.pdf_fwd));
    trail
}

/// The light subpath of `visitor`.
fn light_walk<'a, P: Profile>(
    visitor: LightPath<'a, P, WideFilm>,
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
    hero: usize,
    stream: &mut Stream,
) -> Trail<LightPath<'a, P, WideFilm>, P::MisSums> {
    let max_edges = estimator.max_edges.saturating_sub(1);
    let kind = Kind { transport: Transport::Importance, max_edges, ..Kind::of_camera(estimator, hero) };
    let mut trail = Trail::new(visitor);
    walk::<P>(estimator.scene, kind, light_path::depart(estimator, start), &mut trail, stream);
    trail
}

/// Every path that one camera subpath through `film` and one light subpath make, with its fast weight.
pub(super) fn cases<P: Profile>(
    estimator: &Estimator<'_, P>,
    film: Vec2,
    hero: usize,
    stream: &mut Stream,
) -> Vec<Case> {
    let camera = camera_walk(estimator, film, hero, stream);
    let mut cases = Cases { scene: estimator.scene, hidden: estimator.hide_emitters, hero, all: Vec::new() };
    of_eye(estimator, &camera, &mut cases, stream);
    of_pivots(estimator, film, &camera.visitor, &mut cases, stream);
    let Some(start) = light_path::begin(estimator, stream) else { return cases.all };
    let (mut kept, mut film) = (LightCache::new(P::Channels::COUNT), WideFilm);
    let visitor = LightPath::new(estimator, &mut kept, &mut film, start, hero);
    let trail = light_walk(visitor, estimator, &start, hero, stream);
    of_light(estimator, &start, &trail, &mut cases, stream);
    of_both(estimator, &camera, &start, &trail.vertices, &mut cases, stream);
    cases.all
}

/// Paths of at least `length` vertices: one by next-event estimation, one by a connection, one by the lens.
pub(super) fn long_cases<P: Profile>(
    estimator: &Estimator<'_, P>,
    length: usize,
    stream: &mut Stream,
) -> Vec<Case> {
    let scene = estimator.scene;
    let mut kept = LightCache::new(P::Channels::COUNT);
    let camera = camera_walk(estimator, vec2(8.0, 6.0), 0, stream);
    let start = scene.lights.sample_emission(&scene.geometry, None, stream).unwrap();
    let mut film = WideFilm;
    let light =
        light_walk(LightPath::new(estimator, &mut kept, &mut film, start, 0), estimator, &start, 0, stream);
    let mut cases = Cases { scene, hidden: estimator.hide_emitters, hero: 0, all: Vec::new() };
    let last = &camera.vertices[length - 1];
    let sample = (0..100)
        .find_map(|_| scene.lights.sample_emitter(&scene.geometry, last.position(), estimator.aim(), stream))
        .unwrap();
    let of_eye = |count| chain(&camera.vertices[..count], false);
    let of_light = |count| chain(&light.vertices[..count], false);
    cases.add(
        emitter_of(&sample),
        Vec::new(),
        of_eye(length),
        camera.visitor.join_emitter(last, &sample, stream),
    );
    let half = length / 2;
    let contribution =
        camera.visitor.connect_with(&camera.vertices[half - 1], &light.vertices[half - 1], stream);
    cases.add(start_of(&start), of_light(half), of_eye(half), contribution);
    let seen = light.visitor.connect_to_lens(&light.vertices[length - 1], APERTURE, stream);
    cases.add(start_of(&start), of_light(length), Vec::new(), seen.map(|(_, contribution)| contribution));
    cases.all
}

struct Cases<'a> {
    scene: &'a Scene,
    /// The lens does not see emitters.
    hidden: bool,
    hero: usize,
    all: Vec<Case>,
}

impl Cases<'_> {
    /// A path from an emitter by `light`, in walking order, to the lens by `camera`, in walking order.
    fn add(
        &mut self,
        emitter: (u32, Place),
        light: Vec<Node>,
        camera: Vec<Node>,
        contribution: Option<Contribution>,
    ) {
        let Some(Contribution { weight, .. }) = contribution else { return };
        let (index, place) = emitter;
        let strategy = light.len() + 1;
        let mut nodes = vec![Node::emitter(self.scene, index, place)];
        nodes.extend(light);
        nodes.extend(camera.into_iter().rev());
        nodes.push(Node::lens(self.scene));
        let path = Path::through(self.scene, self.hidden, index, nodes);
        self.all.push(Case { path, strategy, hero: self.hero, weight });
    }

    /// The same where the camera subpath made all of it.
    fn add_hit(&mut self, emitter: (u32, Place), camera: Vec<Node>, contribution: Option<Contribution>) {
        self.add_by(0, emitter, camera, contribution);
    }

    /// The same by the strategy of this number.
    fn add_by(
        &mut self,
        strategy: usize,
        emitter: (u32, Place),
        camera: Vec<Node>,
        contribution: Option<Contribution>,
    ) {
        let before = self.all.len();
        self.add(emitter, Vec::new(), camera, contribution);
        self.all[before..].iter_mut().for_each(|case| case.strategy = strategy);
    }
}

/// The vertices of a walk; `dirac` says how the last one scatters.
fn chain<S: MisSums>(vertices: &[Vertex<S>], dirac: bool) -> Vec<Node> {
    let node = |(index, vertex): (usize, &Vertex<S>)| Node {
        place: match vertex.interaction {
            Interaction::Surface(point) => Place::Surface(point),
            Interaction::Medium(position, _) => Place::Volume(position),
        },
        medium: vertex.subpath.medium,
        dirac: vertices.get(index + 1).map_or(dirac, |next| next.subpath.after_dirac),
    };
    vertices.iter().enumerate().map(node).collect()
}

fn of_eye<P: Profile>(
    estimator: &Estimator<'_, P>,
    camera: &Trail<CameraPath<'_, P, Sum>, P::MisSums>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    let scene = estimator.scene;
    let mut previous = Node::lens(scene).position();
    for (index, vertex) in camera.vertices.iter().enumerate() {
        if !P::NULLS
            && let Interaction::Surface(point) = vertex.interaction
            && let Some(light) = scene.surface(point.shape).emitter
            && let Some(sample) =
                scene.lights.surface_hit(&scene.geometry, light, &point, previous, estimator.sky)
        {
            let before = chain(&camera.vertices[..index], vertex.subpath.after_dirac);
            cases.add_hit(
                (light, Place::Surface(point)),
                before,
                camera.visitor.emitter_hit(&vertex.subpath, &sample, previous),
            );
        }
        if can_join(estimator, vertex)
            && estimator.counts.next_event > 0.0
            && let Some(sample) =
                scene.lights.sample_emitter(&scene.geometry, vertex.position(), estimator.aim(), stream)
        {
            let contribution = camera.visitor.join_emitter(vertex, &sample, stream);
            cases.add(
                emitter_of(&sample),
                Vec::new(),
                chain(&camera.vertices[..=index], false),
                contribution,
            );
        }
        previous = vertex.position();
    }
    of_flights(estimator, camera, cases, stream);
    if let Some(subpath) = &camera.escaped
        && let Some(sample) = scene.lights.infinity_hit(-subpath.incoming, previous, estimator.aim())
    {
        let before = chain(&camera.vertices, subpath.after_dirac);
        cases.add_hit(emitter_of(&sample), before, camera.visitor.emitter_hit(subpath, &sample, previous));
    }
}

/// Emitters that are met on the flights of the camera subpath: points of emissive media, and of shapes.
fn of_flights<P: Profile>(
    estimator: &Estimator<'_, P>,
    camera: &Trail<CameraPath<'_, P, Sum>, P::MisSums>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    let Scene { lights, geometry, .. } = estimator.scene;
    for (count, departure, passed) in &camera.passed {
        let met = match passed {
            Passed::Medium(part) => lights.of_medium(part.medium).and_then(|(light, emission)| {
                let (t, _) = emission
                    .sample_along(&part.emitting(&estimator.scene.media[part.medium.0 as usize]), stream)?;
                camera.visitor.meet(departure, part, light, t, stream)
            }),
            Passed::Emitter(crossing) => {
                let (light, from) = (crossing.light, departure.position);
                let sample = lights.surface_hit(geometry, light, &crossing.point, from, estimator.sky);
                cross::<P>(departure, crossing, cases.hero).zip(sample)
            }
        };
        if let Some((subpath, sample)) = met {
            let before = chain(&camera.vertices[..*count], departure.dirac);
            cases.add_hit(
                emitter_of(&sample),
                before,
                camera.visitor.emitter_hit(&subpath, &sample, departure.position),
            );
        }
    }
}

/// Equiangular sampling, along the same ray.
fn of_pivots<P: Profile>(
    estimator: &Estimator<'_, P>,
    film: Vec2,
    camera: &CameraPath<'_, P, Sum>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    let departure = camera_path::depart(estimator, film, APERTURE);
    if estimator.counts.equiangular > 0.0
        && let Some((vertex, sample)) = camera.pick_equiangular(&departure, stream)
    {
        let contribution = camera.join_equiangular(&vertex, &sample, stream);
        cases.add_by(3, emitter_of(&sample), chain(&[vertex], false), contribution);
    }
}

fn can_join<P: Profile>(estimator: &Estimator<'_, P>, vertex: &Vertex<P::MisSums>) -> bool {
    vertex.subpath.edges < estimator.max_edges && vertex.is_connectible(estimator.scene)
}

fn of_light<P: Profile>(
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
    light: &Trail<LightPath<'_, P, WideFilm>, P::MisSums>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    if estimator.counts.lens <= 0.0 {
        return;
    }
    let contribution =
        light.visitor.connect_start_to_lens(APERTURE, stream).map(|(_, contribution)| contribution);
    cases.add(start_of(start), Vec::new(), Vec::new(), contribution);
    for (index, vertex) in light.vertices.iter().enumerate() {
        if vertex.is_connectible(estimator.scene) {
            let contribution =
                light.visitor.connect_to_lens(vertex, APERTURE, stream).map(|(_, contribution)| contribution);
            cases.add(start_of(start), chain(&light.vertices[..=index], false), Vec::new(), contribution);
        }
    }
}

fn of_both<P: Profile>(
    estimator: &Estimator<'_, P>,
    camera: &Trail<CameraPath<'_, P, Sum>, P::MisSums>,
    start: &EmissionSample,
    light: &[Vertex<P::MisSums>],
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    if estimator.counts.connection <= 0.0 || light.is_empty() {
        return;
    }
    for (index, vertex) in camera.vertices.iter().enumerate() {
        let other = stream.below(light.len());
        let (ours, theirs) = (can_join(estimator, vertex), light[other].is_connectible(estimator.scene));
        if ours && theirs && vertex.subpath.edges + light[other].subpath.edges < estimator.max_edges {
            let contribution = camera.visitor.connect_with(vertex, &light[other], stream);
            let (camera, light) = (chain(&camera.vertices[..=index], false), chain(&light[..=other], false));
            cases.add(start_of(start), light, camera, contribution);
        }
    }
}

fn start_of(start: &EmissionSample) -> (u32, Place) {
    (start.light, Place::of(start.light, &start.point))
}

/// The emitter of a sample and its vertex.
fn emitter_of(sample: &EmitterSample) -> (u32, Place) {
    (sample.light, Place::of(sample.light, &sample.point))
}
