//! What a scene needs of a profile, and what in the scene asks for it.

use crate::{
    bsdf::BsdfModel,
    emitter::Kind,
    math::Spectrum,
    medium::{Medium, MediumIndex},
    scene::{Scene, Surface},
};

/// A part of estimators that a scene may need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Some medium has extinction.
    Media,
    /// Some medium's coefficients vary in space.
    Heterogeneous,
    /// Some extinction differs between channels.
    Chromatic,
    /// Some surface lets rays pass undeflected, even if only those from the camera.
    Nulls,
    /// The rays of some emitter, at infinity or not, or those of the sensor are parallel.
    Infinite,
    /// Some medium emits light.
    Emissive,
    /// Some medium's extinction depends on the direction of flight.
    Flakes,
}

/// What asks for a need.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// A medium.
    Medium(MediumIndex),
    /// Media that lie in one place.
    Overlap,
    /// A shape.
    Shape(u32),
    /// A shape that emits and is hidden from the camera.
    Hidden(u32),
    /// Boundaries of media that contradict each other.
    Contradiction,
    /// An emitter, by its index.
    Emitter(usize),
    /// The camera.
    Sensor,
}

impl Need {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Media,
        Self::Heterogeneous,
        Self::Chromatic,
        Self::Nulls,
        Self::Infinite,
        Self::Emissive,
        Self::Flakes,
    ];

    /// What asks for it in `scene`, one after the other; `hide_emitters` as in [`super::Options`].
    pub fn reasons(self, scene: &Scene, hide_emitters: bool) -> Box<dyn Iterator<Item = Reason> + '_> {
        let overlap = scene.media_map.overlaps.iter().map(|_| Reason::Overlap);
        match self {
            Self::Media => media(scene, |medium| medium.bound().sigma_t != Spectrum::ZERO),
            Self::Heterogeneous => {
                Box::new(media(scene, |medium| medium.heterogeneous().is_some()).chain(overlap))
            }
            Self::Chromatic => media(scene, Medium::is_chromatic),
            Self::Nulls => Box::new(passed(scene, hide_emitters).chain(overlap)),
            Self::Infinite => Box::new(parallel(scene)),
            Self::Emissive => {
                let lights = scene.lights.all.iter();
                let glowing = lights.filter(|light| matches!(light.emitter.kind, Kind::Medium(_)));
                Box::new(glowing.map(|light| Reason::Medium(light.medium)))
            }
            Self::Flakes => media(scene, Medium::depends_on_direction),
        }
    }

    /// In words, what a profile without it leaves out.
    pub fn name(self) -> &'static str {
        match self {
            Self::Media => "media",
            Self::Heterogeneous => "varying media",
            Self::Chromatic => "chromatic extinction",
            Self::Nulls => "index-matched boundaries",
            Self::Infinite => "infinite emitters",
            Self::Emissive => "emissive media",
            Self::Flakes => "microflakes",
        }
    }
}

fn media(scene: &Scene, asks: fn(&Medium) -> bool) -> Box<dyn Iterator<Item = Reason> + '_> {
    let asking = scene.media.iter().enumerate().filter(move |(_, medium)| asks(medium));
    Box::new(asking.map(|(index, _)| Reason::Medium(MediumIndex(index as u32))))
}

/// What lets rays pass undeflected.
fn passed(scene: &Scene, hide_emitters: bool) -> impl Iterator<Item = Reason> + '_ {
    let shape = move |(index, surface): (usize, &Surface)| {
        let index = index as u32;
        if scene.bsdfs[surface.bsdf as usize].has_null() {
            Some(Reason::Shape(index))
        } else {
            (hide_emitters && surface.emitter.is_some()).then_some(Reason::Hidden(index))
        }
    };
    let contradiction = scene.media_map.nowhere.iter().map(|_| Reason::Contradiction);
    scene.surfaces.iter().enumerate().filter_map(shape).chain(contradiction)
}

/// Whose rays are parallel.
fn parallel(scene: &Scene) -> impl Iterator<Item = Reason> + '_ {
    let emitters = scene.lights.all.iter().enumerate().filter(|(_, light)| light.emitter.is_parallel());
    let sensor = scene.sensor.is_parallel().then_some(Reason::Sensor);
    emitters.map(|(index, _)| Reason::Emitter(index)).chain(sensor)
}

/// What a scene needs of its profile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Needs {
    /// [`Need::Media`].
    pub media: bool,
    /// [`Need::Chromatic`].
    pub chromatic: bool,
    /// [`Need::Heterogeneous`].
    pub heterogeneous: bool,
    /// [`Need::Nulls`].
    pub nulls: bool,
    /// [`Need::Infinite`].
    pub infinite: bool,
    /// [`Need::Emissive`].
    pub emissive: bool,
    /// [`Need::Flakes`].
    pub flakes: bool,
}

impl Needs {
    /// What `scene` needs; `hide_emitters` as in [`super::Options`].
    pub fn of(scene: &Scene, hide_emitters: bool) -> Self {
        Self::where_asked(|need| need.reasons(scene, hide_emitters).next().is_some())
    }

    fn where_asked(asked: impl Fn(Need) -> bool) -> Self {
        Self {
            media: asked(Need::Media),
            chromatic: asked(Need::Chromatic),
            heterogeneous: asked(Need::Heterogeneous),
            nulls: asked(Need::Nulls),
            infinite: asked(Need::Infinite),
            emissive: asked(Need::Emissive),
            flakes: asked(Need::Flakes),
        }
    }
}
