//! `tyndall diff`: how far an image is from another.

use super::{
    console::{Answer, complain, say},
    outputs::check_short,
};
use crate::{
    analysis::{
        diff::{self, Comparison, Difference, MEASURES, MapOf, Mapped, Tolerance, View},
        picture::{self, Picture},
    },
    error::{Error, Result},
    film::{self, png::ToneCurve},
    inputs::{self, Reader},
};
use clap::{Args, ValueEnum};
use serde_json::{Value, json};
use std::path::PathBuf;

/// Compare an image with a reference.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Diff {
    /// Image to compare: OpenEXR (.exr), float map (.pfm), Radiance (.hdr, .rgbe), PNG or another supported format
    #[arg(value_name = "IMAGE")]
    pub image: PathBuf,

    /// Reference image; relative measures are relative to it
    #[arg(value_name = "REFERENCE")]
    pub reference: PathBuf,

    /// Compare this layer of both OpenEXR files, or the channel with this full name [default: the channels
    /// without a layer]
    #[arg(long, value_name = "NAME")]
    pub layer: Option<String>,

    /// Tolerance above which a pixel counts as different: the absolute difference in any channel, or relative to
    /// the reference with %
    #[arg(long, value_name = "T", default_value = "1%", value_parser = tolerance, allow_negative_numbers = true)]
    pub tolerance: Tolerance,

    /// For display units multiply both images by 2^STOPS and clip them at white [default: the tone curve of the
    /// reference's PNG]
    #[arg(long, value_name = "STOPS", value_parser = stops, allow_negative_numbers = true)]
    pub exposure: Option<f32>,

    /// Pixels per degree of the viewer's field of view, for FLIP (67: a 4K screen 0.7 m wide seen from 0.7 m)
    #[arg(long, value_name = "N", default_value_t = 67.0, value_parser = per_degree, allow_negative_numbers = true)]
    pub pixels_per_degree: f32,

    /// How the measures are given.
    #[command(flatten)]
    pub answer: Answer,

    /// Also write a false-colour image of the differences to this PNG file
    #[arg(long, value_name = "FILE", value_parser = png_file)]
    pub map: Option<PathBuf>,

    /// Value of each pixel in the image of --map, averaged over its channels
    #[arg(long, value_enum, value_name = "NAME", default_value_t = Shows::Relative, requires = "map")]
    pub map_of: Shows,

    /// Difference shown in the last colour of the map [default: the 99th percentile of the pixels; 1 for FLIP]
    #[arg(long, value_name = "VALUE", value_parser = positive, requires = "map", allow_negative_numbers = true)]
    pub map_to: Option<f32>,

    /// Exit with code 1 if a measure exceeds a value, such as relmse=0.01; may be repeated
    ///
    /// Measures: mse, rmse, relmse, trimmed_relmse, mape, smape, difference (absolute relative difference of the
    /// means), largest, beyond (percentage of pixels beyond the tolerance), each also as display.NAME, and flip
    /// (mean).
    #[arg(long, value_name = "MEASURE=VALUE", value_parser = limit, allow_negative_numbers = true)]
    pub fail_above: Vec<Limit>,
}

/// A measure and what it may be at most.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    measure: String,
    most: f64,
}

/// What a map shows of every pixel.
#[derive(Clone, Copy, Debug, Eq, PartialEq, ValueEnum)]
pub enum Shows {
    /// (x - r)^2 / (r^2 + 0.01 m^2), where m is the mean luminance of the reference
    Relative,
    /// |x - r|
    Absolute,
    /// x - r: blue where the image is darker, red where it is brighter
    Signed,
    /// FLIP
    Flip,
}

impl Shows {
    fn of(self) -> MapOf {
        match self {
            Self::Relative => MapOf::Relative,
            Self::Absolute => MapOf::Absolute,
            Self::Signed => MapOf::Signed,
            Self::Flip => MapOf::Flip,
        }
    }
}

fn number<T: std::str::FromStr>(text: &str) -> Option<T> {
    text.trim().parse().ok()
}

fn tolerance(text: &str) -> std::result::Result<Tolerance, String> {
    let known = |x: &f64| x.is_finite() && *x >= 0.0;
    let value = match text.strip_suffix('%') {
        Some(percent) => number(percent).filter(known).map(|percent| Tolerance::Relative(percent / 100.0)),
        None => number(text).filter(known).map(Tolerance::Absolute),
    };
    value.ok_or_else(|| "expected a number >= 0, with % if it is relative, such as 0.01 or 1%".into())
}

fn stops(text: &str) -> std::result::Result<f32, String> {
    let value = number(text).filter(|x: &f32| x.abs() <= 60.0);
    value.ok_or_else(|| "expected a number from -60 to 60, such as -1.5".into())
}

