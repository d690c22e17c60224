//! zstd frames put together by hand (RFC 8878), so that the files do not depend on what a version of zstd makes.

use xxhash_rust::xxh64::xxh64;

const MAGIC: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];
/// The most that a block holds.
const BLOCK: usize = 128 << 10;
/// Runs shorter than this are not worth a block.
const RUN: usize = 16;

/// A frame: its header, and blocks of which each is stored as it is or is a run of one byte.
pub(crate) struct Frame {
    pub(crate) content_size: Option<u64>,
    /// Exponent and mantissa of the window; without them the window is the content.
    pub(crate) window: Option<(u8, u8)>,
    pub(crate) dictionary: Option<u8>,
    pub(crate) checksum: bool,
}

impl Frame {
    /// A frame that states its size, in four bytes.
    pub(crate) fn of(content: &[u8]) -> Self {
        Self { content_size: Some(content.len() as u64), window: None, dictionary: None, checksum: false }
    }

    pub(crate) fn pack(&self, content: &[u8]) -> Vec<u8> {
        let mut out = self.header();
        out.extend(blocks(content));
        if self.checksum {
            out.extend(&xxh64(content, 0).to_le_bytes()[..4]);
        }
        out
    }

    fn header(&self) -> Vec<u8> {
        let mut out = MAGIC.to_vec();
        let size_flag = if self.content_size.is_some() { 0x80 } else { 0 };
        let single = if self.window.is_none() { 0x20 } else { 0 };
        out.push(size_flag | single | u8::from(self.checksum) << 2 | u8::from(self.dictionary.is_some()));
        out.extend(self.window.map(|(exponent, mantissa)| exponent << 3 | mantissa));
        out.extend(self.dictionary);
        out.extend(self.content_size.into_iter().flat_map(|size| (size as u32).to_le_bytes()));
        out
    }
}

/// A frame of the content in the plainest form that a file may hold.
pub(crate) fn zstd(content: &[u8]) -> Vec<u8> {
    Frame::of(content).pack(content)
}

/// A frame with a window of 8 MiB that states one size and holds another number of zeros.
pub(crate) fn bomb(stated: u64, blocks: usize) -> Vec<u8> {
    let frame = Frame { content_size: Some(stated), window: Some((13, 0)), dictionary: None, checksum: false };
    let mut out = frame.header();
    for i in 0..blocks {
        out.extend(block_header(i + 1 == blocks, 1, BLOCK));
        out.push(0);
    }
    out
}

fn blocks(content: &[u8]) -> Vec<u8> {
    if content.is_empty() {
        return block_header(true, 0, 0);
    }
    let mut out = Vec::new();
    let mut rest = content;
    while !rest.is_empty() {
        let run = run_of(rest);
        let (kind, len) = if run >= RUN { (1, run.min(BLOCK)) } else { (0, up_to_run(rest)) };
        let (block, after) = rest.split_at(len);
        out.extend(block_header(after.is_empty(), kind, len));
        out.extend(if kind == 1 { &block[..1] } else { block });
        rest = after;
    }
    out
}

/// How many bytes at the start are alike.
fn run_of(bytes: &[u8]) -> usize {
    bytes.iter().take_while(|&byte| *byte == bytes[0]).count()
}

/// How many bytes come before the next long run.
fn up_to_run(bytes: &[u8]) -> usize {
    (1..bytes.len().min(BLOCK)).find(|&i| run_of(&bytes[i..]) >= RUN).unwrap_or(bytes.len().min(BLOCK))
}

/// Whether it is the last one, 0 for bytes as they are and 1 for a run, and how many.
fn block_header(last: bool, kind: u32, len: usize) -> Vec<u8> {
    (u32::from(last) | kind << 1 | (len as u32) << 3).to_le_bytes()[..3].to_vec()
}
