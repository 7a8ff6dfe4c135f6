//! The program as a user runs it: in a temporary folder with some files, and what came of it.

use exr::prelude::read_first_flat_layer_from_file;
use std::{
    collections::BTreeMap,
    io::Write as _,
    path::PathBuf,
    process::{Command, Output, Stdio},
};
use tempfile::TempDir;

/// A folder in which the program runs.
pub(crate) struct Sandbox(TempDir);

impl Sandbox {
    /// An empty one.
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    /// One with `scene.json` in it.
    pub(crate) fn with_scene(scene: &serde_json::Value) -> Self {
        Self::with_files(&[("scene.json", &scene.to_string())])
    }

    /// One with these files in it, folders made as their names say.
    pub(crate) fn with_files(files: &[(&str, &str)]) -> Self {
        let sandbox = Self::new();
        for (name, text) in files {
            let path = sandbox.path(name);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
        sandbox
    }

    /// Where a file of this name lies.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// Runs the program with `words` as its arguments.
    pub(crate) fn run(&self, words: &str) -> Run {
        let words: Vec<&str> = words.split_whitespace().collect();
        self.run_words(&words)
    }

    /// The same with arguments that may hold spaces.
    pub(crate) fn run_words(&self, words: &[&str]) -> Run {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        let output = program.current_dir(self.0.path()).args(words).output().unwrap();
        Run { words: words.join(" "), output }
    }

    /// Runs a script of the shell, in which `$TYNDALL` is the program.
    #[cfg(unix)]
    pub(crate) fn shell(&self, script: &str) -> Run {
        let mut shell = Command::new("bash");
        let shell = shell.env("TYNDALL", env!("CARGO_BIN_EXE_tyndall")).current_dir(self.0.path());
        let output = shell.args(["-c", script]).output().unwrap();
        Run { words: script.to_owned(), output }
    }

    /// The same as [`Self::run`] with `input` on standard input.
    pub(crate) fn run_with(&self, words: &str, input: &str) -> Run {
        let mut program = Command::new(env!("CARGO_BIN_EXE_tyndall"));
        program.current_dir(self.0.path()).args(words.split_whitespace());
        program.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        let mut child = program.spawn().unwrap();
        // What is refused before it is read leaves a closed pipe.
        let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
        Run { words: words.to_owned(), output: child.wait_with_output().unwrap() }
    }

    /// A file.
    pub(crate) fn bytes(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.path(name)).unwrap()
    }

    /// The channels of an OpenEXR image.
    pub(crate) fn channels(&self, name: &str) -> BTreeMap<String, Vec<f32>> {
        let layer = read_first_flat_layer_from_file(self.path(name)).unwrap().layer_data;
        let list = layer.channel_data.list.into_iter();
        list.map(|c| (c.name.to_string(), c.sample_data.values_as_f32().collect())).collect()
    }

    /// A text file.
    pub(crate) fn text(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap()
    }

    /// A JSON file.
    pub(crate) fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_str(&self.text(name)).unwrap()
    }

    /// Names of all files, hidden ones too.
    pub(crate) fn files(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

/// What came of it.
pub(crate) struct Run {
    words: String,
    output: Output,
}

impl Run {
    /// Exit code, standard output, standard error.
    pub(crate) fn reported(&self) -> (Option<i32>, String, String) {
        (self.output.status.code(), self.out(), self.err())
    }

    /// Exit code; none of a program that was killed.
    pub(crate) fn code(&self) -> Option<i32> {
        self.output.status.code()
    }

    /// Standard output.
    pub(crate) fn out(&self) -> String {
        String::from_utf8(self.output.stdout.clone()).unwrap()
    }

    /// Standard error.
    pub(crate) fn err(&self) -> String {
        String::from_utf8(self.output.stderr.clone()).unwrap()
    }

    /// It ends with this code, without a panic.
    pub(crate) fn ends(self, code: i32) -> Self {
        assert_eq!(self.output.status.code(), Some(code), "{}: {}{}", self.words, self.out(), self.err());
        assert!(!self.err().contains("panicked"), "{}: {}", self.words, self.err());
        self
    }

    /// It ends with code 2, having said all of `hints`.
    pub(crate) fn refuses(self, hints: &[&str]) {
        let run = self.ends(2);
        for hint in hints {
            assert!(run.err().contains(hint), "{}: no \"{hint}\" in: {}", run.words, run.err());
        }
    }
}
