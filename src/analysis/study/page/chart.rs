//! Error curves on logarithmic scales, as the inside of an SVG element. Colours, strokes and sizes of text are the
//! page's: everything is in groups with classes.

use super::{
    axis::Span,
    measure::{Axis, Measure},
};
use crate::{
    analysis::study::outcome::{ContenderOutcome, Interval, Point, SceneOutcome},
    error::{Error, Result},
};
use plotters::{
    coord::combinators::{LogCoord, WithKeyPoints},
    prelude::*,
};

/// Width of the drawing (units of its own).
pub(super) const WIDTH: u32 = 1600;
/// Height of the drawing.
pub(super) const HEIGHT: u32 = 1000;
/// Room for the numbers at the left and at the bottom.
const LABELS: [u32; 2] = [130, 64];
/// Room at the other sides.
const MARGIN: u32 = 24;
/// Half the size of a mark.
const MARK: i32 = 13;

type Coordinate = WithKeyPoints<LogCoord<f64>>;
type Plane<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<Coordinate, Coordinate>>;
type Drawn = std::result::Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// Curves with their intervals.
pub(super) struct Chart {
    /// Of each series, x and y of its points.
    curves: Vec<Vec<(f64, Interval)>>,
    /// Of the guiding lines.
    slope: Option<f64>,
    /// What no curve can be seen to fall below.
    floor: Option<f64>,
    across: Span,
    up: Span,
}

impl Chart {
    /// Error over an axis, of all contenders of a scene; the reference's own error is the floor.
    pub(super) fn new(scene: &SceneOutcome, measure: &Measure, axis: &Axis) -> Self {
        let point = |point: &Point| Some(((axis.of)(point)?, (measure.of)(point)));
        let curve = |contender: &ContenderOutcome| match axis.is_known(contender) {
            true => contender.points.iter().filter_map(point).collect(),
            false => Vec::new(),
        };
        let curves = scene.contenders.iter().map(curve).collect();
        let own = scene.reference.own_relmse.filter(|own| *own > 0.0 && measure.key == "relmse");
        Self::of(curves, Some(measure.slope), own)
    }

    /// With scales that hold all of `curves`.
    pub(super) fn of(curves: Vec<Vec<(f64, Interval)>>, slope: Option<f64>, floor: Option<f64>) -> Self {
        let points = || curves.iter().flatten();
        let across = Span::around(points().map(|(x, _)| *x));
        let means: Vec<f64> = points().map(|(_, interval)| interval.mean).collect();
        // The ends of wide intervals must not squeeze the curves.
        let core = Span::around(means.iter().copied());
        let ends = points().flat_map(|(_, interval)| [interval.low, interval.high]);
        let ends = ends.filter(|end| core.is_near(*end));
        let near = floor.filter(|floor| core.is_near(*floor));
        let up = Span::around(means.iter().copied().chain(ends).chain(near));
        Self { curves, slope, floor, across, up }
    }

    /// The inside of the SVG element.
    pub(super) fn svg(&self) -> Result<String> {
        let mut parts = vec![group("mesh", &self.layer(|plane| self.draw_mesh(plane))?)];
        parts.push(group("guide", &self.layer(|plane| self.draw_guide(plane))?));
        if let Some(floor) = self.floor {
            parts.push(group("floor", &self.layer(|plane| self.draw_level(plane, floor))?));
        }
        let all = 0..self.curves.len();
        // Below every line, so that one contender's interval does not hide another's curve.
        for series in all.clone() {
            parts.push(of_series("band", series, &self.layer(|plane| self.draw_band(plane, series))?));
        }
        for series in all {
            let line = group("line", &self.layer(|plane| self.draw_line(plane, series))?);
            let marks = group("marks", &self.layer(|plane| self.draw_marks(plane, series))?);
            parts.push(of_series("series", series, &(line + &marks)));
        }
        Ok(parts.concat())
    }

