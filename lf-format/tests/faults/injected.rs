//! Errors and deaths at every system call that a save makes.

use std::fs;
use std::os::unix::process::ExitStatusExt;

use crate::child::{BEGIN, END, Ending, command};
use crate::folder::{Folder, age};
use crate::sample::{NEW, OLD};
use crate::tools::can_inject;

/// A system call of a save: `nth` is its place among those of this name that the thread makes.
#[derive(Debug)]
struct Call {
    thread: String,
    name: String,
    nth: usize,
    text: String,
}

/// The system calls of a save that concern files, in order.
fn trace() -> Vec<Call> {
    let folder = prepared();
    let log = folder.path("log");
    let wrapper = ["strace", "-f", "-o", log.to_str().unwrap(), "-y", "-s", "0", "-e", "trace=%file,%desc"];
    let ending = Ending::of(command(&wrapper, &format!("save {NEW}"), folder.target()));
    assert!(ending.saved());
    between_markers(calls(&fs::read_to_string(log).unwrap()))
}

/// The calls that a trace lists, of all threads.
fn calls(log: &str) -> Vec<Call> {
    let mut calls: Vec<Call> = Vec::new();
    for (call, text) in log.lines().filter_map(|line| line.split_once('(')) {
        let Some((thread, name)) = call.split_once(' ') else { continue };
        let (thread, name) = (thread.to_owned(), name.trim_start().to_owned());
        let nth = 1 + calls.iter().filter(|call| call.thread == thread && call.name == name).count();
        calls.push(Call { thread, name, nth, text: text.to_owned() });
    }
    calls
}

/// Those of the thread that saves, from marker to marker.
fn between_markers(mut calls: Vec<Call>) -> Vec<Call> {
    let at = |marker: &str| calls.iter().position(|call| call.text.contains(marker)).expect("a marker");
    let (begin, end) = (at(BEGIN), at(END));
    let thread = calls[begin].thread.clone();
    let save = calls.drain(begin + 1..end).filter(|call| call.thread == thread).collect::<Vec<_>>();
    let elsewhere = |call: &&Call| calls.iter().any(|other| other.name == call.name && other.nth == call.nth);
    assert!(save.iter().find(elsewhere).is_none(), "other threads come to: {:?}", save.iter().find(elsewhere));
    save
}

/// A folder with the old file, and something to sweep.
fn prepared() -> Folder {
    let folder = Folder::with(OLD);
    folder.add_leftover("left");
    folder
}

/// Saves the new file while `inject` is in force.
fn save_under(folder: &Folder, inject: &[&str]) -> Ending {
    let mut wrapper = vec!["strace", "-f", "-o", "/dev/null"];
    wrapper.extend(inject.iter().flat_map(|inject| ["-e", inject]));
    Ending::of(command(&wrapper, &format!("save {NEW}"), folder.target()))
}

