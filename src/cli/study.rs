//! `tyndall study`: error against run time.

use super::{
    arguments::{Size, Tracker, confidence, definition, duration, positive_u32, size, threads as threads_of},
    complain, contenders, estimator, say, threads,
};
use crate::{
    description::Object,
    error::{Error, Result},
    render::budget::Budget,
    scene::{
        self, Sources,
        build::{self, Overrides, Setup},
    },
    study::{
        convergence::{
            contender::{Contender, Entry},
            question::{Effort, Question, ReferenceFile, SceneQuestion, Wanted, fingerprint},
            reference,
            run::{self, Progress, Signature},
            table,
        },
        page,
    },
    transport::Strategies,
};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use std::{
    num::NonZeroUsize,
    path::{Path, PathBuf},
    sync::Arc,
    time::{Duration, Instant},
};
use sysinfo::{CpuRefreshKind, RefreshKind, System};

/// Measure error against run time.
#[derive(Args, Clone, Debug, PartialEq)]
pub struct Study {
    /// Scene files: Mitsuba 3 XML (.xml) or JSON (.json)
    #[arg(value_name = "SCENE", required = true)]
    pub scenes: Vec<PathBuf>,

    /// Folder to write to; the same command goes on with what it holds
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,

    /// Integrators that compete, separated by commas: bdpt, pt, lt [default: bdpt,pt, where nobody else is named]
    ///
    /// All axes (--integrators, --strategies, --trackers, --heuristics, --samplers, --vary) multiply.
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1)]
    pub integrators: Vec<String>,

    /// Sets of strategies that compete, such as hit+next-event,hit+next-event+join; those of bdpt, where --integrators names
    /// no others
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1)]
    pub strategies: Vec<String>,

    /// Flight samplers that compete, such as exact,null_collision
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1)]
    pub trackers: Vec<String>,

    /// Heuristics that compete, such as balance,power,maximum; all on the profile everything
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1)]
    pub heuristics: Vec<String>,

    /// Sources of random numbers that compete: independent, sobol
    #[arg(long, value_name = "LIST", value_delimiter = ',', num_args = 1)]
    pub samplers: Vec<String>,

    /// Any option of `tyndall render` that says how paths are made, as an axis: max-depth=2,4,8; of a switch: on,off. May
    /// be repeated
    #[arg(long, value_name = "OPTION=LIST", allow_hyphen_values = true)]
    pub vary: Vec<String>,

    /// One more contender, by options of `tyndall render`: "joins: --integrator bdpt --strategies hit,join"; may be repeated
    #[arg(long = "contender", value_name = "NAME: OPTIONS", allow_hyphen_values = true)]
    pub contenders: Vec<String>,

    /// Renders of each contender with a seed each; intervals come from these
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub seeds: u32,

    /// Budgets at which a render is looked at, each twice the one before
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=30))]
    pub doublings: u32,

    /// Samples per pixel of the largest budget, in place of a time
    #[arg(long, value_name = "N", value_parser = positive_u32, conflicts_with = "seconds", allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// Time of the largest budget, as --time-limit of `tyndall render` [default: 8]
    ///
    /// A pilot turns it into samples per pixel, once for each contender and scene; runs/plan.json tells how many.
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub seconds: Option<Duration>,

    /// The first seed
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads_of, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Set a $name parameter of all scenes, in place of its default; may be repeated
    #[arg(short = 'D', value_name = "name=value", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Size of the images in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// Of every interval, from 0.5 to 0.9999
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = confidence, allow_negative_numbers = true)]
    pub confidence: f64,

    /// Image to measure errors against (.exr, .pfm), one for each scene, in their order [default: one is made]
    #[arg(long = "reference", value_name = "FILE", conflicts_with_all = ["by", "reference_seconds", "reference_spp"])]
    pub references: Vec<PathBuf>,

    /// relMSE of the --reference against the truth, one for each [default: not known]
    #[arg(long = "reference-error", value_name = "RELMSE", value_parser = error, requires = "references",
          allow_negative_numbers = true)]
    pub reference_errors: Vec<f64>,

    /// Who makes the reference, by options of `tyndall render`: "--integrator bdpt" [default: bdpt or pt, whichever does
    /// not compete, where it covers the scene and is not much noisier, else a contender with other seeds]
    #[arg(long = "reference-by", value_name = "OPTIONS", allow_hyphen_values = true)]
    pub by: Option<String>,

    /// Time to make each reference in [default: four times that of a contender's largest budgets]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub reference_seconds: Option<Duration>,

    /// Samples per pixel of each reference, in place of a time
    #[arg(long, value_name = "N", value_parser = positive_u32, conflicts_with = "reference_seconds",
          allow_negative_numbers = true)]
    pub reference_spp: Option<u32>,

    /// Drop what an earlier study left in FOLDER
    #[arg(long)]
    pub restart: bool,
}

/// Time of the largest budget [s].
const SECONDS: f64 = 8.0;

fn error(text: &str) -> std::result::Result<f64, String> {
    let error = text.parse().ok().filter(|error: &f64| error.is_finite() && *error >= 0.0);
    error.ok_or_else(|| "expected a relMSE of 0 or more, such as 1e-4".to_owned())
}

