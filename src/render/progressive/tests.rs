use super::{conductance::Maps, mesh::Mesh, queue::Queue, regions::Outlines, sight::FirstSurface, *};
use crate::{
    film::sharing::FilmSamples,
    format,
    math::{Vec3, vec3},
    passes::budget::Budget,
    render::render,
    sampling::Sampler,
    scene::build::{self, Setup},
    settings::Overrides,
    transport::{Connections, Options, Strategies, profiles::ProfileName, strategy::StrategyKind},
};
use std::path::Path;

/// A wall that is seen face on, 2 m away.
fn wall(albedo: f32) -> Sight {
    let first = FirstSurface { position: Vec3::ZERO, normal: Vec3::Z, distance: 2.0 };
    Sight { first: Some(first), last_normal: Vec3::Z, albedo: Spectrum::splat(albedo), ..Sight::NOTHING }
}

/// The same at another place, facing elsewhere.
fn turned(position: Vec3, normal: Vec3) -> Sight {
    let first = FirstSurface { position, normal, distance: 2.0 };
    Sight { first: Some(first), last_normal: normal, ..wall(0.5) }
}

fn likeness(a: Sight, b: Sight) -> f32 {
    Maps::new(2, vec![a, b]).likeness(0, 1)
}

/// exp(-(difference / unit)^2) of every map, and the product of all.
#[test]
fn conductances_of_known_differences() {
    let close = |found: f32, exponent: f32| {
        let expected = (-exponent).exp();
        assert!((found - expected).abs() < 1e-4 * (1.0 + expected), "{found}, not {expected}");
    };
    close(likeness(wall(0.5), wall(0.5)), 0.0);
    // sqrt(3) times 0.05, over 0.1.
    close(likeness(wall(0.5), wall(0.55)), 0.75);
    // Along the wall, however far; 0.02 of 2 m off its plane.
    close(likeness(wall(0.5), turned(vec3(7.0, 0.0, 0.0), Vec3::Z)), 0.0);
    close(likeness(wall(0.5), turned(vec3(7.0, 0.0, 0.04), Vec3::Z)), 1.0);
    let tilted = vec3(0.3f32.sin(), 0.0, 0.3f32.cos());
    let angle = (2.0 * 0.15f32.sin() / 0.3).powi(2);
    close(likeness(wall(0.5), turned(Vec3::ZERO, tilted)), angle);
    close(likeness(wall(0.45), turned(Vec3::ZERO, tilted)), angle + 0.75);
    let fog = |opacity, nearness, sight| Sight { opacity, nearness, ..sight };
    close(likeness(fog(0.5, 1.0, wall(0.5)), fog(0.25, 1.0, wall(0.5))), 0.25 + 0.25);
    // What is half hidden counts a quarter.
    close(likeness(fog(0.5, 1.0, wall(0.5)), fog(0.5, 1.0, wall(0.6))), 0.25 * 3.0);
    assert!(likeness(wall(0.5), Sight::NOTHING) < 1e-6);
    assert!(likeness(wall(0.5), Sight { emitter: Some(0), ..wall(0.5) }) < 1e-6);
    close(likeness(Sight::NOTHING, Sight::NOTHING), 0.0);
}

/// A picture of what `sight` says of each place.
fn maps(width: usize, height: usize, sight: impl Fn(usize, usize) -> Sight) -> Maps {
    Maps::new(width, (0..width * height).map(|pixel| sight(pixel % width, pixel / width)).collect())
}

/// P03T fig. 6.5: the product along the pixels that a line passes; past a corner, of the worse way around.
#[test]
fn conductances_along_lines() {
    let steps = maps(8, 8, |x, _| wall(0.1 * x as f32));
    // Each step across differs by 0.1 in each channel.
    for (to, steps_across) in [(7, 7), (8 * 7 + 7, 7), (8 * 3 + 7, 7), (8 * 7, 0)] {
        let (there, back) = (steps.along(0, to), steps.along(to, 0));
        let expected = (-3.0 * steps_across as f32).exp();
        assert!((there - expected).abs() < 1e-3 * expected, "{to}: {there}");
        assert!((there - back).abs() < 1e-3 * expected, "{to}: {there} and {back}");
    }
    let corner = maps(2, 2, |x, y| wall(if (x, y) == (1, 0) { 0.6 } else { 0.5 }));
    assert!((corner.along(0, 3) - (-6.0f32).exp()).abs() < 1e-5);
}

