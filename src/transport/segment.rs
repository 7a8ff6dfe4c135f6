//! The segments of a path, which may cross index-matched boundaries. `free_flight` samples where a segment ends;
//! `transmittance` attenuates a segment with given ends; `forced` ends one in two ways at once. Media, and the
//! boundaries between them, enter light transport here and nowhere else.

mod forced;
mod free_flight;
mod transmittance;

pub(super) use forced::{ForcedEnd, force, sure_depth};
pub(crate) use free_flight::sample_free_flight;
pub(super) use free_flight::{EmitterCrossing, FlightPart, FlightState, FreeFlight, Passed};
pub(super) use transmittance::SegmentTransmittance;
pub(crate) use transmittance::transmittance;

use crate::{
    math::{RaySegment, Spectrum, Vec3, measure, offset},
    medium::{MediaProfile, Medium, MediumIndex, MediumInterval},
    sampling::Stream,
    scene::Scene,
    shape::{Hit, Ray, SurfacePoint},
};

/// The rest of a segment: from its start, or from the boundary that it crossed last.
#[derive(Clone, Copy)]
pub struct Segment<'a> {
    scene: &'a Scene,
    ray: Ray,
    /// The medium that the ray starts in.
    medium: MediumIndex,
    /// Distance from the boundary to the start of the ray (m), skipped to be clear of the surface. In a homogeneous
    /// medium it still counts: where the mean free path is some hundreds of rounding errors, light would otherwise
    /// start too deep.
    skipped: f32,
    /// Emitters do not block the segment: it leads to a camera that does not see them.
    hidden: bool,
}

impl<'a> Segment<'a> {
    /// Along `ray` to wherever it ends, starting in `medium`; emitters that are `hidden` are passed.
    #[inline(always)]
    pub fn along(scene: &'a Scene, ray: Ray, medium: MediumIndex, hidden: bool) -> Self {
        Self { scene, ray, medium, skipped: 0.0, hidden }
    }

    /// What lies ahead.
    #[inline]
    pub fn ray(&self) -> &Ray {
        &self.ray
    }

    /// The medium that it is in.
    #[inline(always)]
    pub fn medium(&self) -> &'a Medium {
        &self.scene.media[self.medium.0 as usize]
    }

    /// True if emitters are passed.
    pub fn is_hidden(&self) -> bool {
        self.hidden
    }

    /// The next surface within `reach` (m), and the interval of the medium before it; without a surface, all the rest
    /// of the segment. Where media overlap, this also finds the medium.
    #[inline(always)]
    pub fn next<P: MediaProfile>(&mut self, reach: f32) -> (MediumInterval, Option<Hit>) {
        let Ray { origin, direction, t_max } = self.ray;
        let overlaps = if P::HETEROGENEOUS { self.scene.media_map.overlaps.as_deref() } else { None };
        let reach = if overlaps.is_some() { t_max } else { reach.min(t_max) };
        let hit = self.scene.geometry.closest(&Ray { t_max: reach, ..self.ray });
        let segment = RaySegment { origin, direction, length: hit.map_or(t_max, |hit| hit.t) };
        if let Some(overlaps) = overlaps {
            self.medium = overlaps.along(self.medium, &segment);
        }
        (MediumInterval { segment, skipped: self.skipped }, hit)
    }

    /// The point of the next surface.
    #[inline(always)]
    pub fn surface(&self, hit: &Hit) -> SurfacePoint {
        self.scene.geometry.surface(&self.ray, hit)
    }

    /// The part of light that passes a surface point undeflected.
    #[inline]
    fn transmission(&self, point: &SurfacePoint) -> Spectrum {
        if self.hidden && self.scene.surface(point.shape).emitter.is_some() {
            return Spectrum::ONE;
        }
        self.scene.null_transmission(point, self.ray.direction)
    }

    /// Samples whether the segment passes a surface or stops there.
    #[inline]
    pub fn sample_crossing(&self, point: &SurfacePoint, stream: &mut Stream) -> NullCrossing {
        let through = self.transmission(point);
        let passing = through.max_element();
        if passing <= 0.0 || (passing < 1.0 && stream.uniform() >= passing) {
            return NullCrossing::Stopped(1.0 - passing.max(0.0));
        }
        NullCrossing::Passed(through, passing)
    }

    /// Shows a point that a flight has reached, if it emits.
    #[inline]
    fn show_emitter<L>(
        &self,
        point: SurfacePoint,
        before: FlightState<L>,
        certain: bool,
        stream: &mut Stream,
        along: &mut impl FnMut(&Passed<L>, &mut Stream),
    ) {
        if let Some(light) = self.scene.surface(point.shape).emitter {
            let medium = self.medium;
            along(&Passed::Emitter(EmitterCrossing { light, point, medium, before, certain }), stream);
        }
    }

    /// The segment along `ray`, which leaves `point` in another direction.
    pub fn deflected(&self, point: &SurfacePoint, ray: Ray) -> Self {
        let medium = self.scene.medium_towards(point, -self.ray.direction, ray.direction, self.medium);
        Self::along(self.scene, ray, medium, false)
    }

    /// Goes on beyond `point`, in the medium there.
    #[inline]
    pub fn cross(&mut self, point: &SurfacePoint) {
        let Ray { origin, direction, t_max } = self.ray;
        let beyond = point.leaving(direction).origin;
        let t_max = t_max - (beyond - origin).dot(direction);
        self.skipped = (beyond - point.position).dot(direction).max(0.0);
        self.ray = Ray { origin: beyond, direction, t_max };
        self.medium = self.scene.medium_beyond(point, direction, self.medium);
    }

    /// Aims at `end` again. Crossings are rounded, and the segment must not end in the surface beyond.
    #[inline]
    fn aim(&mut self, end: Vec3) {
        let Ray { origin, direction, .. } = self.ray;
        let (aim, t_max, _) = measure::between(origin, end).unwrap_or((direction, 0.0, 0.0));
        // The step across the boundary passed an end this near: it is reached.
        let overshot = aim.dot(direction) <= 0.0;
        self.ray = match overshot {
            true => Ray { t_max: 0.0, ..self.ray },
            // Stop before an end on a boundary: positions there are rounded by more than the rest of the segment, which
            // would cross to and fro for ever.
            false => Ray { origin, direction: aim, t_max: t_max * (1.0 - offset::gamma(8)) },
        };
    }
}

