//! Portals: the places where paths that reach the image cross, wherever they come from. A few dozen walks show them,
//! long before any table of directions is of use.

use super::{
    Lesson,
    portal::{Portal, Sphere},
};
use crate::{math::Vec3, sampling::Thinning};
use rayon::prelude::*;

/// Most portals.
const MOST: usize = 4;
/// Lessons of each fold whose crossings are tried, pair by pair.
const CROSSED: usize = 32;
/// Lessons of each fold that judge.
const JUDGES: usize = 1024;
/// Radii: the first is the extent of all lessons times this power of a half, each further one half of the one before.
const LARGEST: i32 = 3;
const RADII: usize = 6;
/// Least gain in a lesson's log likelihood by a portal. Measured in scenes/efficiency: keyhole 0.5 to 1.3, skylight
/// 0.15 to 0.7, headlights and door_ajar up to 0.04, in others nothing.
const LEAST: f64 = 0.1;
/// Fewest lessons of a fold through a portal: one with fewer is chance.
const FEWEST: u32 = 5;
/// Rays whose squared sine is less cross anywhere.
const PARALLEL: f32 = 1e-3;

/// The portals of `lessons`, the most telling first. Each of their folds has to show it.
pub(super) fn find(lessons: &[Lesson]) -> Vec<Portal> {
    let (low, high) = lessons.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), lesson| {
        (low.min(lesson.position), high.max(lesson.position))
    });
    let radius = |index| (high - low).max_element() * 0.5f32.powi(LARGEST + index as i32);
    let radii_squared: [f32; RADII] = std::array::from_fn(|index| radius(index).powi(2));
    let mut folds = [0, 1].map(|fold| Fold::of(lessons, fold));
    let centres: Vec<Vec3> = folds.iter().flat_map(|fold| crossings(&fold.judges)).collect();
    let mut found = Vec::new();
    while found.len() < MOST {
        let best = |centre: &Vec3| {
            let [a, b] = folds.each_ref().map(|fold| fold.gains(*centre, &radii_squared));
            let gains = a.into_iter().zip(b).map(|(a, b)| a.min(b));
            let spheres = radii_squared.map(|radius_squared| Sphere { centre: *centre, radius_squared });
            gains.zip(spheres).max_by(|a, b| a.0.total_cmp(&b.0))
        };
        let of_centres: Vec<Option<(f64, Sphere)>> = centres.par_iter().map(best).collect();
        let best = of_centres.into_iter().flatten().max_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, sphere)) = best.filter(|(gain, _)| *gain > LEAST) else { break };
        let judges =
            folds.iter().flat_map(|fold| &fold.judges).map(|judge| (judge.weight as f32, &judge.lesson));
        let portal = Portal::fitted(sphere, judges);
        let outermost = portal.outermost();
        folds.iter_mut().for_each(|fold| fold.judges.retain(|judge| !outermost.is_crossed(&judge.lesson)));
        found.push(portal);
    }
    found
}

/// A lesson, and how much it counts.
struct Judge {
    lesson: Lesson,
    weight: f64,
}

/// One of two independent parts of all lessons.
struct Fold {
    judges: Vec<Judge>,
    /// Total weight of the judges.
    weight: f64,
}

impl Fold {
    /// About [`JUDGES`] of its lessons, in proportion to their weights.
    fn of(lessons: &[Lesson], fold: usize) -> Self {
        let own = || lessons.iter().filter(|lesson| lesson.fold == fold && lesson.unguided > 0.0);
        let step = own().map(|lesson| f64::from(lesson.weight)).sum::<f64>() / JUDGES as f64;
        let mut thinning = Thinning::by(step as f32);
        let judge = |lesson: &Lesson| {
            let weight = thinning.keeps(lesson.weight)?;
            Some(Judge { lesson: *lesson, weight: f64::from(weight) })
        };
        let judges: Vec<Judge> = own().filter_map(judge).collect();
        Self { weight: judges.iter().map(|judge| judge.weight).sum(), judges }
    }

