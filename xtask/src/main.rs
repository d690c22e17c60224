//! Development tasks of this workspace: `cargo xtask test` runs every check that a change must pass.

#![forbid(unsafe_code)]

mod apt;
mod steps;
mod test;
mod third_party;
mod vulkan;

use std::process::ExitCode;

const USAGE: &str = "\
Usage: cargo xtask <TASK>

Tasks:
  test [--long]   run every check: formatting, clippy, docs, all tests on a Vulkan device, each crate compiled alone,
                  other people's programs on our files;
                  installs a software Vulkan driver if there is no adapter, Python and Node if they are missing
                  (Debian, Ubuntu; as root)
                  --long: also the slow tests (LFSLAB_LONG=1) and each benchmark once
  help            print this
";

#[derive(Debug, PartialEq, Eq)]
enum Task {
    Test { long: bool },
    Help,
}

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args_os().skip(1).map(|a| a.to_string_lossy().into_owned()).collect();
    match parse(&arguments) {
        Ok(Task::Help) => {
            print!("{USAGE}");
            ExitCode::SUCCESS
        }
        Ok(Task::Test { long }) => match test::run(long) {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                eprintln!("\n{failure}");
                ExitCode::FAILURE
            }
        },
        Err(problem) => {
            eprint!("{problem}\n\n{USAGE}");
            ExitCode::from(2)
        }
    }
}

fn parse(arguments: &[String]) -> Result<Task, String> {
    let (task, rest) = arguments.split_first().ok_or("no task given")?;
    let mut long = false;
    for argument in rest {
        match (task.as_str(), argument.as_str()) {
            (_, "--help" | "-h") => return Ok(Task::Help),
            ("test", "--long") => long = true,
            _ => return Err(format!("unknown argument {argument:?} of the task {task:?}")),
        }
    }
    match task.as_str() {
        "test" => Ok(Task::Test { long }),
        "help" | "--help" | "-h" => Ok(Task::Help),
        _ => Err(format!("unknown task {task:?}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments() {
        let parse = |line: &str| parse(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
        assert_eq!(parse("test"), Ok(Task::Test { long: false }));
        assert_eq!(parse("test --long"), Ok(Task::Test { long: true }));
        for help in ["help", "--help", "-h", "test --help"] {
            assert_eq!(parse(help), Ok(Task::Help), "{help}");
        }
        for wrong in ["", "tests", "test --fast", "test long", "help --long"] {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }
}
