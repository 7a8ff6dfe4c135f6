//! Russian roulette of walks that are long, or far from everything. No density contains it: it is the same for all
//! strategies, so the weights do not need it.
//!
//! White fog without end absorbs nothing, and a walk through it has no end. From a distance of d, about a part r/d of all
//! walks comes back to a sphere of radius r around the scene. A part (r/d)^2.5 of them goes on. As d doubles, walks take
//! four times as many segments, and a sixth of them is left: their mean number of segments is finite. The few that come
//! back weigh more the farther they went. The power is chosen by hand: in white fog around a lamp over a floor, 2 took
//! twice the time for about the same error, and 3 showed bright pixels.

use super::{mis::MisSums, walk::Departure};
use crate::{
    math::{Bounds, Spectrum, Vec3},
    sampling::Stream,
    scene::Scene,
};

/// Where walks are thinned.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thinning {
    /// Walks of at most so many segments go on wherever they are.
    spared: u32,
    /// Walks of more are thinned wherever they are.
    long: u32,
    /// The centre of a sphere around the scene.
    centre: Vec3,
    /// Its squared radius (m^2).
    squared_radius: f32,
}

impl Thinning {
    /// Most segments of walks that are not thinned, in endless fog.
    const LONG: u32 = 100_000;
    /// The same elsewhere. In a white ball 6,000 mean free paths across, 1 in 50 walks has more.
    const LONGEST: u32 = 10_000_000;

    /// That of `scene`.
    pub(super) fn of(scene: &Scene) -> Self {
        let by_segments =
            |long| Self { spared: long, long, centre: Vec3::ZERO, squared_radius: f32::INFINITY };
        let outside = scene.media_map.outside;
        let fog = &scene.media[outside.0 as usize];
        if !scene.is_endless() || fog.extent().is_some() {
            return by_segments(Self::LONGEST);
        }
        let arrives = || fog.transmittance_from_infinity() != Spectrum::ZERO;
        if scene.lights.of_medium(outside).is_some() || scene.lights.has_infinite() && arrives() {
            // There is light far from the scene, too.
            return by_segments(Self::LONG);
        }
        let Bounds { low, high } = scene.bounds();
        // In thin fog, flights lead far from a small scene, and the first collisions still matter.
        let mean_free_path = fog.bound().sigma_t.min_element().recip();
        let radius = mean_free_path.max(0.5 * low.distance(high));
        Self { spared: 0, long: Self::LONG, centre: 0.5 * (low + high), squared_radius: radius * radius }
    }

    /// True if all walks go on as `next`, of which a part `left` was left before.
    #[inline(always)]
    pub(super) fn spares<S: MisSums>(&self, left: f32, next: &Departure<S>) -> bool {
        let is_near = || next.position.distance_squared(self.centre) <= self.squared_radius;
        next.edges <= self.spared || left == 1.0 && next.edges <= self.long && is_near()
    }

    /// The part of walks of so many segments that is left at `position`.
    fn left(&self, segments: u32, position: Vec3) -> f32 {
        self.begun(position).min(self.long as f32 / segments as f32)
    }

    /// The same of walks that begin there: a start far away is no reason to end.
    #[inline]
    pub(super) fn begun(&self, position: Vec3) -> f32 {
        let squared = self.squared_radius / position.distance_squared(self.centre);
        if squared >= 1.0 { 1.0 } else { squared * squared.sqrt().sqrt() }
    }

    /// The walk that goes on as `next`, if it does; `before` is the part that was left at the vertex before.
    #[cold]
    pub(super) fn thin<S: MisSums>(
        &self,
        before: f32,
        next: Departure<S>,
        stream: &mut Stream,
    ) -> Option<Departure<S>> {
        let left = self.left(next.edges, next.position).min(before);
        let survival = left / before;
        if survival < 1.0 && stream.uniform() >= survival {
            return None;
        }
        Some(Departure { throughput: next.throughput / survival, left, ..next })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        guide::Learnt,
        math::Vec2,
        sampling::stream::Purpose,
        settings::options::Options,
        transport::{Estimator, LightCache, Nowhere, camera_path, profiles::Fog, tests::scenes::build},
    };

