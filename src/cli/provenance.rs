//! How an image is made: what its files say of themselves, and what must be equal for its samples to be added up.

use super::scene::Scene;
use crate::{
    analysis::study::question::differ,
    error::{Error, Result},
    film::sharing::FilmSamples,
    film::view::Display,
    format,
    learning::pilot::Choice,
    passes::Settings,
    render::{Image, Precision},
    sampling::Basis,
    scene::build::Setup,
    transport::{Connections, Effort, LightStarts, Options, Sky},
};
use serde_json::{Map, Value, json};
use std::path::Path;

/// All that decides about the samples of an image.
pub(super) fn settings(
    scene: &Scene,
    setup: &Setup,
    settings: &Settings,
    chosen: Option<Choice>,
    precision: Option<Precision>,
) -> Result<Value> {
    let sources = format::sources(&scene.file, &scene.definitions, Some(setup.time))?;
    // The scene may have another name elsewhere.
    let names = |(index, (name, print)): (usize, (String, String))| {
        (if index == 0 { "scene".to_owned() } else { name }, print.into())
    };
    let files: Map<String, Value> = sources.fingerprints()?.into_iter().enumerate().map(names).collect();
    let definitions: Map<String, Value> =
        scene.definitions.iter().map(|(name, value)| (name.clone(), value.as_str().into())).collect();
    let Settings { options, sampler, film_samples, seed, profile, .. } = settings;
    let trackers = setup.scene.media.iter().filter_map(|medium| medium.heterogeneous());
    let trackers: Vec<String> =
        trackers.map(|medium| medium.forced().unwrap_or(medium.requested()).name().to_owned()).collect();
    let film = &setup.film;
    let mut all = json!({
        "program": program(),
        "files": files,
        "definitions": definitions,
        "time": setup.time,
        "film": {
            "full_size": film.window.full_size,
            "filter": format!("{:?}", film.filter),
            "window": { "size": film.window.size, "offset": film.window.offset, "border": film.border },
        },
        "layers": setup.integrator.layers.iter().map(|layer| layer.name.as_str()).collect::<Vec<_>>(),
        "strategies": chosen.map_or(options.strategies, |choice| choice.among).names(),
        "trackers": trackers,
        "sampler": sampler.name(),
        "seed": seed,
        "profile": profile.name(),
        "chosen_by_pilot": chosen.map(by_pilot),
        "error": precision.map(|precision| precision.error),
        "confidence": precision.map(|precision| precision.confidence),
    });
    options.json().into_iter().for_each(|(name, value)| all[name] = value);
    if let Some(sensor) = &scene.sensor {
        all["sensor"] = sensor.as_str().into();
    }
    extend(&mut all, setup, options, *film_samples);
    Ok(all)
}

/// Adds what else decides, only where there is something: earlier sums, which know of none of it, can go on.
fn extend(settings: &mut Value, setup: &Setup, options: &Options, film_samples: FilmSamples) {
    let overridden = setup.overrides.json();
    if !overridden.is_empty() {
        settings["overridden"] = Value::Object(overridden);
    }
    if options.connections == Connections::All {
        settings["connections"] = "all".into();
    }
    let is_usual = match film_samples {
        FilmSamples::Shared => true,
        FilmSamples::Own => !setup.film.can_share(),
        FilmSamples::Apart => false,
    };
    if !is_usual {
        settings["film_samples"] = film_samples.name().into();
    }
    if options.algorithm.ends_in_first_pass() {
        settings["preview"] = options.algorithm.name().into();
        settings["first_pass"] = options.first_pass.by(options.algorithm).name().into();
    }
    if let Some(name) = starts(options.effort).filter(|_| settings["chosen_by_pilot"].is_null()) {
        settings[name] = true.into();
    }
    if options.effort.sky == Sky::Hit && settings["chosen_by_pilot"].is_null() {
        settings["sky"] = "hit".into();
    }
    if options.effort.is_guided() {
        settings["guide"] = true.into();
        if options.basis != Basis::default() {
            settings["basis"] = options.basis.name().into();
        }
    }
}

/// What says that light subpaths start elsewhere than emitters emit.
fn starts(effort: Effort) -> Option<&'static str> {
    match effort.starts {
        LightStarts::Emitted => None,
        LightStarts::Aimed => Some("aimed_starts"),
        LightStarts::Learnt => Some("learnt_starts"),
    }
}

