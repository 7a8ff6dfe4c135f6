//! How an element reflects, scatters and emits.

use super::{elements::emitted, point::Point};
use crate::{
    bsdf::{BsdfModel as _, Transport},
    guide::distribution::{Bins, Distribution},
    math::{Frame, Spectrum, Vec3, vec2, vec3, warp},
    medium::MediumIndex,
    phase::{Deflection, PhaseModel as _},
    sampling::{Stream, stream::Purpose},
    scene::Scene,
    shape::SurfacePoint,
    transport::{Arrival, Event, Interaction, profiles::Everything},
};
use rayon::prelude::*;
use std::sync::Arc;

/// Seed of the random numbers of reflection.
const SEED: u64 = 0x7265_666c_6563_7400;
/// Bins along each edge of the square of all directions, where elements look different from everywhere.
pub(super) const BINS: u32 = 8;
/// The least |cos| at which light comes to an element.
const GRAZING: f32 = 0.1;
/// Points of an element that determine its scattering.
const LOOKED_AT: usize = 4;
/// Samples of the part of a bin's light that is scattered.
const REFLECTED: usize = 16;

/// How an element of surfaces or of a medium scatters.
pub(super) struct Element {
    /// What it emits: radiance of a surface, and of a medium what is emitted for each collision (W/(m^2 sr)).
    pub source: Distribution,
    /// See [`Distribution::scattered`].
    scattering: Arc<[Spectrum]>,
    /// A factor on it.
    tint: Spectrum,
    /// Unit, on average; none in a medium.
    normal: Option<Vec3>,
}

impl Element {
    /// The element of `points`; media scatter by `phases`.
    pub(super) fn of(scene: &Scene, points: &[Point], phases: &[Phase]) -> Self {
        match points[points.len() / 2].interaction {
            Interaction::Surface(_) => of_surfaces(scene, points),
            Interaction::Medium(_, found) => of_medium(scene, points, &phases[found.medium.0 as usize]),
        }
    }

    /// |cos| of unit `towards` to a surface; 1 in a medium. Bins are too wide for grazing angles.
    pub(super) fn cosine(&self, towards: Vec3) -> f32 {
        cosine(self.normal, towards)
    }

    /// The |cos| of the middle of a bin; 1 where the bin's angle contains it.
    pub(super) fn cosine_of(&self, bin: usize) -> f32 {
        cosine_of(self.normal, self.source.bins, bin)
    }

    /// The power that comes (W) for each of its measure.
    pub(super) fn received(&self, incoming: &Distribution) -> Spectrum {
        incoming.values.iter().enumerate().map(|(bin, value)| *value * self.cosine_of(bin)).sum()
    }

    /// What it scatters of what comes.
    pub(super) fn scatter(&self, incoming: &Distribution) -> Distribution {
        incoming.scattered(&self.scattering, self.tint)
    }
}

/// See [`Element::cosine`].
fn cosine(normal: Option<Vec3>, towards: Vec3) -> f32 {
    normal.map_or(1.0, |normal| normal.dot(towards).abs().max(GRAZING))
}

/// See [`Element::cosine_of`].
fn cosine_of(normal: Option<Vec3>, bins: Bins, bin: usize) -> f32 {
    match bins {
        Bins::Sides(_) => 1.0,
        Bins::Equal(_) => cosine(normal, bins.direction(bin, [0.5; 2])),
    }
}

/// How a medium scatters light between bins, with albedo 1.
pub(super) type Phase = (Bins, Arc<[Spectrum]>);

/// The phase of each medium.
pub(super) fn phases(scene: &Scene) -> Vec<Phase> {
    scene
        .media
        .par_iter()
        .map(|medium| {
            let looks = [Vec3::Z, Vec3::X, -Vec3::Z];
            let pdf = |after: Vec3| medium.phase.pdf_sr(Deflection::between(Vec3::Z, after));
            let is_even = looks.into_iter().all(|after| (pdf(after) / warp::SPHERE_PDF - 1.0).abs() < 1e-3);
            let bins = Bins::Equal(if is_even { 1 } else { BINS });
            let pdf = |incoming: Vec3, outgoing: Vec3| {
                Spectrum::splat(medium.phase.pdf_sr(Deflection::between(-incoming, outgoing)))
            };
            let mut all = matrix(bins, pdf);
            conserve(bins, &mut all, |_| 1.0, |_| Spectrum::ONE);
            (bins, all.into())
        })
        .collect()
}

/// Scattering between all bins, by means of `value` over directions of both: a row of incoming bins for each outgoing
/// one.
fn matrix(bins: Bins, value: impl Fn(Vec3, Vec3) -> Spectrum) -> Vec<Spectrum> {
    const ASIDE: [[f32; 2]; 4] = [[0.2, 0.4], [0.6, 0.2], [0.4, 0.8], [0.8, 0.6]];
    let of = |bin: usize| ASIDE.map(|at| bins.direction(bin, at));
    let all: Vec<[Vec3; 4]> = (0..bins.count()).map(of).collect();
    let mean = |from: &[Vec3; 4], to: &[Vec3; 4]| {
        let pairs = from.iter().flat_map(|from| to.iter().map(|to| value(*from, *to)));
        pairs.sum::<Spectrum>() / 16.0
    };
    all.iter().flat_map(|to| all.iter().map(|from| mean(from, to)).collect::<Vec<_>>()).collect()
}

