//! Nothing is lost: renders that stop and go on, and parts of one image.

use crate::{
    common::pieces::*,
    sandbox::{Run, Sandbox},
};
use serde_json::{Value, json};
use std::{
    fs,
    io::{BufRead as _, BufReader, Read as _},
    net::TcpListener,
    path::Path,
    process::{Child, Command, Stdio},
    time::{Duration, Instant},
};

/// A room of fog: light comes by every strategy, and in every pass from other blocks.
fn foggy() -> Sandbox {
    Sandbox::with_files(&[("fog.json", include_str!("../../scenes/foggy_room.json"))])
}

const SIZE: &str = "--size 60x50";

/// Samples are alike, however many they are to be, unless an integrator is named: no pilot chooses by their number.
fn command(words: &str) -> String {
    let alike = if words.contains("--integrator") { "" } else { "--strategies hit,next-event,join,lens" };
    format!("render fog.json {SIZE} {alike} {words}")
}

fn render(sandbox: &Sandbox, words: &str) -> Run {
    sandbox.run(&command(words))
}

fn good(run: Run) -> Run {
    run.ends(0)
}

fn refused(run: Run, words: &[&str]) {
    let error = run.ends(2).err();
    words.iter().for_each(|word| assert!(error.contains(word), "{word}: {error}"));
}

/// The same values in the same channels. What the files say of themselves differs.
fn assert_same(sandbox: &Sandbox, a: &str, b: &str) {
    assert!(sandbox.channels(a) == sandbox.channels(b), "{a} and {b} differ");
}

/// A render that has begun: it has said what it will do.
#[cfg(target_os = "linux")]
fn started(sandbox: &Sandbox, words: &str) -> Child {
    child(sandbox, words, |_| true)
}

/// A render that has samples.
#[cfg(target_os = "linux")]
fn under_way(sandbox: &Sandbox, words: &str) -> Child {
    child(sandbox, &format!("{words} --progress json"), |line| {
        let progress: Value = serde_json::from_str(line).unwrap_or_default();
        progress["samples_per_pixel"].as_u64().is_some_and(|samples| samples > 0)
    })
}

/// A render that has said what `is_enough`. Signals end it, even where whoever started the tests has them ignored.
#[cfg(target_os = "linux")]
fn child(sandbox: &Sandbox, words: &str, is_enough: impl Fn(&str) -> bool) -> Child {
    let all = command(words);
    let mut command = Command::new("env");
    command.args(["--default-signal=HUP,INT,TERM", env!("CARGO_BIN_EXE_tyndall")]);
    command.args(all.split_whitespace()).current_dir(sandbox.path("")).stdout(Stdio::null());
    let mut child = command.stderr(Stdio::piped()).spawn().unwrap();
    let mut said = BufReader::new(child.stderr.take().unwrap());
    let heard = said.by_ref().lines().any(|line| is_enough(&line.unwrap()));
    assert!(heard, "it ends without");
    // It goes on talking, with nobody to listen.
    std::thread::spawn(move || std::io::copy(&mut said, &mut std::io::sink()));
    child
}

/// True as soon as something `holds`; false if it does not within so many seconds.
#[cfg(target_os = "linux")]
fn within(seconds: u64, mut holds: impl FnMut() -> bool) -> bool {
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(seconds) {
        if holds() {
            return true;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    false
}

#[cfg(target_os = "linux")]
fn signal(child: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &child.id().to_string()]).status().unwrap().success());
}

#[test]
fn any_partition_of_the_samples_makes_the_same_image() {
    let sandbox = foggy();
    good(render(&sandbox, "--spp 12 -o all.exr --threads 2"));
    for (index, cuts) in [&[0, 12][..], &[0, 5, 12], &[0, 1, 2, 11, 12]].into_iter().enumerate() {
        let mut parts: Vec<String> = Vec::new();
        for (range, threads) in cuts.windows(2).zip([1, 3, 2, 7]) {
            let (name, samples) =
                (format!("{index}_{}.sums", range[0]), format!("{}..{}", range[0], range[1]));
            good(render(&sandbox, &format!("--samples {samples} --sums {name} --threads {threads}")));
            parts.insert(parts.len() / 2, name);
        }
        good(sandbox.run(&format!("merge {} -o merged.exr", parts.join(" "))));
        assert_same(&sandbox, "all.exr", "merged.exr");
    }
}

