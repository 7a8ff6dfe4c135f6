//! The arguments of the command line.

use super::{
    display::Display,
    estimator::Estimator,
    preview::Preview,
    progressive::Progressive,
    study::Study,
    viewer,
    voice::{Answer, ProgressForm},
};
use crate::{
    description::Object,
    error::Error,
    film::accumulator::MOST_PASSES,
    format,
    scene::sensors,
    settings::{Crop, Overrides},
};
use clap::{
    Args, Parser, Subcommand,
    builder::{PathBufValueParser, PossibleValuesParser, TypedValueParser},
};
use std::{num::NonZeroUsize, path::PathBuf, time::Duration};

/// A bidirectional path tracer for fog, smoke and fire.
#[derive(Clone, Debug, Parser, PartialEq)]
#[command(version, about, propagate_version = true, after_help = EXIT_CODES)]
pub struct Arguments {
    /// Print no progress, plan, summary or table; warnings, errors and what is asked for as data (--json, --progress json)
    /// remain
    #[arg(short, long, global = true)]
    pub quiet: bool,

    /// Form of the progress on standard error: a bar on a terminal, or lines of JSON for other programs, also with --quiet
    ///
    /// json: a line for each update, ten a second at most and one at the end, such as
    /// {"done": 0.25, "samples_per_pixel": 16, "noise": 0.031, "within": null, "seconds": 2.1, "image": null}: the part of the way to
    /// the nearest limit (0 to 1), the relative error of the image so far (root of relMSE), or null where it is not known yet, the share of
    /// the pixels within --error, the time since the render began, and which frame or batch it is. study says what it is
    /// doing ("doing") in place of samples and noise; strategies has "done" alone. With --quiet, other lines are warnings and errors.
    /// A render whose standard error is closed meanwhile ends as on Ctrl-C.
    #[arg(long, global = true, value_enum, value_name = "FORM", default_value_t = ProgressForm::Bar)]
    pub progress: ProgressForm,

    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// The codes that the program ends with, for scripts.
const EXIT_CODES: &str = "\
Exit codes:
  0    success
  1    done, and what was tested does not hold (diff --fail-above, phase, flights)
  2    a mistake in the arguments or files, or a fault of the machine such as a full disk (a closed pipe is none)
  129  ended by SIGHUP
  130  ended by Ctrl-C (SIGINT)
  143  ended by SIGTERM";

/// What to do.
#[derive(Clone, Debug, PartialEq, Subcommand)]
pub enum Command {
    /// Render a scene to an image
    Render(Render),
    /// Show what each strategy of bidirectional path tracing contributes to a scene
    ///
    /// Writes to a folder the image of each strategy, weighted and unweighted, as EXR layers and as pyramids on
    /// contact sheets (Veach 1997, fig. 10.2 and 10.3), and a table of the shares of energy, variance and time as
    /// JSON and CSV. Short renders with different sets of strategies then show which kinds of strategies the
    /// scene does not need.
    Strategies(super::strategies::Arguments),
    /// Show what a guide learns of a scene: what render --guide follows
    ///
    /// Writes to a folder guide.json, with the number of cells, their memory and the time that learning took, how often light
    /// subpaths start at each emitter, and the cells that most pixels see; cells.png: the cells as the camera sees them, and the
    /// part of the directions of both kinds of walks that is guided there; directions.png: where walks go from the cells
    /// that most pixels see (azimuth to the right, +z downwards; equal areas are equal solid angles; yellow is a
    /// thousand times as likely as evenly spread directions, black a hundredth).
    Guide(super::guide::Arguments),
    /// Write the paths of one pixel's samples as JSON, for debugging
    ///
    /// The samples are those of a render with the same seed, size and options: the same camera subpaths and the
    /// same light vertices. Every vertex is listed with its pdfs and every contribution with its weight; the
    /// contributions sum to the value of the pixel.
    Pixel(super::pixel::Arguments),
    /// Put together parts of one image, rendered with --samples or --crop, and write the image
    ///
    /// The parts are files of sums of the same scene, options and seed. Those with other samples of the same pixels
    /// (--samples) are added up: the image is the same, bit for bit, as that of one render of all of these samples with
    /// --samples. It is also that of one render with --spp, if they are 2.1 million or more, all pixels together: the pilot of
    /// fewer is shorter. Those
    /// with other pixels (--crop) are put side by side; they must cover the image and not overlap.
    Merge(super::merge::Merge),
    /// Print a summary of a scene without rendering it
    ///
    /// Of an image or sums, print how they were made; of a volume file (.vdb, .nvdb, .vol), the grids in it, and which
    /// of them the plugin smoke takes by itself.
    Info(Info),
    /// Convert a scene from Mitsuba 3 XML to JSON, or from JSON to XML; an image to a PNG; a volume file to .vol
    ///
    /// An image (.exr, .pfm, .rgbe, .hdr) becomes the PNG that render would write beside it, with another --exposure or
    /// --view: tyndall convert fog.exr fog.png --exposure auto --view agx
    ///
    /// A grid of an OpenVDB or NanoVDB file (.vdb, .nvdb) becomes Mitsuba's .vol, of all voxels in the box around the
    /// active ones and one more on every side; a gridvolume with use_grid_bbox shows the same of both files.
    ///
    /// Plugins, names, ids, references, order, the exact value of every number, colours, spectra, the steps of
    /// transforms, and parameters with their defaults are preserved (<default> in XML is "$defaults" in JSON).
    /// Included files and the values of spectrum files are written into the new file; aliases are replaced by the
    /// ids that they refer to. Comments and layout are not kept. Paths of other files are adjusted so that they
    /// still refer to the same files, which are not moved. Where the new format does not allow a parameter, its
    /// value is written instead, and a note on standard error names the place.
    Convert(Convert),
    /// Create the page of a study, study.html, again from its numbers and images
    Report(Report),
    /// Measure error against run time: render scenes with several contenders and compare them with a reference
    ///
    /// Every contender renders every scene with several seeds. Each render is measured every time its number of
    /// samples has doubled, so the points of one curve share samples: the intervals over seeds are valid at every
    /// budget, and the slope is estimated seed by seed. Writes study.json, study.csv, images, and runs/ with the
    /// state of the study to FOLDER: a study that was interrupted continues when the same command is run again.
    Study(Study),
    /// Compare an image with a reference: MSE, relMSE, MAPE, SMAPE, FLIP and more
    ///
    /// Measures are given in radiance and in display units (both images tone-mapped with the same curve). Exit
    /// code: 0, 1 if a measure is above its --fail-above, 2 on an error.
    Diff(super::diff::Diff),
    /// Test whether the samples of a phase function match its pdf, or draw both: a polar plot (SVG) and meshes (PLY)
    ///
    /// Exit code: 0, 1 if they do not match, 2 on an error.
    Phase(super::phase::Phase),
    /// Compare methods of free-flight sampling in a slab or a cube: bias, variance, time
    ///
    /// Photons enter at one point in one direction. Distances are constant steps (CDS), exponentially distributed
    /// with sigma_t (RDS_t) or with sigma_s (RDS_s), or have their first collision forced. Exit code: 0, 1 if an
    /// unbiased method deviates from the expected values, 2 on an error.
    Flights(super::flights::Flights),
    /// Explain plugins of scenes: their parameters, with ranges, units and defaults
    ///
    /// For example: tyndall explain, tyndall explain heterogeneous, tyndall explain sigma_t
    Explain(Explain),
    /// Print a script that completes commands, options and names in a shell
    ///
    /// For example: tyndall completions bash > ~/.local/share/bash-completion/completions/tyndall
    Completions(Completions),
    /// Print the manual page, or write the pages of all commands to a folder
    Man(Manual),
}

impl Command {
    /// How the command gives its result, where that is a choice.
    pub fn answer(&self) -> Option<&Answer> {
        match self {
            Self::Render(render) => Some(&render.answer),
            Self::Strategies(strategies) => Some(&strategies.answer),
            Self::Guide(guide) => Some(&guide.answer),
            Self::Info(info) => Some(&info.answer),
            Self::Study(study) => Some(&study.answer),
            Self::Diff(diff) => Some(&diff.answer),
            Self::Phase(phase) => Some(&phase.answer),
            Self::Flights(flights) => Some(&flights.answer),
            Self::Pixel(_)
            | Self::Convert(_)
            | Self::Merge(_)
            | Self::Report(_)
            | Self::Explain(_)
            | Self::Completions(_)
            | Self::Man(_) => None,
        }
    }
}

/// Render a scene to an image.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Render {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// Image to write: linear OpenEXR (.exr), float map (.pfm) or Radiance (.rgbe, .hdr); a tone-mapped PNG
    /// (.png) is written next to it
    ///
    /// Default: the name of the scene, in the current folder, in the file format of its film.
    #[arg(short, long, value_name = "FILE", value_parser = image_file)]
    pub output: Option<PathBuf>,

