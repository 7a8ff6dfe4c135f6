//! The program `tyndall`: see `tyndall --help`.

fn main() -> std::process::ExitCode {
    tyndall::cli::run()
}
