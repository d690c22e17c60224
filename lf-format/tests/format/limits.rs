//! The memory and the time that a file may cost.

use std::time::{Duration, Instant};

use lf_format::{Container, FormatError, Limits, Rule};

use crate::assemble::{Chunk, File, entry_at, reseal};
use crate::damage::full_file;
use crate::layout::{Axis, Field, Slab, Window, smallest};
use crate::readers::{assert_breaks, first_error, parse, sound};

const TINY: Limits = Limits { memory_bytes: 4096 };

/// A file with as many entries as there may be, all but two of kinds that no reader knows.
fn with_65_536_entries() -> Vec<u8> {
    let notes = (0..65_534).map(|tile| Chunk { tile, ..Chunk::new(b"note", 0, vec![1]) });
    let File { chunks, version } = smallest();
    File { chunks: chunks.into_iter().chain(notes).collect(), version }.to_bytes()
}

/// A file is accepted within the memory that it takes, and refused within any less.
#[test]
fn one_budget_covers_everything() {
    let file = full_file().to_bytes();
    let used = Limits::default().memory_bytes - sound(&file).budget().left();
    assert!((1..1 << 20).contains(&used), "{used}");
    assert_eq!(Container::parse(&file, &Limits { memory_bytes: used }).unwrap().budget().left(), 0);
    for memory_bytes in 0..used {
        let error = first_error(&file, &Limits { memory_bytes }).unwrap();
        assert!(matches!(error, FormatError::LimitExceeded { bytes, left, .. } if bytes > left), "{error}");
        assert_eq!((error.id(), error.broken_rule()), ("limit", None));
    }
}

#[test]
fn what_is_unpacked_can_be_taken_off_the_budget() {
    let mut budget = parse(&smallest().to_bytes()).budget();
    let left = budget.left();
    budget.take("tiles", left - 1).unwrap();
    assert_eq!(budget.take("tiles", 2).unwrap_err().id(), "limit");
    assert_eq!(budget.left(), 1);
    budget.take("tiles", 1).unwrap();
}

#[test]
fn a_full_directory_is_read_within_a_few_mebibytes() {
    let file = with_65_536_entries();
    assert_eq!(sound(&file).chunks().len(), 65_536);
    assert!(Container::parse(&file, &Limits { memory_bytes: 16 << 20 }).is_ok());
    assert_eq!(first_error(&file, &TINY).unwrap().id(), "limit");
}

const MOST: Axis = (0.0, 1.0, 1 << 16);

/// A file of one slab with one more chunk before its only tile, of 8 bytes.
fn huge(slab: &Slab, chunk: Option<Chunk>) -> File {
    let mut chunks = Field::new(vec![slab.clone()]).heads();
    chunks.extend(chunk);
    chunks.push(Chunk::new(b"TILE", 1, vec![0; 8]));
    File::new(chunks)
}

/// All windows of an axis empty but one.
fn all_but(kept: usize) -> Vec<Window> {
    let mut windows = vec![[0, 0]; 1 << 16];
    windows[kept] = [0, 1];
    windows
}

/// Far more than reading the windows takes, far less than a step for each of 2³² cameras.
const SOON: Duration = Duration::from_secs(1);

#[track_caller]
fn soon<T>(f: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let result = f();
    assert!(start.elapsed() < SOON, "took {:?}", start.elapsed());
    result
}

/// Cameras that are not there cost no time, whatever the tiles.
#[test]
fn four_billion_cameras_with_one_window_are_read_at_once() {
    let last = (1 << 16) - 1;
    for kept in [[0, 0], [last, last], [last, 0], [0, last], [77, 40_000]] {
        for per_tile in [[1 << 16, 1 << 16], [65_535, 65_535], [1 << 16, 1], [1, 1 << 15], [7, 300], [2, 2]] {
            let crop = Some(kept.map(all_but));
            let slab = Slab { st: [MOST; 2], per_tile, crop, ..Slab::smallest() };
            let place = [0, 1].map(|i| kept[i] as u32 / per_tile[i]);
            let mut file = huge(&slab, None);
            file.chunks[2].tile = place[1] * (1u32 << 16).div_ceil(per_tile[0]) + place[0];
            let bytes = file.to_bytes();
            soon(|| {
                let read = sound(&bytes);
                let tiling = &read.tilings()[0];
                assert_eq!(tiling.stored_tiles().collect::<Vec<_>>(), [file.chunks[2].tile]);
                assert_eq!(tiling.place(kept.map(|i| i as u32)).unwrap().corner, [0, 0]);
                assert_eq!(read.tile(0, file.chunks[2].tile).unwrap().raw_len, 8);
            });
        }
    }
}

