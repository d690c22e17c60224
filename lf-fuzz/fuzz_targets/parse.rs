//! See `lf_fuzz::parse`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::parse::run(data));
