//! Contenders of a study from words. Options that say how `tyndall render` makes paths can be one, and can be an axis.

use super::{depth::MaxDepth, estimator::Estimator, study::Study};
use crate::{
    analysis::study::{
        contender::{Contender, How, slug},
        external,
    },
    error::{Error, Result},
};
use clap::{CommandFactory, Parser};

/// The options of `tyndall render` that make a contender, alone.
#[derive(Debug, Parser)]
#[command(no_binary_name = true, disable_help_flag = true, disable_version_flag = true)]
struct Words {
    #[command(flatten)]
    estimator: Estimator,
}

/// What `words` request; `place` is where they are.
pub(super) fn parse(place: &str, words: &str) -> Result<Estimator> {
    let parsed = Words::try_parse_from(words.split_whitespace());
    parsed.map(|words| words.estimator).map_err(|error| {
        let text = error.to_string();
        let reported =
            text.split("\n\nUsage").next().unwrap_or_default().trim_start_matches("error: ").trim();
        let expected = "options of tyndall render about path sampling";
        Error::new(place, expected, reported.replace('\n', " "), "see tyndall render --help")
    })
}

/// All contenders of the command line: the explicit ones, then the product of the axes.
pub(super) fn all(arguments: &Study) -> Result<Vec<Contender>> {
    let mut contenders = Vec::new();
    for text in &arguments.contenders {
        let (name, words) = named("--contender", text, "joins: --integrator bdpt --strategies hit,join")?;
        let words = words.split_whitespace().collect::<Vec<_>>().join(" ");
        contenders.push(Contender { name, how: How::Options(words) });
    }
    let is_alone = contenders.is_empty();
    for text in &arguments.externals {
        let (name, command) =
            named("--external", text, "other: render.py {scene} --seed {seed} --spp {spp} -o {out}")?;
        external::words("--external", &command)?;
        contenders.push(Contender { name, how: How::Command(command) });
    }
    let axes = axes(arguments)?;
    if !axes.is_empty() {
        contenders.extend(product(&axes));
    } else if is_alone {
        contenders.extend(product(&[Axis::of("integrator=bdpt,pt")?]));
    }
    for Contender { name, how } in &contenders {
        if let How::Options(words) = how {
            parse(name, words)?;
        }
    }
    let mut slugs: Vec<String> = contenders.iter().map(Contender::slug).collect();
    slugs.sort();
    match slugs.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(contenders),
        Some(pair) => {
            let found = format!("\"{}\" twice", pair[0]);
            Err(Error::new("--contender", "names that make different file names", found, "rename one"))
        }
    }
}

/// The parts of "NAME: REST", which `flag` was given.
fn named(flag: &str, text: &str, example: &str) -> Result<(String, String)> {
    let (name, rest) = text.split_once(':').unwrap_or_default();
    if name.trim().is_empty() {
        let expected = if flag == "--external" { "NAME: COMMAND" } else { "NAME: OPTIONS" };
        let remedy = format!("write, for example, {flag} \"{example}\"");
        return Err(Error::new(flag, expected, format!("\"{text}\""), remedy));
    }
    Ok((name.trim().to_owned(), rest.trim().to_owned()))
}

/// An option and the values that it takes in turn.
struct Axis {
    /// Per value: how it is shown, and the words that set it.
    values: Vec<(String, String)>,
}

/// Options whose values tell by themselves what they are.
const PLAIN: [&str; 5] = ["integrator", "strategies", "tracker", "heuristic", "sampler"];

/// Every axis of the command line.
fn axes(arguments: &Study) -> Result<Vec<Axis>> {
    let mut axes: Vec<Axis> = arguments.vary.iter().map(|text| Axis::of(text)).collect::<Result<_>>()?;
    let given = || arguments.vary.iter().map(|text| text.trim_start_matches('-'));
    let varies = |option: &str| given().find(|text| text.split('=').next() == Some(option));
    if varies("strategies").is_some() && varies("integrator").is_none() {
        // All strategies are those of bdpt; the scene's own integrator may have fewer.
        axes.insert(0, Axis { values: vec![(String::new(), "--integrator bdpt".to_owned())] });
    }
    if varies("heuristic").is_some_and(|text| text != "heuristic=balance") {
        // The others are compiled for this profile only: times are those of heuristics, not of profiles.
        axes.push(Axis { values: vec![(String::new(), "--profile everything".to_owned())] });
    }
    Ok(axes)
}