const START: &str = "render opening.xml -D res=16 --strategies hit,next-event,join,lens --starts learnt";

/// Of samples and of pixels, where light subpaths begin at learnt starts; each window of pixels learns its own.
#[test]
fn parts_with_learnt_starts_make_the_same_image() {
    let scene = include_str!("../../scenes/efficiency/small_opening.xml");
    let sandbox = Sandbox::with_files(&[("opening.xml", scene)]);
    let render = |words: &str| good(sandbox.run(&format!("{START} {words}")));
    for (name, crop) in [("all", ""), ("top", "--crop 16x7+0+0"), ("bottom", "--crop 16x9+0+7")] {
        let render = |words: &str| render(&format!("{crop} {words}"));
        let said = render(&format!("-v --spp 7 --sums {name}.sums -o {name}.exr --threads 2")).err();
        assert!(said.contains("learnt starts"), "{said}");
        render("--samples 0..3 --sums a.sums --threads 2");
        render("--samples 3..7 --sums b.sums --threads 1");
        good(sandbox.run("merge b.sums a.sums -o merged.exr"));
        assert_same(&sandbox, &format!("{name}.exr"), "merged.exr");
        render("--spp 7 --resume --sums a.sums -o gone_on.exr --threads 1");
        assert_same(&sandbox, &format!("{name}.exr"), "gone_on.exr");
    }
    good(sandbox.run("merge bottom.sums top.sums -o both.exr"));
    let [top, bottom, both] = ["top", "bottom", "both"].map(|name| sandbox.channels(&format!("{name}.exr")));
    both.iter().for_each(|(name, values)| assert!([&top[name][..], &bottom[name]].concat() == *values));
}

#[test]
fn sums_of_parts_go_on() {
    let sandbox = foggy();
    good(render(&sandbox, "--spp 7 -o all.exr"));
    good(render(&sandbox, "--samples 1..3 --sums a.sums"));
    good(render(&sandbox, "--samples 5..6 --sums b.sums"));
    good(sandbox.run("merge b.sums a.sums --sums both.sums"));
    good(render(&sandbox, "--spp 7 --resume --sums both.sums -o gone_on.exr"));
    assert_same(&sandbox, "all.exr", "gone_on.exr");
}

#[test]
fn layers_and_moments_are_merged() {
    let mut scene: Value = serde_json::from_str(include_str!("../../scenes/foggy_room.json")).unwrap();
    scene["integrator"] =
        json!({"type": "aov", "aovs": "n:sh_normal", "inner": {"type": "moment", "path": {"type": "bdpt"}}});
    let sandbox = Sandbox::with_files(&[("fog.json", &scene.to_string())]);
    good(render(&sandbox, "--spp 5 -o all.exr"));
    good(render(&sandbox, "--samples 0..2 --sums a.sums"));
    good(render(&sandbox, "--samples 2..5 --sums b.sums"));
    good(sandbox.run("merge b.sums a.sums -o merged.exr"));
    assert_same(&sandbox, "all.exr", "merged.exr");
}

#[test]
fn what_is_no_part_of_the_image_is_refused() {
    let sandbox = foggy();
    good(render(&sandbox, "--samples 0..2 --sums a.sums"));
    good(render(&sandbox, "--samples 1..3 --sums b.sums"));
    refused(sandbox.run("merge a.sums b.sums -o x.exr"), &["b.sums", "samples 1..3"]);
    for (words, differs) in [
        ("--seed 1", "seed"),
        ("--integrator pt", "strategies"),
        ("--max-depth 3", "max_depth"),
        ("--min-depth 2", "min_depth"),
    ] {
        good(render(&sandbox, &format!("--samples 2..3 --sums c.sums {words}")));
        refused(sandbox.run("merge a.sums c.sums -o x.exr"), &["c.sums", differs]);
        refused(render(&sandbox, &format!("--spp 9 --resume --sums a.sums {words}")), &["a.sums", differs]);
    }
    fs::write(sandbox.path("fog.json"), sandbox.text("fog.json") + " ").unwrap();
    refused(render(&sandbox, "--spp 9 --resume --sums a.sums"), &["files.scene"]);
    assert!(!sandbox.path("x.exr").exists());
}

