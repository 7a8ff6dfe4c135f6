//! An explicit path: its vertices from emitter to lens, and the optical depths between them.

use crate::{
    emitter::Kind,
    math::{DVec3, RaySegment, Spectrum, Vec2, Vec3, offset::Lift, vec2, vec3},
    medium::{DistanceMethod, Heterogeneous, Medium, MediumIndex, MediumInterval, MediumProperties},
    sampling::Stream,
    scene::{Scene, lights::EmitterPoint},
    shape::{Ray, SurfacePoint},
    transport::profiles::Everything,
};

/// What a vertex lies on or in.
#[derive(Clone, Copy, Debug)]
pub(super) enum Place {
    /// The point of a point light or spotlight.
    Point(Vec3),
    /// A point on a surface.
    Surface(SurfacePoint),
    /// A point in a medium.
    Volume(Vec3),
    /// A point of this emitter, an emissive medium.
    VolumeEmitter(Vec3, u32),
    /// An emitter at infinity in this unit direction.
    Sky(Vec3),
    /// The point of a disk that a beam leaves, and its unit direction.
    Disk(Vec3, Vec3),
    /// The pinhole, or the point [`APERTURE`] of a lens.
    Lens(Vec3),
}

impl Place {
    /// That of a point of the emitter `light`.
    pub(super) fn of(light: u32, point: &EmitterPoint) -> Self {
        match *point {
            EmitterPoint::Point(position) => Self::Point(position),
            EmitterPoint::Surface(point) => Self::Surface(point),
            EmitterPoint::Volume { position, .. } => Self::VolumeEmitter(position, light),
            EmitterPoint::Direction(towards) => Self::Sky(towards),
            EmitterPoint::Beam { position, direction } => Self::Disk(position, direction),
        }
    }
}

/// The one point of the aperture that the reference looks through: which one it is cancels in every weight.
pub(super) const APERTURE: Vec2 = vec2(0.01, -0.02);

/// A vertex of a path.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    /// Where.
    pub place: Place,
    /// The medium around it (of a surface that separates media, either).
    pub medium: MediumIndex,
    /// True if the path scatters by a Dirac lobe here.
    pub dirac: bool,
}

impl Node {
    /// The end of every path.
    pub(super) fn lens(scene: &Scene) -> Self {
        let position = scene.sensor.ray(Vec2::ZERO, APERTURE).position;
        Self { place: Place::Lens(position), medium: scene.media_map.sensor, dirac: false }
    }

    /// A vertex of an emitter.
    pub(super) fn emitter(scene: &Scene, light: u32, place: Place) -> Self {
        Self { place, medium: scene.lights.all[light as usize].medium, dirac: false }
    }

    /// World position, or the direction to an emitter at infinity.
    pub(super) fn position(&self) -> Vec3 {
        match self.place {
            Place::Point(p)
            | Place::Volume(p)
            | Place::Sky(p)
            | Place::Lens(p)
            | Place::VolumeEmitter(p, _)
            | Place::Disk(p, _) => p,
            Place::Surface(point) => point.position,
        }
    }

    /// Unit direction from here to `other`.
    pub(super) fn towards(&self, other: &Self) -> DVec3 {
        match (self.place, other.place) {
            (_, Place::Sky(direction)) => direction.as_dvec3(),
            (Place::Sky(direction), _) => -direction.as_dvec3(),
            (_, Place::Disk(_, direction)) => -direction.as_dvec3(),
            (Place::Disk(_, direction), _) => direction.as_dvec3(),
            _ => (other.position().as_dvec3() - self.position().as_dvec3()).normalize(),
        }
    }

    /// 1/d^2 to `other`, 1 for parallel light.
    pub(super) fn inverse_distance_squared(&self, other: &Self) -> f64 {
        match (self.place, other.place) {
            (_, Place::Sky(_) | Place::Disk(..)) | (Place::Sky(_) | Place::Disk(..), _) => 1.0,
            _ => 1.0 / self.position().as_dvec3().distance_squared(other.position().as_dvec3()),
        }
    }

    /// The same where `scene` has flakes: the area that they show.
    pub(super) fn facing(&self, scene: &Scene, direction: DVec3) -> f64 {
        let medium = &scene.media[self.medium.0 as usize];
        match self.place {
            Place::Volume(position) => f64::from(medium.area::<Everything>(position, direction.as_vec3())),
            _ => self.cosine(direction),
        }
    }

