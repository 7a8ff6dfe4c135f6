//! The program `tyndall`: see `tyndall --help`.

use std::process::ExitCode;

fn main() -> ExitCode {
    if !suffices() {
        eprintln!(
            "tyndall: expected a processor with AVX2 and FMA, found an older one\n  remedy: build it on this machine by RUSTFLAGS= cargo build --release"
        );
        return ExitCode::from(2);
    }
    tyndall::cli::run()
}

/// True if the processor has what the program was compiled for (`.cargo/config.toml`).
#[cfg(all(target_arch = "x86_64", target_feature = "avx2", target_feature = "fma"))]
fn suffices() -> bool {
    // The standard library's own test knows the answer when it is compiled.
    let id = raw_cpuid::CpuId::new();
    id.get_extended_feature_info().is_some_and(|info| info.has_avx2())
        && id.get_feature_info().is_some_and(|info| info.has_fma())
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2", target_feature = "fma")))]
fn suffices() -> bool {
    true
}
