//! The slow reference of the weights: the judge of the fast ones.
//!
//! `pdf` writes the density of every strategy of an explicit `path` out, vertex by vertex, in f64 logarithms,
//! without any of the running sums of `walk`, `vertex` and `weight`, and `sharing` the heuristics by definition. `record` takes real walks and the weights
//! that the fast code gives the paths they make; `replay` leads the fast code along a given path from both ends,
//! so that it weighs all strategies of one path. All three must agree, and each set of weights must sum to one.

mod cases;
mod flakes;
mod guide;
mod heuristics;
mod next_event;
mod path;
mod reference;
mod replay;
mod report;
pub(super) mod scenes;
mod shut_in;
mod starts;

use super::{
    Connections, Effort, Estimator, Heuristic, LightCache, LightStarts, Nowhere, Options, Strategies,
    Survival,
    profile::Profile,
    profiles::{
        Bounded, ByCompared, ByCutoff, ByKind, ChromaticBounded, ChromaticFog, Everything, Fire, Fog, Guided,
        Smoke, Vacuum,
    },
};
use crate::{
    guide::Learnt,
    math::{Channels, vec2, vec3},
    sampling::{Stream, stream::Purpose},
    scene::build::Setup,
};
use path::{Node, Path, Place};
use reference::Reference;
use report::Report;
use scenes::*;
use std::sync::Arc;

const ALL: Options = Options {
    algorithm: crate::settings::options::Algorithm::Bdpt,
    strategies: Strategies::BDPT,
    effort: Effort::EQUAL,
    basis: crate::sampling::Basis::Quadtree,
    first_pass: crate::settings::options::FirstPass::Usual,
    flat: false,
    connections: Connections::Cached,
    heuristic: Heuristic::Balance,
    max_depth: None,
    min_depth: 0,
    hide_emitters: false,
    forced_interaction: false,
};
const PIXELS: u64 = 16 * 12;
const SEED: u64 = 1;

/// Compares all paths that `pairs` camera and light subpaths make.
fn examine<P: Profile>(name: &'static str, setup: &Setup, options: Options, pairs: u64) -> Report {
    let starts = match options.effort.starts {
        LightStarts::Emitted => None,
        LightStarts::Aimed => setup.scene.aimed_starts(),
        LightStarts::Learnt => Some(starts::lessons(setup)),
    };
    let learnt =
        Learnt { starts, guide: options.effort.is_guided().then(guide::arbitrary), ..Learnt::default() };
    let estimator = Estimator::<P>::new(&setup.scene, options, learnt, SEED, PIXELS, PIXELS);
    let reference = Reference::new(&estimator);
    let mut report = Report::new(name);
    for pair in 0..pairs {
        let mut stream = Stream::new(5, pair, 0, Purpose::Study);
        let film = vec2(16.0, 12.0) * stream.square();
        let hero = pair as usize % P::Channels::COUNT;
        for case in cases::cases(&estimator, film, hero, &mut stream) {
            report.take(&estimator, &reference, &case);
        }
    }
    report.check();
    report
}

/// The same, and at least a thousand paths, some by each kind of strategy.
fn examine_all<P: Profile>(name: &'static str, setup: &Setup, pairs: u64) {
    let report = examine::<P>(name, setup, ALL, pairs);
    assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    assert!(report.strategies.iter().all(|count| *count > 0), "{name}: {:?}", report.strategies);
}

#[test]
fn fog_in_a_closed_box() {
    let setup = build(&[FOG, INSIDE, ROOM, LAMP, BALL]);
    examine_all::<Fog>("fog", &setup, 400);
    examine_all::<Everything>("fog by everything", &setup, 200);
    examine_all::<Vacuum>("vacuum", &build(&[CLEAR, INSIDE, ROOM, LAMP, BALL]), 400);
}

/// Extinction that depends on the direction of flight.
#[test]
fn flakes() {
    examine_all::<Everything>("fog of flakes", &build(&[FLAKES, INSIDE, ROOM, LAMP, BALL]), 300);
    examine_all::<Everything>(
        "waves of flakes",
        &build(&[OUTSIDE, WAVES_OF_FLAKES, GROUND, LAMP, SKY]),
        1000,
    );
    let strategies = Strategies { equiangular: true, ..Strategies::BDPT };
    let setup = build(&[FLAKES, INSIDE, ROOM, LAMP, BULB, POINT, BALL]);
    let along = examine::<Everything>("flakes, along", &setup, Options { strategies, ..ALL }, 300);
    assert!(along.equiangular >= 30, "{}", along.equiangular);
    examine_heuristics("flakes by other heuristics", &setup, Options { strategies, ..ALL }, 60);
}

