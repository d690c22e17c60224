//! Disks and limits that are too small.

use std::error::Error;
use std::fs::{self, File};
use std::io::{self, Seek, SeekFrom, Write};
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::Command;
use std::time::Duration;

use lf_format::{AtomicFile, FormatError};

use crate::child::{Ending, chain, command, start};
use crate::folder::Folder;
use crate::sample::{NEW, OLD, identify};
use crate::tools::{available, can_inject, not_tested};

const BIG: crate::sample::Sample = crate::sample::Sample { tiles: 60, seed: 3 };
/// Mounts a small file system on a folder where only this process sees it, and goes on as another program.
const IN_SMALL_DISK: [&str; 6] = [
    "unshare",
    "-rm",
    "sh",
    "-c",
    r#"mount -t tmpfs -o size=128k,nr_inodes=4 tmpfs "$(dirname "$LFSLAB_FAULTS_TARGET")" && exec "$@""#,
    "sh",
];

#[test]
fn a_full_disk_leaves_the_old_file() {
    let folder = Folder::new();
    let mount = r#"mount -t tmpfs tmpfs "$1""#;
    if !available(&["unshare", "-rm", "sh", "-c", mount, "sh", folder.path("").to_str().unwrap()]) {
        return;
    }
    let ending = Ending::of(command(&IN_SMALL_DISK, "fill", folder.target()));
    assert!(ending.saved(), "{ending:?}");
    eprint!("{}", ending.message);
    assert!(!folder.target().exists(), "it was on the small disk");
}

/// What a child does on a disk of 32 pages, of which the old file has 5: the new one, 4 pages, with every number of pages free.
pub(crate) fn fill_disk(target: &Path) {
    let folder = target.parent().unwrap();
    let holds = |among: &[_]| identify(&fs::read(target).unwrap(), among);
    OLD.save(target).unwrap();
    let mut saved = 0;
    for free in 0..27 {
        OLD.save(target).unwrap();
        let filler = folder.join("filler");
        fs::write(&filler, vec![1; (27 - free) * 4096]).unwrap();
        match NEW.save(target) {
            Ok(_) => saved += usize::from(holds(&[NEW]) == NEW),
            Err(error) => assert!(is_full(&error) && holds(&[OLD]) == OLD, "{}", chain(&error)),
        }
        assert_eq!(fs::read_dir(folder).unwrap().count(), 2);
        fs::remove_file(filler).unwrap();
    }
    assert_eq!(saved, 23);
    assert!(is_full(&BIG.save(target).unwrap_err()));
    // Of 4 nodes the root has one and the file one.
    let fillers = ["one", "two"].map(|name| folder.join(name));
    fillers.iter().for_each(|path| drop(File::create(path).unwrap()));
    assert!(is_full(&OLD.save(target).unwrap_err()));
    assert_eq!(holds(&[NEW]), NEW);
    eprintln!("full disk: {saved} of 27 saved, none torn");
}

fn is_full(error: &FormatError) -> bool {
    matches!(error, FormatError::Io { source, .. } if source.kind() == io::ErrorKind::StorageFull)
}

#[test]
fn a_device_that_is_always_full_reports_it_and_is_not_replaced() {
    let device = Path::new("/dev/full");
    if !device.exists() {
        return not_tested("there is no /dev/full");
    }
    assert!(is_full(&NEW.write_to(File::options().write(true).open(device).unwrap()).unwrap_err()));
    let error = NEW.save(device).unwrap_err();
    assert!(chain(&error).starts_with("could not write /dev/full: there is something that is not a regular file"));
    assert!(!fs::metadata(device).unwrap().is_file());
}

/// Saves under a limit on the size of files, which a shell counts in units of 512 or 1024 bytes.
fn save_limited(folder: &Folder, units: u32, on_signal: &str) -> Ending {
    let script = format!(r#"{on_signal}; ulimit -c 0; ulimit -f {units}; exec "$@""#);
    Ending::of(command(&["sh", "-c", &script, "sh"], &format!("save {NEW}"), folder.target()))
}

#[test]
fn a_limit_on_file_sizes_leaves_the_old_file() {
    let mut counts = [0; 3];
    for units in (0..30).step_by(3) {
        let folder = Folder::with(OLD);
        let saved = save_limited(&folder, units, "trap '' XFSZ").saved();
        assert_eq!(folder.holds(&[OLD, NEW]), if saved { NEW } else { OLD });
        assert!(folder.temporaries().is_empty());
        counts[usize::from(saved)] += 1;
        // Without the trap the signal kills.
        let ending = save_limited(&folder, units, "true");
        assert_eq!(ending.status.signal().is_some(), !saved, "{ending:?}");
        assert_eq!(folder.holds(&[OLD, NEW]), if saved { NEW } else { OLD });
        assert_eq!(folder.temporaries().len(), usize::from(!saved));
        counts[2] += usize::from(!saved);
    }
    assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
    eprintln!("file size limits: {} refused, {} saved, {} killed; none torn", counts[0], counts[1], counts[2]);
}

/// The system takes a part of what it is given, up to a limit, and the rest when the limit is raised.
#[test]
fn a_write_that_is_cut_short_is_continued() {
    if !can_inject() || !available(&["prlimit"]) {
        return;
    }
    let folder = Folder::with(OLD);
    let log = folder.path("log");
    let script = r#"trap '' XFSZ; ulimit -S -f 12; exec strace -f -o "$0" -e trace=write -e inject=write:delay_exit=400000 "$@""#;
    let (mut child, id) =
        start(command(&["sh", "-c", script, log.to_str().unwrap()], &format!("save {NEW}"), folder.target()));
    let is_cut = || folder.temporaries().iter().any(|path| fs::metadata(path).is_ok_and(|file| file.len() >= 12 * 512));
    while child.try_wait().unwrap().is_none() && !is_cut() {
        std::thread::sleep(Duration::from_millis(5));
    }
    let raise = Command::new("prlimit").args(["--pid", &id.to_string(), "--fsize=unlimited"]).status().unwrap();
    assert!(raise.success() && child.wait().unwrap().success());
    assert_eq!(folder.holds(&[OLD, NEW]), NEW);
    let log = fs::read_to_string(log).unwrap();
    assert!(log.lines().filter_map(asked_and_written).any(|(asked, written)| (1..asked).contains(&written)), "{log}");
}

/// Of a line of a trace, such as `17 write(4, "…"..., 4096) = 512 (DELAYED)`.
fn asked_and_written(line: &str) -> Option<(u64, u64)> {
    let (call, result) = line.split_once(") = ")?;
    let asked = call.rsplit_once(", ")?.1.parse().ok()?;
    Some((asked, result.split(' ').next()?.parse().ok()?))
}

/// Takes at most a few bytes at a time, and is interrupted in between.
struct Stuttering<W> {
    out: W,
    turn: usize,
}

impl<W: Write> Write for Stuttering<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.turn += 1;
        if self.turn.is_multiple_of(3) {
            return Err(io::ErrorKind::Interrupted.into());
        }
        self.out.write(&bytes[..bytes.len().min(1 + self.turn % 97)])
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

impl<W: Seek> Seek for Stuttering<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.out.seek(to)
    }
}

#[test]
fn many_short_and_interrupted_writes_make_the_same_file() -> Result<(), Box<dyn Error>> {
    let folder = Folder::with(OLD);
    let file = NEW.write_to(Stuttering { out: AtomicFile::create(&folder.target())?, turn: 0 })?;
    assert_eq!(file.out.commit()?, NEW.bytes().len() as u64);
    assert_eq!(folder.holds(&[OLD, NEW]), NEW);
    Ok(())
}
