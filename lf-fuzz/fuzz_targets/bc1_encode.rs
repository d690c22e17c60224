//! See `lf_fuzz::bc1_encode`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::bc1_encode::run(data));
