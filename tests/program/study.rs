//! `tyndall study` as a user runs it: what it finds, what it says, and that it can be stopped at any moment.

use crate::common::pieces::*;
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    fs,
    path::{Path, PathBuf},
    process::{Command, Output, Stdio},
    thread,
    time::{Duration, Instant},
};
use tempfile::TempDir;
use tyndall::{
    analysis::picture::{self, Picture},
    math::{Spectrum, SpectrumExt},
};

/// A folder in which the program runs.
struct Desk {
    folder: TempDir,
}

impl Desk {
    /// With scenes in it, by the names of their files.
    fn new(scenes: &[(&str, Value)]) -> Self {
        let desk = Self { folder: TempDir::new().unwrap() };
        for (name, scene) in scenes {
            fs::write(desk.path(name), scene.to_string()).unwrap();
        }
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        command.current_dir(self.folder.path()).arg("study").args(words);
        command
    }

    fn run(&self, words: &[&str]) -> Output {
        self.command(words).output().unwrap()
    }

    /// Runs a study that succeeds; what it says.
    fn study(&self, words: &[&str]) -> String {
        let output = self.run(words);
        assert!(output.status.success(), "{words:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    }

    /// It ends with code 2, having said all of `hints`.
    fn refuses(&self, words: &[&str], hints: &[&str]) {
        let output = self.run(words);
        let reported = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {reported}");
        for hint in hints {
            assert!(reported.contains(hint), "{words:?}: no \"{hint}\" in: {reported}");
        }
        assert!(!reported.contains("panicked"), "{words:?}: {reported}");
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_slice(&fs::read(self.path(name)).unwrap()).unwrap()
    }

    fn pixels(&self, name: &str) -> Vec<Spectrum> {
        picture::read(&self.path(name)).unwrap().pixels
    }
}

fn foggy_room() -> Value {
    scene(&[
        ("sensor", camera([0.0, 0.0, 0.9], [0.0, 0.0, -1.0], 8)),
        ("fog", medium(1.0, 0.8, 0.3)),
        ("room", room(0.6, Some(named("fog")))),
        ("lamp", lamp_ball([0.2, 0.3, -0.3], 0.3, 2.0)),
    ])
}

/// All that is not time in an outcome.
fn timeless(outcome: &Value) -> Value {
    const TIMES: [&str; 7] =
        ["seconds", "cpu_seconds", "slope", "efficiency", "ratio", "load_seconds", "conditions"];
    match outcome {
        Value::Object(map) => {
            let kept = map.iter().filter(|(name, _)| !TIMES.contains(&name.as_str()));
            Value::Object(kept.map(|(name, value)| (name.clone(), timeless(value))).collect())
        }
        Value::Array(values) => values.iter().map(timeless).collect(),
        other => other.clone(),
    }
}

/// The rows of `study.csv` without their seconds.
fn timeless_rows(csv: &str) -> Vec<Vec<String>> {
    let is_time: Vec<bool> =
        csv.lines().next().unwrap().split(',').map(|name| name.contains("seconds")).collect();
    let fields = |line: &str| {
        let fields = line.split(',').enumerate().filter(|(i, _)| !is_time[*i]);
        fields.map(|(_, field)| field.to_owned()).collect()
    };
    csv.lines().map(fields).collect()
}

/// Every file below `folder`, by name.
fn files(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        match entry.path() {
            path if path.is_dir() => found.extend(files(&path)),
            path => drop(found.insert(path.clone(), fs::read(path).unwrap_or_default())),
        }
    }
    found
}

/// The end of a study, without times.
struct Harvest {
    outcome: Value,
    rows: Vec<Vec<String>>,
    plan: Value,
    images: Vec<(PathBuf, Vec<u8>)>,
}

fn harvest(desk: &Desk) -> Harvest {
    let relative = |path: PathBuf| path.strip_prefix(desk.folder.path()).unwrap().to_owned();
    let images = files(&desk.path("out/images"));
    Harvest {
        outcome: timeless(&desk.json("out/study.json")),
        rows: timeless_rows(&fs::read_to_string(desk.path("out/study.csv")).unwrap()),
        plan: desk.json("out/runs/plan.json"),
        images: images.into_iter().map(|(path, bytes)| (relative(path), bytes)).collect(),
    }
}

/// Starts the study and kills it a random while after it has written some more files; false if it ended before.
fn kill(desk: &Desk, words: &[&str], more: usize, pause: Duration) -> bool {
    let before = files(&desk.path("out")).len();
    let mut child = desk.command(words).stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let started = Instant::now();
    while files(&desk.path("out")).len() < before + more && child.try_wait().unwrap().is_none() {
        assert!(started.elapsed() < Duration::from_secs(120), "nothing is written");
        thread::sleep(Duration::from_millis(1));
    }
    thread::sleep(pause);
    let is_killed = child.try_wait().unwrap().is_none();
    child.kill().unwrap();
    child.wait().unwrap();
    is_killed
}

#[test]
fn a_study_killed_at_random_moments_ends_with_the_same_numbers() {
    let words = [
        "room.json",
        "-o",
        "out",
        "--spp",
        "64",
        "--doublings",
        "4",
        "--seeds",
        "3",
        "--reference-spp",
        "640",
    ];
    let (whole, broken) =
        (Desk::new(&[("room.json", foggy_room())]), Desk::new(&[("room.json", foggy_room())]));
    whole.study(&words);
    let mut state = 12345u64;
    let mut random = |below: u64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) % below
    };
    let mut killed = 0;
    for round in 0..8 {
        // The first without a pause: however fast the machine, most of the study is still to come then.
        let (more, pause) = (1 + random(6) as usize, Duration::from_micros(round * random(3000)));
        killed += u32::from(kill(&broken, &words, more, pause));
    }
    assert!(killed >= 1, "it ended before it could be killed");
    broken.study(&words);
    let (expected, found) = (harvest(&whole), harvest(&broken));
    assert_eq!(found.outcome, expected.outcome);
    assert_eq!(found.rows, expected.rows);
    assert_eq!(found.plan, expected.plan);
    assert!(found.images == expected.images, "images differ");
    let left: Vec<PathBuf> = files(&broken.path("out")).into_keys().collect();
    assert!(!left.iter().any(|path| path.to_string_lossy().ends_with(".partial")), "{left:?}");
    // 2 contenders, 3 seeds, 4 budgets, and the names of the columns.
    assert_eq!(found.rows.len(), 25);
}