    /// |cos| to the geometric normal of a surface; 1 elsewhere.
    pub(super) fn cosine(&self, direction: DVec3) -> f64 {
        match self.place {
            Place::Surface(point) => point.normal.as_dvec3().dot(direction).abs(),
            _ => 1.0,
        }
    }

    /// sigma_t of `channel` in a medium, what replaces it where that emits; 1 elsewhere.
    pub(super) fn sigma_t(&self, scene: &Scene, channel: usize) -> f64 {
        match self.place {
            Place::Volume(p) => f64::from(properties(scene, self.medium, p).sigma_t[channel]),
            Place::VolumeEmitter(p, light) => f64::from(rate(scene, light, p)[channel]),
            _ => 1.0,
        }
    }

    /// Where a segment in unit `direction` begins: at the vertex, but for the lens at its near clip.
    fn edge(&self, scene: &Scene, direction: DVec3) -> DVec3 {
        match self.place {
            Place::Lens(_) => self.exit(scene, direction.as_vec3()).0.as_dvec3(),
            _ => self.position().as_dvec3(),
        }
    }

    /// Where a ray in unit `direction` starts.
    fn exit(&self, scene: &Scene, direction: Vec3) -> (Vec3, MediumIndex) {
        match self.place {
            Place::Surface(point) => {
                let origin = point.leaving(direction).origin;
                (origin, scene.medium_towards(&point, direction, direction, self.medium))
            }
            Place::Lens(position) => {
                let seen = scene.sensor.project_direction(direction, APERTURE);
                (seen.map_or(position, |seen| seen.ray.origin), self.medium)
            }
            _ => (self.position(), self.medium),
        }
    }
}

/// A path.
#[derive(Clone, Debug)]
pub(super) struct Path {
    /// The emitter.
    pub light: u32,
    /// From the emitter to the lens.
    pub nodes: Vec<Node>,
    /// Optical depth of every channel from each vertex to the next, the logarithms of the probabilities to pass
    /// half-transparent surfaces included.
    pub depths: Vec<[f64; 3]>,
    /// What f32 positions leave uncertain of the densities, relative.
    pub rounding: f64,
}

/// How far off f32 may leave a position, relative (ulp).
const SHAKEN: f32 = 4.0;

/// What lies between two vertices.
struct Way {
    depth: [f64; 3],
    rounding: f64,
}

impl Path {
    /// Finds the depths; none where something blocks it.
    /// The lens does not see emitters that are `hidden`.
    pub(super) fn through(scene: &Scene, hidden: bool, light: u32, nodes: Vec<Node>) -> Option<Self> {
        let way = |pair: &[Node]| Way::both(scene, hidden, &pair[1], &pair[0]);
        let ways = nodes.windows(2).map(way).collect::<Option<Vec<Way>>>()?;
        let rounding = ways.iter().map(|way| way.rounding).sum();
        Some(Self { light, nodes, depths: ways.iter().map(|way| way.depth).collect(), rounding })
    }

    /// The same but for positions on surfaces and in media, each coordinate of which is off by up to some ulp of the largest.
    pub(super) fn shaken(&self, stream: &mut Stream) -> Self {
        let mut path = self.clone();
        for node in &mut path.nodes {
            let (Place::Surface(SurfacePoint { position, .. }) | Place::Volume(position)) = &mut node.place
            else {
                continue;
            };
            let reach = SHAKEN * f32::EPSILON * position.abs().max_element();
            let [a, b] = [stream.square(), stream.square()].map(|u| u * 2.0 - 1.0);
            *position += vec3(a.x, a.y, b.x) * reach;
        }
        path
    }
}

impl Way {
    /// From `from` to `to`, which may be at infinity; none where the other way would be another: along the very
    /// rim of a surface.
    fn both(scene: &Scene, hidden: bool, from: &Node, to: &Node) -> Option<Self> {
        let hidden = hidden && matches!(from.place, Place::Lens(_));
        let there = Self::between(scene, hidden, from, to)?;
        if matches!(to.place, Place::Sky(_)) {
            return Some(there);
        }
        let back = Self::between(scene, hidden, to, from)?;
        let agree = |c: usize| (there.depth[c] - back.depth[c]).abs() <= 1e-3 * (1.0 + there.depth[c]);
        (0..3).all(agree).then_some(there)
    }

