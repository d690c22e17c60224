//! The byte streams that a tile is coded in, and the frame that holds them.

use std::io::{self, Write};

use zstd::stream::Encoder;
use zstd::zstd_safe::CParameter;

use super::TileError;
use super::block::{Block, ESCAPE, split};
use super::choice::Choice;
use super::grid::CONTEXTS;
use crate::zstd_tile;

/// Streams in a tile: modes by context, steps, escaped endpoints, rows of corrections.
const STREAMS: usize = CONTEXTS + 3;
/// Each stream's length, a `u32`, stands before the first.
const HEADER_LEN: usize = 4 * STREAMS;
/// Bytes that a block puts into the streams at most: a mode, two steps, two escaped endpoints, four rows.
const BLOCK_LEN: u64 = 11;
/// Shortest match that zstd looks for. Shorter ones are chance: they cost 1 % in size and a third more time to decode.
const MIN_MATCH: u32 = 6;
/// Zeros that the decoder keeps after the last stream, so that it can always read a word.
const SLACK: usize = 4;

/// The streams of a tile in the making.
#[derive(Default)]
pub(super) struct Streams {
    modes: [Vec<u8>; CONTEXTS],
    steps: Vec<u8>,
    escapes: Vec<u8>,
    rows: Vec<u8>,
}

impl Streams {
    pub(super) fn push(&mut self, context: usize, choice: &Choice, block: Block) {
        self.modes[context].push(choice.mode);
        if choice.ends.has_steps() {
            for (step, color) in choice.ends.steps.into_iter().zip(split(block.ends)) {
                self.steps.push(step);
                if step == ESCAPE {
                    self.escapes.extend(color.to_le_bytes());
                }
            }
        }
        self.rows.extend(choice.correction.to_le_bytes().into_iter().filter(|&byte| byte != 0));
    }

    /// One frame with its content size. Each stream ends a zstd block, so that it has its own Huffman code.
    pub(super) fn to_frame(&self, level: i32) -> io::Result<Vec<u8>> {
        let [a, b, c, d] = &self.modes;
        let streams: [&Vec<u8>; STREAMS] = [a, b, c, d, &self.steps, &self.escapes, &self.rows];
        let content_len = HEADER_LEN + streams.iter().map(|stream| stream.len()).sum::<usize>();
        let mut encoder = Encoder::new(Vec::new(), level)?;
        encoder.set_pledged_src_size(Some(content_len as u64))?;
        if content_len > 1 << zstd_tile::MAX_WINDOW_LOG {
            encoder.window_log(zstd_tile::MAX_WINDOW_LOG)?;
        }
        encoder.set_parameter(CParameter::MinMatch(MIN_MATCH))?;
        for stream in streams {
            // A tile's streams hold less than 2³² bytes in all, see `TileShape`.
            encoder.write_all(&(stream.len() as u32).to_le_bytes())?;
        }
        for stream in streams {
            encoder.write_all(stream)?;
            encoder.flush()?;
        }
        encoder.finish()
    }
}

/// The streams of a tile as the decoder reads them.
pub(super) struct Content {
    bytes: Vec<u8>,
    /// Where each stream ends.
    ends: [usize; STREAMS],
}

impl Content {
    /// Unpacks a frame. Nothing beyond 28 bytes and 11 a block is allocated, whatever the frame says.
    pub(super) fn unpack(frame: &[u8], blocks: usize) -> Result<Self, TileError> {
        let limit = HEADER_LEN as u64 + BLOCK_LEN * blocks as u64;
        let bytes = zstd_tile::unpack_up_to(frame, limit, SLACK).map_err(TileError::Frame)?;
        let len = bytes.len();
        let (lengths, _) = bytes.as_chunks::<4>();
        let mut ends = [HEADER_LEN; STREAMS];
        let mut end = HEADER_LEN;
        for (place, length) in ends.iter_mut().zip(lengths) {
            end = end.saturating_add(u32::from_le_bytes(*length) as usize);
            *place = end;
        }
        if len < HEADER_LEN || end != len {
            return Err(TileError::Malformed("the streams do not fill the frame"));
        }
        let mut bytes = bytes;
        bytes.resize(len + SLACK, 0);
        Ok(Self { bytes, ends })
    }

    /// All streams with the header before them and four zeros after them.
    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes
    }

    /// Where each stream begins.
    pub(super) fn starts(&self) -> [usize; STREAMS] {
        std::array::from_fn(|i| i.checked_sub(1).map_or(HEADER_LEN, |before| self.ends[before]))
    }

    /// Where each stream ends.
    pub(super) fn ends(&self) -> [usize; STREAMS] {
        self.ends
    }
}
