//! This program, started again to save files in a process that can be made to fail.

use std::error::Error;
use std::ffi::OsStr;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};

use crate::full;
use crate::sample::Sample;

const JOB: &str = "LFSLAB_FAULTS_JOB";
const TARGET: &str = "LFSLAB_FAULTS_TARGET";
/// Exit status of a child that was told of an error and said so.
const REFUSED: i32 = 3;
/// Nothing is there. A child looks at these before and after it saves, so that a trace shows where that begins and ends.
pub(crate) const BEGIN: &str = "/lfslab-faults-begin";
pub(crate) const END: &str = "/lfslab-faults-end";

/// The way in. Among the other tests it does nothing.
#[test]
fn entry() {
    let (Ok(job), Some(target)) = (std::env::var(JOB), std::env::var_os(TARGET)) else { return };
    println!("\nready {}", std::process::id());
    if let Err(error) = run(&job, Path::new(&target)) {
        eprintln!("{}", chain(&*error));
        std::process::exit(REFUSED);
    }
    std::process::exit(0);
}

fn run(job: &str, target: &Path) -> Result<(), Box<dyn Error>> {
    let words: Vec<&str> = job.split(' ').collect();
    match words[..] {
        ["save", sample] => {
            let sample: Sample = sample.parse()?;
            count_on();
            let _ = std::fs::metadata(BEGIN);
            let saved = sample.save(target);
            let _ = std::fs::metadata(END);
            saved?;
        }
        ["repeat", times, one, two] => {
            let samples: [Sample; 2] = [one.parse()?, two.parse()?];
            for i in 0..times.parse()? {
                samples[i % 2].save(target)?;
            }
        }
        ["fill"] => full::fill_disk(target),
        _ => return Err(format!("no job {job}").into()),
    }
    Ok(())
}

/// Makes calls like those of a save. `strace` injects into the nth call of each thread: this gives those of a save numbers
/// that the main thread does not come to.
fn count_on() {
    for _ in 0..100 {
        let _ = std::fs::metadata("/");
        let _ = std::fs::read_dir("/").map(Iterator::count);
    }
}

/// What went wrong, and why, and why, in one line.
pub(crate) fn chain(error: &dyn Error) -> String {
    let causes = std::iter::successors(Some(error), |&error| error.source());
    causes.map(ToString::to_string).collect::<Vec<_>>().join(": ")
}

/// A command that does a job on a target; `wrapper` is the beginning of a command line that runs it.
pub(crate) fn command(wrapper: &[&str], job: &str, target: impl AsRef<OsStr>) -> Command {
    let program = std::env::current_exe().unwrap();
    let entry = ["child::entry", "--exact", "--nocapture", "--test-threads=1"];
    let mut command = match wrapper {
        [] => Command::new(program),
        [first, rest @ ..] => {
            let mut command = Command::new(first);
            command.args(rest).arg(program);
            command
        }
    };
    command.args(entry).env(JOB, job).env(TARGET, target);
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

/// How a child ended.
#[derive(Debug)]
pub(crate) struct Ending {
    pub(crate) status: ExitStatus,
    pub(crate) message: String,
}

impl Ending {
    pub(crate) fn of(mut command: Command) -> Self {
        let output = command.output().unwrap();
        Self { status: output.status, message: String::from_utf8_lossy(&output.stderr).into_owned() }
    }

    /// Whether it saved; if not, it must have been told of an error and said so.
    #[track_caller]
    pub(crate) fn saved(&self) -> bool {
        match self.status.code() {
            Some(0) => true,
            Some(REFUSED) => {
                assert!(self.message.starts_with("could not "), "{self:?}");
                false
            }
            _ => panic!("{self:?}"),
        }
    }
}

/// Starts a child and waits until it begins its job; returns its process id too, which is not that of a wrapper.
pub(crate) fn start(mut command: Command) -> (Child, u32) {
    let mut child = command.spawn().unwrap();
    let lines = BufReader::new(child.stdout.as_mut().unwrap()).lines();
    let id = lines.map_while(Result::ok).find_map(|line| line.strip_prefix("ready ")?.parse().ok());
    (child, id.expect("the child begins"))
}