/// A mesh over an image, of its corners and some pixels within.
fn mesh(width: usize, height: usize, radiance: impl Fn(usize, usize) -> Spectrum) -> Mesh {
    let mut mesh = Mesh::new(width, width * height);
    let corners = [0, width - 1, width * (height - 1), width * height - 1];
    let inside = (1..40).map(|i| i * 7919 % (width * height));
    for pixel in corners.into_iter().chain(inside) {
        if mesh.at(pixel).is_none() {
            mesh.insert(pixel, radiance(pixel % width, pixel / width), None);
        }
    }
    mesh
}

/// Triangles leave no pixel out, and where everything looks alike a linear picture is found exactly.
#[test]
fn linear_pictures_are_exact() {
    let radiance =
        |x: usize, y: usize| vec3(1.0 + x as f32, 3.0 + 2.0 * y as f32, 50.0 - x as f32 + 0.5 * y as f32);
    for (width, height) in [(29, 17), (2, 2), (3, 40)] {
        let picture = mesh(width, height, radiance).paint(&maps(width, height, |_, _| wall(0.5)));
        for (pixel, found) in picture.into_iter().enumerate() {
            let expected = radiance(pixel % width, pixel / width);
            assert!(
                (found - expected).length() < 1e-4 * expected.length(),
                "{pixel}: {found}, not {expected}"
            );
        }
    }
}

/// Edges of what is seen stay sharp although triangles reach across.
#[test]
fn pixels_take_from_corners_that_look_alike() {
    let side = |x: usize| if x < 9 { 1.0 } else { 4.0 };
    let halves = maps(20, 20, |x, _| wall(0.2 * side(x)));
    let picture = mesh(20, 20, |x, _| Spectrum::splat(side(x))).paint(&halves);
    // But for triangles with all corners on the other side.
    let wrong = picture.iter().enumerate().filter(|(pixel, value)| (value.x - side(pixel % 20)).abs() > 0.01);
    assert!(wrong.count() < 20);
}

#[test]
fn the_worst_edge_comes_first() {
    let halves = maps(16, 16, |x, y| if x >= 10 && y < 8 { Sight::NOTHING } else { wall(0.5) });
    let mut mesh = Mesh::new(16, 256);
    [0, 15, 240, 255].into_iter().for_each(|pixel| mesh.insert(pixel, Spectrum::ONE, None));
    let mut queue = Queue::new();
    queue.add(&mesh, &halves, std::iter::empty());
    let order: Vec<_> = std::iter::from_fn(|| queue.pop(&mesh)).collect();
    // The diagonal is longer, but only two sides cross the edge, or both ways do.
    assert_eq!(order.len(), 5);
    assert!(halves.along(order[0][0] as usize, order[0][1] as usize) < 0.01, "{order:?}");
    assert!(halves.along(order[4][0] as usize, order[4][1] as usize) > 0.99, "{order:?}");
    // The top side: halfway between its middle, 8, and the break before 10.
    assert_eq!(division(&halves, [0, 15], |_| false), Some(9));
    assert_eq!(division(&halves, [0, 15], |pixel| pixel == 9), Some(8));
    assert_eq!(division(&halves, [0, 15], |_| true), None);
}

/// Outlines are closed, and every piece stays in its region; what is too small has none.
#[test]
fn outlines_follow_regions() {
    let place = |x: usize, y: usize| if (4..14).contains(&x) && (5..12).contains(&y) { 1 } else { 0 };
    let dot = |x: usize, y: usize| (x, y) == (17, 3);
    let maps = maps(20, 16, |x, y| if dot(x, y) { wall(1.0) } else { wall(0.5 * place(x, y) as f32) });
    let Outlines { corners, pieces } = Outlines::of(&maps);
    assert!(!corners.contains(&(3 * 20 + 17)));
    for corner in [5 * 20 + 4, 5 * 20 + 13, 11 * 20 + 4, 11 * 20 + 13] {
        assert!(corners.contains(&corner), "{corner}: {corners:?}");
    }
    for [a, b] in &pieces {
        let region = |pixel: usize| (place(pixel % 20, pixel / 20), dot(pixel % 20, pixel / 20));
        maps.walk(*a as usize, *b as usize, |pixel, _| {
            assert_eq!(region(pixel), region(*a as usize), "{a} {b}")
        });
        let ends = |at: u32| pieces.iter().flatten().filter(|end| **end == at).count();
        assert!(ends(*a).is_multiple_of(2), "{a} is where an outline ends");
    }
    // The square has the greater area for each of its corners.
    assert_eq!(place(corners[0] % 20, corners[0] / 20), 1);
}

