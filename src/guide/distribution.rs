//! Light over directions (P03T sec. A.1), constant on each side of a surface or on bins of equal solid angle.
//! Distributions are added, evaluated and sampled; reflection and scattering are matrices between them.

use crate::{
    math::{Frame, Spectrum, SpectrumExt, Vec2, Vec3, vec2, warp},
    sampling::{Discrete, Stream},
};
use std::f32::consts::PI;

/// How directions are divided into bins, each of one value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bins {
    /// Two: on the side of this unit normal, and on the other.
    Sides(Vec3),
    /// n x n of equal solid angle.
    Equal(u32),
}

impl Bins {
    /// How many there are.
    pub fn count(self) -> usize {
        match self {
            Self::Sides(_) => 2,
            Self::Equal(n) => (n * n) as usize,
        }
    }

    /// The bin of a unit `direction`.
    #[inline]
    pub fn of(self, direction: Vec3) -> usize {
        match self {
            Self::Sides(normal) => usize::from(normal.dot(direction) < 0.0),
            Self::Equal(1) => 0,
            Self::Equal(n) => {
                let at = (warp::from_sphere(direction) * n as f32).as_uvec2();
                (at.y * n + at.x) as usize
            }
        }
    }

    /// A unit direction in the `bin`, for a point of the unit square: uniform if that is.
    pub fn direction(self, bin: usize, [u, v]: [f32; 2]) -> Vec3 {
        match self {
            Self::Sides(normal) => {
                let side = if bin == 0 { normal } else { -normal };
                let around = warp::to_sphere(vec2(u, v));
                if around.dot(side) < 0.0 { -around } else { around }
            }
            Self::Equal(n) => {
                let (x, y) = (bin as u32 % n, bin as u32 / n);
                warp::to_sphere(vec2(x as f32 + u, y as f32 + v) / n as f32)
            }
        }
    }

    /// A unit direction in which uniform light leaves through the `bin`, for a uniform point of the unit square. For
    /// the sides of a surface of unit `normal` it is distributed by the cosine, else uniformly.
    pub fn leave(self, bin: usize, normal: Vec3, u: Vec2) -> Vec3 {
        match self {
            Self::Sides(_) => {
                let side = if bin == 0 { normal } else { -normal };
                Frame::around(side).to_world(warp::to_cosine_hemisphere(u))
            }
            Self::Equal(_) => self.direction(bin, [u.x, u.y]),
        }
    }

    /// The solid angle of a bin, times the mean cosine on sides (sr).
    pub fn angle(self) -> f32 {
        match self {
            Self::Sides(_) => PI,
            Self::Equal(n) => 1.0 / (warp::SPHERE_PDF * (n * n) as f32),
        }
    }

    /// Weight in its bin of light of perpendicular irradiance 1 from unit `direction`: the cosine at a surface with one
    /// value per side; else 1, and scattering contains the cosine.
    #[inline]
    pub fn cosine(self, direction: Vec3) -> f32 {
        match self {
            Self::Sides(normal) => normal.dot(direction).abs(),
            Self::Equal(_) => 1.0,
        }
    }
}

/// A value for each bin.
#[derive(Clone, Debug, PartialEq)]
pub struct Distribution {
    /// Which directions have one value.
    pub bins: Bins,
    /// Those values.
    pub values: Vec<Spectrum>,
}

impl Distribution {
    /// 0 everywhere.
    pub fn dark(bins: Bins) -> Self {
        Self { bins, values: vec![Spectrum::ZERO; bins.count()] }
    }

    /// 1 everywhere.
    pub fn even(bins: Bins) -> Self {
        Self { bins, values: vec![Spectrum::ONE; bins.count()] }
    }

    /// The same, times `scale`.
    pub fn scaled(mut self, scale: Spectrum) -> Self {
        self.values.iter_mut().for_each(|value| *value *= scale);
        self
    }

    /// The same, multiplied by `other` over the same bins.
    pub fn times(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value *= *other);
        self
    }

    /// The same divided by `other`, over the same bins; 1 where `other` is 0.
    pub fn over(mut self, other: &Self) -> Self {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value = over(*value, *other));
        self
    }

    /// In unit `direction`.
    #[inline]
    pub fn at(&self, direction: Vec3) -> Spectrum {
        self.values[self.bins.of(direction)]
    }

    /// Adds light of perpendicular irradiance `irradiance` that comes from unit `direction`.
    #[inline]
    pub fn receive(&mut self, direction: Vec3, irradiance: Spectrum) {
        self.values[self.bins.of(direction)] += irradiance * self.bins.cosine(direction);
    }

    /// Adds `other`, over the same bins.
    pub fn add(&mut self, other: &Self) {
        self.values.iter_mut().zip(&other.values).for_each(|(value, other)| *value += *other);
    }

    /// Adds what a part of a cluster sends: on sides as they face, else the intensity in the middle of each bin.
    pub fn gather(&mut self, part: &Self) {
        join(self.bins, part.bins, |bin, of_part, share| self.values[bin] += part.values[of_part] * share);
    }

    /// Adds to each bin of a part the values of a `cluster` that [`Self::gather`] adds that bin to, by the same shares.
    pub fn part_of(&mut self, cluster: &Self) {
        join(cluster.bins, self.bins, |bin, of_part, share| {
            self.values[of_part] += cluster.values[bin] * share
        });
    }

    /// The light that leaves where this arrives. `scattering` has a row of all incoming bins for each outgoing bin.
    pub fn scattered(&self, scattering: &[Spectrum], tint: Spectrum) -> Self {
        let rows = scattering.chunks_exact(self.values.len());
        let sum = |row: &[Spectrum]| -> Spectrum {
            row.iter().zip(&self.values).map(|(part, value)| *part * *value).sum()
        };
        Self { bins: self.bins, values: rows.map(|row| tint * sum(row)).collect() }
    }

    /// The sum over bins.
    pub fn sum(&self) -> Spectrum {
        self.values.iter().copied().sum()
    }

    /// Samples a unit direction in which light leaves a surface of unit `normal`, by the cosine on each side, or a
    /// medium, uniformly within a bin. The second value is the light of all directions over that of this one at the
    /// same density (sr). None where it is dark.
    pub fn sample(&self, normal: Vec3, stream: &mut Stream) -> Option<(Vec3, f32)> {
        let chances = Discrete::new(self.values.iter().map(|value| f64::from(value.luminance())));
        if chances.is_empty() {
            return None;
        }
        let (bin, probability) = chances.sample_precisely(stream.uniform_precisely());
        let direction = self.bins.leave(bin, normal, stream.square());
        Some((direction, self.bins.angle() / probability as f32))
    }
}

