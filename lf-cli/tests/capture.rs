//! Long work: killed, stopped, resumed and shared out, a capture makes the same bytes.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use tempfile::TempDir;

/// A capture of some seconds in many tiles, of the folder's `field.lfslab` and `depth.lfslab`.
fn command(folder: &Path, more: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_lfslab"));
    let sampling = ["--cameras", "6x5", "--resolution", "260x24", "--planes", "0.3", "--supersample", "2"];
    command.current_dir(folder).args(["capture", "--out", "field.lfslab", "--depth", "depth.lfslab"]);
    command.args(sampling).args(more).stdout(Stdio::piped()).stderr(Stdio::piped());
    command
}

fn run(folder: &Path, more: &[&str]) -> Output {
    command(folder, more).output().expect("the program starts")
}

fn lfslab(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_lfslab")).current_dir(folder).args(arguments).output().expect("the program starts")
}

#[track_caller]
fn succeeds(output: &Output) {
    assert!(output.status.success(), "{}", stderr(output));
}

#[track_caller]
fn fails(output: &Output, words: &[&str]) {
    let stderr = stderr(output);
    assert_eq!(output.status.code(), Some(1), "{stderr}");
    assert!(words.iter().all(|word| stderr.contains(word)) && !stderr.contains("panicked"), "{words:?}: {stderr}");
}

fn stderr(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn files(folder: &Path) -> [Vec<u8>; 2] {
    ["field.lfslab", "depth.lfslab"].map(|name| fs::read(folder.join(name)).unwrap())
}

/// The two files, made in one run.
static EXPECTED: LazyLock<[Vec<u8>; 2]> = LazyLock::new(|| {
    let folder = TempDir::new().unwrap();
    succeeds(&run(folder.path(), &[]));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "the journal is gone");
    for name in ["field.lfslab", "depth.lfslab"] {
        succeeds(&lfslab(folder.path(), &["validate", name]));
    }
    files(folder.path())
});

/// Waits until a running capture has so many bytes in its journal.
fn wait_for(child: &mut Child, journal: &Path, bytes: u64) {
    let start = Instant::now();
    while fs::metadata(journal).map_or(0, |found| found.len()) < bytes {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it could be stopped");
        assert!(start.elapsed() < Duration::from_secs(300), "nothing was written");
        sleep(Duration::from_millis(2));
    }
}