#[test]
fn a_finished_study_is_told_again_without_rendering() {
    // Under a name that the study's own files might have had.
    let desk = Desk::new(&[("lock.json", foggy_room())]);
    let words = ["lock.json", "-o", "out", "--spp", "4", "--seeds", "2", "--reference-spp", "32"];
    let reported = desk.study(&words);
    for part in
        ["lock, 8 x 8", "contender", "bdpt", "pt", "relMSE", "own relMSE", "CPU seconds", "study.json"]
    {
        assert!(reported.contains(part), "{part}: {reported}");
    }
    let outcome = desk.json("out/study.json");
    assert_eq!(desk.study(&words), reported);
    let mut again = desk.json("out/study.json");
    for contender in 0..2 {
        let load = "load_seconds";
        again["scenes"][0]["contenders"][contender][load] =
            outcome["scenes"][0]["contenders"][contender][load].clone();
    }
    assert_eq!(again, outcome, "the times are those of the first run");
    // Another confidence is another look at the same renders.
    desk.study(&[&words[..], &["--confidence", "0.5"]].concat());
    let narrow = &desk.json("out/study.json")["scenes"][0]["contenders"][0]["points"][0]["relmse"];
    let wide = &outcome["scenes"][0]["contenders"][0]["points"][0]["relmse"];
    assert_eq!(narrow["mean"], wide["mean"]);
    assert!(narrow["high"].as_f64() < wide["high"].as_f64());
}

