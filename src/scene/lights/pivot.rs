//! Equiangular sampling: distances along a ray, denser nearer to an emitter (Kulla and Fajardo 2012, Importance
//! Sampling Techniques for Path Tracing in Participating Media, sec. 4). For a beam, distances within it.

use super::{Geometry, Lights, disk::Disk, light::Light};
use crate::{
    emitter::Kind,
    math::{Vec3, offset},
    sampling::{Stream, stream::Purpose},
    settings::options::Sky,
};
use std::f32::consts::FRAC_PI_2;

/// Points sampled to find where a shape lies.
const POINTS: u16 = 64;

/// Where an emitter is, as far as distances to it matter.
#[derive(Clone, Copy, Debug)]
pub enum Pivot {
    /// Around a place.
    Around(Place),
    /// Light is in the beam from this disk only: all distances in it are as likely.
    Beam(Disk),
}

/// Where light comes from.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// The point, or the centre of the shape.
    pub position: Vec3,
    /// Root mean square distance of its light from there (m).
    pub radius: f32,
}

/// Distances along a ray, from its start to infinity.
struct Distances {
    /// That of the point closest to the emitter (m).
    closest: f32,
    /// How far the emitter is from there, at least (m).
    apart: f32,
    /// The angle at which it sees the ray.
    angle: f32,
}

impl Pivot {
    /// The pivot of `light`; none where it is at infinity, in a medium, or cannot be connected to.
    pub(super) fn of(light: &Light, geometry: &Geometry) -> Option<Self> {
        let around = |shape| {
            let mut stream = Stream::new(0, u64::from(shape), 0, Purpose::Pilot);
            let points: Vec<Vec3> =
                (0..POINTS).map(|_| geometry.sample_area(shape, &mut stream).position).collect();
            let mean = |sum: f32| sum / f32::from(POINTS);
            let position = points.iter().map(|point| *point / f32::from(POINTS)).sum();
            let square = points.iter().map(|point| point.distance_squared(position)).sum();
            Self::Around(Place { position, radius: mean(square).sqrt() })
        };
        match light.emitter.kind {
            _ if !light.emitter.is_connectible() => None,
            Kind::Surface(_) => light.shape.map(around),
            Kind::Point(_) => Some(Self::Around(Place { position: light.position, radius: 0.0 })),
            Kind::Beam(_) => Disk::of(light).map(Self::Beam),
            Kind::Infinite(_) | Kind::Medium(_) => None,
        }
    }

    /// A distance along the ray from `origin` in unit `direction`, and its density (1/m); none where there is none.
    pub fn sample(&self, origin: Vec3, direction: Vec3, u: f32) -> Option<(f32, f32)> {
        let (distance, pdf) = match self {
            Self::Around(place) => place.sample(origin, direction, u)?,
            Self::Beam(disk) => {
                let [from, to] = disk.lit_part(origin, direction, 0.0)?;
                (from + (to - from) * u, 1.0 / (to - from))
            }
        };
        (distance > 0.0 && distance < f32::INFINITY && pdf > 0.0).then_some((distance, pdf))
    }

    /// Density of `position` (1/m), `distance` metres from the start of a ray in unit `direction`.
    #[inline]
    pub fn pdf(&self, position: Vec3, direction: Vec3, distance: f32) -> f32 {
        match self {
            Self::Around(place) => place.pdf(position, direction, distance),
            Self::Beam(disk) => match disk.lit_part(position, direction, distance) {
                Some([from, to]) if from <= distance && distance <= to => 1.0 / (to - from),
                _ => 0.0,
            },
        }
    }
}

impl Place {
    /// Distances of the ray in unit `direction` that starts `distance` metres before `position`; none where it starts
    /// at the emitter.
    fn distances(&self, position: Vec3, direction: Vec3, distance: f32) -> Option<Distances> {
        let towards = self.position - position;
        let closest = distance + towards.dot(direction);
        let away = towards.cross(direction).length_squared();
        let resolved = offset::RESOLVED_ANGLE * offset::RESOLVED_ANGLE * (closest * closest + away);
        let apart = (away + self.radius * self.radius + resolved).sqrt();
        (apart > 0.0).then(|| Distances { closest, apart, angle: apart.atan2(-closest) })
    }

    /// See [`Pivot::sample`].
    fn sample(&self, origin: Vec3, direction: Vec3, u: f32) -> Option<(f32, f32)> {
        let all = self.distances(origin, direction, 0.0)?;
        let distance = all.closest + all.apart * (FRAC_PI_2 - all.angle * (1.0 - u)).tan();
        Some((distance, self.pdf(origin + direction * distance, direction, distance)))
    }

    /// See [`Pivot::pdf`].
    #[inline]
    fn pdf(&self, position: Vec3, direction: Vec3, distance: f32) -> f32 {
        let Some(Distances { closest, apart, angle }) = self.distances(position, direction, distance) else {
            return 0.0;
        };
        let beyond = distance - closest;
        apart / (angle * (apart * apart + beyond * beyond))
    }
}

impl Lights {
    /// True if there are emitters for equiangular sampling.
    pub fn has_pivots(&self) -> bool {
        !self.pivoting.is_empty()
    }

    /// The emitter that `u` in [0, 1) chooses for equiangular sampling, and its probability.
    pub fn sample_pivot(&self, u: f64) -> Option<(usize, &Pivot, f32)> {
        if self.pivoting.is_empty() {
            return None;
        }
        let (index, chosen) = self.pivoting.sample_precisely(u);
        Some((index, self.pivots[index].as_ref()?, chosen as f32))
    }