#[test]
fn a_killed_capture_is_resumed_to_the_same_bytes() {
    let (folder, expected) = (TempDir::new().unwrap(), &*EXPECTED);
    let journal = folder.path().join("field.lfslab.part");
    let mut begun = 0;
    // Killed thrice at other moments, the first time perhaps before the header is whole.
    for bytes in [3000, 9000, 15_000] {
        let mut child = command(folder.path(), &["--resume", "--threads", "1"]).spawn().unwrap();
        wait_for(&mut child, &journal, begun + bytes);
        child.kill().unwrap();
        child.wait().unwrap();
        begun = fs::metadata(&journal).unwrap().len();
        assert!(!folder.path().join("field.lfslab").exists());
    }
    fails(&run(folder.path(), &[]), &["field.lfslab.part holds an unfinished capture", "--resume", "--restart"]);
    fails(
        &run(folder.path(), &["--resume", "--whole"]),
        &["--restart", "belongs to another capture", "whole is false"],
    );
    let resumed = run(folder.path(), &["--resume", "--threads", "2"]);
    succeeds(&resumed);
    let kept: usize = stderr(&resumed).split("resume   ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!(kept > 0, "{}", stderr(&resumed));
    assert!(files(folder.path()) == *expected);
    assert!(!journal.exists());
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_what_can_be_resumed_and_says_how() {
    let folder = TempDir::new().unwrap();
    let journal = folder.path().join("field.lfslab.part");
    let mut child = command(folder.path(), &["--threads", "1"]).spawn().unwrap();
    wait_for(&mut child, &journal, 6000);
    fails(&run(folder.path(), &["--resume"]), &["is in use", "wait"]);
    fails(&run(folder.path(), &["--restart"]), &["is in use"]);
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("there is a kill");
    assert!(kill.success());
    let output = child.wait_with_output().unwrap();
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(130), "{said}");
    assert!(said.contains("tiles are in field.lfslab.part; the same command with --resume goes on"), "{said}");
    succeeds(&run(folder.path(), &["--resume"]));
    assert!(files(folder.path()) == *EXPECTED);
    // To begin anew throws the rest away.
    fs::write(&journal, "rubbish").unwrap();
    fails(&run(folder.path(), &["--resume"]), &["field.lfslab.part is not a journal"]);
    succeeds(&run(folder.path(), &["--restart"]));
    assert!(files(folder.path()) == *EXPECTED && !journal.exists());
}

#[test]
fn merged_shards_have_the_same_bytes() {
    let (folder, expected) = (TempDir::new().unwrap(), &*EXPECTED);
    let merge = |journals: &[&str], depth: bool| {
        let depth = if depth { &["--depth", "depth.lfslab"][..] } else { &[] };
        lfslab(folder.path(), &[&["merge", "--out", "field.lfslab"], depth, journals].concat())
    };
    let [first, second, third] = [1, 2, 3].map(|number| format!("field.lfslab.{number}-of-3.part"));
    succeeds(&run(folder.path(), &["--shard", "1/3"]));
    succeeds(&run(folder.path(), &["--shard", "3/3", "--resume"]));
    let mut child = command(folder.path(), &["--shard", "2/3", "--threads", "1"]).spawn().unwrap();
    wait_for(&mut child, &folder.path().join(&second), 5000);
    child.kill().unwrap();
    child.wait().unwrap();
    fails(&merge(&[&first, &third], true), &["the journals of shards 2 of 3 are missing"]);
    fails(&merge(&[&first, &second, &third], true), &["2-of-3.part lacks", "--resume"]);
    succeeds(&run(folder.path(), &["--shard", "2/3", "--resume"]));
    // A shard that is finished stays so.
    succeeds(&run(folder.path(), &["--shard", "2/3", "--resume"]));
    fails(&merge(&[&first, &second, &third], false), &["--depth FILE"]);
    fs::copy(folder.path().join(&first), folder.path().join("copy")).unwrap();
    fails(&merge(&[&first, &second, "copy", &third], true), &["shard 1/3 is there twice", "copy"]);
    fs::write(folder.path().join("other"), expected[0].as_slice()).unwrap();
    fails(&merge(&[&first, &second, "other"], true), &["other is not a journal"]);
    assert!(!folder.path().join("field.lfslab").exists());
    succeeds(&merge(&[&third, &first, &second], true));
    assert!(files(folder.path()) == *expected);
    assert_eq!(lfslab(folder.path(), &["capture", "--out", "x.lfslab", "--shard", "4/3"]).status.code(), Some(2));
}

#[test]
fn cube_maps_hold_radiance_and_distance() {
    let folder = TempDir::new().unwrap();
    let points = ["--at", "0,1.4,0", "--at", "-1,2,1.5"];
    succeeds(&lfslab(folder.path(), &[&["cubemap", "--size", "8", "--out", "cubes"][..], &points].concat()));
    assert_eq!(fs::read_dir(folder.path().join("cubes")).unwrap().count(), 12);
    let picture = exr::prelude::read_first_flat_layer_from_file(folder.path().join("cubes/1-posy.exr")).unwrap();
    let channels = &picture.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "Z"]);
    // The ceiling of the museum is 2 m above the point: along z = 2·√(1 + a² + b²), a and b being the slopes.
    let distances: Vec<f32> = channels[3].sample_data.values_as_f32().collect();
    for (index, distance) in distances.iter().enumerate() {
        let [a, b] = [index % 8, index / 8].map(|i| (2 * i + 1) as f32 / 8.0 - 1.0);
        let expected = 2.0 * (1.0 + a * a + b * b).sqrt();
        assert!((distance - expected).abs() < 1e-4 || *distance < expected, "{index}: {distance} {expected}");
    }
    assert!(distances.iter().any(|distance| *distance > 2.0));
    assert_eq!(lfslab(folder.path(), &["cubemap", "--at", "1,2", "--out", "cubes"]).status.code(), Some(2));
}

/// A capture of 64×64 cameras of 256×256 texels, 1.6 milliard of them, streams to the disk: a part of it in little memory.
#[cfg(target_os = "linux")]
#[test]
fn a_large_capture_takes_little_memory() {
    if std::env::var_os("LFSLAB_LONG").is_none() {
        // Past the capture of the test harness.
        let _ = writeln!(std::io::stderr(), "NOT TESTED: needs LFSLAB_LONG=1");
        return;
    }
    let folder = TempDir::new().unwrap();
    let large = ["--cameras", "64", "--resolution", "256", "--supersample", "1", "--quality", "fast"];
    let mut child = Command::new(env!("CARGO_BIN_EXE_lfslab"))
        .current_dir(folder.path())
        .args(["capture", "--planes", "faces", "--out", "large.lfslab", "--shard", "1/64"])
        .args(large)
        .spawn()
        .unwrap();
    let mut most = 0;
    while child.try_wait().unwrap().is_none() {
        let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse().ok());
        most = most.max(kib.unwrap_or(0));
        sleep(Duration::from_millis(20));
    }
    assert!(child.wait().unwrap().success());
    println!("{most} KiB");
    assert!((1..1_500_000u64).contains(&most), "{most} KiB");
}
