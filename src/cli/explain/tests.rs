//! Every plugin's table against what the reader reads: each row is asked for, and nothing is asked for without one.

use super::*;
use crate::{
    description::{
        parameter::{Default, Kind},
        params::NOTES,
    },
    format, sensor,
    settings::Overrides,
};
use serde_json::{Map, Value, json};
use std::path::Path;

/// What makes the reader ask for rows that it does not always ask for.
fn beside(plugin: &str, name: &str) -> Value {
    match (plugin, name) {
        ("equipotential", "p0") => json!({"shape": "line", "p1": [5, 0, 0]}),
        ("equipotential", "p1") => json!({"shape": "segment", "p0": [5, 0, 0]}),
        ("equipotential", "radius") => json!({"shape": "sphere"}),
        ("radiancemeter", "origin") => json!({"direction": [0, 0, 1]}),
        ("radiancemeter", "direction") => json!({"origin": [0, 0, 0]}),
        (_, "alpha_u") => json!({"alpha_v": 0.5}),
        (_, "alpha_v") => json!({"alpha_u": 0.5}),
        (_, "fov_axis") => json!({"fov": 30}),
        ("homogeneous" | "heterogeneous", "emission_scale" | "group") => json!({"emission": 1}),
        ("regular", "value") => json!({"values": null, "wavelength_min": null, "wavelength_max": null}),
        ("irregular", "value") => json!({"values": null, "wavelengths": null}),
        ("regular", "values") => json!({"wavelength_min": 400, "wavelength_max": 700}),
        ("regular", _) => json!({"values": "0.1, 0.2", "wavelength_min": 400, "wavelength_max": 700}),
        ("irregular", "values") => json!({"wavelengths": "400, 700"}),
        ("irregular", "wavelengths") => json!({"values": "0.1, 0.2"}),
        ("polynomial", _) => json!({"x": "0.5, 0.1"}),
        ("gridvolume", "grid") => json!({"filename": "smoke.vdb"}),
        // The sky of a whole year takes its time.
        ("timed_sunsky", _) => json!({"sky_scale": 0}),
        _ => json!({}),
    }
}

fn sample_text(plugin: &str, name: &str) -> &'static str {
    match (plugin, name) {
        (_, "profile") => "0:1, 90:0",
        (_, "focal_length") => "35mm",
        (_, "aovs") => "dd:depth",
        (_, "material") => "Au",
        (_, "heuristic") => "power",
        (_, "grid") => "density",
        (_, "group") => "key",
        ("smoke", _) => "",
        (_, "wavelengths") => "400, 700",
        ("mesh_attribute", _) => "vertex_color",
        _ => "0.5, 0.1",
    }
}

fn sample_file(plugin: &str) -> &'static str {
    match plugin {
        "obj" => "tent.obj",
        "ply" => "ball.ply",
        "serialized" => "solids.serialized",
        "gridvolume" | "smoke" => "smoke.vol",
        "envmap" => "dusk.exr",
        _ => "tiles.png",
    }
}

/// A plugin of the kind `tag`, complete; for the parts of `plugin` where it has such.
fn sample_of(tag: &str, plugin: &str) -> Value {
    match (tag, plugin) {
        ("volume", "cosine") => json!({"type": "wave", "vector": [1, 0, 0]}),
        ("volume", "polynomial") => json!({"type": "term", "powers": [1, 0, 0]}),
        ("shape", "instance") => json!({"type": "shapegroup", "s": {"type": "sphere"}}),
        ("shape", "distant") => json!({"type": "rectangle"}),
        ("shape", _) => json!({"type": "sphere"}),
        ("sensor", "batch") => json!({"type": "perspective"}),
        ("sensor", _) => json!({"type": "irradiancemeter"}),
        ("film", plugin) if sensor::is_meter(plugin) => json!({"type": "hdrfilm", "width": 1, "height": 1}),
        ("film", _) => json!({"type": "hdrfilm"}),
        ("sampler", _) => json!({"type": "independent"}),
        ("rfilter", _) => json!({"type": "box"}),
        ("bsdf", _) => json!({"type": "diffuse"}),
        ("emitter", _) => json!({"type": "area"}),
        ("medium", _) => json!({"type": "homogeneous"}),
        ("phase", _) => json!({"type": "hg"}),
        ("texture", "bumpmap") => json!({"type": "bitmap", "filename": "tiles.png"}),
        ("texture", _) => json!({"type": "checkerboard"}),
        ("volume", "sggx") => json!({"type": "gridvolume", "filename": "flakes.vol"}),
        ("volume", _) => json!({"type": "constvolume"}),
        ("integrator", _) => json!({"type": "path"}),
        _ => unreachable!("{tag}"),
    }
}

