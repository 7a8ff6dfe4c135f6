//! What an image will not show, with a warning: a scene without light, a camera shut in, a medium shut in. And from which media
//! no light is seen.

use super::{
    Surface,
    accel::Geometry,
    lights::Lights,
    media::{Boundary, Names, Solid, direction},
};
use crate::{
    bsdf::{Bsdf, BsdfModel},
    description::{Library, Location},
    emitter::{BeamModel, Kind},
    math::{Bounds, Vec3},
    medium::{Medium, MediumIndex},
    settings::{integrator::Integrator, options::Algorithm},
};

/// The scene at `location` has no light; a preview needs none, nor do layers without an image.
pub(super) fn warn_of_darkness(
    lights: &Lights,
    integrator: &Integrator,
    location: &Location,
    library: &Library,
) {
    let options = &integrator.options;
    if lights.is_empty() && options.algorithm != Algorithm::Fog && options.max_depth != Some(0) {
        let found = if lights.all.is_empty() { "no emitter" } else { "no emitter with power above 0" };
        let text = format!(
            "{found} is in this scene: all integrators but fog give a black image. Add one, such as \"constant\" \
             (a sky), \"point\", or \"area\" in a shape"
        );
        library.warn(location, &text);
    }
}

/// What decides whether something is shut in by an opaque shape.
pub(super) struct Unseen<'a> {
    /// All shapes.
    pub geometry: &'a Geometry,
    /// Their properties.
    pub surfaces: &'a [Surface],
    /// Their BSDFs.
    pub bsdfs: &'a [Bsdf],
    /// All emitters.
    pub lights: &'a Lights,
    /// Where camera rays start: one point, or nearly.
    pub viewpoint: Vec3,
}

impl Unseen<'_> {
    /// Says of every closed opaque shape what it hides; the camera is at `camera` in the file.
    pub(super) fn warn(&self, names: &Names<'_>, camera: &Location) {
        let shapes =
            (0..self.surfaces.len() as u32).filter(|shape| !self.surfaces[*shape as usize].transmits);
        for shape in shapes {
            if self.shuts_in_camera(shape) {
                names.warn_of_camera_shut_in(shape, camera);
            } else if let Some(medium) = self.shut_in_medium(shape) {
                names.warn_of_medium_shut_in(medium, shape);
            }
        }
    }

    /// For each of `media`, whether all that lies in it is shut in with it, as in frosted glass: nothing there emits,
    /// and light enters and leaves only by scattering at a closed surface. `elsewhere` are media that also lie
    /// somewhere else.
    pub(super) fn shut_in(&self, media: &[Medium], elsewhere: &[MediumIndex]) -> Vec<bool> {
        let mut shut_in: Vec<bool> = media.iter().map(|medium| medium.emission.is_none()).collect();
        let lit = self.lights.all.iter().map(|light| light.medium);
        elsewhere.iter().copied().chain(lit).for_each(|medium| shut_in[medium.0 as usize] = false);
        for (shape, Surface { boundary, .. }) in self.surfaces.iter().enumerate() {
            for medium in [boundary.interior, boundary.exterior].into_iter().flatten() {
                let shut_in = &mut shut_in[medium.0 as usize];
                *shut_in = *shut_in && self.shuts_in_all(shape as u32, medium);
            }
        }
        shut_in
    }

    /// All that touches `shape` of `medium` is within, no emitter is, and no ray goes straight out. What costs most is asked last.
    fn shuts_in_all(&self, shape: u32, medium: MediumIndex) -> bool {
        let Surface { bsdf, boundary: Boundary { interior, exterior }, .. } = self.surfaces[shape as usize];
        let is_passed = self.bsdfs[bsdf as usize].has_null();
        let is_around = || self.is_closed(shape) && self.inner_medium(shape) == Some(medium);
        !is_passed && interior != exterior && !self.may_hold_light(shape) && is_around()
    }

    /// The camera is inside an opaque `shape`, and no emitter is. What costs most is asked last.
    fn shuts_in_camera(&self, shape: u32) -> bool {
        let is_around = self.bounds(shape).contains(Bounds::of(self.viewpoint));
        let is_lit = || self.lights.is_empty() || self.may_hold_light(shape);
        is_around && !is_lit() && self.is_inside(shape, self.viewpoint) && self.is_closed(shape)
    }

    /// The medium inside an opaque `shape` that the camera is outside of. Lamps may say of what they are.
    fn shut_in_medium(&self, shape: u32) -> Option<MediumIndex> {
        let Surface { boundary, emitter, .. } = self.surfaces[shape as usize];
        if !boundary.is_known() || emitter.is_some() {
            return None;
        }
        let is_hidden = || self.is_closed(shape) && !self.is_inside(shape, self.viewpoint);
        self.inner_medium(shape).filter(|_| is_hidden())
    }

    fn is_closed(&self, shape: u32) -> bool {
        self.geometry.shapes()[shape as usize].is_closed()
    }

    fn bounds(&self, shape: u32) -> Bounds {
        self.geometry.shapes()[shape as usize].bounds()
    }

    /// The medium inside a closed shape; none for vacuum, or where the file names none.
    fn inner_medium(&self, shape: u32) -> Option<MediumIndex> {
        let Boundary { interior, exterior } = self.surfaces[shape as usize].boundary;
        let inner = if self.solid(shape).is_outward() { interior } else { exterior };
        inner.filter(|medium| *medium != MediumIndex::VACUUM)
    }

    fn solid(&self, shape: u32) -> Solid {
        Solid::new(&self.geometry.shapes()[shape as usize], &[])
    }

    /// True if a closed `shape` is around `point`, by most of a few directions: faces of opaque meshes may be turned over.
    fn is_inside(&self, shape: u32, point: Vec3) -> bool {
        let solid = self.solid(shape);
        (1..4).filter(|index| solid.holds(point, direction(7 * index))).count() >= 2
    }

    /// An emitter may be within `shape`, or on it.
    fn may_hold_light(&self, shape: u32) -> bool {
        let bounds = self.bounds(shape);
        let meets = |light: Bounds| bounds.common(light).is_some();
        self.lights.all.iter().any(|light| match (&light.emitter.kind, light.shape) {
            (Kind::Surface(_), Some(other)) => meets(self.bounds(other)),
            (Kind::Infinite(_), _) => false,
            (Kind::Point(_), _) => meets(Bounds::of(light.position)),
            (Kind::Beam(beam), _) => meets(Bounds::of(light.position).grown(Vec3::splat(beam.radius()))),
            (Kind::Surface(_) | Kind::Medium(_), _) => true,
        })
    }
}