/// Runs the command.
pub fn run(arguments: &Study) -> Result<()> {
    let contenders = contenders::all(arguments)?;
    let pool = threads(arguments.threads)?;
    let question = question(arguments, contenders, pool.current_num_threads())?;
    let mut stage = Stage::new(arguments);
    check(&mut stage, &question)?;
    let signature = Signature {
        command: command(),
        machine: machine(pool.current_num_threads()),
        confidence: arguments.confidence,
    };
    let mut bar = Bar::new();
    let enter = &mut |scene: usize, words: &str| stage.enter(scene, words);
    let tell = &mut |progress: &Progress| bar.tell(progress);
    let outcome =
        pool.install(|| run::run(&arguments.output, arguments.restart, &question, &signature, enter, tell));
    bar.bar.finish_and_clear();
    say(table::text(&outcome?).trim_end());
    let page = page::write(&arguments.output)?;
    say(&format!(
        "{} shows it; numbers and images lie beside it: study.json, study.csv, images",
        page.display()
    ));
    Ok(())
}

fn question(arguments: &Study, contenders: Vec<Contender>, threads: usize) -> Result<Question> {
    let names = contenders::scene_names(&arguments.scenes);
    let scene = |(name, file): (String, &PathBuf)| {
        Ok(SceneQuestion {
            name,
            fingerprint: fingerprint_of(&scene::sources(file, &arguments.definitions)?)?,
        })
    };
    let effort = match (arguments.spp, arguments.seconds) {
        (Some(spp), _) => Effort::Samples(u64::from(spp)),
        (None, seconds) => Effort::Seconds(seconds.map_or(SECONDS, |seconds| seconds.as_secs_f64())),
    };
    Ok(Question {
        program: format!("tyndall {}", env!("CARGO_PKG_VERSION")),
        scenes: names.into_iter().zip(&arguments.scenes).map(scene).collect::<Result<_>>()?,
        definitions: arguments.definitions.clone(),
        size: arguments.size.map(|size| [size.width, size.height]),
        reference: wanted(arguments, &contenders)?,
        contenders,
        seeds: u64::from(arguments.seeds),
        first_seed: arguments.seed,
        doublings: arguments.doublings,
        effort,
        threads,
    })
}

/// Of all that a scene is read from.
fn fingerprint_of(sources: &Sources) -> Result<String> {
    let spectra = format!("{:?}", sources.spectra);
    let mut all = vec![fingerprint(spectra.as_bytes())];
    for file in &sources.files {
        all.push(fingerprint(&read(file)?));
    }
    Ok(fingerprint(all.concat().as_bytes()))
}

fn wanted(arguments: &Study, contenders: &[Contender]) -> Result<Wanted> {
    let (files, errors, scenes) =
        (&arguments.references, &arguments.reference_errors, arguments.scenes.len());
    let counted = |name: &str, count: usize| match count {
        0 => Ok(()),
        count if count == scenes => Ok(()),
        count => {
            let expected = format!("one for each scene, {scenes} in all");
            Err(Error::new(
                name,
                expected,
                count.to_string(),
                format!("repeat {name} in the order of the scenes"),
            ))
        }
    };
    counted("--reference", files.len())?;
    counted("--reference-error", errors.len())?;
    if !files.is_empty() {
        let file = |(index, path): (usize, &PathBuf)| {
            let fingerprint = fingerprint(&read(path)?);
            let own_relmse = errors.get(index).copied();
            Ok(ReferenceFile { file: path.display().to_string(), fingerprint, own_relmse })
        };
        return Ok(Wanted::Files(files.iter().enumerate().map(file).collect::<Result<_>>()?));
    }
    let effort = match (arguments.reference_spp, arguments.reference_seconds) {
        (Some(spp), _) => Some(Effort::Samples(u64::from(spp))),
        (None, seconds) => seconds.map(|seconds| Effort::Seconds(seconds.as_secs_f64())),
    };
    let others = match &arguments.by {
        None => contenders::referees(contenders)?,
        Some(words) => {
            contenders::parse("--reference-by", words)?;
            vec![words.clone()]
        }
    };
    Ok(Wanted::Made { others, is_given: arguments.by.is_some(), effort })
}

fn read(path: &Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|error| Error::io(path, "read", &error))
}

/// Loads every scene once before anything is rendered: what is wrong with the last one is said now, not in an hour.
fn check(stage: &mut Stage<'_>, question: &Question) -> Result<()> {
    for scene in 0..question.scenes.len() {
        let setup = stage.load(scene)?;
        for warning in &setup.warnings {
            complain(&format!("warning: {warning}"));
        }
        if let Wanted::Files(files) = &question.reference {
            reference::read(&files[scene], setup.film.width as usize, setup.film.height as usize)?;
        }
        if let Wanted::Made { others, is_given: true, .. } = &question.reference {
            stage.enter(scene, &others[0])?;
        }
    }
    Ok(())
}

