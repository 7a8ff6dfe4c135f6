//! Portals: the places where paths that reach the image cross, wherever they come from. A few dozen walks show them,
//! long before any table of directions is of use.

use super::{
    Thinning,
    portal::{Passage, Portal, Sphere},
};
use crate::math::Vec3;
use rayon::prelude::*;

/// Most portals.
const MOST: usize = 4;
/// Radii: the first is the extent of the places times this power of a half, each further one half of the one before.
const LARGEST: i32 = 3;
const RADII: usize = 6;
/// Least gain in a passage's log likelihood by a portal. Measured with guides in scenes/efficiency: keyhole 0.5 to 1.3, skylight
/// 0.15 to 0.7, headlights and door_ajar up to 0.04, in others nothing.
const LEAST: f64 = 0.1;
/// Rays whose squared sine is less cross anywhere.
const PARALLEL: f32 = 1e-3;

/// How much is looked at.
#[derive(Clone, Copy, Debug)]
pub struct Search {
    /// Passages of each fold whose crossings are tried, pair by pair.
    pub crossed: usize,
    /// Passages of each fold that judge.
    pub judges: usize,
    /// Fewest passages of each fold through a portal: one with fewer is chance.
    pub fewest: u32,
}

/// The portals of `passages` among places of such an `extent` (m), the most telling first. Each of their folds has to
/// show it.
pub fn find(passages: impl Iterator<Item = Passage> + Clone, extent: f32, search: Search) -> Vec<Portal> {
    let radius = |index| extent * 0.5f32.powi(LARGEST + index as i32);
    let radii_squared: [f32; RADII] = std::array::from_fn(|index| radius(index).powi(2));
    let mut folds = [0, 1].map(|fold| Fold::of(passages.clone(), fold, search.judges));
    let centres: Vec<Vec3> = folds.iter().flat_map(|fold| crossings(&fold.judges, search.crossed)).collect();
    let mut found = Vec::new();
    while found.len() < MOST {
        let best = |centre: &Vec3| {
            let [a, b] = folds.each_ref().map(|fold| fold.gains(*centre, &radii_squared, search.fewest));
            let gains = a.into_iter().zip(b).map(|(a, b)| a.min(b));
            let spheres = radii_squared.map(|radius_squared| Sphere { centre: *centre, radius_squared });
            gains.zip(spheres).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let of_centres: Vec<Option<(f64, Sphere)>> = centres.par_iter().map(best).collect();
        let best = of_centres.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, sphere)) = best.filter(|(gain, _)| *gain > LEAST) else { break };
        let portal = Portal::fitted(sphere, folds.iter().flat_map(|fold| &fold.judges));
        let outermost = portal.outermost();
        folds.iter_mut().for_each(|fold| fold.judges.retain(|judge| !judge.crosses(&outermost)));
        found.push(portal);
    }
    found
}

/// One of two independent parts of all passages.
struct Fold {
    judges: Vec<Passage>,
    /// Total weight of the judges.
    weight: f64,
}

impl Fold {
    /// About so many `judges` of its passages, in proportion to their weights.
    fn of(passages: impl Iterator<Item = Passage> + Clone, fold: usize, judges: usize) -> Self {
        let own = passages.filter(|passage| passage.fold == fold && passage.unaimed > 0.0);
        let step = own.clone().map(|passage| f64::from(passage.weight)).sum::<f64>() / judges as f64;
        let mut thinning = Thinning::by(step as f32);
        let judge = |passage: Passage| {
            let weight = thinning.keeps(passage.weight)?;
            Some(Passage { weight, ..passage })
        };
        let judges: Vec<Passage> = own.filter_map(judge).collect();
        Self { weight: judges.iter().map(|judge| f64::from(judge.weight)).sum(), judges }
    }

    /// Gains in a passage's log likelihood by spheres of these `radii_squared` around `centre`, if each gets as many
    /// directions as pass through it and the others remain as they are.
    fn gains(&self, centre: Vec3, radii_squared: &[f32; RADII], fewest: u32) -> [f64; RADII] {
        let (mut count, mut through, mut gains) = ([0; RADII], [0.0; RADII], [0.0; RADII]);
        for judge in &self.judges {
            let Some(miss) = judge.miss(centre) else { continue };
            let hit = |(_, radius_squared): &(usize, &f32)| miss <= **radius_squared;
            // Near a portal, aiming at it says little.
            for (index, radius_squared) in radii_squared.iter().enumerate().take_while(hit) {
                let sphere = Sphere { centre, radius_squared: *radius_squared };
                if judge.begins_outside(&sphere.outermost()) {
                    let (ratio, weight) = (judge.density(&sphere) / judge.unaimed, f64::from(judge.weight));
                    count[index] += 1;
                    through[index] += weight;
                    gains[index] += weight * f64::from(ratio).ln();
                }
            }
        }
        std::array::from_fn(|index| {
            let share = through[index] / self.weight;
            let of = |share: f64| if share > 0.0 { share * share.ln() } else { 0.0 };
            if count[index] >= fewest {
                gains[index] / self.weight + of(share) + of(1.0 - share)
            } else {
                0.0
            }
        })
    }
}

