//! Null-collision tracking: delta tracking for distances (Woodcock et al. 1965), ratio tracking for transmittance
//! (Cramer 1978; Novak et al. 2014), both by the local majorants of a coarse lattice.
//!
//! Unbiased for any bounded medium, and random: the weights of the balance heuristic use the depth of the lattice's
//! means instead, the same for every strategy.

use super::{DistanceSample, Extinction};
use crate::{
    math::{Channels, RaySegment},
    sampling::Stream,
    volume::{Coarse, Piece},
};

/// Estimates that fall below this go on with a probability of their own size over it.
const ROULETTE: f32 = 0.05;

/// The stand-in is no deeper than this: flights that find a gap between dense voxels come through where the mean says
/// that none do, and a density of 0 in their weights would lose them.
const DEEPEST: f32 = 30.0;

/// The deterministic depth that replaces the medium's own.
#[inline]
pub fn stand_in<L: Channels>(medium: &Extinction, coarse: &Coarse, segment: &RaySegment) -> L {
    coarse.integral::<L>(segment).scaled(medium.scale).at_most(DEEPEST)
}

/// Tentative collisions along `segment`, at the rate of the local majorants: `visit` is given t and the
/// majorant [1/m], and returns whether to go on.
#[inline]
fn collisions(
    medium: &Extinction,
    coarse: &Coarse,
    segment: &RaySegment,
    stream: &mut Stream,
    mut visit: impl FnMut(f32, f32, &mut Stream) -> bool,
) {
    let mut remaining = stream.exponential();
    for Piece { cell, first, last } in coarse.pieces(segment) {
        let majorant = coarse.most(cell) * medium.scale;
        let mut at = first;
        // A cell without matter has no collisions: 0 < 0 is false, whatever depth remains.
        while remaining < majorant * (last - at) {
            at += remaining / majorant;
            remaining = stream.exponential();
            if !visit(at, majorant, stream) {
                return;
            }
        }
        remaining -= majorant * (last - at);
    }
}

/// Ratio tracking: an unbiased estimate of every channel's transmittance along `segment`.
#[inline]
pub fn transmittance<L: Channels>(
    medium: &Extinction,
    coarse: &Coarse,
    segment: &RaySegment,
    stream: &mut Stream,
) -> L {
    product(medium, coarse, segment, stream, |sigma_t: L, majorant| {
        L::splat(1.0) + sigma_t.scaled(-1.0 / majorant)
    })
}

/// The product of `factor` over tentative collisions, cut short by Russian roulette.
#[inline]
fn product<L: Channels>(
    medium: &Extinction,
    coarse: &Coarse,
    segment: &RaySegment,
    stream: &mut Stream,
    factor: impl Fn(L, f32) -> L,
) -> L {
    let mut product = L::splat(1.0);
    collisions(medium, coarse, segment, stream, |t, majorant, stream| {
        product = product * factor(medium.at::<L>(segment.at(t)), majorant);
        let size = product.to_spectrum().abs().max_element();
        if size >= ROULETTE {
            return true;
        }
        let goes_on = stream.uniform() * ROULETTE < size;
        product = if goes_on { product.scaled(ROULETTE / size) } else { L::splat(0.0) };
        goes_on
    });
    product
}

/// Delta tracking by the `hero` channel.
#[inline]
pub fn sample_distance<L: Channels>(
    medium: &Extinction,
    coarse: &Coarse,
    segment: &RaySegment,
    hero: usize,
    stream: &mut Stream,
) -> DistanceSample<L> {
    let mut collision = None;
    collisions(medium, coarse, segment, stream, |t, majorant, stream| {
        let real = stream.uniform() * majorant < medium.at::<L>(segment.at(t)).hero(hero);
        if real {
            collision = Some(t);
        }
        !real
    });
    let flown = RaySegment { length: collision.unwrap_or(segment.length), ..*segment };
    let depth = stand_in(medium, coarse, &flown);
    let ratio = transmittance_ratio(medium, coarse, &flown, hero, stream);
    DistanceSample { collision, depth, ratio, spent: 0.0 }
}

/// The rate of forced collisions is at least this fraction of the majorant: so matter that the means of cells
/// miss is found too.
const LEAST: f32 = 0.05;

/// The rate at which forced collisions are drawn in `cell` [1/m]: the mean, as in the stand-in.
#[inline]
fn forced_rate<L: Channels>(medium: &Extinction, coarse: &Coarse, cell: u32, hero: usize) -> f32 {
    let mean = L::from_spectrum(coarse.mean(cell)).hero(hero);
    mean.max(LEAST * coarse.most(cell)) * medium.scale
}

/// Its integral along `segment`.
pub fn forced_depth<L: Channels>(
    medium: &Extinction,
    coarse: &Coarse,
    segment: &RaySegment,
    hero: usize,
) -> f32 {
    let rate = |cell| forced_rate::<L>(medium, coarse, cell, hero);
    coarse.pieces(segment).map(|piece| rate(piece.cell) * (piece.last - piece.first)).sum()
}

/// A collision where [`forced_depth`] is `remaining`; what comes as far as that, and what collides there, is estimated.
pub fn force<L: Channels>(
    medium: &Extinction,
    coarse: &Coarse,
    segment: &RaySegment,
    hero: usize,
    remaining: f32,
    stream: &mut Stream,
) -> Option<DistanceSample<L>> {
    let mut left = remaining;
    let (t, rate) = coarse.pieces(segment).find_map(|piece| {
        let rate = forced_rate::<L>(medium, coarse, piece.cell, hero);
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
    let transmittance: L = transmittance(medium, coarse, &flown, stream);
    let ratio = transmittance.scaled(remaining.exp() * own / rate);
    Some(DistanceSample {
        collision: Some(t),
        depth: stand_in(medium, coarse, &flown),
        ratio,
        spent: remaining,
    })
}

/// An unbiased estimate of every channel's transmittance over the hero's: exp of the integral of the
/// difference, which may have either sign.
#[inline]
pub fn transmittance_ratio<L: Channels>(
    medium: &Extinction,
    coarse: &Coarse,
    flown: &RaySegment,
    hero: usize,
    stream: &mut Stream,
) -> L {
    if L::COUNT == 1 {
        return L::splat(1.0);
    }
    product(medium, coarse, flown, stream, |sigma_t: L, majorant| {
        let difference = sigma_t + L::splat(-sigma_t.hero(hero));
        L::splat(1.0) + difference.scaled(-1.0 / majorant)
    })
}
