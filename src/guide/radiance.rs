//! Radiance learnt beforehand, which replaces walks that would go on from a place (after P03T sec. 5.3). It is the mean
//! over cells: of surfaces that face one way, and of media seen from one way, as far as these scatter forwards or
//! backwards.

use super::places::{Places, Valued};
use crate::{
    math::{Spectrum, SpectrumExt, Vec3},
    sampling::Cells,
};
use rayon::prelude::*;

/// Half the number of looks at which a cell is divided: its noise averages out over the many cells that a pixel looks
/// at.
const PER_CELL: f64 = 64.0;
/// Levels of cells below the root: there are 32,768 of surfaces, and as many of media.
const LEVELS: u32 = 15;
/// Radiance has settled when one more bounce changes at most this part of all of it.
const SETTLED: f64 = 1e-6;

/// What is seen of a place, on average.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    position: Vec3,
    /// On a surface the unit normal on the side that is seen; in a medium the direction that it is seen from, times the
    /// mean cosine of scattering.
    facing: Vec3,
    is_surface: bool,
    /// What is scattered to where it is seen from (W/(m^2 sr)).
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

    /// The key of its cell.
    #[inline]
    fn key(&self, places: &Places) -> [f32; 6] {
        places.facing(self.position, self.facing)
    }
}

/// A place that a walk came to.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// The place, and what it scatters by itself (W/(m^2 sr)).
    pub seen: Seen,
    /// The later look that the walk came to next, and the part of its radiance that this place scatters on.
    pub onward: Option<(u32, Spectrum)>,
    /// Of each channel, 0 if the walk sampled distances by another, else the part of this place's radiance that the place before
    /// scatters: walks that follow a guide come here the more often, the less they bring.
    pub weights: Spectrum,
    /// The walk was followed far enough to say what it scatters.
    pub is_whole: bool,
}

impl Look {
    /// What the place scatters, where others have the radiance `at` their indices.
    fn lit_by(&self, at: impl Fn(usize) -> Spectrum) -> Spectrum {
        let onward = self.onward.map_or(Spectrum::ZERO, |(next, part)| part * at(next as usize));
        self.seen.radiance + onward
    }
}

/// What was seen everywhere.
#[derive(Clone, Debug)]
pub struct Radiance {
    places: Places,
    surfaces: Cells<6, u32>,
    media: Cells<6, u32>,
    /// That of each cell.
    values: Vec<Spectrum>,
}

impl Radiance {
    /// Learns from `looks` the radiance of light of at most `most_bounces` bounces from one place to another.
    ///
    /// Cells end where the brightness of places changes: first the brightness that each walk alone found, then the one
    /// that follows from the first cells.
    pub fn learn(looks: &[Look], most_bounces: u32) -> Self {
        let first = Self::between(looks, &walked(looks), most_bounces);
        let lit = |look: &Look| look.lit_by(|next| first.at(&looks[next].seen));
        Self::between(looks, &looks.par_iter().map(lit).collect::<Vec<_>>(), most_bounces)
    }

    /// In cells that end where the `shown` radiance of places differs.
    fn between(looks: &[Look], shown: &[Spectrum], most_bounces: u32) -> Self {
        let places = Places::around(looks.iter().map(|look| look.seen.position));
        let mut leaves: Vec<Vec<u32>> = Vec::new();
        let mut cells = |is_surface| {
            let own = looks.iter().zip(shown).enumerate();
            let own = own.filter(|(_, (look, _))| look.is_whole && look.seen.is_surface == is_surface);
            let known = own.map(|(index, (look, shown))| Valued {
                key: look.seen.key(&places),
                value: shown.luminance().max(0.0).sqrt(),
                index: index as u32,
            });
            Cells::learn(known.collect(), PER_CELL, LEVELS, |known| {
                leaves.push(known.into_iter().map(|known| known.index).collect());
                leaves.len() as u32 - 1
            })
        };
        let (surfaces, media) = (cells(true), cells(false));
        let mut radiance = Self { places, surfaces, media, values: vec![Spectrum::ZERO; leaves.len()] };
        let cells: Vec<_> = looks.par_iter().map(|look| radiance.cell(&look.seen)).collect();
        let balances = leaves.par_iter().map(|leaf| Balance::of(looks, leaf, &cells)).collect::<Vec<_>>();
        radiance.values = solve(&balances, most_bounces);
        radiance
    }

