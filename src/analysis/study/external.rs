//! Other renderers as contenders: a command line that renders a scene to OpenEXR files and reports its times.
//!
//! The command is run with these words in it replaced (no shell is involved):
//!
//! | `{scene}` | the scene file, absolute |
//! | `{definitions}` | as a word of its own: `-D name=value` for each parameter of the study |
//! | `{size}`, `{width}`, `{height}` | of the image (pixels), such as 96x64 |
//! | `{threads}`, `{seed}` | threads to render with; a seed of 64 bits, of which no two may give the same image |
//! | `{spp}`, `{out}` | samples per pixel, and the file to write |
//! | `{budgets}`, `{folder}` | or all budgets, separated by commas, and a folder where each is to be written as `SPP.exr` |
//!
//! With `{spp}` it runs once for each budget. With `{budgets}` it runs once for each seed, so that starting and loading are
//! paid once, and may go on from each budget to the next one as this program does. On standard output it reports, on a line
//! for each image, `{"spp": 16, "seconds": 1.5}`: the time that rendering so many samples took, without starting, loading and
//! compiling, whose time may be reported as `"load_seconds"`. It may add `"cpu_seconds"`, the processor time of all its threads
//! for the same samples, and `"plan"`, what it does in a line of text. Other lines are ignored. A command with `{spp}` that reports
//! nothing is timed from outside. Exit codes other than 0 are errors, explained by the last line on standard error.

use super::unit::Seen;
use crate::{
    analysis::picture,
    error::{Error, Result},
    math::Spectrum,
    render::Snapshot,
};
use serde::Deserialize;
use std::{
    path::Path,
    process::{Command, Stdio},
    time::{Duration, Instant},
};

/// A command that renders one scene.
#[derive(Clone, Debug, PartialEq)]
pub struct External {
    words: Vec<String>,
    size: (usize, usize),
    is_at_once: bool,
}

/// Images at growing budgets, and what is known of their times.
pub struct Rendered {
    /// One a budget.
    pub seen: Vec<Seen>,
    /// Time of starting, loading and compiling (s), where it is reported.
    pub load_seconds: Option<f64>,
    /// The times are those of the whole command: none were reported.
    pub is_timed_outside: bool,
    /// What it did at the last budget, in a line, where it says.
    pub plan: Option<String>,
}

/// A line of the command's report.
#[derive(Deserialize)]
struct Report {
    spp: u64,
    seconds: f64,
    load_seconds: Option<f64>,
    cpu_seconds: Option<f64>,
    plan: Option<String>,
}

/// The words of a command line as a shell would split them, refused unless it renders what is requested.
pub fn words(place: &str, command: &str) -> Result<Vec<String>> {
    let refuse = |expected: &str, found: String| {
        let remedy =
            "write, for example, --external \"other: renderer {scene} --seed {seed} --spp {spp} -o {out}\"";
        Err(Error::new(place, expected, found, remedy))
    };
    let Some(words) = shlex::split(command).filter(|words| !words.is_empty()) else {
        return refuse("a command line whose quotes are closed", format!("\"{command}\""));
    };
    let has = |name: &str| command.contains(&format!("{{{name}}}"));
    let needed = [has("scene"), has("seed"), has("spp") != has("budgets"), has("out") == has("spp")];
    if needed.contains(&false) || has("folder") != has("budgets") {
        let expected = "{scene}, {seed}, and either {spp} and {out} or {budgets} and {folder}";
        return refuse(expected, format!("\"{command}\""));
    }
    Ok(words)
}

impl External {
    /// The command of `words` for a scene.
    pub fn new(
        words: &[String],
        scene: &Path,
        definitions: &[(String, String)],
        size: (usize, usize),
        threads: usize,
    ) -> Result<Self> {
        let scene = std::path::absolute(scene).map_err(|error| Error::io(scene, "find", &error))?;
        let (width, height) = size;
        let values = [
            ("{scene}", scene.display().to_string()),
            ("{size}", format!("{width}x{height}")),
            ("{width}", width.to_string()),
            ("{height}", height.to_string()),
            ("{threads}", threads.to_string()),
        ];
        let given =
            || definitions.iter().flat_map(|(name, value)| ["-D".to_owned(), format!("{name}={value}")]);
        let expanded = words.iter().flat_map(|word| match word.as_str() {
            "{definitions}" => given().collect(),
            word => vec![filled(word, &values)],
        });
        let is_at_once = words.iter().any(|word| word.contains("{budgets}"));
        Ok(Self { words: expanded.collect(), size, is_at_once })
    }

    /// Renders with `seed` at all `budgets` (samples per pixel), in growing order.
    pub fn render(&self, seed: u64, budgets: &[u64]) -> Result<Rendered> {
        let mut rendered =
            Rendered { seen: Vec::new(), load_seconds: None, is_timed_outside: false, plan: None };
        for budgets in budgets.chunks(if self.is_at_once { budgets.len().max(1) } else { 1 }) {
            self.run(seed, budgets, &mut rendered)?;
        }
        Ok(rendered)
    }