    /// How its PNG shows it.
    #[command(flatten)]
    pub display: Display,

    /// Where the statistics of the render go: time, samples, noise, how paths were sampled.
    #[command(flatten)]
    pub answer: Answer,

    /// Samples per pixel [default: the scene's sample_count]
    ///
    /// With --time-limit and without --spp: as many as the time allows.
    #[arg(long, value_name = "N", value_parser = positive_u32, allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// Stop after this time: a number with the unit s, m or h (90, 90s, 5m, 1.5h; seconds without a unit)
    /// [default: no limit]
    ///
    /// The samples completed by then are written. A pilot and what is learnt count, up to half of it if beforehand. With
    /// --spp as well, the render stops at whichever limit is reached first. Alpha and the layers of an aov integrator
    /// are rendered afterwards, within a tenth of a second or one pass over the image.
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub time_limit: Option<Duration>,

    /// Sample every pixel until its relative error is below this value, such as 0.02
    ///
    /// The error is estimated from the samples of each pixel, in every channel, and holds for each pixel with the
    /// probability --confidence. It is relative to the pixel's value plus 1 % of the image's mean luminance, as in the
    /// MAPE of tyndall diff. Noisier pixels get more samples, pixels that are still black as many as the noisiest; the
    /// image stays unbiased. With --spp or --time-limit as well, the render stops at whichever limit is reached first;
    /// without them there is no other limit. In EXR files the channel samples.N is the number of samples of each
    /// pixel.
    #[arg(long, value_name = "E", value_parser = relative_error, allow_negative_numbers = true)]
    pub error: Option<f64>,