/// The same where flakes vary.
#[test]
fn felt() {
    examine_all::<Everything>("felt", &build(&[FELT, INSIDE, SHELL, LAMP, BALL]), 300);
    examine_all::<Everything>("felt in colour", &build(&[CHROMATIC_FELT, INSIDE, SHELL, LAMP, BALL]), 300);
    examine_all::<Everything>("waves of felt", &build(&[OUTSIDE, WAVES_OF_FELT, GROUND, LAMP, SKY]), 1000);
    let strategies = Strategies { equiangular: true, ..Strategies::BDPT };
    let setup = build(&[CHROMATIC_FELT, INSIDE, SHELL, LAMP, BULB, POINT, BALL]);
    let along = examine::<Everything>("felt, along", &setup, Options { strategies, ..ALL }, 300);
    assert!(along.equiangular >= 30, "{}", along.equiangular);
}

/// Equiangular sampling: every kind of emitter, homogeneous, chromatic and varying media, with boundaries before and behind
/// the point.
#[test]
fn equiangular_sampling() {
    fn take<P: Profile>(name: &'static str, parts: &[&str], strategies: Strategies) {
        let options = Options { strategies: Strategies { equiangular: true, ..strategies }, ..ALL };
        let report = examine::<P>(name, &build(parts), options, 400);
        assert!(report.equiangular >= 30, "{name}: {} of {}", report.equiangular, report.paths);
    }
    for strategies in [Strategies::BDPT, Strategies::PT, Strategies::LT, Strategies::NONE] {
        take::<Fog>("fog, along", &[FOG, INSIDE, ROOM, LAMP, BULB, POINT, SPOT, GLASS_BALL], strategies);
        take::<Fog>("lens, along", &[FOG, LENS, ROOM, LAMP, BALL, POINT], strategies);
        take::<Bounded>("pane, along", &[FOG, INSIDE, ROOM, LAMP, BALL, PANE], strategies);
        take::<Bounded>("kernel, along", &[OUTSIDE, SMOKE, KERNEL, GROUND, SKY, BULB, POINT], strategies);
        take::<Bounded>("null lamp, along", &[FOG, INSIDE, ROOM, BALL, NULL_LAMP], strategies);
        take::<ChromaticFog>("colours, along", &[CHROMATIC_FOG, INSIDE, ROOM, LAMP, BALL], strategies);
        take::<ChromaticFog>("1e-3, 1, 1e3, along", &[EXTREME_FOG, INSIDE, ROOM, LAMP, BALL], strategies);
        take::<Bounded>("beam, along", &[FOG, INSIDE, ROOM, SEARCHLIGHT, BULB, BALL], strategies);
        take::<Smoke>("waves, along", &[OUTSIDE, WAVES, GROUND, LAMP, BULB], strategies);
        let parts = [OUTSIDE, CHROMATIC_WAVES, GROUND, LAMP, POINT];
        take::<Everything>("coloured waves, along", &parts, strategies);
        take::<ByKind>("fire, along", &[OUTSIDE, HAZE, FIRE_BALL, GROUND, LAMP, POINT], strategies);
    }
    let strategies = Strategies { equiangular: true, ..Strategies::BDPT };
    let setup = build(&[CHROMATIC_FOG, INSIDE, ROOM, LAMP, POINT, BALL]);
    examine_heuristics("heuristics, along", &setup, Options { strategies, ..ALL }, 60);
}

#[test]
fn other_efforts() {
    let effort = Effort { survival: Survival::FourthRoot, connections: 4, ..Effort::EQUAL };
    let options = Options { effort, ..ALL };
    for (name, parts) in [
        ("long walks", &[FOG, INSIDE, ROOM, LAMP, GLASS_BALL][..]),
        ("long walks, open", &[OUTSIDE, CHROMATIC_SMOKE, GROUND, SUN, SKY]),
    ] {
        let report = examine::<Everything>(name, &build(parts), options, 500);
        assert_eq!(report.paths, examine::<ByKind>(name, &build(parts), options, 500).paths);
        assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    }
}

