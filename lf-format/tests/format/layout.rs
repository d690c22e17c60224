//! What clauses 5 to 8 of the specification make of a light field: the chunks before the tiles, and the sizes of the tiles.

use std::ops::Range;

use crate::assemble::{Chunk, File};

/// The red block of the smallest file.
pub(crate) const RED: [u8; 8] = [0x00, 0xF8, 0x1F, 0x00, 0, 0, 0, 0];

/// First, step, count (§5.7).
pub(crate) type Axis = (f32, f32, u32);

/// First block, number of blocks (§6.1).
pub(crate) type Window = [u32; 2];

/// A slab, fields as in its record (§5), and what is left out of it (§6).
#[derive(Debug, Clone)]
pub(crate) struct Slab {
    pub(crate) face: u8,
    pub(crate) encoding: u8,
    pub(crate) plane: f32,
    pub(crate) st: [Axis; 2],
    pub(crate) uv: [Axis; 2],
    /// 0 for none.
    pub(crate) focal_depth: f32,
    pub(crate) per_tile: [u32; 2],
    /// Windows by s and by t.
    pub(crate) crop: Option<[Vec<Window>; 2]>,
    /// Whether camera t·N_s + s is stored.
    pub(crate) mask: Option<Vec<bool>>,
}

/// What a file holds beside its tiles.
#[derive(Debug, Clone)]
pub(crate) struct Field {
    pub(crate) center: [f64; 3],
    pub(crate) half_extent: [f32; 3],
    pub(crate) slabs: Vec<Slab>,
    pub(crate) metadata: Vec<(String, String)>,
}

impl Slab {
    /// One camera of 4×4 texels of BC1: the slab of §11.
    pub(crate) fn smallest() -> Self {
        Self {
            face: 4,
            encoding: 1,
            plane: 0.5,
            st: [(0.0, 1.0, 1); 2],
            uv: [(-0.75, 0.5, 4); 2],
            focal_depth: 0.0,
            per_tile: [1; 2],
            crop: None,
            mask: None,
        }
    }

    /// The 68 bytes of §5.
    fn record(&self) -> Vec<u8> {
        let transfer = u8::from(self.encoding == 3);
        let mut out = vec![self.face, self.encoding, transfer, 0];
        out.extend(self.plane.to_le_bytes());
        for (first, step, count) in self.st.into_iter().chain(self.uv) {
            out.extend(first.to_le_bytes());
            out.extend(step.to_le_bytes());
            out.extend(count.to_le_bytes());
        }
        out.extend(self.focal_depth.to_le_bytes());
        out.extend(self.per_tile.into_iter().flat_map(u32::to_le_bytes));
        out
    }

    /// N_s and N_t.
    pub(crate) fn cameras(&self) -> [u32; 2] {
        self.st.map(|(_, _, count)| count)
    }

    /// N_u and N_v.
    pub(crate) fn resolution(&self) -> [u32; 2] {
        self.uv.map(|(_, _, count)| count)
    }

    /// The window of column `i` of cameras (axis 0) or of row `i` (axis 1).
    pub(crate) fn window(&self, axis: usize, i: u32) -> Window {
        let whole = [0, self.resolution()[axis].div_ceil(4)];
        self.crop.as_ref().map_or(whole, |windows| windows[axis][i as usize])
    }

    /// §6.3.
    pub(crate) fn stores(&self, [s, t]: [u32; 2]) -> bool {
        let bit = |mask: &Vec<bool>| mask[(t * self.cameras()[0] + s) as usize];
        self.window(0, s)[1] > 0 && self.window(1, t)[1] > 0 && self.mask.as_ref().is_none_or(bit)
    }

    /// The cameras of a tile along s and t (§7.1).
    pub(crate) fn cameras_of(&self, tile: u32) -> [Range<u32>; 2] {
        let across = self.cameras()[0].div_ceil(self.per_tile[0]);
        let place = [tile % across, tile / across];
        [0, 1].map(|i| {
            let per_tile = self.per_tile[i];
            place[i] * per_tile..((place[i] + 1) * per_tile).min(self.cameras()[i])
        })
    }

    /// The tiles that are in the file (§7.1).
    pub(crate) fn tiles(&self) -> Vec<u32> {
        let [across, down] = [0, 1].map(|i| self.cameras()[i].div_ceil(self.per_tile[i]));
        let stored = |&tile: &u32| {
            let [s, t] = self.cameras_of(tile);
            t.into_iter().any(|t| s.clone().any(|s| self.stores([s, t])))
        };
        (0..across * down).filter(stored).collect()
    }