#[test]
fn four_billion_tiles_are_refused_at_once() {
    for per_tile in [[1, 1], [1, 2], [2, 2]] {
        let slab = Slab { st: [MOST; 2], per_tile, ..Slab::smallest() };
        let bytes = huge(&slab, None).to_bytes();
        let error = soon(|| first_error(&bytes, &Limits::default())).unwrap();
        let rule = if per_tile == [1, 1] { Rule::Tiling } else { Rule::RawLength };
        assert_eq!(error.broken_rule().unwrap().0, rule);
    }
}

#[test]
fn a_mask_of_four_billion_cameras_without_its_bytes_is_refused() {
    let slab = Slab { st: [MOST; 2], ..Slab::smallest() };
    let short = huge(&slab, Some(Chunk::new(b"MASK", 1, vec![1; 100])));
    assert_breaks(&short.to_bytes(), Rule::MaskLength, short.payload_at(1));
    let mut declared = short.to_bytes();
    for field in [24, 32] {
        declared[entry_at(1) + field..][..8].copy_from_slice(&(1u64 << 29).to_le_bytes());
    }
    reseal(&mut declared);
    assert_breaks(&declared, Rule::StoredLength, entry_at(1) + 24);
}

#[cfg(feature = "std")]
mod from_a_file {
    use std::io::{self, Read, Seek, SeekFrom};

    use lf_format::FileReader;

    use super::*;

    /// A few bytes and then zeros: a long file that takes no memory. Counts what is read of it.
    #[derive(Debug)]
    struct Sparse {
        start: Vec<u8>,
        len: u64,
        at: u64,
        read: u64,
    }

    impl Read for Sparse {
        fn read(&mut self, out: &mut [u8]) -> io::Result<usize> {
            let count = (self.len - self.at).min(out.len() as u64) as usize;
            for byte in &mut out[..count] {
                *byte = self.start.get(self.at as usize).copied().unwrap_or(0);
                self.at += 1;
            }
            self.read += count as u64;
            Ok(count)
        }
    }

    impl Seek for Sparse {
        fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
            self.at = match to {
                SeekFrom::Start(at) => at,
                SeekFrom::End(back) => self.len.saturating_add_signed(back),
                SeekFrom::Current(by) => self.at.saturating_add_signed(by),
            };
            Ok(self.at)
        }
    }

    /// The error of a file that is refused before more than its first bytes are read.
    #[track_caller]
    fn refused_unread(start: Vec<u8>, len: u64, limits: &Limits) -> FormatError {
        let mut input = Sparse { start, len, at: 0, read: 0 };
        let error = FileReader::open(&mut input, limits).unwrap_err();
        assert!(input.read <= 16 << 10, "{} bytes were read", input.read);
        error
    }

    #[test]
    fn a_directory_beyond_the_budget_is_not_read() {
        let file = with_65_536_entries();
        let len = file.len() as u64;
        assert_eq!(refused_unread(file, len, &TINY).id(), "limit");
    }

    #[test]
    fn a_mask_beyond_the_budget_is_not_read() {
        let slab = Slab { st: [MOST; 2], per_tile: [1 << 16, 1 << 16], ..Slab::smallest() };
        let bytes = huge(&slab, Some(Chunk::new(b"MASK", 1, vec![0; 64]))).to_bytes();
        // The mask as long as it has to be, and the tile after it.
        let mask_at = u64::from_le_bytes(bytes[entry_at(1) + 16..][..8].try_into().unwrap());
        let mask_end = mask_at + (1 << 29);
        let mut start = bytes[..mask_at as usize].to_vec();
        let mut set = |at: usize, value: u64| start[at..at + 8].copy_from_slice(&value.to_le_bytes());
        set(entry_at(1) + 24, 1 << 29);
        set(entry_at(1) + 32, 1 << 29);
        set(entry_at(2) + 16, mask_end);
        set(16, mask_end + 8);
        reseal(&mut start);
        // A bit of the payload and a byte for each camera are more than the default.
        assert_eq!(refused_unread(start, mask_end + 8, &Limits::default()).id(), "limit");
    }
}
