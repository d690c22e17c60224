//! See `lf_fuzz::import`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::import::run(data));