#[test]
fn damaged_sums_are_refused_and_the_ones_before_them_used() {
    let sandbox = foggy();
    good(render(&sandbox, "--samples 0..2 --sums a.sums"));
    let whole = sandbox.bytes("a.sums");
    let mut flipped = whole.clone();
    flipped[whole.len() - 100] ^= 1;
    let text = String::from_utf8_lossy(&whole).find("end\\\":2").unwrap();
    let mut other = whole.clone();
    other[text + 6] = b'1';
    for damaged in [&whole[..whole.len() - 1], &whole[..7], &[], &flipped, &other, b"{\"width\": 3}"] {
        fs::write(sandbox.path("a.sums"), damaged).unwrap();
        refused(sandbox.run("merge a.sums -o x.exr"), &["a.sums"]);
    }
    refused(render(&sandbox, "--spp 3 --resume --sums a.sums -o x.exr"), &["a.sums", "damaged"]);
    fs::write(sandbox.path("a.sums.previous"), whole).unwrap();
    let warning = good(render(&sandbox, "--spp 3 --resume --sums a.sums -o x.exr")).err();
    assert!(warning.contains("a.sums.previous"), "{warning}");
    good(render(&sandbox, "--spp 3 -o all.exr"));
    assert_same(&sandbox, "all.exr", "x.exr");
}

/// Signals end a render in order: the picture, its report and the sums are there, and it goes on to the same bits.
#[cfg(target_os = "linux")]
#[test]
fn what_a_signal_ends_goes_on() {
    for (name, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        let sandbox = foggy();
        let mut child = under_way(&sandbox, "--time-limit 1000s -o fog.exr --report report.json");
        signal(&child, name);
        assert_eq!(child.wait().unwrap().code(), Some(code), "{name}");
        let done = sandbox.json("report.json")["samples_per_pixel"].as_u64().unwrap();
        assert!(sandbox.path("fog.png").exists() && sandbox.path("fog.exr").exists());
        good(render(&sandbox, &format!("--spp {} --resume -o fog.exr", done + 2)));
        good(render(&sandbox, &format!("--spp {} -o all.exr", done + 2)));
        assert_same(&sandbox, "fog.exr", "all.exr");
        assert!(!sandbox.path("fog.exr.sums").exists());
    }
}

/// Scripts repeat one command until it is done: it starts from nothing, goes on, and leaves nothing but the image.
#[cfg(target_os = "linux")]
#[test]
fn one_command_begins_goes_on_and_cleans_up() {
    let sandbox = foggy();
    let words = |limit: &str| format!("--spp 40 {limit} --sums-every 0.05s --resume -o fog.exr");
    let first = good(render(&sandbox, &words("--time-limit 0.01s"))).err();
    assert!(first.contains("no ") && first.contains("from the beginning"), "{first}");
    assert!(sandbox.path("fog.exr.sums").exists(), "a limit of time ended it");
    let last = good(render(&sandbox, &words(""))).err();
    assert!(!last.contains("from the beginning") && !last.contains("warning"), "{last}");
    assert_eq!(sandbox.files(), ["fog.exr", "fog.json", "fog.png"]);
    good(render(&sandbox, "--spp 40 -o all.exr"));
    assert_same(&sandbox, "fog.exr", "all.exr");
    good(render(&sandbox, "--spp 2 --resume --sums fog.sums -o fog.exr"));
    let more = good(render(&sandbox, "--spp 40 --resume --sums fog.sums -o fog.exr")).err();
    assert!(!more.contains("from the beginning") && sandbox.path("fog.sums").exists(), "{more}");
    assert_same(&sandbox, "fog.exr", "all.exr");
}

