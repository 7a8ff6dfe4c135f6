//! Guiding by links (P03T sec. 5.2.3): a walk chooses one of the links that bring light to its place, then a point of
//! the sender, and goes there.

use super::hierarchy::Hierarchy;
use crate::{
    math::{Frame, Vec3, vec3},
    sampling::Stream,
};
use std::sync::Arc;

/// The box around a sender, in which points are chosen evenly.
#[derive(Clone, Copy, Debug)]
pub struct Aim {
    /// Its middle.
    pub centre: Vec3,
    /// Its axes.
    pub frame: Frame,
    /// Half its edges (m), all above 0.
    pub half: Vec3,
    /// The probability to choose it.
    pub probability: f32,
}

impl Aim {
    /// Density of unit `direction` from `position` (1/sr): points of the box are uniform, so those along the ray have a
    /// density in proportion to the squared distance.
    #[inline]
    fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        let origin = self.frame.to_local(position - self.centre);
        let inverse = self.frame.to_local(direction).recip();
        let (a, b) = ((-self.half - origin) * inverse, (self.half - origin) * inverse);
        let (near, far) = (a.min(b).max_element().max(0.0), a.max(b).min_element());
        if far > near {
            (far * far * far - near * near * near) / (24.0 * self.half.element_product())
        } else {
            0.0
        }
    }

    /// A unit direction from `position` to a point of it.
    fn sample(&self, position: Vec3, stream: &mut Stream) -> Vec3 {
        let (square, u) = (stream.square(), stream.uniform());
        let at = self.half * (2.0 * vec3(square.x, square.y, u) - Vec3::ONE);
        let to = self.centre + self.frame.to_world(at) - position;
        to.try_normalize().unwrap_or(self.frame.normal)
    }
}

/// The links that bring light to an element.
#[derive(Clone, Debug, Default)]
pub struct Aims(Arc<[Aim]>);

impl Aims {
    /// Keeps the most probable of `aims`, up to `most` of them: the others find little. Empty where there are none.
    pub fn of(mut aims: Vec<Aim>, most: usize) -> Self {
        aims.sort_by(|a, b| b.probability.total_cmp(&a.probability));
        aims.truncate(most);
        let all: f32 = aims.iter().map(|aim| aim.probability).sum();
        aims.iter_mut().for_each(|aim| aim.probability /= all);
        Self(aims.into())
    }

    /// True if there are none.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Density of unit `direction` from `position` (1/sr).
    #[inline]
    pub(super) fn pdf(&self, position: Vec3, direction: Vec3) -> f32 {
        self.0.iter().map(|aim| aim.probability * aim.pdf(position, direction)).sum()
    }

    /// A unit direction from `position`.
    pub(super) fn sample(&self, position: Vec3, stream: &mut Stream) -> Vec3 {
        let mut u = stream.uniform();
        let chosen = self.0.iter().find(|aim| {
            u -= aim.probability;
            u < 0.0
        });
        chosen.unwrap_or(&self.0[0]).sample(position, stream)
    }

    /// Memory that it takes (bytes).
    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.0[..])
    }
}

/// The links of all elements.
#[derive(Debug)]
pub struct Links {
    /// The elements.
    pub hierarchy: Hierarchy,
    /// What brings light to each.
    pub aims: Vec<Aims>,
}

impl Links {
    /// The links at a place; none where nothing brings light there.
    pub(super) fn at(&self, position: Vec3, normal: Option<Vec3>) -> Option<&Aims> {
        let element = self.hierarchy.element(position, normal)?;
        Some(&self.aims[element as usize]).filter(|aims| !aims.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{math::warp, sampling::stream::Purpose, testing};
    use statrs::distribution::{ContinuousCDF, Normal};
    use std::f64::consts::PI;

    /// From outside of two boxes and from within one: densities integrate to 1, and samples over their density are the solid angle
    /// that the boxes take up.
    #[test]
    fn directions_go_to_boxes_as_their_density_says() {
        let boxed = |centre: Vec3, normal: Vec3, half: Vec3, probability: f32| Aim {
            centre,
            frame: Frame::around(normal.normalize()),
            half,
            probability,
        };
        let aims = Aims::of(
            vec![
                boxed(vec3(0.0, 0.0, 2.0), vec3(1.0, 1.0, 2.0), vec3(0.5, 0.7, 0.01), 0.6),
                boxed(vec3(1.0, -1.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(0.3, 0.4, 0.5), 0.2),
                boxed(vec3(9.0, 9.0, 9.0), Vec3::Z, Vec3::ONE, 0.01),
            ],
            2,
        );
        assert_eq!(aims.0.len(), 2);
        const N: u32 = 200_000;
        let most = -Normal::standard().inverse_cdf(testing::significance(6) / 2.0);
        let mut stream = Stream::new(3, 0, 0, Purpose::Study);
        let mut moments = |value: &mut dyn FnMut(&mut Stream) -> f64| {
            let all = (0..N).map(|_| value(&mut stream)).fold((0.0, 0.0), |(a, b), x| (a + x, b + x * x));
            let (mean, square) = (all.0 / f64::from(N), all.1 / f64::from(N));
            (mean, ((square - mean * mean) / f64::from(N)).sqrt())
        };
        for position in [Vec3::ZERO, vec3(1.0, -0.9, 0.1), vec3(-2.0, 1.0, 1.9)] {
            let pdf = |direction| f64::from(aims.pdf(position, direction));
            let (all, error) = moments(&mut |stream| 4.0 * PI * pdf(warp::to_sphere(stream.square())));
            assert!(((all - 1.0) / error).abs() < most, "{position}: {all} +- {error}");
            let (expected, error) = moments(&mut |stream| {
                if pdf(warp::to_sphere(stream.square())) > 0.0 { 4.0 * PI } else { 0.0 }
            });
            let (found, noise) = moments(&mut |stream| 1.0 / pdf(aims.sample(position, stream)));
            let z = (found - expected) / (error * error + noise * noise).sqrt();
            assert!(z.abs() < most, "{position}: {found} of {expected}, {z} standard errors");
        }
    }
}