/// One sample of each strategy for each pair of subpaths (LW96 eq. 14).
#[test]
fn all_vertices_of_a_pair_of_walks() {
    let options = Options { connections: Connections::All, ..ALL };
    let all = |name: &'static str, report: Report| {
        assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    };
    let room = build(&[FOG, INSIDE, ROOM, LAMP, POINT, BALL]);
    assert_eq!(
        Estimator::<Fog>::new(&room.scene, options, Learnt::default(), SEED, 64, 64).counts.connection,
        1.0
    );
    all("room", examine::<Fog>("pairs, in a room", &room, options, 500));
    let glass = build(&[FOG, INSIDE, ROOM, LAMP, GLASS_BALL, MIRROR]);
    all("glass", examine::<Fog>("pairs, with glass", &glass, options, 400));
    let open = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SUN, SKY]);
    all("open", examine::<ByKind>("pairs, in the open", &open, options, 600));
    let waves = build(&[OUTSIDE, WAVES, GROUND, LAMP, BULB]);
    all("waves", examine::<Smoke>("pairs, in waves", &waves, options, 500));
    let vacuum = build(&[OUTSIDE, GROUND, LAMP, BALL]);
    all("vacuum", examine::<Vacuum>("pairs, in a vacuum", &vacuum, options, 2000));
}

/// Emitters of all kinds with learnt starts.
#[test]
fn learnt_starts() {
    let options = Options { effort: Effort { starts: LightStarts::Learnt, ..ALL.effort }, ..ALL };
    let all = |name: &'static str, report: Report| {
        assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    };
    let open = build(&[OUTSIDE, SMOKE, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB]);
    all("open", examine::<Bounded>("learnt, in the open", &open, options, 1000));
    let room = build(&[FOG, INSIDE, ROOM, BALL, LUMINAIRE, BEAM, PROFILED_POINT, SPOT, BULB]);
    all("room", examine::<Fog>("learnt, in a room", &room, options, 600));
    let image = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SKY_IMAGE, SUN]);
    all("image", examine::<Everything>("learnt, sky image", &image, options, 1000));
    let beam = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SEARCHLIGHT, SKY]);
    all("beam", examine::<Everything>("learnt, beam", &beam, options, 1000));
    let fire = build(&[OUTSIDE, CHROMATIC_FIRE, GROUND, SUN, BULB]);
    all("fire", examine::<ByKind>("learnt, fire", &fire, options, 600));
    let light = Options { strategies: Strategies { emitter_hit: false, ..Strategies::BDPT }, ..options };
    all("starts seen", examine::<Bounded>("learnt, starts seen", &open, light, 1000));
}

/// The same with starts that aim at glass and smoke.
#[test]
fn aimed_starts() {
    let options = Options { effort: Effort { starts: LightStarts::Aimed, ..ALL.effort }, ..ALL };
    let all = |name: &'static str, report: Report| {
        assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    };
    let open = build(&[OUTSIDE, SMOKE, FROSTED_BALL, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB]);
    all("open", examine::<Bounded>("aimed, in the open", &open, options, 1000));
    let room = build(&[FOG, INSIDE, ROOM, GLASS_BALL, LUMINAIRE, BEAM, PROFILED_POINT, SPOT, BULB]);
    all("room", examine::<Fog>("aimed, in a room", &room, options, 1000));
    let image = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SKY_IMAGE, SUN]);
    all("image", examine::<Everything>("aimed, sky image", &image, options, 1000));
    let fire = build(&[OUTSIDE, CHROMATIC_FIRE, FROSTED_BALL, GROUND, SUN, BULB]);
    all("fire", examine::<ByKind>("aimed, fire", &fire, options, 600));
}

/// Next-event estimation leaves the environment alone.
#[test]
fn a_sky_that_is_hit_only() {
    let options = Options { effort: Effort { sky: super::Sky::Hit, ..ALL.effort }, ..ALL };
    let all = |name: &'static str, report: Report| {
        assert!(report.paths >= 1000, "{name}: {} paths", report.paths);
    };
    let open = build(&[OUTSIDE, SMOKE, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB]);
    all("open", examine::<Bounded>("hit, in the open", &open, options, 1000));
    let image = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SKY_IMAGE, SUN]);
    all("image", examine::<Everything>("hit, sky image", &image, options, 1000));
    let fire = build(&[OUTSIDE, FIRE_BOX, GROUND, SKY]);
    all("fire", examine::<Fire>("hit, fire in a box", &fire, options, 600));
    let learnt = Options { effort: Effort { starts: LightStarts::Learnt, ..options.effort }, ..options };
    all("learnt", examine::<Bounded>("hit, learnt", &open, learnt, 1000));
}

