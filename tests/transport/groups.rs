//! Layers of groups of emitters: they add up to the image, which is the same without them, and each shows what its emitters
//! contribute.

use crate::common::{
    Stage,
    claims::{Claims, Sample},
    pieces::*,
    strategies,
};
use serde_json::{Value, json};
use tyndall::{
    math::{Spectrum, vec3},
    passes::{Settings, budget::Budget},
    render::{self, Image, Precision},
    transport::Strategies,
};

pub(crate) const SETS: [&str; 5] = [
    "hit+next-event",
    "lens",
    "hit+next-event+join+lens",
    "next-event+join",
    "hit+next-event+join+lens+equiangular",
];

/// A room of `fog`, which may emit, with lamps of several kinds; the one called `name` is `changed`.
pub(crate) fn room_with(fog: Value, name: &str, changed: &[(&str, Value)]) -> Value {
    let grouped = |lamp: Value, group: &str| with(lamp, &[("group", json!(group))]);
    let ball = json!({"type": "area", "radiance": rgb(2.0, 3.0, 1.0), "group": "warm"});
    let searchlight = beam([-0.8, 0.6, -0.6], [0.8, -0.5, 0.6], 0.25, rgb(6.0, 4.0, 2.0));
    let mut lamps = [
        ("ball", ball),
        ("searchlight", grouped(searchlight, "beams")),
        ("spot", grouped(spot([0.5, 0.5, 0.5], [0.0, -1.0, 0.0], 1.0), "beams")),
        ("point", point([-0.5, -0.5, 0.0], 0.3)),
    ];
    if let Some((_, lamp)) = lamps.iter_mut().find(|(lamp, _)| *lamp == name) {
        *lamp = with(lamp.clone(), changed);
    }
    let [(_, ball), searchlight, spot, point] = lamps;
    let shell = lamp_ball([0.2, 0.3, -0.3], 0.3, 0.0);
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("room", room(0.6, Some(fog))),
        ("ball", with(shell, &[("emitter", ball)])),
        searchlight,
        spot,
        point,
    ])
}