/// Values that the row allows: every word, both truths, something inside of a range.
fn samples(plugin: &str, row: &Parameter) -> Vec<Value> {
    match row.kind {
        Kind::Number(range) | Kind::NumberOrName(range) | Kind::Integer(range) => {
            let middle = if range.contains(1.0) { 1.0 } else { 0.5 * (range.low + range.high) };
            let number = match row.name {
                "eta" => 1.5,
                "wavelength_max" => 900.0,
                "window_end_time" => 12.0,
                _ => middle,
            };
            let integer = matches!(row.kind, Kind::Integer(_));
            let least = if row.name == "end_year" { 2026 } else { range.low as i64 };
            vec![if integer { json!(least) } else { json!(number) }]
        }
        Kind::Boolean => vec![json!(true), json!(false)],
        Kind::Choice(words) => words.iter().map(|word| json!(word)).collect(),
        Kind::Text(_) => vec![json!(sample_text(plugin, row.name))],
        Kind::Channels => vec![json!(0.5), json!([0.5, 0, 1])],
        Kind::Vector => vec![json!([1, 0, 0])],
        Kind::Transform => vec![json!([])],
        Kind::Colour(..) | Kind::Texture(..) | Kind::Volume(..) => vec![json!(0.5)],
        Kind::Spectrum => vec![json!({"type": "spectrum", "value": [[400, 0.1], [700, 0.5]]})],
        Kind::File => vec![json!(sample_file(plugin))],
        Kind::Object(tag) => vec![sample_of(tag, plugin)],
        Kind::Nested => vec![sample_of(row.name, plugin)],
        Kind::Ignored { .. } => vec![json!(0)],
    }
}

/// A name for nested plugin number `i` of those of a row.
fn nth(i: usize, row: &Parameter) -> String {
    format!("n{i}_{}", row.name)
}

/// The plugin with all that it needs and, if any, `given`.
fn described(plugin: &str, table: &Table, given: Option<(&Parameter, &Value)>) -> Value {
    let mut object = Map::from_iter([("type".to_owned(), json!(plugin))]);
    let count = |tag: &str| if plugin.starts_with("blend") && tag != "texture" { 2 } else { 1 };
    for row in table.rows().filter(|row| row.default == Default::Required) {
        let value = samples(plugin, row).remove(0);
        match row.kind {
            Kind::Nested => {
                (0..count(row.name)).for_each(|i| drop(object.insert(nth(i, row), value.clone())))
            }
            _ => drop(object.insert(row.name.into(), value)),
        }
    }
    let name = given.map_or("", |(row, _)| row.name);
    let extras = beside(plugin, name);
    object.extend(extras.as_object().unwrap().clone());
    if let Some((row, value)) = given {
        object.insert(if row.kind == Kind::Nested { nth(0, row) } else { row.name.into() }, value.clone());
    }
    object.retain(|_, value| !value.is_null());
    object.into()
}

/// A scene that builds `object`, a plugin of the kind `tag`.
fn scene_of(tag: &str, object: Value) -> Value {
    let plugin = object["type"].as_str().unwrap().to_owned();
    let camera = json!({"type": "perspective"});
    match (tag, plugin.as_str()) {
        ("sensor", "irradiancemeter") => json!({"type": "scene", "a": {"type": "sphere", "m": object}}),
        ("sensor", _) => json!({"type": "scene", "a": object}),
        ("film" | "sampler", _) => json!({"type": "scene", "a": {"type": "perspective", tag: object}}),
        ("rfilter", _) => {
            json!({"type": "scene", "a": {"type": "perspective", "f": {"type": "hdrfilm", "rfilter": object}}})
        }
        ("emitter", "area" | "directionalarea") => {
            json!({"type": "scene", "c": camera, "a": {"type": "rectangle", "e": object}})
        }
        ("shape", "shapegroup") => {
            json!({"type": "scene", "c": camera, "a": {"type": "instance", "g": object}})
        }
        ("volume", "wave") => json!({"type": "scene", "c": camera, "a": {"type": "cosine", "w": object}}),
        ("volume", "term") => json!({"type": "scene", "c": camera, "a": {"type": "polynomial", "t": object}}),
        ("texture", "blackbody") => {
            json!({"type": "scene", "c": camera, "a": {"type": "point", "intensity": object}})
        }
        _ => json!({"type": "scene", "c": camera, "a": object}),
    }
}

