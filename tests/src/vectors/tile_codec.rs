//! The tile codec written once more, from the text of `spec/codecs.md` alone: any way of coding a block that is allowed, so
//! that all of them occur, and no thought of size.

use std::collections::HashMap;
use std::ops::Range;

use super::paint::hash;

/// The streams of a tile (T.1).
#[derive(Clone, Default)]
pub(crate) struct Streams(pub(crate) [Vec<u8>; 7]);

impl Streams {
    /// The content of the frame.
    pub(crate) fn content(&self) -> Vec<u8> {
        let lengths = self.0.iter().flat_map(|stream| (stream.len() as u32).to_le_bytes());
        lengths.chain(self.0.concat()).collect()
    }
}

#[derive(Clone, Copy, Default)]
struct Block {
    ends: [u16; 2],
    indices: u32,
}

/// A tile's blocks by camera and position (T.2).
struct Tile<'a> {
    columns: &'a [Range<u32>],
    rows: &'a [Range<u32>],
    blocks: HashMap<(usize, usize, u32, u32), Block>,
}

/// The columns and rows of cameras whose windows hold a position.
struct Grid {
    columns: Vec<usize>,
    rows: Vec<usize>,
    at: [u32; 2],
}

/// Codes the blocks of a tile's picture, given in raster order, whose windows are `columns` and `rows`.
pub(crate) fn encode(columns: &[Range<u32>], rows: &[Range<u32>], raw: &[u8]) -> Streams {
    let tile = Tile { columns, rows, blocks: by_position(columns, rows, raw) };
    let mut streams = Streams::default();
    let mut contexts = vec![3; columns.len()];
    let end = |windows: &[Range<u32>]| windows.iter().map(|window| window.end).max().unwrap_or(0);
    for (y, x) in (0..end(rows)).flat_map(|y| (0..end(columns)).map(move |x| (y, x))) {
        let holding =
            |windows: &[Range<u32>], i: u32| (0..windows.len()).filter(|&c| windows[c].contains(&i)).collect();
        let grid = Grid { columns: holding(columns, x), rows: holding(rows, y), at: [x, y] };
        for (t, s) in (0..grid.rows.len()).flat_map(|t| (0..grid.columns.len()).map(move |s| (t, s))) {
            let context = &mut contexts[grid.columns[s]];
            let corrected = tile.code(&grid, s as isize, t as isize, *context, &mut streams);
            *context = corrected.min(3);
        }
    }
    streams
}

fn by_position(columns: &[Range<u32>], rows: &[Range<u32>], raw: &[u8]) -> HashMap<(usize, usize, u32, u32), Block> {
    let along = |windows: &[Range<u32>]| -> Vec<(usize, u32)> {
        windows.iter().enumerate().flat_map(|(i, window)| window.clone().map(move |x| (i, x))).collect()
    };
    let across = along(columns);
    let places = along(rows).into_iter().flat_map(|(t, y)| across.iter().map(move |&(s, x)| (s, t, x, y)));
    let block = |bytes: &[u8]| {
        let color = |i: usize| u16::from_le_bytes([bytes[i], bytes[i + 1]]);
        let indices = u32::from_le_bytes([bytes[4], bytes[5], bytes[6], bytes[7]]);
        Block { ends: [color(0), color(2)], indices }
    };
    places.zip(raw.chunks(8).map(block)).collect()
}

