//! The `GEOM` chunk: cell, slabs and their tilings (spec §5).

use alloc::format;
use alloc::string::ToString;
use alloc::vec::Vec;

use glam::{DVec3, Vec3};
use lf_math::{Cell, Face, GeometryError, LightFieldGeometry, SampledAxis, Slab};

use crate::bytes::Cursor;
use crate::{FormatError, Rule, SlabTiling, TexelEncoding};

/// Values are sRGB-encoded and interpolated as they are stored.
pub(crate) const TRANSFER_SRGB: u8 = 0;
/// Values are linear.
pub(crate) const TRANSFER_LINEAR: u8 = 1;
/// Samples along an axis at most.
pub(crate) const MAX_COUNT: u32 = 1 << 16;

/// Where the record of the first slab begins, from the start of the payload, and how long a record is.
const RECORDS_AT: u64 = 40;
const RECORD_LEN: u64 = 68;

/// How a slab is stored, as far as its record says.
#[derive(Clone, Copy)]
pub(crate) struct Storage {
    pub(crate) encoding: TexelEncoding,
    pub(crate) cameras_per_tile: [u32; 2],
}

/// Most bytes that the chunk can have.
pub(crate) const MAX_LEN: u64 = RECORDS_AT + 6 * RECORD_LEN;

/// Where the fields of §5.9 are in the record of a slab, from the start of the payload.
pub(crate) fn tiling_at(slab: usize) -> u64 {
    RECORDS_AT + RECORD_LEN * slab as u64 + 60
}

/// Reads the chunk's payload, which begins at `offset` in the file.
pub(crate) fn parse(payload: &[u8], offset: u64) -> Result<(LightFieldGeometry, Vec<Storage>), FormatError> {
    let mut cursor = Cursor::new(payload, offset, Rule::GeometryLength);
    let cell = parse_cell(&mut cursor)?;
    let at = cursor.offset();
    let count = cursor.u32()?;
    if !(1..=6).contains(&count) {
        return Err(FormatError::malformed(at, Rule::SlabCount, format!("there are {count} slabs, must be 1 to 6")));
    }
    let mut slabs = Vec::new();
    let mut storage = Vec::new();
    for _ in 0..count {
        let (slab, stored) = parse_slab(&mut cursor)?;
        slabs.push(slab);
        storage.push(stored);
    }
    cursor.finish()?;
    let at = offset.saturating_add(disordered_record(&slabs));
    let geometry = LightFieldGeometry::new(cell, slabs).map_err(broken(at, Rule::FaceOrder))?;
    Ok((geometry, storage))
}

/// Where the record of the first slab is whose face does not come after the one before, from the start of the payload.
fn disordered_record(slabs: &[Slab]) -> u64 {
    let before = slabs.windows(2).take_while(|pair| pair[0].face() < pair[1].face()).count();
    RECORDS_AT + RECORD_LEN * (before as u64 + 1)
}

/// Turns a broken rule of geometry into a malformed file.
fn broken(offset: u64, rule: Rule) -> impl Fn(GeometryError) -> FormatError {
    move |error| FormatError::malformed(offset, rule, error.to_string())
}

fn parse_cell(cursor: &mut Cursor<'_>) -> Result<Cell, FormatError> {
    let at = cursor.offset();
    let center = DVec3::new(cursor.f64()?, cursor.f64()?, cursor.f64()?);
    let half_extent = Vec3::new(cursor.f32()?, cursor.f32()?, cursor.f32()?);
    Cell::new(center, half_extent).map_err(broken(at, Rule::Cell))
}

fn parse_slab(cursor: &mut Cursor<'_>) -> Result<(Slab, Storage), FormatError> {
    let face = parse_face(cursor)?;
    let encoding = parse_encoding(cursor)?;
    parse_transfer(cursor, encoding)?;
    cursor.reserved::<1>(Rule::GeometryReserved)?;
    let at = cursor.offset();
    let plane = cursor.f32()?;
    let st = [parse_axis(cursor)?, parse_axis(cursor)?];
    let uv = [parse_axis(cursor)?, parse_axis(cursor)?];
    let slab = Slab::new(face, plane, st, uv, None).map_err(broken(at, Rule::Plane))?;
    let slab = parse_focal_depth(cursor, slab)?;
    let cameras_per_tile = parse_cameras_per_tile(cursor, &slab)?;
    Ok((slab, Storage { encoding, cameras_per_tile }))
}

