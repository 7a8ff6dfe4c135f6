//! What observers see of walks: where they go, where they arrive, and what is there.

use super::{interaction::Interaction, profiles::Everything};
use crate::{
    bsdf::Transport,
    guide::solution::Place,
    math::{Spectrum, Vec3},
    medium::MediumIndex,
    phase::PhaseModel,
    scene::Scene,
};
use std::f32::consts::FRAC_1_PI;

/// The density of a dull BSDF in the direction of a mirror, or straight on, is less than so many times that of one that is even.
const GLOSSY: f32 = 4.0;

/// How a walk goes on from its start or a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Where it was.
    pub position: Vec3,
    /// Where it goes to, unit.
    pub direction: Vec3,
    /// The medium that it is then in.
    pub medium: MediumIndex,
    /// Segments so far.
    pub edges: u32,
    /// The direction is that of a Dirac lobe.
    pub dirac: bool,
    /// Density of the direction, survival included (1/sr) (or of the start on the disk (1/m^2)).
    pub density: f32,
    /// Contribution over density so far.
    pub throughput: Spectrum,
    /// How often walks that end by the albedo come so far, over how often this one does.
    pub by_albedo: f32,
}

/// How a walk reached a point.
#[derive(Clone, Copy, Debug)]
pub struct Arrival {
    /// The medium of the segment that ended here.
    pub medium: MediumIndex,
    /// Unit direction towards the vertex before.
    pub incoming: Vec3,
    /// Segments since the start of the walk, from 1.
    pub edges: u32,
    /// Density of the point by the hero channel: per volume in media (1/m^3), per area on surfaces (1/m^2), per solid
    /// angle at infinity (1/sr).
    pub density: f32,
    /// Contribution over density of all before its own scattering.
    pub throughput: Spectrum,
}

/// A vertex that a walk reached.
#[derive(Clone, Copy, Debug)]
pub struct Event<'a> {
    /// Where, and what is there.
    pub interaction: &'a Interaction,
    /// Probability that the walk goes on from here.
    pub survival: f32,
    /// How the walk came here.
    pub arrival: Arrival,
}

impl Event<'_> {
    /// World position.
    pub fn position(&self) -> Vec3 {
        self.interaction.position()
    }

    /// True if something of its scattering is not Dirac.
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        self.interaction.is_connectible(scene)
    }

    /// True in media, and on surfaces that look about the same from everywhere: their mean tells something.
    pub fn is_dull(&self, scene: &Scene) -> bool {
        let Interaction::Surface(point) = self.interaction else { return true };
        let (incoming, normal) = (self.arrival.incoming, point.shading.normal);
        let most = GLOSSY * FRAC_1_PI;
        let pdf = |outgoing: Vec3| {
            let scattering =
                self.interaction.scatter::<Everything>(scene, incoming, outgoing, Transport::Radiance);
            scattering.pdf_fwd
        };
        let mirrored = 2.0 * normal.dot(incoming) * normal - incoming;
        self.is_connectible(scene) && pdf(mirrored) < most && pdf(-incoming) < most
    }

    /// Where it is looked up.
    #[inline]
    pub fn place(&self, scene: &Scene) -> Place {
        let mean_cosine = match self.interaction {
            Interaction::Surface(_) => 0.0,
            Interaction::Medium(_, found) => scene.media[found.medium.0 as usize].phase.mean_cosine(),
        };
        let (normal, towards) = (self.interaction.normal(), self.arrival.incoming);
        Place { position: self.position(), normal, towards, mean_cosine }
    }
}