    /// Probability that a pixel is within --error [default: 0.95]
    #[arg(long, value_name = "C", value_parser = confidence, requires = "error", allow_negative_numbers = true)]
    pub confidence: Option<f64>,

    /// Which pixels are shaded.
    #[command(flatten)]
    pub pixels: Progressive,

    /// Render N images with the seeds --seed, --seed + 1, ... and write their mean
    ///
    /// The EXR also holds the standard error of the mean (standard_error.R, ...) and every image (batch.0.R,
    /// batch.1.R, ...), for uses that need independent images. --spp and --time-limit apply to each image; the
    /// scene is loaded once.
    #[arg(long, value_name = "N", value_parser = batches, conflicts_with = "error", allow_negative_numbers = true)]
    pub batches: Option<u32>,

    /// Also write what each group of emitters contributes, as layers of the EXR (group.NAME.R, ...)
    ///
    /// The parameter "group" of emitters and emissive media names their group; those that name none are the group rest. The
    /// layers add up to the image, and an image of lights that are weaker, stronger or of another colour is a sum of layers
    /// times factors.
    #[arg(long)]
    pub groups: bool,

    /// Also write unscattered, emitted and scattered light (Premoze 2003, eq. 17), as layers of the EXR
    ///
    /// By what happens in media between the camera and the first surface: nothing (unscattered.R, ...: light of what is
    /// behind), light is emitted there (emitted.R, ...), or it is scattered there, of which there is light that was
    /// scattered in media once on its whole way (scattered.single.R, ...) and more than once (scattered.multiple.R, ...).
    /// The layers add up to the image. With --groups, those of each group are written (group.NAME.unscattered.R, ...).
    #[arg(long)]
    pub components: bool,

    /// Continue from the sums of an earlier render: the rest of an interrupted one, or, with --sums in both commands, more
    /// samples for a finished one
    ///
    /// The image is the same, bit for bit, as if the render had never stopped; --spp is the total. Where that is another than
    /// before, a pilot may choose other strategies for the samples that follow, unless --strategies names them. Scene, files and
    /// options that decide about the image must be the same. Where there are no sums yet, the render starts from the
    /// beginning.
    #[arg(long, overrides_with = "resume", conflicts_with_all = ["batches", "frames"])]
    pub resume: bool,