#[test]
fn dirac_vertices_in_fog() {
    examine_all::<Fog>("glass, mirror", &build(&[FOG, INSIDE, ROOM, LAMP, GLASS_BALL, MIRROR]), 400);
    examine_all::<Fog>("frosted", &build(&[FOG, INSIDE, ROOM, BULB, FROSTED_BALL, MIRROR, POINT]), 400);
}

#[test]
fn surfaces_with_several_kinds_of_lobes() {
    examine_all::<Fog>("plastic", &build(&[FOG, INSIDE, ROOM, LAMP, PLASTIC_BALL, MIRROR]), 400);
    examine_all::<Bounded>("veiled", &build(&[FOG, INSIDE, ROOM, LAMP, VEILED_BALL]), 400);
    examine_all::<Bounded>("stained", &build(&[FOG, INSIDE, ROOM, LAMP, BALL, STAINED_PANE]), 400);
    examine_all::<Fog>("blurred", &build(&[FOG, INSIDE, ROOM, BULB, BLURRED_PANE]), 400);
}

#[test]
fn emitters_at_infinity() {
    examine_all::<Bounded>("sky", &build(&[OUTSIDE, SMOKE, KERNEL, GROUND, SKY]), 1000);
    let setup = build(&[OUTSIDE, SMOKE, GROUND, SUN]);
    let report = examine::<Bounded>("sun", &setup, ALL, 1000);
    assert_eq!(report.strategies[0], 0, "a single direction cannot be met");
    examine_all::<Everything>("sun, sky", &build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SUN, SKY]), 1000);
}

/// They cross boundaries, fill a part of what is seen, and come through glass.
#[test]
fn beams() {
    let alone = examine::<Bounded>("beam", &build(&[FOG, INSIDE, ROOM, SEARCHLIGHT]), ALL, 400);
    assert_eq!(alone.strategies[0], 0, "a beam cannot be hit");
    examine_all::<Bounded>("in a room", &build(&[FOG, INSIDE, ROOM, SEARCHLIGHT, BULB, GLASS_BALL]), 400);
    examine_all::<Bounded>("in the open", &build(&[OUTSIDE, SMOKE, GROUND, SEARCHLIGHT, SKY]), 1000);
    let colours = build(&[OUTSIDE, CHROMATIC_WAVES, GROUND, SEARCHLIGHT]);
    assert!(examine::<Everything>("coloured", &colours, ALL, 600).paths >= 1000);
}

#[test]
fn half_transparent_panes() {
    examine_all::<Bounded>("pane", &build(&[FOG, INSIDE, ROOM, LAMP, BALL, PANE]), 400);
    examine_all::<Everything>(
        "pane, colours",
        &build(&[CHROMATIC_FOG, INSIDE, ROOM, BULB, PANE, MIRROR]),
        300,
    );
}

/// Camera subpaths hit them and go on.
#[test]
fn emitters_that_light_passes() {
    examine_all::<Bounded>("null lamp", &build(&[FOG, INSIDE, ROOM, BALL, NULL_LAMP]), 400);
    examine_all::<Bounded>("masked bulb", &build(&[FOG, INSIDE, ROOM, BALL, MASKED_BULB, LAMP]), 400);
    examine_all::<Bounded>("bright boundary", &build(&[OUTSIDE, BRIGHT_SMOKE, GROUND]), 1000);
    let setup = build(&[CHROMATIC_FOG, INSIDE, ROOM, NULL_LAMP, MASKED_BULB, MIRROR]);
    examine_all::<Everything>("null lamp, colours", &setup, 300);
}

