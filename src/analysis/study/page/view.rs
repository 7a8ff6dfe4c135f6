//! What the page's template is filled with: texts, numbers as texts, and images, all of them ready to be shown.

use super::{
    bias::BiasView,
    chart::{self, Chart},
    data, figures,
    measure::{AXES, Axis, MEASURES, Measure},
    strips::Strips,
    tone,
};
use crate::{
    analysis::study::{
        outcome::{Chosen, Conditions, ContenderOutcome, Interval, Outcome, Point, SceneOutcome},
        trust,
    },
    error::{Error, Result},
};
use askama::Template;
use std::path::Path;

/// The page.
#[derive(Template)]
#[template(path = "page.html", config = "src/analysis/study/page/askama.toml")]
pub(super) struct Page<'a> {
    outcome: &'a Outcome,
    pub(super) scenes: Vec<SceneView<'a>>,
    contenders: Vec<&'a str>,
    measures: &'static [Measure],
    pub(super) tones: String,
    data: String,
}

impl<'a> Page<'a> {
    /// Of the study in `folder`.
    pub(super) fn new(folder: &Path, outcome: &'a Outcome) -> Result<Self> {
        let scenes = outcome.scenes.iter().enumerate();
        Ok(Self {
            outcome,
            scenes: scenes.map(|(index, _)| SceneView::new(folder, outcome, index)).collect::<Result<_>>()?,
            contenders: names(outcome),
            measures: &MEASURES,
            tones: tone::table(),
            data: data::json(outcome)?,
        })
    }

    /// The whole file.
    pub(super) fn html(&self) -> Result<String> {
        self.render().map_err(|error| {
            Error::new(
                "study.html",
                "a study that a page can show",
                error.to_string(),
                "report this study.json",
            )
        })
    }

    fn style(&self) -> &'static str {
        concat!(include_str!("curves.css"), include_str!("style.css"))
    }

    fn script(&self) -> &'static str {
        concat!(
            include_str!("script/parts.js"),
            include_str!("script/curves.js"),
            include_str!("script/images.js"),
            include_str!("script/compare.js"),
            include_str!("script/start.js")
        )
    }

    fn confidence(&self) -> String {
        let percent = (1000.0 * self.outcome.confidence).round() / 10.0;
        format!("{percent} %")
    }

    /// When it was made, and what else the machine did.
    fn conditions(&self) -> Option<String> {
        self.outcome.conditions.as_ref().map(Conditions::sentence)
    }

    fn hue(&self, series: &usize) -> usize {
        chart::hue(*series)
    }

    /// How much there is to see.
    fn counted(&self) -> String {
        let some = |count: usize, one: &str, many: &str| match count {
            1 => format!("One {one}"),
            _ => format!("{count} {many}"),
        };
        let (scenes, contenders) = (self.scenes.len(), self.contenders.len());
        format!(
            "{}, {}.",
            some(scenes, "scene", "scenes"),
            some(contenders, "contender", "contenders").to_lowercase()
        )
    }

    /// The efficiency of `name` in a scene over that of the scene's first contender.
    fn lead(&self, scene: &SceneOutcome, name: &&str) -> Option<Share> {
        let contender = scene.contenders.iter().find(|contender| contender.name == **name)?;
        Some(Share::of(scene, contender))
    }
}

/// Of all contenders of all scenes, in order of appearance.
fn names(outcome: &Outcome) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for contender in outcome.scenes.iter().flat_map(|scene| &scene.contenders) {
        if !names.contains(&contender.name.as_str()) {
            names.push(&contender.name);
        }
    }
    names
}

/// How much better than the first.
struct Share {
    ratio: Option<Interval>,
    best: bool,
}

impl Share {
    fn of(scene: &SceneOutcome, contender: &ContenderOutcome) -> Self {
        let efficiency = |contender: &ContenderOutcome| contender.efficiency.mean;
        let best = scene.contenders.iter().map(efficiency).fold(f64::MIN, f64::max);
        Self { ratio: contender.ratio, best: efficiency(contender) >= best }
    }

    fn text(&self) -> String {
        match self.ratio {
            None => "1".into(),
            Some(ratio) if ratio.mean.is_nan() => "–".into(),
            Some(ratio) => format!("{}×", figures::number(ratio.mean)),
        }
    }

    fn ends(&self) -> Option<String> {
        self.ratio.filter(|ratio| !ratio.mean.is_nan()).map(figures::ends)
    }
}

/// A scene.
pub(super) struct SceneView<'a> {
    index: usize,
    pub(super) scene: &'a SceneOutcome,
    pub(super) rows: Vec<Row<'a>>,
    pub(super) charts: Vec<ChartView>,
    axes: Vec<&'static Axis>,
    biases: Vec<BiasView>,
    pub(super) strips: Strips,
    trust: Vec<String>,
    notes: Vec<Notes<'a>>,
}

