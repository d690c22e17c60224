//! See `lf_fuzz::tile`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::tile::run(data));
