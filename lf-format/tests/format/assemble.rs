//! A second writer, made from clauses 3 and 4 of the specification alone: it can also write files that break the rules.

use xxhash_rust::xxh64::xxh64;

pub(crate) const MAGIC: &[u8; 12] = b"\x8ALFSLAB\0\r\n\x1A\n";

/// A chunk with the fields of its entry that do not follow from its place.
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

/// A file by its chunks, in the order of the directory.
#[derive(Clone)]
pub(crate) struct File {
    pub(crate) version: (u16, u16),
    pub(crate) chunks: Vec<Chunk>,
}

impl Chunk {
    /// A chunk that is not packed and belongs to no slab.
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
    pub(crate) fn new(chunks: Vec<Chunk>) -> Self {
        Self { version: (1, 0), chunks }
    }

    /// The same file with one chunk more.
    pub(crate) fn with(mut self, index: usize, chunk: Chunk) -> Self {
        self.chunks.insert(index, chunk);
        self
    }

    /// The same file with other bytes somewhere in the payload of a chunk.
    pub(crate) fn patch(mut self, chunk: usize, at: usize, bytes: &[u8]) -> Self {
        self.chunks[chunk].payload[at..at + bytes.len()].copy_from_slice(bytes);
        self
    }

    /// Where the payload of a chunk begins (§4.5).
    pub(crate) fn payload_at(&self, chunk: usize) -> usize {
        let before = self.chunks[..chunk].iter().map(|chunk| chunk.payload.len());
        let start = entry_at(self.chunks.len()).next_multiple_of(64);
        before.fold(start, |at, len| (at + len).next_multiple_of(64))
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
        body[..12].copy_from_slice(MAGIC);
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

/// Where an entry of the directory begins.
pub(crate) fn entry_at(index: usize) -> usize {
    64 + 48 * index
}

/// A file with other bytes somewhere in header or directory, and right checksums of both.
pub(crate) fn patched(file: &File, at: usize, bytes: &[u8]) -> Vec<u8> {
    let mut file = file.to_bytes();
    file[at..at + bytes.len()].copy_from_slice(bytes);
    reseal(&mut file);
    file
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
