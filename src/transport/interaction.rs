//! What a path meets at the end of a segment, and how that scatters.

use crate::{
    bsdf::{BsdfModel, Transport},
    math::{Channels, Spectrum, Vec3},
    medium::{MediaProfile, Medium, MediumProperties},
    phase::Deflection,
    scene::Scene,
    shape::SurfacePoint,
};

/// Scattering at a vertex between two given directions.
#[derive(Clone, Copy, Debug)]
pub struct Scattering {
    /// The factor of the path's contribution (LW96 eq. 10, g without the other vertex's cosine): albedo x phase
    /// in a medium (sigma_t is a factor of the flight), BSDF x cosine on a surface, shading normals accounted
    /// for.
    pub value: Spectrum,
    /// Density of the outgoing direction given the incoming one, survival included (1/sr).
    pub pdf_fwd: f32,
    /// Density of the incoming direction given the outgoing one, survival included (1/sr).
    pub pdf_rev: f32,
}

/// What scatters, or absorbs, at the end of a free flight.
#[derive(Clone, Copy, Debug)]
pub enum Interaction {
    /// A surface.
    Surface(SurfacePoint),
    /// A collision at this point, and the properties of the medium there.
    Medium(Vec3, MediumProperties),
}

impl Interaction {
    /// World position.
    #[inline]
    pub fn position(&self) -> Vec3 {
        match self {
            Self::Surface(point) => point.position,
            Self::Medium(position, _) => *position,
        }
    }

    /// sigma_t per channel in a medium, without [`Self::cosine`], 1 on a surface.
    #[inline]
    pub fn sigma_t<L: Channels>(&self) -> L {
        match self {
            Self::Surface(_) => L::splat(1.0),
            Self::Medium(_, properties) => L::from_spectrum(properties.sigma_t),
        }
    }

    /// The largest channel of the albedo, or a bound on it, where the walk came from `incoming`.
    #[inline]
    pub fn albedo_bound(&self, scene: &Scene, incoming: Vec3) -> f32 {
        match self {
            Self::Surface(point) => {
                let wi = point.shading.to_local(incoming);
                scene.at(point, |bsdf, uv| bsdf.survival(uv, wi))
            }
            Self::Medium(_, properties) => properties.survival(),
        }
    }

    /// Scattering of a walk by `transport` from unit `incoming`, which points back along the walk, to unit `outgoing`.
    /// Densities are without survival and without a guide.
    ///
    /// LW96 eq. 10: g, without the cosine that the density of the vertex contains.
    #[inline]
    pub fn scatter<M: MediaProfile>(
        &self,
        scene: &Scene,
        incoming: Vec3,
        outgoing: Vec3,
        transport: Transport,
    ) -> Scattering {
        match self {
            Self::Medium(position, properties) => {
                let medium = &scene.media[properties.medium.0 as usize];
                let phase = medium.phase.pdf_sr_at(*position, Deflection::between(-incoming, outgoing));
                let pdf_rev = phase * back::<M>(medium, *position, incoming, outgoing);
                Scattering { value: properties.albedo * phase, pdf_fwd: phase, pdf_rev }
            }
            Self::Surface(point) => {
                let (wi, wo) = (point.shading.to_local(incoming), point.shading.to_local(outgoing));
                let f = scene.at(point, |bsdf, uv| bsdf.evaluate(uv, wi, wo, transport));
                let cosine = wo.z.abs() * shading_correction(point, incoming, outgoing, wi, wo, transport);
                Scattering { value: f.value * cosine, pdf_fwd: f.pdf_fwd, pdf_rev: f.pdf_rev }
            }
        }
    }

    /// Unit geometric normal of a surface.
    #[inline]
    pub fn normal(&self) -> Option<Vec3> {
        match self {
            Self::Surface(point) => Some(point.normal),
            Self::Medium(..) => None,
        }
    }

    /// True if some of its scattering is not Dirac.
    #[inline]
    pub fn is_connectible(&self, scene: &Scene) -> bool {
        match self {
            Self::Surface(point) => scene.surface(point.shape).connectible,
            Self::Medium(..) => true,
        }
    }

    /// |cos| to the geometric normal on a surface; in a medium [`Medium::area`], which is 1 without flakes.
    #[inline]
    pub fn cosine<M: MediaProfile>(&self, scene: &Scene, direction: Vec3) -> f32 {
        match self {
            Self::Surface(point) => point.normal.dot(direction).abs(),
            Self::Medium(position, properties) if M::FLAKES => {
                scene.media[properties.medium.0 as usize].area::<M>(*position, direction)
            }
            Self::Medium(..) => 1.0,
        }
    }
}

/// Density of scattering from unit `outgoing` back to unit `incoming` over the density forwards: for flakes the ratio
/// of the areas that they show in both directions, else 1.
#[inline]
pub(super) fn back<M: MediaProfile>(medium: &Medium, position: Vec3, incoming: Vec3, outgoing: Vec3) -> f32 {
    let area = |direction| medium.area::<M>(position, direction);
    if M::FLAKES { area(incoming) / area(outgoing) } else { 1.0 }
}

/// The correction of a light subpath's scattering where the shading normal is not the geometric one (Veach
/// 1997, eq. 5.19): |wi.ns| |wo.ng| / (|wi.ng| |wo.ns|). Camera subpaths and media have no such factor.
#[inline]
pub(super) fn shading_correction(
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
