//! Chains of points where smooth surfaces reflect or refract, and how far light spreads along them.

use crate::math::DVec3;

/// Most points of a chain.
pub(super) const MOST: usize = 3;

/// What a chain leads to.
#[derive(Clone, Copy, Debug)]
pub(super) enum Target {
    /// A point.
    Point(DVec3),
    /// The unit direction towards something at infinity.
    Direction(DVec3),
}

impl Target {
    /// The unit direction to it from `from`.
    pub(super) fn seen_from(self, from: DVec3) -> DVec3 {
        match self {
            Self::Point(point) => (point - from).normalize_or_zero(),
            Self::Direction(direction) => direction,
        }
    }

    /// The same where `origin` is the origin.
    pub(super) fn relative_to(self, origin: DVec3) -> Self {
        match self {
            Self::Point(point) => Self::Point(point - origin),
            direction => direction,
        }
    }

    /// The point, from the origin, or the direction.
    pub(super) fn vector(self) -> DVec3 {
        match self {
            Self::Point(vector) | Self::Direction(vector) => vector,
        }
    }
}

/// A point of a chain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Link {
    /// Where it is.
    pub(super) position: DVec3,
    /// Unit normal, either one.
    pub(super) normal: DVec3,
    /// How the normal turns along the surface: 1 over the radius of a ball or a tube along its outward normal, 0 on a plane (1/m).
    pub(super) curvature: f64,
    /// The unit direction of a tube's axis, along which the normal does not turn; else 0.
    pub(super) axis: DVec3,
    /// The index beyond over that before; none where it reflects.
    pub(super) ratio: Option<f64>,
    /// Which primitive of the shape it lies on.
    pub(super) primitive: usize,
}

/// A path from a given point over smooth surfaces of one shape to a target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chain {
    links: [Link; MOST],
    count: usize,
}

impl Chain {
    /// Of one to [`MOST`] links.
    pub(super) fn new(links: &[Link]) -> Self {
        let at = |index: usize| links[index.min(links.len() - 1)];
        Self { links: [at(0), at(1), at(2)], count: links.len() }
    }

    pub(super) fn links(&self) -> &[Link] {
        &self.links[..self.count]
    }

    /// Solid angle at `from` over the area across the light that it covers at the target, or over the solid angle there if the
    /// target is at infinity: 1/d^2 of a chain without links. None where rays meet.
    pub(super) fn spread(&self, from: DVec3, target: Target) -> Option<f64> {
        let mut beam = Beam::from(from, self.links[0].position);
        for link in self.links() {
            beam.travel(link)?;
            beam.turn(link)?;
        }
        let area = match target {
            Target::Point(point) => {
                let distance = (point - beam.origin).dot(beam.direction);
                let [a, b] = [0, 1].map(|i| beam.origins[i] + beam.directions[i] * distance);
                a.cross(b)
            }
            Target::Direction(_) => beam.directions[0].cross(beam.directions[1]),
        };
        let spread = 1.0 / area.dot(beam.direction).abs();
        (spread.is_finite() && spread > 0.0).then_some(spread)
    }
}

/// The direction of a ray that is refracted where the index beyond a surface over that before is `ratio`; none in total
/// reflection.
pub(super) fn refracted(direction: DVec3, normal: DVec3, ratio: f64) -> Option<DVec3> {
    let (index, cosine) = (1.0 / ratio, direction.dot(normal));
    let square = 1.0 - index * index * (1.0 - cosine * cosine);
    let along = square.max(0.0).sqrt().copysign(cosine) - index * cosine;
    (square > 0.0).then(|| direction * index + normal * along)
}

/// A ray, and how it changes with the direction in which it set out (Igehy 1999).
struct Beam {
    origin: DVec3,
    direction: DVec3,
    origins: [DVec3; 2],
    directions: [DVec3; 2],
}

impl Beam {
    fn from(origin: DVec3, towards: DVec3) -> Self {
        let direction = (towards - origin).normalize_or_zero();
        let (across, along) = direction.any_orthonormal_pair();
        Self { origin, direction, origins: [DVec3::ZERO; 2], directions: [across, along] }
    }

    /// To the surface at `link`.
    fn travel(&mut self, link: &Link) -> Option<()> {
        let distance = (link.position - self.origin).dot(self.direction);
        let cosine = self.direction.dot(link.normal);
        if cosine == 0.0 {
            return None;
        }
        for i in 0..2 {
            let moved = self.origins[i] + self.directions[i] * distance;
            self.origins[i] = moved - self.direction * (moved.dot(link.normal) / cosine);
        }
        self.origin = link.position;
        Some(())
    }

    /// Reflected or refracted there: d' = k d + m N, where k is 1 or the ratio of indices.
    fn turn(&mut self, link: &Link) -> Option<()> {
        let (direction, normal) = (self.direction, link.normal);
        let cosine = direction.dot(normal);
        let turned = |i: usize| {
            let moved = self.origins[i];
            let normals = (moved - link.axis * moved.dot(link.axis)) * link.curvature;
            (normals, self.directions[i].dot(normal) + direction.dot(normals))
        };
        let Some(ratio) = link.ratio else {
            self.directions = [0, 1].map(|i| {
                let (normals, cosines) = turned(i);
                self.directions[i] - (normal * cosines + normals * cosine) * 2.0
            });
            self.direction = direction - normal * (2.0 * cosine);
            return Some(());
        };
        let index = 1.0 / ratio;
        self.direction = refracted(direction, normal, ratio)?;
        let beyond = self.direction.dot(normal);
        let along = beyond - index * cosine;
        self.directions = [0, 1].map(|i| {
            let (normals, cosines) = turned(i);
            let changed = (index * index * cosine / beyond - index) * cosines;
            self.directions[i] * index + normal * changed + normals * along
        });
        Some(())
    }
}
