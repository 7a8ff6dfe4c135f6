//! Scenes in JSON.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tyndall_fuzz::scene("scene.json", data));