impl<'a> SceneView<'a> {
    fn new(folder: &Path, outcome: &'a Outcome, index: usize) -> Result<Self> {
        let scene = &outcome.scenes[index];
        let contenders = scene.contenders.iter().enumerate();
        Ok(Self {
            index,
            scene,
            rows: contenders.map(|(series, contender)| Row::new(scene, series, contender)).collect(),
            charts: charts(scene)?,
            axes: Axis::all_of(scene),
            biases: BiasView::all(scene)?,
            strips: Strips::new(folder, outcome, scene)?,
            trust: trust::sentences(scene, figures::number),
            notes: notes(scene),
        })
    }
}

impl SceneView<'_> {
    fn has_own(&self) -> bool {
        self.scene.reference.own_relmse.is_some()
    }

    /// Processor times are known.
    fn has_cpu(&self) -> bool {
        self.scene.contenders.iter().flat_map(|contender| &contender.points).any(|p| p.cpu_seconds.is_some())
    }
}

/// What a reader must know of a contender to trust its curves.
struct Notes<'a> {
    series: usize,
    name: &'a str,
    chosen: Option<String>,
    notes: &'a [String],
}

/// Of every contender of which there is something to say.
fn notes<'a>(scene: &'a SceneOutcome) -> Vec<Notes<'a>> {
    let of = |(series, contender): (usize, &'a ContenderOutcome)| {
        let ContenderOutcome { name, chosen, notes, .. } = contender;
        Notes { series, name, chosen: chosen.as_ref().map(Chosen::sentence), notes }
    };
    let all = scene.contenders.iter().enumerate().map(of);
    all.filter(|of| of.chosen.is_some() || !of.notes.is_empty()).collect()
}

/// Curves by one measure over one axis.
pub(super) struct ChartView {
    measure: &'static Measure,
    axis: &'static Axis,
    pub(super) svg: String,
}

fn charts(scene: &SceneOutcome) -> Result<Vec<ChartView>> {
    let axes = Axis::all_of(scene);
    let kinds = MEASURES.iter().flat_map(|measure| axes.iter().map(move |axis| (measure, *axis)));
    let drawn =
        |(measure, axis)| Ok(ChartView { measure, axis, svg: Chart::new(scene, measure, axis).svg()? });
    kinds.map(drawn).collect()
}

impl ChartView {
    fn view_box(&self) -> String {
        format!("0 0 {} {}", chart::WIDTH, chart::HEIGHT)
    }

    /// True for the one to begin with.
    fn is_first(&self) -> bool {
        self.measure.key == MEASURES[0].key && self.axis.key == AXES[0].key
    }
}

/// A contender's row of the table.
pub(super) struct Row<'a> {
    series: usize,
    pub(super) contender: &'a ContenderOutcome,
    last: &'a Point,
    share: Share,
}

impl<'a> Row<'a> {
    fn new(scene: &SceneOutcome, series: usize, contender: &'a ContenderOutcome) -> Self {
        let last = &contender.points[contender.points.len() - 1];
        Self { series, contender, last, share: Share::of(scene, contender) }
    }

    pub(super) fn hue(&self) -> usize {
        chart::hue(self.series)
    }

    fn relmse(&self) -> String {
        figures::number(self.last.relmse.mean)
    }

    fn samples(&self, point: &Point) -> String {
        figures::count(point.samples)
    }

    /// Processor time.
    fn cpu(&self, point: &Point) -> Cell {
        let none = Cell { mean: "–".into(), ends: String::new() };
        point.cpu_seconds.as_ref().map_or(none, cell)
    }

    fn load(&self) -> String {
        self.contender.load_seconds.map_or("–".into(), figures::number)
    }

    fn measured(&self, measure: &Measure, point: &Point) -> Cell {
        cell(&(measure.of)(point))
    }

    /// The mark of the curve, as the inside of an SVG element around (0, 0).
    pub(super) fn mark(&self) -> String {
        match chart::outline(self.series) {
            None => "<circle r=\"13\"/>".into(),
            Some(corners) => {
                let corners: Vec<String> = corners.iter().map(|(x, y)| format!("{x},{y}")).collect();
                format!("<polygon points=\"{}\"/>", corners.join(" "))
            }
        }
    }
}

/// A number and its interval, for a cell of a table.
struct Cell {
    mean: String,
    ends: String,
}

fn cell(interval: &Interval) -> Cell {
    Cell { mean: figures::number(interval.mean), ends: figures::ends(*interval) }
}

/// The same in percent.
fn percent(interval: &Interval) -> Cell {
    let Interval { mean, low, high } = *interval;
    cell(&Interval { mean: 100.0 * mean, low: 100.0 * low, high: 100.0 * high })
}
