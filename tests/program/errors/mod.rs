//! What is said of broken scenes, word for word. Every message is there to be read in `messages.txt`.
//!
//! After a change that is meant, `TYNDALL_BLESS=1 cargo test --test program errors` writes that file again;
//! the difference is to be read like code.

mod cases;
#[cfg(target_os = "linux")]
mod commands;

use cases::{Case, File};
use std::{fmt::Write as _, fs, path::Path};
use tyndall::{
    error::{Error, Result},
    format,
    scene::{self},
    settings::Overrides,
};

/// Reads and builds the scene of `case`; what is said of it, without the folder that it stood in, and all warnings.
fn outcome(case: &Case) -> std::result::Result<Vec<String>, Error> {
    let desk = tempfile::tempdir().unwrap();
    for File { name, content } in &case.files {
        let path = desk.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }
    let definitions: Vec<_> =
        case.definitions.iter().map(|(n, v)| ((*n).to_owned(), (*v).to_owned())).collect();
    let built: Result<_> = format::read(&desk.path().join(case.main()), &definitions)
        .and_then(|root| scene::build::build(&root, Overrides::default()));
    let folder = format!("{}/", desk.path().display());
    let real = format!("{}/", desk.path().canonicalize().unwrap().display());
    let plain = |text: String| {
        text.replace(&real, "").replace(&folder, "").replace(folder.trim_end_matches('/'), ".")
    };
    match built {
        Ok(setup) => Ok(setup.warnings.into_iter().map(plain).collect()),
        Err(Error { place, expected, found, remedy }) => Err(Error {
            place: plain(place),
            expected: plain(expected),
            found: plain(found),
            remedy: plain(remedy),
        }),
    }
}

/// The messages of all cases, as the file holds them.
fn messages(cases: &[Case]) -> String {
    let mut text = String::new();
    for case in cases {
        let message = match outcome(case) {
            Err(error) => format!("error: {error}"),
            Ok(warnings) if warnings.is_empty() => "nothing is said".into(),
            Ok(warnings) => warnings.iter().map(|w| format!("warning: {w}")).collect::<Vec<_>>().join("\n"),
        };
        writeln!(text, "# {}\n{}\n{message}\n", case.name, case.shown()).unwrap();
    }
    text
}

#[test]
fn messages_are_as_written_down() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/errors/messages.txt");
    let found = messages(&cases::all());
    #[cfg(target_os = "linux")]
    let found = found + &commands::messages();
    if std::env::var_os("TYNDALL_BLESS").is_some() {
        fs::write(&file, &found).unwrap();
    }
    let expected = fs::read_to_string(&file).unwrap().replace("\r\n", "\n");
    let (mut before, mut after) = (expected.split("\n\n"), found.split("\n\n"));
    loop {
        match (before.next(), after.next()) {
            (None, None) => break,
            (before, after) => assert_eq!(before, after, "TYNDALL_BLESS=1 writes {} anew", file.display()),
        }
    }
}

/// Every message says where, what would be right, what is there, and what to do.
#[test]
fn messages_have_all_their_parts() {
    for case in cases::all() {
        let Error { place, expected, found, remedy } = match outcome(&case) {
            Err(error) => error,
            Ok(warnings) => {
                assert!(case.is_warned && !warnings.is_empty(), "{} passes in silence", case.name);
                continue;
            }
        };
        assert!(!case.is_warned, "{}: {expected}, {found}", case.name);
        let is_located =
            case.files.iter().any(|file| place.starts_with(file.name)) || place == "the command line";
        assert!(is_located || place.starts_with(case.main()), "{}: {place}", case.name);
        for part in [&expected, &found, &remedy] {
            assert!(!part.trim().is_empty(), "{}: {place}: {expected}, {found}; {remedy}", case.name);
        }
        let whole = format!("{place}{expected}{found}{remedy}");
        assert!(!whole.contains("/tmp") && whole.len() < 2000, "{}: {whole}", case.name);
    }
}

#[test]
fn there_are_many_and_each_has_its_name() {
    let mut names: Vec<_> = cases::all().into_iter().map(|case| case.name).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!((names.len(), count >= 80), (count, true));
}
