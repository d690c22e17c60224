//! A sweep and a save that meet at the same temporary file: `strace` holds one of them up at the wrong moment.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;
use std::process::Child;
use std::thread;
use std::time::Duration;

use crate::child::{command, start};
use crate::folder::{Folder, age};
use crate::sample::{NEW, OLD};
use crate::tools::can_inject;

/// A child that saves the new file and stops for two seconds before its first call of this name.
fn start_slowly(folder: &Folder, call: &str) -> Child {
    let inject = format!("inject={call}:delay_enter=2000000:when=1");
    start(command(&["strace", "-f", "-o", "/dev/null", "-e", &inject], &format!("save {NEW}"), folder.target())).0
}

/// Whether someone holds a lock on a file. To try it would get in the way of those who want it.
fn is_locked(path: &Path) -> bool {
    let inode = format!(":{} ", fs::metadata(path).unwrap().ino());
    fs::read_to_string("/proc/locks").unwrap().lines().any(|lock| lock.contains("FLOCK") && lock.contains(&inode))
}

fn wait_until(mut happens: impl FnMut() -> bool) {
    for _ in 0..2000 {
        if happens() {
            return;
        }
        thread::sleep(Duration::from_millis(5));
    }
    panic!("it does not happen");
}

/// A process that is stopped between making and locking its file, or whose clock is a minute off, loses it to a sweep.
#[test]
fn a_file_swept_before_it_is_locked_is_made_anew() {
    if !can_inject() {
        return;
    }
    let folder = Folder::with(OLD);
    let mut child = start_slowly(&folder, "flock");
    wait_until(|| !folder.temporaries().is_empty());
    age(&folder.temporaries()[0]);
    OLD.save(&folder.target()).unwrap();
    assert!(folder.temporaries().is_empty() && child.try_wait().unwrap().is_none(), "it must be stopped still");
    assert!(child.wait().unwrap().success());
    assert_eq!((folder.holds(&[OLD, NEW]), folder.temporaries().len()), (NEW, 0));
}

/// Else the owner could get the lock and lose the file after that.
#[test]
fn a_sweep_removes_a_file_under_its_lock() {
    if !can_inject() {
        return;
    }
    let folder = Folder::with(OLD);
    let left = folder.add_leftover("left");
    let mut child = start_slowly(&folder, "unlink");
    wait_until(|| is_locked(&left));
    thread::sleep(Duration::from_millis(200));
    assert!(is_locked(&left) && child.try_wait().unwrap().is_none(), "it must be stopped still");
    assert!(child.wait().unwrap().success());
    assert_eq!((folder.holds(&[OLD, NEW]), folder.temporaries().len()), (NEW, 0));
}
