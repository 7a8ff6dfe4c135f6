//! A phase function as a polar plot: its density as a line, the histogram of its samples under it, by linear and by
//! logarithmic radius.

use super::{Check, quadrature};
use crate::{
    error::{Error, Result},
    phase::Phase,
};
use plotters::{
    coord::Shift,
    prelude::{
        Circle, Color, DrawingArea, IntoDrawingArea, IntoFont, PathElement, Polygon, RGBColor, SVGBackend,
        Text, WHITE,
    },
};
use std::f64::consts::{PI, TAU};

/// Sides of each of the two plots (pixels).
const SIDE: i32 = 520;

/// What a logarithmic radius shows at most (decades).
const DECADES: f64 = 4.0;

const DENSITY: RGBColor = RGBColor(20, 60, 160);
const SAMPLES: RGBColor = RGBColor(240, 160, 60);
const GRID: RGBColor = RGBColor(190, 190, 190);
const INK: RGBColor = RGBColor(60, 60, 60);

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// How far from the centre a density is drawn.
#[derive(Clone, Copy)]
enum Radius {
    Linear { most: f64 },
    Logarithmic { least: f64, most: f64 },
}

impl Radius {
    /// In [0, 1].
    fn of(self, pdf: f64) -> f64 {
        match self {
            Self::Linear { most } => (pdf / most).clamp(0.0, 1.0),
            Self::Logarithmic { least, .. } if pdf <= least => 0.0,
            Self::Logarithmic { least, most } => ((pdf / least).ln() / (most / least).ln()).clamp(0.0, 1.0),
        }
    }

    /// Densities of the circles of the grid.
    fn circles(self) -> Vec<f64> {
        match self {
            Self::Linear { most } => (1..=4).map(|i| most * f64::from(i) / 4.0).collect(),
            Self::Logarithmic { least, most } => {
                let decades = least.log10().ceil() as i32..=most.log10().floor() as i32;
                decades.map(|decade| 10f64.powi(decade)).collect()
            }
        }
    }

    fn title(self) -> &'static str {
        match self {
            Self::Linear { .. } => "linear radius",
            Self::Logarithmic { .. } => "logarithmic radius",
        }
    }
}

/// The plot as the text of an SVG file.
pub fn svg(title: &str, phase: &Phase, check: &Check) -> Result<String> {
    let mut text = String::new();
    draw(&mut text, title, phase, check).map_err(|error| {
        Error::new(
            "the polar plot",
            "a drawing",
            error,
            "report this with the parameters of the phase function",
        )
    })?;
    Ok(text)
}

fn draw(text: &mut String, title: &str, phase: &Phase, check: &Check) -> std::result::Result<(), String> {
    let line = pdf_line(phase);
    let bars = histogram(check);
    let all = || line.iter().chain(&bars).map(|(_, pdf)| *pdf).filter(|pdf| *pdf > 0.0);
    let most = all().fold(f64::MIN_POSITIVE, f64::max);
    let lowest = all().fold(most, f64::min);
    // At least one decade, so that an isotropic function is a circle and not a point.
    let least = lowest.clamp(most / 10f64.powf(DECADES), most / 10.0);
    let root = SVGBackend::with_string(text, (2 * SIDE as u32, SIDE as u32 + 40)).into_drawing_area();
    root.fill(&WHITE).map_err(drawing_error)?;
    write(&root, title, (12, 10), 18)?;
    let legend = format!(
        "line: pdf [1/sr]; bars: {} samples; light comes from the left",
        check.histogram.iter().sum::<u64>()
    );
    write(&root, &legend, (12, 32), 13)?;
    for (i, radius) in [Radius::Linear { most }, Radius::Logarithmic { least, most }].into_iter().enumerate()
    {
        polar(&root, (SIDE / 2 + SIDE * i as i32, SIDE / 2 + 40), radius, &line, &bars)?;
    }
    root.present().map_err(drawing_error)
}

/// Angles and densities, finer where peaks may be.
fn pdf_line(phase: &Phase) -> Vec<(f64, f64)> {
    let points = 721;
    let even = (0..points).map(|i| f64::from(i) / f64::from(points - 1));
    // Evenly by angle as well: the stretched places are sparse at right angles.
    let by_angle = even.clone().map(|t| {
        let (half, back) = if t < 0.5 { (t, false) } else { (1.0 - t, true) };
        let place = 0.5 * (2.0 * (0.5 * PI * half).sin().powi(2)).powf(0.25);
        if back { 1.0 - place } else { place }
    });
    let mut places: Vec<f64> = even.chain(by_angle).collect();
    places.sort_by(f64::total_cmp);
    places.iter().map(|t| (quadrature::angle_at(*t), quadrature::pdf_at(phase, *t))).collect()
}

/// Where each bar begins (rad), and its height (1/sr).
fn histogram(check: &Check) -> Vec<(f64, f64)> {
    let width = PI / check.histogram.len() as f64;
    let samples: u64 = check.histogram.iter().sum();
    let bar = |(i, count): (usize, &u64)| {
        let start = i as f64 * width;
        let solid_angle = TAU * 2.0 * (start + 0.5 * width).sin() * (0.5 * width).sin();
        (start, *count as f64 / samples as f64 / solid_angle)
    };
    check.histogram.iter().enumerate().map(bar).collect()
}

fn polar(
    root: &Area<'_>,
    centre: (i32, i32),
    radius: Radius,
    line: &[(f64, f64)],
    bars: &[(f64, f64)],
) -> std::result::Result<(), String> {
    let full = f64::from(SIDE) * 0.44;
    let at = |angle: f64, r: f64| {
        (
            centre.0 + (full * r * angle.cos()).round() as i32,
            centre.1 - (full * r * angle.sin()).round() as i32,
        )
    };
    for (start, pdf) in bars {
        let (r, end) = (radius.of(*pdf), start + PI / bars.len() as f64);
        for side in [1.0, -1.0] {
            let wedge = vec![at(0.0, 0.0), at(side * start, r), at(side * end, r)];
            root.draw(&Polygon::new(wedge, SAMPLES.mix(0.7))).map_err(drawing_error)?;
        }
    }
    for pdf in radius.circles() {
        let r = radius.of(pdf);
        root.draw(&Circle::new(centre, (full * r) as i32, GRID)).map_err(drawing_error)?;
        write(root, &format!("{pdf:.2e}"), at(0.5 * PI, r), 11)?;
    }
    for angle in 0..12 {
        let angle = f64::from(angle) * PI / 6.0;
        root.draw(&PathElement::new(vec![centre, at(angle, 1.0)], GRID)).map_err(drawing_error)?;
    }
    for side in [1.0, -1.0] {
        let points: Vec<_> = line.iter().map(|(angle, pdf)| at(side * angle, radius.of(*pdf))).collect();
        root.draw(&PathElement::new(points, DENSITY.stroke_width(2))).map_err(drawing_error)?;
    }
    write(root, radius.title(), (centre.0 - SIDE / 2 + 12, centre.1 + SIDE / 2 - 24), 13)
}

fn write(root: &Area<'_>, text: &str, at: (i32, i32), size: u32) -> std::result::Result<(), String> {
    root.draw(&Text::new(text.to_owned(), at, ("sans-serif", size).into_font().color(&INK)))
        .map_err(drawing_error)
}

fn drawing_error(error: impl std::fmt::Display) -> String {
    error.to_string()
}
