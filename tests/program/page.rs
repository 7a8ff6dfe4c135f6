//! `tyndall report`: the page of a made-up study, read back as HTML and, where there is a Chromium, looked at in it.

use crate::common::studies::{self, Study};
use crate::html::{self, all, shown, texts};
use roxmltree::Document;
use std::{fs, path::Path, process::Command};
use tyndall::analysis::study::page;

/// The page of a study, refused unless it is well-formed and stands alone.
fn page_of(study: &Study) -> Document<'static> {
    let path = page::write(study.folder.path()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(path, study.folder.path().join("study.html"));
    let text = fs::read_to_string(path).unwrap();
    let html = html::parse(&text);
    stands_alone(&text, &html);
    html
}

/// Nothing in it leads to another file.
fn stands_alone(text: &str, html: &Document) {
    for element in all(html, "*") {
        for name in ["src", "href", "srcset", "data", "action"] {
            let Some(address) = element.attribute(name) else { continue };
            assert!(address.starts_with("data:") || address.starts_with('#'), "{name}={address:.80}");
        }
    }
    assert!(!text.contains("://") && !text.contains("@import"), "an address in the page");
}

#[test]
fn everything_of_a_study_is_on_its_page() {
    let study = Study::new(&["room", "church"], &["bdpt", "pt", "volpath"], 4);
    let html = page_of(&study);
    assert_eq!(texts(&html, ".scene h2"), ["room", "church"]);
    assert_eq!(texts(&html, "#scene-1 .legend button"), ["bdpt", "pt", "volpath"]);
    assert_eq!(texts(&html, "#scene-0 .strip h4").len(), 4);
    // Five measures over three axes, one shown at first; a mark for every budget.
    assert_eq!(all(&html, "#scene-0 .chart").len(), 15);
    assert_eq!(shown(&html, "#scene-0 .chart").len(), 1);
    let marks = shown(&html, "#scene-0 .chart .marks > *");
    assert_eq!(marks.len(), 3 * 4);
    assert_eq!(shown(&html, "#scene-0 .chart .floor > *").len(), 1);
    // The reference; an image and an error of each at each level; a variance of each.
    assert_eq!(all(&html, "#scene-0 img.source").len(), 1 + 3 * 4 * 2 + 3);
    // Who does not report processor time has no curve over it.
    let over = |axis: &str| {
        all(&html, &format!("#scene-0 .chart[data-measure='relmse'][data-axis='{axis}'] .marks > *")).len()
    };
    assert_eq!((over("seconds"), over("cpu"), over("samples")), (3 * 4, 2 * 4, 3 * 4));
    let footer = texts(&html, "footer").concat();
    for said in
        [&study.outcome.command, &study.outcome.machine, "2026-11-27 13:20 UTC", "0.50, 0.25, 0.12 before"]
    {
        assert!(footer.contains(said), "{said} is not in: {footer}");
    }
    assert!(texts(&html, "#scene-0 header").concat().contains(&study.outcome.scenes[0].reference.how));
}

/// By what it is known, what part of the errors it makes, and who agrees that is made otherwise.
#[test]
fn a_page_says_why_its_reference_can_be_trusted() {
    let mut study = Study::new(&["room"], &["bdpt", "pt", "volpath"], 4);
    let header = |study: &Study| texts(&page_of(study), "#scene-0 header .says").concat();
    let said = header(&study);
    for part in [
        "own relMSE is 1.00×10⁻⁵, by how far its 16 independent batches are apart",
        "0.0267 % to 0.0800 % of the contenders'",
        "agrees with the reference's, and standard errors between them: pt (−1.50).",
        "by more than chance, in standard errors: volpath (12.0).",
    ] {
        assert!(said.contains(part), "{part}: {said}");
    }
    let scene = &mut study.outcome.scenes[0];
    (scene.reference.apart, scene.reference.own_relmse) = (Some(0.7), None);
    scene.contenders.truncate(1);
    study.rewrite();
    let said = header(&study);
    for part in ["own relMSE is not known.", "renderers are 0.700 standard errors apart", "none can confirm"]
    {
        assert!(said.contains(part), "{part}: {said}");
    }
}

/// Of versions that knew less.
#[test]
fn an_old_study_still_has_its_page() {
    let study = Study::new(&["room"], &["bdpt", "pt"], 3);
    let mut old = serde_json::to_value(&study.outcome).unwrap();
    forget(&mut old, &["conditions", "known_by", "apart", "like", "chosen", "cpu_seconds"]);
    fs::write(study.folder.path().join("study.json"), old.to_string()).unwrap();
    let html = page_of(&study);
    assert_eq!(all(&html, ".chart").len(), 10);
    assert!(!texts(&html, "footer").concat().contains("UTC") && all(&html, ".notes").is_empty());
    assert!(texts(&html, ".numbers th").iter().all(|head| head != "CPU seconds"));
}