    const FOG: [&str; 3] = [
        r#""fog": {"type": "homogeneous", "sigma_t": 1, "albedo": 1}"#,
        r#""camera": {"type": "perspective", "fog": {"type": "ref", "id": "fog"}}"#,
        r#""lamp": {"type": "point", "position": [0, 0, 6], "intensity": 1}"#,
    ];

    /// Throughputs of those of 10,000 walks that go on as `next`, over that of `next`.
    fn survivors<S: MisSums>(thinning: &Thinning, begun: f32, next: Departure<S>) -> Vec<f32> {
        let mut stream = Stream::new(2, 0, 0, Purpose::Study);
        let walks = (0..10_000).filter_map(|_| thinning.thin(begun, next, &mut stream));
        walks.map(|walk| walk.throughput.x / next.throughput.x).collect()
    }

    /// A wide film, or a wide beam, begins outside the sphere.
    #[test]
    fn a_start_far_away_ends_no_walk_but_going_farther_does() {
        let setup = build(&FOG);
        let estimator = Estimator::<Fog>::new(&setup.scene, Options::default(), Learnt::default(), 1, 64, 64);
        let start = camera_path::depart(&estimator, Vec2::ZERO, Vec2::ZERO);
        let thinning = Thinning::of(&setup.scene);
        let way = Vec3::X * (10.0 * thinning.squared_radius.sqrt());
        let begun = thinning.begun(thinning.centre + way);
        for times in [0.5, 1.0, 2.0f32] {
            let next = Departure { position: thinning.centre + way * times, edges: 1, ..start };
            let found = survivors(&thinning, begun, next);
            let part = times.powf(-2.5).min(1.0);
            let expected = 1e4 * part;
            let off = (found.len() as f32 - expected).abs();
            assert!(off <= 5.0 * (expected * (1.0 - part)).sqrt(), "{times}: {}", found.len());
            assert!(found.iter().all(|factor| (factor * part - 1.0).abs() < 1e-5), "{times}");
        }
    }

    /// Light of a lamp in white fog without end: after 30 segments, a tenth of all walks brings the same power.
    #[test]
    fn few_walks_bring_the_light_of_all() {
        let setup = build(&FOG);
        let options = Options { max_depth: Some(31), ..Options::default() };
        let mut estimator = Estimator::<Fog>::new(&setup.scene, options, Learnt::default(), 1, 64, 64);
        let mut found = |thinning: Thinning| {
            estimator.thinning = thinning;
            let (mut walks, mut sums) = (0, [0.0; 2]);
            for walk in 0..100_000 {
                let (mut cache, mut stream) = (LightCache::new(1), Stream::new(1, walk, 0, Purpose::Light));
                estimator.trace_light(&mut cache, &mut Nowhere, 0, &mut stream);
                for vertex in cache.drawn(0, 1).vertices().iter().filter(|one| one.subpath.edges == 30) {
                    walks += 1;
                    let near = vertex.position().length() < 6.0;
                    let power = if near { f64::from(vertex.subpath.throughput.x) } else { 0.0 };
                    sums = [sums[0] + power, sums[1] + power * power];
                }
            }
            (walks, sums[0], sums[1])
        };
        let usual = Thinning::of(&setup.scene);
        let (all, power, squares) = found(Thinning { spared: u32::MAX, ..usual });
        let (few, thinned, more) = found(usual);
        assert!(all > 99_000 && few > 1_000 && few < all / 5, "{few} of {all}");
        assert!((thinned - power).abs() < 4.0 * (squares + more).sqrt(), "{thinned} in place of {power}");
    }
}
