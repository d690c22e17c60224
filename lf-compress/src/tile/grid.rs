//! The order in which blocks are coded, and the neighbours of each.
//!
//! Positions within the cameras' images go row by row; at each position the blocks of all cameras whose windows hold it
//! follow each other, row of cameras by row of cameras. One row of this grid is kept, in which each block replaces that
//! of the camera above, so that all neighbours are at hand in registers or in the first-level cache. Which cameras there
//! are is listed beforehand for each column and each row of positions: within the grid nothing asks for windows.

use std::ops::Range;

use super::TileShape;
use super::block::{Block, RawBlock};

/// Number of mode streams. A block's is the number of rows that were corrected in the camera above, but at most 3.
pub(super) const CONTEXTS: usize = 4;
/// The contexts before the first position.
const FIRST_CONTEXT: u8 = CONTEXTS as u8 - 1;

/// What is known when a block is coded.
pub(super) struct Around<'a> {
    /// The blocks of the cameras above left, above and above right.
    pub(super) above: [Block; 3],
    /// The block of the camera to the left.
    pub(super) left: Block,
    /// The mode stream.
    pub(super) context: usize,
    /// Raster place of the block.
    pub(super) place: usize,
    /// How far back the blocks before and above in the same image are; beyond the tile if they are not there.
    pub(super) back: &'a [usize; 2],
    /// Raster places of the blocks of the cameras to the right and below at this position. Right of the last camera it is
    /// some other block that is still to come, or beyond the tile; below the last one it is beyond the tile.
    pub(super) next: [usize; 2],
}

