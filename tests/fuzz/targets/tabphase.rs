//! Values of a tabulated phase function.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tyndall_fuzz::phase_table(data));
