//! Tools of the operating system that are not everywhere.

use std::io::Write;
use std::process::Command;

/// Whether a command succeeds. If not, what needs it is not tested: this says so, or fails if all must be tested.
pub(crate) fn available(command: &[&str]) -> bool {
    let output = Command::new(command[0]).args(&command[1..]).output();
    let works = output.is_ok_and(|output| output.status.success());
    if !works {
        not_tested(&format!("`{}` does not work here", command.join(" ")));
    }
    works
}

/// Says that something is not tested.
pub(crate) fn not_tested(why: &str) {
    assert!(std::env::var_os("LFSLAB_REQUIRE_FAULTS").is_none_or(|value| value != "1"), "NOT TESTED: {why}");
    // Not by `eprintln`, which is not shown of tests that pass.
    std::io::stderr().write_all(format!("NOT TESTED: {why}\n").as_bytes()).unwrap();
}

/// Whether `strace` may trace and inject.
pub(crate) fn can_inject() -> bool {
    available(&["strace", "-f", "-o", "/dev/null", "-e", "inject=fsync:error=EIO", "true"])
}