/// What is looked at on the way is what a render of so many samples would have been.
#[test]
fn points_are_renders_and_measures_are_against_the_reference() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let made = ["room.json", "-o", "out", "--spp", "12", "--doublings", "3", "--seeds", "2", "--seed", "5"];
    desk.study(&[&made[..], &["--vary", "integrator=pt", "--reference-spp", "64"]].concat());
    for (index, spp) in ["3", "6", "12"].into_iter().enumerate() {
        let mut render = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        render.current_dir(desk.folder.path()).args(["render", "room.json", "-o", "a.exr", "--spp", spp]);
        assert!(render.args(["--integrator", "pt", "--seed", "5"]).output().unwrap().status.success());
        assert_eq!(desk.pixels(&format!("out/images/room/pt/{index}.exr")), desk.pixels("a.exr"), "{spp}");
    }
    let outcome = desk.json("out/study.json");
    let how = outcome["scenes"][0]["reference"]["how"].as_str().unwrap();
    assert!(how.contains("bdpt") && how.contains("not among the contenders"), "{how}");
    // By hand, for the first seed's last image.
    let (image, truth) = (desk.pixels("a.exr"), desk.pixels("out/images/room/reference.exr"));
    let pairs = image.iter().zip(&truth).flat_map(|(x, r)| x.to_array().into_iter().zip(r.to_array()));
    let luminance: f64 = truth.iter().map(|r| f64::from(r.luminance())).sum::<f64>() / truth.len() as f64;
    let floor = 0.01 * luminance.powi(2);
    let relative = pairs.map(|(x, r)| (f64::from(x - r)).powi(2) / (f64::from(r).powi(2) + floor));
    let relmse = relative.sum::<f64>() / 192.0;
    let csv = fs::read_to_string(desk.path("out/study.csv")).unwrap();
    let row: Vec<&str> = csv.lines().nth(3).unwrap().split(',').collect();
    assert_eq!(row[..4], ["room", "pt", "12", "5"]);
    assert!((row[6].parse::<f64>().unwrap() / relmse - 1.0).abs() < 1e-6, "{row:?} {relmse}");
    // The variance of two images is half the square of their difference.
    let other = desk.pixels("out/runs/room/turns/pt/6.exr");
    let variance = desk.pixels("out/images/room/pt/variance.exr");
    let half_square = 0.5 * (image[20].x - other[20].x).powi(2);
    assert!((variance[20].x - half_square).abs() <= 1e-5 * half_square, "{} {half_square}", variance[20].x);
    // The same image read from a file gives the same numbers.
    fs::copy(desk.path("out/images/room/reference.exr"), desk.path("truth.exr")).unwrap();
    fs::rename(desk.path("out"), desk.path("first")).unwrap();
    let file = ["--vary", "integrator=pt", "--reference", "truth.exr", "--reference-error", "0.5"];
    let reported = desk.study(&[&made[..], &file].concat());
    assert!(reported.contains("times the reference's own"), "{reported}");
    let again = fs::read_to_string(desk.path("out/study.csv")).unwrap();
    assert_eq!(timeless_rows(&again), timeless_rows(&csv));
    assert_eq!(desk.json("out/study.json")["scenes"][0]["reference"]["own_relmse"], json!(0.5));
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

/// A numeric log-log slope of the mean relMSE over samples per pixel: without times, it is the same every time.
fn slope_over_samples(contender: &Value) -> f64 {
    let points: Vec<(f64, f64)> = contender["points"]
        .as_array()
        .unwrap()
        .iter()
        .map(|point| (number(&point["samples"]).ln(), number(&point["relmse"]["mean"]).ln()))
        .collect();
    let n = points.len() as f64;
    let (x, y) = (points.iter().map(|p| p.0).sum::<f64>() / n, points.iter().map(|p| p.1).sum::<f64>() / n);
    points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>()
        / points.iter().map(|p| (p.0 - x).powi(2)).sum::<f64>()
}

#[test]
fn an_unbiased_contender_falls_with_slope_minus_one() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    // Samples that are spread evenly err even less.
    let words = ["--vary", "integrator=pt", "--vary", "sampler=independent", "--spp", "256"];
    let more = ["--doublings", "5", "--reference-spp", "8192"];
    desk.study(&[&["room.json", "-o", "out"], &words[..], &more[..]].concat());
    let contender = &desk.json("out/study.json")["scenes"][0]["contenders"][0];
    let slope = slope_over_samples(contender);
    assert!((slope + 1.0).abs() < 0.1, "{slope}");
    // Over time as well, though of renders of a millisecond no more is sure than that longer ones err less.
    let timed = number(&contender["slope"]["mean"]);
    assert!(timed.is_finite() && timed < 0.0, "{timed}");
    let last = &contender["points"][4]["difference"];
    assert!(number(&last["low"]) < 0.01 && number(&last["high"]) > -0.01, "{last}");
    assert_eq!(contender.get("notes"), None, "{}", contender["notes"]);
}

/// A cloud of thin layers, which steps much longer than they are cannot see.
fn layered() -> Value {
    let wave = json!({"type": "cosine", "w": {"type": "wave", "amplitude": 1, "vector": [0, 0, 2]}});
    let cloud = json!({"type": "heterogeneous", "sigma_t": wave, "albedo": 0.3, "scale": 2, "step": 1.9});
    scene(&[
        ("sensor", camera([0.0, 0.0, 4.0], [0.0, 0.0, 0.0], 8)),
        ("cloud", null_box([-1.0; 3], [1.0; 3], Some(cloud))),
        ("sky", sky(1.0)),
    ])
}