    /// File for the sums of all samples, from which --resume continues and tyndall merge makes one image
    /// [default: the image's name and .sums, such as fog.exr.sums, once the render has taken a minute]
    ///
    /// Written every minute (--sums-every), less often where it would take more than 1 % of the time, and at the end. A
    /// file that is named stays; the default one is removed once the image has all samples, or the error, that were asked
    /// for. The format is safetensors.
    #[arg(long, visible_alias = "checkpoint", value_name = "FILE", conflicts_with_all = ["batches", "frames"])]
    pub sums: Option<PathBuf>,

    /// Time between two writes of the sums, at least [default: 1m]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub sums_every: Option<Duration>,

    /// Render only the samples A to B - 1 of every pixel, for tyndall merge
    ///
    /// Parts with other samples of the same scene, options and seed, rendered anywhere, add up to exactly the image
    /// that one render of all samples makes. An image is written only if -o is given. Renders with --error are cut by
    /// --crop instead.
    #[arg(long, value_name = "A..B", value_parser = samples, requires = "sums", allow_hyphen_values = true,
        conflicts_with_all = ["spp", "error", "batches", "frames"])]
    pub samples: Option<Samples>,

    /// Write the image so far, and its PNG, every five seconds
    #[arg(long)]
    pub preview: bool,

    /// Show the image so far in the viewer tev
    #[arg(long, value_name = "HOST:PORT", num_args = 0..=1, default_missing_value = viewer::ADDRESS, value_parser = address)]
    pub tev: Option<String>,

    /// Seed of all random numbers; the same seed gives the same image
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Render frames A to B of an animation, both included, or the single frame A; frame k shows the scene at the
    /// time of the scene + k / FPS
    ///
    /// Volumes inside a "wind" move; the scene is loaded once. The frame number is added to the file name with at
    /// least four digits: fog.0007.exr and fog.0007.png. --spp and --time-limit apply to each frame. The random
    /// numbers of a frame depend on --seed and its number only: a frame rendered alone is the same image.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true)]
    pub frames: Option<Frames>,

    /// Frames per second [default: 24]
    #[arg(long, value_name = "FPS", value_parser = fps, requires = "frames", allow_negative_numbers = true)]
    pub fps: Option<f64>,

    /// How paths are sampled.
    #[command(flatten)]
    pub estimator: Estimator,

    /// How the preview looks.
    #[command(flatten)]
    pub fog: Preview,

    /// Size of the image in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// Render only the part of the image of WIDTHxHEIGHT pixels whose top left corner is at pixel X, Y
    ///
    /// With --sums it is a part for tyndall merge, which puts together parts that cover the image; an image of the part is
    /// written only if -o is given. Every part traces light subpaths of its own, as many as it has pixels: what they
    /// contribute by the strategy lens is noisier than in a render of the whole image, so prefer --samples to cut a render
    /// without --error. --error is relative to the mean luminance of the part.
    #[arg(long, value_name = "WIDTHxHEIGHT+X+Y", value_parser = crop, allow_hyphen_values = true)]
    pub crop: Option<Crop>,
}

impl Render {
    /// What the options override in the scene.
    pub fn overrides(&self) -> Overrides {
        let Self { crop, groups, components, .. } = *self;
        let fog = self.fog.settings();
        let strict = self.scene.strict;
        Overrides { crop, groups, components, fog, strict, ..self.estimator.overrides(self.size) }
    }

    /// Seed of the random numbers: of parts of an image, no two share one, or the noise of one would be repeated in others.
    pub fn seed_of_part(&self) -> u64 {
        let Some(Crop { corner: [x, y], .. }) = self.crop else { return self.seed };
        let corner = u64::from(y) << 32 | u64::from(x);
        self.seed ^ corner.wrapping_add(1).wrapping_mul(0xd1b5_4a32_d192_ed03)
    }

    /// True if no image is to be written but sums, for tyndall merge.
    pub fn is_part(&self) -> bool {
        let is_cut = self.samples.is_some() || self.crop.is_some();
        is_cut && self.sums.is_some() && self.output.is_none()
    }
}

/// Print a summary of a scene.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Info {
    /// Which scene.
    #[command(flatten)]
    pub scene: Scene,

    /// How paths would be sampled.
    #[command(flatten)]
    pub estimator: Estimator,

    /// Also show what the pilot foretells of all that it could choose: error, time, and why the winner won
    #[arg(long)]
    pub pilot: bool,

    /// Samples per pixel of the render to come, by which the pilot is sized [default: the scene's sample_count]
    #[arg(long, value_name = "N", value_parser = positive_u32, allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// How the summary is given.
    #[command(flatten)]
    pub answer: Answer,
}