    /// Columns and rows of blocks of a tile's picture (§7.2).
    pub(crate) fn blocks(&self, tile: u32) -> [u32; 2] {
        let cameras = self.cameras_of(tile);
        [0, 1].map(|axis| cameras[axis].clone().map(|i| self.window(axis, i)[1]).sum())
    }

    /// §7.2.
    pub(crate) fn raw_len(&self, tile: u32) -> usize {
        let [width, height] = self.blocks(tile);
        let block_len = match self.encoding {
            1 => 8,
            2 => 64,
            _ => 96,
        };
        (width * height) as usize * block_len
    }
}

impl Field {
    /// A cell of edge 1 around the origin.
    pub(crate) fn new(slabs: Vec<Slab>) -> Self {
        Self { center: [0.0; 3], half_extent: [0.5; 3], slabs, metadata: Vec::new() }
    }

    /// All chunks, the tiles packed as `tile` says: by slab and number, packing and stored bytes.
    pub(crate) fn file(&self, mut tile: impl FnMut(usize, u32) -> (u8, Vec<u8>)) -> File {
        let mut chunks = self.heads();
        for (i, slab) in self.slabs.iter().enumerate() {
            for number in slab.tiles() {
                let (packing, payload) = tile(i, number);
                let raw_len = slab.raw_len(number) as u64;
                let chunk = Chunk::new(b"TILE", 1, payload);
                chunks.push(Chunk { packing, slab: i as u32, tile: number, raw_len, ..chunk });
            }
        }
        File::new(chunks)
    }

    /// The chunks before the tiles (§4.10).
    pub(crate) fn heads(&self) -> Vec<Chunk> {
        let mut chunks = vec![Chunk::new(b"GEOM", 1, self.geometry())];
        if !self.metadata.is_empty() {
            let pairs = self.metadata.iter().map(|(key, value)| (key.as_bytes(), value.as_bytes()));
            chunks.push(Chunk::new(b"META", 2, metadata(&pairs.collect::<Vec<_>>())));
        }
        let slabs = || (0u32..).zip(&self.slabs);
        let windows = slabs().filter_map(|(i, slab)| Some((i, crop(slab.crop.as_ref()?))));
        chunks.extend(windows.map(|(slab, payload)| Chunk { slab, ..Chunk::new(b"CROP", 1, payload) }));
        let masks = slabs().filter_map(|(i, slab)| Some((i, mask(slab.mask.as_ref()?))));
        chunks.extend(masks.map(|(slab, payload)| Chunk { slab, ..Chunk::new(b"MASK", 1, payload) }));
        chunks
    }

    /// The payload of `GEOM` (§5).
    fn geometry(&self) -> Vec<u8> {
        let mut out = Vec::new();
        out.extend(self.center.into_iter().flat_map(f64::to_le_bytes));
        out.extend(self.half_extent.into_iter().flat_map(f32::to_le_bytes));
        out.extend((self.slabs.len() as u32).to_le_bytes());
        out.extend(self.slabs.iter().flat_map(Slab::record));
        out
    }
}

/// The payload of `CROP` (§6.1).
pub(crate) fn crop(windows: &[Vec<Window>; 2]) -> Vec<u8> {
    windows.iter().flatten().flatten().flat_map(|number| number.to_le_bytes()).collect()
}

/// The payload of `MASK` (§6.2).
pub(crate) fn mask(stored: &[bool]) -> Vec<u8> {
    let byte = |bits: &[bool]| bits.iter().rev().fold(0, |byte, &bit| byte << 1 | u8::from(bit));
    stored.chunks(8).map(byte).collect()
}

/// The payload of `META` (§8): keys and values, whatever they are.
pub(crate) fn metadata(pairs: &[(&[u8], &[u8])]) -> Vec<u8> {
    let mut out = (pairs.len() as u32).to_le_bytes().to_vec();
    for (key, value) in pairs {
        out.extend((key.len() as u16).to_le_bytes());
        out.extend((value.len() as u32).to_le_bytes());
        out.extend(*key);
        out.extend(*value);
    }
    out
}

/// The smallest file (§11).
pub(crate) fn smallest() -> File {
    Field::new(vec![Slab::smallest()]).file(|_, _| (0, RED.to_vec()))
}