#[test]
fn bias_flattens_the_curve_and_shifts_the_mean() {
    let desk = Desk::new(&[("cloud.json", layered())]);
    let words = [
        "--vary",
        "tracker=closed_form,march,exact",
        "--vary",
        "sampler=independent",
        "--spp",
        "256",
        "--doublings",
        "5",
        "--reference-spp",
        "4096",
    ];
    let reported = desk.study(&[&["cloud.json", "-o", "out"], &words[..]].concat());
    let scene = &desk.json("out/study.json")["scenes"][0];
    let [fair, biased] = [0, 1].map(|i| &scene["contenders"][i]);
    assert_eq!(
        (fair["name"].as_str(), biased["name"].as_str()),
        (Some("closed_form independent"), Some("march independent"))
    );
    let (steep, flat) = (slope_over_samples(fair), slope_over_samples(biased));
    assert!((steep + 1.0).abs() < 0.1 && flat > -0.5, "{steep} {flat}");
    let difference = &biased["points"][4]["difference"];
    let (low, high) = (number(&difference["low"]), number(&difference["high"]));
    assert!(low * high > 0.0 && low.abs().min(high.abs()) > 0.01, "{difference}");
    for hint in [
        "differs by more than chance, in standard errors: march independent (",
        "exact independent cannot render it",
    ] {
        assert!(reported.contains(hint), "{hint}: {reported}");
    }
    assert!(notes(biased).contains("is biased by the step") && notes(biased).contains("its mean differs"));
    assert!(!notes(fair).contains("its mean differs"), "{reported}");
    assert_eq!(scene["contenders"].as_array().unwrap().len(), 2);
}

/// Of a contender.
fn notes(contender: &Value) -> String {
    let notes = contender["notes"].as_array().into_iter().flatten();
    notes.map(|note| note.as_str().unwrap()).collect::<Vec<_>>().join("\n")
}

/// LW96 sec. 5: the bias of each step against flights without any, whatever the scene's own.
#[test]
fn bias_is_drawn_over_the_step() {
    let desk = Desk::new(&[("cloud.json", layered())]);
    let words =
        "cloud.json -o out --vary step=1.9,0.1 --spp 128 --doublings 1 --seeds 4 --reference-spp 2048";
    desk.study(&words.split(' ').collect::<Vec<_>>());
    let scene = &desk.json("out/study.json")["scenes"][0];
    let how = scene["reference"]["how"].as_str().unwrap();
    assert!(how.contains("--tracker auto"), "{how}");
    let bias = |index: usize| number(&scene["contenders"][index]["points"][0]["difference"]["mean"]).abs();
    assert!(bias(0) > 5.0 * bias(1), "{} {}", bias(0), bias(1));
    let page = fs::read_to_string(desk.path("out/study.html")).unwrap();
    assert!(page.contains("<h3>Bias over step</h3>") && !page.contains("Bias over seed"));
}

/// A mirror under a lamp, which light subpaths cannot show.
fn mirror() -> Value {
    let mirror = with(floor(-0.5, 0.6, 0.5), &[("bsdf", json!({"type": "conductor"}))]);
    scene(&[
        ("sensor", camera([0.0, 0.5, 0.9], [0.0, -0.3, -0.5], 8)),
        ("mirror", mirror),
        ("room", room(0.6, None)),
        ("lamp", lamp_panel([0.0, 0.95, 0.0], 0.4, 2.0)),
    ])
}

#[test]
fn several_scenes_and_what_a_contender_cannot_show() {
    let desk = Desk::new(&[("room.json", foggy_room()), ("mirror.json", mirror())]);
    let words = [
        "--vary",
        "integrator=bdpt,lt",
        "--spp",
        "16",
        "--seeds",
        "6",
        "--reference-spp",
        "256",
        "--threads",
        "1",
    ];
    let more = ["--contender", "narrow, \"joined\": --strategies hit,join --max-depth 3"];
    let reported = desk.study(&[&["room.json", "mirror.json", "-o", "out"], &words[..], &more].concat());
    for hint in [
        "lt:\n  lt (lens",
        "  its variance is infinite",
        "  does not sample light of area emitters seen by way of smooth",
        "narrow, \"joined\":\n  bdpt (hit, join",
    ] {
        assert!(reported.contains(hint), "{hint}: {reported}");
    }
    let outcome = desk.json("out/study.json");
    let scenes = outcome["scenes"].as_array().unwrap();
    // The narrow one makes no reference, though it covers all that the mirror shows.
    let of = |name: &str| {
        let all = scenes.iter().flat_map(|scene| scene["contenders"].as_array().unwrap());
        all.filter(|contender| contender["name"] == name).map(notes).collect::<String>()
    };
    assert!(of("narrow, \"joined\"").contains("its mean") && !of("bdpt").contains("its mean"), "{reported}");
    assert_eq!(scenes.iter().map(|s| s["name"].as_str().unwrap()).collect::<Vec<_>>(), ["room", "mirror"]);
    assert_eq!(scenes[0]["contenders"][0]["name"], "narrow, \"joined\"");
    assert!(scenes[0]["contenders"][0].get("ratio").is_none());
    assert!(number(&scenes[0]["contenders"][1]["ratio"]["mean"]) > 0.0);
    assert!(outcome["machine"].as_str().unwrap().ends_with("1 threads"), "{}", outcome["machine"]);
    assert!(outcome["command"].as_str().unwrap().contains("'narrow, \"joined\": --strategies hit,join"));
    for scene in scenes {
        let images = scene["contenders"].as_array().unwrap().iter().flat_map(|contender| {
            let points = contender["points"].as_array().unwrap().iter().map(|point| &point["image"]);
            points.chain([&contender["variance"]])
        });
        for image in images.chain([&scene["reference"]["image"]]) {
            assert!(desk.path("out").join(image.as_str().unwrap()).is_file(), "{image}");
        }
    }
    let csv = fs::read_to_string(desk.path("out/study.csv")).unwrap();
    assert!(csv.contains("\nroom,\"narrow, \"\"joined\"\"\",1,0,"), "{csv}");
}