/// Names for `strace`, and numbers on Linux.
const ERRORS: [(&str, i32); 10] = [
    ("EINTR", 4),
    ("EIO", 5),
    ("EACCES", 13),
    ("EXDEV", 18),
    ("EINVAL", 22),
    ("EMFILE", 24),
    ("EFBIG", 27),
    ("ENOSPC", 28),
    ("EROFS", 30),
    ("EDQUOT", 122),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Outcome {
    Saved,
    /// The error is reported, the old file is there.
    Refused,
    /// The error is reported, the new file is there.
    RefusedInPlace,
}

/// What the documentation of `AtomicFile` says.
fn expected(call: &Call, error: &str) -> Outcome {
    let of_sweep = call.text.contains("-left.tmp") || call.text.contains("O_DIRECTORY");
    match call.name.as_str() {
        "flock" | "close" | "fcntl" | "getdents64" | "fstat" | "newfstatat" => Outcome::Saved,
        _ if of_sweep => Outcome::Saved,
        // Begun again.
        "openat" | "write" | "fsync" if error == "EINTR" => Outcome::Saved,
        "fsync" if call.text.contains(".tmp>") => Outcome::Refused,
        "fsync" if error == "EINVAL" => Outcome::Saved,
        "fsync" => Outcome::RefusedInPlace,
        _ => Outcome::Refused,
    }
}

fn outcome(folder: &Folder, ending: &Ending) -> Outcome {
    match (ending.saved(), folder.holds(&[OLD, NEW]) == NEW) {
        (true, true) => Outcome::Saved,
        (false, false) => Outcome::Refused,
        (false, true) => Outcome::RefusedInPlace,
        (true, false) => panic!("not saved, and nothing said: {ending:?}"),
    }
}

#[test]
fn every_error_of_every_call_leaves_the_old_file_or_the_new_one() {
    if !can_inject() {
        return;
    }
    let mut calls = trace();
    // Rust's standard library panics if a folder that it has listed cannot be closed; no file system is known to say so.
    let listed = calls.iter().rposition(|call| call.name == "getdents64").unwrap();
    assert_eq!(calls.remove(listed + 1).name, "close");
    let mut counts = [0; 3];
    for (call, (error, number)) in calls.iter().flat_map(|call| ERRORS.map(|error| (call, error))) {
        let folder = prepared();
        let ending = save_under(&folder, &[&format!("inject={}:error={error}:when={}", call.name, call.nth)]);
        let outcome = outcome(&folder, &ending);
        assert_eq!(outcome, expected(call, error), "{error} at {call:?}: {ending:?}");
        let text = std::io::Error::from_raw_os_error(number).to_string();
        assert!(outcome == Outcome::Saved || ending.message.contains(&text), "{error} at {call:?}: {ending:?}");
        let left = folder.temporaries().into_iter().filter(|path| !path.ends_with(".lfslab-left.tmp"));
        assert_eq!(left.count(), 0, "{error} at {call:?}: {ending:?}");
        counts[outcome as usize] += 1;
    }
    let [saved, refused, in_place] = counts;
    eprintln!("errors injected: {saved} borne, {refused} refused, {in_place} after the rename; none torn");
}

#[test]
fn death_at_every_call_leaves_the_old_file_or_the_new_one() {
    if !can_inject() {
        return;
    }
    let calls = trace();
    let rename = calls.iter().position(|call| call.name.starts_with("rename")).unwrap();
    for (i, call) in calls.iter().enumerate() {
        let folder = prepared();
        let ending = save_under(&folder, &[&format!("inject={}:signal=KILL:when={}", call.name, call.nth)]);
        assert_eq!(ending.status.signal(), Some(9), "at {call:?}: {ending:?}");
        let found = folder.holds(&[OLD, NEW]);
        assert!(i == rename || found == if i < rename { OLD } else { NEW }, "{found} at {call:?}");
        folder.temporaries().iter().for_each(|path| age(path));
        OLD.save(&folder.target()).unwrap();
        assert_eq!((folder.holds(&[OLD]), folder.temporaries().len()), (OLD, 0));
    }
    eprintln!("killed at each of {} calls; none torn", calls.len());
}

/// A file that cannot be removed when saving fails stays for a later save to sweep.
#[test]
fn the_first_error_is_told_even_if_nothing_can_be_removed() {
    if !can_inject() {
        return;
    }
    let folder = Folder::with(OLD);
    let ending = save_under(&folder, &["inject=fsync:error=EIO", "inject=unlink,unlinkat:error=EROFS"]);
    assert_eq!(outcome(&folder, &ending), Outcome::Refused);
    assert!(ending.message.contains("os error 5"), "{ending:?}");
    let [left] = &folder.temporaries()[..] else { panic!("{:?}", folder.temporaries()) };
    age(left);
    NEW.save(&folder.target()).unwrap();
    assert_eq!((folder.holds(&[NEW]), folder.temporaries().len()), (NEW, 0));
}

/// After a loss of power a name that leads to the new file must find all its bytes, so they are flushed first.
#[test]
fn bytes_are_flushed_before_the_rename_and_the_folder_after() {
    if !can_inject() {
        return;
    }
    let calls = trace();
    let last = |name: &str, text: &str| {
        calls.iter().rposition(|call| call.name.starts_with(name) && call.text.contains(text)).expect("a call")
    };
    let first = |name: &str, text: &str| {
        calls.iter().position(|call| call.name.starts_with(name) && call.text.contains(text)).expect("a call")
    };
    let rename = first("rename", "field.lfslab");
    assert!(last("write", ".tmp>") < first("fsync", ".tmp>") && first("fsync", ".tmp>") < rename, "{calls:?}");
    let after = &calls[rename..];
    assert!(after.iter().any(|call| call.name == "fsync" && !call.text.contains("lfslab")), "{calls:?}");
    assert!(!after.iter().any(|call| call.name.contains("write")), "{calls:?}");
}
