//! The fast code led along a given path: walk states at all its vertices from both ends, and the weights of all
//! strategies from them.

use super::{
    cases::WideFilm,
    path::{APERTURE, Node, Path, Place, properties, rate},
    reference::{Reference, reflect},
};
use crate::{
    bsdf::Transport,
    math::{Channels, Spectrum, vec3},
    sampling::{Stream, stream::Purpose},
    scene::lights::{Densities, EmissionSample, EmitterPoint},
    shape::Ray,
    transport::{
        Estimator, LightCache,
        cache::Partners,
        camera_path::{self, CameraPath},
        equiangular::FirstCollision,
        interaction::Interaction,
        light_path::{self, LightPath},
        mis::MisSums,
        observer::Sum,
        profile::Profile,
        segment::{FlightState, FreeFlight, SegmentTransmittance},
        thinning::Thinning,
        vertex::{Subpath, Vertex},
        walk::{Arrival, Departure, Kind, Visitor, arrive, land, scatter::ScatterSample, set_out},
    },
};

/// Which way and by which channel a walk is led.
struct Lead<'a> {
    reference: &'a Reference<'a>,
    transport: Transport,
    hero: usize,
    /// In walking order, the start included.
    nodes: Vec<Node>,
    depths: Vec<[f64; 3]>,
}

/// A walk that was led along a path.
struct Led<S: MisSums> {
    vertices: Vec<Vertex<S>>,
    /// The subpath to the last of its nodes, if it came there.
    end: Option<Subpath<S>>,
}

/// The fast weights (over the number of channels) of all strategies of `path` by channel `hero`: none where the way
/// is blocked, 0 where a strategy cannot make the path.
pub(super) fn weights<P: Profile>(
    estimator: &Estimator<'_, P>,
    reference: &Reference<'_>,
    path: &Path,
    hero: usize,
) -> Vec<Option<f64>> {
    let (mut kept, mut film) = (LightCache::new(P::Channels::COUNT), WideFilm);
    let start = start(reference, path);
    let light = LightPath::new(estimator, &mut kept, &mut film, start, hero);
    let mut camera = CameraPath::new(estimator, Partners::NONE, hero, Sum::default());
    let by_light = by_light(estimator, reference, path, &start, hero, &light);
    let by_eye = by_eye(estimator, reference, path, hero, &camera);
    camera.first = by_eye.vertices.first().and_then(|vertex| first(path, vertex, reference));
    let last = path.nodes.len() - 1;
    let lens_side = |i: usize| by_eye.vertices.get(last - 1 - i);
    let emitter_side = |i: usize| by_light.vertices.get(i - 1);
    let one = |s: usize| {
        // Estimates of transmittance are of no concern to weights.
        let stream = &mut Stream::new(17, 0, 0, Purpose::Study);
        if reference.count(path, s) == 0.0 {
            return Some(0.0);
        }
        let contribution = match s {
            0 => by_eye.end.as_ref().map(|end| {
                camera.emitter_hit(end, &reference.emitter_sample(path)?, path.nodes[1].position())
            }),
            1 if last == 1 => {
                Some(light.connect_start_to_lens(APERTURE, stream).map(|(_, contribution)| contribution))
            }
            _ if s == last => emitter_side(s - 1)
                .map(|v| light.connect_to_lens(v, APERTURE, stream).map(|(_, contribution)| contribution)),
            1 => reference
                .emitter_sample(path)
                .filter(|sample| sample.pdf > 0.0)
                .and_then(|sample| lens_side(1).map(|vertex| camera.join_emitter(vertex, &sample, stream))),
            _ => lens_side(s)
                .zip(emitter_side(s - 1))
                .map(|(ours, theirs)| camera.connect_with(ours, theirs, stream)),
        };
        // The hero cannot walk here (no extinction of its own, say): a density of 0.
        let Some(contribution) = contribution else { return Some(0.0) };
        contribution.map(|contribution| f64::from(contribution.weight) / P::Channels::COUNT as f64)
    };
    let along = reference.equiangular(path).map(|_| along(reference, path, &camera));
    (0..=last).map(one).chain(along).collect()
}

