//! See `lf_fuzz::bc1_decode`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::bc1_decode::run(data));
