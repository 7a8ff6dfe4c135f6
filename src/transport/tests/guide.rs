//! Guided walks: their densities, and that any guide shows the same.

use super::*;
use crate::{
    bsdf::Transport,
    guide::{Guide, Lesson},
    math::{SpectrumExt, Vec3, vec3, warp},
    sampling::Basis,
    settings::options::Guiding,
    testing,
    transport::observer::Sum,
};
use statrs::distribution::{ContinuousCDF, Normal};

/// A guide that has little to do with what reaches the image: directions that depend on the place, some of them a hundred
/// times as likely as others, a portal that many of them aim at, and places of which only one kind of walk knows.
pub(super) fn arbitrary() -> Arc<Guide> {
    let mut stream = Stream::new(23, 0, 0, Purpose::Study);
    let lessons = (0..60_000).map(|index| {
        let [a, b, c] = [stream.square(), stream.square(), stream.square()];
        let position = 4.0 * vec3(a.x - 0.5, a.y - 0.5, b.x - 0.5);
        let aim = vec3(0.3, 0.2, -0.3) + 0.1 * warp::to_sphere(c);
        let is_aimed = index % 5 == 0;
        let direction = if is_aimed { (aim - position).normalize() } else { warp::to_sphere(c) };
        let towards = is_aimed || direction.dot(vec3(position.y, 1.0, -position.x)) > 0.9;
        let transport = match index % 2 {
            0 if position.x < 0.5 => Transport::Radiance,
            1 if position.x > -0.5 => Transport::Importance,
            0 => Transport::Importance,
            _ => Transport::Radiance,
        };
        let axis = [Vec3::X, Vec3::Y, Vec3::Z][index % 3];
        let normal = (b.y > 0.5).then(|| if b.y > 0.75 { axis } else { -axis });
        Lesson {
            position,
            normal,
            transport,
            direction,
            weight: if towards { 1.0 } else { 0.01 },
            unguided: 0.08,
            fold: index / 7 % 2,
        }
    });
    let guide = Guide::learn(lessons.collect(), Basis::default(), None).unwrap();
    assert!(!guide.portals().is_empty());
    Arc::new(guide)
}

#[test]
fn weights_of_guided_paths() {
    let options = Options { effort: Effort { guide: Guiding::Always, ..ALL.effort }, ..ALL };
    let all = |name: &'static str, report: Report| {
        assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    };
    let room = build(&[FOG, INSIDE, ROOM, LAMP, POINT, PLASTIC_BALL]);
    all("room", examine::<Guided<Fog>>("guided, in a room", &room, options, 600));
    let glass = build(&[FOG, INSIDE, ROOM, LAMP, POINT, GLASS_BALL]);
    all("glass", examine::<Guided<Fog>>("guided, beside glass", &glass, options, 600));
    let vacuum = build(&[CLEAR, INSIDE, ROOM, LAMP, BALL]);
    all("vacuum", examine::<Guided<Vacuum>>("guided, in a vacuum", &vacuum, options, 600));
    let open = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SUN, SKY, LAMP]);
    all("open", examine::<Guided<Everything>>("guided, in the open", &open, options, 1000));
    let colours = build(&[CHROMATIC_FOG, INSIDE, ROOM, LAMP, BALL]);
    all("colours", examine::<Guided<ChromaticFog>>("guided, in colours", &colours, options, 600));
    let waves = build(&[OUTSIDE, WAVES, GROUND, LAMP, BULB]);
    all("waves", examine::<Guided<Smoke>>("guided, in waves", &waves, options, 600));
    let fire = build(&[OUTSIDE, CHROMATIC_FIRE, GROUND, SUN, BULB]);
    all("fire", examine::<ByKind>("guided, fire", &fire, options, 600));
    let along = Options { strategies: Strategies { equiangular: true, ..Strategies::BDPT }, ..options };
    let report = examine::<Guided<Fog>>("guided, along", &room, along, 400);
    assert!(report.equiangular >= 30, "{} of {}", report.equiangular, report.paths);
    let learnt = Options { effort: Effort { starts: LightStarts::Learnt, ..options.effort }, ..options };
    all("learnt", examine::<Guided<Smoke>>("guided, learnt starts", &waves, learnt, 600));
}

/// Mean luminance of the film and its variance, without what light subpaths show the lens.
fn mean<P: Profile>(setup: &Setup, options: Options, seed: u64) -> (f64, f64) {
    let learnt = Learnt { guide: options.effort.is_guided().then(arbitrary), ..Learnt::default() };
    let estimator = Estimator::<P>::new(&setup.scene, options, learnt, SEED, PIXELS, PIXELS);
    let batches = 400;
    let (mut sum, mut squares) = (0.0, 0.0);
    for batch in 0..batches {
        let stream = |index: u64| Stream::new(seed, batch, index, Purpose::Study);
        let mut cache = LightCache::new(P::Channels::COUNT);
        for walk in 0..PIXELS {
            let hero = walk as usize % P::Channels::COUNT;
            estimator.trace_light(&mut cache, &mut Nowhere, hero, &mut stream(walk));
        }
        let pixel = |pixel: u64| {
            let mut stream = stream(PIXELS + pixel);
            let film = vec2(16.0, 12.0) * stream.square();
            let hero = (pixel as usize % P::Channels::COUNT, 0);
            let sum =
                estimator.sample_pixel(&cache, [film, path::APERTURE], hero, Sum::default(), &mut stream);
            f64::from(sum.radiance.luminance())
        };
        let value = (0..PIXELS).map(pixel).sum::<f64>() / PIXELS as f64;
        sum += value;
        squares += value * value;
    }
    let (n, mean) = (batches as f64, sum / batches as f64);
    (mean, (squares / n - mean * mean) / n)
}

#[test]
fn a_guide_of_another_scene_shows_the_same() {
    fn compare<P: Profile, G: Profile>(name: &str, parts: &[&str]) {
        let setup = build(parts);
        for (kind, strategies) in [
            ("pt", Strategies::PT),
            ("hit", Strategies { next_event: false, ..Strategies::PT }),
            ("join", Strategies { lens: false, ..Strategies::BDPT }),
        ] {
            let options = Options { strategies, max_depth: Some(5), ..ALL };
            let guided = Options { effort: Effort { guide: Guiding::Always, ..ALL.effort }, ..options };
            let ((usual, a), (other, b)) = (mean::<P>(&setup, options, 1), mean::<G>(&setup, guided, 2));
            let z = (usual - other).abs() / (a + b).sqrt();
            let most = -Normal::standard().inverse_cdf(testing::significance(9) / 2.0);
            assert!(z < most && usual > 0.0, "{name}, {kind}: {usual} {other}, {z} standard errors");
        }
    }
    compare::<Fog, Guided<Fog>>("fog", &[FOG, INSIDE, ROOM, LAMP, BALL]);
    compare::<Vacuum, Guided<Vacuum>>("vacuum", &[CLEAR, INSIDE, ROOM, LAMP, PLASTIC_BALL]);
    compare::<Everything, Guided<Everything>>("open", &[OUTSIDE, CHROMATIC_SMOKE, GROUND, SKY, LAMP]);
}
