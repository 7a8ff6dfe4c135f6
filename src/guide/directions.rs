//! Directions of walks from the places of a cell: the share that aims at each portal, a table of others, and the share
//! that is left to the BSDF or the phase function.

use super::{
    Lesson,
    links::{Aims, Links},
};
use crate::{
    math::{Vec3, warp},
    sampling::{
        Basis, Quadtree, Stream,
        portal::{Aimed, Portal},
        quadtree::{Deposit, effective},
    },
};

/// Choices of a, the BSDF sampling fraction among directions that aim at no portal. At a vertex, the weight of a path
/// grows by at most 1 / a; the choice of a looks at one vertex at a time.
const BSDF_FRACTIONS: [f32; 4] = [0.5, 0.65, 0.8, 1.0];
/// Fewest directions, as [`effective`] counts them, that can be learnt from.
pub(super) const ENOUGH: f64 = 32.0;

/// The directions of a cell; the shares sum to 1.
#[derive(Clone, Debug)]
pub(super) struct Directions {
    /// The share of the BSDF or the phase function.
    pub unguided: f32,
    /// The shares that aim at portals.
    aimed: Aimed,
    /// The share of a table, if there is one.
    tabled: Option<(f32, Table)>,
}

/// Directions that aim at no portal.
#[derive(Clone, Debug)]
enum Table {
    /// Directions that walks took.
    Learnt(Quadtree),
    /// Directions to senders of links.
    Linked(Aims),
}

/// What tables are made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tabulator<'a> {
    pub basis: Basis,
    /// The links of [`Basis::Links`].
    pub links: Option<&'a Links>,
}

impl Directions {
    /// None where directions are better left to the BSDF or the phase function.
    pub(super) fn learn(lessons: &[&Lesson], portals: &[Portal], tabulator: Tabulator<'_>) -> Option<Self> {
        let aimed = Aimed::of(portals, lessons.iter().map(|lesson| lesson.passage()));
        let rest = 1.0 - aimed.share();
        let is_aimed =
            |lesson: &&Lesson| portals.iter().any(|portal| lesson.passage().crosses(&portal.outermost()));
        let others: Vec<&Lesson> = lessons.iter().copied().filter(|lesson| !is_aimed(lesson)).collect();
        let is_known = effective(others.iter().map(|lesson| lesson.weight)) >= ENOUGH;
        let a = if is_known { part_unguided(&others, tabulator) } else { 1.0 };
        let tabled = if a < 1.0 { tabulator.table(&others) } else { None };
        let tabled = tabled.map(|table| (rest * (1.0 - a), table));
        let known = Self { unguided: rest * a, aimed, tabled };
        (known.unguided < 1.0).then_some(known)
    }

    /// Density of unit `direction` from `position` among the guided ones, times their share (1/sr).
    #[inline]
    pub(super) fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        let tabled =
            self.tabled.as_ref().map_or(0.0, |(share, table)| share * table.pdf(position, direction));
        tabled + self.aimed.pdf(|portal| portal.pdf(position, direction))
    }

    /// A unit direction from `position`; none where it is left to the BSDF or the phase function.
    #[inline]
    pub(super) fn sample(&self, position: Vec3, stream: &mut Stream) -> Option<Vec3> {
        let mut u = stream.uniform();
        if u < self.unguided {
            return None;
        }
        u -= self.unguided;
        if let Some(portal) = self.aimed.choose(&mut u) {
            return Some(portal.sample(position, stream));
        }
        self.tabled.as_ref().map(|(_, table)| table.sample(position, stream))
    }

    /// Memory that it takes (bytes).
    pub(super) fn bytes(&self) -> usize {
        self.aimed.bytes() + self.tabled.as_ref().map_or(0, |(_, table)| table.bytes())
    }
}

/// Chooses a, by the second moment of each half of the `lessons` under a table of the other half; 1 where there is no
/// table.
fn part_unguided(lessons: &[&Lesson], tabulator: Tabulator<'_>) -> f32 {
    let half = |fold| lessons.iter().copied().filter(|lesson| lesson.fold == fold).collect::<Vec<_>>();
    let [Some(even), Some(odd)] = [1, 0].map(|other| tabulator.table(&half(other))) else { return 1.0 };
    let tables = [even, odd];
    let known = lessons.iter().filter(|lesson| lesson.unguided > 0.0);
    let ratios: Vec<_> = known
        .map(|lesson| {
            (lesson.weight, tables[lesson.fold].pdf(lesson.position, lesson.direction) / lesson.unguided)
        })
        .collect();
    let moment = |a: f32| -> f64 {
        let of = |(weight, ratio): &(f32, f32)| f64::from(weight * weight / (a + (1.0 - a) * ratio));
        ratios.iter().map(of).sum()
    };
    let best = BSDF_FRACTIONS.into_iter().map(|a| (a, moment(a))).min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(1.0, |(a, _)| a)
}

