//! The streaming writer: what it takes over, and what it refuses.

use std::io::Cursor;

use lf_format::{
    Container, Contents, ExtraChunk, FormatError, Metadata, Packing, SlabTiling, Tag, TexelEncoding, Writer,
};
use lf_math::{SampledAxis, Slab};

use crate::assemble::{Chunk, entry_at};
use crate::damage::full_file;
use crate::layout::{RED, smallest};
use crate::readers::{parse, sound};

/// A file as a program writes it that has read it: with the chunks that it may copy, and the same tiles.
pub(crate) fn rewritten(bytes: &[u8]) -> Vec<u8> {
    let read = parse(bytes);
    let contents = Contents { extra: read.copyable_chunks().unwrap(), ..contents_of(&read) };
    let mut writer = Writer::new(Cursor::new(Vec::new()), contents).unwrap();
    while let Some((slab, tile)) = writer.next_tile() {
        let stored = read.tile(slab, tile).unwrap();
        writer.tile(stored.packing, stored.bytes).unwrap();
    }
    writer.finish().unwrap().into_inner()
}

fn contents_of(read: &Container<'_>) -> Contents {
    Contents::new(read.geometry().clone(), read.tilings().to_vec(), read.metadata().clone())
}

/// What the smallest file holds beside its tile.
fn smallest_contents() -> Contents {
    contents_of(&parse(&smallest().to_bytes()))
}

/// The smallest file, begun in memory.
pub(crate) fn smallest_writer() -> Writer<Cursor<Vec<u8>>> {
    Writer::new(Cursor::new(Vec::new()), smallest_contents()).unwrap()
}

#[track_caller]
fn assert_argument<T>(result: &Result<T, FormatError>) {
    assert!(matches!(result, Err(FormatError::InvalidArgument { .. })));
}

#[test]
fn two_writers_agree() {
    let mut writer = smallest_writer();
    writer.tile(Packing::None, &RED).unwrap();
    assert_eq!(writer.finish().unwrap().into_inner(), smallest().to_bytes());
}

#[test]
fn chunks_that_are_safe_to_copy_survive_and_others_do_not() {
    let mut file = full_file();
    let rewritten = rewritten(&file.to_bytes());
    file.chunks.retain(|chunk| &chunk.tag != b"more");
    assert_eq!(rewritten, file.to_bytes());
    let copied: Vec<Tag> = sound(&rewritten).copyable_chunks().unwrap().iter().map(ExtraChunk::tag).collect();
    assert_eq!(copied, [Tag::private(*b"note").unwrap()]);
}

#[test]
fn a_damaged_chunk_is_not_copied() {
    let file = smallest().with(2, Chunk::new(b"note", 2, vec![1, 2, 3]));
    let mut bytes = file.to_bytes();
    assert_eq!(parse(&bytes).copyable_chunks().unwrap()[0].payload(), [1, 2, 3]);
    *bytes.last_mut().unwrap() ^= 1;
    let error = parse(&bytes).copyable_chunks().unwrap_err();
    assert_eq!(error.broken_rule(), Some((lf_format::Rule::Checksum, entry_at(2) as u64 + 40)));
}

#[test]
fn private_chunks_are_written_in_the_order_of_the_directory() {
    let private = |tag, safe, byte| ExtraChunk::private(tag, safe, vec![byte]).unwrap();
    let extra = vec![private(*b"zeta", true, 1), private(*b"a1B2", false, 2)];
    let mut writer = Writer::new(Cursor::new(Vec::new()), Contents { extra, ..smallest_contents() }).unwrap();
    writer.tile(Packing::None, &RED).unwrap();
    let expected = smallest().with(2, Chunk::new(b"a1B2", 0, vec![2])).with(3, Chunk::new(b"zeta", 2, vec![1]));
    assert_eq!(writer.finish().unwrap().into_inner(), expected.to_bytes());
}

#[test]
fn private_chunks_have_private_tags() {
    for tag in [b"Note", b"1ote", b"not ", b"no-e", b"n\xC3\xA4e"] {
        assert_argument(&ExtraChunk::private(*tag, true, vec![1]));
    }
    assert_argument(&ExtraChunk::private(*b"note", true, vec![]));
    let note = || ExtraChunk::private(*b"note", true, vec![1]).unwrap();
    let twice = Contents { extra: vec![note(), note()], ..smallest_contents() };
    assert_argument(&Writer::new(Cursor::new(Vec::new()), twice));
}

