//! A long file is written and read with memory for one tile at a time.
//!
//! The only test of its program, so that the peak of the process is its own. With `LFSLAB_LONG=1` the file has 4 GiB.

#![cfg(all(feature = "std", target_os = "linux"))]

use std::fs::File;
use std::io::{BufReader, Write};
use std::path::Path;

use glam::DVec3;
use lf_format::{Contents, FileReader, FormatError, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab};

/// Bytes of a tile: one image of 2048 × 2048 texels, four bytes each.
const TILE: usize = 16 << 20;

/// A slab of so many tiles.
fn contents(tiles: u32) -> Contents {
    let axis = |count| SampledAxis::new(0.0, 1e-3, count).unwrap();
    let slab = Slab::new(Face::PosX, 0.0, [axis(tiles), axis(1)], [axis(2048), axis(2048)], None).unwrap();
    let geometry = LightFieldGeometry::new(Cell::cube(DVec3::ZERO, 1.0).unwrap(), vec![slab]).unwrap();
    let tiling = SlabTiling::new(&slab, TexelEncoding::Rgba8, [1, 1]).unwrap();
    Contents::new(geometry, vec![tiling], Metadata::new())
}

/// The largest resident set of this process so far, bytes.
fn peak() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status.lines().find(|line| line.starts_with("VmHWM:")).unwrap();
    1024 * line.split_whitespace().nth(1).unwrap().parse::<u64>().unwrap()
}

/// The byte that tile `i` is full of.
fn byte(i: u32) -> u8 {
    (i % 251) as u8 + 1
}

fn write(path: &Path, tiles: u32) -> u64 {
    let mut writer = Writer::create(path, contents(tiles)).unwrap();
    let mut raw = vec![0; TILE];
    while let Some((_, tile)) = writer.next_tile() {
        raw.fill(byte(tile));
        writer.tile(Packing::None, &raw).unwrap();
    }
    writer.save().unwrap()
}

fn read(path: &Path, tiles: u32) {
    // One tile at a time, and what it takes beside its tiles is little.
    let limits = Limits { memory_bytes: TILE as u64 + (1 << 20) };
    let short = Limits { memory_bytes: TILE as u64 - 1 };
    let mut refused = FileReader::open(File::open(path).unwrap(), &short).unwrap();
    assert!(matches!(refused.tile(0, 0, &mut Vec::new()), Err(FormatError::LimitExceeded { .. })));
    let mut file = FileReader::open(BufReader::new(File::open(path).unwrap()), &limits).unwrap();
    let mut buffer = Vec::new();
    for tile in 0..tiles {
        let stored = file.tile(0, tile, &mut buffer).unwrap();
        assert!(stored.bytes.len() == TILE && stored.bytes.iter().all(|&found| found == byte(tile)));
    }
    file.verify(|error| panic!("{error}")).unwrap();
}

#[test]
fn a_long_file_costs_the_memory_of_a_tile() {
    let long = std::env::var_os("LFSLAB_LONG").is_some();
    let (tiles, bar) = if long { (256, 256 << 20) } else { (16, 64 << 20) };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.lfslab");
    let baseline = peak();
    let len = write(&path, tiles);
    let written = peak();
    read(&path, tiles);
    let taken = peak() - baseline;
    assert!(len > u64::from(tiles) * TILE as u64);
    let mib = |bytes| bytes >> 20;
    let report = format!(
        "{} MiB of tiles: {} MiB above a baseline of {} MiB, {} MiB of it to write",
        mib(len),
        mib(taken),
        mib(baseline),
        mib(written - baseline)
    );
    // Straight to standard error, past the capture of the test harness.
    let _ = writeln!(std::io::stderr(), "{report}");
    assert!(taken < bar, "{report}");
}
