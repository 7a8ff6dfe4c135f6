//! A camera that is moved about what it looks at.

use crate::{
    description::{TransformStep, transform::compose},
    math::{DMat4, DVec3},
};
use std::f64::consts::PI;

/// How near the camera may come to looking straight up or down, from where the way around is lost (radians).
const STEEPEST: f64 = 0.01;
/// The pivot is not nearer than this, nor farther (m).
const DISTANCES: [f64; 2] = [1e-4, 1e7];
/// The part of a pixel that lines may be wrong by, at a distance of 1 m or at the pivot, whichever is nearer.
const UNSEEN: f64 = 0.05;
/// Digits behind the point that lines have.
const DIGITS: [f64; 2] = [4.0, 12.0];
/// Parallel rays are not brought closer together than this, nor farther apart.
const SCALES: [f64; 2] = [1e-6, 1e9];

/// A camera, in the coordinates of the scene file.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Camera {
    position: DVec3,
    /// Unit vectors, across each other.
    forward: DVec3,
    up: DVec3,
    /// How far the pivot is, in the middle of the image (m).
    distance: f64,
    /// What is up in the scene, whichever way the camera is turned.
    zenith: DVec3,
    /// By how much its own axes are scaled before it is placed: -1 where the image is mirrored; the size of parallel rays.
    scale: DVec3,
    /// Its rays are parallel.
    is_parallel: bool,
    /// What its film makes of it.
    frame: Frame,
}

/// Where the image is: a crop window or an offset of the principal point moves it off the camera's axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// The point on the ray through the middle of the image that is nearest to the camera, relative to it, in the
    /// scene's coordinates (m).
    pub origin: DVec3,
    /// The direction of that line, there too: a unit vector.
    pub direction: DVec3,
    /// How wide the image is at a distance of 1 m; of parallel rays, at any distance (m).
    pub breadth: f64,
}