#[test]
fn tilings_are_those_of_the_slabs() {
    let contents = smallest_contents();
    let slab = contents.geometry.slabs()[0];
    assert_argument(&SlabTiling::new(&slab, TexelEncoding::Bc1, [0, 1]));
    assert_argument(&SlabTiling::new(&slab, TexelEncoding::Bc1, [u32::MAX, 1]));
    let refused = |tilings| {
        let contents = Contents { tilings, ..contents.clone() };
        assert_argument(&Writer::new(Cursor::new(Vec::new()), contents));
    };
    refused(vec![]);
    let axis = |count| SampledAxis::new(0.0, 1.0, count).unwrap();
    let wider = Slab::new(slab.face(), 0.5, slab.st(), [axis(9); 2], None).unwrap();
    refused(vec![SlabTiling::new(&wider, TexelEncoding::Bc1, [1, 1]).unwrap()]);
    // One tile of the same size, but of four cameras where there is one.
    let more = Slab::new(slab.face(), 0.5, [axis(2); 2], slab.uv(), None).unwrap();
    refused(vec![SlabTiling::new(&more, TexelEncoding::Bc1, [2, 2]).unwrap()]);
}

/// Contents with one +X slab of as many cameras and texels along each axis, one camera in a tile.
fn with_counts(st: [u32; 2], uv: [u32; 2]) -> Contents {
    let axis = |count| SampledAxis::new(0.0, 1.0, count).unwrap();
    let slab = Slab::new(lf_math::Face::PosX, 0.5, st.map(axis), uv.map(axis), None).unwrap();
    let cell = *smallest_contents().geometry.cell();
    let geometry = lf_math::LightFieldGeometry::new(cell, vec![slab]).unwrap();
    let tiling = SlabTiling::new(&slab, TexelEncoding::Bc1, [1, 1]).unwrap();
    Contents::new(geometry, vec![tiling], Metadata::new())
}

#[test]
fn the_formats_own_bounds_hold_for_the_writer() {
    let begin = |contents| Writer::new(Cursor::new(Vec::new()), contents);
    assert_argument(&begin(with_counts([1, 1], [(1 << 16) + 1, 1])));
    assert_argument(&begin(with_counts([(1 << 16) + 1, 1], [1, 1])));
    begin(with_counts([1, 1], [1 << 16, 1])).unwrap();
    // 65,535 tiles and the geometry are as many chunks as there may be.
    begin(with_counts([65_535, 1], [1, 1])).unwrap();
    assert_argument(&begin(with_counts([256, 256], [1, 1])));
    let mut metadata = Metadata::new();
    for i in 0..17 {
        metadata.insert(i.to_string(), "x".repeat(1 << 16)).unwrap();
    }
    assert_argument(&begin(Contents { metadata, ..smallest_contents() }));
}

#[test]
fn tiles_are_what_comes_next() {
    let mut writer = smallest_writer();
    assert_eq!(writer.next_tile(), Some((0, 0)));
    assert_argument(&writer.tile(Packing::None, &[0; 7]));
    assert_argument(&writer.tile(Packing::Zstd, &[]));
    for id in [0, 1, 2, 3] {
        assert_argument(&writer.tile(Packing::Unknown(id), &[0; 8]));
    }
    assert_eq!(writer.next_tile(), Some((0, 0)), "what was refused is still to come");
    writer.tile(Packing::None, &[0; 8]).unwrap();
    assert_eq!(writer.next_tile(), None);
    assert_argument(&writer.tile(Packing::None, &[0; 8]));
    assert_argument(&smallest_writer().finish());
    let rgba8 = SlabTiling::new(&smallest_contents().geometry.slabs()[0], TexelEncoding::Rgba8, [1, 1]).unwrap();
    let contents = Contents { tilings: vec![rgba8], ..smallest_contents() };
    let mut writer = Writer::new(Cursor::new(Vec::new()), contents).unwrap();
    assert_argument(&writer.tile(Packing::Tile, &[1]));
}

#[test]
fn saving_writes_the_same_bytes() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.lfslab");
    let mut writer = Writer::create(&path, smallest_contents()).unwrap();
    writer.tile(Packing::None, &RED).unwrap();
    assert!(!path.exists(), "nothing is there before the file is whole");
    assert_eq!(writer.save().unwrap(), 328);
    assert_eq!(std::fs::read(&path).unwrap(), smallest().to_bytes());
}

#[test]
fn a_file_that_is_given_up_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.lfslab");
    std::fs::write(&path, "old").unwrap();
    drop(Writer::create(&path, smallest_contents()).unwrap());
    assert_argument(&Writer::create(&path, smallest_contents()).unwrap().save());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn an_unwritable_target_is_an_io_error_with_its_path() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("missing/a.lfslab");
    match Writer::create(&path, smallest_contents()).unwrap_err() {
        FormatError::Io { action, source } => {
            assert_eq!(action, format!("write {}", path.display()));
            assert_eq!(source.kind(), std::io::ErrorKind::NotFound);
        }
        other => panic!("{other}"),
    }
}