/// The same to a precision: it says so, and goes on.
#[cfg(target_os = "linux")]
#[test]
fn a_render_to_a_precision_goes_on_after_a_signal() {
    let sandbox = foggy();
    let mut child = under_way(&sandbox, "--error 0.5 -o fog.exr --report report.json");
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(sandbox.json("report.json")["pixels_within_error"].as_f64().unwrap() < 1.0);
    let said = good(sandbox.run("info fog.exr.sums")).out();
    assert!(said.contains("pixels_within_error") && said.contains("confidence           0.95"), "{said}");
    good(render(&sandbox, "--error 0.5 --resume -o fog.exr"));
    good(render(&sandbox, "--error 0.5 -o all.exr"));
    assert_same(&sandbox, "fog.exr", "all.exr");
}

/// Sums of one kind are no use to a render of the other, nor those of another precision.
#[test]
fn sums_of_another_precision_are_refused() {
    let sandbox = foggy();
    good(render(&sandbox, "--spp 3 --sums plain.sums -o x.exr"));
    good(render(&sandbox, "--spp 3 --error 0.5 --sums fog.sums -o x.exr"));
    let with = ["found the sums of a render with --error", "without"];
    refused(render(&sandbox, "--spp 9 --resume --sums fog.sums -o x.exr"), &with);
    refused(sandbox.run("merge plain.sums fog.sums -o x.exr"), &with);
    let without = ["found the sums of a render without --error"];
    refused(render(&sandbox, "--error 0.5 --resume --sums plain.sums -o x.exr"), &without);
    for (words, differs) in
        [("--error 0.4", "error = 0.4"), ("--error 0.5 --confidence 0.9", "confidence = 0.9")]
    {
        refused(render(&sandbox, &format!("{words} --resume --sums fog.sums -o x.exr")), &[differs]);
    }
}

/// A second one ends it at once, even while it cannot end in order: in white fog as dense as this, a sample takes hours.
#[cfg(target_os = "linux")]
#[test]
fn a_second_signal_ends_at_once() {
    let fog = json!({"type": "homogeneous", "sigma_t": 1e6, "albedo": 1});
    let white = scene(&[
        ("camera", camera([0.0; 3], [0.0, 0.0, -1.0], 8)),
        ("ball", json!({"type": "sphere", "radius": 0.5, "bsdf": {"type": "null"}, "interior": fog})),
        ("sky", sky(1.0)),
    ]);
    let sandbox = Sandbox::with_files(&[("fog.json", &white.to_string())]);
    let mut child = child(&sandbox, "--spp 1", |line| line.contains("60 x 50"));
    signal(&child, "-INT");
    std::thread::sleep(Duration::from_secs(1));
    assert!(child.try_wait().unwrap().is_none(), "it ends in order");
    signal(&child, "-INT");
    let has_ended = within(5, || child.try_wait().unwrap().is_some());
    child.kill().unwrap();
    assert!(has_ended && child.wait().unwrap().code() == Some(130));
}

