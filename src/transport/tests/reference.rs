//! The densities of all strategies of a path, each written out vertex by vertex (LW96 eq. 11-13), and the weights by
//! a heuristic over them (eq. 14). Logarithms in f64: no path is too long or too dense for them.

use super::{
    heuristics,
    path::{APERTURE, Node, Path, Place, properties},
};
use crate::{
    bsdf::{BsdfModel, Transport},
    emitter::{BeamModel, Emitter, Kind, PointModel, SurfaceModel},
    guide::Guide,
    math::{Channels, DVec3, Vec3, offset},
    phase::Deflection,
    sampling::{Stream, stream::Purpose},
    scene::{
        Scene,
        lights::{
            self, Aim, Densities, EmissionSample, EmitterPoint, EmitterSample, Light, Pivot, Start, Starts,
        },
    },
    shape::SurfacePoint,
    transport::{
        Counts, Estimator, Heuristic, Interaction, Sky,
        profile::Profile,
        roulette::{Pending, Roulette},
    },
};
use std::sync::Arc;

/// Expected samples, over those of the likeliest strategy, that never come.
const NEVER: f64 = 1e-30;

/// Paths that are like one path within what f32 holds.
const SHAKES: u32 = 16;

/// What the reference knows of an estimator.
pub(super) struct Reference<'a> {
    pub scene: &'a Scene,
    pub counts: Counts,
    pub heuristic: Heuristic,
    pub roulette: Roulette,
    pub channels: usize,
    /// A sampled start on every emitter: those of one emitter have equal densities, but for environments
    /// and media.
    pub starts: Vec<Option<EmissionSample>>,
    pub sky: Sky,
    pub learnt: Option<Arc<Starts>>,
    pub guide: Option<Arc<Guide>>,
}

/// ln p>_i and ln p<_i of every vertex of a path, per channel.
struct Written {
    by_light: Vec<[f64; 3]>,
    by_eye: Vec<[f64; 3]>,
}

impl<'a> Reference<'a> {
    /// Gathers what is needed of the emitters.
    pub(super) fn new<P: Profile>(estimator: &Estimator<'a, P>) -> Self {
        let Estimator { scene, counts, heuristic, roulette, sky, .. } = *estimator;
        let mut starts = vec![None; scene.lights.all.len()];
        let mut stream = Stream::new(7, 0, 0, Purpose::Study);
        // The faintest of the lamps of the scenes comes once in some 10 000.
        for _ in 0..1_000_000 {
            if let Some(start) = scene.lights.sample_emission(&scene.geometry, None, &mut stream) {
                starts[start.light as usize].get_or_insert(start);
            }
            if starts.iter().all(Option::is_some) {
                break;
            }
        }
        let (learnt, guide) = (estimator.starts.clone(), estimator.guide.clone());
        Self { scene, counts, heuristic, roulette, channels: P::Channels::COUNT, starts, sky, learnt, guide }
    }

    /// Weights by strategy and hero, each in [0, 1]: they sum to one.
    pub(super) fn weights(&self, path: &Path) -> Vec<Vec<f64>> {
        heuristics::weights(self.heuristic, &self.counted(path))
    }

    /// The weights of paths with vertices like those of `path`, but for what f32 may leave uncertain of where they are.
    pub(super) fn shaken(&self, path: &Path) -> impl Iterator<Item = Vec<Vec<f64>>> {
        let mut stream = Stream::new(19, 0, 0, Purpose::Study);
        (0..SHAKES).map(move |_| self.weights(&path.shaken(&mut stream)))
    }

    /// True by strategy and hero where walks come along the path so rarely, beside other strategies, that f32 need not
    /// hold how rarely.
    pub(super) fn never(&self, path: &Path) -> Vec<Vec<bool>> {
        let logs = self.counted(path);
        let most = logs.iter().flatten().copied().fold(f64::NEG_INFINITY, f64::max);
        logs.iter().map(|strategy| strategy.iter().map(|log| *log < most + NEVER.ln()).collect()).collect()
    }

    /// True if densities that are off by `slack`, relative, could make all the difference to the weights.
    pub(super) fn is_close(&self, path: &Path, slack: f64) -> bool {
        heuristics::is_close(self.heuristic, &self.counted(path), slack)
    }

    /// ln(n_s p_s^c) by strategy and channel; equiangular sampling comes last, where it can make the path.
    fn counted(&self, path: &Path) -> Vec<Vec<f64>> {
        let written = self.write(path);
        let along = self.equiangular(path).map(|pdf| vec![pdf.ln(); self.channels]);
        let strategy = |s: usize| {
            let count = self.count(path, s).ln();
            let pdf = |c| count + self.first(path, s) + rest(&written, s, c);
            (0..self.channels).map(pdf).collect()
        };
        (0..path.nodes.len()).map(strategy).chain(along).collect()
    }

