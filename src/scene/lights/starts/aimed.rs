//! Starts that aim at targets although nothing is learnt.

use super::{Learnt, Starts, over_unlearnt};
use crate::{
    sampling::{
        Discrete, Stream,
        portal::{Aimed, Portal, Sphere},
        stream::Purpose,
    },
    scene::{
        accel::Geometry,
        lights::{EmissionSample, Lights},
    },
};
use rayon::prelude::*;

/// Most starts that tell how much power an emitter sends to a target...
const DRAWN: usize = 32;
/// ... and most of all emitters together, to all targets: as many as take a second or so.
const ALL_DRAWN: usize = 1 << 22;

impl Starts {
    /// Half of what is not left to the emitters aims at `targets`, from those emitters whose light sets out for any. Emitters
    /// and targets share it in proportion to the power from one to the other. None where there is none.
    pub fn aimed(lights: &Lights, geometry: &Geometry, targets: &[Sphere]) -> Option<Self> {
        let portals: Vec<Portal> = targets.iter().copied().map(Portal::around).collect();
        let pairs = lights.all.len() * portals.len();
        let drawn = (ALL_DRAWN / pairs.max(1)).clamp(1, DRAWN);
        let powers = |index| -> Vec<f32> {
            portals.iter().map(|portal| lights.power_through(geometry, index, portal, drawn)).collect()
        };
        let powers: Vec<Vec<f32>> = (0..lights.all.len()).into_par_iter().map(powers).collect();
        let totals: Vec<f64> =
            powers.iter().map(|powers| powers.iter().copied().map(f64::from).sum()).collect();
        let all: f64 = totals.iter().sum();
        if !(all > 0.0 && all.is_finite()) {
            return None;
        }
        let own = |index| lights.starts.probability_precisely(index);
        let emitters =
            Discrete::new(totals.iter().enumerate().map(|(index, total)| own(index) + total / all));
        let learn = |(index, powers): (usize, Vec<f32>)| Learnt {
            over_unlearnt: over_unlearnt(&emitters, lights, index),
            aimed: Aimed::shared(portals.iter().copied().zip(powers)),
            ..Learnt::default()
        };
        let learnt = powers.into_iter().enumerate().map(learn).collect();
        Some(Self { emitters, learnt, openings: super::Openings::default() })
    }
}

impl Lights {
    /// The power (W) that the emitter `index` sends through `portal`, or about so much, as `count` starts tell; 0 where it has
    /// no choice of directions.
    fn power_through(&self, geometry: &Geometry, index: usize, portal: &Portal, count: usize) -> f32 {
        let is_open = self.starts.probability(index) > 0.0 && self.all[index].emitter.is_connectible();
        if !is_open {
            return 0.0;
        }
        let learnt = Learnt { aimed: Aimed::all_at(*portal), ..Learnt::default() };
        let mut stream = Stream::new(0, index as u64, 0, Purpose::Pilot);
        let drawn = (0..count).filter_map(|_| self.start(geometry, index, 1.0, Some(&learnt), &mut stream));
        let power = |start: EmissionSample| {
            let (is_parallel, _) = self.measure(&start.start());
            let (position, direction) = (start.position(), start.ray.direction);
            let pdf = if is_parallel {
                portal.pdf_across(position, direction)
            } else {
                portal.pdf(position, direction)
            };
            start.throughput.max_element() * (start.unlearnt.direction / pdf)
        };
        let sum = drawn.map(power).filter(|power| power.is_finite()).sum::<f32>();
        self.all[index].emitter.sampling_weight * sum / count as f32
    }
}
