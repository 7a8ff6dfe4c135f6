//! P03T fig. A.12: the mean flight by constant steps against its law, and the error of that over the mean free path.

use super::law::{self, Law};
use crate::error::{Error, Result};
use plotters::{
    chart::ChartContext,
    coord::{
        Shift,
        cartesian::Cartesian2d,
        ranged1d::{Ranged, ValueFormatter},
    },
    prelude::{
        ChartBuilder, Circle, Color, DrawingArea, ErrorBar, IntoDrawingArea, IntoLogRange, LineSeries,
        PathElement, RGBColor, SVGBackend, SeriesLabelPosition, WHITE,
    },
};

const SIZE: (u32, u32) = (1100, 520);
const POINTS: i32 = 200;
const LAW: RGBColor = RGBColor(20, 60, 160);
const MEASURED: RGBColor = RGBColor(200, 60, 30);
const FREE_PATH: RGBColor = RGBColor(120, 120, 120);
const COLOURS: [RGBColor; 6] = [
    RGBColor(20, 60, 160),
    RGBColor(200, 60, 30),
    RGBColor(30, 130, 60),
    RGBColor(130, 60, 150),
    RGBColor(180, 130, 20),
    RGBColor(40, 150, 170),
];

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Drawn = std::result::Result<(), String>;

/// The plot as the text of an SVG file; `laws` are not empty and of one `sigma_s` (1/m).
pub fn svg(laws: &[Law], sigma_s: f64) -> Result<String> {
    let mut text = String::new();
    draw(&mut text, laws, sigma_s).map_err(|error| {
        Error::new(
            "the plot of mean flights",
            "a drawing",
            error,
            "report this with the command that was run",
        )
    })?;
    Ok(text)
}

fn draw(text: &mut String, laws: &[Law], sigma_s: f64) -> Drawn {
    let root = SVGBackend::with_string(text, SIZE).into_drawing_area();
    root.fill(&WHITE).map_err(drawing_error)?;
    let halves = root.split_evenly((1, 2));
    lengths(&halves[0], laws, sigma_s)?;
    errors(&halves[1], laws, sigma_s)?;
    root.present().map_err(drawing_error)
}

/// From half of the least to twice the largest.
fn around(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, 0.0f64), |(low, high), x| (low.min(x), high.max(x)));
    (0.5 * low, 2.0 * high)
}

/// Evenly spaced by their logarithms.
fn between((low, high): (f64, f64)) -> impl Iterator<Item = f64> {
    (0..=POINTS).map(move |i| low * (high / low).powf(f64::from(i) / f64::from(POINTS)))
}

/// The mean length over the length of steps.
fn lengths(area: &Area<'_>, laws: &[Law], sigma_s: f64) -> Drawn {
    let steps = around(laws.iter().map(|law| law.step));
    let ends = [steps.0, steps.1].map(|step| law::mean_length(step, sigma_s));
    let heights = around(ends.into_iter().chain(laws.iter().map(|law| law.measured.mean)));
    let mut chart = ChartBuilder::on(area)
        .caption("mean flight by constant steps", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d((steps.0..steps.1).log_scale(), (heights.0..heights.1).log_scale())
        .map_err(drawing_error)?;
    mesh(&mut chart, ["step [m]", "mean flight [m]"])?;
    let curve = between(steps).map(|step| (step, law::mean_length(step, sigma_s)));
    let drawn = chart.draw_series(LineSeries::new(curve, LAW.stroke_width(2))).map_err(drawing_error)?;
    drawn.label("step / (1 - exp(-sigma_s step))").legend(|at| key(at, LAW));
    let free = [steps.0, steps.1].map(|step| (step, 1.0 / sigma_s));
    let drawn = chart.draw_series(LineSeries::new(free, FREE_PATH.stroke_width(1))).map_err(drawing_error)?;
    drawn.label("1 / sigma_s").legend(|at| key(at, FREE_PATH));
    let bar = |law: &Law| {
        let (mean, error) = (law.measured.mean, 2.0 * law.measured.standard_error);
        // An error as large as the mean has no lower end on this scale.
        let low = (mean - error).max(0.01 * mean);
        ErrorBar::new_vertical(law.step, low, mean, mean + error, MEASURED.filled(), 8)
    };
    let drawn = chart.draw_series(laws.iter().map(bar)).map_err(drawing_error)?;
    drawn.label("measured, with 2 standard errors").legend(|at| key(at, MEASURED));
    labels(&mut chart)
}

/// The error over the mean free path, a curve for each length of steps; points where this medium is.
fn errors(area: &Area<'_>, laws: &[Law], sigma_s: f64) -> Drawn {
    let here = 1.0 / sigma_s;
    let paths = around(laws.iter().map(|law| law.step).chain([here]));
    let ends = |law: &Law| [paths.0, paths.1].map(|path| law::error(law.step, 1.0 / path));
    let heights = around(laws.iter().flat_map(ends).filter(|error| *error > 0.0));
    // Longer steps err most, and the smallest errors are of no interest beyond six decades.
    let heights = (heights.0.max(1e-6 * heights.1), heights.1);
    let mut chart = ChartBuilder::on(area)
        .caption("error of the mean flight", ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(42)
        .y_label_area_size(64)
        .build_cartesian_2d((paths.0..paths.1).log_scale(), (heights.0..heights.1).log_scale())
        .map_err(drawing_error)?;
    mesh(&mut chart, ["mean free path for scattering [m]", "error [m]"])?;
    for (law, colour) in laws.iter().zip(COLOURS.into_iter().cycle()) {
        let curve = between(paths).map(|path| (path, law::error(law.step, 1.0 / path)));
        let drawn =
            chart.draw_series(LineSeries::new(curve, colour.stroke_width(2))).map_err(drawing_error)?;
        drawn.label(format!("step {} m", round(law.step))).legend(move |at| key(at, colour));
        let measured = law.measured.mean - here;
        if measured > 0.0 {
            chart.draw_series([Circle::new((here, measured), 4, colour.filled())]).map_err(drawing_error)?;
        }
    }
    labels(&mut chart)
}

/// Lines at round numbers, which the axes of logarithms name in all their digits if they are let.
fn mesh<'a, 'b: 'a, X, Y>(
    chart: &mut ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>,
    [x, y]: [&str; 2],
) -> Drawn
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let mut mesh = chart.configure_mesh();
    mesh.x_desc(x).y_desc(y).x_labels(5).y_labels(8).max_light_lines(1);
    mesh.x_label_formatter(&|x| round(*x)).y_label_formatter(&|y| round(*y)).draw().map_err(drawing_error)
}

/// Three digits, without those that say nothing.
fn round(x: f64) -> String {
    format!("{x:.2e}").parse().map_or_else(|_| x.to_string(), |rounded: f64| rounded.to_string())
}

fn key((x, y): (i32, i32), colour: RGBColor) -> PathElement<(i32, i32)> {
    PathElement::new([(x, y), (x + 16, y)], colour.stroke_width(2))
}

fn labels<'a, 'b: 'a, X, Y>(chart: &mut ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>) -> Drawn
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let place = SeriesLabelPosition::UpperLeft;
    chart
        .configure_series_labels()
        .position(place)
        .background_style(WHITE.mix(0.8))
        .draw()
        .map_err(drawing_error)
}

fn drawing_error(error: impl std::fmt::Display) -> String {
    error.to_string()
}