fn parse_face(cursor: &mut Cursor<'_>) -> Result<Face, FormatError> {
    let (at, index) = (cursor.offset(), cursor.u8()?);
    Face::from_index(index)
        .ok_or_else(|| FormatError::malformed(at, Rule::Face, format!("a slab's face is {index}, must be 0 to 5")))
}

fn parse_encoding(cursor: &mut Cursor<'_>) -> Result<TexelEncoding, FormatError> {
    let (at, id) = (cursor.offset(), cursor.u8()?);
    TexelEncoding::from_id(id)
        .ok_or_else(|| FormatError::unsupported(at, Rule::Encoding, format!("a slab uses texel encoding {id}")))
}

fn parse_transfer(cursor: &mut Cursor<'_>, encoding: TexelEncoding) -> Result<(), FormatError> {
    let (at, id) = (cursor.offset(), cursor.u8()?);
    if id == encoding.transfer() {
        return Ok(());
    }
    let what = format!("a slab uses transfer function {id}, its texel encoding is known with {}", encoding.transfer());
    Err(FormatError::unsupported(at, Rule::Transfer, what))
}

fn parse_axis(cursor: &mut Cursor<'_>) -> Result<SampledAxis, FormatError> {
    let at = cursor.offset();
    let (first, step, count) = (cursor.f32()?, cursor.f32()?, cursor.u32()?);
    if count > MAX_COUNT {
        let what = format!("an axis has {count} samples, must have at most {MAX_COUNT}");
        return Err(FormatError::malformed(at, Rule::Axis, what));
    }
    SampledAxis::new(first, step, count).map_err(broken(at, Rule::Axis))
}

fn parse_focal_depth(cursor: &mut Cursor<'_>, slab: Slab) -> Result<Slab, FormatError> {
    let at = cursor.offset();
    let depth = cursor.f32()?;
    // By its bits: −0 is not another way to say "none".
    let depth = if depth.to_bits() == 0 { None } else { Some(depth) };
    slab.with_focal_depth(depth).map_err(broken(at, Rule::FocalDepth))
}

fn parse_cameras_per_tile(cursor: &mut Cursor<'_>, slab: &Slab) -> Result<[u32; 2], FormatError> {
    let at = cursor.offset();
    let per_tile = [cursor.u32()?, cursor.u32()?];
    check_cameras_per_tile(slab, per_tile).map_err(|what| FormatError::malformed(at, Rule::Tiling, what))?;
    Ok(per_tile)
}

/// The first rule of §5.9.
pub(crate) fn check_cameras_per_tile(slab: &Slab, per_tile: [u32; 2]) -> Result<(), &'static str> {
    let fits = |i: usize| (1..=slab.cameras()[i]).contains(&per_tile[i]);
    if fits(0) && fits(1) {
        return Ok(());
    }
    Err("a tile must hold at least one camera along each axis, and no more than the slab has")
}

/// The chunk's payload. `tilings` must be those of the geometry's slabs.
pub(crate) fn to_bytes(geometry: &LightFieldGeometry, tilings: &[SlabTiling]) -> Vec<u8> {
    let mut out = Vec::new();
    let cell = geometry.cell();
    out.extend(cell.center().to_array().into_iter().flat_map(f64::to_le_bytes));
    out.extend(cell.half_extent().to_array().into_iter().flat_map(f32::to_le_bytes));
    out.extend((geometry.slabs().len() as u32).to_le_bytes());
    for (slab, tiling) in geometry.slabs().iter().zip(tilings) {
        write_slab(&mut out, slab, tiling);
    }
    out
}

fn write_slab(out: &mut Vec<u8>, slab: &Slab, tiling: &SlabTiling) {
    out.extend([slab.face().index(), tiling.encoding().id(), tiling.encoding().transfer(), 0]);
    out.extend(slab.plane().to_le_bytes());
    for axis in slab.st().into_iter().chain(slab.uv()) {
        out.extend(axis.first().to_le_bytes());
        out.extend(axis.step().to_le_bytes());
        out.extend(axis.count().to_le_bytes());
    }
    out.extend(slab.focal_depth().unwrap_or(0.0).to_le_bytes());
    out.extend(tiling.cameras_per_tile().into_iter().flat_map(u32::to_le_bytes));
}
