//! A second writer, made from the specification alone: it can also write files that break the rules.

use glam::{DVec3, Vec3};
use lf_format::{Container, FormatError, Limits, Metadata, Packing, SlabTiling, TexelEncoding, Writer};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab};
use xxhash_rust::xxh64::xxh64;

#[derive(Clone)]
pub(crate) struct Chunk {
    pub(crate) tag: [u8; 4],
    pub(crate) flags: u16,
    pub(crate) packing: u8,
    pub(crate) slab: u32,
    pub(crate) tile: u32,
    pub(crate) payload: Vec<u8>,
    pub(crate) raw_len: u64,
}

#[derive(Clone)]
pub(crate) struct File {
    pub(crate) version: (u16, u16),
    pub(crate) chunks: Vec<Chunk>,
}

impl Chunk {
    pub(crate) fn new(tag: &[u8; 4], flags: u16, payload: Vec<u8>) -> Self {
        let raw_len = payload.len() as u64;
        Self { tag: *tag, flags, packing: 0, slab: 0, tile: 0, payload, raw_len }
    }

    fn identity(&self) -> Vec<u8> {
        let mut out = self.tag.to_vec();
        out.extend(self.flags.to_le_bytes());
        out.extend([self.packing, 0]);
        out.extend(self.slab.to_le_bytes());
        out.extend(self.tile.to_le_bytes());
        out
    }
}

impl File {
    /// The chunks of the smallest file: see §10 of the specification.
    pub(crate) fn smallest() -> Self {
        let tile = vec![0x00, 0xF8, 0x1F, 0x00, 0, 0, 0, 0];
        Self { version: (1, 0), chunks: vec![Chunk::new(b"GEOM", 1, smallest_geom()), Chunk::new(b"TILE", 1, tile)] }
    }

    /// [`Self::smallest`] with another chunk between its two.
    pub(crate) fn with(chunk: Chunk) -> Self {
        let mut file = Self::smallest();
        file.chunks.insert(1, chunk);
        file
    }

    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut body = vec![0; 64 + 48 * self.chunks.len()];
        let mut directory = Vec::new();
        for chunk in &self.chunks {
            body.resize(body.len().next_multiple_of(64), 0);
            let (offset, identity) = (body.len() as u64, chunk.identity());
            let checksum = xxh64(&[&identity[..], &chunk.payload].concat(), 0);
            directory.extend(identity);
            for value in [offset, chunk.payload.len() as u64, chunk.raw_len, checksum] {
                directory.extend(value.to_le_bytes());
            }
            body.extend(&chunk.payload);
        }
        body[64..64 + directory.len()].copy_from_slice(&directory);
        body[..12].copy_from_slice(b"\x8ALFSLAB\0\r\n\x1A\n");
        body[12..14].copy_from_slice(&self.version.0.to_le_bytes());
        body[14..16].copy_from_slice(&self.version.1.to_le_bytes());
        let file_len = body.len() as u64;
        body[16..24].copy_from_slice(&file_len.to_le_bytes());
        body[24..32].copy_from_slice(&64u64.to_le_bytes());
        body[32..36].copy_from_slice(&(self.chunks.len() as u32).to_le_bytes());
        reseal(&mut body);
        body
    }
}

/// Puts in the right checksums of directory and header, after a change to them.
pub(crate) fn reseal(file: &mut [u8]) {
    let count = u32::from_le_bytes(file[32..36].try_into().unwrap()) as usize;
    if let Some(directory) = count.checked_mul(48).and_then(|len| file.get(64..len.checked_add(64)?)) {
        let checksum = xxh64(directory, 0);
        file[40..48].copy_from_slice(&checksum.to_le_bytes());
    }
    let checksum = xxh64(&file[..56], 0);
    file[56..64].copy_from_slice(&checksum.to_le_bytes());
}

/// The `GEOM` payload of one +Z slab, one camera, 4×4 texels.
fn smallest_geom() -> Vec<u8> {
    let mut out = vec![0; 24];
    out.extend([0.5f32; 3].into_iter().flat_map(f32::to_le_bytes));
    out.extend(1u32.to_le_bytes());
    out.extend([4, 1, 0, 0]);
    out.extend(0.5f32.to_le_bytes());
    for (first, step, count) in [(0.0f32, 1.0f32, 1u32), (0.0, 1.0, 1), (-0.75, 0.5, 4), (-0.75, 0.5, 4)] {
        out.extend(first.to_le_bytes());
        out.extend(step.to_le_bytes());
        out.extend(count.to_le_bytes());
    }
    out.extend(0f32.to_le_bytes());
    out.extend([1u32; 2].into_iter().flat_map(u32::to_le_bytes));
    out
}

/// The same file by the library's writer.
pub(crate) fn smallest_writer() -> Writer {
    let st = SampledAxis::new(0.0, 1.0, 1).unwrap();
    let uv = SampledAxis::new(-0.75, 0.5, 4).unwrap();
    let slab = Slab::new(Face::PosZ, 0.5, [st; 2], [uv; 2], None).unwrap();
    let geometry = LightFieldGeometry::new(Cell::new(DVec3::ZERO, Vec3::splat(0.5)).unwrap(), vec![slab]).unwrap();
    let tiling = SlabTiling::new(&slab, TexelEncoding::Bc1, [1, 1]).unwrap();
    let mut writer = Writer::new(geometry, vec![tiling], Metadata::new()).unwrap();
    writer.add_tile(0, 0, Packing::None, vec![0x00, 0xF8, 0x1F, 0x00, 0, 0, 0, 0]).unwrap();
    writer
}

/// Parses with default limits.
pub(crate) fn parse(bytes: &[u8]) -> Result<Container<'_>, FormatError> {
    Container::parse(bytes, &Limits::default())
}

/// The error of a file that must be refused.
pub(crate) fn refusal(bytes: &[u8]) -> FormatError {
    match parse(bytes) {
        Ok(_) => panic!("the file was accepted"),
        Err(error) => error,
    }
}

/// Asserts that a file is refused as malformed for breaking one clause at one byte.
#[track_caller]
pub(crate) fn assert_breaks(bytes: &[u8], expected: &str, at: usize) {
    match refusal(bytes) {
        FormatError::Malformed { clause, offset, .. } if (clause, offset) == (expected, at as u64) => {}
        other => panic!("expected a break of {expected} at byte {at}, got: {other}"),
    }
}
