//! The table by which the shader finds the windows of cropped images.

use lf_compress::volume::{SlabLayout, VolumeLayout};

/// Rows of four numbers: for each slab one for each column of cameras, one for each row of cameras, then its mask.
///
/// A camera's row holds: place in the slice of the whole image's first texel, which may be negative; first and last texel
/// of the window; what the column or row adds to the number of the slice, negative if the window is empty. A row of a mask
/// holds 128 bits, one for each camera, t·columns + s, the lowest first.
pub(crate) struct WindowTable {
    rows: Vec<[i32; 4]>,
    places: Vec<TablePlace>,
}

/// Where the rows of a slab begin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TablePlace {
    pub(crate) columns: u32,
    pub(crate) rows: u32,
    /// [`NO_MASK`] if all cameras with windows are there.
    pub(crate) mask: u32,
}

pub(crate) const NO_MASK: u32 = u32::MAX;

impl WindowTable {
    /// `None` if all images are whole.
    pub(crate) fn new(layout: &VolumeLayout) -> Option<Self> {
        if layout.slabs().iter().all(|slab| slab.tiling().coverage().is_whole()) {
            return None;
        }
        let mut table = Self { rows: Vec::new(), places: Vec::new() };
        for slab in layout.slabs() {
            table.push(slab);
        }
        Some(table)
    }

    pub(crate) fn rows(&self) -> &[[i32; 4]] {
        &self.rows
    }

    /// Where the rows of the slab at a position are.
    pub(crate) fn place(&self, slab: usize) -> TablePlace {
        self.places[slab]
    }

    /// Whether single cameras are left out.
    pub(crate) fn is_masked(&self) -> bool {
        self.places.iter().any(|place| place.mask != NO_MASK)
    }

    fn push(&mut self, slab: &SlabLayout) {
        let next = |rows: &Vec<[i32; 4]>| rows.len() as u32;
        let columns = next(&self.rows);
        self.rows.extend((0..slab.tiling().cameras()[0]).map(|s| camera_row(slab, 0, s)));
        let rows = next(&self.rows);
        self.rows.extend((0..slab.tiling().cameras()[1]).map(|t| camera_row(slab, 1, t)));
        let coverage = slab.tiling().coverage();
        let mask = if coverage.keeps_all_cameras() { NO_MASK } else { next(&self.rows) };
        if mask != NO_MASK {
            let kept: Vec<bool> = coverage.cameras().map(|camera| coverage.window(camera).is_some()).collect();
            let word = |bits: &[bool]| bits.iter().rev().fold(0u32, |word, &bit| word << 1 | u32::from(bit)) as i32;
            let row = |bits: &[bool]| {
                let mut words = bits.chunks(32).map(word);
                std::array::from_fn(|_| words.next().unwrap_or(0))
            };
            self.rows.extend(kept.chunks(128).map(row));
        }
        self.places.push(TablePlace { columns, rows, mask });
    }
}

/// The row of a column (axis 0) or row (axis 1) of cameras.
fn camera_row(slab: &SlabLayout, axis: usize, camera: u32) -> [i32; 4] {
    let tiling = slab.tiling();
    let windows = [tiling.coverage().columns(), tiling.coverage().rows()][axis];
    let window = windows.get(camera).unwrap_or(0..0);
    let place = if axis == 0 { tiling.column_place(camera) } else { tiling.row_place(camera) };
    let rank = slab.rank(axis, camera / tiling.cameras_per_tile()[axis]);
    match rank.filter(|_| !window.is_empty()) {
        // Places and sizes are below 2³¹: the volume's are.
        Some(rank) => {
            let slices = if axis == 0 { rank } else { rank * slab.groups()[0] };
            [place as i32 - window.start as i32, window.start as i32, window.end as i32 - 1, slices as i32]
        }
        None => [0, 0, 0, -1],
    }
}
