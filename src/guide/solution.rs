//! First passes: coarse solutions of the scene, as walks look them up (P03T ch. 4).

use super::{
    distribution::Distribution,
    hierarchy::Hierarchy,
    radiance::{Radiance, Seen},
};
use crate::{
    math::{Frame, Spectrum, Vec3, warp},
    sampling::Stream,
};
use std::sync::Arc;

/// A place that is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// World position.
    pub position: Vec3,
    /// Unit geometric normal; none in a medium.
    pub normal: Option<Vec3>,
    /// Unit direction towards where it is seen from.
    pub towards: Vec3,
    /// Mean cosine of the medium's phase function; 0 on a surface.
    pub mean_cosine: f32,
}

impl Place {
    /// What walks may have seen of it, nothing yet.
    #[inline]
    pub fn seen(&self) -> Seen {
        let Self { position, normal, towards, mean_cosine } = *self;
        match normal {
            Some(normal) => Seen::surface(position, normal, towards),
            None => Seen::medium(position, mean_cosine, towards),
        }
    }
}

/// What paths end in.
#[derive(Clone, Debug)]
pub struct Ending {
    /// What is scattered everywhere; the same however it is seen.
    pub found: Arc<Found>,
    /// How it is seen.
    pub view: View,
}

/// What is scattered everywhere, as one of the methods found it.
#[derive(Clone, Debug)]
pub enum Found {
    /// Walks from the camera: in cells where they came.
    Walked(Radiance),
    /// Links or particles: in elements of the scene.
    Solved(Solution),
}

impl Ending {
    /// What is scattered at a place (W/(m^2 sr)); 0 where nothing is known of its kind.
    #[inline]
    pub fn at(&self, place: &Place, stream: &mut Stream) -> Spectrum {
        match &*self.found {
            Found::Walked(radiance) => radiance.at(&place.seen()),
            Found::Solved(solution) if self.view.flat => solution.at(place),
            Found::Solved(solution) => solution.about(place, stream),
        }
    }

    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        match &*self.found {
            Found::Walked(radiance) => radiance.bytes(),
            Found::Solved(solution) => solution.bytes(),
        }
    }
}

/// What every element of a scene scatters.
#[derive(Clone, Debug, Default)]
pub struct Solution {
    /// The elements.
    pub hierarchy: Hierarchy,
    /// What each scatters, without what it emits: radiance of a surface, and of a medium what collisions add to it (W/(m^2 sr)).
    pub values: Vec<Distribution>,
}

/// How a first pass is seen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct View {
    /// Paths end in it where they scatter first; else where they scatter for the second time.
    pub at_once: bool,
    /// Its elements are not interpolated.
    pub flat: bool,
}

impl Solution {
    /// What is scattered at a place, as its element has it (W/(m^2 sr)); 0 where there is nothing of its kind.
    #[inline]
    fn at(&self, place: &Place) -> Spectrum {
        let element = self.hierarchy.element(place.position, place.normal);
        element.map_or(Spectrum::ZERO, |element| self.values[element as usize].at(place.towards))
    }

    /// The same, interpolated between elements: `stream` chooses a place within about an element's size, so that the
    /// mean is smooth.
    #[inline]
    fn about(&self, place: &Place, stream: &mut Stream) -> Spectrum {
        let Some(element) = self.hierarchy.element(place.position, place.normal) else {
            return Spectrum::ZERO;
        };
        let reach = self.hierarchy.node(element).radius();
        let aside = match place.normal {
            Some(normal) => Frame::around(normal).to_world(warp::to_disk(stream.square()).extend(0.0)),
            None => warp::to_sphere(stream.square()),
        };
        self.at(&Place { position: place.position + reach * aside, ..*place })
    }

    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        let values = self.values.iter().map(|value| size_of_val(&value.values[..]));
        self.hierarchy.bytes() + size_of_val(&self.values[..]) + values.sum::<usize>()
    }
}