pub(crate) fn fogs() -> [(&'static str, Value); 4] {
    let grey = medium(1.0, 0.8, 0.3);
    let colours = medium(rgb(0.2, 1.0, 3.0), rgb(0.9, 0.7, 0.8), -0.2);
    let glow = [("radiance", json!(0.2)), ("group", json!("glow"))];
    let waves = json!({"type": "cosine", "constant": 1, "a": {"type": "wave", "amplitude": 0.9, "vector": [4, 2, 1]}});
    let smoke =
        json!({"type": "heterogeneous", "tracker": "null_collision", "sigma_t": waves, "albedo": 0.8});
    [
        ("vacuum", medium(0.0, 0.0, 0.0)),
        ("fog", with(grey, &glow)),
        ("colours", with(colours, &glow)),
        ("waves", smoke),
    ]
}

/// The layer of `group`.
fn layer(image: &Image, group: &str) -> Vec<Spectrum> {
    layer_named(image, &format!("group.{group}"))
}

/// The layer with that name.
pub(crate) fn layer_named(image: &Image, layer: &str) -> Vec<Spectrum> {
    let channel = |end: &str| {
        let name = format!("{layer}.{end}");
        let found = image.layers.iter().find(|channel| channel.name == name);
        &found.unwrap_or_else(|| panic!("no {name}")).values
    };
    let [r, g, b] = ["R", "G", "B"].map(channel);
    (0..r.len()).map(|pixel| vec3(r[pixel], g[pixel], b[pixel])).collect()
}

/// Pixel by pixel, `found` is what `expected` says, up to the rounding of sums of many.
pub(crate) fn assert_close(what: &str, found: &[Spectrum], expected: impl Fn(usize) -> Spectrum) {
    let most = found.iter().map(|pixel| pixel.max_element()).fold(0.0, f32::max);
    for (pixel, found) in found.iter().enumerate() {
        let error = (*found - expected(pixel)).abs().max_element();
        let allowed = 2e-5 * found.max_element() + 1e-6 * most;
        assert!(error <= allowed, "{what}, pixel {pixel}: {found} against {}", expected(pixel));
    }
}

fn assert_whole(what: &str, image: &Image, groups: &[&str]) {
    assert_eq!(image.layers.iter().filter(|channel| channel.name.ends_with(".R")).count(), groups.len());
    let layers: Vec<_> = groups.iter().map(|group| layer(image, group)).collect();
    assert!(layers.iter().all(|layer| layer.iter().any(|pixel| *pixel != Spectrum::ZERO)), "{what}");
    assert_close(what, &image.pixels, |pixel| layers.iter().map(|layer| layer[pixel]).sum());
}

#[test]
fn groups_add_up_to_the_image_that_there_is_without_them() {
    for (name, fog) in fogs() {
        let scene = room_with(fog, "", &[]);
        let (plain, grouped) = (Stage::new(&scene), Stage::with_groups(&scene));
        let mut groups = vec!["warm", "beams", "rest"];
        if name == "fog" || name == "colours" {
            groups.insert(2, "glow");
        }
        for set in SETS.map(strategies) {
            // An emissive medium and a lamp in view need one or the other.
            let image = grouped.render_layers(set, 6, 3);
            let what = format!("{name}, {}", crate::common::name_of(set));
            assert_whole(&what, &image, &groups);
            assert_eq!(image.pixels, plain.render(set, 6, 3), "{what}");
        }
    }
}

/// An emitter at half its brightness, and as often sampled as before: the same paths, of which its own count half.
#[test]
fn half_an_emitter_is_half_its_layer() {
    for (name, fog) in fogs() {
        for (lamp, parameter, half, group) in
            [("ball", "radiance", rgb(1.0, 1.5, 0.5), "warm"), ("point", "intensity", json!(0.15), "rest")]
        {
            let changed = [(parameter, half), ("sampling_weight", json!(2))];
            let whole = Stage::with_groups(&room_with(fog.clone(), "", &[]));
            let halved = Stage::with_groups(&room_with(fog.clone(), lamp, &changed));
            for set in SETS.map(strategies) {
                let [before, after] = [&whole, &halved].map(|stage| stage.render_layers(set, 6, 3));
                let own = layer(&before, group);
                let what = format!("{name}, {lamp}, {}", crate::common::name_of(set));
                assert_close(&what, &after.pixels, |pixel| before.pixels[pixel] - 0.5 * own[pixel]);
            }
        }
    }
}

/// With other samples, too, a layer is what its emitters alone would show.
#[test]
fn a_layer_is_the_image_of_its_emitters() {
    let mut claims = Claims::new();
    let fog = medium(1.0, 0.8, 0.3);
    let dark = Stage::with_groups(&room_with(fog.clone(), "ball", &[("radiance", json!(0))]));
    let all = Stage::with_groups(&room_with(fog, "", &[]));
    for set in [Strategies::PT, Strategies::LT, Strategies::BDPT] {
        let render = |stage: &Stage, seed| stage.render_layers(set, 64, seed);
        let without: Vec<_> = (0..12)
            .map(|seed| {
                let image = render(&all, seed);
                let own = layer(&image, "warm");
                image.pixels.iter().zip(own).map(|(pixel, own)| *pixel - own).collect()
            })
            .collect();
        let others: Vec<_> = (100..112).map(|seed| render(&dark, seed).pixels).collect();
        claims.equal(&crate::common::name_of(set), &Sample::of(&without, 8), &Sample::of(&others, 8));
    }
    claims.settle();
}

/// Layers end with the pixels of the image, some of them here after fewer samples than others.
#[test]
fn groups_add_up_where_pixels_stop_by_precision() {
    let stage = Stage::with_groups(&room_with(medium(1.0, 0.8, 0.3), "", &[]));
    let render = |spp: u64| {
        let settings = Settings { budget: Budget::samples(spp), ..stage.settings(Strategies::BDPT, 1, 5) };
        let (setup, precision) = (&stage.setup, Precision { error: 0.3, confidence: 0.9 });
        let layers = &setup.integrator.layers;
        render::render_to_precision(setup, &setup.film, &settings, precision, layers, &mut |_| {}).unwrap()
    };
    let image = render(2000);
    let reached = image.reached.as_ref().unwrap();
    assert!(reached.share > 0.5 && reached.samples.iter().min() < reached.samples.iter().max());
    assert_whole("by precision", &image, &["warm", "beams", "rest"]);
    assert_whole("stopped early", &render(1), &["warm", "beams", "rest"]);
}