    /// Gains in a lesson's log likelihood by spheres of these `radii_squared` around `centre`, if each gets as many
    /// directions as pass through it and the others remain as they are.
    fn gains(&self, centre: Vec3, radii_squared: &[f32; RADII]) -> [f64; RADII] {
        let (mut count, mut through, mut gains) = ([0; RADII], [0.0; RADII], [0.0; RADII]);
        for Judge { lesson, weight } in &self.judges {
            let Some(miss) = Sphere::passes(centre, lesson.position, lesson.direction) else { continue };
            let hit = |(_, radius_squared): &(usize, &f32)| miss <= **radius_squared;
            for (index, radius_squared) in radii_squared.iter().enumerate().take_while(hit) {
                let sphere = Sphere { centre, radius_squared: *radius_squared };
                if sphere.is_crossed(lesson) {
                    let ratio = sphere.pdf(lesson.position, lesson.direction) / lesson.unguided;
                    count[index] += 1;
                    through[index] += weight;
                    gains[index] += weight * f64::from(ratio).ln();
                }
            }
        }
        std::array::from_fn(|index| {
            let share = through[index] / self.weight;
            let of = |share: f64| if share > 0.0 { share * share.ln() } else { 0.0 };
            if count[index] >= FEWEST {
                gains[index] / self.weight + of(share) + of(1.0 - share)
            } else {
                0.0
            }
        })
    }
}

/// Where some of the judges cross each other.
fn crossings(judges: &[Judge]) -> Vec<Vec3> {
    let every = judges.len().div_ceil(CROSSED).max(1);
    let some: Vec<&Lesson> = judges.iter().step_by(every).map(|judge| &judge.lesson).collect();
    let pairs = some.iter().enumerate().flat_map(|(index, a)| some[..index].iter().map(move |b| (a, b)));
    pairs.filter_map(|(a, b)| crossing(a, b)).collect()
}

/// The midpoint between the closest points of two rays; none if one of these is an origin, or if the rays are parallel.
fn crossing(a: &Lesson, b: &Lesson) -> Option<Vec3> {
    let (u, v, between) = (a.direction, b.direction, b.position - a.position);
    let cosine = u.dot(v);
    let sine_squared = u.cross(v).length_squared();
    let (s, t) = (between.dot(u - cosine * v), between.dot(cosine * u - v));
    let (s, t) = (s / sine_squared, t / sine_squared);
    (sine_squared > PARALLEL && s > 0.0 && t > 0.0)
        .then(|| 0.5 * ((a.position + s * u) + (b.position + t * v)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bsdf::Transport,
        math::{vec3, warp},
        sampling::{Stream, stream::Purpose},
    };

    const HOLE: Vec3 = vec3(0.4, -0.7, 0.2);
    const SIZE: f32 = 0.05;

    /// Of walks in a room 4 m wide, of which `through` go through the hole, and the others anywhere.
    fn lessons(count: usize, through: f32, seed: u64) -> Vec<Lesson> {
        let mut stream = Stream::new(seed, 0, 0, Purpose::Study);
        let lesson = |index: usize| {
            let [a, b, c] = [stream.square(), stream.square(), stream.square()];
            let position = 4.0 * vec3(a.x - 0.5, a.y - 0.5, b.x - 0.5);
            let aim = HOLE + SIZE * warp::to_sphere(c);
            let is_through = stream.uniform() < through;
            let direction = if is_through { (aim - position).normalize() } else { warp::to_sphere(c) };
            let (transport, weight) = (Transport::Radiance, 0.5 + b.y);
            let (normal, unguided) = (None, warp::SPHERE_PDF);
            Lesson { position, normal, transport, direction, weight, unguided, fold: index % 2 }
        };
        (0..count).map(lesson).collect()
    }

    /// Two hundred walks are enough to tell, and a few large ones do not drown it.
    #[test]
    fn a_hole_is_found_by_few_of_the_walks() {
        for (count, through) in [(200, 0.25), (400, 0.12), (5000, 0.12), (5000, 1.0)] {
            for seed in 0..4 {
                let found = find(&lessons(count, through, seed));
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
            assert_eq!(find(&lessons(count, 0.0, seed)), [], "{count}, {seed}");
        }
        // All in one place, in one direction, or of no weight.
        let all = lessons(200, 0.3, 8);
        let same = |change: &dyn Fn(&mut Lesson)| {
            let mut all = all.clone();
            all.iter_mut().for_each(change);
            find(&all)
        };
        assert_eq!(same(&|lesson| lesson.position = Vec3::ONE), []);
        assert_eq!(same(&|lesson| lesson.direction = Vec3::X), []);
        assert_eq!(same(&|lesson| lesson.weight = 0.0), []);
        assert_eq!(same(&|lesson| lesson.unguided = 0.0), []);
    }
}
