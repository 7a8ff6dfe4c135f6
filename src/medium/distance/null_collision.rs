//! Null-collision tracking: delta tracking for distances (Woodcock et al. 1965); ratio tracking (Cramer 1978) or
//! residual ratio tracking (Novak et al. 2014) for transmittance. All use bounds and means in the cells of a coarse
//! lattice.
//!
//! It is unbiased for any bounded medium, but random. The weights of the balance heuristic therefore use the depth of
//! the lattice's means, the same for every strategy.

use super::{Attenuation, DistanceMethod, DistanceSample, Extinction};
use crate::{
    math::{Channels, RaySegment, Spectrum, cells::Cells},
    sampling::Stream,
    volume::{Coarse, Piece, Summary},
};

/// A medium from afar, ready to be tracked.
#[derive(Clone, Debug)]
pub struct NullCollision {
    method: DistanceMethod,
    cells: Coarse<Cell>,
    /// All of the medium's box lies in the cells; the box around a turned grid does not.
    covers: bool,
}

/// What is known of extinction in a cell (1/m).
#[derive(Clone, Copy, Debug)]
struct Cell {
    /// The rate of tentative collisions of flights: no channel exceeds it anywhere.
    majorant: f32,
    /// The rate of tentative collisions of transmittance estimates: no channel is farther from its `control`.
    rate: f32,
    /// The mean of every channel.
    mean: Spectrum,
    /// The control extinction, which transmittance estimates need no collisions for: 0 in ratio tracking.
    control: Spectrum,
}

impl Cell {
    /// The cell of `summary` times `scale`; the control may exceed the least extinction by `reach`.
    fn new(summary: &Summary, scale: f32, reach: Option<f32>) -> Self {
        let (least, majorant) = (summary.least * scale, summary.most * scale);
        let mean = summary.mean * scale;
        let control = reach.map_or(Spectrum::ZERO, |reach| mean.min(Spectrum::splat(least + reach)));
        let rate = (majorant - control.min_element()).max(control.max_element() - least);
        // Ratio tracking needs no bound from below.
        let rate = if reach.is_some() { rate } else { majorant };
        Self { majorant, rate, mean, control }
    }
}

/// An estimate below this survives Russian roulette with the probability estimate / `ROULETTE`.
const ROULETTE: f32 = 0.05;

/// The stand-in is no deeper than this. Flights through a gap between dense voxels arrive where the mean says that none
/// do, and a density of 0 in their weights would lose them.
const DEEPEST: f32 = 30.0;

/// The control is the mean, but at most so many collisions per cell above the least extinction. Otherwise a line
/// through a gap in dense matter would make up for all that the mean takes away by rare and huge estimates.
const MOST_TAKEN: f32 = 1.0;

impl NullCollision {
    /// Prepares `method`, which is one of null collisions.
    pub fn new(medium: &Extinction, method: DistanceMethod) -> Self {
        let coarse = Coarse::over(&medium.volume, medium.low, medium.high);
        let side = coarse.cell_volume().cbrt() as f32;
        let is_residual = method == DistanceMethod::ResidualRatioTracking;
        // A flat box has cells without volume, and the control there is the mean.
        let reach = is_residual.then(|| MOST_TAKEN / side);
        let cells = coarse.map(|summary| Cell::new(summary, medium.scale, reach));
        Self { method, cells, covers: coarse.covers(medium.low, medium.high) }
    }

    /// The method.
    pub fn method(&self) -> DistanceMethod {
        self.method
    }

    /// The pieces of `segment` in the cells that it crosses within the medium.
    #[inline]
    fn pieces(&self, medium: &Extinction, segment: &RaySegment) -> Cells {
        let [first, last] = medium.clip(segment).unwrap_or([0.0, 0.0]);
        if self.covers {
            return self.cells.pieces_within(segment, [first, last]);
        }
        let [enters, leaves] = self.cells.clip(segment);
        self.cells.pieces_within(segment, [first.max(enters), last.min(leaves)])
    }

    /// The number of pieces that a transmittance estimate of `segment` goes through, and the approximate number of its
    /// collisions; none are counted in pieces that it hardly reaches.
    pub fn work(&self, medium: &Extinction, segment: &RaySegment) -> [f64; 2] {
        let (mut pieces, mut collisions, mut depth) = (0.0, 0.0, 0.0);
        for Piece { cell, first, last } in self.pieces(medium, segment) {
            let Cell { rate, mean, .. } = self.cells.cell(cell);
            pieces += 1.0;
            collisions += if depth < -ROULETTE.ln() { f64::from(rate * (last - first)) } else { 0.0 };
            depth += mean.max_element() * (last - first);
        }
        [pieces, collisions]
    }

    /// The deterministic depth that replaces the medium's own.
    #[inline]
    pub fn stand_in<L: Channels>(&self, medium: &Extinction, segment: &RaySegment) -> L {
        let depth =
            |Piece { cell, first, last }| L::from_spectrum(self.cells.cell(cell).mean).scaled(last - first);
        let pieces = self.pieces(medium, segment).map(depth);
        pieces.fold(L::splat(0.0), |sum, part| sum + part).at_most(DEEPEST)
    }

