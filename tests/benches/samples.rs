//! Samples of whole images: of each pixel one, in scenes that take different profiles.

use crate::read;
use divan::{Bencher, counter::ItemsCount};
use std::path::Path;
use tyndall::{
    passes::{Settings, blocks::PIXELS_PER_BLOCK, compiled},
    settings::Overrides,
    transport::{Options, Strategies},
};

const SCENES: [&str; 5] = [
    "tests/scenes/lampbox_down.json",
    "scenes/foggy_room.json",
    "scenes/efficiency/glass_fog_sky.xml",
    "scenes/drifting_mist.json",
    "scenes/efficiency/nested_media.xml",
];

fn run(bencher: Bencher<'_, '_>, scene: &str, strategies: Strategies) {
    let setup = read(Path::new(scene), Overrides::default());
    let settings = crate::settings(&setup);
    let settings = Settings { options: Options { strategies, ..settings.options }, ..settings };
    let (scene, film) = (&setup.scene, &setup.film);
    let compiled = compiled::choose(scene, film, &settings, Default::default(), PIXELS_PER_BLOCK);
    let mut pass = 0;
    let sample = || {
        pass += 1;
        let blocks = 0..compiled.blocks().count();
        blocks.map(|block| compiled.render(pass, block, &|_| true).camera().len()).sum::<usize>()
    };
    bencher.counter(ItemsCount::new(film.len())).bench_local(sample);
}

#[divan::bench(args = SCENES)]
fn pt(bencher: Bencher<'_, '_>, scene: &str) {
    run(bencher, scene, Strategies::PT);
}

#[divan::bench(args = SCENES)]
fn bdpt(bencher: Bencher<'_, '_>, scene: &str) {
    run(bencher, scene, Strategies::BDPT);
}