/// Print a script for a shell.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Completions {
    /// The shell
    #[arg(value_enum, value_name = "SHELL")]
    pub shell: clap_complete::Shell,
}

/// Explain what scenes can hold.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Explain {
    /// Plugin (spot), kind of plugins (emitter), parameter (cutoff_angle) or keyframes [default: list all plugins]
    #[arg(value_name = "PLUGIN")]
    pub topic: Option<String>,

    /// Print a JSON Schema of scenes instead, by which editors complete and check them
    #[arg(long, conflicts_with = "topic")]
    pub schema: bool,
}

/// Print or write manual pages.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Manual {
    /// Folder for the pages of all commands, created if missing [default: print the page of tyndall]
    #[arg(value_name = "FOLDER")]
    pub folder: Option<PathBuf>,
}

/// Convert a scene, an image or a volume file.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Convert {
    /// Scene file: Mitsuba 3 XML (.xml) or JSON (.json), or - for standard input; or an image; or a volume file
    #[arg(value_name = "IN", value_parser = scene_file())]
    pub input: PathBuf,

    /// Scene file to write: .xml or .json; of an image: .png; of a volume file: .vol
    #[arg(value_name = "OUT")]
    pub output: PathBuf,

    /// Change the default of the parameter $name in OUT; may be repeated
    #[arg(short = 'D', value_name = "name=value", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Write the values of parameters instead of their names (mitsuba.load_dict does not support parameters)
    #[arg(long)]
    pub fill: bool,

    /// The grid that is meant in a file of several [default: the one named "density", else the only one]
    #[arg(long, value_name = "NAME")]
    pub grid: Option<String>,

    /// How the PNG of an image shows it.
    #[command(flatten)]
    pub display: Display,
}

/// Make the page of a study.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Report {
    /// Folder of the study, with study.json and its images
    #[arg(value_name = "FOLDER")]
    pub folder: PathBuf,

    /// Also write its table, curves and images for a README to this folder: convergence.md, .svg and _strips.svg
    #[arg(long, value_name = "FOLDER")]
    pub record: Option<PathBuf>,
}

/// A scene file and its parameters.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Scene {
    /// Scene file: Mitsuba 3 XML (.xml) or JSON (.json), or - for standard input
    ///
    /// On standard input the first character tells the format. Names of other files in the scene then start at the
    /// current folder, and outputs without a name of their own are called "stdin".
    #[arg(value_name = "SCENE", value_parser = scene_file())]
    pub file: PathBuf,

    /// Set the parameter $name of the scene instead of its default; may be repeated
    #[arg(short = 'D', value_name = "name=value", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Sensor to see the scene by, where it has several: its id, or its number from 0 in file order [default: the first]
    #[arg(long, value_name = "SENSOR")]
    pub sensor: Option<String>,

    /// Refuse files with numbers a hair out of range instead of mending them
    ///
    /// Of volumes and images: negative numbers become 0, albedos and reflectances above 1 become 1, infinite numbers the
    /// greatest finite one of the file, each file with one warning. NaN is an error, and so are numbers so far out of range
    /// that they must mean something else: more than one in a hundred of those that are not 0, by more than a fifth of the
    /// greatest.
    #[arg(long)]
    pub strict: bool,
}

/// Samples of every pixel, the last one excluded.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Samples {
    /// The first.
    pub first: u32,
    /// After the last.
    pub end: u32,
}

impl Scene {
    /// What the file says, with the one sensor that is wanted.
    pub fn read(&self) -> Result<Object, Error> {
        let root = format::read(&self.file, &self.definitions)?;
        match &self.sensor {
            None => Ok(root),
            Some(sensor) => sensors::only(root, sensor),
        }
    }

    /// What outputs are called that have no name of their own.
    pub fn name(&self) -> PathBuf {
        match format::is_standard_input(&self.file) {
            true => "stdin".into(),
            false => self.file.file_stem().unwrap_or_default().into(),
        }
    }
}

/// Frames of an animation, both included.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Frames {
    /// The first.
    pub first: u32,
    /// The last.
    pub last: u32,
}

impl Frames {
    /// Digits of their numbers in names of files.
    pub fn digits(self) -> usize {
        self.last.to_string().len().max(4)
    }
}

/// Width and height of an image in pixels, both positive.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub struct Size {
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl From<Size> for (u32, u32) {
    fn from(size: Size) -> Self {
        (size.width, size.height)
    }
}

