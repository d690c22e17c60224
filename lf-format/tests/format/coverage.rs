//! The rules of clause 6.

use lf_format::Rule;

use crate::assemble::{Chunk, File, entry_at};
use crate::layout::{Field, Slab, Window};
use crate::readers::{assert_breaks, sound};

/// 3 × 3 cameras of 8 × 6 texels, so 2 × 2 blocks, two columns and one row of cameras in a tile.
fn slab() -> Slab {
    let axis = |count| (-1.0, 0.5, count);
    Slab { st: [axis(3); 2], uv: [axis(8), axis(6)], per_tile: [2, 1], ..Slab::smallest() }
}

/// [`slab`] without the second column, and with half of the last row.
fn cropped() -> Slab {
    let windows: [Vec<Window>; 2] = [vec![[0, 2], [0, 0], [1, 1]], vec![[0, 2], [0, 2], [1, 1]]];
    Slab { crop: Some(windows), ..slab() }
}

/// All tiles of zeros.
fn file(slab: Slab) -> File {
    let field = Field::new(vec![slab]);
    field.clone().file(|slab, tile| (0, vec![0; field.slabs[slab].raw_len(tile)]))
}

/// The file with another payload in its second chunk.
fn with_second(mut file: File, payload: Vec<u8>) -> File {
    let old = &file.chunks[1];
    file.chunks[1] = Chunk { slab: old.slab, ..Chunk::new(&old.tag, old.flags, payload) };
    file
}

/// Where the fields of §5.9 are.
fn tiling_at(file: &File) -> usize {
    file.payload_at(0) + 100
}

#[test]
fn a_cropped_slab_is_read() {
    let bytes = file(cropped()).to_bytes();
    let read = sound(&bytes);
    let coverage = read.tilings()[0].coverage();
    assert_eq!(coverage.window([0, 0]), Some([0..8, 0..6]));
    assert_eq!(coverage.window([2, 1]), Some([4..8, 0..6]));
    assert_eq!(coverage.window([0, 2]), Some([0..8, 4..6]));
    assert_eq!(coverage.window([1, 1]), None);
    assert_eq!(read.tilings()[0].tile_size(5), [4, 4]);
}

#[test]
fn a_slab_with_a_mask_is_read() {
    let stored = [true, false, true, true, true, true, false, false, true];
    let bytes = file(Slab { mask: Some(stored.to_vec()), ..slab() }).to_bytes();
    let read = sound(&bytes);
    let coverage = read.tilings()[0].coverage();
    for (i, stored) in (0..9).zip(stored) {
        assert_eq!(coverage.window([i % 3, i / 3]).is_some(), stored);
    }
    assert_eq!(read.tilings()[0].stored_tiles().collect::<Vec<_>>(), [0, 1, 2, 3, 5]);
}

#[test]
fn there_is_a_window_for_each_column_and_row() {
    for records in [5, 7] {
        let wrong = with_second(file(cropped()), vec![0; 8 * records]);
        assert_breaks(&wrong.to_bytes(), Rule::CropLength, wrong.payload_at(1));
    }
    let wrong = with_second(file(cropped()), vec![0; 47]);
    assert_breaks(&wrong.to_bytes(), Rule::CropLength, wrong.payload_at(1));
}

#[test]
fn windows_lie_within_the_image() {
    let last = u32::MAX;
    for record in [0, 2, 3, 5] {
        for window in [[0, 3], [1, 2], [2, 1], [3, 0], [1, 0], [2, 0], [last, 1], [1, last], [last, 0], [last, last]] {
            let bytes: Vec<u8> = window.into_iter().flat_map(u32::to_le_bytes).collect();
            let wrong = file(cropped()).patch(1, 8 * record, &bytes);
            assert_breaks(&wrong.to_bytes(), Rule::CropWindow, wrong.payload_at(1) + 8 * record);
        }
    }
}

#[test]
fn something_is_left_out() {
    let whole = file(Slab { crop: Some([vec![[0, 2]; 3], vec![[0, 2]; 3]]), ..slab() });
    assert_breaks(&whole.to_bytes(), Rule::CropNothing, whole.payload_at(1));
    let all = file(Slab { mask: Some(vec![true; 9]), ..slab() });
    assert_breaks(&all.to_bytes(), Rule::MaskNothing, all.payload_at(1));
    // A mask that leaves out just what the windows leave out.
    let same = (0..9).map(|i| i % 3 != 1).collect();
    let same = file(Slab { mask: Some(same), ..cropped() });
    assert_breaks(&same.to_bytes(), Rule::MaskNothing, same.payload_at(2));
}

#[test]
fn there_is_a_bit_for_each_camera() {
    let masked = || file(Slab { mask: Some((0..9).map(|i| i > 0).collect()), ..slab() });
    sound(&masked().to_bytes());
    for len in [1, 3] {
        let wrong = with_second(masked(), vec![1; len]);
        assert_breaks(&wrong.to_bytes(), Rule::MaskLength, wrong.payload_at(1));
    }
    for bit in 1..8 {
        let wrong = masked().patch(1, 1, &[1 | 1 << bit]);
        assert_breaks(&wrong.to_bytes(), Rule::MaskBits, wrong.payload_at(1) + 1);
    }
}

#[test]
fn a_camera_with_an_empty_window_has_no_bit() {
    for camera in [1, 4, 7] {
        let stored = (0..9).map(|i| (i % 3 != 1 && i != 0) || i == camera).collect();
        let wrong = file(Slab { mask: Some(stored), ..cropped() });
        assert_breaks(&wrong.to_bytes(), Rule::MaskBits, wrong.payload_at(2) + camera / 8);
    }
}

#[test]
fn a_slab_stores_a_camera() {
    let empty = Slab { crop: Some([vec![[0, 0]; 3], vec![[0, 2]; 3]]), ..slab() };
    let none = Slab { mask: Some(vec![false; 9]), ..slab() };
    for slab in [empty, none] {
        // With the tile of a second slab, so that there is one.
        let field = Field::new(vec![slab, Slab { face: 5, ..Slab::smallest() }]);
        let wrong = field.file(|_, _| (0, vec![0; 8]));
        assert_breaks(&wrong.to_bytes(), Rule::NoCamera, tiling_at(&wrong));
    }
}

/// A tile is there if one of its cameras is, and not else.
#[test]
fn tiles_without_a_stored_camera_are_not_in_the_file() {
    let stored = || Some((0..9).map(|i| i != 2 && i != 4).collect::<Vec<bool>>());
    let slab = Slab { mask: stored(), ..slab() };
    assert_eq!(slab.tiles(), [0, 2, 3, 4, 5]);
    sound(&file(slab.clone()).to_bytes());
    let one_more = file(slab.clone()).with(3, Chunk { tile: 1, ..Chunk::new(b"TILE", 1, vec![0; 32]) });
    assert_breaks(&one_more.to_bytes(), Rule::Order, entry_at(3));
}

#[test]
fn windows_and_masks_are_held_to_their_checksums() {
    let both = file(Slab { mask: Some((0..9).map(|i| i % 3 != 1 && i > 0).collect()), ..cropped() });
    for chunk in [1, 2] {
        let mut bytes = both.to_bytes();
        bytes[both.payload_at(chunk)] ^= 1;
        assert_breaks(&bytes, Rule::Checksum, entry_at(chunk) + 40);
    }
}
