//! Long work: killed, stopped, resumed and shared out, a capture makes the same bytes.

use std::fs;
use std::io::Write;
use std::path::Path;
use std::process::{Child, Command, Output, Stdio};
use std::sync::LazyLock;
use std::thread::sleep;
use std::time::{Duration, Instant};

use glam::Vec3;
use lf_scene::{Tracer, museum};
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

/// How many tiles a resumed capture found.
fn found_tiles(resumed: &Output) -> usize {
    succeeds(resumed);
    stderr(resumed).split("resume   ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap()
}

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
    assert!(found_tiles(&resumed) > 0, "{}", stderr(&resumed));
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

/// A disk that fills up, as a limit on the size of files shows it.
#[cfg(unix)]
#[test]
fn a_capture_that_a_full_disk_ended_goes_on_to_the_same_bytes() {
    let folder = TempDir::new().unwrap();
    let whole = command(folder.path(), &["--threads", "2"]);
    // A shell counts in units of 512 or 1024 bytes: two to four of six tiles. Without the trap the signal would kill.
    let line = r#"trap '' XFSZ; ulimit -f 140; exec "$@""#;
    let mut limited = Command::new("sh");
    limited.args(["-c", line, "sh"]).arg(whole.get_program()).args(whole.get_args()).current_dir(folder.path());
    let full = limited.output().expect("there is a shell");
    fails(&full, &["tiles are in field.lfslab.part", "--resume", "could not write field.lfslab.part: "]);
    assert_eq!(stderr(&full).lines().filter(|line| line.starts_with("error: ")).count(), 1);
    assert!(!folder.path().join("field.lfslab").exists());
    let resumed = run(folder.path(), &["--resume"]);
    assert!(found_tiles(&resumed) > 0, "{}", stderr(&resumed));
    assert!(files(folder.path()) == *EXPECTED);
}

#[test]
fn a_file_is_not_written_over_another_of_the_same_run() {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("sub")).unwrap();
    let absolute = folder.path().join("x.lfslab").to_string_lossy().into_owned();
    for depth in ["x.lfslab", "./x.lfslab", "sub/../x.lfslab", &absolute] {
        let output = lfslab(folder.path(), &["capture", "--out", "x.lfslab", "--depth", depth]);
        fails(&output, &["x.lfslab is there twice, as --out and as --depth"]);
    }
    let output = lfslab(folder.path(), &["capture", "--out", "x.lfslab", "--depth", "x.lfslab.part"]);
    fails(&output, &["x.lfslab.part is there twice, as the journal and as --depth"]);
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing was begun");
    ["1.part", "2.part"].iter().for_each(|name| fs::write(folder.path().join(name), name).unwrap());
    for (arguments, words) in [
        (["--out", "./2.part", "1.part", "2.part"], "2.part is there twice, as journal 2 and as --out"),
        (
            ["--out", "x.lfslab", "--depth=sub/../1.part", "1.part"],
            "1.part is there twice, as journal 1 and as --depth",
        ),
        (["--out", "x.lfslab", "1.part", "sub/../1.part"], "1.part is there twice, as journal 1 and as journal 2"),
    ] {
        fails(&lfslab(folder.path(), &[&["merge"][..], &arguments].concat()), &[words]);
    }
    assert!(["1.part", "2.part"].iter().all(|name| fs::read(folder.path().join(name)).unwrap() == name.as_bytes()));
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("1.part", folder.path().join("link")).unwrap();
        fails(&lfslab(folder.path(), &["merge", "--out", "link", "1.part"]), &["link is there twice"]);
    }
}

#[test]
fn a_journal_outlives_a_restart_that_cannot_begin() {
    let folder = TempDir::new().unwrap();
    let journal = folder.path().join("field.lfslab.part");
    fs::write(&journal, "hours of work").unwrap();
    fails(&run(folder.path(), &["--restart", "--scene", "musuem"]), &["musuem"]);
    assert_eq!(fs::read(&journal).unwrap(), b"hours of work");
}