/// The first vertex of the camera subpath, as that remembers it.
fn first<S: MisSums>(path: &Path, vertex: &Vertex<S>, reference: &Reference<'_>) -> Option<FirstCollision> {
    let [.., seen, lens] = path.nodes.as_slice() else { return None };
    FirstCollision::of(vertex, lens.position(), reference.lens(seen) as f32)
}

/// The fast weight of equiangular sampling.
fn along<P: Profile>(reference: &Reference<'_>, path: &Path, camera: &CameraPath<'_, P, Sum>) -> Option<f64> {
    let [_, seen, lens] = path.nodes.as_slice() else { return None };
    let (pivot, over_connect) = reference.scene.lights.pivot(path.light, seen.position(), reference.sky)?;
    let (position, direction) = (seen.position(), lens.towards(seen).as_vec3());
    let film = reference.scene.sensor.project(position, APERTURE)?.film;
    let mut departure = camera_path::depart(camera.estimator, film, APERTURE);
    departure.ray.direction = direction;
    let depth = path.depths[1].map(|depth| depth as f32);
    let pdf = P::Channels::from_spectrum(vec3(depth[0], depth[1], depth[2])).exp_neg();
    let between = SegmentTransmittance { pdf, transmittance: pdf.to_spectrum(), medium: seen.medium };
    let distance = lens.position().distance(position);
    let density = pivot.pdf(position, direction, distance);
    let vertex = camera.along(&departure, &between, position, distance, density)?;
    let mut sample = reference.emitter_sample(path)?;
    sample.pdf *= over_connect;
    let stream = &mut Stream::new(17, 0, 0, Purpose::Study);
    let contribution = camera.join_equiangular(&vertex, &sample, stream)?;
    Some(f64::from(contribution.weight) / P::Channels::COUNT as f64)
}

fn by_light<P: Profile>(
    estimator: &Estimator<'_, P>,
    reference: &Reference<'_>,
    path: &Path,
    start: &EmissionSample,
    hero: usize,
    visitor: &impl Visitor<P>,
) -> Led<P::MisSums> {
    let last = path.nodes.len() - 1;
    let lead = Lead {
        reference,
        transport: Transport::Importance,
        hero,
        nodes: path.nodes[..last].to_vec(),
        depths: path.depths.clone(),
    };
    lead.along::<P>(light_path::depart(estimator, start), visitor)
}

fn by_eye<P: Profile>(
    estimator: &Estimator<'_, P>,
    reference: &Reference<'_>,
    path: &Path,
    hero: usize,
    visitor: &impl Visitor<P>,
) -> Led<P::MisSums> {
    let hittable = estimator.scene.lights.all[path.light as usize].emitter.is_hittable();
    let lead = Lead {
        reference,
        transport: Transport::Radiance,
        hero,
        nodes: path.nodes[usize::from(!hittable)..].iter().rev().copied().collect(),
        depths: path.depths.iter().rev().copied().collect(),
    };
    let seen = &path.nodes[path.nodes.len() - 2];
    let projection = match seen.place {
        Place::Sky(direction) => estimator.scene.sensor.project_direction(direction, APERTURE),
        _ => estimator.scene.sensor.project(seen.position(), APERTURE),
    };
    let Some(projection) = projection else { return Led { vertices: Vec::new(), end: None } };
    lead.along::<P>(camera_path::depart(estimator, projection.film, APERTURE), visitor)
}

/// The start of a light subpath at the first vertex of `path`.
fn start(reference: &Reference<'_>, path: &Path) -> EmissionSample {
    let (node, towards) = (&path.nodes[0], path.nodes[0].towards(&path.nodes[1]));
    let (origin, direction) = (node.position(), towards.as_vec3());
    let Densities { point: pdf, direction: pdf_direction } = reference.densities(path);
    EmissionSample {
        light: path.light,
        point: match node.place {
            Place::Surface(point) => EmitterPoint::Surface(point),
            Place::Sky(towards) => EmitterPoint::Direction(towards),
            Place::Disk(position, direction) => EmitterPoint::Beam { position, direction },
            Place::VolumeEmitter(position, light) => {
                EmitterPoint::Volume { position, rate: rate(reference.scene, light, position) }
            }
            _ => EmitterPoint::Point(origin),
        },
        ray: Ray { origin, direction, t_max: f32::INFINITY },
        cosine: node.cosine(towards) as f32,
        pdf,
        pdf_direction,
        unlearnt: reference.unlearnt(path),
        throughput: Spectrum::ONE,
    }
}

