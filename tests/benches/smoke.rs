//! Transmittance and flights through grids and functions, by every tracker that works for them.

use crate::read;
use divan::{Bencher, counter::ItemsCount};
use std::{fmt, path::Path};
use tyndall::{
    medium::{DistanceMethod, MediumOverrides},
    passes::{
        blocks::{CameraStart, PIXELS_PER_BLOCK},
        compiled,
    },
    sampling::Stream,
    settings::Overrides,
    shape::Ray,
};

const SCENES: [&str; 2] = ["scenes/crosscheck/grid_own_box.json", "scenes/drifting_mist.json"];

/// One medium by one tracker.
struct Case {
    scene: &'static str,
    tracker: DistanceMethod,
}

impl fmt::Display for Case {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}", self.scene, self.tracker.name())
    }
}

fn cases() -> impl Iterator<Item = Case> {
    let trackers = |scene: &'static str| {
        let media = read(Path::new(scene), Overrides::default()).scene.media;
        let works = move |tracker: &DistanceMethod| {
            let volumes = media.iter().filter_map(|medium| medium.heterogeneous());
            *tracker != DistanceMethod::Auto
                && volumes.map(|varying| varying.extinction()).all(|of| tracker.applies_to(&of.volume))
        };
        let all = DistanceMethod::NAMES.into_iter().map(|(_, tracker)| tracker);
        all.filter(works).map(move |tracker| Case { scene, tracker })
    };
    SCENES.into_iter().flat_map(trackers)
}

/// Times what `query` asks along the primary ray of every pixel.
fn ask<T>(
    bencher: Bencher<'_, '_>,
    case: &Case,
    query: impl Fn(&dyn compiled::Compiled, Ray, &mut Stream) -> T,
) {
    let media = MediumOverrides { tracker: Some(case.tracker), ..MediumOverrides::default() };
    let setup = read(Path::new(case.scene), Overrides { media, ..Overrides::default() });
    let settings = crate::settings(&setup);
    let compiled =
        compiled::choose(&setup.scene, &setup.film, &settings, Default::default(), PIXELS_PER_BLOCK);
    let mut pass = 0;
    let all = || {
        pass += 1;
        for pixel in 0..setup.film.len() {
            let CameraStart { position, aperture, mut stream, .. } = compiled.camera_start(pass, pixel);
            let ray = setup.scene.sensor.ray(position, aperture).ray;
            divan::black_box(query(&*compiled, ray, &mut stream));
        }
    };
    bencher.counter(ItemsCount::new(setup.film.len())).bench_local(all);
}

#[divan::bench(args = cases())]
fn transmittance(bencher: Bencher<'_, '_>, case: &Case) {
    ask(bencher, case, |compiled, ray, stream| compiled.transmittance(ray, stream));
}

#[divan::bench(args = cases())]
fn flight(bencher: Bencher<'_, '_>, case: &Case) {
    ask(bencher, case, |compiled, ray, stream| compiled.first_interaction(ray, stream));
}