#[test]
fn extinction_that_differs_between_channels() {
    examine_all::<ChromaticFog>("chromatic", &build(&[CHROMATIC_FOG, INSIDE, ROOM, LAMP, BALL]), 300);
    examine_all::<ChromaticFog>("1e-3, 1, 1e3", &build(&[EXTREME_FOG, INSIDE, ROOM, LAMP, BALL]), 300);
    let milk = build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SUN, SKY, BULB]);
    examine_all::<ChromaticBounded>("in the open", &milk, 1000);
    examine_all::<ChromaticFog>("one clear", &build(&[YELLOW_FOG, INSIDE, ROOM, LAMP, GLASS_BALL]), 300);
}

#[test]
fn lights_of_all_kinds() {
    let setup = build(&[OUTSIDE, SMOKE, GROUND, SKY, SUN, POINT, SPOT, LAMP, BULB]);
    examine_all::<Bounded>("in the open", &setup, 1000);
    examine_all::<Fog>("in a room", &build(&[FOG, INSIDE, ROOM, BALL, POINT, SPOT, LAMP, BULB]), 400);
}

/// Which of them next-event estimation takes depends on where it is.
#[test]
fn many_lamps() {
    let lamp = |i: u32| {
        let (x, z) = (f64::from(i % 5) * 0.4 - 0.8, f64::from(i / 5) * 0.4 - 0.8);
        format!(
            r#""lamp{i}": {{"type": "sphere", "center": [{x}, 0.7, {z}], "radius": 0.05,
                "emitter": {{"type": "area", "radiance": {}}}}}"#,
            1 + i
        )
    };
    let lamps: Vec<String> = (0..25).map(lamp).collect();
    let lamps = || lamps.iter().map(String::as_str);
    let room: Vec<&str> = [FOG, INSIDE, ROOM, BALL, LAMP].into_iter().chain(lamps()).collect();
    examine_all::<Fog>("in a room", &build(&room), 400);
    let open: Vec<&str> = [OUTSIDE, SMOKE, GROUND, SKY, SUN, POINT].into_iter().chain(lamps()).collect();
    examine_all::<Bounded>("in the open", &build(&open), 1000);
}

#[test]
fn a_lens_of_some_size() {
    examine_all::<Fog>("thin lens", &build(&[FOG, LENS, ROOM, LAMP, BALL, POINT]), 400);
}

#[test]
fn profiles_and_single_directions() {
    let setup = build(&[FOG, INSIDE, ROOM, BALL, LUMINAIRE, BEAM, PROFILED_POINT]);
    examine_all::<Fog>("profiles, beam", &setup, 600);
}

#[test]
fn an_image_of_the_sky() {
    examine_all::<Bounded>("sky image", &build(&[OUTSIDE, SMOKE, GROUND, SKY_IMAGE]), 1000);
}

#[test]
fn normals_that_are_not_the_surface_s() {
    examine_all::<Fog>("smooth mesh", &build(&[FOG, INSIDE, ROOM, BULB, SMOOTH]), 400);
}

/// Media whose extinction and albedo vary, by exact depths and by the stand-in for random ones.
#[test]
fn media_that_vary() {
    examine_all::<Smoke>("waves", &build(&[OUTSIDE, WAVES, GROUND, LAMP, BULB]), 600);
    examine_all::<Smoke>("voxels", &build(&[OUTSIDE, VOXELS, GROUND, SKY, SUN]), 1000);
    examine_all::<Everything>("waves by everything", &build(&[OUTSIDE, WAVES, GROUND, LAMP]), 600);
    examine_all::<Everything>(
        "coloured waves",
        &build(&[OUTSIDE, CHROMATIC_WAVES, GROUND, LAMP, POINT]),
        600,
    );
    examine_all::<Everything>("tracked waves", &build(&[OUTSIDE, TRACKED_WAVES, GROUND, LAMP, SKY]), 600);
}

/// Emissive media: as far as the camera is in them, beside lamps, in smoke that is dark itself.
#[test]
fn media_that_shine() {
    examine_all::<Fire>("glowing fog", &build(&[GLOWING_FOG, INSIDE, SHELL, LAMP, BALL]), 300);
    examine_all::<Fire>("fire ball", &build(&[OUTSIDE, HAZE, FIRE_BALL, GROUND, LAMP, POINT]), 600);
    examine_all::<Fire>("fire in a box", &build(&[OUTSIDE, FIRE_BOX, GROUND, SKY]), 600);
    examine_all::<Fire>("no matter", &build(&[OUTSIDE, NEON, GROUND, MIRROR, BALL]), 3000);
    examine_all::<Everything>("colours", &build(&[OUTSIDE, CHROMATIC_FIRE, GROUND, SUN, BULB]), 600);
    examine_all::<Everything>("tracked", &build(&[OUTSIDE, TRACKED_FIRE, GROUND, LAMP]), 600);
    examine_all::<Everything>(
        "colours, glass, pane",
        &build(&[GLOWING_CHROMATIC_FOG, INSIDE, SHELL, GLASS_BALL, PANE]),
        300,
    );
}

