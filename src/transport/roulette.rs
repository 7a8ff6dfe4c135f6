//! When walks end: by Russian roulette at every vertex, with a probability to go on that is a function of the vertex alone,
//! so that it can be part of all densities (LW96 eq. 8 and 9).
//!
//! # Where camera subpaths run alone
//! The roulette of a vertex is drawn at the end of the flight that leaves it, after the emitter that this flight may have
//! hit is counted: a walk that ends has seen the sky once more, for the price of one flight. Strategies s = 0 and s = 1 make
//! a path by the same walk up to the vertex next to the emitter. Both have passed the roulettes of all vertices before it,
//! and neither that of this vertex: so no roulette is part of the ratio of their densities, and it multiplies the throughput
//! and the density of what follows only ([`super::vertex::Subpath::survive`]). Light subpaths could not tell the last vertex
//! of such a walk from others.
//!
//! # How long walks are
//! To go on with the albedo as probability keeps throughputs even, and is right in closed rooms, where there is always more
//! of the walk to pay for. Under a sky most walks soon leave the scene: to end them by roulette saves little time, and
//! brings most of the noise that is left. There, where camera subpaths run alone, walks put roulette off. Such a walk owes
//! the product of all albedos so far over that of its probabilities to go on, and goes on with the eighth root of what it
//! owes: soon it owes the seventh power of the albedo and no less, so that in white clouds it is no longer than with the
//! albedo. [`super::lengths`] says where that is worth it.

use crate::settings::options::Survival;

/// When walks end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Roulette {
    /// At a vertex, by its albedo.
    AtOnce(Survival),
    /// Of camera subpaths that run alone: at the end of the flight from it, by all albedos so far.
    Late,
}

/// What is still to be drawn for a walk.
#[derive(Clone, Copy, Debug)]
pub struct Pending {
    /// The probability to go on at the end of the flight.
    pub survival: f32,
    /// The product of all albedos over that of all probabilities to go on, this one among them.
    owed: f32,
}

impl Pending {
    /// Nothing.
    pub const NONE: Self = Self { survival: 1.0, owed: 1.0 };

    /// How often walks that end by the albedo come so far, over how often this one does.
    #[inline]
    pub fn by_albedo(self) -> f32 {
        self.survival * self.owed
    }
}

impl Roulette {
    /// The probability to go on at once from a vertex of `albedo`, and what is pending behind it, where `before` was.
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

/// The logarithm of the probability that a walk goes on from `vertices` of this mean logarithm of the albedo, where roulette is
/// late. What it owes is seven eighths of what it owed before and of one albedo more.
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