/// Visits every block in coding order: `visit` takes what is around it, may look at and write the tile, and returns
/// the block and the number of its rows that are corrected.
#[inline(always)]
pub(super) fn walk(
    shape: &TileShape,
    tile: &mut [RawBlock],
    mut visit: impl FnMut(&Around<'_>, &mut [RawBlock]) -> (Block, u8),
) {
    let [columns, rows] = shape.windows().each_ref().map(|windows| lines(windows));
    let [columns, rows] = [positions(&columns), positions(&rows)];
    let runs: Vec<&[&[Line]]> = columns.chunk_by(|a, b| same_cameras(a, b)).collect();
    let mut grid = Grid::new(shape, &columns);
    for rows in &rows {
        for run in &runs {
            grid.take_contexts(run[0]);
            for columns in *run {
                grid.enter(&rows[0], columns, tile);
                for (row, below) in rows.iter().zip(1..).map(|(row, next)| (row, rows.get(next))) {
                    grid.visit_row(row, below, tile, &mut visit);
                }
            }
            grid.keep_contexts(run[0]);
        }
    }
}

/// A column of cameras at a column of positions that its window holds; or the same of rows.
#[derive(Clone, Copy)]
struct Line {
    /// The position along the axis, blocks from the first of the whole image.
    position: u32,
    /// Number of the column or row in the tile.
    camera: u32,
    /// Whether the window begins here.
    first: bool,
    /// Where this is in the tile's picture, blocks.
    place: u32,
}

/// All lines of an axis, by position, then by camera.
fn lines(windows: &[Range<u32>]) -> Vec<Line> {
    let of_camera = |(camera, window): (u32, &Range<u32>)| {
        let start = window.start;
        window.clone().map(move |position| (position, camera, position == start))
    };
    let blocks = (0..).zip(windows).flat_map(of_camera);
    let line = |(place, (position, camera, first))| Line { position, camera, first, place };
    let mut lines: Vec<Line> = (0..).zip(blocks).map(line).collect();
    lines.sort_by_key(|line| line.position);
    lines
}

/// The lines at each position that has any.
fn positions(lines: &[Line]) -> Vec<&[Line]> {
    lines.chunk_by(|a, b| a.position == b.position).collect()
}

/// Whether two positions have the same cameras.
fn same_cameras(a: &[Line], b: &[Line]) -> bool {
    a.iter().map(|line| line.camera).eq(b.iter().map(|line| line.camera))
}

/// The row of cameras that is being coded at a position.
struct Grid {
    /// One for each column at this position, and one more for the border on the right.
    cells: Vec<Cell>,
    /// How many columns there are.
    across: usize,
    /// The blocks of the border at the left and right ends of the row above.
    border: [Block; 2],
    /// The contexts of all columns of the tile, while they are not in the cells.
    contexts: Vec<u8>,
    /// Blocks in one row of the tile's picture.
    pitch: usize,
    /// [`Around::back`] by whether the camera's window begins at this row of positions, and at this column.
    back: [[[usize; 2]; 2]; 2],
}

/// A column of cameras at a position.
#[derive(Clone, Copy, Default)]
struct Cell {
    /// The last block that was coded in this column: that of the camera above.
    block: Block,
    /// The context of the next block.
    context: u8,
    /// See [`Line`].
    first: bool,
    place: u32,
}

impl Grid {
    fn new(shape: &TileShape, columns: &[&[Line]]) -> Self {
        let most = columns.iter().map(|lines| lines.len()).max().unwrap_or(0);
        let pitch = shape.picture_blocks()[0] as usize;
        Self {
            cells: vec![Cell::default(); most + 1],
            across: 0,
            border: [Block::default(); 2],
            contexts: vec![FIRST_CONTEXT; shape.cameras()[0] as usize],
            pitch,
            back: [[[1, pitch], [pitch; 2]], [[1; 2], [usize::MAX; 2]]],
        }
    }

    /// Fetches the contexts of these columns.
    fn take_contexts(&mut self, columns: &[Line]) {
        for (cell, line) in self.cells.iter_mut().zip(columns) {
            cell.context = self.contexts[line.camera as usize];
        }
    }

    /// Keeps the contexts of these columns for positions to come.
    fn keep_contexts(&mut self, columns: &[Line]) {
        for (cell, line) in self.cells.iter().zip(columns) {
            self.contexts[line.camera as usize] = cell.context;
        }
    }

    /// Moves on to a position, whose first row of cameras is `row`: the border above takes blocks of earlier positions.
    fn enter(&mut self, row: &Line, columns: &[Line], tile: &[RawBlock]) {
        let (here, back) = (row.place as usize * self.pitch, &self.back[usize::from(row.first)]);
        for (cell, &Line { first, place, .. }) in self.cells.iter_mut().zip(columns) {
            let block = earlier(tile, here + place as usize, back[usize::from(first)][1]);
            *cell = Cell { block, context: cell.context, first, place };
        }
        self.across = columns.len();
        self.cells[self.across].place = columns[0].place + self.pitch as u32;
        self.border = self.ends(row, tile);
    }

    /// The border left and right of a row of cameras.
    #[inline(always)]
    fn ends(&self, row: &Line, tile: &[RawBlock]) -> [Block; 2] {
        let (here, back) = (row.place as usize * self.pitch, &self.back[usize::from(row.first)]);
        [0, self.across - 1].map(|column| {
            let Cell { first, place, .. } = self.cells[column];
            earlier(tile, here + place as usize, back[usize::from(first)][0])
        })
    }

    /// Visits the blocks of a row of cameras.
    #[inline(always)]
    fn visit_row(
        &mut self,
        row: &Line,
        below: Option<&Line>,
        tile: &mut [RawBlock],
        visit: &mut impl FnMut(&Around<'_>, &mut [RawBlock]) -> (Block, u8),
    ) {
        let here = row.place as usize * self.pitch;
        let below = below.map_or(usize::MAX, |row| row.place as usize * self.pitch);
        let ends = self.ends(row, tile);
        self.cells[self.across].block = self.border[1];
        let (mut up_left, mut left, mut up) = (self.border[0], ends[0], self.cells[0].block);
        self.border = ends;
        let back = &self.back[usize::from(row.first)];
        let mut cells = &mut self.cells[..=self.across];
        while let [cell, rest @ ..] = cells
            && let Some(right) = rest.first()
        {
            let (up_right, column) = (right.block, cell.place as usize);
            let around = Around {
                above: [up_left, up, up_right],
                left,
                context: usize::from(cell.context),
                place: here + column,
                back: &back[usize::from(cell.first)],
                next: [here + right.place as usize, below.saturating_add(column)],
            };
            let (block, rows) = visit(&around, tile);
            (cell.block, cell.context) = (block, rows.min(FIRST_CONTEXT));
            (up_left, up, left) = (up, up_right, block);
            cells = rest;
        }
    }
}

/// The block `back` places before `place`, all zero where there is none.
#[inline(always)]
pub(super) fn earlier(tile: &[RawBlock], place: usize, back: usize) -> Block {
    tile.get(place.wrapping_sub(back)).filter(|_| back <= place).map_or(Block::default(), |&raw| Block::from_raw(raw))
}