/// `a` over `b`; 1 where `b` is 0.
pub fn over(a: Spectrum, b: Spectrum) -> Spectrum {
    Spectrum::select(b.cmpgt(Spectrum::ZERO), a / b, Spectrum::ONE)
}

/// Visits all pairs of a bin of a cluster and a bin of its part that share light, with the weight of the part's value
/// in the cluster. The power of each bin of the part is conserved.
fn join(cluster: Bins, part: Bins, mut visit: impl FnMut(usize, usize, f32)) {
    if let (Bins::Sides(own), Bins::Sides(other)) = (cluster, part) {
        let turned = usize::from(own.dot(other) < 0.0);
        return (0..2).for_each(|side| visit(side, side ^ turned, 1.0));
    }
    if cluster == part {
        return (0..part.count()).for_each(|bin| visit(bin, bin, 1.0));
    }
    let middles = (0..cluster.count()).map(|bin| cluster.direction(bin, [0.5; 2]));
    let seen: Vec<(usize, f32)> = middles.map(|middle| (part.of(middle), part.cosine(middle))).collect();
    let mut found = vec![0.0; part.count()];
    seen.iter().for_each(|(bin, cosine)| found[*bin] += cosine * cluster.angle());
    for (bin, (of_part, cosine)) in seen.into_iter().enumerate() {
        visit(bin, of_part, cosine * part.angle() / found[of_part]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::stream::Purpose;

    /// What leaves in all directions is what samples say, on sides by the cosine; and a cluster sends as much as its part.
    #[test]
    fn power_is_that_of_samples_and_of_parts() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        for bins in [Bins::Sides(normal), Bins::Equal(1), Bins::Equal(4)] {
            let mut own = Distribution::dark(bins);
            own.values
                .iter_mut()
                .enumerate()
                .for_each(|(bin, value)| *value = Spectrum::splat(1.0 + bin as f32));
            let power = own.sum().x * bins.angle();
            let mut stream = Stream::new(4, 0, 0, Purpose::Study);
            let sample = |_| {
                let (direction, over) = own.sample(normal, &mut stream).unwrap();
                own.at(direction).x * over
            };
            let mean = (0..1000).map(sample).sum::<f32>() / 1000.0;
            assert!((mean / power - 1.0).abs() < 1e-3, "{bins:?}: {mean} of {power}");
            let mut cluster = Distribution::dark(Bins::Equal(8));
            cluster.gather(&own);
            let sent = cluster.sum().x * cluster.bins.angle();
            assert!((sent / power - 1.0).abs() < 1e-3, "{bins:?}: {sent} of {power}");
        }
        assert!(
            Distribution::dark(Bins::Equal(2))
                .sample(normal, &mut Stream::new(4, 0, 1, Purpose::Study))
                .is_none()
        );
    }

    /// A surface that turns over in a cluster sends to the other side.
    #[test]
    fn sides_are_told_apart() {
        let mut own = Distribution::dark(Bins::Sides(Vec3::Z));
        own.receive(Vec3::new(0.0, 0.6, 0.8), Spectrum::splat(2.0));
        assert!((own.at(Vec3::Z).x - 1.6).abs() < 1e-6 && own.at(-Vec3::Z) == Spectrum::ZERO);
        let mut turned = Distribution::dark(Bins::Sides(-Vec3::Z));
        turned.gather(&own);
        assert!(turned.at(Vec3::Z).x > 1.5 && turned.at(-Vec3::Z) == Spectrum::ZERO);
    }

    /// Gathering parts into clusters, and what [`Distribution::part_of`] finds of clusters, are adjoint.
    #[test]
    fn parts_of_clusters_are_adjoint_to_gathering() {
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let some = |bins: Bins, salt: usize| {
            let value = |bin| Spectrum::splat(((7 * bin + salt) % 5) as f32);
            Distribution { bins, values: (0..bins.count()).map(value).collect() }
        };
        for bins in [Bins::Sides(normal), Bins::Equal(1), Bins::Equal(4), Bins::Equal(8)] {
            for cluster in [Bins::Equal(8), Bins::Sides(-normal)] {
                if matches!((cluster, bins), (Bins::Sides(_), Bins::Equal(_))) {
                    continue;
                }
                let (own, other) = (some(bins, 1), some(cluster, 3));
                let (mut gathered, mut part) = (Distribution::dark(cluster), Distribution::dark(bins));
                gathered.gather(&own);
                part.part_of(&other);
                let [a, b] = [gathered.times(&other), part.times(&own)].map(|product| product.sum().x);
                assert!((a / b - 1.0).abs() < 1e-5, "{bins:?} of {cluster:?}: {a}, {b}");
            }
        }
    }
}
