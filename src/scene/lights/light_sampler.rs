//! Which emitter next-event estimation takes from a reference point, and of an emissive medium which cell.

mod leaves;

use super::{light::Light, light_tree::LightTree};
use crate::{
    math::Vec3,
    medium::Emission,
    sampling::{Discrete, Stream},
};
pub(super) use leaves::Extent;

/// Probability of sampling regardless of the reference: the tree ignores visibility, and may far underestimate an
/// emitter.
const REGARDLESS: f64 = 0.2;

/// The distribution.
#[derive(Clone, Debug, Default)]
pub(super) struct LightSampler {
    /// The emitter, if it is the only one.
    only: Option<usize>,
    /// Half by power, half uniform, whatever the reference.
    regardless: Discrete,
    /// By estimated contribution to the reference; none where there is nothing to choose. The first leaves are the
    /// emitters.
    tree: Option<LightTree>,
    /// The emissive media whose cells are leaves.
    media: Vec<Cells>,
}

/// The leaves that are cells of an emissive medium.
#[derive(Clone, Copy, Debug)]
struct Cells {
    emitter: u32,
    /// The first of them.
    first: u32,
}

/// What was taken.
#[derive(Clone, Copy, Debug)]
pub(super) enum Taken {
    /// An emitter, with this probability.
    Emitter(usize, f32),
    /// An emissive medium; of it a cell, or any part of it.
    Medium(usize, Option<u32>),
}

impl LightSampler {
    /// Over `all` emitters that can be connected to, of the given powers.
    pub(super) fn new(all: &[Light], powers: &[f64], extent: &Extent<'_>) -> Self {
        let joinable =
            |(light, power): (&Light, &f64)| if light.emitter.is_connectible() { *power } else { 0.0 };
        let powers: Vec<f64> = all.iter().zip(powers).map(joinable).collect();
        let (tree, media) = extent.tree(all, &powers);
        let mut lit = (0..powers.len()).filter(|index| powers[*index] > 0.0);
        let only = lit.next().filter(|_| tree.is_none() && lit.next().is_none());
        drop(lit);
        Self { only, regardless: regardless(powers.into_iter()), tree, media }
    }

    /// True where nothing can be connected to.
    pub(super) fn is_empty(&self) -> bool {
        self.regardless.is_empty()
    }

    /// Samples an emitter for `reference`; a single one takes no random number.
    #[inline]
    pub(super) fn sample(&self, reference: Vec3, stream: &mut Stream) -> Taken {
        if let Some(index) = self.only {
            return Taken::Emitter(index, 1.0);
        }
        let u = stream.uniform_precisely();
        let Some(tree) = &self.tree else {
            let (index, probability) = self.regardless.sample_precisely(u);
            return Taken::Emitter(index, probability as f32);
        };
        if u < REGARDLESS {
            let (index, probability) = self.regardless.sample_precisely(u / REGARDLESS);
            if self.cells_of(index).is_some() {
                return Taken::Medium(index, None);
            }
            return Taken::Emitter(index, mixed(probability, tree.probability(index as u32, reference)));
        }
        let (leaf, by_tree) = tree.sample(reference, (u - REGARDLESS) / (1.0 - REGARDLESS));
        if let Some(cells) = self.media.iter().rev().find(|cells| cells.first <= leaf) {
            return Taken::Medium(cells.emitter as usize, Some(leaf - cells.first));
        }
        let index = leaf as usize;
        Taken::Emitter(index, mixed(self.regardless.probability_precisely(index), by_tree))
    }

    /// Probability of the emitter `index` for `reference`; not for a medium of several leaves.
    #[inline]
    pub(super) fn probability(&self, index: usize, reference: Vec3) -> f32 {
        if let Some(only) = self.only {
            return if index == only { 1.0 } else { 0.0 };
        }
        let regardless = self.regardless.probability_precisely(index);
        match &self.tree {
            Some(tree) if regardless > 0.0 => mixed(regardless, tree.probability(index as u32, reference)),
            _ => regardless as f32,
        }
    }

    /// Density of `position` in the emissive medium `index` for `reference`, the choice of the medium included (1/m^3).
    #[inline]
    pub(super) fn pdf_vol(&self, index: usize, emission: &Emission, position: Vec3, reference: Vec3) -> f32 {
        let by_power = emission.pdf_vol(position);
        let (Some(tree), Some(cells)) = (&self.tree, self.cells_of(index)) else {
            return self.probability(index, reference) * by_power;
        };
        let Some(cell) = emission.cell_at(position).filter(|_| by_power > 0.0) else { return 0.0 };
        let regardless = self.regardless.probability_precisely(index) * f64::from(by_power);
        mixed(regardless, tree.probability(cells.first + cell, reference) * emission.pdf_vol_in_cell())
    }

    #[inline]
    fn cells_of(&self, emitter: usize) -> Option<Cells> {
        self.media.iter().copied().find(|cells| cells.emitter as usize == emitter)
    }
}

/// Half by power, half uniform over emitters with power: a strong distant one cannot hide a weak near one.
pub(super) fn regardless(powers: impl Iterator<Item = f64> + Clone) -> Discrete {
    let total: f64 = powers.clone().sum();
    let count = powers.clone().filter(|power| *power > 0.0).count() as f64;
    Discrete::new(powers.map(|power| if power > 0.0 { power / total + 1.0 / count } else { 0.0 }))
}

#[inline]
fn mixed(regardless: f64, by_tree: f32) -> f32 {
    (REGARDLESS * regardless) as f32 + (1.0 - REGARDLESS) as f32 * by_tree
}