/// Whoever makes the reference: contenders of shorter paths miss light that it must have.
#[test]
fn the_reference_is_as_deep_as_the_deepest_contender() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let quick = ["--spp", "2", "--doublings", "1", "--seeds", "2", "--reference-spp", "16"];
    let shallow = "shallow: --integrator pt --max-depth 2";
    let rows: [(&[&str], &str); 4] = [
        (&["--vary", "integrator=pt", "--vary", "max-depth=2,7,3"], "--max-depth 7"),
        // Nobody is left but a contender.
        (
            &["--vary", "integrator=bdpt,pt", "--vary", "sampler=sobol", "--vary", "max-depth=2,7"],
            "--max-depth 7",
        ),
        (&["--contender", shallow, "--contender", "all: --integrator lt --max-depth -1"], "--max-depth -1"),
        (&["--contender", shallow, "--contender", "as the scene: --integrator pt"], "--tracker auto:"),
    ];
    for (index, (words, depth)) in rows.into_iter().enumerate() {
        let folder = format!("out{index}");
        desk.study(&[&["room.json", "-o", &folder], &quick[..], words].concat());
        let study = desk.json(&format!("{folder}/study.json"));
        let how = study["scenes"][0]["reference"]["how"].as_str().unwrap();
        assert!(how.contains(depth), "{words:?}: {how}");
    }
    let long = ["--vary", "integrator=pt", "--vary", "min-depth=2"];
    desk.study(&[&["room.json", "-o", "long"], &quick[..], &long].concat());
    let study = desk.json("long/study.json");
    let how = study["scenes"][0]["reference"]["how"].as_str().unwrap();
    assert!(how.contains("--min-depth 2"), "{how}");
    let by = ["--vary", "min-depth=0,2", "--reference-by", "--integrator pt --min-depth 3"];
    desk.refuses(
        &[&["room.json", "-o", "least"], &quick[..], &by].concat(),
        &["--reference-by", "all contenders, --min-depth 1", "found --min-depth 3"],
    );
    let by = ["--vary", "max-depth=2,7", "--reference-by", "--integrator pt --max-depth 3"];
    desk.refuses(
        &[&["room.json", "-o", "by"], &quick[..], &by].concat(),
        &[
            "--reference-by",
            "the deepest contender, --max-depth 7",
            "found --max-depth 3",
            "add --max-depth 7",
        ],
    );
}

/// The least of `study.csv`'s seconds over all seeds of a contender.
fn least_seconds(csv: &str, contender: &str) -> f64 {
    let rows = csv.lines().map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[1] == contender);
    rows.map(|row| row[4].parse::<f64>().unwrap()).fold(f64::INFINITY, f64::min)
}

