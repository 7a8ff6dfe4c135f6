//! A path vertex: where it is, how it scatters, and what the balance heuristic needs of the walk behind it.

use super::weight::Sums;
use crate::math::Lanes;
use crate::{
    bsdf::{BsdfModel, Transport},
    math::{Spectrum, Vec3, offset},
    medium::{Matter, MediumIndex},
    phase::{Deflection, PhaseModel},
    scene::Scene,
    shape::SurfacePoint,
};

/// What a scattering vertex lies on or in.
#[derive(Clone, Copy, Debug)]
pub enum Site {
    /// On a surface.
    Surface(SurfacePoint),
    /// In the medium that the segment before it ran through, made of this.
    Medium(Matter),
}

/// Scattering at a vertex between two given directions.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// The factor of the path's contribution (LW96 eq. 10, g without the other vertex's cosine): albedo x phase
    /// in a medium (sigma_t stands with the flight), BSDF x cosine on a surface, shading normals accounted for.
    pub value: Spectrum,
    /// Density of the outgoing direction given the incoming one, survival included [1/sr].
    pub forward: f32,
    /// Density of the incoming direction given the outgoing one, survival included [1/sr].
    pub backward: f32,
}

/// A vertex of an eye or light walk, i segments after its start.
///
/// The last three fields are the running sums of the weights. With p>_i the density by which this
/// walk makes vertex i (flight, direction and geometry, LW96 eq. 13) and p<_i that of the opposite walk, for
/// lane c and hero h:
///   reach_i   = product over j <= i of p>^c_j / p>^h_j
///   D_i       = (p<^c_i / p>^h_i) (reach_{i-1} n_i + D_{i-1})
/// sums n_j p_j (as [`Sums`] do for the heuristic at hand) over all strategies that join before vertex i, in units
/// of this walk's own density. What p<_i
/// needs of the vertices beyond i is not known yet, so `partial` is D_{i-1} without the direction density at
/// vertex i, and `inverse` is 1/p>^h_i.
#[derive(Clone, Copy, Debug)]
pub struct Vertex<S: Sums> {
    /// World position.
    pub position: Vec3,
    /// Surface or medium.
    pub site: Site,
    /// Unit direction towards the vertex before.
    pub incoming: Vec3,
    /// The medium of the segment that ended here.
    pub medium: MediumIndex,
    /// Segments since the start of the walk, from 1.
    pub edges: u32,
    /// True if the vertex before scattered by a Dirac lobe: the segment before cannot be a join.
    pub after_dirac: bool,
    /// Contribution over density of everything before this vertex's own scattering.
    pub throughput: Spectrum,
    /// n_i: expected samples of the strategy that joins across the segment before; 0 where none can.
    pub joins: f32,
    /// 1/p>^h_i.
    pub inverse: f32,
    /// reach_{i-1}.
    pub reach_before: S::Lanes,
    /// reach_i.
    pub reach: S::Lanes,
    /// D_{i-1} over the direction density at this vertex towards the one before.
    pub partial: S,
}

impl<S: Sums> Vertex<S> {
    /// sigma_t per lane in a medium, 1 on a surface.
    #[inline]
    pub fn sigma_t(&self) -> S::Lanes {
        match self.site {
            Site::Surface(_) => S::Lanes::splat(1.0),
            Site::Medium(matter) => S::Lanes::from_spectrum(matter.sigma_t),
        }
    }

    /// |cos| to the geometric normal on a surface, 1 in a medium.
    #[inline]
    pub fn cosine(&self, direction: Vec3) -> f32 {
        match &self.site {
            Site::Surface(point) => point.normal.dot(direction).abs(),
            Site::Medium(_) => 1.0,
        }
    }

    /// Where a ray towards unit `direction` starts, and in which medium.
    #[inline]
    pub fn depart(&self, scene: &Scene, direction: Vec3) -> (Vec3, MediumIndex) {
        match &self.site {
            Site::Medium(_) => (self.position, self.medium),
            Site::Surface(point) => {
                let origin = offset::leave_surface(point.position, point.error, point.normal, direction);
                (origin, scene.medium_towards(point, direction, self.medium))
            }
        }
    }

    /// See [`super::weight::End::lift`].
    #[inline]
    pub fn lift(&self, direction: Vec3) -> Vec3 {
        match &self.site {
            Site::Medium(_) => Vec3::ZERO,
            Site::Surface(point) => offset::side_of(point.normal, direction),
        }
    }

    /// The sum over the strategies that join before this vertex, once the direction density back to the
    /// vertex before is known: reach_{i-1} n_i + D_{i-1}.
    #[inline]
    pub fn tail(&self, backward: f32) -> S {
        S::of(self.reach_before.scaled(self.joins)).and(self.partial.scaled(backward))
    }

    /// True on a shape that emits.
    #[inline]
    pub fn is_on_emitter(&self, scene: &Scene) -> bool {
        matches!(&self.site, Site::Surface(point) if scene.surface(point.shape).emitter.is_some())
    }

    /// True if something of its scattering is not Dirac.
    #[inline]
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        match &self.site {
            Site::Surface(point) => scene.surface(point.shape).connectible,
            Site::Medium(_) => true,
        }
    }

    /// Scattering between the vertex before and unit `outgoing`.
    #[inline]
    pub fn scatter_towards(&self, scene: &Scene, outgoing: Vec3, transport: Transport) -> Scattering {
        match &self.site {
            Site::Medium(matter) => {
                let medium = &scene.media[self.medium.0 as usize];
                let phase = medium.phase.density(Deflection::between(-self.incoming, outgoing));
                let density = phase * matter.survival();
                Scattering { value: matter.albedo * phase, forward: density, backward: density }
            }
            Site::Surface(point) => self.reflect_towards(scene, point, outgoing, transport),
        }
    }

    fn reflect_towards(
        &self,
        scene: &Scene,
        point: &SurfacePoint,
        outgoing: Vec3,
        transport: Transport,
    ) -> Scattering {
        let bsdf = scene.bsdf(point.shape);
        let (wi, wo) = (point.shading.to_local(self.incoming), point.shading.to_local(outgoing));
        let f = bsdf.evaluate(point.uv, wi, wo, transport);
        let survival = bsdf.survival(point.uv, wi);
        let cosine = wo.z.abs() * shading_correction(point, self.incoming, outgoing, wi, wo, transport);
        Scattering { value: f.value * cosine, forward: f.forward * survival, backward: f.backward * survival }
    }
}

/// By what a light walk's scattering differs where the shading normal is not the geometric one (Veach 1997,
/// eq. 5.19): |wi.ns| |wo.ng| / (|wi.ng| |wo.ns|). Eye walks and media have no such factor.
#[inline]
pub fn shading_correction(
    point: &SurfacePoint,
    incoming: Vec3,
    outgoing: Vec3,
    wi: Vec3,
    wo: Vec3,
    transport: Transport,
) -> f32 {
    if transport == Transport::Radiance || point.shading.normal == point.normal {
        return 1.0;
    }
    let bottom = point.normal.dot(incoming) * wo.z;
    if bottom == 0.0 { 0.0 } else { (wi.z * point.normal.dot(outgoing) / bottom).abs() }
}
