//! Made-up studies: a folder with `study.json` and small images.

use std::path::Path;
use tempfile::TempDir;
use tyndall::{
    analysis::study::outcome::{
        Apart, Chosen, Conditions, ContenderOutcome, Interval, Outcome, Point, Reference, SceneOutcome,
    },
    film::{exr, format::Format},
    math::{Spectrum, vec3},
};

/// Size of all images.
const WIDTH: usize = 12;
/// Rows.
const HEIGHT: usize = 8;

/// A study in a folder of its own.
pub(crate) struct Study {
    /// Where it lies.
    pub folder: TempDir,
    /// What its `study.json` says.
    pub outcome: Outcome,
}

impl Study {
    /// Every scene with every contender, at as many doubling budgets, all converging.
    pub(crate) fn new(scenes: &[&str], contenders: &[&str], budgets: usize) -> Self {
        let scenes = scenes.iter().enumerate().map(|(index, name)| scene(index, name, contenders, budgets));
        let outcome = Outcome {
            made_by: "tyndall 0.0.0".into(),
            command: "tyndall study room.json --seeds 4".into(),
            machine: "a machine, 2 threads".into(),
            conditions: Some(Conditions {
                started: "2026-11-27 13:20 UTC".into(),
                load_before: Some([0.5, 0.25, 0.125]),
                load_after: Some([2.0, 1.0, 0.5]),
            }),
            confidence: 0.95,
            scenes: scenes.collect(),
        };
        let study = Self { folder: TempDir::new().unwrap(), outcome };
        study.write_images();
        study.rewrite();
        study
    }

    /// Writes `study.json` as the outcome now is.
    pub(crate) fn rewrite(&self) {
        let text = serde_json::to_string(&self.outcome).unwrap();
        std::fs::write(self.folder.path().join("study.json"), text).unwrap();
    }

    /// Makes every number of every contender `value`.
    pub(crate) fn set_all(&mut self, value: f64) {
        let same = Interval { mean: value, low: value, high: value };
        for contender in self.outcome.scenes.iter_mut().flat_map(|scene| &mut scene.contenders) {
            (contender.efficiency, contender.slope) = (same, Some(same));
            for p in &mut contender.points {
                let measures = [&mut p.mse, &mut p.relmse, &mut p.trimmed_relmse, &mut p.mape, &mut p.smape];
                measures.into_iter().for_each(|measure| *measure = same);
                (p.seconds, p.difference) = (same, same);
            }
        }
        for scene in &mut self.outcome.scenes {
            scene.reference.own_relmse = Some(value);
        }
        self.rewrite();
    }

    fn write_images(&self) {
        let at = |path: &Path| self.folder.path().join(path);
        for scene in &self.outcome.scenes {
            let light = |k: usize| 0.1 + 0.5 * (k % 7) as f32;
            write_image(&at(&scene.reference.image), light);
            for (series, contender) in scene.contenders.iter().enumerate() {
                write_image(&at(&contender.variance), |k| 0.01 * light(k));
                for (budget, point) in contender.points.iter().enumerate() {
                    let noise = |k: usize| 0.2 * ((k * 31 + series * 7) % 11) as f32 / (1 << budget) as f32;
                    write_image(&at(&point.image), |k| light(k) + noise(k));
                }
            }
        }
    }
}

/// An image of the size of all, pixel by pixel.
pub(crate) fn write_image(path: &Path, light: impl Fn(usize) -> f32) {
    std::fs::create_dir_all(path.parent().unwrap()).unwrap();
    let pixels: Vec<Spectrum> = (0..WIDTH * HEIGHT).map(light).map(|l| vec3(l, 0.8 * l, 0.6 * l)).collect();
    let format = Format::default();
    exr::write(path, WIDTH, HEIGHT, format.channels(&pixels, &[]), format).unwrap();
}

fn scene(index: usize, name: &str, contenders: &[&str], budgets: usize) -> SceneOutcome {
    let contenders = contenders.iter().enumerate();
    SceneOutcome {
        name: name.to_owned(),
        width: WIDTH,
        height: HEIGHT,
        reference: Reference {
            image: format!("images/{index}/reference.exr").into(),
            how: "bdpt, 4096 samples per pixel".into(),
            own_relmse: Some(1e-5),
            known_by: Some("how far its 16 independent batches are apart".into()),
            apart: None,
            like: vec!["bdpt".into()],
        },
        contenders: contenders
            .map(|(series, name)| contender(&format!("images/{index}/{series}"), series, name, budgets))
            .collect(),
        notes: Vec::new(),
    }
}

fn contender(folder: &str, series: usize, name: &str, budgets: usize) -> ContenderOutcome {
    let about = |mean: f64| Interval { mean, low: 0.8 * mean, high: 1.3 * mean };
    let error = |budget: usize| (1.0 + series as f64) * 0.1 / f64::from(1u32 << budget);
    let point = |budget: usize| Point {
        samples: 4 << budget,
        seconds: about(0.5 * f64::from(1u32 << budget)),
        cpu_seconds: (series != 2).then(|| about(0.9 * f64::from(1u32 << budget))),
        mse: about(2.0 * error(budget)),
        relmse: about(error(budget)),
        trimmed_relmse: about(0.7 * error(budget)),
        mape: about(error(budget).sqrt()),
        smape: about(0.9 * error(budget).sqrt()),
        difference: Interval { mean: 0.0, low: -0.01, high: 0.01 },
        image: format!("{folder}/{budget}.exr").into(),
    };
    ContenderOutcome {
        name: name.to_owned(),
        load_seconds: (series > 0).then_some(0.1),
        points: (0..budgets).map(point).collect(),
        slope: (budgets > 2).then_some(Interval { mean: -1.0, low: -1.1, high: -0.9 }),
        efficiency: about(1.0 / (0.05 * (1.0 + series as f64))),
        chosen: (series == 0).then(|| Chosen { what: "bdpt (hit, join)".into(), otherwise: 1, seeds: 4 }),
        apart: Some(Apart { errors: [0.5, -1.5, 12.0][series % 3], limit: 5.0 }),
        variance: format!("{folder}/variance.exr").into(),
        ratio: (series > 0).then(|| about(1.0 / (1.0 + series as f64))),
        notes: Vec::new(),
    }
}
