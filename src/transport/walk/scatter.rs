//! How a walk scatters at a vertex (LW96 eq. 8 and 9): by the medium or the BSDF, or by a guide.

use super::super::{
    interaction::{Interaction, Scattering, back, shading_correction},
    mis::MisSums,
    profile::Profile,
    vertex::Vertex,
};
use super::{Departure, Kind, set_out};
use crate::{
    bsdf::{BsdfModel, Transport},
    guide::Guide,
    math::{Spectrum, Vec3},
    medium::MediumProperties,
    phase::Deflection,
    sampling::Stream,
    scene::Scene,
    shape::SurfacePoint,
};

/// A direction after scattering.
pub(in crate::transport) struct ScatterSample {
    /// Where the walk goes on to, unit.
    pub direction: Vec3,
    /// Factor on the throughput.
    pub weight: Spectrum,
    /// Density of `direction`, survival included (1/sr), or the probability of the Dirac lobe.
    pub pdf_fwd: f32,
    /// The same for the way back.
    pub pdf_rev: f32,
    /// True if a Dirac lobe was sampled.
    pub dirac: bool,
}

/// Scatters at `vertex`; none if the walk is absorbed there (LW96 eq. 8 and 9 are subcritical).
#[inline]
pub(super) fn scatter<P: Profile>(
    scene: &Scene,
    kind: Kind<'_>,
    vertex: &Vertex<P::MisSums>,
    stream: &mut Stream,
) -> Option<Departure<P::MisSums>> {
    if vertex.survival < 1.0 && stream.uniform() >= vertex.survival {
        return None;
    }
    let scattered = match kind.guide {
        Some(guide) if P::GUIDED => guided::<P>(scene, guide, vertex, kind.transport, stream)?,
        _ => unguided::<P>(scene, vertex, kind.transport, stream)?,
    };
    Some(set_out::<P>(scene, vertex, &scattered))
}

/// By the BSDF or the phase function.
#[inline]
pub(super) fn unguided<P: Profile>(
    scene: &Scene,
    vertex: &Vertex<P::MisSums>,
    transport: Transport,
    stream: &mut Stream,
) -> Option<ScatterSample> {
    match &vertex.interaction {
        Interaction::Medium(_, properties) => Some(collide::<P>(scene, vertex, properties, stream)),
        Interaction::Surface(point) => reflect(scene, vertex, point, transport, stream),
    }
}

/// By the BSDF, the phase function or the guide. The guide scales the probability of a Dirac lobe by the part that it
/// leaves unguided; other directions have the density of the mixture.
pub(super) fn guided<P: Profile>(
    scene: &Scene,
    guide: &Guide,
    vertex: &Vertex<P::MisSums>,
    transport: Transport,
    stream: &mut Stream,
) -> Option<ScatterSample> {
    let Some(direction) = guide.sample(vertex.guidance, transport, vertex.position(), stream) else {
        let sample = unguided::<P>(scene, vertex, transport, stream)?;
        let pdfs = [sample.pdf_fwd, sample.pdf_rev];
        let [pdf_fwd, pdf_rev] = if sample.dirac {
            guide.unguided(vertex.guidance, transport, pdfs)
        } else {
            let pdfs = pdfs.map(|pdf| pdf / vertex.survival);
            guide
                .pdfs(vertex.guidance, transport, vertex.position(), sample.direction, pdfs)
                .map(|pdf| pdf * vertex.survival)
        };
        let weight = sample.weight * (sample.pdf_fwd / pdf_fwd);
        return Some(ScatterSample { weight, pdf_fwd, pdf_rev, ..sample });
    };
    let Scattering { value, pdf_fwd, pdf_rev } =
        vertex.scatter_towards::<P>(scene, Some(guide), direction, transport);
    let weight = value / pdf_fwd;
    (weight.max_element() > 0.0).then_some(ScatterSample {
        direction,
        weight,
        pdf_fwd,
        pdf_rev,
        dirac: false,
    })
}

/// LW96 eq. 8: p_scattering, sigma/kappa being the probability of survival.
#[inline]
pub(super) fn collide<P: Profile>(
    scene: &Scene,
    vertex: &Vertex<P::MisSums>,
    properties: &MediumProperties,
    stream: &mut Stream,
) -> ScatterSample {
    let medium = &scene.media[properties.medium.0 as usize];
    let survival = vertex.survival;
    let (position, flight) = (vertex.position(), -vertex.subpath.incoming);
    let direction = medium.phase.sample_at(position, flight, stream);
    let pdf = medium.phase.pdf_sr_at(position, Deflection::between(flight, direction)) * survival;
    let pdf_rev = pdf * back::<P>(medium, position, vertex.subpath.incoming, direction);
    let weight = properties.albedo / survival;
    ScatterSample { direction, weight, pdf_fwd: pdf, pdf_rev, dirac: false }
}

/// LW96 eq. 9: p_reflection, or the density that the BSDF samples by.
#[inline]
pub(super) fn reflect<S: MisSums>(
    scene: &Scene,
    vertex: &Vertex<S>,
    point: &SurfacePoint,
    transport: Transport,
    stream: &mut Stream,
) -> Option<ScatterSample> {
    let wi = point.shading.to_local(vertex.subpath.incoming);
    let survival = vertex.survival;
    let sample = scene.at(point, |bsdf, uv| bsdf.sample(uv, wi, transport, stream))?;
    let direction = point.shading.to_world(sample.wo).normalize();
    let correction = shading_correction(point, vertex.subpath.incoming, direction, wi, sample.wo, transport);
    let weight = sample.weight * (correction / survival);
    if weight.max_element() <= 0.0 {
        return None;
    }
    let (pdf_fwd, pdf_rev) = (sample.pdf_fwd * survival, sample.pdf_rev * survival);
    Some(ScatterSample { direction, weight, pdf_fwd, pdf_rev, dirac: sample.dirac })
}
