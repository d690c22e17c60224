//! Opening, reading and writing `.lfslab` files, beside what that costs at least, and beside KTX2 with the same payload.
//!
//! The payload is the museum's: six slabs of 16×16 cameras of 96×96 texels in BC1, 6.75 MiB raw. Files lie in the page cache. Answers are checked
//! before anything is timed.

use std::fs::File;
use std::hint::black_box;
use std::io::{Cursor, Read};
use std::path::{Path, PathBuf};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lf_compress::format::{Container, FileReader, Limits, Metadata, Packing, Writer};
use lf_compress::{PackedLightField, unpack_into};
use lf_exchange::ktx2::{Supercompression, encode};
use lf_exchange::{Volume, VolumeFormat};
use lf_tests::{capture, museum, packed};
use rayon::prelude::*;
use xxhash_rust::xxh64::xxh64;

/// zstd's level in all files.
const LEVEL: i32 = 9;

struct Files {
    folder: tempfile::TempDir,
    field: PackedLightField,
    /// One frame for each tile.
    frames: Vec<Vec<u8>>,
    raw_len: usize,
}

impl Files {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let field = packed(&capture(&museum(), 16, 96));
        let raw: Vec<&Vec<u8>> = (0..6).flat_map(|slab| field.tiles(slab)).collect();
        let frames: Vec<_> = raw.iter().map(|raw| zstd::bulk::compress(raw, LEVEL).expect("packs")).collect();
        let raw_len = raw.iter().map(|raw| raw.len()).sum();
        let files = Self { folder, field, frames, raw_len };
        files.field.save(&files.path("coded.lfslab"), Metadata::new()).expect("saves");
        let mut writer =
            Writer::create(&files.path("zstd.lfslab"), files.field.contents(Metadata::new())).expect("begins");
        files.frames.iter().for_each(|frame| writer.tile(Packing::Zstd, frame).expect("a tile"));
        writer.save().expect("saves");
        std::fs::write(files.path("raw"), files.slices().concat()).expect("writes");
        std::fs::write(files.path("field.ktx2"), files.ktx2()).expect("writes");
        files.check();
        files
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn slices(&self) -> Vec<Vec<u8>> {
        self.field.volume_slices(1 << 30).expect("one encoding")
    }

    fn ktx2(&self) -> Vec<u8> {
        let slices = self.slices();
        let views = slices.iter().map(Vec::as_slice).collect();
        let volume = Volume::new(self.field.layout().size(), VolumeFormat::Bc1, views).expect("a volume");
        encode(&volume, Supercompression::Zstd(LEVEL)).expect("encodes")
    }

    fn check(&self) {
        for name in ["coded.lfslab", "zstd.lfslab"] {
            let read = read_all(&self.path(name));
            assert!((0..6).all(|slab| read.tiles(slab) == self.field.tiles(slab)), "{name}");
        }
        assert_eq!(read_ktx2(&self.path("field.ktx2")), std::fs::read(self.path("raw")).expect("reads"));
        let len = |name: &str| std::fs::metadata(self.path(name)).expect("a file").len();
        let [coded, zstd, ktx2] = ["coded.lfslab", "zstd.lfslab", "field.ktx2"].map(len);
        println!("raw tiles {} bytes; coded {coded}, zstd {zstd}, KTX2 {ktx2}", self.raw_len);
    }
}

fn open(path: &Path) -> FileReader<File> {
    FileReader::open(File::open(path).expect("opens"), &Limits::default()).expect("is sound")
}

fn read_all(path: &Path) -> PackedLightField {
    PackedLightField::read_file(&mut open(path)).expect("unpacks")
}

/// Header and directory of a file of `len` bytes, read and hashed: what opening it costs at least.
fn hash_head(path: &Path, len: u64) -> u64 {
    let mut head = vec![0; len as usize];
    File::open(path).expect("opens").read_exact(&mut head).expect("reads");
    xxh64(&head, 0)
}

fn read_ktx2(path: &Path) -> Vec<u8> {
    let bytes = std::fs::read(path).expect("reads");
    let reader = ktx2::Reader::new(&bytes).expect("is sound");
    let level = reader.levels().next().expect("a level");
    zstd::bulk::decompress(level.data, level.uncompressed_byte_length as usize).expect("unpacks")
}