impl Tile<'_> {
    fn west(&self, s: usize, t: usize, [x, y]: [u32; 2]) -> Block {
        if before(&self.columns[s], x) {
            self.blocks[&(s, t, x - 1, y)]
        } else if before(&self.rows[t], y) {
            self.blocks[&(s, t, x, y - 1)]
        } else {
            Block::default()
        }
    }

    fn north(&self, s: usize, t: usize, [x, y]: [u32; 2]) -> Block {
        if before(&self.rows[t], y) { self.blocks[&(s, t, x, y - 1)] } else { self.west(s, t, [x, y]) }
    }

    /// C(s, t).
    fn cell(&self, grid: &Grid, s: isize, t: isize) -> Block {
        let column = grid.columns[s.clamp(0, grid.columns.len() as isize - 1) as usize];
        let row = grid.rows[t.max(0) as usize];
        let [x, y] = grid.at;
        match (0..grid.columns.len() as isize).contains(&s) {
            true if t < 0 => self.north(column, row, grid.at),
            true => self.blocks[&(column, row, x, y)],
            false => self.west(column, row, grid.at),
        }
    }

    /// Codes a block (T.4 to T.6), given its context, and returns how many rows of its indices were corrected.
    fn code(&self, grid: &Grid, s: isize, t: isize, context: usize, streams: &mut Streams) -> usize {
        let (column, row, [x, y]) = (grid.columns[s as usize], grid.rows[t as usize], grid.at);
        let block = self.blocks[&(column, row, x, y)];
        let cell = |s, t| self.cell(grid, s, t);
        let near = [
            cell(s, t - 1),
            cell(s - 1, t),
            cell(s + 1, t - 1),
            cell(s - 1, t - 1),
            self.west(column, row, grid.at),
            self.north(column, row, grid.at),
        ];
        let seed = hash(&[column as u32, row as u32, x, y]);
        let kinds: Vec<u8> = (0..6).filter(|&kind| near[usize::from(kind)].ends == block.ends).chain([6, 7]).collect();
        // By steps now and then, though the endpoints are there.
        let kind =
            if seed.is_multiple_of(8) { 6 + (seed >> 3 & 1) as u8 } else { kinds[(seed >> 8) as usize % kinds.len()] };
        let source = (seed >> 5 & 1) as u8;
        let correction = predict(block.ends, near[usize::from(source)]) ^ block.indices;
        let rows: Vec<u8> = (0..4).filter(|row| correction >> (8 * row) & 0xFF != 0).collect();
        let mask = rows.iter().fold(0, |mask, row| mask | 1 << row);
        streams.0[context].push(kind << 5 | source << 4 | mask);
        if kind >= 6 {
            let from = near[usize::from(kind) - 6].ends;
            block.ends.into_iter().zip(from).for_each(|(color, from)| step(color, from, streams));
        }
        streams.0[6].extend(rows.iter().map(|row| (correction >> (8 * row)) as u8));
        rows.len()
    }
}

fn before(window: &Range<u32>, position: u32) -> bool {
    position > 0 && window.contains(&(position - 1))
}

/// T.5: the step that leads there, or the endpoint itself.
fn step(color: u16, from: u16, streams: &mut Streams) {
    let leads = |&b: &i32| {
        let by = (b / 45 - 2) * 2048 + (b / 5 % 9 - 4) * 32 + b % 5 - 2;
        (i32::from(from) + by) as u16 == color
    };
    match (0..225).find(leads) {
        Some(b) => streams.0[4].push(b as u8),
        None => {
            streams.0[4].push(255);
            streams.0[5].extend(color.to_le_bytes());
        }
    }
}

/// T.7.
fn predict(ends: [u16; 2], source: Block) -> u32 {
    if ends == source.ends {
        return source.indices;
    }
    let rho = |c: u16| [c >> 11 << 1, c >> 5 & 63, (c & 31) << 1].map(i32::from);
    let minus = |a: [i32; 3], b: [i32; 3]| [0, 1, 2].map(|i| a[i] - b[i]);
    let dot = |a: [i32; 3], b: [i32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let ([c0, c1], [n0, n1]) = (ends.map(rho), source.ends.map(rho));
    let a = minus(c0, c1);
    let (l, n, f) = (dot(a, a), dot(a, minus(n0, c1)), dot(a, minus(n1, c1)));
    let index = |q: i32| match q {
        q if q <= l => 1,
        q if q <= 3 * l => 3,
        q if q <= 5 * l => 2,
        _ => 0u32,
    };
    let map = [6 * n, 6 * f, 4 * n + 2 * f, 2 * n + 4 * f].map(index);
    (0..16).map(|texel| map[(source.indices >> (2 * texel) & 3) as usize] << (2 * texel)).sum()
}
