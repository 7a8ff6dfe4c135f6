//! When walks end: by Russian roulette at every vertex. The survival probability is a function of the vertex alone, so
//! that all densities can contain it (LW96 eq. 8 and 9).
//!
//! # Where camera subpaths run alone
//! The roulette of a vertex is drawn at the end of the flight that leaves it, after any emitter that this flight hit is
//! counted: a walk that ends has seen the sky once more, for the price of one flight. Strategies s = 0 and s = 1 make a
//! path by the same walk up to the vertex next to the emitter. Both have passed the roulettes of all vertices before
//! this one, and neither has passed its own. So roulette cancels in the ratio of their densities; it multiplies only
//! the throughput and the density of what follows ([`super::vertex::Subpath::survive`]). Light subpaths could not tell
//! the last vertex of such a walk from others.
//!
//! # How long walks are
//! Survival by the albedo keeps throughputs even. It is right in closed rooms, where walks would go on and on. Under a
//! sky most walks soon leave the scene: roulette saves little time there, and causes most of the remaining noise. If
//! camera subpaths run alone there, walks put roulette off. Such a walk owes the product of all albedos so far over
//! that of its survival probabilities, and survives with the eighth root of what it owes. This debt settles at the
//! seventh power of the albedo, and survival at the albedo: in white clouds the walk is no longer than by the albedo.
//! [`super::lengths`] says where this pays.

use crate::settings::options::Survival;

/// When walks end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roulette {
    /// At a vertex, by its albedo.
    AtOnce(Survival),
    /// For camera subpaths that run alone: at the end of the next flight, by all albedos so far.
    Late,
}

/// The roulette that a walk has put off.
#[derive(Clone, Copy, Debug)]
pub struct Pending {
    /// Survival probability at the end of the flight.
    pub survival: f32,
    /// The product of all albedos over that of all survival probabilities, including this one.
    owed: f32,
}

impl Pending {
    /// Nothing.
    pub const NONE: Self = Self { survival: 1.0, owed: 1.0 };

    /// Probability that a walk with roulette by the albedo gets this far, over that of this walk.
    #[inline]
    pub fn by_albedo(self) -> f32 {
        self.survival * self.owed
    }
}

impl Roulette {
    /// The survival probability at a vertex of `albedo`, and the roulette pending after it, where `before` was pending.
    #[inline]
    pub fn at(self, albedo: f32, before: Pending) -> (f32, Pending) {
        match self {
            Self::AtOnce(survival) => (survival.of(albedo), Pending::NONE),
            Self::Late if albedo > 0.0 => {
                let owed = before.owed * albedo;
                let survival = owed.sqrt().sqrt().sqrt();
                (1.0, Pending { survival, owed: owed / survival })
            }
            // No weight of 0 / 0.
            Self::Late => (0.0, before),
        }
    }
}

/// Log probability that a walk with late roulette survives `vertices` vertices with this mean log `albedo`. In
/// logarithms, each debt is seven eighths of the debt before and one more albedo.
pub fn late(vertices: f32, albedo: f32) -> f32 {
    const KEPT: f32 = 7.0 / 8.0;
    albedo * (vertices - KEPT / (1.0 - KEPT) * (1.0 - KEPT.powf(vertices)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// However long a walk is, it owes no less than the seventh power of the albedo: it goes on as by the albedo.
    #[test]
    fn late_walks_end_as_often_in_the_end() {
        for albedo in [0.3f32, 0.9, 0.999] {
            let mut pending = Pending::NONE;
            for _ in 0..200 {
                pending = Roulette::Late.at(albedo, pending).1;
            }
            assert!((pending.survival / albedo - 1.0).abs() < 1e-3, "{albedo}: {pending:?}");
            assert!((pending.owed / albedo.powi(7) - 1.0).abs() < 1e-2, "{albedo}: {pending:?}");
        }
        let (mut pending, mut product) = (Pending::NONE, 1.0);
        for vertices in 1..20 {
            pending = Roulette::Late.at(0.7, pending).1;
            product *= pending.survival;
            assert!(
                (late(vertices as f32, 0.7f32.ln()) - product.ln()).abs() < 1e-4,
                "{vertices}: {product}"
            );
        }
        let (survival, Pending { owed, .. }) = Roulette::Late.at(0.0, Pending::NONE);
        assert_eq!((survival, owed), (0.0, 1.0));
    }
}