/// `timeout` sends a signal to the program, and again to its group.
#[cfg(target_os = "linux")]
#[test]
fn two_signals_together_are_one() {
    let sandbox = foggy();
    let mut child = under_way(&sandbox, "--time-limit 1000s -o fog.exr");
    let twice = format!("kill -INT {0}; kill -INT {0}", child.id());
    Command::new("sh").args(["-c", &twice]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(sandbox.path("fog.exr").exists());
}

/// While a scene is being read there is nothing to save: the first signal ends it.
#[cfg(target_os = "linux")]
#[test]
fn a_signal_before_the_first_sample_ends_at_once() {
    let mut command = Command::new("env");
    command.args(["--default-signal=INT", env!("CARGO_BIN_EXE_tyndall"), "render", "-"]);
    let mut child = command.stdin(Stdio::piped()).spawn().unwrap();
    let calls = format!("/proc/{}/wchan", child.id());
    // Not every kernel tells.
    within(5, || fs::read_to_string(&calls).unwrap().contains("pipe_read"));
    signal(&child, "-INT");
    let has_ended = within(60, || child.try_wait().unwrap().is_some());
    child.kill().unwrap();
    assert!(has_ended, "it waits for its scene");
}

/// Killed at any moment, also while it writes: what is there is whole, and goes on to the same bits.
#[cfg(target_os = "linux")]
#[test]
fn what_is_killed_goes_on_to_the_same_bits() {
    let sandbox = foggy();
    kill_often(&sandbox, "--spp 400");
    good(render(&sandbox, "--spp 1 --resume --sums fog.sums -o now.exr --report report.json"));
    let done = sandbox.json("report.json")["samples_per_pixel"].as_u64().unwrap();
    good(render(&sandbox, &format!("--spp {} --resume --sums fog.sums -o fog.exr", done + 1)));
    good(render(&sandbox, &format!("--spp {} -o all.exr", done + 1)));
    assert_same(&sandbox, "fog.exr", "all.exr");
}

/// The same of renders to a precision, with other numbers of threads each time, and with limits of time between.
#[cfg(target_os = "linux")]
#[test]
fn a_killed_render_to_a_precision_goes_on_to_the_same_bits() {
    let sandbox = foggy();
    kill_often(&sandbox, "--error 0.5");
    for (limit, threads) in [("--time-limit 0.1s", 3), ("--time-limit 0.15s", 1), ("--spp 40", 2), ("", 7)] {
        let words = format!("--error 0.5 {limit} --threads {threads} --resume --sums fog.sums -o fog.exr");
        good(render(&sandbox, &words));
    }
    good(render(&sandbox, "--error 0.5 -o all.exr"));
    assert_same(&sandbox, "fog.exr", "all.exr");
    // What is finished stays as it is.
    good(render(&sandbox, "--error 0.5 --resume --sums fog.sums -o again.exr"));
    good(sandbox.run("merge fog.sums -o merged.exr"));
    assert_same(&sandbox, "again.exr", "all.exr");
    assert_same(&sandbox, "merged.exr", "all.exr");
}

/// Kills a render at random moments, each time going on from what it kept.
#[cfg(target_os = "linux")]
fn kill_often(sandbox: &Sandbox, words: &str) {
    let kills = std::env::var("TYNDALL_KILLS").map_or(10, |kills| kills.parse().unwrap());
    let mut moment = 1u64;
    for kill in 0.. {
        if kill >= kills && has_sums(&sandbox.path("")) {
            break;
        }
        let resume = if has_sums(&sandbox.path("")) { "--resume" } else { "" };
        let threads = [2, 1, 3, 7][kill % 4];
        let words =
            format!("{words} --threads {threads} --sums fog.sums --sums-every 0.05s {resume} -o fog.exr");
        let mut child = started(sandbox, &words);
        moment = moment.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        std::thread::sleep(Duration::from_millis(50 + (moment >> 33) % 500));
        child.kill().unwrap();
        child.wait().unwrap();
    }
}

/// A limit may end any of the passes up to the next check; the check that it then makes is none of the render's.
#[test]
fn limits_of_samples_make_no_difference_to_a_precision() {
    let sandbox = foggy();
    good(render(&sandbox, "--error 0.5 --spp 1 --sums fog.sums -o fog.exr"));
    for spp in [2, 3, 31, 32, 33, 35, 5, 47, 100] {
        good(render(&sandbox, &format!("--error 0.5 --spp {spp} --resume --sums fog.sums -o fog.exr")));
    }
    good(render(&sandbox, "--error 0.5 --spp 100 -o all.exr"));
    assert_same(&sandbox, "fog.exr", "all.exr");
}

fn has_sums(folder: &Path) -> bool {
    ["fog.sums", "fog.sums.previous"].iter().any(|name| folder.join(name).exists())
}

/// A viewer is sent the picture so far, and the last one.
#[test]
fn tev_shows_the_picture_so_far() {
    let sandbox = foggy();
    for words in ["--time-limit 3s", "--error 0.1 --time-limit 3s"] {
        shows_in_tev(&sandbox, words);
    }
    refused(render(&sandbox, "--spp 1 --tev 127.0.0.1:1"), &["--tev", "start tev first"]);
}

fn shows_in_tev(sandbox: &Sandbox, words: &str) {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let address = listener.local_addr().unwrap();
    let received = std::thread::spawn(move || {
        let mut bytes = Vec::new();
        listener.accept().unwrap().0.read_to_end(&mut bytes).unwrap();
        bytes
    });
    good(render(sandbox, &format!("{words} -o fog.exr --tev {address}")));
    let received = received.join().unwrap();
    // Packets begin with their length; an update holds all of the picture's 32-bit numbers.
    let (mut rest, mut packets, mut last) = (&received[..], 0, &received[..]);
    while let Some(length) = rest.first_chunk().map(|length| u32::from_le_bytes(*length) as usize) {
        (last, rest, packets) = (&rest[..length], &rest[length..], packets + 1);
    }
    assert!(packets >= 3, "{packets} packets: the picture, an update meanwhile, the last one");
    let numbers: Vec<f32> =
        last[last.len() - 60 * 50 * 12..].as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)).collect();
    let red: Vec<f32> = numbers.iter().step_by(3).copied().collect();
    assert_eq!(sandbox.channels("fog.exr")["R"], red);
}

