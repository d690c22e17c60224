//! `cargo xtask test`: what a change must pass, cheapest first.

use std::path::Path;

use crate::steps::{CommandLine, Runner, workspace_root};
use crate::{third_party, vulkan};

/// Runs every check in order and stops at the first that fails.
pub(crate) fn run(long: bool) -> Result<(), String> {
    let crates = packages(&workspace_root())?;
    let (before, after) = (checks(), tests(&crates, long));
    let mut runner = Runner::new(before.len() + 1 + after.len() + 1);
    for (name, line) in before {
        runner.step(&name, || line.run())?;
    }
    let variables = runner.step("Vulkan device", vulkan::prepare)?;
    for (name, mut line) in after {
        line.variables.extend(variables.iter().cloned());
        runner.step(&name, || line.run())?;
    }
    runner.step("other people's readers", third_party::run)?;
    runner.summary();
    Ok(())
}

/// What needs no graphics device.
fn checks() -> Vec<(String, CommandLine)> {
    let docs = CommandLine::new("cargo doc --workspace --no-deps --locked").with("RUSTDOCFLAGS", "-D warnings");
    vec![
        ("formatting".to_owned(), CommandLine::new("cargo fmt --all --check")),
        ("clippy".to_owned(), CommandLine::new("cargo clippy --workspace --all-targets --locked -- -D warnings")),
        ("documentation".to_owned(), docs),
    ]
}

/// What runs code: the tests of each crate alone, since a crate by itself may get fewer features of its dependencies than
/// in the whole workspace.
fn tests(crates: &[String], long: bool) -> Vec<(String, CommandLine)> {
    let mut steps = Vec::new();
    for name in crates {
        let mut line = CommandLine::new(&format!("cargo test -p {name} --locked"));
        if long {
            line = line.with("LFSLAB_LONG", "1");
        }
        steps.push((format!("tests of {name}"), line));
    }
    for name in ["lf-math", "lf-format"] {
        let no_std = CommandLine::new(&format!("cargo test -p {name} --no-default-features --locked"));
        steps.push((format!("tests of {name} without std"), no_std));
    }
    let fuzz = "cargo check -p lf-fuzz --features libfuzzer --locked";
    steps.push(("fuzz targets compile".to_owned(), CommandLine::new(fuzz)));
    if long {
        let benches =
            "cargo bench -p lf-bench -p lf-compress -p lf-ibr -p lf-scene -p lf-tests --benches --locked -- --test";
        steps.push(("each benchmark once".to_owned(), CommandLine::new(benches)));
    }
    steps
}

/// The workspace's packages: the folders with a `Cargo.toml`; a folder that is not called as its package is renamed.
fn packages(root: &Path) -> Result<Vec<String>, String> {
    let entries = std::fs::read_dir(root).map_err(|error| format!("cannot list {}: {error}", root.display()))?;
    let folders = entries.filter_map(Result::ok).filter(|entry| entry.path().join("Cargo.toml").is_file());
    let names = folders.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = names.map(|name| if name == "tests" { "lf-tests".to_owned() } else { name }).collect();
    names.sort_unstable();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_package_is_tested_alone() {
        let crates = packages(&workspace_root()).unwrap();
        for name in ["lf-bench", "lf-cli", "lf-math", "lf-report", "lf-tests", "xtask"] {
            assert!(crates.iter().any(|found| found == name), "{crates:?}");
        }
        assert_eq!(tests(&crates, false).len(), crates.len() + 3);
        assert_eq!(tests(&crates, true).len(), crates.len() + 4);
    }

    #[test]
    fn long_sets_its_variable_for_the_tests() {
        let lines: Vec<String> = tests(&["lf-math".to_owned()], true).iter().map(|(_, l)| l.shell_line()).collect();
        assert_eq!(lines[0], "LFSLAB_LONG='1' cargo test -p lf-math --locked");
    }
}
