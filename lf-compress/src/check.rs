//! The rules of the file format for what is inside tiles.

use half::f16;
use lf_format::{Packing, Rule, SlabTiling, StoredTile, TexelEncoding};
use lf_math::Windows;

use crate::error::PackError;
use crate::file::unpack_into;
use crate::picture::{Unit, cameras_of};

/// Checks a stored tile against every rule of the file format for its contents (spec §7): that it unpacks, that cameras
/// which are not stored are zero, that BC1 blocks are opaque, alpha is 255 and half floats are finite.
///
/// A reader need not do all of this; a program that looks for faults does.
///
/// # Errors
/// [`PackError::Tile`] with the rule that is broken.
pub fn check_tile(stored: &StoredTile<'_>, tiling: &SlabTiling, slab: usize, tile: u32) -> Result<(), PackError> {
    let mut unpacked = Vec::new();
    let raw = if stored.packing == Packing::None && stored.bytes.len() as u64 == stored.raw_len {
        stored.bytes
    } else {
        unpacked.resize(usize::try_from(stored.raw_len).unwrap_or(usize::MAX), 0);
        unpack_into(stored, tiling, slab, tile, &mut unpacked)?;
        &unpacked
    };
    let broken = |(rule, what)| PackError::Tile { slab, tile, rule, what };
    check_texels(raw, tiling, tile).map_err(broken)
}

fn check_texels(raw: &[u8], tiling: &SlabTiling, tile: u32) -> Result<(), (Rule, String)> {
    for camera in cameras_of(tiling, tile) {
        for row in rows(raw, tiling, tile, camera) {
            let (rule, sound, what) = match tiling.place(camera) {
                None => (Rule::Padded, row.iter().all(|&byte| byte == 0), "is not stored, but not zero"),
                Some(_) => check_row(row, tiling.encoding()),
            };
            if !sound {
                return Err((rule, format!("is wrong: camera ({}, {}) {what}", camera[0], camera[1])));
            }
        }
    }
    Ok(())
}

/// The rule for a row of blocks or texels, whether it is kept, and what to say if not.
fn check_row(row: &[u8], encoding: TexelEncoding) -> (Rule, bool, &'static str) {
    match encoding {
        TexelEncoding::Bc1 => {
            (Rule::Opaque, row.as_chunks().0.iter().all(is_opaque), "has a transparent or 3-colour block")
        }
        TexelEncoding::Rgba8 => (
            Rule::Alpha,
            row.as_chunks().0.iter().all(|texel: &[u8; 4]| texel[3] == 255),
            "has an alpha that is not 255",
        ),
        _ => {
            let finite = |&bytes: &[u8; 2]| f16::from_le_bytes(bytes).is_finite();
            (Rule::Finite, row.as_chunks().0.iter().all(finite), "has a value that is not finite")
        }
    }
}

/// Whether a block has color0 > color1, or both equal and index 3 nowhere (§7.3).
fn is_opaque(block: &[u8; 8]) -> bool {
    let [a, b, c, d, indices @ ..] = *block;
    let (color0, color1) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
    let indices = u32::from_le_bytes(indices);
    color0 > color1 || (color0 == color1 && indices & indices >> 1 & 0x5555_5555 == 0)
}

/// The part of each row of blocks (BC1) or texels that belongs to a camera of a tile, stored or not, padding included.
fn rows<'a>(
    raw: &'a [u8],
    tiling: &SlabTiling,
    tile: u32,
    [s, t]: [u32; 2],
) -> impl Iterator<Item = &'a [u8]> + use<'a> {
    let (unit, width) = (Unit::of(tiling.encoding()), tiling.tile_size(tile)[0]);
    let extent = |windows: &Windows, i: u32| windows.get(i).map_or(0, |w| (w.end - w.start).next_multiple_of(4));
    let [across, down] = [extent(tiling.coverage().columns(), s), extent(tiling.coverage().rows(), t)];
    let (x, y) = (tiling.column_place(s), tiling.row_place(t));
    (y..y + down).step_by(unit.texels as usize).filter_map(move |y| {
        let start = unit.offset(width, [x, y]);
        raw.get(start..start + unit.row_bytes(across))
    })
}