/// The picture so far is there long before the end.
#[cfg(target_os = "linux")]
#[test]
fn the_picture_so_far_is_written() {
    for words in ["--time-limit 100s", "--error 0.01"] {
        writes_the_picture_so_far(words);
    }
}

#[cfg(target_os = "linux")]
fn writes_the_picture_so_far(words: &str) {
    let sandbox = foggy();
    let mut child = started(&sandbox, &format!("{words} --preview -o fog.exr"));
    within(60, || sandbox.path("fog.png").exists());
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(sandbox.channels("fog.exr")["R"].len(), 60 * 50);
}

/// The limit holds at any size, and what there is by then is an image without holes.
#[test]
fn time_ends_within_a_block() {
    let sandbox = foggy();
    let words = "render fog.json --size 3840x2160 --time-limit 0.5s -o large.exr --report report.json";
    let said = good(sandbox.run(words)).out();
    assert!(!said.starts_with("0 samples/pixel"), "{said}");
    let seconds = sandbox.json("report.json")["render_seconds"].as_f64().unwrap();
    assert!(seconds < 1.5, "{seconds} s");
}

/// Every file says how it was made, and the command that makes it again makes the same.
#[test]
fn pictures_say_how_they_were_made() {
    let sandbox = foggy();
    good(render(&sandbox, "--spp 3 --integrator pt --seed 7 -o fog.exr --sums fog.sums"));
    for name in ["fog.exr", "fog.png", "fog.sums"] {
        let said = good(sandbox.run(&format!("info {name}"))).out();
        for words in [
            "\ncommand              tyndall render fog.json",
            "pt",
            concat!("tyndall ", env!("CARGO_PKG_VERSION")),
            "fog.json",
            "vacuum",
        ] {
            let words = words.replace("vacuum", "profile");
            assert!(said.contains(&words), "{name}: {words}: {said}");
        }
        let made: Value =
            serde_json::from_str(&good(sandbox.run(&format!("info {name} --json"))).out()).unwrap();
        assert_eq!(
            (&made["settings"]["seed"], &made["settings"]["strategies"]),
            (&json!(7), &json!(["hit", "next-event"]))
        );
    }
    let said = good(sandbox.run("info fog.png")).out();
    let again = said
        .lines()
        .find_map(|line| line.strip_prefix("command"))
        .unwrap()
        .trim()
        .strip_prefix("tyndall ")
        .unwrap();
    fs::rename(sandbox.path("fog.exr"), sandbox.path("first.exr")).unwrap();
    good(sandbox.run(again));
    assert_same(&sandbox, "fog.exr", "first.exr");
    fs::rename(sandbox.path("fog.sums"), sandbox.path("fog.json.kept")).unwrap();
    assert!(good(sandbox.run("info fog.json.kept")).out().contains("\nseed                 7"));
    fs::write(sandbox.path("fog.png"), &sandbox.bytes("fog.png")[..60]).unwrap();
    refused(sandbox.run("info fog.png"), &["fog.png"]);
}

/// Who forgets --resume loses nothing.
#[test]
fn sums_of_an_earlier_render_are_put_aside() {
    let sandbox = foggy();
    good(render(&sandbox, "--samples 0..4 --sums a.sums"));
    let note = good(render(&sandbox, "--samples 0..1 --sums a.sums")).err();
    assert!(note.contains("a.sums.before"), "{note}");
    good(sandbox.run("merge a.sums.before --sums all.sums"));
    assert!(good(sandbox.run("info all.sums")).out().contains("0..4"));
    // As a killed render leaves them: the newer ones are kept.
    fs::rename(sandbox.path("a.sums.before"), sandbox.path("a.sums")).unwrap();
    fs::write(sandbox.path("a.sums.previous"), "older").unwrap();
    good(render(&sandbox, "--samples 0..1 --sums a.sums"));
    assert!(good(sandbox.run("merge a.sums.before -o all.exr")).out().contains("0..4"));
}

