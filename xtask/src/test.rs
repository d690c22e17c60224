//! `cargo xtask test`: what a change must pass, cheapest first.

use std::path::Path;

use crate::steps::{CommandLine, Runner, workspace_root};
use crate::{third_party, vulkan};

/// The crate whose tests make the system's calls fail.
const FAULTY: &str = "lf-format";

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

/// What runs code: all tests with the features that the whole workspace asks of its dependencies, so that those are compiled once. By itself a crate
/// may get fewer, so each is compiled alone, too. Files are made to fail by counting the calls of a process, which no thread of another
/// crate's dependencies may disturb: the tests of lf-format run alone.
fn tests(crates: &[String], long: bool) -> Vec<(String, CommandLine)> {
    let test = |name: &str, packages: &str| {
        let line = CommandLine::new(&format!("cargo test {packages} --locked"));
        (format!("tests of {name}"), if long { line.with("LFSLAB_LONG", "1") } else { line })
    };
    let mut steps = vec![
        test("the workspace", &format!("--workspace --exclude {FAULTY}")),
        test(FAULTY, &format!("-p {FAULTY}")),
        test("lf-math without std", "-p lf-math --no-default-features"),
        test("lf-format without std", "-p lf-format --no-default-features"),
    ];
    let alone = |name: &String| (format!("{name} alone"), CommandLine::new(&format!("cargo check -p {name} --locked")));
    steps.extend(crates.iter().map(alone));
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
    fn every_package_is_tested_and_compiled_alone() {
        let crates = packages(&workspace_root()).unwrap();
        for name in ["lf-bench", "lf-cli", "lf-math", "lf-report", "lf-tests", "xtask"] {
            assert!(crates.iter().any(|found| found == name), "{crates:?}");
        }
        let lines: Vec<String> = tests(&crates, false).iter().map(|(_, line)| line.shell_line()).collect();
        for line in [
            "cargo test --workspace --exclude lf-format --locked",
            "cargo test -p lf-format --locked",
            "cargo check -p lf-gpu --locked",
        ] {
            assert!(lines.iter().any(|found| found == line), "{lines:?}");
        }
        assert_eq!(tests(&crates, true).len(), lines.len() + 1);
    }

    #[test]
    fn long_sets_its_variable_for_the_tests() {
        let lines: Vec<String> = tests(&["lf-math".to_owned()], true).iter().map(|(_, l)| l.shell_line()).collect();
        assert_eq!(lines[1], "LFSLAB_LONG='1' cargo test -p lf-format --locked");
    }
}