impl Camera {
    /// The camera that `steps` place.
    pub(super) fn placed(steps: &[TransformStep], is_parallel: bool) -> Self {
        let matrix = compose(steps);
        let [left, up, forward] = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| matrix.transform_vector3(axis));
        let mirror = left.dot(up.cross(forward)).signum();
        let scale = DVec3::new(mirror * left.length(), up.length(), forward.length());
        let (forward, up) = (forward.normalize(), up.normalize());
        let zenith = nearest_axis(stated_up(steps).unwrap_or(up));
        let position = matrix.transform_point3(DVec3::ZERO);
        let frame = Frame { origin: DVec3::ZERO, direction: DVec3::Z, breadth: 1.0 };
        Self { position, forward, up, distance: 1.0, zenith, scale, is_parallel, frame }
    }

    /// Has the image where `frame` says that this camera sees it.
    pub(super) fn frame(&mut self, Frame { origin, direction, breadth }: Frame) {
        let own = |way: DVec3| DVec3::new(way.dot(self.left()), way.dot(self.up), way.dot(self.forward));
        let breadth = if self.is_parallel { breadth / self.scale.x.abs() } else { breadth };
        self.frame = Frame { origin: own(origin) / self.scale, direction: own(direction), breadth };
    }

    /// Has the image where `other` has it.
    pub(super) fn frame_as(&mut self, other: &Self) {
        self.frame = other.frame;
    }

    /// How wide the image is at such a `distance` from the camera (m).
    pub(super) fn breadth_at(&self, distance: f64) -> f64 {
        self.frame.breadth * if self.is_parallel { self.scale.x.abs() } else { distance }
    }

    /// Has the pivot so far ahead (m).
    pub(super) fn grip(&mut self, distance: f64) {
        self.distance = distance.clamp(DISTANCES[0], DISTANCES[1]);
    }

    /// What it turns about.
    pub(super) fn pivot(&self) -> DVec3 {
        let Frame { origin, direction, .. } = self.frame;
        self.position + self.turned(self.scale * origin + self.distance * direction)
    }

    /// Puts the pivot there, whatever became of the camera about it.
    fn hold(&mut self, pivot: DVec3) {
        self.position += pivot - self.pivot();
    }

    /// A vector in its own axes, none of them scaled, in those of the scene.
    fn turned(&self, own: DVec3) -> DVec3 {
        own.x * self.left() + own.y * self.up + own.z * self.forward
    }

    /// Turns about the pivot as the pointer drags what is seen: so many widths of the image to the right, and down. A width
    /// is half a turn.
    pub(super) fn orbit(&mut self, [across, down]: [f64; 2]) {
        let pivot = self.pivot();
        let steepness = self.forward.angle_between(self.zenith);
        let range = [STEEPEST.min(steepness), (PI - STEEPEST).max(steepness)];
        let tilt = (steepness + PI * down).clamp(range[0], range[1]) - steepness;
        let turn = DMat4::from_axis_angle(self.zenith, -PI * across * self.scale.x.signum())
            * DMat4::from_axis_angle(self.left(), tilt);
        self.forward = turn.transform_vector3(self.forward).normalize();
        // Across it again: rounding adds up over a long way.
        let up = turn.transform_vector3(self.up);
        self.up = (up - up.dot(self.forward) * self.forward).normalize();
        self.hold(pivot);
    }

    /// Moves sideways with the pivot, so that what is seen goes so many metres to the right, and down.
    pub(super) fn pan(&mut self, [right, down]: [f64; 2]) {
        self.position += right * self.scale.x.signum() * self.left() + down * self.up;
    }

    /// Comes nearer to the pivot: so many times by the factor e. Parallel rays come closer together, and begin where they did.
    pub(super) fn dolly(&mut self, times: f64) {
        let pivot = self.pivot();
        if self.is_parallel {
            let wide = self.scale.x.abs();
            let factor = (wide * (-times).exp()).clamp(SCALES[0], SCALES[1]) / wide;
            self.scale *= DVec3::new(factor, factor, 1.0);
        } else {
            self.grip(self.distance * (-times).exp());
        }
        self.hold(pivot);
    }

    /// Goes ahead with the pivot: so many times the way to there.
    pub(super) fn walk(&mut self, times: f64) {
        self.position += times * self.distance * self.turned(self.frame.direction);
    }

    /// How far the pivot is (m).
    pub(super) fn distance(&self) -> f64 {
        self.distance
    }

    /// Unit vector to the left, where the image is not mirrored.
    fn left(&self) -> DVec3 {
        self.up.cross(self.forward)
    }

    /// The steps that place it.
    pub(super) fn steps(&self) -> Vec<TransformStep> {
        self.spelled(|x| x)
    }

    /// True if it is where `other` is.
    pub(super) fn is_at(&self, other: &Self) -> bool {
        self.position == other.position
    }

    /// True if it is one of the same kind.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.is_parallel == other.is_parallel
    }

    /// The same in as few digits as place it, where the image is so many pixels wide.
    pub(super) fn rounded(&self, pixels: u32) -> Vec<TransformStep> {
        let sharpness = self.breadth_at(self.distance.min(1.0)) / f64::from(pixels);
        // Half of the last digit is what rounding moves by.
        let digits = (-(2.0 * UNSEEN * sharpness).log10()).ceil().clamp(DIGITS[0], DIGITS[1]) as usize;
        self.spelled(|x| format!("{x:.digits$}").parse().map_or(x, |x: f64| x + 0.0))
    }

    fn spelled(&self, spell: impl Fn(f64) -> f64) -> Vec<TransformStep> {
        let spelled = |point: DVec3| point.to_array().map(&spell);
        let target = self.position + self.distance * self.forward;
        let (origin, target) = (spelled(self.position), spelled(target));
        let is_level = self.left().dot(self.zenith).abs() < 1e-9 && self.up.dot(self.zenith) > 0.0;
        let up = if is_level { self.zenith.to_array() } else { self.up.to_array() };
        let scale = (!self.is_plain()).then(|| TransformStep::Scale(self.scale.to_array().map(significant)));
        scale.into_iter().chain([TransformStep::LookAt { origin, target, up }]).collect()
    }

    /// True if its axes keep their lengths and hands.
    fn is_plain(&self) -> bool {
        self.scale.distance(DVec3::ONE) < 1e-9
    }
}

/// To nine digits: lengths of axes are computed.
fn significant(x: f64) -> f64 {
    format!("{x:.8e}").parse().unwrap_or(x)
}

/// What the last `lookat` of `steps` calls up, where the steps behind it turn that to.
fn stated_up(steps: &[TransformStep]) -> Option<DVec3> {
    let last = steps.iter().rposition(|step| matches!(step, TransformStep::LookAt { .. }))?;
    let TransformStep::LookAt { up, .. } = &steps[last] else { return None };
    Some(compose(&steps[last + 1..]).transform_vector3(DVec3::from(*up)))
}