    /// The stand-in for the depth of `segment` and an unbiased estimate of every channel's transmittance; none where
    /// that is 0.
    #[inline]
    pub fn attenuation<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        stream: &mut Stream,
    ) -> Option<Attenuation<L>> {
        self.track(medium, segment, stream, |sigma_t| sigma_t)
    }

    /// An unbiased estimate of every channel's transmittance over the hero's: exp of the integral of the
    /// difference, which may have either sign.
    #[inline]
    pub fn transmittance_ratio<L: Channels>(
        &self,
        medium: &Extinction,
        flown: &RaySegment,
        hero: usize,
        stream: &mut Stream,
    ) -> L {
        if L::COUNT == 1 {
            return L::splat(1.0);
        }
        let difference = |sigma_t: L| sigma_t + L::splat(-sigma_t.hero(hero));
        self.track(medium, flown, stream, difference).map_or(L::splat(0.0), |found| found.transmittance)
    }

    /// Residual ratio tracking of `part`, which is linear in extinction: the control's share of the depth is known, and
    /// the residual changes the estimate at collisions.
    #[inline(always)]
    fn track<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        stream: &mut Stream,
        part: impl Fn(L) -> L,
    ) -> Option<Attenuation<L>> {
        let (mut depth, mut pending, mut estimate) = (L::splat(0.0), L::splat(0.0), L::splat(1.0));
        let mut remaining = stream.exponential();
        for Piece { cell, first, last } in self.pieces(medium, segment) {
            let Cell { rate, mean, control, .. } = self.cells.cell(cell);
            let control = part(L::from_spectrum(*control));
            depth = depth + L::from_spectrum(*mean).scaled(last - first);
            let mut at = first;
            // A cell without matter has no collisions: the comparison with 0 is false, whatever depth remains.
            while remaining < rate * (last - at) {
                let step = remaining / rate;
                at += step;
                let residual = part(medium.at::<L>(segment.at(at))) + control.scaled(-1.0);
                let factor = L::splat(1.0) + residual.scaled(-1.0 / rate);
                estimate = estimate * (pending + control.scaled(step)).exp_neg() * factor;
                estimate = survivor(estimate, stream)?;
                (pending, remaining) = (L::splat(0.0), stream.exponential());
            }
            remaining -= rate * (last - at);
            pending = pending + control.scaled(last - at);
        }
        Some(Attenuation { depth: depth.at_most(DEEPEST), transmittance: estimate * pending.exp_neg() })
    }

    /// Delta tracking by the `hero` channel.
    #[inline]
    pub fn sample_distance<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        hero: usize,
        stream: &mut Stream,
    ) -> DistanceSample<L> {
        let (collision, depth) = self.collision(medium, segment, hero, stream);
        let flown = RaySegment { length: collision.unwrap_or(segment.length), ..*segment };
        let ratio = self.transmittance_ratio(medium, &flown, hero, stream);
        DistanceSample { collision, component: 0, depth, ratio, spent: 0.0 }
    }

    /// The first real collision, and the stand-in for the depth up to there.
    #[inline(always)]
    fn collision<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        hero: usize,
        stream: &mut Stream,
    ) -> (Option<f32>, L) {
        let mut depth = L::splat(0.0);
        let mut remaining = stream.exponential();
        for Piece { cell, first, last } in self.pieces(medium, segment) {
            let Cell { majorant, mean, .. } = self.cells.cell(cell);
            let mean = L::from_spectrum(*mean);
            let mut at = first;
            while remaining < majorant * (last - at) {
                at += remaining / majorant;
                remaining = stream.exponential();
                if stream.uniform() * majorant < medium.at::<L>(segment.at(at)).hero(hero) {
                    return (Some(at), (depth + mean.scaled(at - first)).at_most(DEEPEST));
                }
            }
            remaining -= majorant * (last - at);
            depth = depth + mean.scaled(last - first);
        }
        (None, depth.at_most(DEEPEST))
    }
}

/// `estimate` after Russian roulette; none where it ends there.
#[inline]
fn survivor<L: Channels>(estimate: L, stream: &mut Stream) -> Option<L> {
    let size = estimate.to_spectrum().abs().max_element();
    if size >= ROULETTE {
        return Some(estimate);
    }
    (stream.uniform() * ROULETTE < size).then(|| estimate.scaled(ROULETTE / size))
}

/// The rate of forced collisions is at least this fraction of the majorant, to find matter that the means of cells
/// miss.
const LEAST: f32 = 0.05;

impl Cell {
    /// The rate at which forced collisions are drawn (1/m): the mean, as in the stand-in.
    #[inline]
    fn forced<L: Channels>(&self, hero: usize) -> f32 {
        L::from_spectrum(self.mean).hero(hero).max(LEAST * self.majorant)
    }
}

impl NullCollision {
    /// The integral along `segment` of the rate of forced collisions.
    pub fn forced_depth<L: Channels>(&self, medium: &Extinction, segment: &RaySegment, hero: usize) -> f32 {
        let rate = |cell| self.cells.cell(cell).forced::<L>(hero);
        self.pieces(medium, segment).map(|piece| rate(piece.cell) * (piece.last - piece.first)).sum()
    }

    /// A collision where [`Self::forced_depth`] is `remaining`; its ratio contains an estimate of the transmittance up
    /// to it.
    pub fn force<L: Channels>(
        &self,
        medium: &Extinction,
        segment: &RaySegment,
        hero: usize,
        remaining: f32,
        stream: &mut Stream,
    ) -> Option<DistanceSample<L>> {
        let mut left = remaining;
        let (t, rate) = self.pieces(medium, segment).find_map(|piece| {
            let rate = self.cells.cell(piece.cell).forced::<L>(hero);
            let depth = rate * (piece.last - piece.first);
            let here = left < depth;
            let t = piece.first + left / rate;
            left -= depth;
            here.then_some((t, rate))
        })?;
        let own = medium.at::<L>(segment.at(t)).hero(hero);
        if own <= 0.0 {
            return None;
        }
        let flown = RaySegment { length: t, ..*segment };
        let Attenuation { depth, transmittance } = self.attenuation::<L>(medium, &flown, stream)?;
        let ratio = transmittance.scaled(remaining.exp() * own / rate);
        Some(DistanceSample { collision: Some(t), component: 0, depth, ratio, spent: remaining })
    }
}