/// Removes all that has one of `names`, wherever it is.
fn forget(value: &mut serde_json::Value, names: &[&str]) {
    match value {
        serde_json::Value::Object(map) => {
            map.retain(|name, _| !names.contains(&name.as_str()));
            map.values_mut().for_each(|inner| forget(inner, names));
        }
        serde_json::Value::Array(all) => all.iter_mut().for_each(|inner| forget(inner, names)),
        _ => {}
    }
}

#[test]
fn what_scripts_read_is_what_stands_in_the_study() {
    let study = Study::new(&["room"], &["</script><b>&amp;", "é 漢 \u{2028} \"'"], 2);
    let html = page_of(&study);
    let data: serde_json::Value = serde_json::from_str(&texts(&html, "#data").concat()).unwrap();
    let names: Vec<_> = study.outcome.scenes[0].contenders.iter().map(|c| c.name.as_str()).collect();
    let reported: Vec<_> =
        data["scenes"][0].as_array().unwrap().iter().map(|c| c["name"].as_str().unwrap()).collect();
    assert_eq!(reported, names);
    assert_eq!(data["scenes"][0][0]["points"].as_array().unwrap().len(), 2);
}

#[test]
fn names_are_text_wherever_they_stand() {
    let name = "<img src=x onerror=alert(1)> & \"quotes\" 'n' ünï漢 {{ x }} --> ]]>";
    let mut study = Study::new(&[name], &[name, "</style></title><script>"], 2);
    study.outcome.command = name.into();
    study.outcome.machine = name.into();
    study.outcome.made_by = name.into();
    study.outcome.scenes[0].reference.how = name.into();
    study.rewrite();
    let html = page_of(&study);
    assert_eq!(texts(&html, ".scene h2"), [name]);
    assert!(texts(&html, "title").concat().contains(name));
    assert_eq!(texts(&html, ".legend button"), [name, "</style></title><script>"]);
    assert_eq!(texts(&html, "code")[0], name);
    assert!(all(&html, "[onerror]").is_empty());
    assert_eq!(all(&html, "script").len(), 2);
    let frame = all(&html, ".frame")[0].attribute("aria-label").unwrap().to_owned();
    assert!(frame.contains(name), "{frame}");
}

#[test]
fn one_contender_with_one_budget_is_enough() {
    let html = page_of(&Study::new(&["room"], &["bdpt"], 1));
    assert_eq!(all(&html, ".strip").len(), 1);
    assert_eq!(shown(&html, ".chart .marks > *").len(), 1);
    assert!(all(&html, ".glance").is_empty() && all(&html, "nav").is_empty());
}

#[test]
fn every_number_can_be_drawn() {
    for value in [0.0, 1.0, 1e-30, f64::MIN_POSITIVE, 5e-324, 1e30, f64::MAX, f64::NAN] {
        let mut study = Study::new(&["room"], &["a", "b"], 3);
        study.set_all(value);
        let html = page_of(&study);
        for shape in all(&html, ".chart .series *, .chart .band *, .chart .guide *") {
            let numbers = ["points", "cx", "cy"].into_iter().filter_map(|name| shape.attribute(name));
            for place in numbers.flat_map(|text| text.split([' ', ',']).filter(|part| !part.is_empty())) {
                let place: f64 = place.parse().unwrap();
                assert!((-40.0..=1640.0).contains(&place), "{value:e}: {place}");
            }
        }
        for mark in shown(&html, ".chart .marks circle") {
            let at = ["cx", "cy"].map(|name| mark.attribute(name).unwrap().parse::<f64>().unwrap());
            // What is no number, or beyond all scales, stands at the worst corner: late, and with much error.
            let is_worst = at[0] >= 1570.0 && at[1] <= 30.0;
            assert_eq!(is_worst, value.is_nan() || value == f64::MAX, "{value:e}: {at:?}");
        }
        let page = texts(&html, "main").concat();
        assert!(!page.contains("NaN") && !page.contains("inf"), "{value:e}");
    }
}

#[test]
fn notes_and_ratios_are_shown() {
    let mut study = Study::new(&["room"], &["a", "b"], 3);
    study.outcome.scenes[0].notes = vec!["lt cannot render it: why".to_owned()];
    study.outcome.scenes[0].contenders[1].notes = vec!["only 1.2 times the reference's own: some".to_owned()];
    study.rewrite();
    let html = page_of(&study);
    let header = texts(&html, "#scene-0 header").concat();
    assert!(header.contains("lt cannot render it: why."), "{header}");
    // Each contender's own, beside its name.
    assert_eq!(texts(&html, "#scene-0 .notes dt"), ["a", "b"]);
    let said = texts(&html, "#scene-0 .notes dd");
    assert_eq!(said[0], "bdpt (hit, join); 1 of 4 seeds chose otherwise");
    assert!(said[1].contains("only 1.2 times"), "{said:?}");
    let shown = texts(&html, "#scene-0 .legend td");
    assert!(shown.contains(&"1".to_owned()) && shown.contains(&"0.500×".to_owned()), "{shown:?}");
}