fn built(tag: &str, object: Value) -> Result<Vec<String>> {
    let assets = Path::new("scenes/crosscheck/assets");
    let file = tempfile::Builder::new().suffix(".json").tempfile_in(assets).unwrap();
    std::fs::write(file.path(), scene_of(tag, object).to_string()).unwrap();
    let root = format::read(file.path(), &[])?;
    scene::build::build(&root, Overrides::default()).map(|setup| setup.warnings)
}

/// What the files at hand have none of is tested with others (tests/program/smoke.rs, src/volume/grid/tests/files.rs):
/// numbered files, level sets, grids to choose from.
fn needs_other_files(plugin: &str, name: &str, value: &Value) -> bool {
    match (plugin, name) {
        ("smoke", "fps" | "first_frame" | "density_grid" | "color_grid") => true,
        ("gridvolume", "convert") => value == "fog",
        _ => false,
    }
}

/// What is wrong with a row: it must be accepted, and warned of only where it has no effect.
fn faults(tag: &str, plugin: &str, table: &'static Table, row: &Parameter) -> Vec<String> {
    let mut faults = Vec::new();
    let samples = samples(plugin, row).into_iter();
    for value in samples.filter(|value| !needs_other_files(plugin, row.name, value)) {
        let place = format!("{tag} {plugin} {} = {value}", row.name);
        match built(tag, described(plugin, table, Some((row, &value)))) {
            Err(error) => faults.push(format!("{place}: {error}")),
            Ok(warnings) => {
                let unused = warnings.iter().any(|warning| warning.contains("accepted but not used"));
                if unused != (row.kind == Kind::Ignored { silent: false })
                    && (plugin, row.name) != ("d65", "scale")
                {
                    faults.push(format!("{place}: {warnings:?}"));
                }
            }
        }
    }
    faults
}

/// What the reader asked for without a row, and rows that it did not ask for.
fn unread(tag: &str, plugin: &str, table: &'static Table) -> Vec<String> {
    let notes = NOTES.take();
    let of_plugin = || notes.iter().filter(|(of, ..)| of == plugin);
    let without = of_plugin().filter(|(.., known)| !known).map(|(_, name, _)| name.as_str());
    let is_read = |row: &&Parameter| of_plugin().any(|(_, name, _)| name == row.name);
    let unread = table.rows().filter(|row| !row.is_ignored() && !is_read(row)).map(|row| row.name);
    let mut faults: Vec<_> = without.map(|name| format!("{tag} {plugin} has no row {name}")).collect();
    faults.extend(unread.map(|name| format!("{tag} {plugin}: nothing reads {name}")));
    faults
}

