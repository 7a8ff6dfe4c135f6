//! The same seed gives the same image, bit for bit, whatever the machine is doing; and the code that has
//! everything gives the same image as the code that fits.

use crate::common::{
    self, Stage,
    claims::{Claims, Sample},
    pieces::*,
};
use serde_json::{Value, json};
use tyndall::{
    math::Spectrum,
    transport::{Strategies, profiles::ProfileName},
};

/// A room with a lamp, filled with `fog`.
fn room_of(fog: Option<Value>) -> Vec<(&'static str, Value)> {
    vec![
        // More pixels than one block has, so that threads have something to share.
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 40)),
        ("room", room(0.6, fog)),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, rgb(2.0, 3.0, 1.0))),
        ("point", point([-0.5, 0.5, 0.0], 0.3)),
    ]
}

fn cloud_under_sky(sigma_t: Value) -> Vec<(&'static str, Value)> {
    vec![
        ("sensor", camera([0.0, 0.6, 3.2], [0.0, 0.2, 0.0], 40)),
        ("floor", floor(-0.6, 2.0, 0.5)),
        ("cloud", null_box([-0.8, -0.4, -0.8], [0.8, 0.8, 0.8], Some(medium(sigma_t, 0.9, 0.3)))),
        ("sky", sky(0.5)),
        ("sun", sun([0.3, -1.0, -0.2], 1.0)),
    ]
}

/// One scene for every profile.
fn scenes() -> Vec<(ProfileName, Value)> {
    let chromatic = rgb(0.3, 1.0, 2.0);
    vec![
        (ProfileName::Vacuum, scene(&room_of(None))),
        (ProfileName::Fog, scene(&room_of(Some(medium(1.0, 0.8, 0.3))))),
        (ProfileName::Bounded, scene(&cloud_under_sky(json!(1.5)))),
        (ProfileName::Fire, scene(&room_of(Some(with(medium(1.0, 0.8, 0.3), &[("radiance", json!(1))]))))),
        (ProfileName::ChromaticFog, scene(&room_of(Some(medium(chromatic.clone(), 0.8, 0.3))))),
        (ProfileName::ChromaticBounded, scene(&cloud_under_sky(chromatic.clone()))),
        (
            ProfileName::Everything,
            scene(&room_of(Some(with(medium(chromatic, 0.8, 0.3), &[("radiance", json!(1))])))),
        ),
    ]
}

fn bits(image: &[Spectrum]) -> Vec<[u32; 3]> {
    image.iter().map(|v| v.to_array().map(f32::to_bits)).collect()
}

#[test]
fn the_number_of_threads_changes_nothing() {
    for (profile, scene) in scenes() {
        let stage = Stage::new(&scene);
        assert_eq!(stage.profile, profile);
        let image = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| bits(&stage.render(Strategies::BDPT, 6, 11)))
        };
        let one = image(1);
        assert!(one == image(2) && one == image(5), "{}", profile.name());
        assert!(one == image(2), "{}: a second time", profile.name());
    }
}

#[test]
fn another_seed_is_another_image() {
    for (profile, scene) in scenes() {
        let stage = Stage::new(&scene);
        for set in [Strategies::PT, Strategies::LT, Strategies::BDPT] {
            let [a, b, again] = [1, 2, 1].map(|seed| bits(&stage.render(set, 1, seed)));
            assert!(a == again && a != b, "{}", profile.name());
        }
    }
}

#[test]
fn the_code_that_fits_and_the_code_that_has_everything_agree() {
    let mut claims = Claims::new();
    for (profile, scene) in scenes().into_iter().filter(|(name, _)| *name != ProfileName::Everything) {
        let (fitted, everything) = (Stage::new(&scene), Stage::new(&scene).with_everything());
        for (i, set) in [Strategies::PT, Strategies::LT, Strategies::BDPT].into_iter().enumerate() {
            let first = 1000 * i as u64;
            let measure = |stage: &Stage, first| Sample::of(&stage.renders(set, 6, first..first + 10), 40);
            let what = format!("{} against everything, {}", profile.name(), common::name_of(set));
            claims.equal(&what, &measure(&fitted, first), &measure(&everything, first + 500));
        }
    }
    claims.settle();
}

/// Layers come out the same on any number of threads, and the image is the same with and without them.
#[test]
fn layers_change_nothing_but_themselves() {
    for (profile, scene) in scenes() {
        let aovs = json!({"type": "moment", "image": {"type": "bdpt"}});
        let aovs = json!({"type": "aov", "aovs": "d:depth,n:sh_normal", "inner": aovs});
        let (stage, requested) = (Stage::new(&scene), Stage::new(&with(scene, &[("integrator", aovs)])));
        let image = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| requested.render_layers(Strategies::BDPT, 3, 11))
        };
        let (one, three) = (image(1), image(3));
        assert!(one.layers.len() == 17 && one.layers == three.layers, "{}", profile.name());
        assert!(bits(&one.pixels) == bits(&stage.render(Strategies::BDPT, 3, 11)), "{}", profile.name());
    }
}
