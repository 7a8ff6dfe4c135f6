//! Runs a command of the Python package `validation/` on the program under test.

use std::process::Command;

/// Runs `python3 -m validation` with these arguments; panics with its table unless everything in it holds.
pub fn must_hold(arguments: &[&str]) {
    let output = Command::new("python3")
        .args(["-m", "validation"])
        .args(arguments)
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .env("TYNDALL_BINARY", env!("CARGO_BIN_EXE_tyndall"))
        .output()
        .expect("python3 must be installed and on the PATH");
    let (table, messages) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "python3 -m validation {}\n{table}\n{messages}", arguments.join(" "));
}