fn opening(c: &mut Criterion, files: &Files) {
    let path = files.path("coded.lfslab");
    let chunks = open(&path).chunks().len() as u64;
    let head_len = 64 + 48 * chunks;
    println!("{chunks} chunks, {head_len} bytes of header and directory");
    let bytes = std::fs::read(&path).expect("reads");
    let mut group = c.benchmark_group("open");
    group.bench_function("read and hash header and directory", |b| b.iter(|| black_box(hash_head(&path, head_len))));
    group.bench_function("FileReader::open", |b| b.iter(|| black_box(open(&path))));
    group.bench_function("in memory, hash header and directory", |b| {
        b.iter(|| black_box(xxh64(&bytes[..head_len as usize], 0)));
    });
    group.bench_function("in memory, Container::parse", |b| {
        b.iter(|| black_box(Container::parse(&bytes, &Limits::default()).expect("is sound")));
    });
    group.finish();
}

fn reading(c: &mut Criterion, files: &Files) {
    let mut group = c.benchmark_group("read");
    group.throughput(Throughput::Bytes(files.raw_len as u64));
    for name in ["coded.lfslab", "zstd.lfslab"] {
        let path = files.path(name);
        group.bench_function(format!("all of {name}, all threads"), |b| b.iter(|| black_box(read_all(&path))));
        group.bench_function(format!("all of {name}, one thread"), |b| b.iter(|| read_one_thread(&path)));
    }
    group.bench_function("zstd alone, all threads", |b| b.iter(|| unpack_frames(files, true)));
    group.bench_function("zstd alone, one thread", |b| b.iter(|| unpack_frames(files, false)));
    let ktx2 = files.path("field.ktx2");
    group.bench_function("KTX2 with zstd", |b| b.iter(|| black_box(read_ktx2(&ktx2))));
    let raw = files.path("raw");
    group.bench_function("read() of raw bytes", |b| b.iter(|| black_box(std::fs::read(&raw).expect("reads"))));
    group.throughput(Throughput::Bytes(files.raw_len as u64 / 6));
    let path = files.path("zstd.lfslab");
    group.bench_function("one slab of zstd.lfslab, one thread", |b| b.iter(|| read_slab(&mut open(&path), 2)));
    group.finish();
}

fn read_one_thread(path: &Path) {
    let mut file = open(path);
    (0..6).for_each(|slab| read_slab(&mut file, slab));
}

fn read_slab(file: &mut FileReader<File>, slab: usize) {
    let tiling = file.tilings()[slab].clone();
    let mut stored = Vec::new();
    for tile in tiling.stored_tiles() {
        let found = file.tile(slab, tile, &mut stored).expect("is sound");
        let mut raw = vec![0; tiling.raw_len(tile) as usize];
        unpack_into(&found, &tiling, slab, tile, &mut raw).expect("unpacks");
        black_box(raw);
    }
}

/// The frames of all tiles, in memory, to buffers of their own.
fn unpack_frames(files: &Files, parallel: bool) {
    let lens: Vec<usize> = (0..6).flat_map(|slab| files.field.tiles(slab)).map(Vec::len).collect();
    let unpack = |(frame, &len): (&Vec<u8>, &usize)| zstd::bulk::decompress(frame, len).expect("unpacks");
    if parallel {
        black_box(files.frames.par_iter().zip(&lens).map(unpack).collect::<Vec<_>>());
    } else {
        black_box(files.frames.iter().zip(&lens).map(unpack).collect::<Vec<_>>());
    }
}

fn writing(c: &mut Criterion, files: &Files) {
    let mut group = c.benchmark_group("write");
    group.sample_size(10).throughput(Throughput::Bytes(files.raw_len as u64));
    let contents = || files.field.contents(Metadata::new());
    group.bench_function("frames to a file in memory", |b| {
        b.iter(|| {
            let mut writer = Writer::new(Cursor::new(Vec::new()), contents()).expect("begins");
            files.frames.iter().for_each(|frame| writer.tile(Packing::Zstd, frame).expect("a tile"));
            black_box(writer.finish().expect("ends"))
        });
    });
    group.bench_function("packing, to a file in memory", |b| {
        b.iter(|| black_box(files.field.to_bytes(Metadata::new()).expect("packs")));
    });
    group.bench_function("KTX2 with zstd", |b| b.iter(|| black_box(files.ktx2())));
    group.finish();
}

fn container(c: &mut Criterion) {
    let files = Files::new();
    opening(c, &files);
    reading(c, &files);
    writing(c, &files);
}

criterion_group!(benches, container);
criterion_main!(benches);