/// What precedes the first sample is in every seed's seconds, however often it was done before: a pilot, and a guide that is
/// learnt, each of which takes far longer than a sample of each of 64 pixels.
#[test]
fn pilots_and_learning_are_among_the_seconds() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let words = "room.json -o out --spp 512 --doublings 9 --seeds 4 --reference-spp 16 --threads 1";
    let few = "room.json -o short --spp 1 --doublings 1 --seeds 4 --reference-spp 16 --threads 1";
    let all = "--strategies hit,next-event,join,lens";
    let contenders = ["bare: --integrator bdpt", "guided: --integrator bdpt --guide always"]
        .map(|words| format!("{words} {all}"));
    let [long, short] = [words, few].map(|words| {
        let contenders = contenders.iter().map(String::as_str).chain(["piloted: --integrator bdpt"]);
        let named = contenders.flat_map(|contender| ["--contender", contender]);
        words.split(' ').chain(named).collect::<Vec<_>>()
    });
    desk.study(&long);
    let csv = fs::read_to_string(desk.path("out/study.csv")).unwrap();
    let [bare, guided, piloted] = ["bare", "guided", "piloted"].map(|name| least_seconds(&csv, name));
    assert!(guided > 4.0 * bare && piloted > 4.0 * bare, "{bare} {guided} {piloted}");
    // A render of one sample has no pilot either.
    desk.study(&short);
    let csv = fs::read_to_string(desk.path("short/study.csv")).unwrap();
    let [bare, piloted] = ["bare", "piloted"].map(|name| least_seconds(&csv, name));
    assert!(piloted < 4.0 * bare, "{bare} {piloted}");
    let outcome = desk.json("out/study.json");
    let contenders = outcome["scenes"][0]["contenders"].as_array().unwrap();
    let [bare, guided, piloted] =
        [0, 1, 2].map(|index: usize| number(&contenders[index]["points"][0]["cpu_seconds"]["mean"]));
    assert!(bare > 0.0 && guided > 4.0 * bare && piloted > 4.0 * bare, "CPU: {bare} {guided} {piloted}");
    for contender in contenders {
        assert!(contender["chosen"]["what"].as_str().unwrap().starts_with("bdpt (hit"), "{contender}");
    }
}

/// When it was measured, and what the machine did before and after: of the first run, whoever continues it.
#[test]
fn a_study_knows_when_it_was_made() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let words = ["room.json", "-o", "out", "--spp", "1", "--seeds", "2", "--reference-spp", "2"];
    desk.study(&words);
    let conditions = desk.json("out/study.json")["conditions"].clone();
    let started = conditions["started"].as_str().unwrap();
    assert!(started.starts_with("20") && started.ends_with(" UTC"), "{started}");
    for load in ["load_before", "load_after"] {
        assert_eq!(conditions[load].as_array().map(Vec::len), cfg!(unix).then_some(3), "{conditions}");
    }
    let page = fs::read_to_string(desk.path("out/study.html")).unwrap();
    assert!(page.contains(started), "{started}");
    desk.study(&words);
    assert_eq!(desk.json("out/study.json")["conditions"], conditions);
}

/// A renderer of which only a command line is known: this program, seen from outside.
fn outside(words: &str) -> String {
    let (command, rest) = words.split_once(' ').unwrap();
    format!("{} {command} --integrator pt {rest}", env!("CARGO_BIN_EXE_tyndall"))
}

/// Another renderer takes its turns, is measured like any other and has its part in the reference.
#[test]
fn another_renderer_competes_by_its_command_line() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let words = [
        "--vary",
        "integrator=pt",
        "--spp",
        "16",
        "--doublings",
        "3",
        "--seeds",
        "3",
        "--reference-spp",
        "512",
    ];
    let once = outside(
        "render {scene} {definitions} -o {out} --size {size} --spp {spp} --seed {seed} --threads {threads}",
    );
    // One start for all budgets, which reports its times.
    fs::write(
        desk.path("script.sh"),
        format!(
            "for n in $(echo $1 | tr , ' '); do {} || exit 7; echo chatter; \
             echo '{{\"spp\": '$n', \"seconds\": '$n'e-3, \"load_seconds\": 0.25, \
             \"cpu_seconds\": '$n'e-2, \"plan\": \"by hand\"}}'; done",
            outside("render $3 -o $2/$n.exr --spp $n --seed $4 > /dev/null")
        ),
    )
    .unwrap();
    let many = "at once: sh script.sh {budgets} {folder} {scene} {seed}";
    let externals = ["--external", &format!("one by one: {once}"), "--external", many];
    let reported = desk.study(&[&["room.json", "-o", "out"], &words[..], &externals].concat());
    let outcome = desk.json("out/study.json");
    let scene = &outcome["scenes"][0];
    let names: Vec<&str> =
        scene["contenders"].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["one by one", "at once", "pt"]);
    // The same samples, so the same errors; times as reported, or else as seen from outside, which is told.
    let points = |contender: usize| scene["contenders"][contender]["points"].as_array().unwrap();
    for budget in 0..3 {
        let relmse = |contender: usize| number(&points(contender)[budget]["relmse"]["mean"]);
        assert!((relmse(0) / relmse(2) - 1.0).abs() < 1e-9 && (relmse(1) / relmse(2) - 1.0).abs() < 1e-9);
        let (seconds, samples) = (&points(1)[budget]["seconds"]["mean"], &points(1)[budget]["samples"]);
        assert!((1e3 * number(seconds) / number(samples) - 1.0).abs() < 1e-9, "{seconds} {samples}");
        let cpu = |contender: usize| points(contender)[budget]["cpu_seconds"]["mean"].as_f64();
        assert!(cpu(0).is_none() && (10.0 * number(seconds) / cpu(1).unwrap() - 1.0).abs() < 1e-9);
    }
    assert_eq!(scene["contenders"][1]["load_seconds"], json!(0.25));
    assert_eq!(scene["contenders"][1]["chosen"]["what"], "by hand");
    let outside = "its seconds are those of the whole command";
    assert!(
        notes(&scene["contenders"][0]).contains(outside) && !notes(&scene["contenders"][1]).contains(outside)
    );
    // Both renderers of the reference are contenders of the same samples' kind: only pt is made otherwise.
    let trust = "The means of its renderers are";
    assert!(reported.contains(trust) && scene["reference"]["apart"].is_number(), "{reported}");
    let how = scene["reference"]["how"].as_str().unwrap();
    assert!(
        how.starts_with("pooled by precision") && how.contains("one by one") && how.contains("bdpt"),
        "{how}"
    );
    // It goes on where it was, and nothing is rendered again.
    assert_eq!(desk.study(&[&["room.json", "-o", "out"], &words[..], &externals].concat()), reported);
    // A reference by those who are named.
    let by = ["--reference-by", "at once"];
    desk.study(&[&["room.json", "-o", "by"], &words[..], &externals, &by].concat());
    let how = desk.json("by/study.json")["scenes"][0]["reference"]["how"].as_str().unwrap().to_owned();
    assert!(how.starts_with("at once: 512 samples per pixel"), "{how}");
}