/// Scales scattering: the part `albedo` of uniform light from each bin leaves, over all directions. `cosine` is that of
/// a bin.
fn conserve(
    bins: Bins,
    matrix: &mut [Spectrum],
    cosine: impl Fn(usize) -> f32,
    albedo: impl Fn(usize) -> Spectrum,
) {
    let count = bins.count();
    for from in 0..count {
        let leaves = |to: usize| matrix[to * count + from] * (cosine(to) * bins.angle());
        let all: Spectrum = (0..count).map(leaves).sum();
        let scale = albedo(from) * cosine(from) / all;
        let scale = Spectrum::select(all.cmpgt(Spectrum::ZERO), scale, Spectrum::ZERO);
        (0..count).for_each(|to| matrix[to * count + from] *= scale);
    }
}

fn of_medium(scene: &Scene, points: &[Point], (bins, scattering): &Phase) -> Element {
    let [mut all, mut scattered, mut emitted] = [Spectrum::ZERO; 3];
    for point in points {
        let Interaction::Medium(position, found) = point.interaction else { continue };
        let emission = scene.lights.of_medium(found.medium).map(|(_, emission)| emission.at(position));
        all += found.sigma_t;
        scattered += found.sigma_t * found.albedo;
        emitted += emission.unwrap_or_default();
    }
    let over = |sum: Spectrum| Spectrum::select(all.cmpgt(Spectrum::ZERO), sum / all, Spectrum::ZERO);
    let source = Distribution { bins: *bins, values: vec![over(emitted); bins.count()] };
    Element { source, scattering: scattering.clone(), tint: over(scattered), normal: None }
}

fn of_surfaces<'a>(scene: &Scene, points: &'a [Point]) -> Element {
    let own = points.iter().step_by(points.len().div_ceil(LOOKED_AT)).map(|point| &point.interaction);
    let normal = own.clone().filter_map(Interaction::normal).sum::<Vec3>().normalize_or(Vec3::Z);
    let is_dull = own.clone().all(|interaction| is_dull(scene, interaction, normal));
    let bins = if is_dull { Bins::Sides(normal) } else { Bins::Equal(BINS) };
    let surface = |interaction: &'a Interaction| match interaction {
        Interaction::Surface(point) => Some(point),
        Interaction::Medium(..) => None,
    };
    let own: Vec<&SurfacePoint> = own.filter_map(surface).take(if is_dull { LOOKED_AT } else { 1 }).collect();
    let emitted = |bin| {
        let direction = bins.leave(bin, normal, vec2(0.5, 0.5));
        mean(&own, |point| emitted(scene, point, direction))
    };
    let source = Distribution { bins, values: (0..bins.count()).map(emitted).collect() };
    let scattered = |incoming, outgoing| {
        mean(&own, |point| {
            let interaction = Interaction::Surface(*point);
            interaction.scatter::<Everything>(scene, outgoing, incoming, Transport::Radiance).value
        })
    };
    let mut scattering = if is_dull { sides(normal, scattered) } else { matrix(bins, scattered) };
    let albedo = |bin| mean(&own, |point| reflected(scene, point, bins, bin));
    conserve(bins, &mut scattering, |bin| cosine_of(Some(normal), bins, bin), albedo);
    Element { source, scattering: scattering.into(), tint: Spectrum::ONE, normal: Some(normal) }
}

fn mean(points: &[&SurfacePoint], of: impl Fn(&SurfacePoint) -> Spectrum) -> Spectrum {
    points.iter().map(|point| of(point)).sum::<Spectrum>() / points.len() as f32
}

/// The part of even light from a bin that a surface scatters, mirrors apart.
fn reflected(scene: &Scene, point: &SurfacePoint, bins: Bins, bin: usize) -> Spectrum {
    let mut stream = Stream::new(SEED, bin as u64, 0, Purpose::Pilot);
    let mut sample = |_| {
        let wi = point.shading.to_local(bins.leave(bin, point.normal, stream.square()));
        let sample = scene.at(point, |bsdf, uv| bsdf.sample(uv, wi, Transport::Importance, &mut stream));
        sample.filter(|sample| !sample.dirac).map_or(Spectrum::ZERO, |sample| sample.weight)
    };
    (0..REFLECTED).map(&mut sample).sum::<Spectrum>() / REFLECTED as f32
}

/// The matrix of both sides, by directions well away from mirrors.
fn sides(normal: Vec3, scattered: impl Fn(Vec3, Vec3) -> Spectrum) -> Vec<Spectrum> {
    let frame = Frame::around(normal);
    let at = |x: f32, y: f32, side: f32| frame.to_world(vec3(x, y, side * 0.8));
    [1.0, -1.0]
        .into_iter()
        .flat_map(|to| [1.0, -1.0].map(|from| scattered(at(0.6, 0.0, from), at(0.0, 0.6, to))))
        .collect()
}

/// True where it looks about the same from both sides of a `normal`, each.
fn is_dull(scene: &Scene, interaction: &Interaction, normal: Vec3) -> bool {
    let frame = Frame::around(normal);
    [1.0, -1.0].into_iter().all(|side| {
        let incoming = frame.to_world(vec3(0.6, 0.0, side * 0.8));
        let arrival = Arrival {
            medium: MediumIndex::VACUUM,
            incoming,
            edges: 1,
            density: 1.0,
            throughput: Spectrum::ONE,
        };
        !interaction.is_connectible(scene) || Event { interaction, survival: 1.0, arrival }.is_dull(scene)
    })
}