impl Axis {
    /// The axis of "OPTION=LIST". Where the option is a switch, its values are "on" and "off"; "off" is passed on, so that the
    /// scene cannot say otherwise.
    fn of(text: &str) -> Result<Self> {
        let (option, values) = text.split_once('=').unwrap_or((text, ""));
        let option = option.trim_start_matches('-');
        let command = Words::command();
        let all = || command.get_arguments().filter_map(|argument| argument.get_long());
        let Some(argument) = command.get_arguments().find(|argument| argument.get_long() == Some(option))
        else {
            let names = all().collect::<Vec<_>>().join(", ");
            let remedy = "write, for example, --vary max-depth=2,4,8";
            return Err(Error::new("--vary", format!("one of {names}"), format!("\"{option}\""), remedy));
        };
        let is_switch = !argument.get_action().takes_values();
        let words = |value: &str| match (is_switch, value) {
            (false, "") => Err("no value".to_owned()),
            (false, value) => Ok(format!("--{option} {}", value.replace('+', ","))),
            (true, "on") => Ok(format!("--{option}")),
            (true, "off") => Ok(format!("--no-{option}")),
            (true, value) => Err(format!("\"{value}\"")),
        };
        let shown = |value: &str| {
            if PLAIN.contains(&option) { value.to_owned() } else { format!("{option}={value}") }
        };
        let pair = |value: &str| Ok((shown(value), words(value)?));
        let values =
            values.split(',').map(pair).collect::<std::result::Result<_, String>>().map_err(|found| {
                let expected = if is_switch { "on, off, or both" } else { "values, separated by commas" };
                Error::new(format!("--vary {option}"), expected, found, "see tyndall study --help")
            })?;
        Ok(Self { values })
    }
}

/// All combinations, the last axis varying fastest.
fn product(axes: &[Axis]) -> Vec<Contender> {
    let joined = |a: &str, b: &str| format!("{a} {b}").trim().to_owned();
    let all = axes.iter().fold(vec![(String::new(), String::new())], |contenders, axis| {
        let with = |(name, words): &(String, String)| {
            let both = |(shown, more): &(String, String)| (joined(name, shown), joined(words, more));
            axis.values.iter().map(both).collect::<Vec<_>>()
        };
        contenders.iter().flat_map(with).collect()
    });
    all.into_iter().map(|(name, words)| Contender { name, how: How::Options(words) }).collect()
}

/// Renderers that may make a reference, best first: with every bound on the depth of paths that one of `contenders`
/// has, with unbiased flights, and with the light that they all agree on. Light tracing is not among them: what it
/// rarely finds makes a bad reference.
pub(super) fn referees(contenders: &[Contender]) -> Result<Vec<How>> {
    let mut requested = Vec::new();
    for Contender { name, how } in contenders {
        if let How::Options(words) = how {
            requested.push(parse(name, words)?);
        }
    }
    let light = same_light(&requested);
    let mut depths: Vec<_> = requested.iter().map(|estimator| estimator.max_depth).collect();
    if depths.is_empty() {
        depths.push(None);
    }
    let mut referees = Vec::new();
    // All strategies, whatever a pilot finds worth its time: light that contenders miss is not to be missed here.
    for name in ["bdpt --strategies hit,next-event,join,lens", "pt"] {
        for depth in &depths {
            let depth = match depth {
                None => String::new(),
                Some(MaxDepth::Unbounded) => " --max-depth -1".to_owned(),
                Some(MaxDepth::Edges(edges)) => format!(" --max-depth {edges}"),
            };
            let how = How::Options(format!("--integrator {name} --tracker auto{light}{depth}"));
            if !referees.contains(&how) {
                referees.push(how);
            }
        }
    }
    Ok(referees)
}