/// A small image of a scene, by `strategies` without the lens.
fn small(scene: &str, strategies: Strategies, connections: Connections) -> (Setup, Settings) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(scene);
    let overrides = Overrides { size: Some((37, 28)), ..Overrides::default() };
    let setup = build::build(&format::read(&path, &[]).unwrap(), overrides).unwrap();
    let strategies = strategies.without(StrategyKind::Lens);
    let options = Options { strategies, connections, max_depth: Some(6), ..setup.integrator.options };
    let (sampler, budget) = (Sampler::Sobol, Budget::samples(3));
    (
        setup,
        Settings {
            options,
            sampler,
            film_samples: FilmSamples::Own,
            budget,
            seed: 5,
            profile: ProfileName::Everything,
        },
    )
}

fn made(setup: &Setup, settings: &Settings, method: Method, fraction: f64) -> (Image, Shaded) {
    let fog = (settings.options.strategies == Strategies::NONE).then_some(&setup.integrator.fog);
    let wanted = Progressive { method, fraction };
    run(&setup.scene, &setup.film, settings, fog, &[], wanted, &mut |_, _| {}).unwrap()
}

const ROOM: &str = "foggy_room.json";

#[test]
fn the_number_of_threads_changes_nothing() {
    let strategies = [(Strategies::PT, 0.3), (Strategies::BDPT, 0.3), (Strategies::NONE, 0.9)];
    for (method, (strategies, fraction)) in
        [Method::Straight, Method::Regions].into_iter().flat_map(|method| strategies.map(|s| (method, s)))
    {
        let (setup, settings) = small(ROOM, strategies, Connections::Cached);
        let [one, two, seven] = [1, 2, 7].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let (image, shaded) = pool.install(|| made(&setup, &settings, method, fraction));
            assert_eq!(shaded.pixels, (fraction * 37.0 * 28.0).round() as usize);
            image.pixels.iter().map(|pixel| pixel.to_array().map(f32::to_bits)).collect::<Vec<_>>()
        });
        assert!(one == two && one == seven, "{method:?} {strategies:?}");
    }
}

/// Where a pixel's samples depend on nothing else, shaded pixels are those of a whole render; so are all where all are shaded.
#[test]
fn shaded_pixels_are_those_of_a_whole_render() {
    for (strategies, connections) in
        [(Strategies::PT, Connections::Cached), (Strategies::BDPT, Connections::All)]
    {
        let (setup, settings) = small(ROOM, strategies, connections);
        let whole = render(&setup.scene, &setup.film, &settings, &mut |_| {}).unwrap();
        for (method, fraction) in [(Method::Straight, 0.2), (Method::Regions, 0.2), (Method::Regions, 1.0)] {
            let (image, _) = made(&setup, &settings, method, fraction);
            let samples = &image.layers.last().unwrap().values;
            let pixels = whole.pixels.iter().zip(&image.pixels).zip(samples);
            let mut shaded = 0;
            for ((whole, few), _) in pixels.filter(|(_, samples)| **samples > 0.0) {
                assert!((*whole - *few).length() <= 1e-5 * whole.length(), "{whole} {few}");
                shaded += 1;
            }
            assert_eq!(shaded, (fraction * 37.0 * 28.0).round() as usize);
        }
    }
}

/// With a cache of light subpaths that a few pixels share, the mean stays what it is.
#[test]
fn light_subpaths_of_a_few_pixels_do() {
    let (setup, settings) = small("lampbox_up.xml", Strategies::BDPT, Connections::Cached);
    let settings = Settings { budget: Budget::samples(200), ..settings };
    let whole = render(&setup.scene, &setup.film, &settings, &mut |_| {}).unwrap();
    let (image, _) = made(&setup, &settings, Method::Straight, 1.0);
    let mean = |image: &Image| image.pixels.iter().map(|pixel| f64::from(pixel.y)).sum::<f64>();
    let (found, expected) = (mean(&image), mean(&whole));
    assert!((found / expected - 1.0).abs() < 0.03, "{found} {expected}");
}

#[test]
fn an_interrupted_picture_is_whole() {
    let (setup, settings) = small(ROOM, Strategies::PT, Connections::Cached);
    let budget = Budget { interrupted: || true, ..settings.budget };
    let (image, shaded) = made(&setup, &Settings { budget, ..settings }, Method::Straight, 0.5);
    assert_eq!((shaded.pixels, image.pixels.len()), (4, 37 * 28));
}