    /// n p of equiangular sampling; none where it cannot make the path.
    pub(super) fn equiangular(&self, path: &Path) -> Option<f64> {
        let [y, x, o] = path.nodes.as_slice() else { return None };
        let Place::Volume(position) = x.place else { return None };
        let (pivot, over_connect) = self.scene.lights.pivot(path.light, position, self.sky)?;
        let (position, lens) = (position.as_dvec3(), o.position().as_dvec3());
        let along = match pivot {
            Pivot::Around(place) => along_place(place, lens, position),
            Pivot::Beam(_) => along_beam(&self.scene.lights.all[path.light as usize], lens, position),
        };
        let t = position.distance(lens);
        let emitter = if y.dirac { 0.0 } else { f64::from(self.emitter_sample(path)?.pdf) };
        let count = f64::from(self.counts.equiangular * over_connect);
        Some(count * self.lens(x) * along / (t * t) * emitter).filter(|pdf| *pdf > 0.0)
    }

    /// Expected samples of strategy `s`; 0 where it cannot make this path, as it would have to connect to a
    /// vertex that scatters by a Dirac lobe.
    pub(super) fn count(&self, path: &Path, s: usize) -> f64 {
        let (length, hittable) = (path.nodes.len(), self.emitter(path).is_hittable());
        let count = match s {
            0 if hittable => self.counts.emitter_hit,
            0 => 0.0,
            _ if path.nodes[s - 1].dirac || path.nodes[s].dirac => 0.0,
            1 if length == 2 && !(hittable && self.counts.emitter_hit == 0.0) => 0.0,
            _ if s == length - 1 => self.counts.lens,
            1 => self.counts.next_event,
            _ => self.counts.connection,
        };
        f64::from(count)
    }

    fn emitter(&self, path: &Path) -> &Emitter {
        &self.scene.lights.all[path.light as usize].emitter
    }

    /// ln of the density of the emitter's vertex in strategy `s`.
    fn first(&self, path: &Path, s: usize) -> f64 {
        match s {
            0 => 0.0,
            1 if path.nodes.len() > 2 => {
                self.emitter_sample(path).map_or(0.0, |sample| f64::from(sample.pdf)).ln()
            }
            _ => f64::from(self.densities(path).point).ln(),
        }
    }

    /// Densities of the emitter's vertex and of the direction as the start of a light subpath.
    pub(super) fn densities(&self, path: &Path) -> Densities {
        let (node, unlearnt) = (&path.nodes[0], self.unlearnt(path));
        let Some(learnt) = &self.learnt else { return unlearnt };
        let position = if let Place::Sky(_) = node.place { &path.nodes[1] } else { node }.position();
        let direction = node.towards(&path.nodes[1]).as_vec3();
        let start = Start { light: path.light, position, direction };
        learnt.densities(&self.scene.lights, &start, unlearnt)
    }

    /// The same if nothing was learnt.
    pub(super) fn unlearnt(&self, path: &Path) -> Densities {
        let towards = path.nodes[0].towards(&path.nodes[1]);
        let direction = self.emission(path.light, &path.nodes[0], towards) as f32;
        Densities { point: self.start(path) as f32, direction }
    }

    fn start(&self, path: &Path) -> f64 {
        let reference = path.nodes[1].position();
        if let (Some(_), Place::Sky(direction)) = (self.emitter(path).environment(), path.nodes[0].place) {
            return self
                .scene
                .lights
                .infinity_hit(direction, reference, self.aim())
                .map_or(0.0, |sample| f64::from(sample.pdf_start));
        }
        if let Place::VolumeEmitter(position, light) = path.nodes[0].place {
            return self
                .scene
                .lights
                .volume_hit(light, position, reference, self.sky)
                .map_or(0.0, |sample| f64::from(sample.pdf_start));
        }
        self.starts[path.light as usize].as_ref().map_or(0.0, |start| f64::from(start.pdf))
    }

    fn write(&self, path: &Path) -> Written {
        let last = path.nodes.len() - 1;
        let by_light = (0..last).map(|i| if i == 0 { [0.0; 3] } else { self.by_light(path, i) }).collect();
        Written { by_light, by_eye: (0..last).map(|i| self.by_eye(path, i)).collect() }
    }

    /// ln p>_i: vertex `i` > 0 as the light subpath makes it.
    fn by_light(&self, path: &Path, i: usize) -> [f64; 3] {
        let nodes = &path.nodes;
        let direction = match i {
            1 => f64::from(self.densities(path).direction),
            _ => self.scatter(&nodes[i - 2], &nodes[i - 1], &nodes[i], Transport::Importance),
        };
        self.made(&nodes[i - 1], &nodes[i], direction, &path.depths[i - 1])
    }

