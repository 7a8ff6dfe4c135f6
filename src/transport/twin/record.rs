//! Real walks, and what the fast code says about every path that their joins make.

use super::path::{APERTURE, Node, Path, Place};
use crate::{
    bsdf::Transport,
    math::{Lanes, Vec2, Vec3, vec2},
    sampling::Stream,
    scene::{
        Scene,
        lights::{EmissionSample, EmitterSample},
    },
    transport::{
        Estimator, LightCache,
        connect::Joined,
        eye::{self, Eye},
        light::{self, Light},
        profile::Profile,
        record::{Meeting, Recorder, Sum},
        segment::{FlightPart, Interaction},
        vertex::{Subpath, Vertex},
        walk::{Departure, Kind, Visitor, walk},
        weight::Sums,
    },
};

/// A path, and the weight that the fast code gave it.
pub struct Case {
    /// None where the twin cannot tell what lies along it.
    pub path: Option<Path>,
    pub strategy: usize,
    pub hero: usize,
    pub weight: f32,
}

/// A film that reaches a little further than the image.
pub struct WideFilm;

impl<S: Sums> Recorder<S> for WideFilm {
    fn covers(&self, film: Vec2) -> bool {
        (film - vec2(8.0, 6.0)).abs().max_element() < 12.0
    }
    fn contribute(&mut self, _: u32, _: u32, _: Meeting<'_, S>, _: Option<&Joined>) {}
}

/// Remembers where a walk went.
pub struct Trail<V, S: Sums> {
    visitor: V,
    pub vertices: Vec<Vertex<S>>,
    pub escaped: Option<Subpath<S>>,
    /// What media were flown through, after how many vertices.
    parts: Vec<(usize, Departure<S>, FlightPart<S::Lanes>)>,
}

impl<V, S: Sums> Trail<V, S> {
    fn new(visitor: V) -> Self {
        Self { visitor, vertices: Vec::new(), escaped: None, parts: Vec::new() }
    }
}

impl<P: Profile, V: Visitor<P>> Visitor<P> for Trail<V, P::Sums> {
    fn joins(&self, edges: u32, position: Vec3) -> f32 {
        self.visitor.joins(edges, position)
    }
    fn arrive(&mut self, vertex: &Vertex<P::Sums>, _: &mut Stream) {
        self.vertices.push(*vertex);
    }
    fn pass(&mut self, departure: &Departure<P::Sums>, part: &FlightPart<P::Lanes>, _: &mut Stream) {
        self.parts.push((self.vertices.len(), *departure, *part));
    }
    fn escape(&mut self, subpath: &Subpath<P::Sums>) {
        self.escaped = Some(*subpath);
    }
}

/// An eye walk through `film`.
pub fn eye_walk<'a, P: Profile>(
    estimator: &'a Estimator<'a, P>,
    cache: &'a LightCache<P::Sums>,
    film: Vec2,
    hero: usize,
    stream: &mut Stream,
) -> Trail<Eye<'a, P, Sum>, P::Sums> {
    let kind = Kind { transport: Transport::Radiance, hero, max_edges: estimator.max_edges };
    let departure = eye::depart(estimator, film, APERTURE);
    let mut trail = Trail::new(Eye::new(estimator, cache, hero, departure.position, Sum::default()));
    walk::<P>(estimator.scene, kind, departure, &mut trail, stream);
    trail
}

/// The light walk of `visitor`.
fn light_walk<'a, P: Profile>(
    visitor: Light<'a, P, WideFilm>,
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
    hero: usize,
    stream: &mut Stream,
) -> Trail<Light<'a, P, WideFilm>, P::Sums> {
    let max_edges = estimator.max_edges.saturating_sub(1);
    let kind = Kind { transport: Transport::Importance, hero, max_edges };
    let mut trail = Trail::new(visitor);
    walk::<P>(estimator.scene, kind, light::depart(estimator, start), &mut trail, stream);
    trail
}