    fn run(&self, seed: u64, budgets: &[u64], rendered: &mut Rendered) -> Result<()> {
        let folder = tempfile::tempdir().map_err(|error| {
            let expected = "a temporary folder that can be made";
            Error::new("an external contender", expected, error.to_string(), "set TMPDIR to a folder")
        })?;
        let file = |spp: &u64| folder.path().join(format!("{spp}.exr"));
        let values = [
            ("{seed}", seed.to_string()),
            ("{spp}", budgets[0].to_string()),
            ("{budgets}", budgets.iter().map(u64::to_string).collect::<Vec<_>>().join(",")),
            ("{out}", file(&budgets[0]).display().to_string()),
            ("{folder}", folder.path().display().to_string()),
        ];
        let words: Vec<String> = self.words.iter().map(|word| filled(word, &values)).collect();
        let started = Instant::now();
        let reports = reports(&words)?;
        let whole = started.elapsed();
        for spp in budgets {
            let report = reports.iter().find(|report| report.spp == *spp);
            let elapsed = match report.map(|report| Duration::try_from_secs_f64(report.seconds)) {
                Some(Ok(time)) => time,
                None if !self.is_at_once => whole,
                _ => {
                    let expected =
                        format!("a line such as {{\"spp\": {spp}, \"seconds\": 1.5}} on standard output");
                    return Err(failed(&words, expected, "none".into()));
                }
            };
            rendered.load_seconds = rendered.load_seconds.or(report.and_then(|report| report.load_seconds));
            rendered.is_timed_outside |= report.is_none();
            let pixels = self.image(&file(spp), &words)?;
            let snapshot = Snapshot { pixels, samples_per_pixel: *spp, elapsed };
            let cpu_seconds = report.and_then(|report| report.cpu_seconds);
            let cpu_seconds = cpu_seconds.filter(|seconds| *seconds >= 0.0 && seconds.is_finite());
            rendered.plan = report.and_then(|report| report.plan.clone());
            rendered.seen.push(Seen { snapshot, cpu_seconds });
        }
        Ok(())
    }

    fn image(&self, path: &Path, words: &[String]) -> Result<Vec<Spectrum>> {
        let expected =
            |(width, height)| format!("an image of {width} x {height} pixels in {}", path.display());
        let image = picture::read(path).map_err(|error| failed(words, expected(self.size), error.found))?;
        match (image.width, image.height) {
            size if size == self.size => Ok(image.pixels),
            (width, height) => Err(failed(words, expected(self.size), format!("{width} x {height}"))),
        }
    }
}

fn filled(word: &str, values: &[(&str, String)]) -> String {
    values.iter().fold(word.to_owned(), |word, (name, value)| word.replace(name, value))
}

fn failed(words: &[String], expected: String, found: String) -> Error {
    let command = shlex::try_join(words.iter().map(String::as_str)).unwrap_or_else(|_| words.join(" "));
    Error::new(&words[0], expected, found, format!("run it by hand: {command}"))
}

/// Runs a command; what it reports.
fn reports(words: &[String]) -> Result<Vec<Report>> {
    let mut command = Command::new(&words[0]);
    let output = command.args(&words[1..]).stdin(Stdio::null()).output();
    let output =
        output.map_err(|error| failed(words, "a program that can be started".into(), error.to_string()))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let last = said.trim().lines().next_back().unwrap_or("nothing on standard error");
        return Err(failed(words, "a command that succeeds".into(), format!("{}: {last}", output.status)));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.lines().filter_map(|line| serde_json::from_str(line).ok()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_must_say_what_to_render_and_where_to() {
        for good in
            ["r {scene} {seed} {spp} {out}", "r '{scene} x' --s={seed} {budgets} {folder} {definitions}"]
        {
            assert!(words("--external", good).is_ok(), "{good}");
        }
        for (bad, hint) in [
            ("", "quotes"),
            ("r '{scene}", "quotes"),
            ("r {scene} {seed} {spp}", "{out}"),
            ("r {scene} {spp} {out}", "{seed}"),
            ("r {scene} {seed} {budgets} {out}", "{folder}"),
            ("r {scene} {seed} {spp} {out} {budgets} {folder}", "either"),
        ] {
            let error = words("--external", bad).unwrap_err().to_string();
            assert!(error.contains(hint) && error.contains("for example"), "{bad}: {error}");
        }
    }

    #[test]
    fn placeholders_are_replaced_word_by_word() {
        let words =
            words("--external", "r {definitions} '{scene}' {size} {threads} {seed} {spp} {out}").unwrap();
        let definitions = [("a b".to_owned(), "c d".to_owned())];
        let external = External::new(&words, Path::new("/x y.json"), &definitions, (4, 3), 2).unwrap();
        let expected = ["r", "-D", "a b=c d", "/x y.json", "4x3", "2", "{seed}", "{spp}", "{out}"];
        assert_eq!(external.words, expected);
    }
}
