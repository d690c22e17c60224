//! From streams back to blocks. What costs time is to predict indices for endpoints that are not the neighbour's; blocks
//! that copy them are done in a few nanoseconds.

use fearless_simd::{Level, Simd, dispatch};

use super::block::{Block, ESCAPE, RawBlock, STEP_SUM, STEPS, join, split};
use super::grid::{self, Around, CONTEXTS, earlier};
use super::streams::Content;
use super::transfer::transfer;
use super::{TileError, TileShape};

/// Unpacks a tile to its blocks in raster order, exactly as they were given to [`encode`](super::encode).
///
/// `bytes` and `shape` may come from anywhere. Beside the result, [`TileShape::raw_len`] bytes, at most 11/8 of that is
/// held, and less than 100 bytes for each column and row of blocks of the tile's picture.
///
/// # Errors
/// [`TileError::Frame`] if `bytes` is not one whole zstd frame with its content size and a window of at most 8 MiB,
/// [`TileError::Malformed`] if what it holds is not the streams of a tile of this shape.
pub fn decode(shape: &TileShape, bytes: &[u8]) -> Result<Vec<u8>, TileError> {
    let content = Content::unpack(bytes, shape.block_count())?;
    let mut tile = vec![[0; 8]; shape.block_count()];
    read_tile(shape, &content, &mut tile)?;
    Ok(tile.into_flattened())
}

/// As [`decode`], into a buffer of exactly [`TileShape::raw_len`] bytes; on an error its contents are of no use.
///
/// # Errors
/// As [`decode`]; [`TileError::BlockBytes`] if the buffer has another length.
pub fn decode_into(shape: &TileShape, bytes: &[u8], out: &mut [u8]) -> Result<(), TileError> {
    let found = out.len();
    match out.as_chunks_mut() {
        (tile, []) if tile.len() == shape.block_count() => {
            read_tile(shape, &Content::unpack(bytes, shape.block_count())?, tile)
        }
        _ => Err(TileError::BlockBytes { expected: shape.raw_len(), found }),
    }
}

fn read_tile(shape: &TileShape, content: &Content, tile: &mut [RawBlock]) -> Result<(), TileError> {
    let mut reader = Reader::new(content);
    dispatch!(Level::new(), simd => read_blocks(simd, shape, &mut reader, tile));
    reader.finish(content)
}

#[inline(always)]
fn read_blocks<S: Simd>(simd: S, shape: &TileShape, reader: &mut Reader<'_>, tile: &mut [RawBlock]) {
    grid::walk(shape, tile, |around, tile| {
        let (block, rows) = reader.block(simd, around, tile);
        tile[around.place] = block.to_raw();
        (block, rows)
    });
}

/// A cursor in each stream, as an index into the whole content.
///
/// Nothing is checked on the way but that indices lie within the content: a stream that is too short continues into
/// the next, and [`Reader::finish`] finds out.
struct Reader<'a> {
    content: &'a [u8],
    modes: [usize; CONTEXTS],
    steps: usize,
    escapes: usize,
    rows: usize,
    /// Whether a step occurred that is none.
    malformed: bool,
}

impl<'a> Reader<'a> {
    fn new(content: &'a Content) -> Self {
        let [a, b, c, d, steps, escapes, rows] = content.starts();
        Self { content: content.bytes(), modes: [a, b, c, d], steps, escapes, rows, malformed: false }
    }

