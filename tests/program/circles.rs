//! Files of a folder that use each other all around can only be read together: no such circle has more than [`MOST`] of them.

use crate::layering::{is_test, sources, without_comments};
use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
};

const MOST: usize = 6;

/// Names from the root of the crate.
type Name = Vec<String>;

/// Which modules each module of a crate uses, whether by name or through a module that passes it on.
#[derive(Default)]
struct Imports {
    of: BTreeMap<Name, BTreeSet<Name>>,
}

impl Imports {
    /// Of files by their modules.
    fn new(files: &[(Name, String)]) -> Self {
        let known: BTreeSet<&Name> = files.iter().map(|(module, _)| module).collect();
        let used = |(module, text): &(Name, String)| {
            let code = without_comments(text.split("#[cfg(test)]\nmod tests").next().unwrap());
            let places = names(&code).into_iter().filter_map(|name| full(module, name));
            let modules = places.filter_map(|name| {
                (1..=name.len()).rev().find_map(|n| known.get(&name[..n].to_vec()).copied())
            });
            (module.clone(), modules.filter(|used| *used != module).cloned().collect())
        };
        Self { of: files.iter().map(used).collect() }
    }

    /// All that `module` uses within its folder, and what those use.
    fn reached<'a>(&'a self, module: &'a Name) -> BTreeSet<&'a Name> {
        let (mut found, mut open) = (BTreeSet::new(), vec![module]);
        while let Some(next) = open.pop() {
            let near = self.of.get(next).into_iter().flatten().filter(|used| used[0] == module[0]);
            open.extend(near.filter(|used| found.insert(*used)));
        }
        found
    }

    /// The largest circle.
    fn circle(&self) -> BTreeSet<&Name> {
        let all: BTreeMap<_, _> = self.of.keys().map(|name| (name, self.reached(name))).collect();
        let is_back =
            |name, other| all.get(other).is_some_and(|theirs: &BTreeSet<&Name>| theirs.contains(name));
        let circles = all.iter().map(|(name, reached)| {
            reached.iter().copied().filter(|other| is_back(*name, *other)).collect::<BTreeSet<_>>()
        });
        circles.max_by_key(BTreeSet::len).unwrap_or_default()
    }
}

/// The name that `name` is in `module`, from the root; none of other crates.
fn full(module: &Name, name: Name) -> Option<Name> {
    let mut base = module.clone();
    let rest = match name.first()?.as_str() {
        "crate" => {
            base.clear();
            &name[1..]
        }
        "self" => &name[1..],
        "super" => {
            let up = name.iter().take_while(|part| *part == "super").count();
            base.truncate(base.len().saturating_sub(up));
            &name[up..]
        }
        _ => &name[..],
    };
    base.extend(rest.iter().cloned());
    Some(base)
}

/// Every name that is imported, and every other that starts at the crate or above.
fn names(code: &str) -> Vec<Name> {
    let is_use = |at: usize| !code[..at].ends_with("pub(in ");
    let starts = |word: &'static str| {
        code.match_indices(word).filter(|(at, _)| is_use(*at)).map(|(at, _)| &code[at..])
    };
    let is_import = |line: &str| line.trim_end().ends_with(')') || ["", "pub"].contains(&line.trim());
    let imports =
        code.match_indices("use ").filter(|(at, _)| is_import(code[..*at].rsplit('\n').next().unwrap()));
    let trees = imports.filter_map(|(at, word)| code[at + word.len()..].split(';').next());
    let imported = trees.flat_map(|tree| expanded(&[], tree));
    let path = |rest: &str| -> Name {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':')).unwrap_or(rest.len());
        rest[..end].split("::").map(String::from).collect()
    };
    // What ends in `::` is the beginning of an imported tree.
    let others = starts("crate::")
        .chain(starts("super::"))
        .map(path)
        .filter(|name| name.last().is_some_and(|last| !last.is_empty()));
    imported.chain(others.collect::<Vec<_>>()).collect()
}

/// The names of a tree such as `a::{b, c::{d, e as f}}` behind `before`.
fn expanded(before: &[String], tree: &str) -> Vec<Name> {
    let (path, branches) = tree.trim().split_once('{').unwrap_or((tree.trim(), ""));
    let path = path.split(" as ").next().unwrap();
    let mut name = before.to_vec();
    name.extend(path.split("::").map(str::trim).filter(|part| !part.is_empty()).map(String::from));
    match branches.strip_suffix('}') {
        None => vec![name],
        Some(inside) => branches_of(inside).into_iter().flat_map(|branch| expanded(&name, branch)).collect(),
    }
}

/// Parts between the commas outside of braces.
fn branches_of(text: &str) -> Vec<&str> {
    let mut depth = 0;
    let parts = text.split(|c| {
        depth += match c {
            '{' => 1,
            '}' => -1,
            _ => 0,
        };
        c == ',' && depth == 0
    });
    parts.filter(|part| !part.trim().is_empty()).collect()
}

/// The module that a file below `src` is.
fn module(file: &Path) -> Name {
    let parts = file.with_extension("");
    let parts = parts.iter().map(|part| part.to_str().unwrap().to_owned());
    parts.filter(|part| part != "mod").collect()
}

#[test]
fn no_import_circle_is_large() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let inside = |file: &Path| file.strip_prefix(&source).unwrap().to_owned();
    let files = sources(&source).into_iter().filter(|file| !is_test(&inside(file)));
    let files: Vec<_> =
        files.map(|file| (module(&inside(&file)), fs::read_to_string(&file).unwrap())).collect();
    let imports = Imports::new(&files);
    let circle: Vec<String> = imports.circle().iter().map(|name| name.join("::")).collect();
    assert!(circle.len() <= MOST, "{} files that use each other: {}", circle.len(), circle.join(", "));
}

#[test]
fn circles_are_seen() {
    let of = |files: &[(&str, &str)]| {
        let named = |(module, text): &(&str, &str)| {
            (module.split("::").map(String::from).collect(), (*text).to_owned())
        };
        let files: Vec<_> = files.iter().map(named).collect();
        Imports::new(&files).circle().len()
    };
    assert_eq!(of(&[("a", "use b::C;"), ("a::b", "use super::{X, Y};")]), 2);
    assert_eq!(of(&[("a", "mod b;"), ("a::b", "use super::{X, Y};")]), 0);
    assert_eq!(
        of(&[
            ("a::b", "use super::{c::{D, E as F}, G};"),
            ("a::c", "fn f() -> crate::a::b::C {}"),
            ("a", "")
        ]),
        2
    );
    assert_eq!(
        of(&[
            ("a::b", "use crate::a::c::D;"),
            ("a::c", "// super::b\n#[cfg(test)]\nmod tests {use super::b;}")
        ]),
        0
    );
    assert_eq!(of(&[("a::b", "use crate::c::D;"), ("c", "use crate::a::b::E;")]), 0);
}
