//! See `lf_fuzz::unpack`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::unpack::run(data));