impl Tabulator<'_> {
    /// The table of `lessons` of one cell; none where no links lead there.
    fn table(self, lessons: &[&Lesson]) -> Option<Table> {
        if self.basis == Basis::Links {
            let lesson = lessons.get(lessons.len() / 2)?;
            return Some(Table::Linked(self.links?.at(lesson.position, lesson.normal)?.clone()));
        }
        let deposit =
            |lesson: &&Lesson| Deposit { at: warp::from_sphere(lesson.direction), weight: lesson.weight };
        Some(Table::Learnt(Quadtree::by(self.basis, lessons.iter().map(deposit).collect())))
    }
}

impl Table {
    /// Density of unit `direction` from `position` (1/sr).
    #[inline]
    fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        match self {
            Self::Learnt(tree) => tree.density(warp::from_sphere(direction)) * warp::SPHERE_PDF,
            Self::Linked(aims) => aims.pdf(position, direction),
        }
    }

    /// A unit direction from `position`.
    #[inline]
    fn sample(&self, position: Vec3, stream: &mut Stream) -> Vec3 {
        match self {
            Self::Learnt(tree) => warp::to_sphere(tree.sample(stream.square())),
            Self::Linked(aims) => aims.sample(position, stream),
        }
    }

    fn bytes(&self) -> usize {
        match self {
            Self::Learnt(tree) => tree.bytes(),
            Self::Linked(aims) => aims.bytes(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bsdf::Transport,
        math::vec3,
        sampling::{portal::Sphere, stream::Purpose},
        testing,
    };
    use statrs::distribution::{ContinuousCDF, Normal};
    use std::f64::consts::PI;

    /// Half of the lessons aim at a portal, some of the others at a patch of sky. Over the density of directions, the solid angles
    /// of both and of all directions come out, wherever one looks from.
    #[test]
    fn solid_angles_are_what_samples_over_their_density_say() {
        let smallest = Sphere { centre: vec3(0.4, -0.7, 0.2), radius_squared: 0.04 };
        let portal = Portal::fitted(smallest, [].into_iter());
        let up = |direction: Vec3| direction.z > 0.9;
        let mut stream = Stream::new(41, 0, 0, Purpose::Study);
        let lessons: Vec<Lesson> = (0..4000)
            .map(|index| {
                let position = smallest.centre + vec3(2.0, 1.0, 0.5) - warp::to_sphere(stream.square());
                let anywhere = warp::to_sphere(stream.square());
                let direction = if index % 2 == 0 { portal.sample(position, &mut stream) } else { anywhere };
                let (transport, unguided) = (Transport::Radiance, warp::SPHERE_PDF);
                let weight = if up(direction) { 5.0 } else { 1.0 };
                Lesson { position, normal: None, transport, direction, weight, unguided, fold: index / 2 % 2 }
            })
            .collect();
        let all: Vec<&Lesson> = lessons.iter().collect();
        let tabulator = Tabulator { basis: Basis::default(), links: None };
        let known = Directions::learn(&all, &[portal], tabulator).unwrap();
        let [(share, _)] = known.aimed.portals() else { panic!("{:?}", known.aimed) };
        assert!(*share > 0.3 && known.tabled.is_some(), "{:?}", known.aimed);
        let most = -Normal::standard().inverse_cdf(testing::significance(12) / 2.0);
        for distance in [0.1, 0.5, 3.0] {
            let position = smallest.centre + distance * vec3(0.6, 0.48, 0.64);
            let outermost = portal.outermost();
            let [within, through] = [smallest, outermost]
                .map(|sphere| move |direction: Vec3| sphere.pdf(position, direction) > 0.0);
            let angle = |sphere: Sphere| {
                let sine_squared = f64::from(sphere.radius_squared / (distance * distance));
                if sine_squared < 1.0 { 2.0 * PI * (1.0 - (1.0 - sine_squared).sqrt()) } else { 4.0 * PI }
            };
            let angles: [(f64, &dyn Fn(Vec3) -> bool); 4] = [
                (4.0 * PI, &|_| true),
                (0.2 * PI, &up),
                (angle(smallest), &within),
                (angle(outermost), &through),
            ];
            let mut sums = [[0.0; 2]; 4];
            let n = 100_000.0;
            for _ in 0..100_000 {
                let guided = known.sample(position, &mut stream);
                let direction = guided.unwrap_or_else(|| warp::to_sphere(stream.square()));
                let pdf = known.unguided * warp::SPHERE_PDF + known.pdf(position, direction);
                let value = 1.0 / f64::from(pdf);
                for ((_, holds), sums) in angles.iter().zip(&mut sums) {
                    let value = if holds(direction) { value } else { 0.0 };
                    sums[0] += value / n;
                    sums[1] += value * value / n;
                }
            }
            for ((angle, _), [mean, square]) in angles.iter().zip(sums) {
                let z = (mean - angle) / ((square - mean * mean) / n).sqrt();
                assert!(z.abs() < most, "{distance}: {mean} of {angle}, {z} standard errors");
            }
        }
    }
}