    /// From `from` to `to` one way.
    fn between(scene: &Scene, hidden: bool, from: &Node, to: &Node) -> Option<Self> {
        let direction = from.towards(to);
        let (mut ray, mut medium) = sight(scene, from, to, direction.as_vec3());
        let mut way = Self { depth: [0.0; 3], rounding: aim(from, to, direction) };
        let mut left = from.edge(scene, direction);
        let end = to.edge(scene, -direction);
        loop {
            let hit = scene.geometry.closest(&ray);
            let point = hit.map(|hit| scene.geometry.surface(&ray, &hit));
            let reached = match (point, to.place) {
                (Some(point), _) => (point.position.as_dvec3() - left).dot(direction),
                (None, Place::Sky(_)) => f64::INFINITY,
                (None, _) => (end - left).dot(direction),
            };
            way.add_leg(scene, medium, left, direction, reached, reach(from, to));
            let Some(point) = point else { return Some(way) };
            let passed = hidden && scene.surface(point.shape).emitter.is_some();
            let null = scene.null_transmission(&point, ray.direction).max_element();
            let passing = if passed { 1.0 } else { f64::from(null) };
            if passing <= 0.0 {
                return None;
            }
            way.depth.iter_mut().for_each(|depth| *depth -= passing.ln());
            medium = scene.medium_towards(&point, -ray.direction, ray.direction, medium);
            left = point.position.as_dvec3();
            way.cross(scene, medium, &point, direction);
            ray = beyond(&ray, &point);
        }
    }

    fn add_leg(
        &mut self,
        scene: &Scene,
        medium: MediumIndex,
        left: DVec3,
        direction: DVec3,
        distance: f64,
        reach: f64,
    ) {
        let medium = &scene.media[medium.0 as usize];
        if medium.depends_on_direction() && medium.phase.varies() {
            return self.add_leg_of_flakes(medium, left, direction, distance, reach);
        }
        let area = medium.area::<Everything>(left.as_vec3(), direction.as_vec3());
        let sigma_t = medium.bound().sigma_t * area;
        self.rounding += ULP * reach * f64::from(sigma_t.max_element());
        if let Some(varying) = medium.heterogeneous() {
            // Ends that are rounded sideways shift the whole leg to where extinction differs.
            let extent = f64::from((varying.extinction().high - varying.extinction().low).length());
            let shifted = STEEPNESS * distance.clamp(0.0, extent);
            self.rounding += ULP * reach * f64::from(sigma_t.max_element()) * shifted;
            let depth = depth_of(varying, left, direction, distance);
            self.depth =
                std::array::from_fn(|channel| self.depth[channel] + depth[channel] * f64::from(area));
            return;
        }
        for (channel, depth) in self.depth.iter_mut().enumerate() {
            if sigma_t[channel] > 0.0 {
                *depth += f64::from(sigma_t[channel]) * distance.max(0.0);
            }
        }
    }

    /// By the depth that the medium says, which the weights must use whatever it is.
    fn add_leg_of_flakes(
        &mut self,
        medium: &Medium,
        left: DVec3,
        direction: DVec3,
        distance: f64,
        reach: f64,
    ) {
        let length = distance.max(0.0) as f32;
        let segment = RaySegment { origin: left.as_vec3(), direction: direction.as_vec3(), length };
        let depth = medium.optical_depth::<Everything>(&MediumInterval::of(segment));
        // Ends that are rounded shift the places where flakes are looked at.
        let shifted = 1.0 + STEEPNESS * distance.clamp(0.0, 10.0);
        self.rounding += ULP * reach * f64::from(medium.densest().max_element()) * shifted;
        self.depth = std::array::from_fn(|channel| self.depth[channel] + f64::from(depth[channel]));
    }

