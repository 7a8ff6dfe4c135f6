//! Pilots against the noise of images, and what they choose in small scenes.

use super::{
    forecast::Tile,
    moments::Weighed,
    record::{Ends, Found, Route, Work},
    *,
};
use crate::{
    format,
    math::SpectrumExt,
    passes::budget::Budget,
    render::instrument::Instrument,
    scene::build::{self, Setup},
    settings::Overrides,
    transport::profiles::ProfileName,
};
use std::path::Path;

/// A small image of a scene of the repository, by `strategies`.
fn small(scene: &str, strategies: Strategies) -> (Setup, Settings) {
    read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene), strategies)
}

/// The same of a room with `things` in it.
fn room(things: &str) -> (Setup, Settings) {
    let text = format!(
        r#"{{"type": "scene", "camera": {{"type": "perspective", "to_world": [{{"type": "lookat", "origin": [0, 0, 0.9], "target": [0, 0, -1]}}]}},
        "room": {{"type": "cube", "flip_normals": true, "bsdf": {{"type": "diffuse", "reflectance": 0.6}}}}, {things}}}"#
    );
    written(&text)
}

/// The same of the scene that `text` describes.
fn written(text: &str) -> (Setup, Settings) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("scene.json");
    std::fs::write(&path, text).unwrap();
    read(&path, Strategies::BDPT)
}

/// The same with a lamp in a black tube, which has one end in the floor.
fn with_tube(length: f64) -> (Setup, Settings) {
    let end = length - 1.0;
    room(&format!(
        r#""tube": {{"type": "cylinder", "p0": [0.3, -1, 0], "p1": [0.3, {end}, 0], "radius": 0.015, "bsdf": {{"type": "twosided", "bsdf": {{"type": "diffuse", "reflectance": 0}}}}}},
        "lamp": {{"type": "sphere", "center": [0.3, -0.98, 0], "radius": 0.01, "emitter": {{"type": "area"}}}}"#
    ))
}

/// The same with a lamp under a dark shade, which much of the light reaches by way of the floor alone.
fn with_shade() -> (Setup, Settings) {
    room(
        r#""shade": {"type": "rectangle", "to_world": [{"type": "scale", "value": 0.5}, {"type": "rotate", "axis": [1, 0, 0], "angle": 90}, {"type": "translate", "value": [0, -0.5, 0]}], "bsdf": {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": 0.1}}},
        "lamp": {"type": "sphere", "center": [0, -0.7, 0], "radius": 0.05, "emitter": {"type": "area"}}"#,
    )
}

/// The same with a ball of glass before a lamp without a size: its caustic is connected by way of the glass.
fn with_glass() -> (Setup, Settings) {
    room(
        r#""ball": {"type": "sphere", "radius": 0.4, "center": [0, -0.4, 0], "bsdf": {"type": "dielectric"}},
        "lamp": {"type": "point", "position": [0, 0.8, 0]}"#,
    )
}

fn read(path: &Path, strategies: Strategies) -> (Setup, Settings) {
    let overrides = Overrides { size: Some((24, 24)), ..Overrides::default() };
    let setup = build::build(&format::read(path, &[]).unwrap(), overrides).unwrap();
    let options = Options { strategies, ..setup.integrator.options };
    let (sampler, budget) = (Sampler::Independent, Budget::ENDLESS);
    (
        setup,
        Settings {
            options,
            sampler,
            film_samples: FilmSamples::Own,
            budget,
            seed: 0,
            profile: ProfileName::Everything,
        },
    )
}

/// The pilot of an image without end, whose light subpaths begin at `starts`.
fn flown(setup: &Setup, settings: &Settings, starts: LightStarts) -> Forecast {
    let among = settings.options.strategies;
    let base = Choice { among, strategies: among, effort: Effort::default(), gain: 1.0 };
    let Setup { scene, film, .. } = setup;
    Pilots { scene, film, settings, decided: Decided::default(), base, work: f64::INFINITY }.fly(starts)
}

