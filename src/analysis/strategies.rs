//! What every strategy of the estimator is worth in a scene (LW96 sec. 4; Veach 1997, sec. 10.3): its image weighted
//! and alone, its share of energy, variance and time; and which kinds of strategies the scene could do without.

pub mod images;
pub mod pilot;
mod report;
mod subsets;
mod table;
mod timing;

pub use report::*;
pub use table::table;

use super::sheet::{self, Row};
use crate::{
    error::Result,
    film::{self, Channel, Film, format::Format, moments::Moments, sharing::FilmSamples},
    math::{Spectrum, SpectrumExt},
    memory,
    render::{Settings, instrument::Instrument},
    scene::build::Setup,
    transport::{Options, Strategies, coverage::Traits, strategy::StrategyKind},
};
use images::{CellImages, StrategyCell, StrategyImages, StrategyTable};
use std::path::{Path, PathBuf};
use subsets::{advice, compare, subset, subsets};
use timing::Times;

/// How much is done.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Paths of up to so many segments are reported strategy by strategy.
    pub depth: u32,
    /// Passes that make the images.
    pub passes: usize,
    /// Passes, or a few more, of every set of strategies in the comparison; 0 for none.
    pub pilots: usize,
}

/// What was found, and the images of it.
pub struct Findings {
    /// The numbers.
    pub report: Report,
    parts: StrategyImages,
    film: [usize; 2],
}

/// Examines all strategies of `setup`, rendered by `settings`. Reports how many steps are done of how many.
pub fn examine(
    setup: &Setup,
    settings: &Settings,
    plan: &Plan,
    progress: &mut dyn FnMut(usize, usize),
) -> Result<Findings> {
    // Images of strategies show what is found through each pixel.
    let settings = &Settings { film_samples: FilmSamples::Own, ..*settings };
    let options = settings.options;
    let cells = table_of(plan, &options);
    check(&setup.film, plan, &options)?;
    let subsets = subsets(options.strategies);
    let timed = plan.passes.div_ceil(4);
    let pilots = if plan.pilots > 0 { pilot::passes(plan.pilots) } else { 0 };
    let before = plan.passes + timed;
    // As many contenders as there can be: which of them can make all paths is not known yet.
    let total = before + pilots * (subsets.len() + 1);
    let instrument = Instrument::new(&setup.scene, &setup.film, settings);
    let parts =
        StrategyImages::render(&instrument, settings.options.strategies, cells, plan.passes, &mut |done| {
            progress(done, total)
        });
    let times = Times::of(&instrument, cells, timed, &mut |done| progress(plan.passes + done, total));
    let mut report = report(setup, &options, &parts, &times, timed);
    let seen = parts.luminance_of(Some(1)) > 0.0;
    let traits = Traits::of(&setup.scene, (&options).into(), seen);
    let (lacking, able): (Vec<_>, Vec<_>) = subsets
        .into_iter()
        .map(|set| (set, traits.missing(set, options.strategies)))
        .partition(|(_, lacks)| lacks.is_some());
    if plan.pilots > 0 {
        let able: Vec<Strategies> = able.into_iter().map(|(set, _)| set).collect();
        let total = before + pilots * (able.len() + 1);
        report.subsets = compare(setup, settings, &able, &parts.whole.mean(), plan.pilots, &mut |done| {
            progress(before + done, total)
        });
        report.advice = Some(advice(&report.subsets));
    }
    let full = options.strategies;
    report
        .subsets
        .extend(lacking.into_iter().map(|(set, lacks)| SubsetReport { lacks, ..subset(full, set, None) }));
    let film = [setup.film.width as usize, setup.film.height as usize];
    Ok(Findings { report, parts, film })
}

/// An error where there is nothing to examine, or memory does not hold the images.
pub fn check(film: &Film, plan: &Plan, options: &Options) -> Result<()> {
    let cells = table_of(plan, options);
    super::check_paths(options.algorithm)?;
    let bytes = film.len().checked_mul(StrategyImages::bytes_per_pixel(cells)).map(|bytes| bytes as u64);
    let size = format!("{} strategies on {} x {} pixels", cells.count(), film.width, film.height);
    let remedy = "use a smaller --size or a smaller --depth";
    memory::check("tyndall strategies", "images", &size, bytes, remedy)
}

fn table_of(plan: &Plan, options: &Options) -> StrategyTable {
    StrategyTable { depth: plan.depth.min(options.max_depth.unwrap_or(u32::MAX)).max(1) }
}

/// What [`Findings::write`] writes.
const FILES: [&str; 6] =
    ["strategies.json", "strategies.csv", "weighted.exr", "weighted.png", "unweighted.exr", "unweighted.png"];