#[test]
fn what_another_renderer_cannot_do_is_said() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let words = [
        "room.json",
        "-o",
        "out",
        "--vary",
        "integrator=pt",
        "--spp",
        "2",
        "--seeds",
        "2",
        "--reference-spp",
        "4",
    ];
    for (command, hints) in [
        ("sh -c 'echo no fog here >&2; exit 3' {scene} {seed} {spp} {out}", "exit status: 3: no fog here"),
        ("no_such_program {scene} {seed} {spp} {out}", "a program that can be started"),
        ("true {scene} {seed} {spp} {out}", "an image of 8 x 8 pixels"),
        ("true {scene} {seed} {budgets} {folder}", "on standard output"),
        (&outside("render {scene} -o {out} --size 4x4 --spp {spp} --seed {seed}"), "found 4 x 4"),
    ] {
        let external = format!("other: {command}");
        let reported = desk.study(&[&words[..], &["--restart", "--external", &external]].concat());
        assert!(
            reported.contains("other cannot render it") && reported.contains(hints),
            "{command}: {reported}"
        );
        assert_eq!(desk.json("out/study.json")["scenes"][0]["contenders"].as_array().unwrap().len(), 1);
    }
    desk.refuses(&[&words[..], &["--external", "other: r {scene}"]].concat(), &["{budgets} and {folder}"]);
}

/// The same picture at any brightness is as noisy, and its errors are as large.
#[test]
fn nothing_depends_on_the_unit_of_radiance() {
    let found = [1e-3, 1.0, 1e3].map(|unit| {
        let mut room = foggy_room();
        room["lamp"]["emitter"]["radiance"] =
            json!({"type": "rgb", "value": [2.0 * unit, 2.0 * unit, 2.0 * unit]});
        let desk = Desk::new(&[("room.json", room)]);
        let mut render = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        render.current_dir(desk.folder.path()).args(["render", "room.json", "-o", "a.exr", "--spp", "32"]);
        assert!(render.args(["--report", "report.json"]).output().unwrap().status.success());
        desk.study(&["room.json", "-o", "out", "--spp", "4", "--seeds", "2", "--reference-spp", "64"]);
        let last = &desk.json("out/study.json")["scenes"][0]["contenders"][1]["points"][2];
        let of = |name: &str| number(&last[name]["mean"]);
        [
            number(&desk.json("report.json")["relative_error"]),
            of("relmse"),
            of("trimmed_relmse"),
            of("mape"),
            of("smape"),
        ]
    });
    for one in &found {
        for (one, middle) in one.iter().zip(&found[1]) {
            assert!((one / middle - 1.0).abs() < 1e-3, "{found:?}");
        }
    }
}