/// No film needs more pixels on a side; a size beyond is a slip of the finger.
const LARGEST_SIDE: u32 = 65_536;

pub(super) fn positive_u32(text: &str) -> Result<u32, String> {
    match text.parse() {
        Ok(0) => Err("it must be at least 1".into()),
        Ok(number) => Ok(number),
        Err(_) => Err("expected a whole number from 1 to 4294967295, such as 64".into()),
    }
}

fn batches(text: &str) -> Result<u32, String> {
    let number = text.parse().ok().filter(|batches| (2..=1000).contains(batches));
    number.ok_or_else(|| "expected a number of images from 2 to 1000, such as 16".to_owned())
}

fn frames(text: &str) -> Result<Frames, String> {
    let expected = || "expected frames from 0 to 99999999, such as 0..47, or one, such as 12".to_owned();
    let frame = |text: &str| text.parse().ok().filter(|n| *n <= 99_999_999).ok_or_else(expected);
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    let (first, last) = (frame(first)?, frame(last)?);
    if first > last {
        return Err(format!("expected the first frame before the last: {last}..{first}"));
    }
    Ok(Frames { first, last })
}

fn samples(text: &str) -> Result<Samples, String> {
    let pair = text.split_once("..").and_then(|(first, end)| Some((first.parse().ok()?, end.parse().ok()?)));
    let pair = pair.filter(|(first, end)| first < end && u64::from(*end) <= MOST_PASSES);
    let (first, end) = pair.ok_or_else(|| {
        format!("expected two numbers from 0 to {MOST_PASSES}, the first below the second, such as 0..64")
    })?;
    Ok(Samples { first, end })
}

fn address(text: &str) -> Result<String, String> {
    let port =
        text.rsplit_once(':').and_then(|(host, port)| port.parse::<u16>().ok().filter(|_| !host.is_empty()));
    port.map(|_| text.to_owned())
        .ok_or_else(|| format!("expected a host and a port, such as {}", viewer::ADDRESS))
}

fn fps(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|fps: &f64| (1e-6..=1e9).contains(fps));
    number.ok_or_else(|| "expected frames per second from 1e-6 to 1e9, such as 24 or 29.97".to_owned())
}

fn relative_error(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|error: &f64| (1e-5..=1.0).contains(error));
    number.ok_or_else(|| "expected a relative error from 1e-5 to 1, such as 0.02".to_owned())
}

pub(super) fn confidence(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|confidence: &f64| (0.5..=0.9999).contains(confidence));
    number.ok_or_else(|| "expected a probability from 0.5 to 0.9999, such as 0.95".to_owned())
}

pub(super) fn threads(text: &str) -> Result<NonZeroUsize, String> {
    let threads = positive_u32(text)?;
    NonZeroUsize::new(threads as usize)
        .filter(|threads| threads.get() <= 4096)
        .ok_or_else(|| "expected at most 4096 threads".into())
}

/// Reads a name of a table as the value that it refers to.
pub(super) fn one_of<T: Copy + Send + Sync + 'static>(
    table: &'static [(&'static str, T)],
) -> impl TypedValueParser<Value = T> {
    PossibleValuesParser::new(table.iter().map(|(name, _)| *name)).try_map(|name| {
        let found = table.iter().find(|(known, _)| *known == name);
        found.map(|(_, value)| *value).ok_or("unknown name")
    })
}

pub(super) fn size(text: &str) -> Result<Size, String> {
    let expected = || format!("expected WIDTHxHEIGHT in pixels from 1 to {LARGEST_SIDE}, such as 640x480");
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(expected)?;
    let side =
        |text: &str| text.parse().ok().filter(|side| (1..=LARGEST_SIDE).contains(side)).ok_or_else(expected);
    Ok(Size { width: side(width)?, height: side(height)? })
}

fn crop(text: &str) -> Result<Crop, String> {
    let parts = text.split_once('+').and_then(|(pixels, corner)| {
        let (x, y) = corner.split_once('+')?;
        let Size { width, height } = size(pixels).ok()?;
        Some(Crop { corner: [x.parse().ok()?, y.parse().ok()?], size: [width, height] })
    });
    parts.ok_or_else(|| "expected WIDTHxHEIGHT+X+Y in pixels, such as 320x240+640+0".to_owned())
}