#[test]
fn every_row_is_read_and_nothing_is_read_without_a_row() {
    let mut all = Vec::new();
    for (tag, plugin, table) in everything().filter(|(tag, ..)| *tag != "scene") {
        NOTES.take();
        // No grid with a name is kept with the scenes; each shape needs parameters of its own, which have rows too.
        // One on a shape that it refers to is not in one.
        let apart = [("gridvolume", "grid"), ("equipotential", "shape"), ("irradiancemeter", "shape")];
        let rows = table.rows().filter(|row| !apart.contains(&(plugin, row.name)));
        all.extend(rows.flat_map(|row| faults(tag, plugin, table, row)));
        all.extend(unread(tag, plugin, table));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn what_must_be_given_must_be_given() {
    for (tag, plugin, table) in everything().filter(|(tag, ..)| *tag != "scene") {
        for row in table.rows().filter(|row| row.default == Default::Required) {
            let mut object = described(plugin, table, None);
            let is_it = |key: &String| {
                if row.kind == Kind::Nested { key.ends_with(&nth(0, row)[2..]) } else { key == row.name }
            };
            object.as_object_mut().unwrap().retain(|key, _| !is_it(key));
            assert!(
                built(tag, object).is_err() || plugin == "polynomial",
                "{tag} {plugin} without {}",
                row.name
            );
        }
    }
}

/// The files that are made of the tables are as the tables say; TYNDALL_BLESS=1 rewrites them.
fn holds(path: &str, text: &str) {
    let is = std::fs::read_to_string(path).unwrap_or_default();
    if is != text && std::env::var_os("TYNDALL_BLESS").is_some() {
        return std::fs::write(path, text).unwrap();
    }
    assert!(
        is == text,
        "{path} is out of date: TYNDALL_BLESS=1 cargo test --release cli::explain rewrites it"
    );
}

/// A line of a table in Markdown, as often as the plugin has rows.
fn markdown(tag: &str) -> String {
    let tables = plugins(tag);
    let shared =
        |row: &Parameter| tables.len() > 1 && tables.iter().all(|(_, table)| table.rows().any(|r| r == row));
    let written = |row: &Parameter| match row.kind {
        Kind::Nested => format!("({})", row.name),
        _ => format!("`{}`{}", row.name, star(row.ours).replace('*', "\\*")),
    };
    let line = |row: &Parameter| {
        let default = text::default(row);
        let default = default.trim_start_matches("default").trim_start_matches([':', ' ']);
        format!("| {} | {} | {default} | {} |\n", written(row), text::allowed(row), row.about)
    };
    let mut lines = "| | | default | |\n|---|---|---|---|\n".to_owned();
    let common: String =
        tables[0].1.rows().filter(|row| shared(row) && !row.is_ignored()).map(line).collect();
    if !common.is_empty() {
        lines += &format!("| **all** | | | |\n{common}");
    }
    for (index, (name, table)) in tables.iter().enumerate() {
        let star = star(is_ours(tag, name)).replace('*', "\\*");
        lines += &format!("| **`{name}`**{star} | | | {} |\n", table.about);
        let own = table.rows().filter(|row| !shared(row) && !row.is_ignored());
        // What an earlier plugin has too is not said again.
        let before =
            |row: &Parameter| tables[..index].iter().find(|(_, table)| table.rows().any(|r| r == row));
        let (again, first): (Vec<_>, Vec<_>) = own.partition(|row| before(row).is_some());
        lines.extend(first.into_iter().map(line));
        for chunk in again.chunk_by(|a, b| before(a).map(|(name, _)| name) == before(b).map(|(name, _)| name))
        {
            let names: Vec<_> = chunk.iter().map(|row| written(row)).collect();
            let (other, _) = before(chunk[0]).unwrap();
            lines += &format!("| {} | as of `{other}` | | |\n", names.join(", "));
        }
    }
    lines
}

#[test]
fn the_reference_has_every_table() {
    let path = "scenes/REFERENCE.md";
    let mut text = std::fs::read_to_string(path).unwrap();
    for (tag, _) in KINDS {
        let (begin, end) = (format!("<!-- tyndall explain {tag} -->\n"), "<!-- end -->");
        let from = text.find(&begin).unwrap_or_else(|| panic!("{path} has no {begin}")) + begin.len();
        let to = from + text[from..].find(end).unwrap();
        text.replace_range(from..to, &markdown(tag));
    }
    holds(path, &text);
}

/// Every name and word that a scene can hold, for libFuzzer.
#[test]
fn the_fuzzer_knows_every_name() {
    let mut words = std::collections::BTreeSet::from(["ref", "id", "type", "value", "$defaults"]);
    for (_, plugin, table) in everything() {
        words.insert(plugin);
        for row in table.rows() {
            words.insert(row.name);
            words.extend(if let Kind::Choice(choices) = row.kind { choices } else { &[] });
        }
    }
    let lines: String = words.iter().map(|word| format!("\"{word}\"\n")).collect();
    holds(
        "tests/fuzz/scene.dict",
        &format!("# Made from the tables of plugins by cli/explain/tests.rs.\n{lines}"),
    );
}

#[test]
fn examples_can_be_pasted() {
    for (tag, plugin, table) in everything().filter(|(tag, ..)| *tag != "scene") {
        let text = format!("{{{}}}", text::example(plugin, table));
        // These need one of several parameters.
        if text.contains("...") || ["polynomial", "regular", "irregular"].contains(&plugin) {
            continue;
        }
        let example: Value = serde_json::from_str(&text).unwrap();
        let object = example.as_object().unwrap().values().next().unwrap().clone();
        built(tag, object).unwrap_or_else(|error| panic!("{tag} {text}: {error}"));
    }
}

/// True if `value` is as `schema` says, a part of `whole`. What the schema does not use is not known here.
fn is_valid(whole: &Value, schema: &Value, value: &Value) -> bool {
    let valid = |schema: &Value, value: &Value| is_valid(whole, schema, value);
    let items = || value.as_array().map_or(&[][..], Vec::as_slice);
    let object = || value.as_object().into_iter().flatten();
    let number = |fits: fn(f64, f64) -> bool, limit: &Value| {
        value.as_f64().is_none_or(|number| fits(number, limit.as_f64().unwrap()))
    };
    let Some(rules) = schema.as_object() else { return schema == &json!(true) };
    rules.iter().all(|(key, rule)| match key.as_str() {
        "$ref" => valid(whole.pointer(&rule.as_str().unwrap()[1..].replace("%20", " ")).unwrap(), value),
        "const" => rule == value,
        "enum" => rule.as_array().unwrap().contains(value),
        "type" => rule
            .as_array()
            .map_or_else(|| has_type(rule, value), |all| all.iter().any(|one| has_type(one, value))),
        "required" => {
            !value.is_object()
                || rule.as_array().unwrap().iter().all(|key| !value[key.as_str().unwrap()].is_null())
        }
        "properties" => object().all(|(key, value)| rule.get(key).is_none_or(|rule| valid(rule, value))),
        "additionalProperties" => {
            let is_known = |key: &str| schema["properties"].get(key).is_some() || key.starts_with("//");
            object().all(|(key, value)| is_known(key) || valid(rule, value))
        }
        "patternProperties" => *rule == json!({"^//": {}}),
        "allOf" => rule.as_array().unwrap().iter().all(|one| valid(one, value)),
        "anyOf" => rule.as_array().unwrap().iter().any(|one| valid(one, value)),
        "if" => {
            schema.get(if valid(rule, value) { "then" } else { "else" }).is_none_or(|rule| valid(rule, value))
        }
        "items" => items().iter().all(|item| valid(rule, item)),
        "minItems" => items().len() as u64 >= rule.as_u64().unwrap(),
        "maxItems" => items().len() as u64 <= rule.as_u64().unwrap(),
        "minimum" => number(|x, low| x >= low, rule),
        "maximum" => number(|x, high| x <= high, rule),
        "exclusiveMinimum" => number(|x, low| x > low, rule),
        "exclusiveMaximum" => number(|x, high| x < high, rule),
        "pattern" => value.as_str().is_none_or(|text| text.contains('$')),
        "then" | "else" | "description" | "default" | "$schema" | "title" | "definitions" => true,
        other => panic!("the schema uses {other}, which this test does not know"),
    })
}

fn has_type(name: &Value, value: &Value) -> bool {
    match name.as_str().unwrap() {
        "object" => value.is_object(),
        "array" => value.is_array(),
        "string" => value.is_string(),
        "boolean" => value.is_boolean(),
        "integer" => value.as_f64().is_some_and(|number| number.fract() == 0.0),
        "number" => value.is_number(),
        other => panic!("the type {other}"),
    }
}

/// The paths of all values that are not objects, by which scenes are misspelt.
fn leaves(path: &str, value: &Value, found: &mut Vec<String>) {
    for (key, value) in value.as_object().into_iter().flatten().filter(|(key, _)| *key != "$defaults") {
        match value {
            Value::Object(_) => leaves(&format!("{path}/{key}"), value, found),
            _ => found.push(format!("{path}/{key}")),
        }
    }
}

#[test]
fn the_schema_accepts_the_scenes_and_no_misspelt_parameter() {
    let (schema, mut seen) = (schema::of_scenes(), std::collections::BTreeSet::new());
    for folder in ["scenes", "scenes/crosscheck"] {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.extension().is_none_or(|ending| ending != "json") {
                continue;
            }
            let scene: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
            assert!(is_valid(&schema, &schema, &scene), "{}", path.display());
            let mut paths = Vec::new();
            leaves("", &scene, &mut paths);
            for place in paths {
                let (holder, key) = place.rsplit_once('/').unwrap();
                let mut misspelt = scene.clone();
                let object = misspelt.pointer_mut(holder).unwrap().as_object_mut().unwrap();
                let plugin = object["type"].to_string();
                let value = object.remove(key).unwrap();
                object.insert(format!("{key}x"), value);
                if seen.insert((plugin, key.to_owned())) {
                    assert!(!is_valid(&schema, &schema, &misspelt), "{} {place}", path.display());
                }
            }
        }
    }
    assert!(seen.len() > 150, "{} names were misspelt", seen.len());
}