#[test]
fn light_subpaths_must_be_better_for_a_denoiser() {
    let (Setup { scene, film, .. }, settings) = &small("efficiency/glass_fog_sky.xml", Strategies::BDPT);
    let judgement = |film_samples, strategies| {
        let choice = Choice { among: Strategies::BDPT, strategies, effort: Effort::default(), gain: 1.0 };
        let (settings, decided) = (&Settings { film_samples, ..*settings }, Decided::default());
        let pilots = Pilots { scene, film, settings, decided, base: choice, work: f64::INFINITY };
        let error = Error { usual: 1.0, few: 0.0 };
        pilots.judge(&Foretold { choice, error, time: 1.0, judgement: f64::INFINITY }, 0.0)
    };
    let ratio =
        |strategies| judgement(FilmSamples::Apart, strategies) / judgement(FilmSamples::Own, strategies);
    assert_eq!([Strategies::BDPT, Strategies::PT].map(ratio), [DENOISED, 1.0]);
}

#[test]
fn path_tracing_has_no_light_subpaths_to_see() {
    let (setup, settings) = small("efficiency/glass_fog_sky.xml", Strategies::PT);
    assert_eq!(flown(&setup, &settings, LightStarts::Emitted).seen_subpaths(), None);
}

fn chosen((setup, settings): &(Setup, Settings), samples_per_pixel: u64) -> Report {
    let settings = Settings { budget: Budget::samples(samples_per_pixel), ..*settings };
    choose(&setup.scene, &setup.film, &settings, Decided::default())
}

/// The tube goes up to the ceiling.
#[test]
fn without_any_light_all_strategies_run_alike() {
    let found = chosen(&with_tube(2.0), 1000);
    assert!(!found.candidates.is_empty());
    assert!(found.candidates.iter().all(|one| one.judgement == f64::INFINITY), "{:?}", found.candidates);
    assert_eq!(found.choice.strategies, Strategies::BDPT);
    assert_eq!(found.choice.effort, Effort { guide: Guiding::Never, ..Effort::default() });
}

#[test]
fn light_from_a_tube_is_worth_a_guide() {
    assert_eq!(chosen(&with_tube(1.2), 1000).choice.effort.guide, Guiding::Always);
}

/// Hardly one in ten thousand light subpaths of this sun meets the ball by chance, and no pilot would know what its caustic
/// costs.
#[test]
fn light_subpaths_aim_at_a_ball_of_glass_under_the_sun() {
    let field = r#""field": {"type": "rectangle", "bsdf": {"type": "diffuse"}, "to_world": [
        {"type": "rotate", "axis": [1, 0, 0], "angle": -90}, {"type": "scale", "value": 30}, {"type": "translate", "value": [0, -1, 0]}]},
        "ball": {"type": "sphere", "center": [0, -0.6, -1.5], "radius": 0.3, "bsdf": {"type": "roughdielectric", "alpha": 0.05}},
        "sun": {"type": "directional", "direction": [0.3, -1, 0.1]}"#;
    let with_field = |things: &str| {
        let text = format!(
            r#"{{"type": "scene", "camera": {{"type": "perspective", "to_world": [{{"type": "lookat", "origin": [0, 1, 2],
            "target": [0, -0.7, -1.5]}}]}}, {things}}}"#
        );
        written(&text)
    };
    let found = chosen(&with_field(field), 1000);
    assert_eq!(found.choice.effort.starts, LightStarts::Aimed, "{:?}", found.candidates[0]);
    let chalk = field.replace("roughdielectric", "diffuse").replace(r#", "alpha": 0.05"#, "");
    assert_eq!(chosen(&with_field(&chalk), 1000).choice.effort.starts, LightStarts::Emitted);
}