/// Every path that one eye walk through `film` and one light walk make, with its fast weight.
pub fn cases<P: Profile>(
    estimator: &Estimator<'_, P>,
    film: Vec2,
    hero: usize,
    stream: &mut Stream,
) -> Vec<Case> {
    let cache = LightCache::new(P::Lanes::COUNT);
    let eye = eye_walk(estimator, &cache, film, hero, stream);
    let mut cases = Cases { scene: estimator.scene, hidden: estimator.hide_emitters, hero, all: Vec::new() };
    of_eye(estimator, &eye, &mut cases, stream);
    let Some(start) = light::begin::<P>(estimator.scene, stream) else { return cases.all };
    let (mut kept, mut film) = (LightCache::new(P::Lanes::COUNT), WideFilm);
    let visitor = Light::new(estimator, &mut kept, &mut film, start, hero);
    let trail = light_walk(visitor, estimator, &start, hero, stream);
    of_light(estimator, &start, &trail, &mut cases, stream);
    of_both(estimator, &eye, &start, &trail.vertices, &mut cases, stream);
    cases.all
}

/// Paths of at least `length` vertices: one by next-event estimation, one by a join, one by the lens.
pub fn long_cases<P: Profile>(estimator: &Estimator<'_, P>, length: usize, stream: &mut Stream) -> Vec<Case> {
    let scene = estimator.scene;
    let (cache, mut kept) = (LightCache::new(P::Lanes::COUNT), LightCache::new(P::Lanes::COUNT));
    let eye = eye_walk(estimator, &cache, vec2(8.0, 6.0), 0, stream);
    let start = scene.lights.sample_emission(&scene.geometry, stream).unwrap();
    let mut film = WideFilm;
    let light =
        light_walk(Light::new(estimator, &mut kept, &mut film, start, 0), estimator, &start, 0, stream);
    let mut cases = Cases { scene, hidden: estimator.hide_emitters, hero: 0, all: Vec::new() };
    let last = &eye.vertices[length - 1];
    let sample =
        (0..100).find_map(|_| scene.lights.sample_emitter(&scene.geometry, last.position(), stream)).unwrap();
    let of_eye = |count| chain(&eye.vertices[..count], false);
    let of_light = |count| chain(&light.vertices[..count], false);
    cases.add(
        emitter_of(&sample),
        Vec::new(),
        of_eye(length),
        eye.visitor.join_emitter(last, &sample, stream),
    );
    let half = length / 2;
    let joined = eye.visitor.join_with(&eye.vertices[half - 1], &light.vertices[half - 1], stream);
    cases.add(start_of(&start), of_light(half), of_eye(half), joined);
    let seen = light.visitor.join_to_lens(&light.vertices[length - 1], APERTURE, stream);
    cases.add(start_of(&start), of_light(length), Vec::new(), seen.map(|(_, joined)| joined));
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
    /// A path from an emitter by `light`, in walking order, to the lens by `eye`, in walking order.
    fn add(&mut self, emitter: (u32, Place), light: Vec<Node>, eye: Vec<Node>, joined: Option<Joined>) {
        let Some(Joined { weight, .. }) = joined else { return };
        let (index, place) = emitter;
        let strategy = light.len() + 1;
        let mut nodes = vec![Node::emitter(self.scene, index, place)];
        nodes.extend(light);
        nodes.extend(eye.into_iter().rev());
        nodes.push(Node::lens(self.scene));
        let path = Path::through(self.scene, self.hidden, index, nodes);
        self.all.push(Case { path, strategy, hero: self.hero, weight });
    }

    /// The same where the eye walk made all of it.
    fn add_hit(&mut self, emitter: (u32, Place), eye: Vec<Node>, joined: Option<Joined>) {
        let before = self.all.len();
        self.add(emitter, Vec::new(), eye, joined);
        self.all[before..].iter_mut().for_each(|case| case.strategy = 0);
    }
}

