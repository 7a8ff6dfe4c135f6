//! Meshes: Mitsuba's `.serialized`.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tyndall_fuzz::shape("serialized", data));