pub(super) fn duration(text: &str) -> Result<Duration, String> {
    let expected = || "expected a time above 0, such as 90, 90s, 5m or 1.5h".to_owned();
    let (number, seconds) = match text.char_indices().next_back() {
        Some((at, 's')) => (&text[..at], 1.0),
        Some((at, 'm')) => (&text[..at], 60.0),
        Some((at, 'h')) => (&text[..at], 3600.0),
        _ => (text, 1.0),
    };
    let number: f64 = number.parse().map_err(|_| expected())?;
    let duration = Duration::try_from_secs_f64(number * seconds).map_err(|_| expected())?;
    if duration.is_zero() { Err(expected()) } else { Ok(duration) }
}

pub(super) fn definition(text: &str) -> Result<(String, String), String> {
    let (name, value) = text.split_once('=').ok_or("expected name=value, such as -D res=512")?;
    if name.is_empty() || name.contains(char::is_whitespace) {
        return Err("expected a name without spaces before \"=\"".into());
    }
    Ok((name.to_owned(), value.to_owned()))
}

/// The path of a scene; - is that of standard input.
fn scene_file() -> impl TypedValueParser<Value = PathBuf> {
    let named = |path: PathBuf| if path.as_os_str() == "-" { format::STANDARD_INPUT.into() } else { path };
    PathBufValueParser::new().map(named)
}