/// An error unless the files of what [`examine`] finds can be written into `folder`, which exists.
pub fn check_files(folder: &Path, film: &Film, plan: &Plan, options: &Options) -> Result<()> {
    let layers = table_of(plan, options).count() + 1;
    let bytes = |name: &str| if name.ends_with(".exr") { film.bytes(3 * layers) } else { 0 };
    let files = FILES.map(|name| (folder.join(name), bytes(name)));
    film::output::check(&files.each_ref().map(|(file, bytes)| (file.as_path(), *bytes)))
}

fn report(setup: &Setup, options: &Options, parts: &StrategyImages, times: &Times, timed: usize) -> Report {
    let whole = Whole {
        luminance: mean_luminance(&parts.whole),
        variance: parts.whole.luminance_variance(),
        seconds: times.total().max(f64::MIN_POSITIVE),
        samples: (timed * setup.film.len()) as f64,
    };
    let lengths = (1..=parts.table.depth).map(Some).chain([None]);
    let rows = lengths.map(|length| RowReport {
        length,
        exposure: sheet::exposure(&parts.sum_of(length)),
        energy: share(parts.luminance_of(length), whole.luminance).unwrap_or(0.0),
    });
    let cells = parts.table.all().zip(&parts.images).enumerate().filter_map(|(index, (cell, images))| {
        let spent = (times.connections[index], times.tries[index]);
        Some(whole.cell(cell, images.as_ref()?, parts.luminance_of(cell.length()), spent))
    });
    let cells: Vec<CellReport> = cells.collect();
    let own: Option<f64> = cells.iter().map(|cell| cell.variance).sum();
    Report {
        made_by: concat!("Tyndall ", env!("CARGO_PKG_VERSION")).to_owned(),
        strategies: options.strategies.names(),
        size: [setup.film.width, setup.film.height],
        passes: parts.whole.passes() as usize,
        luminance: whole.luminance,
        variance: whole.variance,
        seconds: whole.seconds / timed as f64,
        eye_walks: times.camera_paths / whole.seconds,
        light_walks: times.light_paths / whole.seconds,
        eye_vertices: times.camera_vertices as f64 / whole.samples,
        light_vertices: times.light_vertices as f64 / whole.samples,
        covariances: own.map(|own| 1.0 - own),
        rows: rows.collect(),
        cells,
        subsets: Vec::new(),
        advice: None,
    }
}

/// What the shares of strategies are of.
struct Whole {
    luminance: f64,
    variance: Option<f64>,
    seconds: f64,
    samples: f64,
}

impl Whole {
    /// A strategy, which took `seconds` for `tries`; `luminance` is that of all paths of its length.
    fn cell(
        &self,
        cell: StrategyCell,
        images: &CellImages,
        luminance: f64,
        (seconds, tries): (f64, u64),
    ) -> CellReport {
        let relative = |image: &Moments| share(image.luminance_variance()?, self.variance?);
        let (s, t) = match cell {
            StrategyCell::Strategy { s, t } => (Some(s), Some(t)),
            StrategyCell::Longer(StrategyKind::Equiangular) => (Some(1), Some(2)),
            StrategyCell::Longer(_) => (None, None),
        };
        CellReport {
            name: cell.name(),
            length: cell.length(),
            s,
            t,
            kind: cell.kind().name(),
            energy: share(mean_luminance(&images.weighted), self.luminance).unwrap_or(0.0),
            alone: cell.length().and_then(|_| share(mean_luminance(&images.alone), luminance)),
            variance: relative(&images.weighted),
            variance_alone: relative(&images.alone),
            time: seconds / self.seconds,
            tries: tries as f64 / self.samples,
        }
    }
}

/// `part` of `whole`; none where there is nothing.
fn share(part: f64, whole: f64) -> Option<f64> {
    (whole != 0.0).then(|| part / whole)
}

fn mean_luminance(image: &Moments) -> f64 {
    let mean = image.mean();
    mean.iter().map(|pixel| f64::from(pixel.luminance())).sum::<f64>() / mean.len() as f64
}

impl StrategyImages {
    /// The cells of paths of `length` segments, or of longer ones, with their images; equiangular sampling only where it runs.
    fn of(&self, length: Option<u32>) -> impl Iterator<Item = (StrategyCell, Option<&CellImages>)> {
        let all = self.table.all().zip(self.images.iter().map(Option::as_ref));
        let optional = |cell: StrategyCell| cell.kind() == StrategyKind::Equiangular;
        all.filter(move |(cell, images)| cell.length() == length && (images.is_some() || !optional(*cell)))
    }

    /// Mean luminance of what all strategies contribute on paths of `length` segments, or on longer ones.
    fn luminance_of(&self, length: Option<u32>) -> f64 {
        self.of(length).filter_map(|(_, images)| Some(mean_luminance(&images?.weighted))).sum()
    }

    /// The image that they make.
    fn sum_of(&self, length: Option<u32>) -> Vec<Spectrum> {
        let mut sum = vec![Spectrum::ZERO; self.whole.len()];
        for (_, images) in self.of(length) {
            let mean = images.map_or(Vec::new(), |images| images.weighted.mean());
            sum.iter_mut().zip(mean).for_each(|(sum, value)| *sum += value);
        }
        sum
    }
}

