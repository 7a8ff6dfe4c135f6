//! Radiance learnt beforehand: what places scatter towards those who look at them, in place of walks that would go on from there
//! (after P03T sec. 5.3). It is the mean over cells: of surfaces that face one way, and of media as they are seen from one way, so
//! far as they scatter forwards or backwards.

use super::places::Places;
use crate::{
    math::{Spectrum, SpectrumExt, Vec3},
    sampling::{Cells, cells::Keyed},
};

/// Looks at each cell, at least half of it: a cell's noise is blurred again by those who look at many.
const PER_CELL: f64 = 64.0;
/// Levels of cells below the root: there are 32,768 of surfaces, and as many of media.
const LEVELS: u32 = 15;

/// What is seen of a place, on average.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    position: Vec3,
    /// On a surface the unit normal on the side that is seen; in a medium the direction it is seen from, as long as the
    /// mean cosine of scattering.
    facing: Vec3,
    is_surface: bool,
    /// What is scattered to where it is seen from [W/(m^2 sr)].
    pub radiance: Spectrum,
}

impl Seen {
    /// Nothing yet of a surface with this unit normal, from unit `incoming`.
    #[inline]
    pub fn surface(position: Vec3, normal: Vec3, incoming: Vec3) -> Self {
        let facing = normal * normal.dot(incoming).signum();
        Self { position, facing, is_surface: true, radiance: Spectrum::ZERO }
    }

    /// Nothing yet of a medium of this mean cosine, from unit `incoming`.
    #[inline]
    pub fn medium(position: Vec3, mean_cosine: f32, incoming: Vec3) -> Self {
        let facing = incoming * mean_cosine.abs();
        Self { position, facing, is_surface: false, radiance: Spectrum::ZERO }
    }
}

/// A look with what its cell is found by.
struct Known {
    key: [f32; 6],
    radiance: Spectrum,
}

impl Keyed<6> for Known {
    fn key(&self) -> [f32; 6] {
        self.key
    }
    fn weight(&self) -> f32 {
        1.0
    }
    /// Where light ends at a wall, so do cells.
    fn value(&self) -> Option<f32> {
        Some(self.radiance.luminance().max(0.0).sqrt())
    }
}

/// What was seen everywhere.
#[derive(Clone, Debug)]
pub struct Radiance {
    places: Places,
    surfaces: Cells<6, Spectrum>,
    media: Cells<6, Spectrum>,
}

impl Radiance {
    /// As `seen` somewhere.
    pub fn learn(seen: &[Seen]) -> Self {
        let places = Places::around(seen.iter().map(|seen| seen.position));
        let cells = |is_surface| {
            let own = seen.iter().filter(|seen| seen.is_surface == is_surface);
            let known = own.map(|seen| Known {
                key: places.facing(seen.position, seen.facing),
                radiance: seen.radiance,
            });
            Cells::learn(known.collect(), PER_CELL, LEVELS, mean)
        };
        Self { places, surfaces: cells(true), media: cells(false) }
    }

    /// Memory that it takes [bytes].
    pub fn bytes(&self) -> usize {
        self.surfaces.bytes() + self.media.bytes()
    }

    /// At a place [W/(m^2 sr)]; 0 where nothing was seen of its kind.
    #[inline]
    pub fn at(&self, place: &Seen) -> Spectrum {
        let key = self.places.facing(place.position, place.facing);
        let cells = if place.is_surface { &self.surfaces } else { &self.media };
        cells.at(key).copied().unwrap_or(Spectrum::ZERO)
    }
}

fn mean(known: Vec<Known>) -> Spectrum {
    known.iter().map(|known| known.radiance).sum::<Spectrum>() / known.len() as f32
}
