//! Volumes: OpenVDB.
#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| tyndall_fuzz::volume("vdb", data));
