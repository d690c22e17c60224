//! See `lf_fuzz::gltf`.

#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| lf_fuzz::gltf::run(data));