pub(super) fn image_file(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("exr" | "pfm" | "rgbe" | "hdr" | "png") => Ok(path),
        _ if crate::film::output::is_stream(&path) => Ok(path),
        _ => Err("expected a file name that ends in .exr, .pfm, .rgbe, .hdr or .png".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::estimator::{MaxDepth, Profile},
        *,
    };
    use crate::{
        medium::DistanceMethod,
        sampling::Sampler,
        transport::{Strategies, observer::StrategyKind},
    };
    use clap::CommandFactory;

    fn parse(words: &str) -> Result<Command, String> {
        let words = std::iter::once("tyndall").chain(words.split_whitespace());
        Arguments::try_parse_from(words).map(|arguments| arguments.command).map_err(|e| e.to_string())
    }

    fn render(words: &str) -> Render {
        match parse(&format!("render fog.json {words}")) {
            Ok(Command::Render(render)) => render,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn everything_can_be_given_at_once() {
        let r = render(
            "-o a.exr --spp 8 --time-limit 5m --seed 3 --threads 2 --integrator lt -D res=48 -D t=a=b \
             --size 64x32 --profile everything --strategies hit,next-event --max-depth -1 --sampler sobol \
             --crop 8x4+10+0 --forced-interaction",
        );
        assert_eq!(r.output, Some("a.exr".into()));
        assert_eq!((r.spp, r.seed, r.time_limit), (Some(8), 3, Some(Duration::from_secs(300))));
        assert_eq!(
            (r.threads.map(NonZeroUsize::get), r.estimator.integrator),
            (Some(2), Some(Strategies::LT))
        );
        let definitions = [("res".to_owned(), "48".to_owned()), ("t".to_owned(), "a=b".to_owned())];
        assert_eq!(r.scene.definitions, definitions);
        assert_eq!(r.size, Some(Size { width: 64, height: 32 }));
        assert_eq!(r.crop.map(|crop| (crop.corner, crop.size)), Some(([10, 0], [8, 4])));
        assert_eq!(
            (r.estimator.profile, r.estimator.max_depth),
            (Profile::Everything, Some(MaxDepth::Unbounded))
        );
        assert_eq!(r.estimator.strategies, [StrategyKind::EmitterHit, StrategyKind::NextEvent]);
        assert_eq!((r.estimator.sampler, r.estimator.forced_interaction), (Some(Sampler::Sobol), true));
    }

    #[test]
    fn parts_have_random_numbers_of_their_own() {
        let crops = ["", "--crop 4x4+0+0", "--crop 4x4+4+0", "--crop 4x4+0+4", "--crop 4x4+4+4"];
        let mut seeds = crops.map(|crop| render(&format!("{crop} --seed 5")).seed_of_part());
        assert_eq!(seeds[0], 5);
        seeds.sort_unstable();
        assert!(seeds.windows(2).all(|pair| pair[0] != pair[1]), "{seeds:?}");
    }

    #[test]
    fn a_scene_can_be_converted() {
        let Ok(Command::Convert(convert)) = parse("convert a.xml b/c.json -D x=2 --fill") else { panic!() };
        assert_eq!((convert.input, convert.output), ("a.xml".into(), "b/c.json".into()));
        assert_eq!((convert.definitions, convert.fill), (vec![("x".to_owned(), "2".to_owned())], true));
    }

    #[test]
    fn the_default_is_what_the_scene_says() {
        let r = render("");
        assert_eq!((r.spp, r.output, r.estimator.max_depth, r.seed), (None, None, None, 0));
        assert!(r.estimator.strategies.is_empty() && r.scene.definitions.is_empty());
    }

    #[test]
    fn times_have_units() {
        for (text, seconds) in [("90", 90.0), ("90s", 90.0), ("0.5", 0.5), ("5m", 300.0), ("1.5h", 5400.0)] {
            assert_eq!(duration(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["0", "-1", "s", "", "5 m", "nan", "inf", "1e300", "5d", "5\u{b5}"] {
            assert!(duration(text).is_err(), "{text}");
        }
    }

    #[test]
    fn frames_are_a_range_or_one() {
        let frames = |first, last| Some(Frames { first, last });
        assert_eq!(render("--frames 0..47 --fps 25").frames, frames(0, 47));
        assert_eq!(render("--frames 7").frames, frames(7, 7));
        assert_eq!(render("--frames 3..3").frames, frames(3, 3));
        assert_eq!((render("--frames 1").fps, render("--frames 1 --fps 29.97").fps), (None, Some(29.97)));
        assert_eq!((render("").frames, render("").estimator.media.tracker), (None, None));
        for (name, choice) in DistanceMethod::NAMES {
            assert_eq!(render(&format!("--tracker {name}")).estimator.media.tracker, Some(choice));
        }
    }

    #[test]
    fn nonsense_is_refused_with_a_hint() {
        for (words, hint) in [
            ("render a.xml --frames 5..2", "2..5"),
            ("render a.xml --frames -1..2", "from 0"),
            ("render a.xml --frames 1..", "such as 0..47"),
            ("render a.xml --frames 0..=4", "such as 0..47"),
            ("render a.xml --frames 0..123456789", "99999999"),
            ("render a.xml --fps 25", "--frames"),
            ("render a.xml --frames 1 --fps 0", "such as 24"),
            ("render a.xml --frames 1 --fps -24", "such as 24"),
            ("render a.xml --frames 1 --fps nan", "such as 24"),
            ("render a.xml --tracker exakt", "exact"),
            ("info a.xml --tracker delta", "null_collision"),
            ("render a.xml --size 0x5", "from 1 to"),
            ("render a.xml --size 5", "640x480"),
            ("render a.xml --size -5x5", "from 1 to"),
            ("render a.xml --crop 64x32", "320x240+640+0"),
            ("render a.xml --crop 64x0+1+2", "320x240+640+0"),
            ("render a.xml --crop 64x32+-1+2", "320x240+640+0"),
            ("render a.xml --error 0.1 --samples 0..4 --sums a.sums", "cannot be used with"),
            ("render a.xml --spp 0", "at least 1"),
            ("render a.xml --batches 1", "from 2 to 1000"),
            ("render a.xml --batches -4", "from 2 to 1000"),
            ("render a.xml --batches 8 --error 0.02", "cannot be used with"),
            ("render a.xml --spp -3", "whole number"),
            ("render a.xml --threads 0", "at least 1"),
            ("render a.xml --threads 99999", "at most 4096"),
            ("render a.xml --time-limit -5", "above 0"),
            ("render a.xml --max-depth -2", "-1 for no limit"),
            ("render a.xml -D res", "name=value"),
            ("render a.xml -D =3", "before \"=\""),
            ("render a.xml -o a.jpg", ".hdr or .png"),
            ("render a.xml --integrator bdp", "bdpt"),
            ("render a.xml --strategies hit,jion", "join"),
            ("render a.xml --heuristic balanec", "balance, power"),
            ("render a.xml --heuristic cutoff:1", "below 1"),
            ("render a.xml --sampler sobl", "sobol"),
            ("convert a.xml", "OUT"),
            ("convert a.xml b.json -D res", "name=value"),
            ("convert --help", "Comments and layout are not kept"),
            ("render", "SCENE"),
            ("rendr a.xml", "render"),
        ] {
            let message = parse(words).unwrap_err();
            assert!(message.contains(hint), "{words}: {message}");
        }
    }
}
