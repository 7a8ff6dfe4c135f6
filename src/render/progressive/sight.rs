//! What one ray through the middle of a pixel sees of the scene, apart from light: the false colours of P03T sec. 6.3
//! (orientation, depth, material), and the medium before them.

use crate::{
    bsdf::BsdfModel,
    film::Film,
    math::{RaySegment, Spectrum, Vec2, Vec3, vec2, vec3},
    medium::Medium,
    render::fog,
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    shape::SurfacePoint,
    transport::{NullCrossing, Segment, profiles::Everything},
};

/// Surfaces that a ray passes, or is mirrored or refracted by, before it gives up.
const MOST_LEGS: u32 = 64;
/// Halvings that find a mean free path, to a thousandth of the stretch in which it ends.
const HALVINGS: u32 = 10;

/// What a pixel shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sight {
    /// The first surface, including smooth ones; none where there is none.
    pub first: Option<FirstSurface>,
    /// Shading normal of the surface that the ray ends at, behind mirrors and panes; 0 where there is none.
    pub last_normal: Vec3,
    /// Albedo of that surface, times the transmission along the ray.
    pub albedo: Spectrum,
    /// The emitter that it is.
    pub emitter: Option<u32>,
    /// Optical depth, the mean of the channels.
    pub depth: f32,
    /// 1 - exp(-`depth`).
    pub opacity: f32,
    /// 1 over the distance at which the optical depth is 1, or where the last medium ends if it never is (1/m); 0 without
    /// media.
    pub nearness: f32,
}

/// A surface as a ray from the lens meets it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FirstSurface {
    /// Where.
    pub position: Vec3,
    /// Shading normal.
    pub normal: Vec3,
    /// From the near clip plane, along the ray (m).
    pub distance: f32,
}

/// Optical depths of the media before what `scene` shows on `film`, on `count` x `count` rays.
pub fn optical_depths(scene: &Scene, film: &Film, count: u32) -> Vec<f32> {
    let place = |n: u32, size: u32| (n as f32 + 0.5) / count as f32 * size as f32;
    let film_position = |n: u32| vec2(place(n % count, film.width), place(n / count, film.height));
    (0..count * count).map(|n| Sight::of(scene, film_position(n), false).depth).collect()
}

impl Sight {
    /// Nothing at all.
    pub(super) const NOTHING: Self = Self {
        first: None,
        last_normal: Vec3::ZERO,
        albedo: Spectrum::ZERO,
        emitter: None,
        depth: 0.0,
        opacity: 0.0,
        nearness: 0.0,
    };

    /// What `scene` shows at a film position (pixels), through the middle of the lens. Random choices use the same
    /// numbers for all pixels.
    pub(super) fn of(scene: &Scene, film: Vec2, hide_emitters: bool) -> Self {
        let ray = scene.sensor.ray(film, Vec2::ZERO).ray;
        let mut stream = Stream::new(0, 0, 0, Purpose::Pilot);
        let mut segment = Segment::along(scene, ray, scene.sensor_medium(&ray), hide_emitters);
        let (mut seen, mut veil) = (Self::NOTHING, Veil::default());
        let mut through = Spectrum::ONE;
        for _ in 0..MOST_LEGS {
            let (interval, hit) = segment.next::<Everything>(f32::INFINITY);
            veil.add(segment.medium(), &interval.segment);
            let Some(hit) = hit else { break };
            let point = segment.surface(&hit);
            if let NullCrossing::Passed(passed, probability) = segment.sample_crossing(&point, &mut stream) {
                through *= passed / probability;
                segment.cross(&point);
                continue;
            }
            let FirstSurface { position, normal, distance } = FirstSurface {
                position: point.position,
                normal: point.shading.normal,
                distance: veil.length,
            };
            seen.first = seen.first.or(Some(FirstSurface { position, normal, distance }));
            match fog::deflect(scene, &segment, &point, &mut stream) {
                Some((beyond, weight)) => (segment, through) = (beyond, through * weight),
                None => {
                    seen.end(scene, &point, -segment.ray().direction, through);
                    break;
                }
            }
        }
        Self { depth: veil.depth, opacity: 1.0 - (-veil.depth).exp(), nearness: veil.nearness(), ..seen }
    }

    /// Ends at `point`, seen from direction `incoming`.
    fn end(&mut self, scene: &Scene, point: &SurfacePoint, incoming: Vec3, through: Spectrum) {
        let wi = point.shading.to_local(incoming);
        // If the visible side is black, the albedo of the other side, as in the layer albedo.
        let albedo_of = |wi: Vec3| scene.at(point, |bsdf, uv| bsdf.albedo(uv, wi));
        let faced = albedo_of(wi);
        let albedo = if faced == Spectrum::ZERO { albedo_of(vec3(wi.x, wi.y, -wi.z)) } else { faced };
        self.last_normal = point.shading.normal;
        self.albedo = through * albedo;
        self.emitter = scene.surface(point.shape).emitter;
    }
}

/// The media that a ray has passed.
#[derive(Default)]
struct Veil {
    /// How far it came (m).
    length: f32,
    /// Optical depth, the mean of the channels.
    depth: f32,
    /// Distance at which the last medium ended or the depth reached 1 in it (m).
    reach: f32,
}

impl Veil {
    fn add(&mut self, medium: &Medium, stretch: &RaySegment) {
        let depth = depth(medium, stretch, stretch.length);
        if depth > 0.0 && self.depth < 1.0 {
            let missing = 1.0 - self.depth;
            let within = if depth < missing { stretch.length } else { reach(medium, stretch, missing) };
            self.reach = self.length + within;
        }
        (self.depth, self.length) = (self.depth + depth, self.length + stretch.length);
    }

    fn nearness(&self) -> f32 {
        if self.depth > 0.0 { 1.0 / self.reach.max(f32::MIN_POSITIVE) } else { 0.0 }
    }
}

/// Optical depth of the first `length` metres of a stretch.
fn depth(medium: &Medium, stretch: &RaySegment, length: f32) -> f32 {
    let depth = medium.quick_depth(&RaySegment { length, ..*stretch });
    // An endless stretch of nothing has the depth NaN.
    ((depth.x + depth.y + depth.z) / 3.0).max(0.0)
}

/// Where on a stretch the depth is `wanted`, less than that of all of it.
fn reach(medium: &Medium, stretch: &RaySegment, wanted: f32) -> f32 {
    let (mut low, mut high) = (0.0, stretch.length.min(1.0));
    while high < stretch.length && depth(medium, stretch, high) < wanted {
        (low, high) = (high, stretch.length.min(2.0 * high));
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if depth(medium, stretch, middle) < wanted { low = middle } else { high = middle }
    }
    high
}
