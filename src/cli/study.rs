//! `tyndall study`: error against run time.

use super::{
    console::{self, Answer, complain, say},
    contenders, media,
    outputs::NUMBERS,
    parsers::{Size, confidence, definition, duration, positive_u32, size, threads as threads_of},
    plan::Plan,
    provenance,
    scene::threads,
};
use crate::{
    analysis::study::{
        contender::{Contender, Entry, Head, How, Renderer},
        external::{self, External},
        page,
        question::{Effort, Question, ReferenceFile, SceneQuestion, Wanted},
        reference,
        run::{self, Progress, Signature},
        table,
    },
    description::Object,
    error::{Error, Result},
    format,
    format::Sources,
    passes::{Settings, budget::Budget},
    scene::build::{self, Setup},
    settings::Overrides,
    transport::Algorithm,
};
use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use std::{
    num::NonZeroUsize,
    path::PathBuf,
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

    /// Folder to write to; the same command continues a study in it
    #[arg(short, long, value_name = "FOLDER")]
    pub output: PathBuf,

    /// Values to compare of an option of `tyndall render` about path sampling: integrator=bdpt,pt, max-depth=2,4,8;
    /// of a switch: on,off; may be repeated [default: integrator=bdpt,pt if no other contender is given]
    ///
    /// Every combination of values is one contender. Parts of a value are joined by "+": strategies=hit+next-event,hit+join.
    /// Strategies are those of bdpt unless the integrator is given; heuristics are all compared with the profile "everything".
    #[arg(long, value_name = "OPTION=LIST", allow_hyphen_values = true)]
    pub vary: Vec<String>,

    /// Add a contender with options of `tyndall render`: "joins: --integrator bdpt --strategies hit,join"; may be
    /// repeated
    #[arg(long = "contender", value_name = "NAME: OPTIONS", allow_hyphen_values = true)]
    pub contenders: Vec<String>,

    /// Add another renderer as a contender by its command line: "mitsuba: render.py {scene} --seed {seed} --spp
    /// {spp} -o {out}"; may be repeated
    ///
    /// It is run for each budget, or for each seed with {budgets} (such as 16,32,64) and {folder} (where to write 16.exr,
    /// 32.exr, 64.exr) in place of {spp} and {out}. Further placeholders: {definitions} (-D name=value for each parameter),
    /// {size}, {width}, {height}, {threads}. It reports the seconds of rendering, without starting, loading and compiling,
    /// on a line for each image: {"spp": 16, "seconds": 1.5, "load_seconds": 0.2}. It may add "cpu_seconds", and "plan", a line
    /// of text that says what it does. validation/contender.py is one.
    #[arg(long = "external", value_name = "NAME: COMMAND", allow_hyphen_values = true)]
    pub externals: Vec<String>,

    /// Number of renders of each contender, each with its own seed; intervals are computed from these
    #[arg(long, value_name = "N", default_value_t = 8, value_parser = clap::value_parser!(u32).range(2..=100_000))]
    pub seeds: u32,

    /// Number of budgets at which a render is measured, each twice the previous one
    #[arg(long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=30))]
    pub doublings: u32,

    /// Samples per pixel of the largest budget, in place of a time
    #[arg(long, value_name = "N", value_parser = positive_u32, conflicts_with = "seconds", allow_negative_numbers = true)]
    pub spp: Option<u32>,

    /// Time of the largest budget, as --time-limit of `tyndall render` [default: 8]
    ///
    /// A pilot run converts it to samples per pixel, once for each contender and scene; the numbers are in
    /// runs/plan.json.
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub seconds: Option<Duration>,

    /// The first seed
    #[arg(long, value_name = "N", default_value_t = 0, allow_negative_numbers = true)]
    pub seed: u64,

    /// Threads to render with [default: one per processor]
    #[arg(long, value_name = "N", value_parser = threads_of, allow_negative_numbers = true)]
    pub threads: Option<NonZeroUsize>,

    /// Set the parameter $name of all scenes instead of its default; may be repeated
    #[arg(short = 'D', value_name = "name=value", value_parser = definition)]
    pub definitions: Vec<(String, String)>,

    /// Size of the images in pixels, where the film has no crop window [default: the scene's film]
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<Size>,

    /// Confidence level of every interval, from 0.5 to 0.9999
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = confidence, allow_negative_numbers = true)]
    pub confidence: f64,

    /// Reference image (.exr, .pfm), one for each scene, in the order of the scenes [default: render one]
    #[arg(long = "reference", value_name = "FILE", conflicts_with_all = ["by", "reference_seconds", "reference_spp"])]
    pub references: Vec<PathBuf>,

    /// relMSE of the --reference itself, one for each [default: unknown]
    #[arg(long = "reference-error", value_name = "RELMSE", value_parser = error, requires = "references",
          allow_negative_numbers = true)]
    pub reference_errors: Vec<f64>,

    /// Renderer of the reference: options of `tyndall render`, such as "--integrator bdpt", or the name of a
    /// contender; repeat to average several [default: bdpt or pt, whichever is not a contender, if it covers the
    /// scene and is not much noisier, otherwise a contender with other seeds; and the first external contender]
    #[arg(long = "reference-by", value_name = "OPTIONS", allow_hyphen_values = true)]
    pub by: Vec<String>,

    /// Time to render each reference [default: four times that of a contender's largest budgets]
    #[arg(long, value_name = "TIME", value_parser = duration, allow_negative_numbers = true)]
    pub reference_seconds: Option<Duration>,

    /// Samples per pixel of each reference, in place of a time
    #[arg(long, value_name = "N", value_parser = positive_u32, conflicts_with = "reference_seconds",
          allow_negative_numbers = true)]
    pub reference_spp: Option<u32>,

    /// Discard an earlier study in FOLDER
    #[arg(long)]
    pub restart: bool,

    /// How the result is given, which is that of study.json.
    #[command(flatten)]
    pub answer: Answer,
}

