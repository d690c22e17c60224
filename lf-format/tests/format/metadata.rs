//! The rules of clause 8.

use lf_format::{Metadata, Rule};

use crate::assemble::Chunk;
use crate::layout::{metadata, smallest};
use crate::readers::{assert_breaks, sound};

/// Where the payload of the second of three chunks is.
const META: usize = 384;
/// Where key and value of a single pair with a key of one byte are.
const KEY: usize = META + 10;
const VALUE: usize = META + 11;

fn with_payload(payload: Vec<u8>) -> Vec<u8> {
    smallest().with(1, Chunk::new(b"META", 2, payload)).to_bytes()
}

fn with_pairs(pairs: &[(&[u8], &[u8])]) -> Vec<u8> {
    with_payload(metadata(pairs))
}

#[test]
fn metadata_is_read() {
    let bytes = with_pairs(&[(b"a", b""), (b"b", "§".as_bytes())]);
    let read = sound(&bytes);
    assert_eq!((read.metadata().get("a"), read.metadata().get("b")), (Some(""), Some("§")));
    assert!(sound(&smallest().to_bytes()).metadata().is_empty());
}

#[test]
fn counts_and_lengths() {
    assert_breaks(&with_pairs(&[]), Rule::MetadataCount, META);
    assert_breaks(&with_payload(vec![0; 3]), Rule::MetadataOrder, META);
    for count in [2u32, u32::MAX] {
        let payload = [&count.to_le_bytes()[..], &[1, 0, 0, 0, 0, 0, b'a']].concat();
        assert_breaks(&with_payload(payload), Rule::MetadataOrder, VALUE);
    }
    let overlong = [&1u32.to_le_bytes()[..], &[1, 0, 0xFF, 0xFF, 0xFF, 0xFF, b'a']].concat();
    assert_breaks(&with_payload(overlong), Rule::MetadataOrder, VALUE);
    assert_breaks(&with_payload([metadata(&[(b"a", b"")]), vec![0]].concat()), Rule::MetadataOrder, VALUE);
}

#[test]
fn at_most_one_mebibyte() {
    // 16 values of 64 KiB less what the rest takes: 4 for the count, and 8 for each pair, 36 bytes short of the maximum.
    let values: Vec<String> = (0..16).map(|i| "x".repeat((1 << 16) - 8 - if i == 0 { 4 } else { 0 })).collect();
    let keys: Vec<String> = (10..26).map(|i| i.to_string()).collect();
    let pairs: Vec<(&[u8], &[u8])> = keys.iter().zip(&values).map(|(k, v)| (k.as_bytes(), v.as_bytes())).collect();
    assert_eq!(metadata(&pairs).len(), 1 << 20);
    sound(&with_pairs(&pairs));
    let longer = [&pairs[..15], &[(b"25z", pairs[15].1)]].concat();
    assert_breaks(&with_pairs(&longer), Rule::MetadataLength, META);
}

#[test]
fn keys_are_in_order() {
    assert_breaks(&with_pairs(&[(b"b", b""), (b"a", b"")]), Rule::MetadataOrder, VALUE);
    assert_breaks(&with_pairs(&[(b"a", b""), (b"a", b"")]), Rule::MetadataOrder, VALUE);
    sound(&with_pairs(&[(b"a", b""), (b"a.", b""), (b"b", b"")]));
}

#[test]
fn keys_are_of_few_characters() {
    for byte in 0..=255 {
        let bytes = with_pairs(&[(&[byte], b"")]);
        if byte.is_ascii_lowercase() || byte.is_ascii_digit() || b"._-".contains(&byte) {
            sound(&bytes);
        } else {
            assert_breaks(&bytes, Rule::MetadataKey, KEY);
        }
    }
    sound(&with_pairs(&[(&[b'a'; 64], b"")]));
    for key in [&b""[..], b"a b", &[b'a'; 65]] {
        assert_breaks(&with_pairs(&[(key, b"")]), Rule::MetadataKey, KEY);
    }
}

#[test]
fn values_are_text_of_at_most_64_kib() {
    sound(&with_pairs(&[(b"a", &[b'x'; 64 << 10])]));
    // An overlong form, a surrogate, a lone continuation, beyond U+10FFFF, cut off.
    for value in [&b"\xC0\x80"[..], b"\xED\xA0\x80", b"\x80", b"\xF4\x90\x80\x80", b"\xE2\x82", &[b'x'; (64 << 10) + 1]]
    {
        assert_breaks(&with_pairs(&[(b"a", value)]), Rule::MetadataValue, VALUE);
    }
}

#[test]
fn values_have_no_control_characters_but_tab_and_line_feed() {
    for byte in 0..=0x7F {
        let value = format!("a{}", char::from(byte));
        let bytes = with_pairs(&[(b"a", value.as_bytes())]);
        let inserted = Metadata::new().insert("a", value.as_str());
        if matches!(byte, b'\t' | b'\n' | b' '..=b'~') {
            assert_eq!(sound(&bytes).metadata().get("a"), Some(value.as_str()));
            inserted.unwrap();
        } else {
            assert_breaks(&bytes, Rule::MetadataValue, VALUE);
            assert_eq!(inserted.unwrap_err().id(), "argument");
        }
    }
}