impl Lead<'_> {
    fn along<P: Profile>(
        &self,
        mut departure: Departure<P::MisSums>,
        visitor: &impl Visitor<P>,
    ) -> Led<P::MisSums> {
        let scene = self.reference.scene;
        let Reference { roulette, ref guide, .. } = *self.reference;
        let thinning = &Thinning::of(scene);
        let guide = guide.as_deref();
        let kind = Kind {
            transport: self.transport,
            hero: self.hero,
            max_edges: u32::MAX,
            roulette,
            thinning,
            guide,
        };
        let mut led = Led { vertices: Vec::new(), end: None };
        if let [first, second, ..] = self.nodes.as_slice() {
            departure.ray.direction = first.towards(second).as_vec3();
        }
        for i in 1..self.nodes.len() {
            let (node, is_last) = (&self.nodes[i], i + 1 == self.nodes.len());
            let state = self.state(i);
            let interaction = match node.place {
                Place::Surface(point) => Interaction::Surface(point),
                Place::Volume(position) => {
                    Interaction::Medium(position, properties(scene, node.medium, position))
                }
                _ => {
                    led.end = arrive::<P>(&departure, &state, node.medium, &self.emission(node), self.hero);
                    break;
                }
            };
            let flight = FreeFlight { interaction: Some(interaction), medium: node.medium, state };
            let Some(vertex) = land::<P, _>(scene, kind, &departure, &flight, interaction, visitor) else {
                break;
            };
            if is_last {
                led.end = Some(vertex.subpath);
            } else {
                departure = set_out::<P>(scene, &vertex, &self.scattered::<P>(i, &vertex));
            }
            led.vertices.push(vertex);
        }
        led
    }

    fn state<L: Channels>(&self, i: usize) -> FlightState<L> {
        let depth = self.depths[i - 1].map(|depth| depth as f32);
        let depth = L::from_spectrum(vec3(depth[0], depth[1], depth[2]));
        FlightState { depth, ..FlightState::none() }
    }

    /// An emitter that is no surface.
    fn emission<L: Channels>(&self, node: &Node) -> Arrival<L> {
        let (position, sigma_t) = match node.place {
            Place::VolumeEmitter(position, light) => {
                (Some(position), L::from_spectrum(rate(self.reference.scene, light, position)))
            }
            _ => (None, L::splat(1.0)),
        };
        Arrival { position, cosine: 1.0, sigma_t }
    }

    fn scattered<P: Profile>(&self, i: usize, vertex: &Vertex<P::MisSums>) -> ScatterSample {
        let (scene, here) = (self.reference.scene, &self.nodes[i]);
        let (back, on) = (here.towards(&self.nodes[i - 1]), here.towards(&self.nodes[i + 1]));
        let (direction, weight, dirac) = (on.as_vec3(), Spectrum::ONE, here.dirac);
        if let (true, Place::Surface(point)) = (dirac, &here.place) {
            let pdf = |back, on, transport| reflect(self.reference, point, back, on, true, transport) as f32;
            let (pdf_fwd, pdf_rev) =
                (pdf(back, on, self.transport), pdf(on, back, self.transport.reversed()));
            return ScatterSample { direction, weight, pdf_fwd, pdf_rev, dirac };
        }
        let scattering =
            vertex.scatter_towards::<P>(scene, self.reference.guide.as_deref(), direction, self.transport);
        ScatterSample { direction, weight, pdf_fwd: scattering.pdf_fwd, pdf_rev: scattering.pdf_rev, dirac }
    }
}