/// What happened to a sampled segment at a surface.
pub enum NullCrossing {
    /// It ends there, with this probability from either side. Like sigma_t at a collision, the probability cancels in
    /// every ratio of densities; it divides the throughput.
    Stopped(f32),
    /// It goes on: the transmission, and the probability of this.
    Passed(Spectrum, f32),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        sampling::{Stream, stream::Purpose},
        scene::build::Setup,
        transport::{interaction::Interaction, profiles::Bounded, tests::scenes},
    };

    /// A cube of the mean free path 1e-6, its face one metre from the camera, which is the origin: 16 steps
    /// of what single precision can resolve there.
    fn dense() -> Setup {
        let sensor = r#""sensor": {"type": "perspective", "near_clip": 1e-3, "to_world":
            [{"type": "lookat", "origin": [0, 0, 2], "target": [0, 0, 0], "up": [0, 1, 0]}]}"#;
        let cube = r#""cube": {"type": "cube", "bsdf": {"type": "null"}, "interior":
            {"type": "homogeneous", "sigma_t": 1e6}}"#;
        scenes::build(&[sensor, cube, r#""sky": {"type": "constant"}"#])
    }

    const INTO: Ray = Ray { origin: Vec3::ZERO, direction: Vec3::NEG_Z, t_max: f32::INFINITY };

    #[test]
    fn what_is_skipped_behind_a_boundary_counts_as_way() {
        let Setup { scene, .. } = &dense();
        const FLIGHTS: u64 = 20_000;
        let mut sum = 0.0;
        for index in 0..FLIGHTS {
            let mut stream = Stream::new(3, index, 0, Purpose::Study);
            let outside = scene.media_map.sensor;
            let into = Segment::along(scene, INTO, outside, false);
            let flight = sample_free_flight::<Bounded>(into, 0, &mut stream, &mut |_, _| ());
            let Some(Interaction::Medium(position, _)) = flight.interaction else { panic!("{flight:?}") };
            assert!(position.z < -1.0, "a collision before the boundary");
            sum += f64::from(-1.0 - position.z);
        }
        let free_paths = sum / FLIGHTS as f64 * 1e6;
        assert!((free_paths - 1.0).abs() < 0.06, "{free_paths} mean free paths");
        let ray = Ray { t_max: 1.0 + 4e-6, ..INTO };
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        let passed =
            transmittance::<Bounded>(scene, ray, 0.0, scene.media_map.sensor, false, &mut stream).unwrap();
        let expected = -f64::from(ray.t_max - 1.0) * 1e6;
        let found = f64::from(passed.pdf).ln();
        assert!((found - expected).abs() < 0.07, "ln T {found}, not {expected}");
    }

    /// Segments to points in the plane of a boundary that they reach from within: each takes an end there for one before the
    /// boundary or beyond, but takes it once.
    #[test]
    fn ends_on_a_boundary_are_reached() {
        let sensor = r#""sensor": {"type": "perspective", "to_world":
            [{"type": "lookat", "origin": [0.3, 1.1, 1.2], "target": [0, 1, 0], "up": [0, 1, 0]}]}"#;
        let cube = r#""cube": {"type": "cube", "bsdf": {"type": "null"}, "interior": {"type": "homogeneous",
            "sigma_t": 0.25}, "to_world": [{"type": "scale", "value": [1.5, 1, 1.5]}]}"#;
        let Setup { scene, .. } = &scenes::build(&[sensor, cube, r#""sky": {"type": "constant"}"#]);
        let mut passed = 0;
        for index in 0..300_000 {
            let mut stream = Stream::new(5, index, 0, Purpose::Study);
            let [from, to] = [0, 1].map(|_| scene.geometry.sample_area(0, &mut stream));
            let origin = from.position - from.normal * (0.5 * stream.uniform());
            let Some((direction, t_max, _)) = measure::between(origin, to.position) else { continue };
            let ray = Ray { origin, direction, t_max };
            let medium = scene.surface(0).boundary.interior.unwrap();
            let found = transmittance::<Bounded>(scene, ray, 0.0, medium, false, &mut stream);
            passed += u32::from(found.is_some());
        }
        assert!(passed > 290_000, "{passed}");
    }
}