/// In a log there is no bar: lines say how far it is, how fast, and how long it will take.
#[test]
fn a_log_tells_how_far_a_capture_is() {
    let folder = TempDir::new().unwrap();
    let output = lfslab(folder.path(), &["capture", "--cameras", "3", "--resolution", "10", "--out", "x.lfslab"]);
    succeeds(&output);
    let log = stderr(&output);
    let lines: Vec<&str> = log.lines().filter(|line| line.contains(" million rays/s, ")).collect();
    assert!(lines.len() >= 2 && lines.iter().all(|line| line.ends_with(" left")), "{log}");
    let percents: Vec<u32> =
        lines.iter().map(|line| line.split_whitespace().nth(1).unwrap().parse().unwrap()).collect();
    assert!(percents.is_sorted() && percents[0] < 100 && percents.last() == Some(&100), "{log}");
    // For people: no control sequences.
    assert!(!log.contains('\u{1b}') && !log.contains('\r'), "{log}");
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
    let (tracer, point) = (Tracer::new(museum::scene()), Vec3::new(-1.0, 2.0, 1.5));
    // The images' right and down, as Vulkan has them.
    for (face, forward, right, down) in [
        ("posx", Vec3::X, Vec3::NEG_Z, Vec3::NEG_Y),
        ("negx", Vec3::NEG_X, Vec3::Z, Vec3::NEG_Y),
        ("posy", Vec3::Y, Vec3::X, Vec3::Z),
        ("negy", Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z),
        ("posz", Vec3::Z, Vec3::X, Vec3::NEG_Y),
        ("negz", Vec3::NEG_Z, Vec3::NEG_X, Vec3::NEG_Y),
    ] {
        let found = cube_face(&folder.path().join(format!("cubes/1-{face}.exr")));
        for (index, &[r, g, b, z]) in found.iter().enumerate() {
            let [x, y] = [index % 8, index / 8].map(|i| (2 * i + 1) as f32 / 8.0 - 1.0);
            let direction = forward + x * right + y * down;
            assert_eq!(Vec3::new(r, g, b), tracer.trace(point, direction).radiance, "{face} {index}");
            let distance = tracer.distance(point, direction).unwrap() * direction.length();
            assert!((z - distance).abs() <= 1e-5 * distance, "{face} {index}: {z} {distance}");
        }
    }
    // Closed form: the ceiling is 2 m above the point, along z = 2·√(1 + a² + b²), a and b being the slopes. Something hangs below it.
    let above = cube_face(&folder.path().join("cubes/1-posy.exr"));
    let ceiling = above.iter().enumerate().filter(|(index, [.., z])| {
        let [a, b] = [index % 8, index / 8].map(|i| (2 * i + 1) as f32 / 8.0 - 1.0);
        let expected = 2.0 * (1.0 + a * a + b * b).sqrt();
        assert!(*z < expected + 1e-4, "{index}: {z} {expected}");
        (z - expected).abs() < 1e-4
    });
    let ceiling = ceiling.count();
    assert!(ceiling >= 48, "{ceiling} of 64 texels show the ceiling");
    assert_eq!(lfslab(folder.path(), &["cubemap", "--at", "1,2", "--out", "cubes"]).status.code(), Some(2));
}

/// The texels of a cube map's face, row after row: R, G, B, Z.
fn cube_face(path: &Path) -> Vec<[f32; 4]> {
    let picture = exr::prelude::read_first_flat_layer_from_file(path).unwrap();
    let channels = &picture.layer_data.channel_data.list;
    let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
    assert_eq!(names, ["B", "G", "R", "Z"]);
    let [b, g, r, z] = [0, 1, 2, 3].map(|i| channels[i].sample_data.values_as_f32().collect::<Vec<f32>>());
    (0..z.len()).map(|i| [r[i], g[i], b[i], z[i]]).collect()
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