    /// ln p<_i: vertex `i` as the camera subpath makes it.
    fn by_eye(&self, path: &Path, i: usize) -> [f64; 3] {
        let nodes = &path.nodes;
        let direction = match nodes.get(i + 2) {
            None => self.lens(&nodes[i]),
            Some(before) => self.scatter(before, &nodes[i + 1], &nodes[i], Transport::Radiance),
        };
        self.made(&nodes[i + 1], &nodes[i], direction, &path.depths[i])
    }

    /// ln of LW96 eq. 13, p' p'' / d^2, for a vertex `to` reached from `from`.
    fn made(&self, from: &Node, to: &Node, direction: f64, depths: &[f64; 3]) -> [f64; 3] {
        let geometry = to.facing(self.scene, from.towards(to)) * from.inverse_distance_squared(to);
        let flight = |c: usize| to.sigma_t(self.scene, c).ln() - depths[c];
        [0, 1, 2].map(|c| direction.ln() + geometry.ln() + flight(c))
    }

    /// Density of directions that leave the lens, per film area of a pixel.
    pub(super) fn lens(&self, seen: &Node) -> f64 {
        let sensor = &self.scene.sensor;
        let seen = match seen.place {
            Place::Sky(direction) => sensor.project_direction(direction, APERTURE),
            _ => sensor.project(seen.position(), APERTURE),
        };
        seen.map_or(0.0, |seen| f64::from(seen.pdf))
    }

    /// Density of directions that leave an emitter (1/sr); of parallel light, of starts on its disk (1/m^2).
    fn emission(&self, light: u32, node: &Node, direction: DVec3) -> f64 {
        match &self.scene.lights.all[light as usize].emitter.kind {
            Kind::Surface(surface) if surface.is_dirac() => 1.0,
            Kind::Surface(surface) => f64::from(surface.pdf_sr(node.cosine(direction) as f32)),
            Kind::Point(point) => f64::from(point.pdf_sr(direction.as_vec3())),
            Kind::Medium(_) => 0.25 / std::f64::consts::PI,
            Kind::Infinite(_) | Kind::Beam(_) => {
                self.starts[light as usize].as_ref().map_or(0.0, |start| f64::from(start.pdf_direction))
            }
        }
    }

    /// Density of going on from `here` to `after`, coming from `before`, survival included (1/sr); the probability
    /// of the lobe where that is a Dirac lobe.
    fn scatter(&self, before: &Node, here: &Node, after: &Node, transport: Transport) -> f64 {
        let (back, on) = (here.towards(before), here.towards(after));
        match &here.place {
            Place::Volume(position) => {
                let medium = &self.scene.media[here.medium.0 as usize];
                let properties = properties(self.scene, here.medium, *position);
                let turn = Deflection::between(-back.as_vec3(), on.as_vec3());
                let phase = medium.phase.pdf_sr_at(*position, turn);
                let survival = f64::from(self.roulette.at(properties.survival(), Pending::NONE).0);
                survival
                    * self.guided(Interaction::Medium(*position, properties), on, phase, false, transport)
            }
            Place::Surface(point) => reflect(self, point, back, on, here.dirac, transport),
            _ => 0.0,
        }
    }

    /// Density of the direction `on`, or the probability of a Dirac lobe, that is `unguided` without the guide.
    fn guided(&self, here: Interaction, on: DVec3, unguided: f32, dirac: bool, transport: Transport) -> f64 {
        let guide = self.guide.as_deref().filter(|_| here.is_connectible(self.scene));
        let Some(guide) = guide else { return f64::from(unguided) };
        let guidance = guide.guidance(here.position(), here.normal(), Vec3::Z, transport);
        let [pdf, _] = match dirac {
            true => guide.unguided(guidance, transport, [unguided, 0.0]),
            false => guide.pdfs(guidance, transport, here.position(), on.as_vec3(), [unguided, 0.0]),
        };
        f64::from(pdf)
    }