fn per_degree(text: &str) -> std::result::Result<f32, String> {
    let value = number(text).filter(|x| (1.0..=1000.0).contains(x));
    value.ok_or_else(|| "expected a number from 1 to 1000, such as 67".into())
}

fn positive(text: &str) -> std::result::Result<f32, String> {
    let value = number(text).filter(|x: &f32| x.is_finite() && *x > 0.0);
    value.ok_or_else(|| "expected a number above 0, such as 0.1".into())
}

fn png_file(text: &str) -> std::result::Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_png = path.extension().is_some_and(|end| end.eq_ignore_ascii_case("png"));
    if is_png { Ok(path) } else { Err("expected a file name that ends in .png".into()) }
}

fn limit(text: &str) -> std::result::Result<Limit, String> {
    let names = || format!("flip, {}, or display. before one of them", MEASURES.join(", "));
    let (measure, most) = text.split_once('=').ok_or("expected MEASURE=VALUE, such as relmse=0.01")?;
    if measure != "flip" && !MEASURES.contains(&measure.strip_prefix("display.").unwrap_or(measure)) {
        return Err(format!("\"{measure}\" is not a measure: expected {}", names()));
    }
    let most = number(most).filter(|x: &f64| x.is_finite() && *x >= 0.0);
    let most = most.ok_or("expected a finite value >= 0 after \"=\"")?;
    Ok(Limit { measure: measure.into(), most })
}

/// Runs the command; true if no measure is above its limit.
pub fn run(arguments: &Diff) -> Result<bool> {
    let files = [arguments.image.as_path(), arguments.reference.as_path()];
    files.iter().for_each(|file| inputs::note(file, Reader::Command));
    check_short([&arguments.map, &arguments.answer.report].into_iter().flatten())?;
    let image = picture::read_layer(files[0], arguments.layer.as_deref())?;
    let reference = picture::read_layer(files[1], arguments.layer.as_deref())?;
    let view = View {
        tolerance: arguments.tolerance,
        curve: arguments.exposure.map(|stops| ToneCurve::Scale(stops.exp2())),
        pixels_per_degree: arguments.pixels_per_degree,
    };
    let difference = diff::compare(&image, &reference, files, &view)?;
    let values = measured(arguments, &difference)?;
    say(&table(arguments, &image, &difference));
    if let Some(path) = &arguments.map {
        let mapped = mapped(arguments, &image, &reference, &difference)?;
        let colours = picture::false_colour(&mapped.values, mapped.range);
        film::png::write_bytes(path, image.width, image.height, &colours)?;
        say(&format!("{}: {}", path.display(), legend(arguments.map_of, &mapped)));
    }
    arguments.answer.give(&figures(arguments, &image, &difference))?;
    Ok(judge(&arguments.fail_above, &values))
}

/// The measures that have limits.
fn measured(arguments: &Diff, difference: &Difference) -> Result<Vec<f64>> {
    let value = |limit: &Limit| {
        difference.measure(&limit.measure).ok_or_else(|| unknown("--fail-above", &limit.measure))
    };
    arguments.fail_above.iter().map(value).collect()
}

/// There is no such measure of these images.
fn unknown(place: &str, measure: &str) -> Error {
    let (found, remedy) =
        ("a layer that does not contain colours", "leave it out, or compare layers of R G B");
    Error::new(place, format!("images for which {measure} is defined"), found, remedy)
}

fn judge(limits: &[Limit], values: &[f64]) -> bool {
    let mut holds = true;
    for (Limit { measure, most }, value) in limits.iter().zip(values) {
        if value > most {
            complain(&format!("{measure} is {value:.6}, above {most}"));
            holds = false;
        }
    }
    holds
}

fn mapped(arguments: &Diff, image: &Picture, reference: &Picture, difference: &Difference) -> Result<Mapped> {
    let mapped = diff::map(arguments.map_of.of(), image, reference, difference, arguments.map_to);
    mapped.ok_or_else(|| unknown("--map-of", "FLIP"))
}

fn legend(shows: Shows, mapped: &Mapped) -> String {
    let (low, high) = (short(mapped.range.0.into()), short(mapped.range.1.into()));
    match shows {
        Shows::Relative => format!("relative squared error, black {low} to yellow {high} and above"),
        Shows::Absolute => format!("absolute difference, black {low} to yellow {high} and above"),
        Shows::Signed => format!("image less reference, blue {low} over white 0 to red {high}"),
        Shows::Flip => format!("FLIP, black {low} to yellow {high}"),
    }
}