    /// The next block, and how many rows of its indices were corrected.
    #[inline(always)]
    fn block<S: Simd>(&mut self, simd: S, around: &Around<'_>, tile: &[RawBlock]) -> (Block, u8) {
        let mode = self.mode(around.context);
        let rows = usize::from(mode & 15);
        let correction = self.correction(rows);
        let ([up_left, up, up_right], left) = (around.above, around.left);
        // The kinds 6 and 7 begin with the endpoints above and to the left, as 0 and 1 do.
        let base = if mode & 0x20 == 0 { up.ends } else { left.ends };
        let ends = match mode >> 5 {
            0 | 1 => base,
            2 => up_right.ends,
            3 => up_left.ends,
            kind @ 4..6 => earlier(tile, around.place, around.back[usize::from(kind & 1)]).ends,
            _ => self.stepped(base),
        };
        let source = if mode & 0x10 == 0 { up } else { left };
        (Block { ends, indices: transfer(simd, ends, source) ^ correction }, ROW_COUNT[rows])
    }

    #[inline(always)]
    fn mode(&mut self, context: usize) -> u8 {
        let next = &mut self.modes[context % CONTEXTS];
        let mode = self.content.get(*next).copied().unwrap_or(0);
        *next += 1;
        mode
    }

    /// Spreads the next few bytes over the rows that are corrected.
    #[inline(always)]
    fn correction(&mut self, rows: usize) -> u32 {
        let (word, spread) = (u32::from_le_bytes(self.peek(self.rows)), &SPREAD[rows]);
        self.rows += usize::from(ROW_COUNT[rows]);
        (word & spread[0]) | (word << 8 & spread[1]) | (word << 16 & spread[2]) | (word << 24 & spread[3])
    }

    #[inline(always)]
    fn stepped(&mut self, from: u32) -> u32 {
        let symbols = self.peek::<2>(self.steps);
        self.steps += 2;
        let ([first, second], [from0, from1]) = (symbols.map(|symbol| STEP_SUM[usize::from(symbol)]), split(from));
        let ends = join([from0.wrapping_add(first), from1.wrapping_add(second)]);
        let plain = symbols.iter().all(|&symbol| usize::from(symbol) < STEPS);
        if plain { ends } else { self.escaped(symbols, ends) }
    }

    /// As [`Self::stepped`], for bytes that are not both steps.
    #[cold]
    fn escaped(&mut self, symbols: [u8; 2], ends: u32) -> u32 {
        let mut colors = split(ends);
        for (symbol, color) in symbols.into_iter().zip(&mut colors) {
            if symbol == ESCAPE {
                *color = u16::from_le_bytes(self.peek(self.escapes));
                self.escapes += 2;
            } else {
                self.malformed |= usize::from(symbol) >= STEPS;
            }
        }
        join(colors)
    }

    /// The bytes at `at`, zeros beyond the end.
    #[inline(always)]
    fn peek<const N: usize>(&self, at: usize) -> [u8; N] {
        self.content.get(at..).and_then(<[u8]>::first_chunk).copied().unwrap_or([0; N])
    }

    /// Makes sure that every stream was used up, and none beyond its end.
    fn finish(&self, content: &Content) -> Result<(), TileError> {
        let &Self { modes: [a, b, c, d], steps, escapes, rows, .. } = self;
        if self.malformed {
            Err(TileError::Malformed("a step of an endpoint is none of those there are"))
        } else if [a, b, c, d, steps, escapes, rows] != content.ends() {
            Err(TileError::Malformed("a stream is too short or too long"))
        } else {
            Ok(())
        }
    }
}

/// Set bits of 0 to 15.
const ROW_COUNT: [u8; 16] = {
    let mut counts = [0; 16];
    let mut rows = 0;
    while rows < 16 {
        counts[rows] = (rows as u32).count_ones() as u8;
        rows += 1;
    }
    counts
};

/// For each set of rows: which bytes of a word stay in their place, and which move up by one, two, three.
const SPREAD: [[u32; 4]; 16] = {
    let mut spread = [[0; 4]; 16];
    let mut rows = 0;
    while rows < 16 {
        let (mut row, mut taken) = (0, 0);
        while row < 4 {
            if rows >> row & 1 == 1 {
                spread[rows][row - taken] |= 0xff << (8 * row);
                taken += 1;
            }
            row += 1;
        }
        rows += 1;
    }
    spread
};