    /// What `draw` draws, without the element around it.
    fn layer(&self, draw: impl FnOnce(&mut Plane<'_>) -> Drawn) -> Result<String> {
        let mut text = String::new();
        let drawn = {
            let area = SVGBackend::with_string(&mut text, (WIDTH, HEIGHT)).into_drawing_area();
            ChartBuilder::on(&area)
                .margin(MARGIN)
                .margin_bottom(0)
                .set_label_area_size(LabelAreaPosition::Left, LABELS[0])
                .set_label_area_size(LabelAreaPosition::Bottom, LABELS[1])
                .build_cartesian_2d(self.across.coordinate(), self.up.coordinate())
                .and_then(|mut plane| draw(&mut plane))
                .and_then(|()| area.present())
        };
        drawn.map_err(|error| {
            Error::new("study.html", "curves that can be drawn", error.to_string(), "report this study.json")
        })?;
        let inside = text.split_once('>').and_then(|(_, rest)| rest.rsplit_once("</svg>"));
        Ok(inside.map_or(String::new(), |(inside, _)| inside.replace('\n', "")))
    }

    fn draw_mesh(&self, plane: &mut Plane<'_>) -> Drawn {
        plane
            .configure_mesh()
            .bold_line_style(BLACK)
            .axis_style(BLACK)
            .label_style(("sans-serif", 32))
            .x_label_formatter(&|value| self.across.label(*value))
            .y_label_formatter(&|value| self.up.label(*value))
            .draw()
    }

    /// Lines of equal efficiency: an unbiased contender stays on its own, and each is ten times as good as the next.
    fn draw_guide(&self, plane: &mut Plane<'_>) -> Drawn {
        for line in self.slope.iter().flat_map(|slope| self.across.parallels(&self.up, *slope)) {
            plane.draw_series(LineSeries::new(line, BLACK))?;
        }
        Ok(())
    }

    fn draw_level(&self, plane: &mut Plane<'_>, level: f64) -> Drawn {
        let y = self.up.clamped(level);
        let line = [(self.across.low, y), (self.across.high, y)];
        plane.draw_series(LineSeries::new(line, BLACK)).map(drop)
    }

    fn draw_band(&self, plane: &mut Plane<'_>, series: usize) -> Drawn {
        let points = &self.curves[series];
        let place = |x: f64, y: f64| (self.across.clamped(x), self.up.clamped(y));
        let lower = points.iter().map(|(x, interval)| place(*x, interval.low));
        let upper = points.iter().rev().map(|(x, interval)| place(*x, interval.high));
        let outline: Vec<(f64, f64)> = lower.chain(upper).collect();
        if outline.is_empty() {
            return Ok(());
        }
        // One budget has no area: its interval is a bar.
        if let [a, b] = outline[..] {
            return plane.draw_series(LineSeries::new([a, b], BLACK)).map(drop);
        }
        plane.draw_series([Polygon::new(outline, BLACK.filled())]).map(drop)
    }

    fn curve(&self, series: usize) -> Vec<(f64, f64)> {
        let place = |(x, y): &(f64, Interval)| (self.across.clamped(*x), self.up.clamped(y.mean));
        self.curves[series].iter().map(place).collect()
    }

    fn draw_line(&self, plane: &mut Plane<'_>, series: usize) -> Drawn {
        plane.draw_series(LineSeries::new(self.curve(series), BLACK)).map(drop)
    }

    fn draw_marks(&self, plane: &mut Plane<'_>, series: usize) -> Drawn {
        let curve = self.curve(series);
        match outline(series) {
            None => {
                plane.draw_series(curve.into_iter().map(|at| Circle::new(at, MARK, BLACK.filled()))).map(drop)
            }
            Some(corners) => {
                let mark = |at| EmptyElement::at(at) + Polygon::new(corners.clone(), BLACK.filled());
                plane.draw_series(curve.into_iter().map(mark)).map(drop)
            }
        }
    }
}

fn group(class: &str, inside: &str) -> String {
    format!("<g class=\"{class}\">{inside}</g>")
}

/// In a contender's colour, to be hidden with it.
fn of_series(class: &str, series: usize, inside: &str) -> String {
    format!("<g class=\"{class} hue{}\" data-series=\"{series}\">{inside}</g>", hue(series))
}

/// Which of the page's colours a contender has.
pub(super) fn hue(series: usize) -> usize {
    series % HUES
}

/// How many colours the page has.
const HUES: usize = 7;

/// The corners of a contender's mark around its middle; none for a disc. With the colours of [`hue`], which repeat
/// earlier than marks do, they distinguish 35 contenders, and the first five in black and white too.
pub(super) fn outline(series: usize) -> Option<Vec<(i32, i32)>> {
    let r = MARK;
    match series % 5 {
        0 => None,
        1 => Some(vec![(-r, -r), (r, -r), (r, r), (-r, r)]),
        2 => Some(vec![(0, -r - 4), (r + 3, r), (-r - 3, r)]),
        3 => Some(vec![(0, -r - 6), (r + 6, 0), (0, r + 6), (-r - 6, 0)]),
        _ => Some(vec![(0, r + 4), (r + 3, -r), (-r - 3, -r)]),
    }
}
