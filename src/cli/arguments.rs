//! The arguments of the command line.

use super::{
    console::{Answer, ProgressForm},
    convert::Convert,
    denoise::Denoise,
    diff,
    explain::Explain,
    flights, guide,
    info::Info,
    manual::{Completions, Manual},
    merge,
    new::{self, New},
    phase, pixel,
    render::arguments::Render,
    report::Report,
    strategies,
    study::Study,
    view,
};
use clap::{Parser, Subcommand};

/// A bidirectional path tracer for fog, smoke and fire.
#[derive(Clone, Debug, Parser, PartialEq)]
#[command(version, about, propagate_version = true, after_help = EXIT_CODES)]
pub struct Arguments {
    /// Print no progress, plan, summary or table; warnings, errors and what is asked for as data (--json, --progress json)
    /// remain
    #[arg(short, long, global = true)]
    pub quiet: bool,

    /// Form of the progress on standard error; `tyndall explain progress` describes the lines of JSON
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
    Render(Box<Render>),
    /// Look at a scene in a browser while it is written: the picture refines, the camera is moved by hand
    ///
    /// Prints the address of a page, which this machine alone can open, and serves it until Ctrl-C. Dragging turns the camera
    /// about what is in the middle of the image, the wheel brings it nearer, Shift and dragging moves it sideways. The page
    /// shows the lines that place the camera, to be pasted into the scene file, and reads the scene again when it is saved.
    /// A moving camera shows surfaces in fog without shadows; one at rest, what `tyndall render` renders, without a pilot. No
    /// file is written. For example: tyndall view fog.json, tyndall view plume.vdb
    View(Box<view::Arguments>),
    /// Write a scene to start from: a small one by name, or one around a volume file
    ///
    /// For example: tyndall new fog -o fog.json, tyndall new plume.vdb > plume.json
    ///
    /// The scene around a volume file is the one that `tyndall render plume.vdb` renders: all of the smoke in view, on the
    /// ground under the sun, as thick as smoke looks, or at dusk if the file has fire. Its name of the file starts at the
    /// folder of --output; without that, at the current folder.
    #[command(after_help = new::templates())]
    New(New),
    /// Show what each strategy of bidirectional path tracing contributes to a scene
    ///
    /// Writes to a folder the image of each strategy, weighted and unweighted, as EXR layers and as pyramids on
    /// contact sheets (Veach 1997, fig. 10.2 and 10.3), and a table of the shares of energy, variance and time as
    /// JSON and CSV. Short renders with different sets of strategies then show which kinds of strategies the
    /// scene does not need.
    Strategies(strategies::Arguments),
    /// Show what a guide learns of a scene: what render --guide follows
    ///
    /// Writes to a folder guide.json, with the number of cells, their memory and the time that learning took, how often light
    /// subpaths start at each emitter, and the cells that most pixels see; cells.png: the cells as the camera sees them, and the
    /// part of the directions of both kinds of walks that is guided there; directions.png: where walks go from the cells
    /// that most pixels see (azimuth to the right, +z downwards; equal areas are equal solid angles; yellow is a
    /// thousand times as likely as evenly spread directions, black a hundredth).
    Guide(guide::Arguments),
    /// Write the paths of one pixel's samples, or those that make single bright pixels (--outliers), as JSON
    ///
    /// The samples are those of a render with the same seed, size and options: the same camera subpaths and the
    /// same light vertices. Every vertex is listed with its pdfs and every contribution with its weight; the
    /// contributions sum to the value of the pixel.
    Pixel(pixel::Arguments),
    /// Put together parts of one image, rendered with --samples or --crop, and write the image
    ///
    /// The parts are checkpoints of the same scene, options and seed. Parts with other samples of the same pixels (--samples)
    /// are added up. The image is the same, bit for bit, as that of one render of all these samples with --samples. From 2.1
    /// million samples on, over all pixels, it is also that of one render with --spp; the pilot of fewer samples is shorter.
    /// Parts with other pixels (--crop) are put side by side. They must cover the image and not overlap.
    Merge(merge::Merge),
    /// Print a summary of a scene without rendering it
    ///
    /// For an image or a checkpoint, print how it was made. For a volume file (.vdb, .nvdb, .vol), print its grids, and which
    /// of them the plugin smoke chooses by default.
    Info(Info),
    /// Convert a scene from Mitsuba 3 XML to JSON, or from JSON to XML; an image to a PNG; a volume file to .vol
    ///
    /// An image (.exr, .pfm, .rgbe, .hdr) becomes the PNG that render would write beside it, with another --exposure or
    /// --view, or of a --layer: tyndall convert fog.exr fog.png --exposure auto --view agx
    ///
    /// A grid of an OpenVDB or NanoVDB file (.vdb, .nvdb) becomes Mitsuba's .vol, of all voxels in the box around the
    /// active ones and one more on every side; a gridvolume with use_grid_bbox shows the same of both files.
    ///
    /// Plugins, names, ids, references, order, the exact value of every number, colours, spectra and the steps of
    /// transforms are preserved. Comments and layout are not kept. Nor are parameters: each `$name` is replaced by its
    /// value, from -D, `<default>` (XML) or `$defaults` (JSON), and a note on standard error lists the values. Included
    /// files and the values of spectrum files are written into the new file; aliases are replaced by the ids that they
    /// refer to. Paths of other files are adjusted so that they still refer to the same files, which are not moved.
    Convert(Convert),
    /// Denoise an OpenEXR image by Open Image Denoise, which the Python package of Tyndall brings
    ///
    /// Writes NAME.denoised.exr and NAME.denoised.png beside the image. A denoised image is biased, by an amount that nobody
    /// knows. It needs Python with the package tyndall and its extra: `pip install '.[denoise]'`. The environment variable
    /// TYNDALL_PYTHON names another Python than python3.
    Denoise(Denoise),
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
    Diff(diff::Diff),
    /// Test whether the samples of a phase function match its pdf, or draw both: a polar plot (SVG) and meshes (PLY)
    ///
    /// Exit code: 0, 1 if they do not match, 2 on an error.
    Phase(phase::Phase),
    /// Compare methods of free-flight sampling in a slab or a cube: bias, variance, time
    ///
    /// Photons enter at one point in one direction. Distances are constant steps (CDS), exponentially distributed
    /// with sigma_t (RDS_t) or with sigma_s (RDS_s), or have their first collision forced. Exit code: 0, 1 if an
    /// unbiased method deviates from the expected values, 2 on an error.
    Flights(flights::Flights),
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
            | Self::View(_)
            | Self::New(_)
            | Self::Denoise(_)
            | Self::Merge(_)
            | Self::Report(_)
            | Self::Explain(_)
            | Self::Completions(_)
            | Self::Man(_) => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{
            depth::MaxDepth,
            estimator::Profile,
            parsers::{Frames, Size},
        },
        *,
    };
    use crate::{
        medium::DistanceMethod,
        sampling::Sampler,
        transport::{Algorithm, strategy::StrategyKind},
    };
    use clap::CommandFactory;
    use std::{num::NonZeroUsize, time::Duration};

    fn parse(words: &str) -> Result<Command, String> {
        let words = std::iter::once("tyndall").chain(words.split_whitespace());
        Arguments::try_parse_from(words).map(|arguments| arguments.command).map_err(|e| e.to_string())
    }

    fn render(words: &str) -> Render {
        match parse(&format!("render fog.json {words}")) {
            Ok(Command::Render(render)) => *render,
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
            (Some(2), Some(Algorithm::Lt))
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
        let Ok(Command::Convert(convert)) = parse("convert a.xml b/c.json -D x=2") else { panic!() };
        assert_eq!((convert.input, convert.output), ("a.xml".into(), "b/c.json".into()));
        assert_eq!(convert.definitions, [("x".to_owned(), "2".to_owned())]);
    }

    #[test]
    fn the_default_is_what_the_scene_says() {
        let r = render("");
        assert_eq!((r.spp, r.output, r.estimator.max_depth, r.seed), (None, None, None, 0));
        assert!(r.estimator.strategies.is_empty() && r.scene.definitions.is_empty());
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
            ("render a.xml --min-depth -1", "from 0 to 4294967295"),
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