    /// The nearer to grazing a boundary is met, the less certain is where.
    fn cross(&mut self, scene: &Scene, medium: MediumIndex, point: &SurfacePoint, direction: DVec3) {
        let sigma_t = f64::from(scene.media[medium.0 as usize].bound().sigma_t.max_element());
        let cosine = point.normal.as_dvec3().dot(direction).abs();
        self.rounding += ULP * f64::from(point.position.abs().max_element()) * sigma_t / cosine;
    }
}

/// Optical depth of a varying medium: by quadrature where its tracker is exact, else what the tracker says, which the
/// weights must use whatever it is.
fn depth_of(varying: &Heterogeneous, left: DVec3, direction: DVec3, distance: f64) -> DVec3 {
    let segment = RaySegment {
        origin: left.as_vec3(),
        direction: direction.as_vec3(),
        length: distance.max(0.0) as f32,
    };
    if !matches!(varying.tracker().choice(), DistanceMethod::ClosedForm | DistanceMethod::RegularTracking) {
        return varying.depth::<Spectrum>(&segment).as_dvec3();
    }
    let medium = varying.extinction();
    let Some([first, last]) = medium.clip(&segment) else { return DVec3::ZERO };
    let step = f64::from(last - first) / f64::from(POINTS);
    let point = |i: u32| left + direction * (f64::from(first) + (f64::from(i) + 0.5) * step);
    (0..POINTS).map(|i| medium.at::<Spectrum>(point(i).as_vec3()).as_dvec3()).sum::<DVec3>() * step
}

/// How fast the media of the scenes vary, relative to their maximum (1/m).
const STEEPNESS: f64 = 6.0;

/// Points of the quadrature of an optical depth.
const POINTS: u32 = 4_000;

/// The properties of a medium at `position`.
pub(super) fn properties(scene: &Scene, medium: MediumIndex, position: Vec3) -> MediumProperties {
    scene.media[medium.0 as usize].properties_at::<Everything>(0, position)
}

/// How often a camera subpath that passes `position` samples what the emitter `light` emits there (1/m).
pub(super) fn rate(scene: &Scene, light: u32, position: Vec3) -> Spectrum {
    match &scene.lights.all[light as usize].emitter.kind {
        Kind::Medium(glow) => glow.emission.rate(position),
        _ => Spectrum::ZERO,
    }
}

const ULP: f64 = f32::EPSILON as f64;

/// The largest coordinate of either end.
fn reach(a: &Node, b: &Node) -> f64 {
    let of = |node: &Node| match node.place {
        Place::Sky(_) => 0.0,
        _ => f64::from(node.position().abs().max_element()),
    };
    of(a).max(of(b))
}

/// How uncertain rounded ends leave the direction between them and, where it grazes a surface, the cosine.
fn aim(a: &Node, b: &Node, direction: DVec3) -> f64 {
    let cosine = a.cosine(direction).min(b.cosine(direction));
    let distance = match (a.place, b.place) {
        (_, Place::Sky(_)) | (Place::Sky(_), _) => return ULP / cosine,
        _ => a.position().as_dvec3().distance(b.position().as_dvec3()),
    };
    ULP * (1.0 + reach(a, b) / distance) / cosine
}

/// The ray from one vertex to just before another, and the medium it starts in.
fn sight(scene: &Scene, from: &Node, to: &Node, direction: Vec3) -> (Ray, MediumIndex) {
    let (origin, medium) = from.exit(scene, direction);
    if matches!(to.place, Place::Sky(_)) {
        return (Ray { origin, direction, t_max: f32::INFINITY }, medium);
    }
    let lift = match to.place {
        Place::Surface(point) => point.lift(-direction),
        _ => Lift::NONE,
    };
    let way = lift.clear(origin, to.exit(scene, -direction).0) - origin;
    (Ray { origin, direction: way.normalize(), t_max: way.length() }, medium)
}

/// The rest of a ray behind a point that it passes, to the same end.
fn beyond(ray: &Ray, point: &SurfacePoint) -> Ray {
    let origin = point.leaving(ray.direction).origin;
    let way = ray.origin + ray.direction * ray.t_max - origin;
    if ray.t_max == f32::INFINITY || way.dot(ray.direction) <= 0.0 {
        return Ray { origin, t_max: if ray.t_max == f32::INFINITY { f32::INFINITY } else { 0.0 }, ..*ray };
    }
    Ray { origin, direction: way.normalize(), t_max: way.length() }
}
