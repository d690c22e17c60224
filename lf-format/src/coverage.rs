//! The `CROP` and `MASK` chunks: what is left out of a slab (spec §6).

use alloc::format;
use alloc::string::ToString;
use alloc::vec::Vec;
use core::ops::Range;

use lf_math::{Coverage, Slab};

use crate::bytes::Cursor;
use crate::tiling::BLOCK;
use crate::{FormatError, Rule};

/// Bytes of a window's record.
const RECORD_LEN: u64 = 8;

/// Length of the `CROP` payload of a slab.
pub(crate) fn crop_len(slab: &Slab) -> u64 {
    RECORD_LEN * slab.cameras().map(u64::from).iter().sum::<u64>()
}

/// Length of the `MASK` payload of a slab.
pub(crate) fn mask_len(slab: &Slab) -> u64 {
    slab.cameras().map(u64::from).iter().product::<u64>().div_ceil(8)
}

/// Reads the payload of a `CROP` chunk, which begins at `offset` in the file and has the right length.
pub(crate) fn parse_crop(payload: &[u8], offset: u64, slab: &Slab) -> Result<Coverage, FormatError> {
    let mut cursor = Cursor::new(payload, offset, Rule::CropLength);
    let [cameras, texels] = [slab.cameras(), slab.resolution()];
    let columns = parse_windows(&mut cursor, cameras[0], texels[0])?;
    let rows = parse_windows(&mut cursor, cameras[1], texels[1])?;
    cursor.finish()?;
    let coverage = Coverage::new(slab, columns, rows)
        .map_err(|error| FormatError::malformed(offset, Rule::CropWindow, error.to_string()))?;
    if coverage.is_whole() {
        return Err(FormatError::malformed(offset, Rule::CropNothing, "a CROP chunk leaves nothing out"));
    }
    Ok(coverage)
}

fn parse_windows(cursor: &mut Cursor<'_>, count: u32, texels: u32) -> Result<Vec<Range<u32>>, FormatError> {
    (0..count).map(|_| parse_window(cursor, texels)).collect()
}

fn parse_window(cursor: &mut Cursor<'_>, texels: u32) -> Result<Range<u32>, FormatError> {
    let (at, first, number) = (cursor.offset(), cursor.u32()?, cursor.u32()?);
    let blocks = texels.div_ceil(BLOCK);
    match first.checked_add(number) {
        Some(end) if end <= blocks && (number > 0 || first == 0) => {
            Ok(first.saturating_mul(BLOCK)..end.saturating_mul(BLOCK).min(texels))
        }
        _ => {
            let what = format!("a window has {number} blocks from {first} on, the image has {blocks}");
            Err(FormatError::malformed(at, Rule::CropWindow, what))
        }
    }
}

/// Reads the payload of a `MASK` chunk, which begins at `offset` in the file and has the right length.
pub(crate) fn parse_mask(payload: &[u8], offset: u64, coverage: Coverage) -> Result<Coverage, FormatError> {
    let mut kept = Vec::with_capacity(payload.len().saturating_mul(8));
    let bit = |i: usize| payload.get(i / 8).is_some_and(|byte| byte >> (i % 8) & 1 == 1);
    let mut left_out = false;
    for (i, camera) in coverage.cameras().enumerate() {
        match (bit(i), coverage.window(camera).is_some()) {
            (true, false) => return Err(stray_bit(offset, i)),
            (stored, windowed) => left_out |= windowed && !stored,
        }
        kept.push(bit(i));
    }
    if let Some(i) = (kept.len()..8 * payload.len()).find(|&i| bit(i)) {
        return Err(stray_bit(offset, i));
    }
    if !left_out {
        return Err(FormatError::malformed(offset, Rule::MaskNothing, "a MASK chunk leaves nothing out"));
    }
    coverage.with_cameras(kept).map_err(|error| FormatError::malformed(offset, Rule::MaskLength, error.to_string()))
}

fn stray_bit(offset: u64, i: usize) -> FormatError {
    let at = offset.saturating_add(i as u64 / 8);
    FormatError::malformed(
        at,
        Rule::MaskBits,
        format!("bit {i} of a MASK chunk is set for no camera or an empty window"),
    )
}

/// The payload of the `CROP` chunk; `None` if all windows are whole.
pub(crate) fn crop_bytes(coverage: &Coverage) -> Option<Vec<u8>> {
    if coverage.columns().is_whole() && coverage.rows().is_whole() {
        return None;
    }
    let record = |window: Range<u32>| {
        let (first, end) = (window.start / BLOCK, window.end.div_ceil(BLOCK));
        let number = if window.start < window.end { end - first } else { 0 };
        [if number > 0 { first } else { 0 }, number]
    };
    let records = coverage.columns().iter().chain(coverage.rows().iter()).flat_map(record);
    Some(records.flat_map(u32::to_le_bytes).collect())
}

/// The payload of the `MASK` chunk; `None` if every camera with a window is stored.
pub(crate) fn mask_bytes(coverage: &Coverage) -> Option<Vec<u8>> {
    if coverage.keeps_all_cameras() {
        return None;
    }
    let mut out = Vec::new();
    for (i, camera) in coverage.cameras().enumerate() {
        if i % 8 == 0 {
            out.push(0);
        }
        if let (Some(byte), Some(_)) = (out.last_mut(), coverage.window(camera)) {
            *byte |= 1 << (i % 8);
        }
    }
    Some(out)
}
