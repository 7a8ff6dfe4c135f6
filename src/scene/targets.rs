//! Targets: what light subpaths may aim at although nothing is learnt.
//!
//! Light that a ball of glass focuses is found by light subpaths alone. Under a sun over a wide ground, hardly one in ten
//! thousand of them meets the ball. (Jensen 1996, Global Illumination using Photon Maps, sends photons to specular objects by
//! projection maps, for the same reason.)

use super::{Scene, lights::Starts};
use crate::{
    bsdf::BsdfModel as _,
    math::{Bounds, Spectrum, Vec3},
    medium::{Medium, MediumProperties},
    sampling::portal::Sphere,
};
use std::sync::Arc;

/// Most targets: starts are looked up in all of them.
const MOST: usize = 8;

impl Scene {
    /// Starts of light subpaths that aim at the targets; none where no light sets out for any.
    pub fn aimed_starts(&self) -> Option<Arc<Starts>> {
        let aim = || Starts::aimed(&self.lights, &self.geometry, &self.targets()).map(Arc::new);
        self.lights.aimed.recall(String::new(), aim)
    }

    /// Spheres about as large as the shapes that bend light or hold media that scatter. Of many, close ones have one in
    /// common. What fills much of the scene is met anyway and left out.
    fn targets(&self) -> Vec<Sphere> {
        let large = 0.5 * largest_side(&self.geometry.bounds());
        let is_small = |bounds: &Bounds| bounds.is_finite() && largest_side(bounds) < large;
        let shapes = (0..).zip(self.geometry.shapes());
        let found = shapes.filter(|(index, _)| self.is_target(*index)).map(|(_, shape)| shape.bounds());
        let found = grouped(found.filter(is_small).collect());
        let spheres = found.iter().filter(|bounds| is_small(bounds)).map(sphere_in_place_of);
        spheres.filter(|sphere| sphere.radius_squared > f32::MIN_POSITIVE).collect()
    }

    fn is_target(&self, shape: u32) -> bool {
        let (bsdf, surface) = (self.bsdf(shape), self.surface(shape));
        let overlaps = self.media_map.overlaps.as_ref();
        let stated = surface.boundary.interior.filter(|_| surface.transmits);
        let within = stated.or_else(|| overlaps?.inside(shape));
        let scatters = |medium: &Medium| {
            let MediumProperties { sigma_t, albedo, .. } = medium.bound();
            sigma_t * albedo != Spectrum::ZERO
        };
        // Mirrors, on one side or both.
        let is_smooth = bsdf.smooth().is_some() || !(bsdf.is_connectible() || bsdf.has_null());
        is_smooth
            || bsdf.scatters_across()
            || within.is_some_and(|medium| scatters(&self.media[medium.0 as usize]))
    }
}

fn largest_side(bounds: &Bounds) -> f32 {
    bounds.size().max_element()
}

/// As wide as its longest side. Wider spheres around it have its corners.
fn sphere_in_place_of(bounds: &Bounds) -> Sphere {
    let radius = 0.5 * largest_side(bounds);
    Sphere { centre: centre(bounds), radius_squared: radius * radius }
}

fn centre(bounds: &Bounds) -> Vec3 {
    0.5 * (bounds.low + bounds.high)
}

fn union(part: &[Bounds]) -> Bounds {
    part.iter().copied().fold(Bounds::EMPTY, Bounds::union)
}

/// Boxes around all of them, at most [`MOST`]: those of the largest group are told apart until the groups are as many.
fn grouped(all: Vec<Bounds>) -> Vec<Bounds> {
    let (mut open, mut closed) = (vec![all], Vec::new());
    while open.len() + closed.len() < MOST {
        let size = |part: &Vec<Bounds>| largest_side(&union(part));
        let Some(largest) = (0..open.len()).max_by(|a, b| size(&open[*a]).total_cmp(&size(&open[*b]))) else {
            break;
        };
        match halved(open.swap_remove(largest)) {
            Ok(halves) => open.extend(halves),
            Err(one) => closed.push(one),
        }
    }
    open.iter().map(|part| union(part)).chain(closed).filter(|bounds| bounds.is_finite()).collect()
}

/// The two halves of `part`, whose centres lie apart; else the box around it.
fn halved(part: Vec<Bounds>) -> Result<[Vec<Bounds>; 2], Bounds> {
    let centres = union(&part.iter().map(|one| Bounds::of(centre(one))).collect::<Vec<_>>());
    let (middle, axis) = (centre(&centres), centres.size().max_position());
    let (near, far): (Vec<_>, Vec<_>) = part.iter().partition(|one| centre(one)[axis] <= middle[axis]);
    if far.is_empty() || near.is_empty() { Err(union(&part)) } else { Ok([near, far]) }
}