/// The vertices of a walk; `dirac` tells of the last one how it scatters.
fn chain<S: Sums>(vertices: &[Vertex<S>], dirac: bool) -> Vec<Node> {
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
    eye: &Trail<Eye<'_, P, Sum>, P::Sums>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    let scene = estimator.scene;
    let mut previous = Node::lens(scene).position();
    for (index, vertex) in eye.vertices.iter().enumerate() {
        if let Interaction::Surface(point) = vertex.interaction
            && let Some(light) = scene.surface(point.shape).emitter
            && let Some(sample) = scene.lights.surface_hit(&scene.geometry, light, &point, previous)
        {
            let before = chain(&eye.vertices[..index], vertex.subpath.after_dirac);
            cases.add_hit((light, Place::Surface(point)), before, eye.visitor.hit(&vertex.subpath, &sample));
        }
        if can_join(estimator, vertex)
            && estimator.counts.next_event > 0.0
            && let Some(sample) = scene.lights.sample_emitter(&scene.geometry, vertex.position(), stream)
        {
            let joined = eye.visitor.join_emitter(vertex, &sample, stream);
            cases.add(emitter_of(&sample), Vec::new(), chain(&eye.vertices[..=index], false), joined);
        }
        previous = vertex.position();
    }
    of_flights(estimator, eye, cases, stream);
    if let Some(subpath) = &eye.escaped
        && let Some(sample) = scene.lights.infinity_hit(-subpath.incoming)
    {
        let before = chain(&eye.vertices, subpath.after_dirac);
        cases.add_hit(emitter_of(&sample), before, eye.visitor.hit(subpath, &sample));
    }
}

/// Points of media that shine, met on the flights of the eye walk.
fn of_flights<P: Profile>(
    estimator: &Estimator<'_, P>,
    eye: &Trail<Eye<'_, P, Sum>, P::Sums>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    for (count, departure, part) in &eye.parts {
        if let Some((light, emission)) = estimator.scene.lights.of_medium(part.medium)
            && let Some((t, _)) = emission.sample_along(&part.interval.section, stream)
            && let Some((subpath, sample)) = eye.visitor.meet(departure, part, light, t, stream)
        {
            let before = chain(&eye.vertices[..*count], departure.dirac);
            cases.add_hit(emitter_of(&sample), before, eye.visitor.hit(&subpath, &sample));
        }
    }
}

fn can_join<P: Profile>(estimator: &Estimator<'_, P>, vertex: &Vertex<P::Sums>) -> bool {
    vertex.subpath.edges < estimator.max_edges && vertex.is_connectible(estimator.scene)
}

fn of_light<P: Profile>(
    estimator: &Estimator<'_, P>,
    start: &EmissionSample,
    light: &Trail<Light<'_, P, WideFilm>, P::Sums>,
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    if estimator.counts.lens <= 0.0 {
        return;
    }
    let joined = light.visitor.join_start_to_lens(APERTURE, stream).map(|(_, joined)| joined);
    cases.add(start_of(start), Vec::new(), Vec::new(), joined);
    for (index, vertex) in light.vertices.iter().enumerate() {
        if vertex.is_connectible(estimator.scene) {
            let joined = light.visitor.join_to_lens(vertex, APERTURE, stream).map(|(_, joined)| joined);
            cases.add(start_of(start), chain(&light.vertices[..=index], false), Vec::new(), joined);
        }
    }
}

fn of_both<P: Profile>(
    estimator: &Estimator<'_, P>,
    eye: &Trail<Eye<'_, P, Sum>, P::Sums>,
    start: &EmissionSample,
    light: &[Vertex<P::Sums>],
    cases: &mut Cases<'_>,
    stream: &mut Stream,
) {
    if estimator.counts.join <= 0.0 || light.is_empty() {
        return;
    }
    for (index, vertex) in eye.vertices.iter().enumerate() {
        let other = stream.below(light.len());
        let (ours, theirs) = (can_join(estimator, vertex), light[other].is_connectible(estimator.scene));
        if ours && theirs && vertex.subpath.edges + light[other].subpath.edges < estimator.max_edges {
            let joined = eye.visitor.join_with(vertex, &light[other], stream);
            let (eye, light) = (chain(&eye.vertices[..=index], false), chain(&light[..=other], false));
            cases.add(start_of(start), light, eye, joined);
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
