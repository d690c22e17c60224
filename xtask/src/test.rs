//! `cargo xtask test`: what a change must pass, cheapest first.

use std::path::Path;

use crate::steps::{CommandLine, Runner, workspace_root};
use crate::vulkan;

/// Runs every check in order and stops at the first that fails.
pub(crate) fn run(long: bool) -> Result<(), String> {
    let crates = library_crates(&workspace_root())?;
    let (before, after) = (checks(), tests(&crates, long));
    let mut runner = Runner::new(before.len() + 1 + after.len());
    for (name, line) in before {
        runner.step(&name, || line.run())?;
    }
    let variables = runner.step("Vulkan device", vulkan::prepare)?;
    for (name, mut line) in after {
        line.variables.extend(variables.iter().cloned());
        runner.step(&name, || line.run())?;
    }
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

/// What runs code. A crate by itself may get fewer features of its dependencies than in the whole workspace, so each
/// is compiled alone too.
fn tests(crates: &[String], long: bool) -> Vec<(String, CommandLine)> {
    let mut all = CommandLine::new("cargo test --workspace --locked");
    if long {
        all = all.with("LFSLAB_LONG", "1");
    }
    let no_std = CommandLine::new("cargo test -p lf-math --no-default-features --locked");
    let mut steps = vec![("all tests".to_owned(), all), ("lf-math without std".to_owned(), no_std)];
    for name in crates {
        let alone = CommandLine::new(&format!("cargo check -p {name} --all-targets --locked"));
        steps.push((format!("{name} alone"), alone));
    }
    if long {
        let benches = "cargo bench -p lf-compress -p lf-ibr -p lf-scene --benches --locked -- --test";
        steps.push(("each benchmark once".to_owned(), CommandLine::new(benches)));
    }
    steps
}

/// The workspace's libraries: folders `lf-*` with a `src/lib.rs`, by name.
fn library_crates(root: &Path) -> Result<Vec<String>, String> {
    let entries = std::fs::read_dir(root).map_err(|error| format!("cannot list {}: {error}", root.display()))?;
    let folders = entries.filter_map(Result::ok).filter(|entry| entry.path().join("src/lib.rs").is_file());
    let mut names: Vec<String> = folders.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.retain(|name| name.starts_with("lf-"));
    names.sort_unstable();
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_library_is_compiled_alone() {
        let crates = library_crates(&workspace_root()).unwrap();
        for name in ["lf-math", "lf-report"] {
            assert!(crates.iter().any(|found| found == name), "{crates:?}");
        }
        assert_eq!(tests(&crates, false).len(), crates.len() + 2);
        assert_eq!(tests(&crates, true).len(), crates.len() + 3);
    }

    #[test]
    fn long_sets_its_variable_for_all_tests_only() {
        let lines: Vec<String> = tests(&["lf-math".to_owned()], true).iter().map(|(_, l)| l.shell_line()).collect();
        assert_eq!(lines[0], "LFSLAB_LONG='1' cargo test --workspace --locked");
        assert!(lines[1..].iter().all(|line| !line.contains("LFSLAB_LONG")), "{lines:?}");
    }
}