/// Where so many of the judges, `crossed` of them, cross each other.
fn crossings(judges: &[Passage], crossed: usize) -> Vec<Vec3> {
    let every = judges.len().div_ceil(crossed).max(1);
    let some: Vec<&Passage> = judges.iter().step_by(every).collect();
    let pairs = some.iter().enumerate().flat_map(|(index, a)| some[..index].iter().map(move |b| (a, b)));
    pairs.filter_map(|(a, b)| crossing(a, b)).collect()
}

/// The midpoint between the closest points of two rays; none if one of these is an origin, or if the rays are parallel.
/// Parallel light has no origin, and crosses anywhere.
fn crossing(a: &Passage, b: &Passage) -> Option<Vec3> {
    let (u, v, between) = (a.direction, b.direction, b.position - a.position);
    let cosine = u.dot(v);
    let sine_squared = u.cross(v).length_squared();
    if sine_squared <= PARALLEL {
        let beside = between - between.dot(u) * u;
        return (a.is_parallel && b.is_parallel).then(|| a.position + 0.5 * beside);
    }
    let (s, t) = (between.dot(u - cosine * v), between.dot(cosine * u - v));
    let (s, t) = (s / sine_squared, t / sine_squared);
    ((a.is_parallel || s > 0.0) && (b.is_parallel || t > 0.0))
        .then(|| 0.5 * ((a.position + s * u) + (b.position + t * v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        math::{vec3, warp},
        sampling::{Stream, stream::Purpose},
    };

    const HOLE: Vec3 = vec3(0.4, -0.7, 0.2);
    const SIZE: f32 = 0.05;

    const EXTENT: f32 = 4.0;
    const SEARCH: Search = Search { crossed: 32, judges: 1024, fewest: 5 };

    /// Of walks in a room 4 m wide, of which `through` go through the hole, and the others anywhere.
    fn passages(count: usize, through: f32, seed: u64) -> Vec<Passage> {
        let mut stream = Stream::new(seed, 0, 0, Purpose::Study);
        let passage = |index: usize| {
            let [a, b, c] = [stream.square(), stream.square(), stream.square()];
            let position = 4.0 * vec3(a.x - 0.5, a.y - 0.5, b.x - 0.5);
            let aim = HOLE + SIZE * warp::to_sphere(c);
            let is_through = stream.uniform() < through;
            let direction = if is_through { (aim - position).normalize() } else { warp::to_sphere(c) };
            let (weight, unaimed) = (0.5 + b.y, warp::SPHERE_PDF);
            Passage { position, direction, is_parallel: false, weight, unaimed, fold: index % 2 }
        };
        (0..count).map(passage).collect()
    }

    /// Two hundred walks are enough to tell, and a few large ones do not drown it.
    #[test]
    fn a_hole_is_found_by_few_of_the_walks() {
        for (count, through) in [(200, 0.25), (400, 0.12), (5000, 0.12), (5000, 1.0)] {
            for seed in 0..4 {
                let found = find(passages(count, through, seed).into_iter(), EXTENT, SEARCH);
                let first = found.first().unwrap_or_else(|| panic!("{count}, {through}, {seed}: none"));
                let Sphere { centre, radius_squared } = first.smallest;
                let radius = radius_squared.sqrt();
                assert!(centre.distance(HOLE) < radius, "{count}, {through}, {seed}: {found:?}");
                assert!((0.5 * SIZE..3.0 * SIZE).contains(&radius), "{count}, {through}, {seed}: {found:?}");
            }
        }
    }

    #[test]
    fn where_walks_go_anywhere_there_is_none() {
        for (count, seed) in [(0, 0), (1, 1), (2, 2), (40, 3), (200, 4), (200, 5), (200, 6), (20_000, 7)] {
            assert_eq!(find(passages(count, 0.0, seed).into_iter(), EXTENT, SEARCH), [], "{count}, {seed}");
        }
        // All in one place, in one direction, or of no weight.
        let all = passages(200, 0.3, 8);
        let same = |change: &dyn Fn(&mut Passage)| {
            let mut all = all.clone();
            all.iter_mut().for_each(change);
            find(all.into_iter(), EXTENT, SEARCH)
        };
        assert_eq!(same(&|passage| passage.position = Vec3::ONE), []);
        assert_eq!(same(&|passage| passage.direction = Vec3::X), []);
        assert_eq!(same(&|passage| passage.weight = 0.0), []);
        assert_eq!(same(&|passage| passage.unaimed = 0.0), []);
    }
}
