//! Disks that emit parallel light: that of a beam, or for an emitter at infinity one outside the scene.

use super::light::Light;
use crate::{
    emitter::{BeamEmitter, BeamModel, Kind},
    math::{Frame, Vec2, Vec3, vec3, warp},
    sampling::Stream,
};
use std::f32::consts::PI;

/// A disk, local z towards where its light comes from.
#[derive(Clone, Copy, Debug)]
pub struct Disk {
    centre: Vec3,
    frame: Frame,
    /// In metres.
    radius: f32,
    /// How far it lies from `centre` along local z (m).
    lift: f32,
}

impl Disk {
    /// Around `centre`, of light that travels in unit `direction`, with a radius in metres.
    pub fn new(centre: Vec3, direction: Vec3, radius: f32) -> Self {
        Self { centre, frame: Frame::around(-direction), radius, lift: 0.0 }
    }

    /// The disk of an emitter at infinity, outside the sphere around `centre` and facing unit `towards`.
    #[inline]
    pub(super) fn around(centre: Vec3, radius: f32, towards: Vec3) -> Self {
        Self { centre, frame: Frame::around(towards), radius, lift: radius }
    }

    /// The disk of the beam `emitter`, centred at `centre`.
    pub fn of_beam(emitter: &BeamEmitter, centre: Vec3) -> Self {
        Self::new(centre, emitter.direction(), emitter.radius())
    }

    /// The disk of `light`, if it is a beam.
    #[inline]
    pub fn of(light: &Light) -> Option<Self> {
        if let Kind::Beam(emitter) = &light.emitter.kind {
            Some(Self::of_beam(emitter, light.position))
        } else {
            None
        }
    }

    /// Uniform density of its points (1/m^2).
    #[inline]
    pub fn pdf_area(&self) -> f32 {
        1.0 / (PI * self.radius * self.radius)
    }

    /// The unit direction in which its light travels.
    #[inline]
    pub fn direction(&self) -> Vec3 {
        -self.frame.normal
    }

    /// Radius (m).
    #[inline]
    pub fn radius(&self) -> f32 {
        self.radius
    }

    /// `point` of the unit disk as a point of this one.
    #[inline]
    pub fn at(&self, point: Vec2) -> Vec3 {
        self.centre + self.frame.to_world((point * self.radius).extend(self.lift))
    }

    /// Any point of it.
    pub fn sample(&self, stream: &mut Stream) -> Vec3 {
        self.at(warp::to_disk(stream.square()))
    }

    /// Where on the unit disk the parallel ray through `position` crosses it.
    #[inline]
    pub fn unit(&self, position: Vec3) -> Vec2 {
        self.frame.to_local(position - self.centre).truncate() / self.radius
    }

    /// The point whose light reaches `reference`; none where no light of the disk does.
    #[inline]
    pub fn onto(&self, reference: Vec3) -> Option<Vec3> {
        let local = self.frame.to_local(reference - self.centre);
        let across = local.truncate() / self.radius;
        let lit = local.z < self.lift && across.length_squared() <= 1.0;
        lit.then(|| self.centre + self.frame.to_world(vec3(local.x, local.y, self.lift)))
    }
}

impl Disk {
    /// The first and last distance (m) at which the ray in unit `direction` is in the beam from this disk. It passes
    /// `position` at `distance` from its start. None where it is not in the beam, or for ever.
    #[inline]
    pub fn lit_part(&self, position: Vec3, direction: Vec3, distance: f32) -> Option<[f32; 2]> {
        let local = self.frame.to_local(position - self.centre);
        let ray = self.frame.to_local(direction);
        let (here, across) = (local.truncate(), ray.truncate());
        let squared = across.length_squared();
        let chord = self.radius * self.radius * squared - here.perp_dot(across).powi(2);
        let (middle, half) = (-here.dot(across) / squared, chord.max(0.0).sqrt() / squared);
        // Light is below the disk, where local z is negative.
        let crossing = -local.z / ray.z;
        let from = (middle - half).max(if ray.z < 0.0 { crossing } else { f32::NEG_INFINITY });
        let to = (middle + half).min(if ray.z > 0.0 { crossing } else { f32::INFINITY });
        let (from, to) = ((distance + from).max(0.0), distance + to);
        let lit = ray.z != 0.0 || local.z < 0.0;
        (chord > 0.0 && lit && from < to && to < f32::INFINITY).then_some([from, to])
    }
}
