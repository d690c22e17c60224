//! The `GEOM` chunk: cell, slabs and their tilings (spec §5).

use glam::{DVec3, Vec3};
use lf_math::{Cell, Face, GeometryError, LightFieldGeometry, SampledAxis, Slab};

use crate::bytes::Cursor;
use crate::{FormatError, Limits, SlabTiling, TexelEncoding};

/// Values are sRGB-encoded and interpolated as they are stored.
const TRANSFER_SRGB: u8 = 0;

/// Where the record of the first slab begins, from the start of the payload, and how long a record is.
const RECORDS_AT: u64 = 40;
const RECORD_LEN: u64 = 68;

type Geometry = (LightFieldGeometry, Vec<SlabTiling>);

/// Reads the chunk's payload, which begins at `offset` in the file.
pub(crate) fn parse(payload: &[u8], offset: u64, limits: &Limits) -> Result<Geometry, FormatError> {
    let mut cursor = Cursor::new(payload, offset, "§5");
    let cell = parse_cell(&mut cursor)?;
    let at = cursor.offset();
    let count = cursor.u32()?;
    if !(1..=6).contains(&count) {
        return Err(FormatError::malformed(at, "§5.2", format!("there are {count} slabs, must be 1 to 6")));
    }
    let mut slabs = Vec::new();
    let mut tilings = Vec::new();
    for _ in 0..count {
        let (slab, tiling) = parse_slab(&mut cursor)?;
        slabs.push(slab);
        tilings.push(tiling);
    }
    cursor.finish()?;
    let at = offset.saturating_add(disordered_record(&slabs));
    let geometry = LightFieldGeometry::new(cell, slabs).map_err(rule(at, "§5.3"))?;
    limits.geometry(&geometry, &tilings)?;
    Ok((geometry, tilings))
}

/// Where the record of the first slab is whose face does not come after the one before, from the start of the payload.
fn disordered_record(slabs: &[Slab]) -> u64 {
    let before = slabs.windows(2).take_while(|pair| pair[0].face() < pair[1].face()).count();
    RECORDS_AT + RECORD_LEN * (before as u64 + 1)
}

/// Turns a broken rule of geometry into a malformed file.
fn rule(offset: u64, clause: &'static str) -> impl Fn(GeometryError) -> FormatError {
    move |error| FormatError::malformed(offset, clause, error.to_string())
}

fn parse_cell(cursor: &mut Cursor<'_>) -> Result<Cell, FormatError> {
    let at = cursor.offset();
    let center = DVec3::new(cursor.f64()?, cursor.f64()?, cursor.f64()?);
    let half_extent = Vec3::new(cursor.f32()?, cursor.f32()?, cursor.f32()?);
    Cell::new(center, half_extent).map_err(rule(at, "§5.1"))
}

fn parse_slab(cursor: &mut Cursor<'_>) -> Result<(Slab, SlabTiling), FormatError> {
    let face = parse_face(cursor)?;
    let encoding = parse_encoding(cursor)?;
    parse_transfer(cursor)?;
    cursor.reserved::<1>("§5.10")?;
    let at = cursor.offset();
    let plane = cursor.f32()?;
    let st = [parse_axis(cursor)?, parse_axis(cursor)?];
    let uv = [parse_axis(cursor)?, parse_axis(cursor)?];
    let slab = Slab::new(face, plane, st, uv, None).map_err(rule(at, "§5.6"))?;
    let slab = parse_focal_depth(cursor, slab)?;
    let tiling = parse_tiling(cursor, &slab, encoding)?;
    Ok((slab, tiling))
}

fn parse_face(cursor: &mut Cursor<'_>) -> Result<Face, FormatError> {
    let (at, index) = (cursor.offset(), cursor.u8()?);
    Face::from_index(index)
        .ok_or_else(|| FormatError::malformed(at, "§5.3", format!("a slab's face is {index}, must be 0 to 5")))
}

fn parse_encoding(cursor: &mut Cursor<'_>) -> Result<TexelEncoding, FormatError> {
    let (at, id) = (cursor.offset(), cursor.u8()?);
    TexelEncoding::from_id(id)
        .ok_or_else(|| FormatError::unsupported(at, "§5.4", format!("a slab uses texel encoding {id}")))
}

fn parse_transfer(cursor: &mut Cursor<'_>) -> Result<(), FormatError> {
    let (at, id) = (cursor.offset(), cursor.u8()?);
    if id == TRANSFER_SRGB {
        return Ok(());
    }
    Err(FormatError::unsupported(at, "§5.5", format!("a slab uses transfer function {id}")))
}

fn parse_axis(cursor: &mut Cursor<'_>) -> Result<SampledAxis, FormatError> {
    let at = cursor.offset();
    SampledAxis::new(cursor.f32()?, cursor.f32()?, cursor.u32()?).map_err(rule(at, "§5.7"))
}

fn parse_focal_depth(cursor: &mut Cursor<'_>, slab: Slab) -> Result<Slab, FormatError> {
    let at = cursor.offset();
    let depth = cursor.f32()?;
    // By its bits: −0 is not another way to say "none".
    let depth = if depth.to_bits() == 0 { None } else { Some(depth) };
    slab.with_focal_depth(depth).map_err(rule(at, "§5.8"))
}

fn parse_tiling(cursor: &mut Cursor<'_>, slab: &Slab, encoding: TexelEncoding) -> Result<SlabTiling, FormatError> {
    let at = cursor.offset();
    let cameras_per_tile = [cursor.u32()?, cursor.u32()?];
    SlabTiling::checked(slab, encoding, cameras_per_tile).map_err(|what| FormatError::malformed(at, "§5.9", what))
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
    out.extend([slab.face().index(), tiling.encoding().id(), TRANSFER_SRGB, 0]);
    out.extend(slab.plane().to_le_bytes());
    for axis in slab.st().into_iter().chain(slab.uv()) {
        out.extend(axis.first().to_le_bytes());
        out.extend(axis.step().to_le_bytes());
        out.extend(axis.count().to_le_bytes());
    }
    out.extend(slab.focal_depth().unwrap_or(0.0).to_le_bytes());
    out.extend(tiling.cameras_per_tile().into_iter().flat_map(u32::to_le_bytes));
}