/// The axis of the file's coordinates, one way or the other, that `direction` is nearest to.
fn nearest_axis(direction: DVec3) -> DVec3 {
    let axes = [DVec3::Y, DVec3::Z, DVec3::X];
    let nearest = axes.into_iter().fold(DVec3::Y, |best, axis| {
        if direction.dot(axis).abs() > direction.dot(best).abs() + 1e-9 { axis } else { best }
    });
    nearest * direction.dot(nearest).signum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looking(origin: [f64; 3], target: [f64; 3]) -> Camera {
        let mut camera =
            Camera::placed(&[TransformStep::LookAt { origin, target, up: [0.0, 1.0, 0.0] }], false);
        camera.grip(DVec3::from(origin).distance(DVec3::from(target)));
        camera
    }

    fn near(a: DVec3, b: [f64; 3]) -> bool {
        a.distance(DVec3::from(b)) < 1e-9
    }

    #[test]
    fn an_orbit_keeps_the_pivot_where_it_is() {
        let mut camera = looking([0.0, 0.0, 5.0], [0.0; 3]);
        // What is dragged to the right is seen from the left.
        camera.orbit([0.5, 0.0]);
        assert!(near(camera.position, [-5.0, 0.0, 0.0]) && near(camera.pivot(), [0.0; 3]), "{camera:?}");
        assert!(near(camera.forward, [1.0, 0.0, 0.0]) && near(camera.up, [0.0, 1.0, 0.0]));
        // And what is dragged down from above.
        camera.orbit([0.0, 0.25]);
        let s = 5.0 * 0.5f64.sqrt();
        assert!(near(camera.position, [-s, s, 0.0]) && near(camera.pivot(), [0.0; 3]), "{camera:?}");
    }

    #[test]
    fn the_camera_does_not_turn_over() {
        for down in [9.0, -9.0] {
            let mut camera = looking([0.0, 0.0, 5.0], [0.0; 3]);
            for _ in 0..100 {
                camera.orbit([0.013, down]);
            }
            assert!(camera.up.y > 0.0 && camera.forward.y.abs() < 1.0, "{camera:?}");
            assert!((camera.position.length() - 5.0).abs() < 1e-9);
            camera.orbit([0.0, -down / 9.0 * 0.4]);
            assert!(camera.forward.y.abs() < 0.4, "{camera:?}");
        }
    }

    #[test]
    fn pan_dolly_and_walk_go_the_way_of_the_hand() {
        let mut camera = looking([0.0, 0.0, 5.0], [0.0; 3]);
        camera.pan([1.0, 2.0]);
        assert!(
            near(camera.position, [-1.0, 2.0, 5.0]) && near(camera.pivot(), [-1.0, 2.0, 0.0]),
            "{camera:?}"
        );
        camera.dolly(2f64.ln());
        assert!(
            near(camera.position, [-1.0, 2.0, 2.5]) && near(camera.pivot(), [-1.0, 2.0, 0.0]),
            "{camera:?}"
        );
        camera.walk(2.0);
        assert!(
            near(camera.position, [-1.0, 2.0, -2.5]) && near(camera.pivot(), [-1.0, 2.0, -5.0]),
            "{camera:?}"
        );
        camera.dolly(1e300);
        assert!(camera.position.is_finite() && camera.distance > 0.0);
        camera.dolly(-1e300);
        assert!(camera.position.is_finite() && camera.distance < 1e8);
    }

    /// Whatever the scene's own steps, those that are made of them place the same camera.
    #[test]
    fn steps_place_the_same_camera() {
        let turned = TransformStep::Rotate { axis: [1.0, 2.0, 0.5], angle: 33.0 };
        let looks =
            TransformStep::LookAt { origin: [1.0, 2.0, 3.0], target: [0.0, 0.5, -1.0], up: [0.0, 0.0, 2.0] };
        for steps in [
            vec![],
            vec![looks.clone()],
            vec![TransformStep::Scale([-1.0, 1.0, 1.0]), looks.clone()],
            vec![TransformStep::Scale([2.5, 2.5, 1.0]), turned.clone(), looks.clone()],
            vec![looks, turned, TransformStep::Translate([0.0, 7.0, 0.0])],
        ] {
            let mut camera = Camera::placed(&steps, true);
            camera.grip(12.0);
            assert!(compose(&camera.steps()).abs_diff_eq(compose(&steps), 1e-9), "{steps:?}: {camera:?}");
            assert!(
                compose(&camera.rounded(100)).abs_diff_eq(compose(&steps), 1e-3),
                "{steps:?}: {camera:?}"
            );
            camera.orbit([0.3, -0.1]);
            let again = Camera {
                distance: camera.distance,
                zenith: camera.zenith,
                ..Camera::placed(&camera.steps(), true)
            };
            assert!(
                again.position.distance(camera.position) < 1e-9 && again.up.distance(camera.up) < 1e-9,
                "{steps:?}"
            );
        }
    }

    #[test]
    fn a_mirrored_image_is_dragged_the_other_way() {
        let [plain, mirrored] = [1.0, -1.0].map(|x| {
            let looks =
                TransformStep::LookAt { origin: [0.0, 0.0, 5.0], target: [0.0; 3], up: [0.0, 1.0, 0.0] };
            let mut camera = Camera::placed(&[TransformStep::Scale([x, 1.0, 1.0]), looks], false);
            camera.grip(5.0);
            camera.orbit([0.1, 0.0]);
            camera.pan([0.1, 0.0]);
            camera.position
        });
        assert!((plain.x + mirrored.x).abs() < 1e-9 && plain.x < -1.0, "{plain} {mirrored}");
    }

    #[test]
    fn up_is_an_axis_of_the_scene() {
        let up = |up: [f64; 3], target: [f64; 3]| {
            Camera::placed(&[TransformStep::LookAt { origin: [0.0; 3], target, up }], false).zenith
        };
        assert_eq!(up([0.0, 0.0, 1.0], [1.0, 0.0, -9.0]), DVec3::Z);
        assert_eq!(up([0.1, -1.0, 0.0], [0.0, 0.0, 1.0]), -DVec3::Y);
        assert_eq!(Camera::placed(&[], false).zenith, DVec3::Y);
    }

    #[test]
    fn lines_have_no_more_digits_than_can_be_seen() {
        let mut camera = looking([0.0, 0.0, 5.0], [0.0; 3]);
        camera.orbit([0.1, 0.0]);
        let expected =
            TransformStep::LookAt { origin: [-1.5451, 0.0, 4.7553], target: [0.0; 3], up: [0.0, 1.0, 0.0] };
        assert_eq!(camera.rounded(100), [expected]);
        let TransformStep::LookAt { origin, .. } = camera.rounded(100_000)[0] else { panic!() };
        assert_eq!(origin, [-1.545085, 0.0, 4.755283]);
    }

    #[test]
    fn parallel_rays_come_closer_and_begin_where_they_did() {
        let looks = TransformStep::LookAt { origin: [0.0, 0.0, 5.0], target: [0.0; 3], up: [0.0, 1.0, 0.0] };
        let mut camera = Camera::placed(&[TransformStep::Scale([-2.0, 3.0, 1.0]), looks], true);
        camera.dolly(2f64.ln());
        assert!(near(camera.scale, [-1.0, 1.5, 1.0]) && near(camera.position, [0.0, 0.0, 5.0]), "{camera:?}");
        camera.dolly(1e300);
        assert!(camera.scale.x < 0.0 && camera.scale.x > -1e-5, "{camera:?}");
    }

    /// A window in a corner of the film looks elsewhere than the camera does.
    #[test]
    fn what_is_in_the_middle_of_the_image_stays_there() {
        let aside = DVec3::new(0.6, -0.3, -1.0).normalize();
        for is_parallel in [false, true] {
            let looks = TransformStep::LookAt {
                origin: [1.0, 2.0, 5.0],
                target: [1.0, 2.0, 0.0],
                up: [0.0, 1.0, 0.0],
            };
            let mut camera = Camera::placed(&[TransformStep::Scale([-2.0, 2.0, 1.0]), looks], is_parallel);
            let (origin, direction) =
                if is_parallel { (DVec3::new(0.5, 0.25, 0.0), DVec3::NEG_Z) } else { (DVec3::ZERO, aside) };
            camera.frame(Frame { origin, direction, breadth: 3.0 });
            camera.grip(4.0);
            let pivot = camera.pivot();
            assert!(near(pivot, (camera.position + origin + 4.0 * direction).to_array()), "{pivot}");
            assert!((camera.breadth_at(2.0) - if is_parallel { 3.0 } else { 6.0 }).abs() < 1e-12);
            camera.orbit([0.2, 0.1]);
            camera.dolly(0.7);
            assert!(near(pivot, camera.pivot().to_array()), "{pivot} {camera:?}");
            camera.walk(1.0);
            let gone = camera.pivot() - pivot;
            assert!((gone.length() - camera.distance).abs() < 1e-9, "{gone}");
        }
    }
}