/// Going on from the file before the last keeps that until a new one is there.
#[cfg(unix)]
#[test]
fn the_last_good_sums_outlive_a_damaged_file() {
    let sandbox = foggy();
    good(render(&sandbox, "--samples 0..4 --sums a.sums"));
    fs::rename(sandbox.path("a.sums"), sandbox.path("a.sums.previous")).unwrap();
    fs::write(sandbox.path("a.sums"), "damaged").unwrap();
    let words = "render fog.json --size 60x50 --spp 6 --resume --sums a.sums -o a.exr";
    sandbox.shell(&format!("ulimit -f 8; trap '' XFSZ; $TYNDALL {words}")).ends(2);
    good(sandbox.run("merge a.sums.previous --sums whole.sums"));
    good(sandbox.run(words));
    good(render(&sandbox, "--spp 6 -o all.exr"));
    assert_same(&sandbox, "a.exr", "all.exr");
}

/// The image does not depend on the sums.
#[cfg(target_os = "linux")]
#[test]
fn sums_that_cannot_be_written_do_not_cost_the_image() {
    let sandbox = foggy();
    fs::create_dir(sandbox.path("fog.exr.sums")).unwrap();
    let mut child = under_way(&sandbox, "--time-limit 1000s -o fog.exr");
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(2));
    assert!(sandbox.path("fog.exr").exists() && sandbox.path("fog.png").exists());
}

/// nohup and scripts start programs that are to ignore signals.
#[cfg(target_os = "linux")]
#[test]
fn ignored_signals_stay_ignored() {
    let sandbox = foggy();
    let script = "trap '' HUP; $TYNDALL render fog.json --size 60x50 --time-limit 2s -o fog.exr & \
        sleep 0.7; kill -HUP $!; wait $!";
    sandbox.shell(script).ends(0);
    assert!(sandbox.path("fog.exr").exists() && !sandbox.path("fog.exr.sums").exists());
}

/// A link stays one, and the mode of what it leads to is kept.
#[cfg(unix)]
#[test]
fn sums_go_through_links() {
    use std::os::unix::fs::PermissionsExt;
    let sandbox = foggy();
    good(render(&sandbox, "--samples 0..1 --sums real.sums"));
    fs::set_permissions(sandbox.path("real.sums"), fs::Permissions::from_mode(0o664)).unwrap();
    std::os::unix::fs::symlink("real.sums", sandbox.path("link.sums")).unwrap();
    good(render(&sandbox, "--spp 3 --resume --sums link.sums -o fog.exr"));
    assert!(sandbox.path("link.sums").is_symlink());
    assert_eq!(sandbox.path("real.sums").metadata().unwrap().permissions().mode() & 0o777, 0o664);
    assert!(good(sandbox.run("info real.sums")).out().contains("0..3"));
}

/// Options that would have no effect are refused before the first ray.
#[test]
fn what_cannot_be_kept_is_refused() {
    let sandbox = foggy();
    for (words, hints) in [
        ("--integrator fog --samples 0..4 --sums a.sums", &["--sums", "preview fog"][..]),
        ("--samples 0..4 --sums a.sums --preview", &["--preview", "-o"]),
        ("--preview -o /dev/stdout", &["--preview", "device"]),
        ("--sums /dev/null", &["/dev/null", "plain file"]),
        ("--samples 4..4 --sums a.sums", &["0..64"]),
    ] {
        refused(render(&sandbox, words), hints);
    }
    good(render(&sandbox, "--samples 0..4 --sums a.sums"));
    let more = good(render(&sandbox, "--spp 2 --resume --sums a.sums -o a.exr")).err();
    assert!(more.contains("0..2") && more.contains("0..4"), "{more}");
    refused(sandbox.run("merge a.sums -o a.sums.exr --sums a.sums.png"), &["a.sums.png"]);
}
