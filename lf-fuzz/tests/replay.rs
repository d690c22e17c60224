//! Runs every target over its kept inputs, and over bytes without meaning.

use std::path::Path;

use lf_fuzz::TARGETS;

#[test]
fn kept_inputs_do_not_panic() {
    for (name, run) in TARGETS {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("corpus").join(name);
        let entries = std::fs::read_dir(&folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
        let mut count = 0;
        for entry in entries {
            run(&std::fs::read(entry.unwrap().path()).unwrap());
            count += 1;
        }
        println!("{name}: {count} inputs");
        assert!(count >= 20, "{name} has only {count} inputs");
    }
}

#[test]
fn noise_does_not_panic() {
    let mut state = 1u64;
    let mut byte = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 56) as u8
    };
    for len in [0, 1, 7, 64, 300, 1000, 5000] {
        for _ in 0..20 {
            let data: Vec<u8> = (0..len).map(|_| byte()).collect();
            TARGETS.into_iter().for_each(|(_, run)| run(&data));
        }
    }
}
