//! Points that stand for elements, and lines between them.

use crate::{
    guide::hierarchy::Sample,
    math::{Spectrum, Vec3, measure, offset::Lift},
    medium::{MediumIndex, MediumProperties},
    sampling::Stream,
    scene::{Scene, lights::EmitterPoint},
    shape::{Ray, SurfacePoint},
    transport::{Interaction, Segment, profiles::Everything, transmittance},
};

/// A point of a surface or of a medium.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    pub interaction: Interaction,
    /// The media on both sides of a surface, that of its normal first.
    media: [MediumIndex; 2],
    /// Which of the sides reflect or emit.
    live: [bool; 2],
}

impl Point {
    /// On a surface, which reflects or emits on the sides that are `live`.
    pub(super) fn on(scene: &Scene, point: SurfacePoint, live: [bool; 2]) -> Self {
        let media = [point.normal, -point.normal].map(|away| match scene.media.len() {
            1 => MediumIndex::VACUUM,
            _ => scene.medium_along(point.leaving(away).origin, away),
        });
        Self { interaction: Interaction::Surface(point), media, live }
    }

    pub(super) fn within(position: Vec3, found: MediumProperties, medium: MediumIndex) -> Self {
        Self { interaction: Interaction::Medium(position, found), media: [medium; 2], live: [true; 2] }
    }

    /// What the hierarchy knows of a point in a medium that stands for so much of it.
    pub(super) fn sample(&self, measure: Spectrum, value: f32) -> Sample {
        let Self { interaction, .. } = self;
        Sample { position: interaction.position(), normal: interaction.normal(), measure, value }
    }

    /// Where a ray in unit `direction` starts, and in which medium.
    pub(super) fn depart(&self, direction: Vec3) -> (Vec3, MediumIndex) {
        match &self.interaction {
            Interaction::Medium(position, _) => (*position, self.media[0]),
            Interaction::Surface(point) => {
                let side = usize::from(point.normal.dot(direction) < 0.0);
                (point.leaving(direction).origin, self.media[side])
            }
        }
    }

    /// True if the side of unit `direction` reflects or emits.
    pub(super) fn is_live(&self, direction: Vec3) -> bool {
        self.live[self.interaction.normal().map_or(0, |normal| usize::from(normal.dot(direction) < 0.0))]
    }

    /// The way ahead from here.
    pub(super) fn ahead<'a>(&self, scene: &'a Scene, direction: Vec3) -> Segment<'a> {
        let (origin, medium) = self.depart(direction);
        Segment::along(scene, Ray { origin, direction, t_max: f32::INFINITY }, medium, false)
    }

    fn lift(&self, towards: Vec3) -> Lift {
        match &self.interaction {
            Interaction::Medium(..) => Lift::NONE,
            Interaction::Surface(point) => point.lift(towards),
        }
    }

    /// |cos| of a unit `direction` to the normal of a surface, 1 in a medium.
    pub(super) fn cosine(&self, direction: Vec3) -> f32 {
        self.interaction.normal().map_or(1.0, |normal| normal.dot(direction).abs())
    }

    /// The unit direction to `other`, and transmittance; none where something is between.
    pub(super) fn line_to(
        &self,
        scene: &Scene,
        other: &Self,
        stream: &mut Stream,
    ) -> Option<(Vec3, Spectrum)> {
        let (towards, ..) = measure::between(self.interaction.position(), other.interaction.position())?;
        let (end, lift) = (other.depart(-towards).0, other.lift(-towards));
        Some((towards, self.through(scene, towards, end, lift, stream)?))
    }

    /// The unit direction to a point of an emitter, and transmittance over the squared distance (1/m^2), or where light is parallel,
    /// transmittance.
    pub(super) fn line_to_light(
        &self,
        scene: &Scene,
        light: &EmitterPoint,
        stream: &mut Stream,
    ) -> Option<(Vec3, Spectrum)> {
        let (towards, squared) = light.seen_from(self.interaction.position())?;
        let through = match light.position() {
            Some(end) => self.through(scene, towards, end, Lift::NONE, stream)?,
            None => self.open(scene, towards, f32::INFINITY, 0.0, stream)?,
        };
        Some((towards, through / squared))
    }

    /// Transmittance to `end`, which lies in unit direction `towards`.
    fn through(
        &self,
        scene: &Scene,
        towards: Vec3,
        end: Vec3,
        lift: Lift,
        stream: &mut Stream,
    ) -> Option<Spectrum> {
        let origin = self.depart(towards).0;
        let before = lift.clear(origin, end);
        let (direction, distance, _) = measure::between(origin, before)?;
        let cut = (end - before).dot(direction).max(-distance);
        self.open(scene, direction, distance, cut, stream)
    }

    /// Transmittance over `distance` (m) and `cut` more of the medium there; none where something is between.
    fn open(
        &self,
        scene: &Scene,
        direction: Vec3,
        distance: f32,
        cut: f32,
        stream: &mut Stream,
    ) -> Option<Spectrum> {
        let (origin, medium) = self.depart(direction);
        let ray = Ray { origin, direction, t_max: distance };
        Some(transmittance::<Everything>(scene, ray, cut, medium, false, stream)?.transmittance)
    }
}