/// The scene at work, as it was built for each tracker.
struct Stage<'a> {
    arguments: &'a Study,
    scene: Option<(usize, Object, f64)>,
    setups: Vec<(Option<Tracker>, Arc<Setup>, f64)>,
}

impl<'a> Stage<'a> {
    fn new(arguments: &'a Study) -> Self {
        Self { arguments, scene: None, setups: Vec::new() }
    }

    /// The scene as its file says.
    fn load(&mut self, scene: usize) -> Result<Arc<Setup>> {
        Ok(self.setup(scene, None)?.0)
    }

    /// The scene with `tracker`, and the time that reading and building it took [s].
    fn setup(&mut self, scene: usize, tracker: Option<Tracker>) -> Result<(Arc<Setup>, f64)> {
        let started = Instant::now();
        let (root, reading) = match self.scene.take() {
            Some((index, root, reading)) if index == scene => (root, reading),
            _ => {
                self.setups.clear();
                let root = scene::read(&self.arguments.scenes[scene], &self.arguments.definitions)?;
                (root, started.elapsed().as_secs_f64())
            }
        };
        let (_, root, _) = self.scene.insert((scene, root, reading));
        if let Some((_, setup, seconds)) = self.setups.iter().find(|(other, ..)| *other == tracker) {
            return Ok((setup.clone(), *seconds));
        }
        let started = Instant::now();
        let size = self.arguments.size.map(|size| (size.width, size.height));
        let overrides = Overrides { size, tracker: tracker.map(Tracker::choice) };
        let setup = Arc::new(build::build(root, overrides)?);
        let seconds = reading + started.elapsed().as_secs_f64();
        self.setups.push((tracker, setup.clone(), seconds));
        Ok((setup, seconds))
    }

    /// A contender ready to render.
    fn enter(&mut self, scene: usize, words: &str) -> Result<Entry> {
        let asked = contenders::parse("contender", words)?;
        let (setup, load_seconds) = self.setup(scene, asked.tracker)?;
        let budget = Budget { samples_per_pixel: Some(1), time: None };
        let settings = estimator::settings(&asked, &setup, 0, budget)?;
        if settings.options.strategies == Strategies::NONE {
            let (expected, found) = ("an integrator that estimates radiance", "fog, which is a preview");
            return Err(Error::new("--integrator", expected, found, "choose bdpt, pt or lt"));
        }
        let still = setup.scene.media.iter().all(|medium| medium.heterogeneous().is_none());
        let idle = (asked.tracker.is_some() && still).then(|| IDLE_TRACKER.to_owned());
        Ok(Entry { setup, settings, load_seconds, notes: idle.into_iter().collect() })
    }
}

/// Said of a contender whose name promises a difference that there is not.
const IDLE_TRACKER: &str = "its tracker has no effect: no medium of this scene varies";

/// The command, as a shell takes it.
fn command() -> String {
    let words = std::env::args_os().skip(1).map(|word| quoted(&word.to_string_lossy()));
    std::iter::once("tyndall".to_owned()).chain(words).collect::<Vec<_>>().join(" ")
}

/// `word` in quotes, unless no shell can find anything in it that means more than itself.
fn quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_=+,./:@%".contains(c);
    match !word.is_empty() && word.chars().all(is_plain) {
        true => word.to_owned(),
        false => format!("'{}'", word.replace('\'', "'\\''")),
    }
}

fn machine(threads: usize) -> String {
    let system = System::new_with_specifics(RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing()));
    let brand = system.cpus().first().map_or("", |cpu| cpu.brand().trim());
    let brand = if brand.is_empty() { std::env::consts::ARCH } else { brand };
    format!("{brand}, {threads} threads")
}

/// A progress bar over the whole study. Where nobody looks at a terminal, a line now and then.
struct Bar {
    bar: ProgressBar,
    is_hidden: bool,
    tenths: u64,
}

/// Steps of the bar.
const STEPS: f64 = 1e6;

impl Bar {
    fn new() -> Self {
        let bar = ProgressBar::new(STEPS as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  {eta} left") {
            bar.set_style(style);
        }
        let is_hidden = bar.is_hidden();
        Self { bar, is_hidden, tenths: 0 }
    }

    fn tell(&mut self, progress: &Progress) {
        let Progress { share, doing, is_old } = progress;
        self.bar.set_message(doing.clone());
        self.bar.set_position((share * STEPS) as u64);
        if *is_old {
            self.bar.reset_eta();
        }
        let tenths = (share * 10.0) as u64;
        if self.is_hidden && tenths > self.tenths {
            self.tenths = tenths;
            complain(&format!("{} % done: {doing}", 10 * tenths));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_that_mean_more_to_a_shell_are_quoted() {
        for (word, expected) in [
            ("a/b-c_d.json", "a/b-c_d.json"),
            ("hit+join,x=1", "hit+join,x=1"),
            ("", "''"),
            ("~", "'~'"),
            ("a b", "'a b'"),
            ("it's", "'it'\\''s'"),
            ("`ls`#{a}", "'`ls`#{a}'"),
            ("é", "'é'"),
        ] {
            assert_eq!(quoted(word), expected);
        }
    }
}
