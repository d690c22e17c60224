//! Files that break a rule of clause 3.

use super::{Kind, Stage, Vector, malformed, unsupported};
use crate::assemble::{File, patched, reseal};
use crate::layout::smallest;

pub(crate) fn vectors() -> Vec<Vector> {
    [magic_and_version(), lengths(), fields()].concat()
}

fn magic_and_version() -> Vec<Vector> {
    let good = smallest().to_bytes();
    let starting = |start: &[u8]| [start, &good[12..]].concat();
    let version = |major| File { version: (major, 0), ..smallest() }.to_bytes();
    let latin = starting(b"\xC2\x8ALFSLAB\0\r\n\x1A\n");
    let foreign = Vector::new("foreign", "some other kind of file", "§3.1", b"\x89PNG\r\n\x1A\n\0\0\0\rIHDR".to_vec());
    vec![
        foreign.refused("foreign", Kind::Foreign, Stage::Open),
        malformed("text-mode-lf", "header.magic", "§3.1", "CR LF became LF", starting(b"\x8ALFSLAB\0\n\x1A\n")),
        malformed("text-mode-crlf", "header.magic", "§3.1", "LF became CR LF", starting(b"\x8ALFSLAB\0\r\r\n\x1A\r\n")),
        malformed(
            "text-mode-7-bit",
            "header.magic",
            "§3.1",
            "the eighth bit was cleared",
            starting(b"\x0ALFSLAB\0\r\n\x1A\n"),
        ),
        malformed("text-mode-utf-8", "header.magic", "§3.1", "taken for Latin-1, became UTF-8", latin),
        unsupported("future-major", "header.version", "§3.2", "version 2.0", version(2)),
        unsupported("major-0", "header.version", "§3.2", "version 0.0", version(0)),
    ]
}

/// The smallest file with its header's file length as it then is, after more bytes.
fn longer(bytes: usize) -> Vec<u8> {
    let mut file = smallest().to_bytes();
    file.resize(328 + bytes, 0);
    file[16..24].copy_from_slice(&(328 + bytes as u64).to_le_bytes());
    reseal(&mut file);
    file
}

fn lengths() -> Vec<Vector> {
    let good = smallest().to_bytes();
    let count = |count: u32| patched(&smallest(), 32, &count.to_le_bytes());
    let alone = File::new(vec![smallest().chunks.remove(0)]).to_bytes();
    vec![
        malformed("truncated", "header.truncated", "§3.3", "the last byte is missing", good[..327].to_vec()),
        malformed("truncated-in-header", "header.truncated", "§3 §3.3", "40 bytes of a header", good[..40].to_vec()),
        malformed("one-byte-more", "header.file-length", "§3.3", "a byte after the end", [&good[..], &[0]].concat()),
        malformed(
            "bytes-after-last-payload",
            "file.tail",
            "§4.5",
            "the file goes on after the last payload",
            longer(56),
        ),
        malformed("entry-count-1", "header.entry-count", "§3.5", "the geometry alone", alone),
        malformed(
            "entry-count-beyond-file",
            "header.entry-count",
            "§3.5",
            "more entries than the file has room for",
            count(65_536),
        ),
        malformed(
            "entry-count-65537",
            "header.entry-count",
            "§3.5",
            "more entries than a file may have",
            count(65_537),
        ),
    ]
}

fn fields() -> Vec<Vector> {
    let flipped = |at: usize| {
        let mut file = smallest().to_bytes();
        file[at] ^= 1;
        file
    };
    vec![
        malformed(
            "directory-offset",
            "header.directory-offset",
            "§3.4",
            "the directory is said to be at 128",
            patched(&smallest(), 24, &[128]),
        ),
        malformed(
            "reserved-after-count",
            "header.reserved",
            "§3.6",
            "byte 36 is not zero",
            patched(&smallest(), 36, &[1]),
        ),
        malformed(
            "reserved-after-checksum",
            "header.reserved",
            "§3.6",
            "byte 55 is not zero",
            patched(&smallest(), 55, &[1]),
        ),
        malformed(
            "directory-checksum",
            "header.directory-checksum",
            "§3.7",
            "the directory's checksum is wrong",
            directory_checksum(),
        ),
        malformed("header-checksum", "header.checksum", "§3.8", "the header's checksum is wrong", flipped(56)),
    ]
}

/// A wrong checksum of the directory under a right one of the header.
fn directory_checksum() -> Vec<u8> {
    let mut file = smallest().to_bytes();
    file[40] ^= 1;
    let checksum = xxhash_rust::xxh64::xxh64(&file[..56], 0);
    file[56..64].copy_from_slice(&checksum.to_le_bytes());
    file
}