/// What a pilot chose; other starts are named where there are any, so that earlier sums without them can go on.
pub(super) fn by_pilot(Choice { strategies, effort, .. }: Choice) -> Value {
    let mut chosen = json!({
        "strategies": strategies.names(),
        "survival": effort.survival.name(),
        "light_walks": effort.light_walks,
        "connections": effort.connections,
    });
    if let Some(name) = starts(effort) {
        chosen[name] = true.into();
    }
    if effort.sky == Sky::Hit {
        chosen["sky"] = "hit".into();
    }
    chosen
}

/// This program and its version.
pub(super) fn program() -> String {
    format!("tyndall {}", env!("CARGO_PKG_VERSION"))
}

/// True if pixels of a render share samples.
pub(super) fn shares_samples(setup: &Setup, settings: &Settings) -> bool {
    setup.film.can_share() && settings.film_samples == FilmSamples::Shared
}

/// `settings` with the command that is running: enough to make the image again; and whether pixels share samples, which
/// denoisers ask.
pub(super) fn made(settings: Value, shares_samples: bool) -> Value {
    let command: Vec<String> = std::env::args_os().map(|word| word.to_string_lossy().into_owned()).collect();
    let folder = std::env::current_dir().map(|folder| folder.display().to_string()).unwrap_or_default();
    json!({ "settings": settings, "command": command, "folder": folder, "shares_samples": shares_samples })
}

/// The same with what became of it, as files hold it: ASCII.
pub(super) fn metadata(made: &Value, image: &Image) -> String {
    let mut all = made.clone();
    all["samples_per_pixel"] = image.samples().into();
    all["render_seconds"] = image.elapsed.as_secs_f64().into();
    all["relative_error"] = image.noise.map(|noise| noise.error).into();
    all["machine"] = machine().into();
    ascii(&all)
}

/// The same for a PNG, with how it shows the image.
pub(super) fn shown(metadata: &str, display: Display) -> String {
    let mut all: Value = serde_json::from_str(metadata).unwrap_or_else(|_| json!({}));
    all["view"] = display.view.name().into();
    all["exposure"] = display.stops.into();
    ascii(&all)
}

fn ascii(all: &Value) -> String {
    let escaped = |character: char| -> String {
        let mut units = [0; 2];
        character.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")).collect()
    };
    let text = all.to_string();
    text.chars().map(|c| if c.is_ascii() { c.to_string() } else { escaped(c) }).collect()
}

fn machine() -> String {
    let name = sysinfo::System::host_name().unwrap_or_default();
    let threads = rayon::current_num_threads();
    format!("{name} ({} {}, {threads} threads)", std::env::consts::OS, std::env::consts::ARCH)
}

/// The same of any part of the image.
pub(super) fn without_window(made: &Value) -> Value {
    let mut made = made.clone();
    made["settings"]["film"]["window"].take();
    made
}

/// `settings` without those that affect noise alone: the pilot's choice, and whether walks follow a guide. Samples that
/// differ in these are of the same image. `validation/cluster/tiles.py` has the same list.
fn of_image(settings: &Value) -> Value {
    let mut settings = settings.clone();
    for chosen in ["chosen_by_pilot", "guide", "basis", "aimed_starts", "learnt_starts", "sky"] {
        settings[chosen].take();
    }
    settings
}

/// Refuses sums in `file` whose image is made otherwise.
pub(super) fn must_equal(file: &Path, found: &Value, wanted: &Value) -> Result<()> {
    let none = Value::Null;
    let (found, wanted) = [found, wanted].map(|made| made.get("settings").unwrap_or(&none)).into();
    let kind =
        |settings: &Value| if settings["error"].is_null() { "without --error" } else { "with --error" };
    if kind(found) != kind(wanted) {
        let [expected, found] =
            [wanted, found].map(|settings| format!("the sums of a render {}", kind(settings)));
        let remedy = "name another file, or use the options that these sums were rendered with";
        return Err(Error::new(file.display(), expected, found, remedy));
    }
    match differ("", &of_image(found), &of_image(wanted)) {
        None => Ok(()),
        Some((place, old, new)) => Err(Error::new(
            file.display(),
            format!("samples of the same image, with {place} = {new}"),
            format!("{place} = {old}"),
            "use the scene, the files and the options that these samples were rendered with",
        )),
    }
}
