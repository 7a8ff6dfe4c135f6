//! The modules stand in layers: each may use its own layer and those above it in [`LAYERS`], none below.
//! `lib.rs` lists them in the same order.

use std::{
    fs,
    path::{Path, PathBuf},
};

/// From what everything uses to what uses everything.
const LAYERS: &[&[&str]] = &[
    &["error", "inputs", "math", "memory", "sampling"],
    &["description"],
    &["phase", "texture", "volume"],
    &["medium", "bsdf", "shape", "emitter", "sensor"],
    &["film"],
    &["settings"],
    &["format"],
    &["scene"],
    &["guide"],
    &["transport"],
    &["first_pass"],
    &["passes"],
    &["learning"],
    &["render"],
    &["analysis"],
    &["cli"],
];

/// What transport must not know of: files, threads, clocks, JSON, printing.
const FOREIGN_TO_TRANSPORT: &[&str] = &[
    "std::fs",
    "std::thread",
    "std::time",
    "std::io",
    "serde_json",
    "rayon",
    "println!",
    "eprintln!",
    "print!",
];

fn layer(module: &str) -> Option<usize> {
    LAYERS.iter().position(|layer| layer.contains(&module))
}

/// A line that breaks a rule.
struct Breach {
    line: usize,
    rule: String,
}

/// Checks the text of a file of `module`. Tests may use what they like.
fn check(module: &str, text: &str) -> Vec<Breach> {
    let code = without_comments(text.split("#[cfg(test)]\nmod tests {").next().unwrap());
    let own = layer(module).unwrap_or_else(|| panic!("no layer for the module {module}: add it to LAYERS"));
    let mut breaches: Vec<Breach> = used_modules(&code)
        .filter_map(|(line, used)| match layer(&used) {
            Some(other) if other > own => Some(Breach { line, rule: format!("{module} may not use {used}") }),
            Some(_) => None,
            None => Some(Breach { line, rule: format!("{used} has no layer: add it to LAYERS") }),
        })
        .collect();
    if module == "transport" {
        for (index, line) in code.lines().enumerate() {
            for foreign in FOREIGN_TO_TRANSPORT.iter().filter(|foreign| line.contains(**foreign)) {
                let rule = format!("transport knows no files, threads, clocks, JSON or printing ({foreign})");
                breaches.push(Breach { line: index + 1, rule });
            }
        }
    }
    breaches
}

/// Comments blanked out, lines kept.
pub(crate) fn without_comments(text: &str) -> String {
    text.lines().map(|line| line.split("//").next().unwrap()).collect::<Vec<_>>().join("\n")
}

/// Every module named after `crate::`, alone or in braces, with its line.
fn used_modules(code: &str) -> impl Iterator<Item = (usize, String)> + '_ {
    code.match_indices("crate::").filter(|(at, _)| !code[..*at].ends_with('$')).flat_map(
        move |(at, found)| {
            let rest = &code[at + found.len()..];
            let names = if rest.starts_with('{') { names_in_braces(rest) } else { vec![(0, name_at(rest))] };
            let start = at + found.len();
            names
                .into_iter()
                .map(move |(offset, name)| (code[..start + offset].matches('\n').count() + 1, name))
        },
    )
}

fn name_at(text: &str) -> String {
    text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
}

/// First names of the items of `{a::b, c::{d, e}}`, with their places.
fn names_in_braces(text: &str) -> Vec<(usize, String)> {
    let (mut depth, mut names, mut expecting) = (0, Vec::new(), false);
    for (at, c) in text.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        match c {
            '{' | ',' if depth == 1 => expecting = true,
            _ if expecting && depth == 1 && (c.is_alphabetic() || c == '_') => {
                names.push((at, name_at(&text[at..])));
                expecting = false;
            }
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    names
}

pub(crate) fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_dir() {
            found.extend(sources(&entry));
        } else if entry.extension().is_some_and(|extension| extension == "rs") {
            found.push(entry);
        }
    }
    found.sort();
    found
}

/// True for files that only tests compile.
pub(crate) fn is_test(file: &Path) -> bool {
    file.components()
        .any(|part| ["tests", "tests.rs", "testing.rs"].iter().any(|name| part.as_os_str() == *name))
}

#[test]
fn imports_point_up_the_layers_only() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut breaches = Vec::new();
    for file in sources(&source) {
        let inside = file.strip_prefix(&source).unwrap();
        let module = inside.iter().next().unwrap().to_str().unwrap().trim_end_matches(".rs");
        if is_test(inside) || ["lib", "main"].contains(&module) {
            continue;
        }
        let found = check(module, &fs::read_to_string(&file).unwrap());
        breaches.extend(found.iter().map(|b| format!("src/{}:{}: {}", inside.display(), b.line, b.rule)));
    }
    assert!(breaches.is_empty(), "imports against the layers:\n{}", breaches.join("\n"));
}

#[test]
fn every_module_has_its_layer_in_the_order_of_the_map() {
    let map = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("src/lib.rs")).unwrap();
    let listed = map.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    let layers: Vec<usize> =
        listed.map(|name| layer(name).unwrap_or_else(|| panic!("no layer: {name}"))).collect();
    assert!(layers.is_sorted(), "lib.rs lists a module before one that it uses: {layers:?}");
    assert_eq!(layers.len(), LAYERS.concat().len(), "LAYERS names a module that lib.rs does not");
}

#[test]
fn breaches_are_seen() {
    let lines = |module: &str, text: &str| check(module, text).iter().map(|b| b.line).collect::<Vec<_>>();
    assert_eq!(lines("medium", "use crate::scene::Scene;"), [1]);
    assert_eq!(
        lines("medium", "\nuse crate::{\n    error::Result,\n    film::{Film, math},\n    phase,\n};"),
        [4]
    );
    assert_eq!(lines("scene", "fn f() -> crate::transport::Options {}"), [1]);
    assert_eq!(lines("scene", "// crate::transport\nuse crate::film::Film;"), [0usize; 0]);
    assert_eq!(lines("transport", "use std::time::Instant;"), [1]);
    assert_eq!(
        lines("transport", "use crate::math;\n#[cfg(test)]\nmod tests {\n use crate::cli;"),
        [0usize; 0]
    );
}
