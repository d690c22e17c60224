//! Damaged and hostile files.

use lf_format::{Limits, Rule};
use proptest::prelude::*;

use crate::assemble::{Chunk, File, patched, reseal};
use crate::layout::{Field, Slab, smallest};
use crate::readers::{assert_breaks, assert_damaged, first_error, refusal, sound};

/// A file with every kind of chunk and of padding, a few kilobytes long: three encodings, tiles packed and not, windows and
/// a mask, metadata, and chunks of kinds that no reader knows.
pub(crate) fn full_file() -> File {
    let axis = |count| (-0.5, 0.25, count);
    let slab = Slab { st: [axis(2); 2], uv: [axis(3), axis(5)], per_tile: [2, 1], ..Slab::smallest() };
    let masked = Slab { face: 1, mask: Some(vec![true, false, true, true]), ..slab.clone() };
    let crop = Some([vec![[0, 1], [0, 0]], vec![[0, 2], [1, 1]]]);
    let cropped = Slab { face: 2, encoding: 2, crop, focal_depth: 2.0, ..slab.clone() };
    let half = Slab { face: 5, encoding: 3, st: [axis(1); 2], per_tile: [1, 1], ..slab };
    let metadata = vec![("scene".to_owned(), "three slabs".to_owned())];
    let field = Field { metadata, ..Field::new(vec![masked, cropped, half]) };
    let raw = |slab: usize, tile| (0, vec![7; field.slabs[slab].raw_len(tile)]);
    let file = field.file(|slab, tile| if tile == 1 { (1, vec![1, 2, 3]) } else { raw(slab, tile) });
    let unknown = Chunk { packing: 9, slab: 5, raw_len: 4, ..Chunk::new(b"note", 2, vec![1; 70]) };
    let end = file.chunks.len();
    file.with(end, Chunk::new(b"more", 0, vec![3])).with(end + 1, unknown)
}

#[test]
fn every_truncation_is_refused() {
    let file = full_file().to_bytes();
    sound(&file);
    for len in 0..file.len() {
        let error = refusal(&file[..len]);
        if len == 0 {
            assert_eq!(error.id(), "foreign");
        } else {
            assert_eq!(error.broken_rule(), Some((Rule::Truncated, len as u64)));
        }
        if len >= 64 {
            let message = error.to_string();
            assert!(message.contains(&format!("it has {len} bytes, should have {}", file.len())), "{message}");
        }
    }
}

#[test]
fn every_flipped_bit_is_refused() {
    let mut file = full_file().to_bytes();
    for bit in 0..8 * file.len() {
        file[bit / 8] ^= 1 << (bit % 8);
        assert!(first_error(&file, &Limits::default()).is_some(), "bit {} of byte {}", bit % 8, bit / 8);
        file[bit / 8] ^= 1 << (bit % 8);
    }
}

#[test]
fn every_byte_of_padding_and_of_tiles_is_covered() {
    let file = full_file();
    let bytes = file.to_bytes();
    let with_flip = |at: usize| {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0x10;
        bytes
    };
    for (index, chunk) in file.chunks.iter().enumerate() {
        let start = file.payload_at(index);
        let padding = index
            .checked_sub(1)
            .map_or(64 + 48 * file.chunks.len(), |i| file.payload_at(i) + file.chunks[i].payload.len());
        (padding..start).for_each(|at| assert_damaged(&with_flip(at), Rule::Padding, at));
        let at = 64 + 48 * index + 40;
        for i in start..start + chunk.payload.len() {
            if [b"TILE", b"more", b"note"].contains(&&chunk.tag) {
                assert_damaged(&with_flip(i), Rule::Checksum, at);
            } else {
                assert_breaks(&with_flip(i), Rule::Checksum, at);
            }
        }
    }
}

/// Numbers at which sums and products overflow.
const EXTREMES: [u64; 10] =
    [0, 1, u32::MAX as u64, 1 << 32, (1 << 63) - 1, 1 << 63, u64::MAX - 64, u64::MAX - 63, u64::MAX - 1, u64::MAX];

#[test]
fn extreme_lengths_in_header_and_directory_are_refused() {
    for value in EXTREMES {
        for at in [16, 24] {
            refusal(&patched(&smallest(), at, &value.to_le_bytes()));
        }
        refusal(&patched(&smallest(), 32, &value.to_le_bytes()[..4]));
        for field in [64, 112].into_iter().flat_map(|entry| [16, 24, 32].map(|field| entry + field)) {
            refusal(&patched(&smallest(), field, &value.to_le_bytes()));
        }
        // Stored and raw length alike, as of a chunk that is not packed.
        for entry in [64, 112] {
            refusal(&patched(&smallest(), entry + 24, &[value.to_le_bytes(); 2].concat()));
        }
    }
}

#[test]
fn extreme_counts_in_the_geometry_are_refused() {
    let counts = [0, 5, 1 << 16, 1 << 30, u32::MAX - 3, u32::MAX - 1, u32::MAX];
    for value in counts {
        // Slab count, s, t, u, v counts, cameras per tile.
        for at in [36, 56, 68, 80, 92, 100, 104] {
            refusal(&smallest().patch(0, at, &value.to_le_bytes()).to_bytes());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]

    /// Any change of geometry, metadata, windows or mask is either refused or gives a file that is written the same again.
    #[test]
    fn changed_content_is_refused_or_sound(chunk in 0usize..4, at: prop::sample::Index, byte: u8) {
        let mut file = full_file();
        // A program that rewrites a file drops it.
        file.chunks.retain(|chunk| &chunk.tag != b"more");
        let at = at.index(file.chunks[chunk].payload.len());
        let bytes = file.patch(chunk, at, &[byte]).to_bytes();
        if first_error(&bytes, &Limits::default()).is_none() {
            #[cfg(feature = "std")]
            prop_assert_eq!(crate::writer::rewritten(&bytes), bytes);
        }
    }

    /// Several random changes with right checksums, anywhere in header or directory, never panic.
    #[test]
    fn resealed_noise_never_panics(changes in prop::collection::vec((12usize..400, any::<u8>()), 1..6)) {
        let mut file = full_file().to_bytes();
        for (at, byte) in changes {
            file[at] = byte;
        }
        reseal(&mut file);
        let _ = first_error(&file, &Limits::default());
    }

    #[test]
    fn noise_never_panics(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(first_error(&bytes, &Limits::default()).is_some());
    }
}