/// Four digits, in the shorter of the two ways of writing them.
fn short(x: f64) -> String {
    let size = x.abs();
    if size == 0.0 || (1e-3..1e5).contains(&size) || !size.is_finite() {
        format!("{x:.4}")
    } else {
        format!("{x:.3e}")
    }
}

fn table(arguments: &Diff, image: &Picture, difference: &Difference) -> String {
    let display = difference.display.as_ref();
    let columns: Vec<&Comparison> =
        std::iter::once(&difference.radiance).chain(display.map(|shown| &shown.comparison)).collect();
    let mut lines =
        vec![heading(arguments, image), row("", &["radiance".into(), "display".into()][..columns.len()])];
    for (title, cell) in ROWS {
        lines.push(row(title, &columns.iter().map(|column| cell(column)).collect::<Vec<_>>()));
    }
    let beyond = format!("beyond {}", describe_tolerance(arguments.tolerance));
    lines.push(row(
        &beyond,
        &columns.iter().map(|c| format!("{:.3} % of pixels", c.beyond)).collect::<Vec<_>>(),
    ));
    lines.push(describe_flip(arguments, difference));
    lines.push(match display.map(|shown| shown.curve) {
        Some(ToneCurve::White(white)) => {
            format!(
                "display: both by the reference's tone curve (white {}), sRGB-encoded, 0 to 1",
                short(white.into())
            )
        }
        Some(ToneCurve::Scale(scale)) => {
            format!("display: both times {}, cut off at 1, sRGB-encoded", short(scale.into()))
        }
        None => "display: none, the layer does not contain colours".into(),
    });
    lines.join("\n")
}

type Cell = fn(&Comparison) -> String;

/// Titles, and the cells of their rows.
const ROWS: &[(&str, Cell)] = &[
    ("MSE", |c| short(c.measures.mse)),
    ("RMSE", |c| short(c.measures.rmse)),
    ("relMSE", |c| short(c.measures.relmse)),
    ("relMSE, worst 0.1 % left out", |c| short(c.measures.trimmed_relmse)),
    ("MAPE", |c| short(c.measures.mape)),
    ("SMAPE", |c| short(c.measures.smape)),
    ("mean of the image", |c| each(&c.mean_image)),
    ("mean of the reference", |c| each(&c.mean_reference)),
    ("ratio of the two", |c| each(&c.ratio)),
    ("difference of all means, relative", |c| short(c.measures.difference)),
    ("largest difference", |c| short(c.largest.difference)),
    ("  at column, row, channel", |c| {
        format!("{}, {}, {}", c.largest.column, c.largest.row, c.largest.channel)
    }),
    ("  image, reference", |c| each(&[c.largest.image, c.largest.reference])),
];

fn each(values: &[f64]) -> String {
    values.iter().map(|x| short(*x)).collect::<Vec<_>>().join(" ")
}

fn row(title: &str, cells: &[String]) -> String {
    let cells: String = cells.iter().map(|cell| format!("  {cell:<30}")).collect();
    format!("{title:<34}{cells}").trim_end().to_owned()
}

fn heading(arguments: &Diff, image: &Picture) -> String {
    let layer = arguments.layer.as_ref().map_or(String::new(), |layer| format!(", {layer}"));
    let (a, b) = (arguments.image.display(), arguments.reference.display());
    format!("{a} against {b} (reference), {} x {} pixels{layer}", image.width, image.height)
}

fn describe_tolerance(tolerance: Tolerance) -> String {
    match tolerance {
        Tolerance::Absolute(most) => format!("{most}"),
        Tolerance::Relative(most) => format!("{} % of the reference", 100.0 * most),
    }
}

fn describe_flip(arguments: &Diff, difference: &Difference) -> String {
    let per_degree = arguments.pixels_per_degree;
    match difference.measure("flip") {
        Some(mean) => row("FLIP, mean", &[String::new(), format!("{mean:.4} ({per_degree} pixels/degree)")]),
        None => "FLIP: none, the layer does not contain colours".into(),
    }
}

fn figures(arguments: &Diff, image: &Picture, difference: &Difference) -> Value {
    let shown = difference.display.as_ref();
    json!({
        "image": arguments.image,
        "reference": arguments.reference,
        "layer": arguments.layer,
        "width": image.width,
        "height": image.height,
        "channels": difference.channels,
        "tolerance": describe_tolerance(arguments.tolerance),
        "radiance": difference.radiance,
        "display": shown.map(|shown| &shown.comparison),
        "curve": shown.map(|shown| match shown.curve {
            ToneCurve::White(white) => json!({ "white": white }),
            ToneCurve::Scale(scale) => json!({ "scale": scale }),
        }),
        "flip": shown.map(diff::Shown::mean_flip),
        "pixels_per_degree": arguments.pixels_per_degree,
    })
}