/// By every set of strategies that connect the walks.
fn every_subset<P: Profile>(name: &'static str, setup: &Setup, pairs: u64) {
    for bits in 1..16 {
        let on = |bit: u32| bits >> bit & 1 == 1;
        let strategies = Strategies {
            emitter_hit: on(0),
            next_event: on(1),
            connection: on(2),
            lens: on(3),
            ..Strategies::NONE
        };
        let report = examine::<P>(name, setup, Options { strategies, ..ALL }, pairs);
        for (bit, count) in report.strategies.iter().enumerate() {
            assert_eq!(*count > 0, on(bit as u32), "{strategies:?}");
        }
    }
}

#[test]
fn media_that_shine_by_any_subset_of_strategies() {
    let setup = build(&[GLOWING_FOG, INSIDE, SHELL, LAMP, GLASS_BALL]);
    every_subset::<Fire>("shining subset", &setup, 60);
}

#[test]
fn media_that_shine_within_a_limited_depth() {
    let setup = build(&[OUTSIDE, HAZE, FIRE_BALL, GROUND, LAMP]);
    for (depth, name) in
        [(0, "fire, depth 0"), (1, "fire, depth 1"), (2, "fire, depth 2"), (3, "fire, depth 3")]
    {
        for hide_emitters in [false, true] {
            let options = Options { max_depth: Some(depth), hide_emitters, ..ALL };
            let report = examine::<Fire>(name, &setup, options, 300);
            assert_eq!(report.longest, depth as usize);
            assert_eq!(report.paths > 0, depth > 0, "a medium is never hidden");
        }
    }
}

/// All heuristics but the balance heuristic, in `setup`.
fn examine_heuristics(name: &'static str, setup: &Setup, options: Options, pairs: u64) {
    let by = |heuristic, max_depth| Options { heuristic, max_depth, ..options };
    let open = options.max_depth;
    let bound = Some(open.unwrap_or(Heuristic::CUTOFF_EDGES));
    let reports = [
        examine::<ByCompared>(name, setup, by(Heuristic::Power, open), pairs),
        examine::<ByCompared>(name, setup, by(Heuristic::Maximum, open), pairs),
        examine::<ByCutoff>(name, setup, by(Heuristic::Cutoff { alpha: 0.1 }, bound), pairs),
        examine::<ByCutoff>(name, setup, by(Heuristic::Cutoff { alpha: 0.9 }, bound), pairs),
        examine::<ByCompared>(name, setup, by(Heuristic::Uniform, open), pairs),
    ];
    for report in reports {
        assert!(report.compared >= 100, "{name}: {} paths", report.compared);
    }
}

#[test]
fn every_heuristic_in_fog() {
    examine_heuristics("fog", &build(&[FOG, INSIDE, ROOM, LAMP, BALL]), ALL, 60);
    examine_heuristics("vacuum", &build(&[CLEAR, INSIDE, ROOM, LAMP, BALL]), ALL, 60);
    examine_heuristics("chromatic", &build(&[CHROMATIC_FOG, INSIDE, ROOM, LAMP, BALL]), ALL, 60);
    examine_heuristics("1e-3, 1, 1e3", &build(&[EXTREME_FOG, INSIDE, ROOM, LAMP, BALL]), ALL, 60);
    examine_heuristics("one clear", &build(&[YELLOW_FOG, INSIDE, ROOM, LAMP, BALL]), ALL, 60);
}

#[test]
fn every_heuristic_with_dirac_vertices() {
    let setup = build(&[CHROMATIC_FOG, INSIDE, ROOM, LAMP, GLASS_BALL, MIRROR]);
    examine_heuristics("glass, mirror", &setup, ALL, 60);
    let setup = build(&[FOG, INSIDE, ROOM, LAMP, POINT, PLASTIC_BALL, PANE]);
    examine_heuristics("plastic, pane", &setup, ALL, 60);
}

