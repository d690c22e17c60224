//! The rules of clause 3.

use lf_format::{FormatError, Rule};

use crate::assemble::{File, patched, reseal};
use crate::layout::smallest;
use crate::readers::{assert_breaks, assert_unsupported, refusal, sound};

fn with_byte(at: usize, value: u8) -> Vec<u8> {
    patched(&smallest(), at, &[value])
}

#[test]
fn versions() {
    let version = |major, minor| File { version: (major, minor), ..smallest() }.to_bytes();
    assert_eq!(sound(&version(1, 9)).version(), (1, 9));
    for (major, minor) in [(2, 0), (0, 1)] {
        let file = version(major, minor);
        assert_unsupported(&file, Rule::Version, 12);
        let message = refusal(&file).to_string();
        assert!(message.contains(&format!("of version {major}.{minor}, this reader knows version 1")), "{message}");
    }
}

#[test]
fn a_version_that_is_not_known_is_all_that_is_looked_at() {
    let file = [&b"\x8ALFSLAB\0\r\n\x1A\n"[..], &[2, 0, 0, 0]].concat();
    assert_unsupported(&file, Rule::Version, 12);
}

#[test]
fn header_fields() {
    assert_breaks(&with_byte(24, 128), Rule::DirectoryOffset, 24);
    assert_breaks(&with_byte(36, 1), Rule::HeaderReserved, 36);
    assert_breaks(&with_byte(39, 1), Rule::HeaderReserved, 39);
    assert_breaks(&with_byte(48, 1), Rule::HeaderReserved, 48);
    assert_breaks(&with_byte(55, 1), Rule::HeaderReserved, 55);
    let mut file = smallest().to_bytes();
    file[70] ^= 1;
    assert_breaks(&file, Rule::DirectoryChecksum, 40);
    file[60] ^= 1;
    assert_breaks(&file, Rule::HeaderChecksum, 56);
}

#[test]
fn entry_counts() {
    let count = |count: u32| patched(&smallest(), 32, &count.to_le_bytes());
    for wrong in [0, 1, 6, 65_536, 65_537, u32::MAX] {
        assert_breaks(&count(wrong), Rule::EntryCount, 32);
    }
    // A count that is too large is refused even where the file is long enough.
    let mut long = smallest().to_bytes();
    long.resize(64 + 48 * 65_537, 0);
    let len = long.len() as u64;
    long[16..24].copy_from_slice(&len.to_le_bytes());
    long[32..36].copy_from_slice(&65_537u32.to_le_bytes());
    reseal(&mut long);
    assert_breaks(&long, Rule::EntryCount, 32);
}

#[test]
fn file_lengths() {
    let mut file = smallest().to_bytes();
    file.push(0);
    assert_breaks(&file, Rule::FileLength, 328);
    file.truncate(327);
    assert_breaks(&file, Rule::Truncated, 327);
}

#[test]
fn foreign_files_are_named() {
    let files: [&[u8]; 5] = [
        b"",
        b"\x89PNG\r\n\x1A\n\0\0\0\rIHDR",
        b"Some text, longer than a magic.",
        b"\x89LFP\r\n\x1A\n\0\0\0\x01",
        &[0; 4096],
    ];
    for file in files {
        let error = refusal(file);
        assert!(matches!(error, FormatError::NotLfslab { .. }), "{error}");
        assert_eq!((error.id(), error.broken_rule()), ("foreign", None));
        assert!(error.to_string().starts_with("not an .lfslab file"), "{error}");
    }
}

#[test]
fn text_mode_damage_is_recognised() {
    let good = smallest().to_bytes();
    let rest = &good[12..];
    let starts: [&[u8]; 6] = [
        b"\x8ALFSLAB\0\n\x1A\n",           // CR LF became LF
        b"\x8ALFSLAB\0\r\r\n\x1A\r\n",     // LF became CR LF
        b"\x8ALFSLAB\0\r\r\x1A\r",         // LF became CR
        b"\x0ALFSLAB\0\r\n\x1A\n",         // the eighth bit was cleared
        b"\xC2\x8ALFSLAB\0\r\n\x1A\n",     // taken for Latin-1, became UTF-8
        b"\xEF\xBF\xBDLFSLAB\0\r\n\x1A\n", // taken for broken UTF-8
    ];
    for start in starts {
        let file = [start, rest].concat();
        assert_breaks(&file, Rule::Magic, 0);
        assert!(refusal(&file).to_string().contains("text mode"));
    }
    // Cut off at the end-of-file character.
    assert_breaks(&good[..10], Rule::Truncated, 10);
}