/// Time of the largest budget (s).
const SECONDS: f64 = 8.0;

fn error(text: &str) -> std::result::Result<f64, String> {
    let error = text.parse().ok().filter(|error: &f64| error.is_finite() && *error >= 0.0);
    error.ok_or_else(|| "expected a relMSE of 0 or more, such as 1e-4".to_owned())
}

/// Runs the command.
pub(super) fn run(arguments: &Study) -> Result<()> {
    check_files(&arguments.scenes)?;
    let contenders = contenders::all(arguments)?;
    let pool = threads(arguments.threads)?;
    let question = question(arguments, contenders, pool.current_num_threads())?;
    let mut stage = Stage::new(arguments, pool.current_num_threads());
    check(&mut stage, &question)?;
    arguments.answer.check()?;
    let signature = Signature {
        command: command(),
        machine: machine(pool.current_num_threads()),
        confidence: arguments.confidence,
    };
    let mut bar = Bar::new();
    let enter = &mut |scene: usize, how: &How| stage.enter(scene, how);
    let show = &mut |progress: &Progress| bar.show(progress);
    let outcome =
        pool.install(|| run::run(&arguments.output, arguments.restart, &question, &signature, enter, show));
    bar.bar.finish_and_clear();
    let outcome = outcome?;
    say(table::text(&outcome).trim_end());
    let page = page::write(&arguments.output)?;
    say(&format!(
        "{} shows the result; the numbers and images are next to it: study.json, study.csv, images",
        page.display()
    ));
    arguments.answer.give(&serde_json::json!(outcome))
}

/// Scenes are read several times, and again when the study is continued.
fn check_files(scenes: &[PathBuf]) -> Result<()> {
    match scenes.iter().any(|scene| scene.as_os_str() == "-") {
        false => Ok(()),
        true => {
            Err(Error::new("SCENE", "scene files", "- (standard input)", "save the scene to a file first"))
        }
    }
}