/// What takes longer than it can gain is left out; what it takes else is a small part of the samples to come.
#[test]
fn pilots_are_sized_by_the_work_to_come() {
    let (setup, settings) = small("efficiency/glass_fog_sky.xml", Strategies::BDPT);
    let samples = |each: u64| {
        let settings = Settings { budget: Budget::samples(each), ..settings };
        choose(&setup.scene, &setup.film, &settings, Decided::default()).samples
    };
    let pixels = setup.film.len() as f64;
    assert_eq!(samples(16), 0.0);
    for each in [64, 256, 1024] {
        let (found, work) = (samples(each), each as f64 * pixels);
        assert!(found > 0.0 && found <= 1.5 * (SHARE * work).max(LEAST), "{each}: {found}");
    }
    assert!(samples(1 << 20) <= MOST);
}

/// Relative variance of pixel samples, as their images show it, but in the few pixels with the greatest.
fn measured(instrument: &Instrument<'_>) -> f64 {
    let mut sums = vec![(0.0, 0.0); instrument.film.len()];
    let n = 400.0;
    instrument.passes(0..n as usize, &mut |image| {
        for ((sum, square), value) in sums.iter_mut().zip(image) {
            let luminance = f64::from(value.luminance());
            *sum += luminance;
            *square += luminance * luminance;
        }
    });
    let mean = sums.iter().map(|(sum, _)| sum / n).sum::<f64>() / sums.len() as f64;
    let relative = |(sum, square): &(f64, f64)| {
        let of_pixel = sum / n;
        (square / n - of_pixel * of_pixel) / (of_pixel * of_pixel + 0.01 * mean * mean)
    };
    let mut all: Vec<f64> = sums.iter().map(relative).collect();
    all.sort_unstable_by(f64::total_cmp);
    all[..(0.98 * sums.len() as f64) as usize].iter().sum::<f64>() / sums.len() as f64
}

/// A contribution of 1 to the pixel 0.
fn contribution(
    sample: u32,
    kind: StrategyKind,
    shares: [f32; StrategyKind::ALL.len()],
    route: Route,
) -> Found {
    let (pixel, square, expected, vertex) = (0, 1.0, 1.0, 0);
    let (unlearnt, unaimed, without_sky) = (1.0, 1.0, 1.0);
    Found { pixel, square, shares, route, unlearnt, unaimed, without_sky, kind, expected, sample, vertex }
}

/// Next-event estimation does not ask whether the walk survives the vertex next to the emitter, nor do connections to
/// the lens at the other end.
#[test]
fn strategies_survive_all_vertices_but_their_last() {
    let before = Survival::FourthRoot;
    let [at_sensor, at_emitter] = [0.9, 0.1].map(|albedo: f32| Ends::at(albedo.sqrt().sqrt(), before));
    let outermost = [0.9f32.ln(), 0.1f32.ln()];
    let route = Route { all: at_sensor.and(at_emitter), outermost, ..Route::default() };
    let found = contribution(0, StrategyKind::NextEvent, [0.2; 5], route);
    let weighed = Weighed::of(0, &found, End::AtOnce(Survival::Albedo), before);
    let survive = |albedo: f32| 0.2 * albedo.powf(0.75);
    for (kind, expected) in [
        (StrategyKind::EmitterHit, survive(0.9 * 0.1)),
        (StrategyKind::NextEvent, survive(0.9)),
        (StrategyKind::Connection, 0.2),
        (StrategyKind::Lens, survive(0.1)),
    ] {
        let share = weighed.shares[kind as usize] * weighed.passed;
        assert!((share / expected - 1.0).abs() < 1e-5, "{kind:?}: {share}, not {expected}");
    }
}