#[test]
fn every_heuristic_under_the_sky_and_in_fire() {
    examine_heuristics("sky", &build(&[OUTSIDE, CHROMATIC_SMOKE, GROUND, SUN, SKY]), ALL, 200);
    examine_heuristics("waves", &build(&[OUTSIDE, CHROMATIC_WAVES, GROUND, LAMP, POINT]), ALL, 100);
    let setup = build(&[GLOWING_CHROMATIC_FOG, INSIDE, SHELL, GLASS_BALL, PANE]);
    examine_heuristics("fire", &setup, ALL, 60);
}

/// In a hollow diffuse ball all connections of a path have the same density, but for rounding: they share it.
#[test]
fn strategies_that_are_tied() {
    let setup = build(&[CLEAR, INSIDE, HOLLOW]);
    let options = Options { heuristic: Heuristic::Maximum, ..ALL };
    let report = examine::<ByCompared>("hollow ball", &setup, options, 300);
    assert!(report.divided >= 50, "{} of {} paths", report.divided, report.compared);
}

#[test]
fn every_heuristic_by_some_strategies_within_a_limited_depth() {
    let setup = build(&[CHROMATIC_FOG, INSIDE, ROOM, LAMP, BULB, GLASS_BALL]);
    for strategies in [
        Strategies::PT,
        Strategies { next_event: false, ..Strategies::BDPT },
        Strategies { emitter_hit: false, ..Strategies::BDPT },
    ] {
        examine_heuristics("subset", &setup, Options { strategies, max_depth: Some(4), ..ALL }, 100);
    }
}

#[test]
fn limited_depth() {
    let setup = build(&[FOG, INSIDE, ROOM, LAMP, BULB, BALL, POINT]);
    for (depth, name) in [(0, "depth 0"), (1, "depth 1"), (2, "depth 2"), (4, "depth 4")] {
        let options = Options { max_depth: Some(depth), ..ALL };
        let report = examine::<Fog>(name, &setup, options, 300);
        assert_eq!(report.longest, depth as usize);
        assert_eq!(report.paths > 0, depth > 0);
    }
}

#[test]
fn any_subset_of_strategies() {
    let setup = build(&[FOG, INSIDE, ROOM, LAMP, BULB, GLASS_BALL]);
    every_subset::<Fog>("subset", &setup, 100);
}

#[test]
fn hidden_emitters_are_not_seen_but_lit_by() {
    let setup = build(&[OUTSIDE, SMOKE, GROUND, SKY, LAMP]);
    let report = examine::<Bounded>("hidden", &setup, Options { hide_emitters: true, ..ALL }, 300);
    assert!(report.strategies.iter().all(|count| *count > 0));
}

#[test]
fn joins_across_a_hundred_mean_free_paths() {
    let report = examine::<Fog>("tunnel", &build(&[TUNNEL]), ALL, 300);
    assert!(report.deepest > 100.0 && report.strategies[2] > 100);
}

/// No real walk takes these: one to three vertices in the dark between the lamp and the lens, 100 mean free paths
/// apart. All strategies are as unlikely, and must still be weighed against each other.
#[test]
fn paths_through_the_dark() {
    let setup = build(&[TUNNEL]);
    let estimator = Estimator::<Fog>::new(&setup.scene, ALL, Learnt::default(), SEED, PIXELS, PIXELS);
    let (reference, mut report) = (Reference::new(&estimator), Report::new("dark"));
    for index in 0..300 {
        let mut stream = Stream::new(5, index, 0, Purpose::Study);
        let start = setup.scene.lights.sample_emission(&setup.scene.geometry, None, &mut stream).unwrap();
        let mut nodes = vec![Node::emitter(&setup.scene, 0, Place::of(0, &start.point))];
        let count = 1 + index % 3;
        for step in (1..=count).rev() {
            let aside = (stream.square() - 0.5) * 8.0;
            let along = (step as f32 + stream.uniform() - 0.5) * 100.0 / (count + 1) as f32;
            let place = Place::Volume(vec3(aside.x, aside.y, along));
            nodes.push(Node { place, medium: setup.scene.media_map.sensor, dirac: false });
        }
        nodes.push(Node::lens(&setup.scene));
        let path = Path::through(&setup.scene, false, 0, nodes).unwrap();
        let slow = report.lead(&estimator, &reference, &path);
        assert!(slow.iter().flatten().filter(|weight| **weight > 1e-6).count() > 0);
    }
    report.check();
}