fn question(arguments: &Study, contenders: Vec<Contender>, threads: usize) -> Result<Question> {
    let names = contenders::scene_names(&arguments.scenes);
    let scene = |(name, file): (String, &PathBuf)| {
        Ok(SceneQuestion {
            name,
            fingerprint: fingerprint_of(&format::sources(file, &arguments.definitions, None)?)?,
        })
    };
    let effort = match (arguments.spp, arguments.seconds) {
        (Some(spp), _) => Effort::Samples(u64::from(spp)),
        (None, seconds) => Effort::Seconds(seconds.map_or(SECONDS, |seconds| seconds.as_secs_f64())),
    };
    Ok(Question {
        program: provenance::program(),
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

/// The largest budget, by which pilots judge: a render of its own has the same.
fn largest(arguments: &Study) -> Budget {
    let seconds = || arguments.seconds.unwrap_or(Duration::from_secs_f64(SECONDS));
    let (samples_per_pixel, time) = (arguments.spp.map(u64::from), arguments.spp.is_none().then(seconds));
    Budget { samples_per_pixel, time, ..Budget::ENDLESS }
}

/// Of all that a scene is read from.
fn fingerprint_of(sources: &Sources) -> Result<String> {
    let all: Vec<String> = sources.fingerprints()?.into_iter().map(|(_, fingerprint)| fingerprint).collect();
    Ok(format::fingerprint(all.concat().as_bytes()))
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
            let fingerprint = format::file_fingerprint(path)?;
            let own_relmse = errors.get(index).copied();
            Ok(ReferenceFile { file: path.display().to_string(), fingerprint, own_relmse })
        };
        return Ok(Wanted::Files(files.iter().enumerate().map(file).collect::<Result<_>>()?));
    }
    let effort = match (arguments.reference_spp, arguments.reference_seconds) {
        (Some(spp), _) => Some(Effort::Samples(u64::from(spp))),
        (None, seconds) => seconds.map(|seconds| Effort::Seconds(seconds.as_secs_f64())),
    };
    let named = |text: &String| match contenders.iter().find(|contender| contender.name == *text) {
        Some(contender) => Ok(contender.how.clone()),
        None => contenders::parse("--reference-by", text).map(|_| How::Options(text.clone())),
    };
    let others = match arguments.by.is_empty() {
        true => contenders::referees(contenders)?,
        false => arguments.by.iter().map(named).collect::<Result<_>>()?,
    };
    Ok(Wanted::Made { others, is_given: !arguments.by.is_empty(), effort })
}

/// Loads every scene once before anything is rendered: what is wrong with the last one is said now, not in an hour.
fn check(stage: &mut Stage<'_>, question: &Question) -> Result<()> {
    for scene in 0..question.scenes.len() {
        let setup = stage.load(scene)?;
        setup.film.check_memory(NUMBERS)?;
        for warning in &setup.warnings {
            complain(&format!("warning: {warning}"));
        }
        if let Wanted::Files(files) = &question.reference {
            reference::read(&files[scene], setup.film.width as usize, setup.film.height as usize)?;
        }
        if let Wanted::Made { others, is_given: true, .. } = &question.reference {
            others.iter().try_for_each(|how| stage.enter(scene, how).map(drop))?;
        }
    }
    Ok(())
}

/// The scene at work, as it was built for contenders that override different things.
struct Stage<'a> {
    arguments: &'a Study,
    threads: usize,
    scene: Option<(usize, Object, f64)>,
    setups: Vec<(Overrides, Arc<Setup>, f64)>,
}

impl<'a> Stage<'a> {
    fn new(arguments: &'a Study, threads: usize) -> Self {
        Self { arguments, threads, scene: None, setups: Vec::new() }
    }

    /// The scene as its file says.
    fn load(&mut self, scene: usize) -> Result<Arc<Setup>> {
        let size = self.arguments.size.map(Into::into);
        Ok(self.setup(scene, Overrides { size, ..Overrides::default() })?.0)
    }