#[test]
fn a_time_is_turned_into_samples_once() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let words = ["room.json", "-o", "out", "--seconds", "0.2", "--seeds", "2", "--doublings", "3"];
    desk.study(&words);
    let plan = desk.json("out/runs/plan.json");
    let budgets: Vec<u64> =
        serde_json::from_value(plan["scenes"][0]["contenders"][0]["budgets"].clone()).unwrap();
    assert!(budgets[2] > 3 && budgets[1] == 2 * budgets[0] && budgets[2] == 2 * budgets[1], "{budgets:?}");
    let numbers = timeless(&desk.json("out/study.json"));
    fs::remove_file(desk.path("out/runs/room/turns/pt/1.json")).unwrap();
    desk.study(&words);
    assert_eq!(timeless(&desk.json("out/study.json")), numbers);
    assert_eq!(desk.json("out/runs/plan.json"), plan);
}

#[test]
fn a_scene_whose_image_changed_is_another_scene() {
    let sky = |value: f32| Picture::new(2, 3, vec![Spectrum::splat(value); 6]);
    let camera = camera([0.0; 3], [0.0, 0.0, 1.0], 4);
    let lit = scene(&[("sensor", camera), ("sky", json!({"type": "envmap", "filename": "sky.exr"}))]);
    let desk = Desk::new(&[("open.json", lit)]);
    let words = ["open.json", "-o", "out", "--spp", "2", "--seeds", "2", "--reference-spp", "2"];
    sky(1.0).write(&desk.path("sky.exr")).unwrap();
    desk.study(&words);
    sky(2.0).write(&desk.path("sky.exr")).unwrap();
    desk.refuses(&words, &["scenes[0].fingerprint", "another folder"]);
    sky(1.0).write(&desk.path("sky.exr")).unwrap();
    desk.study(&words);
}

#[test]
fn what_cannot_be_done_is_said() {
    let desk = Desk::new(&[("room.json", foggy_room())]);
    let quick = ["--spp", "2", "--seeds", "2", "--reference-spp", "2"];
    let with_quick = |words: &[&'static str]| [words, &quick[..]].concat();
    desk.study(&with_quick(&["room.json", "-o", "out"]));
    let rows: [(&[&str], &[&str]); 16] = [
        (&["-o", "out"], &["SCENE"]),
        (&["room.json"], &["--output"]),
        (&["room.json", "-o", "out", "--seeds", "1"], &["--seeds", "2.."]),
        (&["room.json", "-o", "out", "--confidence", "95"], &["from 0.5 to 0.9999"]),
        (&["room.json", "-o", "out", "--spp", "2", "--seconds", "2"], &["--seconds"]),
        (&["room.json", "-o", "out", "--reference-error", "1"], &["--reference <FILE>"]),
        (&["room.json", "-o", "new", "--reference", "none.exr"], &["none.exr", "check that the path"]),
        (&["room.json", "-o", "new", "--reference", "room.json"], &["room.json", "an image file"]),
        (&["room.json", "room.json", "-o", "new", "--reference", "a.exr"], &["one for each scene, 2 in all"]),
        (&["room.json", "-o", "new", "--vary", "integrator=fog"], &["preview", "bdpt, pt or lt"]),
        (&["room.json", "-o", "new", "--reference-by", "--integrator fog"], &["preview"]),
        (&["room.json", "-o", "new", "--contender", "pt"], &["NAME: OPTIONS", "for example"]),
        (&["hall.json", "-o", "new"], &["hall.json"]),
        (&["room.json", "-o", "room.json"], &["room.json", "a folder"]),
        (&["room.json", "-o", "out", "--vary", "colour=red"], &["max-depth", "colour"]),
        (
            &["room.json", "-o", "new", "--size", "4x4", "--reference", "out/images/room/reference.exr"],
            &["--size 8x8"],
        ),
    ];
    for (words, hints) in rows {
        desk.refuses(words, hints);
    }
    // Another study in the same folder.
    desk.refuses(&["room.json", "-o", "out", "--spp", "2"], &["seeds = 2, but 8", "--restart"]);
    fs::write(desk.path("room.json"), scene(&[("sensor", camera([0.0; 3], [0.0, 0.0, 1.0], 8))]).to_string())
        .unwrap();
    desk.refuses(&with_quick(&["room.json", "-o", "out"]), &["scenes[0].fingerprint", "another folder"]);
    fs::write(desk.path("room.json"), foggy_room().to_string()).unwrap();
    // A file that is no longer whole.
    fs::write(desk.path("out/runs/room/turns/bdpt/0.json"), "{").unwrap();
    desk.refuses(&with_quick(&["room.json", "-o", "out"]), &["bdpt/0.json", "remove the file", "--restart"]);
    desk.study(&with_quick(&["room.json", "-o", "out", "--restart"]));
}