/// Options that decide which light the image has, besides its depth, if all of `requested` want the same; else the
/// scene decides.
fn same_light(requested: &[Estimator]) -> String {
    let words = |estimator: &Estimator| {
        let scattering =
            estimator.media.scattering.map(|scattering| format!(" --scattering {}", scattering.name()));
        let switches = [
            (estimator.hide_emitters, " --hide-emitters"),
            (estimator.no_hide_emitters, " --no-hide-emitters"),
        ];
        let switch = switches.into_iter().find_map(|(is_on, words)| is_on.then_some(words));
        let least = estimator.min_depth.map(|least| format!(" --min-depth {least}"));
        format!(
            "{}{}{}",
            scattering.unwrap_or_default(),
            switch.unwrap_or_default(),
            least.unwrap_or_default()
        )
    };
    let mut all = requested.iter().map(words);
    let first = all.next().unwrap_or_default();
    if all.all(|words| words == first) { first } else { String::new() }
}

/// Names for scenes out of their files' names, each its own.
pub(super) fn scene_names(files: &[std::path::PathBuf]) -> Vec<String> {
    let mut names: Vec<String> = Vec::new();
    for file in files {
        let stem = slug(&file.file_stem().unwrap_or_default().to_string_lossy());
        let numbered = |n: usize| if n == 1 { stem.clone() } else { format!("{stem}_{n}") };
        names.extend((1..).map(numbered).find(|name| !names.contains(name)));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::{
        super::arguments::{Arguments, Command},
        *,
    };

    fn contenders(options: &[&str]) -> Result<Vec<Contender>> {
        let words = ["tyndall", "study", "a.json", "-o", "out"].iter().chain(options);
        let Command::Study(study) = Arguments::try_parse_from(words).unwrap().command else { panic!() };
        all(&study)
    }

    fn words(how: How) -> String {
        match how {
            How::Options(words) | How::Command(words) => words,
        }
    }

    fn shown(options: &[&str]) -> Vec<String> {
        contenders(options).unwrap().into_iter().map(|c| format!("{}: {}", c.name, words(c.how))).collect()
    }

    #[test]
    fn axes_multiply() {
        assert_eq!(shown(&[]), ["bdpt: --integrator bdpt", "pt: --integrator pt"]);
        assert_eq!(
            shown(&["--vary", "strategies=hit+next-event,hit+join", "--vary", "tracker=exact,march"]),
            [
                "hit+next-event exact: --integrator bdpt --strategies hit,next-event --tracker exact",
                "hit+next-event march: --integrator bdpt --strategies hit,next-event --tracker march",
                "hit+join exact: --integrator bdpt --strategies hit,join --tracker exact",
                "hit+join march: --integrator bdpt --strategies hit,join --tracker march",
            ]
        );
        assert_eq!(
            shown(&["--contender", "mine:  --integrator lt --max-depth 3", "--vary", "max-depth=2,-1"]),
            [
                "mine: --integrator lt --max-depth 3",
                "max-depth=2: --max-depth 2",
                "max-depth=-1: --max-depth -1",
            ]
        );
    }

    #[test]
    fn other_renderers_come_first_and_compete_with_the_usual() {
        assert_eq!(
            shown(&["--external", "other: r {scene} {seed} {spp} {out}"]),
            ["other: r {scene} {seed} {spp} {out}", "bdpt: --integrator bdpt", "pt: --integrator pt"]
        );
    }

    #[test]
    fn heuristics_compete_on_one_profile() {
        assert_eq!(
            shown(&["--vary", "heuristic=balance,power", "--vary", "sampler=sobol"]),
            [
                "balance sobol: --heuristic balance --sampler sobol --profile everything",
                "power sobol: --heuristic power --sampler sobol --profile everything",
            ]
        );
        let dashed = shown(&["--vary", "--heuristic=power"]);
        assert_eq!(dashed, ["power: --heuristic power --profile everything"]);
    }

    #[test]
    fn nonsense_is_refused_with_a_hint() {
        for (options, hint) in [
            (["--contender", "--integrator pt"], "NAME: OPTIONS"),
            (["--contender", ": --integrator pt"], "NAME: OPTIONS"),
            (["--contender", "a: --integrator ptt"], "bdpt"),
            (["--external", "render.py"], "NAME: COMMAND"),
            (["--external", "a: render.py {scene}"], "{budgets} and {folder}"),
            (["--contender", "a: --spp 4"], "about path sampling"),
            (["--vary", "integrator=bdpt,bdpt"], "twice"),
            (["--vary", "integrator=bdpt,ptt"], "ptt"),
            (["--vary", "strategies=hit+jion"], "join"),
            (["--vary", "max-dept=2"], "max-depth"),
            (["--vary", "max-depth"], "values"),
            (["--vary", "max-depth=deep"], "number of edges"),
            (["--vary", "max-depth=2,,3"], "--vary max-depth: expected values"),
            (["--vary", "sampler=sobol,"], "--vary sampler: expected values"),
            (["--vary", "step=0.1,0"], "a length above 0"),
            (["--contender", "a: --step 0.1 --march-error 0.1"], "cannot be used with"),
            (["--contender", "a: --scattering once"], "multiple, single, none"),
            (["--vary", "forced-interaction=yes"], "on, off"),
        ] {
            let error = contenders(&options).unwrap_err().to_string();
            assert!(error.contains(hint), "{options:?}: {error}");
        }
    }

    #[test]
    fn references_may_be_as_deep_as_any_contender() {
        let depths = |options: &[&str]| {
            let all: Vec<String> =
                referees(&contenders(options).unwrap()).unwrap().into_iter().map(words).collect();
            let [bdpt, pt] = ["bdpt --strategies hit,next-event,join,lens", "pt"]
                .map(|name| format!("--integrator {name} --tracker auto"));
            let of =
                |start: &str| all.iter().filter_map(|words| words.strip_prefix(start)).collect::<Vec<_>>();
            assert_eq!(of(&bdpt), of(&pt));
            of(&bdpt).join(",")
        };
        assert_eq!(depths(&[]), "");
        assert_eq!(depths(&["--vary", "max-depth=2"]), " --max-depth 2");
        assert_eq!(depths(&["--vary", "max-depth=2,3,-1"]), " --max-depth 2, --max-depth 3, --max-depth -1");
        let unequal = ["--contender", "a: --max-depth 4", "--contender", "b: --integrator pt"];
        assert_eq!(depths(&unequal), " --max-depth 4,");
    }

    /// What single scattering leaves out is no error of a contender that is to leave it out.
    #[test]
    fn references_have_the_light_of_all_contenders() {
        let first = |options: &[&str]| words(referees(&contenders(options).unwrap()).unwrap().remove(1));
        let pt = "--integrator pt --tracker auto";
        let marched =
            ["--contender", "a: --scattering single --step 0.1", "--contender", "b: --scattering single"];
        assert_eq!(first(&marched), format!("{pt} --scattering single"));
        assert_eq!(first(&["--vary", "scattering=multiple,single"]), pt);
        assert_eq!(first(&["--vary", "hide-emitters=off"]), format!("{pt} --no-hide-emitters"));
        assert_eq!(first(&["--vary", "step=0.1,0.2"]), pt);
        assert_eq!(first(&["--vary", "min-depth=3"]), format!("{pt} --min-depth 3"));
        assert_eq!(first(&["--vary", "min-depth=2,3"]), pt);
    }

    #[test]
    fn scenes_of_one_name_are_told_apart() {
        assert_eq!(scene_names(&["a/x.xml".into(), "b/x.json".into(), "y.xml".into()]), ["x", "x_2", "y"]);
    }
}