    /// The scene with `overrides`, and the time that reading and building it took (s).
    fn setup(&mut self, scene: usize, overrides: Overrides) -> Result<(Arc<Setup>, f64)> {
        let started = Instant::now();
        let (root, reading) = match self.scene.take() {
            Some((index, root, reading)) if index == scene => (root, reading),
            _ => {
                self.setups.clear();
                let root = format::read(&self.arguments.scenes[scene], &self.arguments.definitions)?;
                (root, started.elapsed().as_secs_f64())
            }
        };
        let (_, root, _) = self.scene.insert((scene, root, reading));
        if let Some((_, setup, seconds)) = self.setups.iter().find(|(other, ..)| *other == overrides) {
            return Ok((setup.clone(), *seconds));
        }
        let started = Instant::now();
        let setup = Arc::new(build::build(root, overrides)?);
        let seconds = reading + started.elapsed().as_secs_f64();
        self.setups.push((overrides, setup.clone(), seconds));
        Ok((setup, seconds))
    }

    /// A contender ready to render.
    fn enter(&mut self, scene: usize, how: &How) -> Result<Entry> {
        match how {
            How::Options(words) => self.own(scene, words),
            How::Command(command) => self.external(scene, command),
        }
    }

    fn external(&mut self, scene: usize, command: &str) -> Result<Entry> {
        let setup = self.load(scene)?;
        let size = (setup.film.width as usize, setup.film.height as usize);
        let words = external::words("--external", command)?;
        let Study { scenes, definitions, .. } = self.arguments;
        let external = External::new(&words, &scenes[scene], definitions, size, self.threads)?;
        Ok(Entry { setup, renderer: Renderer::External(external), notes: Vec::new() })
    }

    fn own(&mut self, scene: usize, words: &str) -> Result<Entry> {
        let requested = contenders::parse("contender", words)?;
        let overrides = requested.overrides(self.arguments.size);
        let (setup, load_seconds) = self.setup(scene, overrides)?;
        let (settings, head) = Head::of(&setup.scene, || {
            let started = Instant::now();
            let (settings, chosen) = requested.chosen(&setup, 0, largest(self.arguments))?;
            let budget = Budget { spent: started.elapsed(), ..settings.budget };
            let settings = Settings { budget, ..settings };
            Ok((settings, Plan::new(&setup, settings, chosen, None).words()))
        })?;
        if settings.options.algorithm == Algorithm::Fog {
            let (expected, found) = ("an integrator that estimates radiance", "fog, which is a preview");
            return Err(Error::new("--integrator", expected, found, "choose bdpt, pt or lt"));
        }
        // The name of a contender that is no other promises a difference that does not exist.
        let notes = media::idle(&overrides, &setup.scene).into_iter().collect();
        Ok(Entry { setup, renderer: Renderer::Own { settings, load_seconds, head }, notes })
    }
}

/// The command, as a shell takes it.
fn command() -> String {
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    let all = || std::iter::once("tyndall").chain(words.iter().map(String::as_str));
    shlex::try_join(all()).unwrap_or_else(|_| all().collect::<Vec<_>>().join(" "))
}

fn machine(threads: usize) -> String {
    let system = System::new_with_specifics(RefreshKind::nothing().with_cpu(CpuRefreshKind::nothing()));
    let brand = system.cpus().first().map_or("", |cpu| cpu.brand().trim());
    let brand = if brand.is_empty() { std::env::consts::ARCH } else { brand };
    format!("{brand}, {threads} threads")
}

/// A progress bar over the whole study; without a terminal, a line from time to time.
struct Bar {
    bar: ProgressBar,
    is_hidden: bool,
    tenths: u64,
}

/// Steps of the bar.
const STEPS: f64 = 1e6;

impl Bar {
    fn new() -> Self {
        let bar = console::bar(STEPS as u64);
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {percent:>3} %  {msg}  {eta} left") {
            bar.set_style(style);
        }
        let is_hidden = bar.is_hidden();
        Self { bar, is_hidden, tenths: 0 }
    }

    fn show(&mut self, progress: &Progress) {
        let Progress { share, doing, is_old } = progress;
        self.bar.set_message(doing.clone());
        self.bar.set_position((share * STEPS) as u64);
        console::update(*share >= 1.0, || serde_json::json!({ "done": share, "doing": doing }));
        if *is_old {
            self.bar.reset_eta();
        }
        let tenths = (share * 10.0) as u64;
        if self.is_hidden && tenths > self.tenths {
            self.tenths = tenths;
            console::announce(&format!("{} % done: {doing}", 10 * tenths));
        }
    }
}