    /// The pivot of emitter `index`, and its probability in equiangular sampling over that in next-event estimation
    /// from `reference`; none where equiangular sampling does not apply.
    #[inline]
    pub fn pivot(&self, index: u32, reference: Vec3, sky: Sky) -> Option<(&Pivot, f32)> {
        let pivot = self.pivots[index as usize].as_ref()?;
        let index = index as usize;
        Some((pivot, self.pivoting.probability(index) / self.connections(sky).probability(index, reference)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::Vec2, testing};

    const fn place(position: Vec3, radius: f32) -> Pivot {
        Pivot::Around(Place { position, radius })
    }

    const RAYS: [(Vec3, Pivot); 5] = [
        (Vec3::ZERO, place(Vec3::new(1.0, 0.5, 2.0), 0.0)),
        (Vec3::ZERO, place(Vec3::new(0.3, 0.0, -2.0), 0.1)),
        (Vec3::new(5.0, 5.0, 5.0), place(Vec3::new(5.0, 5.0, 8.0), 0.0)),
        (Vec3::ZERO, place(Vec3::new(1e-3, 0.0, 1e3), 0.0)),
        (Vec3::ZERO, place(Vec3::new(0.0, 0.0, 1e-3), 0.5)),
    ];

    /// Before and behind an emitter, beside one and straight through one.
    #[test]
    fn distances_come_as_often_as_their_density_says() {
        const CELLS: usize = 20;
        for (origin, pivot) in RAYS {
            let mut counts = vec![0; CELLS];
            let mut stream = Stream::new(4, 0, 0, Purpose::Study);
            let edge = |cell: usize| {
                pivot.sample(origin, Vec3::Z, (cell as f32 + 0.5) / CELLS as f32).map_or(0.0, |(t, _)| t)
            };
            let edges: Vec<f32> = (0..CELLS - 1).map(edge).collect();
            const N: usize = 100_000;
            for _ in 0..N {
                let t = pivot.sample(origin, Vec3::Z, stream.uniform()).map_or(f32::INFINITY, |(t, _)| t);
                counts[edges.partition_point(|edge| *edge < t)] += 1;
            }
            let inner = |pair: &[f32]| integral(&pivot, origin, pair[0], pair[1]) * N as f64;
            let first = integral(&pivot, origin, 0.0, edges[0]) * N as f64;
            let mut expected = vec![first];
            expected.extend(edges.windows(2).map(inner));
            expected.push(N as f64 - expected.iter().sum::<f64>());
            let p = testing::chi_square(&counts, &expected);
            assert!(p > testing::significance(RAYS.len()), "{pivot:?}: {p}, {counts:?} {expected:?}");
        }
    }

    fn integral(pivot: &Pivot, origin: Vec3, from: f32, to: f32) -> f64 {
        const STEPS: u32 = 20_000;
        let step = (f64::from(to) - f64::from(from)) / f64::from(STEPS);
        let at = |i: u32| {
            let t = (f64::from(from) + (f64::from(i) + 0.5) * step) as f32;
            f64::from(pivot.pdf(origin + Vec3::Z * t, Vec3::Z, t))
        };
        (0..STEPS).map(at).sum::<f64>() * step
    }

    /// Rays that cross it, begin in it, end at its disk, and leave that.
    #[test]
    fn distances_in_a_beam_are_those_that_it_lights() {
        let disk = Disk::new(Vec3::new(0.2, 0.0, 5.0), -Vec3::Z, 0.5);
        let beam = Pivot::Beam(disk);
        let mut stream = Stream::new(5, 0, 0, Purpose::Study);
        for (origin, towards) in [
            (Vec3::new(-3.0, 0.1, 0.0), Vec3::new(1.0, 0.0, 0.3)),
            (Vec3::new(0.3, 0.2, 0.0), Vec3::new(0.1, 0.2, -1.0)),
            (Vec3::new(0.3, 0.2, 0.0), Vec3::new(0.0, 0.05, 1.0)),
            (Vec3::new(0.2, 0.0, 9.0), Vec3::new(0.01, 0.0, -1.0)),
        ] {
            let direction = towards.normalize();
            let (mut low, mut high, mut expected) = (f32::INFINITY, 0f32, 0.0);
            for _ in 0..10_000 {
                let (distance, pdf) = beam.sample(origin, direction, stream.uniform()).unwrap();
                let position = origin + direction * distance;
                // At its edge, rounding decides.
                assert!(
                    disk.onto(position + (disk.at(Vec2::ZERO) - position).reject_from(Vec3::Z) * 1e-4)
                        .is_some()
                );
                assert!((beam.pdf(position, direction, distance) / pdf - 1.0).abs() < 1e-3);
                (low, high, expected) = (low.min(distance), high.max(distance), 1.0 / pdf);
            }
            assert!(
                ((high - low) / expected - 1.0).abs() < 0.01,
                "{origin}: {low} to {high}, not {expected}"
            );
            let beside = origin + direction * (high + 0.1 * expected);
            assert_eq!(beam.pdf(beside, direction, high + 0.1 * expected), 0.0);
        }
        assert!(beam.sample(Vec3::new(5.0, 0.0, 0.0), Vec3::Y, 0.5).is_none());
        assert!(beam.sample(Vec3::new(0.2, 0.0, 0.0), -Vec3::Z, 0.5).is_none(), "for ever");
    }

    #[test]
    fn rays_from_a_point_light_itself_have_no_distances() {
        let pivot = place(Vec3::ONE, 0.0);
        assert!(pivot.sample(Vec3::ONE, Vec3::X, 0.5).is_none());
        assert_eq!(pivot.pdf(Vec3::ONE + Vec3::X, Vec3::X, 1.0), 0.0);
    }
}