/// Which of the two images of a strategy.
#[derive(Clone, Copy)]
enum Which {
    Weighted,
    Alone,
}

impl Findings {
    /// Writes numbers and images into `folder`, which exists; the files.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>> {
        let file = |name: &str| folder.join(name);
        let json = serde_json::to_string_pretty(&self.report).unwrap_or_default();
        let (json_file, csv_file) = (file("strategies.json"), file("strategies.csv"));
        film::output::write(&json_file, |out| writeln!(out, "{json}"))?;
        film::output::write(&csv_file, |out| out.write_all(table::csv(&self.report).as_bytes()))?;
        let mut files = vec![json_file, csv_file];
        for (which, name) in [(Which::Weighted, "weighted"), (Which::Alone, "unweighted")] {
            let (exr, png) = (file(&format!("{name}.exr")), file(&format!("{name}.png")));
            let [width, height] = self.film;
            film::exr::write(&exr, width, height, self.channels(which), Format::default())?;
            sheet::write(&png, width, height, &self.rows(which))?;
            files.extend([exr, png]);
        }
        Ok(files)
    }

    /// The image of a strategy; black where it does not run.
    fn image(&self, images: Option<&CellImages>, which: Which) -> Vec<Spectrum> {
        match (images, which) {
            (None, _) => vec![Spectrum::ZERO; self.film[0] * self.film[1]],
            (Some(images), Which::Weighted) => images.weighted.mean(),
            (Some(images), Which::Alone) => images.alone.mean(),
        }
    }

    /// The whole image, and of every strategy a layer.
    fn channels(&self, which: Which) -> Vec<Channel> {
        let mut layers = vec![(String::new(), self.parts.whole.mean())];
        for (cell, images) in self.parts.table.all().zip(&self.parts.images) {
            if images.is_some() {
                layers.push((format!("{}.", cell.name()), self.image(images.as_ref(), which)));
            }
        }
        let channel = |(layer, image): &(String, Vec<Spectrum>), at: usize| Channel {
            name: format!("{layer}{}", ["R", "G", "B"][at]),
            values: image.iter().map(|pixel| pixel[at]).collect(),
        };
        layers.iter().flat_map(|layer| (0..3).map(move |at| channel(layer, at))).collect()
    }

    /// How long the paths of a row are.
    fn length(&self, length: Option<u32>) -> String {
        match length {
            Some(1) => "1 segment".to_owned(),
            Some(length) => format!("{length} segments"),
            None => format!("> {} segments", self.parts.table.depth),
        }
    }

    fn rows(&self, which: Which) -> Vec<Row> {
        let image =
            |(cell, images): (StrategyCell, Option<&CellImages>)| (caption(cell), self.image(images, which));
        let row = |report: &RowReport| Row {
            caption: self.length(report.length),
            exposure: report.exposure,
            images: self.parts.of(report.length).map(image).collect(),
        };
        self.report.rows.iter().map(row).collect()
    }
}

/// (s, t) of a strategy; of several, their kind.
fn caption(cell: StrategyCell) -> String {
    match cell {
        StrategyCell::Strategy { s, t } => format!("({s},{t})"),
        StrategyCell::Longer(kind) => kind.name().to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::study::outcome::Interval;

    #[test]
    fn every_kind_is_left_out_once_and_no_set_comes_twice() {
        let named = |full: Strategies| -> Vec<String> {
            subsets(full).into_iter().map(|set| subset(full, set, None).without).collect()
        };
        assert_eq!(
            named(Strategies::BDPT),
            ["hit", "next-event", "join", "lens", "join,lens", "hit,next-event,join"]
        );
        assert_eq!(named(Strategies::PT), ["hit", "next-event"]);
        assert_eq!(named(Strategies::LT), [""; 0], "nothing is left of it");
        // What the path tracer leaves out of these is what is left out by one kind already.
        assert_eq!(
            named(Strategies::BDPT.without(StrategyKind::Connection)),
            ["hit", "next-event", "lens", "hit,next-event"]
        );
    }

    #[test]
    fn advice_needs_an_interval_that_lies_above_one() {
        let one = |kind: StrategyKind, mean: f64, low: f64| {
            let gain = Interval { mean, low, high: 2.0 * mean };
            subset(Strategies::BDPT, Strategies::BDPT.without(kind), Some(gain))
        };
        let doubtful = one(StrategyKind::Connection, 3.0, 0.9);
        assert!(advice(std::slice::from_ref(&doubtful)).starts_with("keep all strategies: no set"));
        assert!(advice(&[]).contains("paths would be missing"));
        let sure = [doubtful, one(StrategyKind::EmitterHit, 1.1, 1.05), one(StrategyKind::Lens, 1.3, 1.2)];
        assert_eq!(
            advice(&sure),
            "leave out lens: 1.30x [1.20, 2.60] less error x time; --strategies hit,next-event,join"
        );
    }
}
