//! Processes that are killed, and processes that save to the same path, while others read.

use std::fs::{self, File};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use lf_format::{AtomicFile, FileReader, Limits};

use crate::child::{command, start};
use crate::folder::{Folder, age};
use crate::sample::{Sample, identify};

const SMALL: Sample = Sample { tiles: 20, seed: 4 };
const LARGE: Sample = Sample { tiles: 35, seed: 5 };
const BOTH: [Sample; 2] = [SMALL, LARGE];
const KILLS: u32 = 100;

/// Runs `work` while two readers check the file again and again; returns how often they did.
fn while_read(target: &Path, work: impl FnOnce()) -> [usize; 2] {
    let done = AtomicBool::new(false);
    let count = |read: fn(&Path)| {
        let mut count = 0;
        while !done.load(Ordering::Relaxed) {
            read(target);
            count += 1;
        }
        count
    };
    thread::scope(|scope| {
        let readers = [read_whole as fn(&Path), read_by_pieces].map(|read| scope.spawn(move || count(read)));
        let stop = Stop(&done);
        work();
        drop(stop);
        readers.map(|reader| reader.join().unwrap())
    })
}

/// Stops the readers, also when the work panics.
struct Stop<'a>(&'a AtomicBool);

impl Drop for Stop<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

fn read_whole(target: &Path) {
    identify(&fs::read(target).unwrap(), &BOTH);
}

/// The file may be replaced between one piece and the next.
fn read_by_pieces(target: &Path) {
    let mut input = File::open(target).unwrap();
    let mut reader = FileReader::open(&input, &Limits::default()).unwrap();
    reader.verify(|error| panic!("torn: {error}")).unwrap();
    let mut bytes = Vec::new();
    input.seek(SeekFrom::Start(0)).unwrap();
    input.read_to_end(&mut bytes).unwrap();
    identify(&bytes, &BOTH);
}

/// A child that saves both files in turn, killed after `delay`.
fn kill_after(delay: Duration, target: &Path) {
    let (mut child, _) = start(command(&[], &format!("repeat 1000000 {SMALL} {LARGE}"), target));
    thread::sleep(delay);
    child.kill().unwrap();
    assert_eq!(child.wait().unwrap().code(), None);
}

#[test]
fn readers_see_whole_files_while_the_writer_is_killed_and_the_rest_is_swept_later() {
    let folder = Folder::with(SMALL);
    let target = folder.target();
    // Multiples of the golden ratio spread over the moments of a save, however long it takes.
    let delay = |i: u32| Duration::from_secs_f64(0.06 * (f64::from(i) * 0.618_033_988_75).fract());
    let reads = while_read(&target, || (0..KILLS).for_each(|i| kill_after(delay(i), &target)));
    let left = folder.temporaries();
    eprintln!("{KILLS} kills, {} of them in the middle of a save; {reads:?} reads, none torn", left.len());
    assert!(left.len() > 2 && reads.iter().all(|&count| count > 100));
    sweeps_all_but_the_young_and_the_held(&folder);
}

fn sweeps_all_but_the_young_and_the_held(folder: &Folder) {
    let target = folder.target();
    let left = folder.temporaries();
    SMALL.save(&target).unwrap();
    assert_eq!(folder.temporaries(), left, "they are not a minute old");
    let alive = AtomicFile::create(&target).unwrap();
    folder.temporaries().iter().skip(1).for_each(|path| age(path));
    let held = File::open(&left[1]).unwrap();
    held.lock().unwrap();
    LARGE.save(&target).unwrap();
    let stays = folder.temporaries();
    assert!(stays.len() == 3 && left[..2].iter().all(|path| stays.contains(path)), "{stays:?}");
    // The third is that of a save that is still going on.
    let alive = SMALL.write_to(alive).unwrap();
    alive.commit().unwrap();
    assert_eq!((folder.holds(&BOTH), folder.temporaries()), (SMALL, left[..2].to_vec()));
}

#[test]
fn of_several_writers_each_file_is_whole() {
    let folder = Folder::with(SMALL);
    let target = folder.target();
    let times = 40;
    let reads = while_read(&target, || {
        let begin = |_| start(command(&[], &format!("repeat {times} {SMALL} {LARGE}"), &target)).0;
        for mut child in [(); 4].map(begin) {
            assert!(child.wait().unwrap().success());
        }
    });
    // Each of them ended with the large one, and so did the last.
    assert_eq!((folder.holds(&BOTH), folder.temporaries().len()), (LARGE, 0));
    eprintln!("4 writers, {times} saves each; {reads:?} reads, none torn");
}

#[test]
fn the_last_to_commit_wins() {
    let folder = Folder::new();
    let [first, last] = BOTH.map(|sample| sample.write_to(AtomicFile::create(&folder.target()).unwrap()).unwrap());
    last.commit().unwrap();
    assert_eq!(folder.holds(&BOTH), LARGE);
    first.commit().unwrap();
    assert_eq!((folder.holds(&BOTH), folder.temporaries().len()), (SMALL, 0));
}