#[test]
fn walks_of_ten_thousand_vertices() {
    let setup = build(&[FURNACE, INSIDE, POINT]);
    let options = Options { max_depth: Some(10_001), ..ALL };
    let estimator = Estimator::<Fog>::new(&setup.scene, options, Learnt::default(), SEED, PIXELS, PIXELS);
    let reference = Reference::new(&estimator);
    let mut stream = Stream::new(5, 0, 0, Purpose::Study);
    let mut weighed = 0;
    for case in cases::long_cases(&estimator, 10_000, &mut stream) {
        let path = case.path.unwrap();
        let (slow, fast) = (reference.weights(&path)[case.strategy][0], f64::from(case.weight));
        eprintln!("{} vertices, s = {}: {fast:e} {slow:e}", path.nodes.len(), case.strategy);
        assert!(fast > 0.0 && fast.is_finite());
        // Every vertex rounds the sums once more.
        assert!((fast / slow - 1.0).abs() < 1e-3, "{fast} {slow}");
        weighed += 1;
    }
    assert!(weighed >= 2, "a lens that looks elsewhere is all that may be missing");
}

/// Of more vertices than a cache holds, each is as likely to be there, whenever it came.
#[test]
fn a_full_cache_favours_no_vertex() {
    let setup = build(&[FOG, INSIDE, ROOM, LAMP]);
    let estimator = Estimator::<Fog>::new(&setup.scene, ALL, Learnt::default(), SEED, 1024, 1024);
    let (mut traced, mut stream) = (LightCache::new(1), Stream::new(1, 0, 0, Purpose::Light));
    estimator.trace_light(&mut traced, &mut Nowhere, 0, &mut stream);
    let mut vertex = traced.drawn(0, 1).vertices()[0];
    let mut cache = LightCache::new(1);
    cache.add_walk(0, 1.0);
    let count = 1_000_000;
    for number in 0..count {
        vertex.subpath.edges = number;
        cache.push(0, vertex, false, &mut stream);
    }
    let kept = cache.drawn(0, 1).vertices();
    let mean = kept.iter().map(|vertex| f64::from(vertex.subpath.edges)).sum::<f64>() / kept.len() as f64;
    let (count, len) = (f64::from(count), kept.len() as f64);
    let error = count * ((1.0 - len / count) / (12.0 * len)).sqrt();
    assert!(len < count && (mean - 0.5 * count).abs() < 4.0 * error, "{mean} of {count}, error {error}");
}

/// n of a connection is how often a draw from the cache gives a certain vertex of a light subpath, thinned or not, and of more
/// vertices than it holds.
#[test]
fn joins_are_counted_as_often_as_they_come() {
    for (setup, thinned, walks) in [
        (build(&[FOG, INSIDE, ROOM, LAMP]), false, 20_000),
        (build(&[FURNACE, INSIDE, LAMP]), true, 20_000),
        (build(&[FOG, INSIDE, ROOM, LAMP]), false, 200_000),
    ] {
        let options = Options { max_depth: Some(200), ..ALL };
        let estimator = Estimator::<Fog>::new(&setup.scene, options, Learnt::default(), SEED, 1024, 1024);
        assert_eq!(estimator.keep < 1.0, thinned);
        let mut cache = LightCache::new(1);
        for walk in 0..walks {
            let mut stream = Stream::new(1, walk, 0, Purpose::Light);
            estimator.trace_light(&mut cache, &mut Nowhere, 0, &mut stream);
        }
        let drawn = cache.drawn(0, 1);
        assert!(drawn.vertices().len() < cache.len() || walks == 20_000);
        let stood_for = drawn.scale * walks as f32 * estimator.keep / cache.len() as f32;
        assert!((stood_for - 1.0).abs() < 1e-3, "{stood_for}");
        // Every walk has a first vertex here, so of the draws this part are first vertices:
        let pool = cache.drawn(0, 1).vertices();
        let first = pool.iter().filter(|vertex| vertex.subpath.edges == 1).count() as f32 / pool.len() as f32;
        let count = estimator.counts.connection;
        assert!((count / first - 1.0).abs() < 0.1, "{count} counted, {first} came");
    }
}