/// What a README shows is what the page shows.
#[test]
fn the_record_has_all_curves_and_images() {
    let study = Study::new(&["room", "church <&>"], &["bdpt", "<pt>", "volpath"], 4);
    let to = study.folder.path().join("record");
    let paths = page::record(study.folder.path(), &to).unwrap();
    let text = |name: &str| fs::read_to_string(to.join(name)).unwrap();
    assert_eq!(paths.len(), 3);
    let (table, curves, strips) =
        (text("convergence.md"), text("convergence.svg"), text("convergence_strips.svg"));
    for said in [
        &study.outcome.command,
        &study.outcome.machine,
        "church <&>",
        "](convergence.svg)",
        "13:20 UTC",
        "CPU seconds",
    ] {
        assert!(table.contains(said), "{said}: {table}");
    }
    for svg in [&curves, &strips] {
        let svg = Document::parse(svg).unwrap();
        let texts: Vec<&str> = svg.descendants().filter_map(|node| node.text()).collect();
        assert!(
            ["room", "church <&>", "<pt>", "volpath"].iter().all(|name| texts.contains(name)),
            "{texts:?}"
        );
    }
    let count = |svg: &str, name: &str| svg.matches(name).count();
    assert_eq!(count(&curves, "class=\"chart\""), 2);
    // A reference and an image of each contender, of each scene.
    assert_eq!(count(&strips, "href=\"data:image/png;base64,"), 2 * 4);
}

#[test]
fn broken_pixels_are_shown_as_such() {
    let study = Study::new(&["room"], &["a"], 2);
    let broken = [f32::NAN, f32::INFINITY, -1.0, 1e30];
    studies::write_image(
        &study.folder.path().join(&study.outcome.scenes[0].contenders[0].points[1].image),
        |k| broken[k % broken.len()],
    );
    page_of(&study);
}

fn refused(study: &Study, hints: &[&str]) {
    let error = page::write(study.folder.path()).unwrap_err().to_string();
    for hint in hints {
        assert!(error.contains(hint), "no \"{hint}\" in: {error}");
    }
    assert!(!study.folder.path().join("study.html").exists());
}

#[test]
fn what_is_missing_is_named() {
    let study = Study::new(&["room"], &["bdpt"], 2);
    let numbers = study.folder.path().join("study.json");
    let whole = fs::read_to_string(&numbers).unwrap();
    fs::write(&numbers, &whole[..whole.len() / 2]).unwrap();
    refused(&study, &["study.json:", "a study as JSON", "remedy"]);
    fs::write(&numbers, whole.replacen("\"width\"", "\"wide\"", 1)).unwrap();
    refused(&study, &["missing field `width`"]);
    fs::remove_file(&numbers).unwrap();
    refused(&study, &["study.json", "the numbers of a study"]);

    let mut study = Study::new(&["room"], &["bdpt"], 2);
    study.outcome.scenes[0].contenders[0].points.clear();
    study.rewrite();
    refused(&study, &["at least one budget", "bdpt in room"]);
    study.outcome.scenes.clear();
    study.rewrite();
    refused(&study, &["at least one scene"]);

    let study = Study::new(&["room"], &["bdpt"], 2);
    let image = study.folder.path().join(&study.outcome.scenes[0].contenders[0].points[1].image);
    fs::write(&image, "no image").unwrap();
    refused(&study, &[&image.display().to_string(), "an image of 12 x 8 pixels"]);
    fs::remove_file(&image).unwrap();
    refused(&study, &[&image.display().to_string()]);
    let mut study = Study::new(&["room"], &["bdpt"], 2);
    study.outcome.scenes[0].width = 13;
    study.rewrite();
    refused(&study, &["reference.exr", "13 x 8", "12 x 8"]);
}

#[test]
fn the_command_says_where_the_page_is() {
    let study = Study::new(&["room"], &["bdpt"], 2);
    let run = |folder: &Path| {
        Command::new(env!("CARGO_BIN_EXE_tyndall")).arg("report").arg(folder).output().unwrap()
    };
    let output = run(study.folder.path());
    assert!(output.status.success());
    let path = String::from_utf8(output.stdout).unwrap();
    assert!(Path::new(path.trim()).is_file(), "{path}");
    let output = run(&study.folder.path().join("nowhere"));
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("nowhere/study.json"));
}