/// A corner of the image that other strategies do not see decides against them, however small.
#[test]
fn what_a_choice_leaves_out_is_no_outlier() {
    let found = |sample, kind, shares| contribution(sample, kind, shares, Route::default());
    let tile = Tile { pixels: 1.0, samples: 1.0, mean: 0.7, level: 0.7 };
    let alone = |kind| StrategyKind::each(|one| if one == kind { 1.0 } else { 0.0 });
    let corner = |tile| if tile == 7 { StrategyKind::Lens } else { StrategyKind::EmitterHit };
    let found = (0..100).map(|tile| (tile, found(tile, corner(tile), alone(corner(tile))))).collect();
    let work = [Work { walks: 1.0, ..Work::default() }; WALKS_END.len()];
    let forecast = Forecast {
        tiles: vec![tile; 100],
        pixels: Vec::new(),
        found,
        camera: work,
        light: work,
        light_emitted: work,
        starts: LightStarts::Emitted,
        survival: Survival::Albedo,
    };
    let effort = Effort::default();
    let all = Choice { among: Strategies::BDPT, strategies: Strategies::BDPT, effort, gain: 1.0 };
    let [whole, part] = [Strategies::BDPT, Strategies::PT]
        .map(|strategies| forecast.judge(&[Choice { strategies, ..all }])[0].all());
    assert!(whole < 10.0);
    assert_eq!(part, f64::INFINITY);
}

/// From the samples of all strategies, the noise of others is known before they run: of walks that end sooner, of more
/// connections of a vertex, and of next-event estimation that aims at no portals.
#[test]
fn pilots_foresee_the_noise_of_other_counts() {
    let of = |scene| (scene, small(scene, Strategies::BDPT));
    let scenes = ["lampbox_down.xml", "efficiency/glass_fog_sky.xml", "efficiency/skylight.xml"].map(of);
    for (scene, (setup, settings)) in
        scenes.into_iter().chain([("shade", with_shade()), ("glass", with_glass())])
    {
        let forecast = flown(&setup, &settings, LightStarts::Learnt);
        let (among, effort) = (Strategies::BDPT, Effort::default());
        let all = Choice { among, strategies: among, effort, gain: 1.0 };
        let four = Effort { connections: 4, ..all.effort };
        let learnt = Effort { starts: LightStarts::Learnt, ..all.effort };
        let longer = Effort { survival: Survival::FourthRoot, ..all.effort };
        let mut choices = vec![
            all,
            Choice { strategies: Strategies::PT, ..all },
            Choice { effort: four, ..all },
            Choice { effort: longer, ..all },
            Choice { strategies: Strategies::PT, effort: longer, ..all },
            Choice { effort: Effort { connections: 4, ..longer }, ..all },
            Choice { strategies: Strategies::PT, effort: learnt, ..all },
        ];
        choices.retain(|one| coverage::is_complete(&setup.scene, &settings.options, one.strategies));
        let relative: Vec<f64> = choices
            .iter()
            .zip(forecast.judge(&choices))
            .map(|(Choice { strategies, effort, .. }, error)| {
                let options = Options { strategies: *strategies, effort: *effort, ..settings.options };
                let settings = Settings { options, ..settings };
                error.usual / measured(&Instrument::new(&setup.scene, &setup.film, &settings))
            })
            .collect();
        let near = relative.iter().all(|one| (0.75..1.33).contains(&(one / relative[0])));
        assert!(near, "{scene}: {relative:?}");
    }
}

/// A tile that is bright by one of its contributions is measured against those around it; one that is bright by many
/// against itself.
#[test]
fn one_bright_path_makes_no_level() {
    let tile = Tile { pixels: 4.0, samples: 16.0, mean: 1.0, level: 0.0 };
    let mut tiles = [tile; 9];
    tiles[4].mean = 100.0;
    let level = |contributions: f64| {
        let mut squares = [1.0 / 16.0; 9];
        squares[4] = 100.0 * 100.0 / contributions;
        forecast::levels(&tiles, 3, &squares)
    };
    let [by_one, by_many] = [level(1.0), level(1000.0)];
    assert!((10.0..25.0).contains(&by_one[4]) && by_many[4] > 98.0, "{by_one:?}, {by_many:?}");
    assert!(by_one.iter().chain(&by_many).all(|level| (1.0..=100.0).contains(level)));
    // Unlit, or unseen.
    let dark = [Tile { mean: 0.0, ..tile }, Tile { samples: 0.0, mean: 0.0, ..tile }];
    assert_eq!(forecast::levels(&dark, 2, &[0.0; 2]), [0.0; 2]);
}