    /// Memory that it takes (bytes).
    pub fn bytes(&self) -> usize {
        self.surfaces.bytes() + self.media.bytes() + size_of_val(&self.values[..])
    }

    /// At a place (W/(m^2 sr)); 0 where nothing was seen of its kind.
    #[inline]
    pub fn at(&self, place: &Seen) -> Spectrum {
        self.cell(place).map_or(Spectrum::ZERO, |cell| self.values[cell as usize])
    }

    #[inline]
    fn cell(&self, place: &Seen) -> Option<u32> {
        let cells = if place.is_surface { &self.surfaces } else { &self.media };
        cells.at(place.key(&self.places)).copied()
    }
}

/// The radiance of places as the walks that came there found it.
fn walked(looks: &[Look]) -> Vec<Spectrum> {
    let mut all = vec![Spectrum::ZERO; looks.len()];
    // Walks go on to later looks.
    for (index, look) in looks.iter().enumerate().rev() {
        all[index] = look.lit_by(|next| all[next]);
    }
    all
}

/// What a cell scatters.
struct Balance {
    /// By itself.
    source: Spectrum,
    /// The parts of other cells' radiance that it scatters as well.
    transfers: Vec<(u32, Spectrum)>,
}

impl Balance {
    /// Of the looks of a cell, as their means, where `cells` has those of all looks.
    fn of(looks: &[Look], leaf: &[u32], cells: &[Option<u32>]) -> Self {
        let own = || leaf.iter().map(|index| &looks[*index as usize]);
        // Each channel uses the walks that sampled by it: in others it is noisy, as their densities differ.
        let all = own().map(|look| look.weights).sum::<Spectrum>();
        let each = Spectrum::select(all.cmpgt(Spectrum::ZERO), all.recip(), Spectrum::ZERO);
        let source = own().map(|look| look.weights * look.seen.radiance).sum::<Spectrum>() * each;
        let onward = |look: &Look| {
            let (to, part) = look.onward?;
            Some((cells[to as usize]?, look.weights * part * each))
        };
        let mut transfers: Vec<_> = own().filter_map(onward).collect();
        transfers.sort_by_key(|(to, _)| *to);
        transfers.dedup_by(|(to, part), (before, sum)| {
            let is_same = to == before;
            *sum += if is_same { *part } else { Spectrum::ZERO };
            is_same
        });
        // By chance alone cells scatter more than all there is.
        let most = transfers.iter().map(|(_, part)| *part).sum::<Spectrum>().max(Spectrum::ONE);
        transfers.iter_mut().for_each(|(_, part)| *part /= most);
        Self { source, transfers }
    }

    fn radiance(&self, values: &[Spectrum]) -> Spectrum {
        let scattered = self.transfers.iter().map(|(from, part)| *part * values[*from as usize]);
        self.source + scattered.sum::<Spectrum>()
    }
}

/// The radiance of all cells, after so many bounces at most.
fn solve(balances: &[Balance], most_bounces: u32) -> Vec<Spectrum> {
    let mut values: Vec<Spectrum> = balances.iter().map(|balance| balance.source).collect();
    for _ in 0..most_bounces {
        let next: Vec<_> = balances.par_iter().map(|balance| balance.radiance(&values)).collect();
        let sum = |value: Spectrum| f64::from(value.element_sum());
        let change: f64 = next.iter().zip(&values).map(|(a, b)| sum((*a - *b).abs())).sum();
        let all: f64 = next.iter().map(|value| sum(*value)).sum();
        values = next;
        if change <= SETTLED * all {
            break;
        }
    }
    values
}
