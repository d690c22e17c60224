//! Steps that are run, timed and, when one fails, reported so that it can be run again alone.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::Command;
use std::time::{Duration, Instant};

/// The workspace's root; every command runs there.
pub(crate) fn workspace_root() -> PathBuf {
    let mut root = PathBuf::from(env!("CARGO_MANIFEST_DIR"));
    root.pop();
    root
}

/// A command with the variables set for it alone.
#[derive(Debug, Clone)]
pub(crate) struct CommandLine {
    pub(crate) variables: Vec<(&'static str, OsString)>,
    pub(crate) words: Vec<String>,
}

impl CommandLine {
    /// A command from words set apart by spaces.
    pub(crate) fn new(words: &str) -> Self {
        Self { variables: Vec::new(), words: words.split_whitespace().map(str::to_owned).collect() }
    }

    pub(crate) fn with(mut self, name: &'static str, value: impl Into<OsString>) -> Self {
        self.variables.push((name, value.into()));
        self
    }

    pub(crate) fn command(&self) -> Command {
        let mut command = Command::new(&self.words[0]);
        let variables = self.variables.iter().map(|(name, value)| (name, value));
        command.args(&self.words[1..]).envs(variables).current_dir(workspace_root());
        command
    }

    /// The command as it would be typed into a shell.
    pub(crate) fn shell_line(&self) -> String {
        let variables = self.variables.iter().map(|(name, value)| format!("{name}='{}' ", value.to_string_lossy()));
        variables.collect::<String>() + &self.words.join(" ")
    }

    /// Runs it to its end with its output on the terminal; an error says what went wrong and how to repeat it.
    pub(crate) fn run(&self) -> Result<(), String> {
        let outcome = match self.command().status() {
            Ok(status) if status.success() => return Ok(()),
            Ok(status) => status.to_string(),
            Err(error) => format!("cannot start {}: {error}", self.words[0]),
        };
        Err(format!("{outcome}\nrun it again: {}", self.shell_line()))
    }
}

/// Runs steps in order and remembers how long each took.
#[derive(Debug)]
pub(crate) struct Runner {
    start: Instant,
    total: usize,
    done: Vec<(String, Duration)>,
}

impl Runner {
    /// A runner for `total` steps.
    pub(crate) fn new(total: usize) -> Self {
        Self { start: Instant::now(), total, done: Vec::new() }
    }

    /// Runs one step under a heading.
    pub(crate) fn step<T>(&mut self, name: &str, body: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
        eprintln!("\n=== {}/{} {name}", self.done.len() + 1, self.total);
        let start = Instant::now();
        let value = body().map_err(|error| format!("step {name:?} failed: {error}"))?;
        self.done.push((name.to_owned(), start.elapsed()));
        Ok(value)
    }

    /// Prints what was run and how long it took.
    pub(crate) fn summary(&self) {
        let width = self.done.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        println!();
        for (name, time) in &self.done {
            println!("{name:width$}  {:7.1} s", time.as_secs_f64());
        }
        println!("all {} steps passed in {:.1} s", self.done.len(), self.start.elapsed().as_secs_f64());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn failures_name_the_step_and_the_command() {
        let line = CommandLine::new("cargo xtask-that-is-not-there").with("NAME", "a b");
        assert_eq!(line.shell_line(), "NAME='a b' cargo xtask-that-is-not-there");
        let missing = CommandLine::new("./no-such-program --flag");
        let error = Runner::new(1).step("example", || missing.run()).unwrap_err();
        assert!(error.starts_with("step \"example\" failed: cannot start ./no-such-program"), "{error}");
        assert!(error.ends_with("run it again: ./no-such-program --flag"), "{error}");
    }
}