    /// How next-event estimation aims at emitters.
    fn aim(&self) -> Aim<'_> {
        Aim { sky: self.sky, starts: self.learnt.as_deref() }
    }

    /// The emitter's vertex as next-event estimation finds it from the next vertex.
    pub(super) fn emitter_sample(&self, path: &Path) -> Option<EmitterSample> {
        let (lights, geometry) = (&self.scene.lights, &self.scene.geometry);
        let reference = path.nodes[1].position();
        match (&self.emitter(path).kind, path.nodes[0].place) {
            (Kind::Surface(_), Place::Surface(point)) => {
                lights.surface_hit(geometry, path.light, &point, reference, self.sky)
            }
            (Kind::Infinite(_), Place::Sky(direction)) if self.emitter(path).environment().is_some() => {
                lights.infinity_hit(direction, reference, self.aim())
            }
            (Kind::Medium(_), Place::VolumeEmitter(position, light)) => {
                lights.volume_hit(light, position, reference, self.sky)
            }
            (_, place) => {
                // Single points and directions come up as often as their emitter is chosen.
                let mut stream = Stream::new(11, 0, 0, Purpose::Study);
                let found = |sample: &EmitterSample| match (sample.point, place) {
                    (EmitterPoint::Point(found), Place::Point(wanted)) => found == wanted,
                    (EmitterPoint::Direction(found), Place::Sky(wanted)) => found == wanted,
                    (EmitterPoint::Beam { .. }, Place::Disk(..)) => sample.light == path.light,
                    _ => false,
                };
                (0..4_096)
                    .filter_map(|_| lights.sample_emitter(geometry, reference, self.aim(), &mut stream))
                    .find(found)
            }
        }
    }
}

/// Density of the distance to `x` from the `lens` by equiangular sampling of what lies around `place` (1/m).
fn along_place(place: &lights::Place, lens: DVec3, x: DVec3) -> f64 {
    let (to_x, to_place) = (x - lens, place.position.as_dvec3() - lens);
    let closest = to_place.dot(to_x.normalize());
    let resolved = f64::from(offset::RESOLVED_ANGLE) * to_place.length();
    let away = to_place.cross(to_x.normalize()).length();
    let apart = (away * away + f64::from(place.radius).powi(2) + resolved * resolved).sqrt();
    // The ray as seen from the emitter: from its start to where it is parallel to it.
    let angle = |t: f64| ((t - closest) / apart).atan();
    let whole = std::f64::consts::FRAC_PI_2 - angle(0.0);
    apart / (whole * (apart * apart + (to_x.length() - closest).powi(2)))
}

/// The same within the beam of `light`, all of whose distances are as likely: those at which the ray is in a cylinder, and
/// before its disk.
fn along_beam(light: &Light, lens: DVec3, x: DVec3) -> f64 {
    let Kind::Beam(beam) = &light.emitter.kind else { return 0.0 };
    let (axis, radius) = (beam.direction().as_dvec3().normalize(), f64::from(beam.radius()));
    let (start, ray) = (lens - light.position.as_dvec3(), (x - lens).normalize());
    let (o, d) = (start - axis * start.dot(axis), ray - axis * ray.dot(axis));
    let root = (o.dot(d).powi(2) - d.dot(d) * (o.dot(o) - radius * radius)).sqrt();
    let [mut from, mut to] = [-root, root].map(|root| (root - o.dot(d)) / d.dot(d));
    let disk = -start.dot(axis) / ray.dot(axis);
    if ray.dot(axis) > 0.0 {
        from = from.max(disk);
    } else {
        to = to.min(disk);
    }
    1.0 / (to - from.max(0.0))
}

/// The product over all vertices but the emitter's own, if strategy `s` makes that by the light subpath.
fn rest(written: &Written, s: usize, channel: usize) -> f64 {
    let light: f64 = written.by_light[..s].iter().map(|log| log[channel]).sum();
    let camera: f64 = written.by_eye[s..].iter().map(|log| log[channel]).sum();
    light + camera
}

/// Density of the direction `on` given `back`, survival included.
pub(super) fn reflect(
    reference: &Reference<'_>,
    point: &SurfacePoint,
    back: DVec3,
    on: DVec3,
    dirac: bool,
    transport: Transport,
) -> f64 {
    let scene = reference.scene;
    let (wi, wo) = (point.shading.to_local(back.as_vec3()), point.shading.to_local(on.as_vec3()));
    let survival =
        f64::from(reference.roulette.at(scene.at(point, |bsdf, uv| bsdf.survival(uv, wi)), Pending::NONE).0);
    let guided = |pdf| survival * reference.guided(Interaction::Surface(*point), on, pdf, dirac, transport);
    if !dirac {
        return guided(scene.at(point, |bsdf, uv| bsdf.evaluate(uv, wi, wo, transport)).pdf_fwd);
    }
    // A surface has one Dirac lobe on each side at most; sample until it is the one on this side.
    let mut stream = Stream::new(13, 0, 0, Purpose::Study);
    let lobe = (0..4_096)
        .filter_map(|_| scene.at(point, |bsdf, uv| bsdf.sample(uv, wi, transport, &mut stream)))
        .find(|sample| sample.dirac && sample.wo.z * wo.z > 0.0);
    guided(lobe.map_or(0.0, |sample| sample.pdf_fwd))
}
