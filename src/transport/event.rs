//! What observers see of walks: departures, arrivals and the vertices reached.

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

/// A BSDF is dull if its pdf in the mirror and straight-through directions is below this many times 1/pi.
const GLOSSY: f32 = 4.0;

/// A walk as it leaves its start or a vertex.
#[derive(Clone, Copy, Debug)]
pub struct Leg {
    /// Where it was.
    pub position: Vec3,
    /// Where it goes to, unit.
    pub direction: Vec3,
    /// The medium that it enters.
    pub medium: MediumIndex,
    /// Segments so far.
    pub edges: u32,
    /// The direction is that of a Dirac lobe.
    pub dirac: bool,
    /// Density of the direction, survival included (1/sr) (or of the start on the disk (1/m^2)).
    pub density: f32,
    /// Contribution over density so far.
    pub throughput: Spectrum,
    /// Probability that a walk with roulette by the albedo gets this far, over that of this walk.
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
    /// Contribution over density, without the scattering here.
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

    /// True if some of its scattering is not Dirac.
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        self.interaction.is_connectible(scene)
    }

    /// True in media, and on surfaces that look about the same from everywhere: there a mean radiance is meaningful.
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

    /// The place at which radiance is looked up.
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
