//! Texels for the vectors: what each tile holds before it is packed, and the digest of a slab, from clauses 6 and 7 of the
//! specification alone.

use std::ops::Range;

use xxhash_rust::xxh64::{Xxh64, xxh64};

use crate::layout::{RED, Slab};

/// What a slab shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Paint {
    /// Something that differs from camera to camera and from texel to texel.
    Scene,
    /// Black.
    Black,
    /// The red block of the smallest file.
    Red,
}

/// A number that looks random, the same on every machine.
pub(crate) fn hash(words: &[u32]) -> u32 {
    let bytes: Vec<u8> = words.iter().flat_map(|word| word.to_le_bytes()).collect();
    xxh64(&bytes, 1) as u32
}

/// The raw tile (§7.2).
pub(crate) fn raw_tile(slab: &Slab, tile: u32, paint: Paint) -> Vec<u8> {
    // Blocks are what a row is made of in BC1, texels else.
    let unit = if slab.encoding == 1 { 1 } else { 4 };
    let [columns, rows] = [0, 1].map(|axis| {
        let units = |i: u32| {
            let [first, number] = slab.window(axis, i);
            (unit * first..unit * (first + number)).map(move |x| (i, x))
        };
        slab.cameras_of(tile)[axis].clone().flat_map(units).collect::<Vec<_>>()
    });
    let place = |&(t, y): &(u32, u32)| columns.iter().map(move |&(s, x)| ([s, t], [x, y]));
    rows.iter().flat_map(place).flat_map(|(camera, at)| unit_bytes(slab, camera, at, paint)).collect()
}

/// A tile's windows of columns and rows, in blocks (T.2).
pub(crate) fn windows(slab: &Slab, tile: u32) -> [Vec<Range<u32>>; 2] {
    let cameras = slab.cameras_of(tile);
    [0, 1].map(|axis| {
        let window = |i| slab.window(axis, i);
        cameras[axis].clone().map(window).map(|[first, number]| first..first + number).collect()
    })
}

/// The bytes of a block or texel of a picture; zero where the camera is not stored, the nearest texel in the padding.
fn unit_bytes(slab: &Slab, camera: [u32; 2], [x, y]: [u32; 2], paint: Paint) -> Vec<u8> {
    let [width, height] = slab.resolution();
    let nearest = [x.min(width - 1), y.min(height - 1)];
    match (slab.encoding, slab.stores(camera)) {
        (1, true) => block(slab, camera, [x, y], paint).to_vec(),
        (2, true) => [&rgb8(camera, nearest, paint)[..], &[255]].concat(),
        (3, true) => rgb16f(camera, nearest, paint).into_iter().flat_map(u16::to_le_bytes).collect(),
        (encoding, _) => vec![0; [8, 4, 6][usize::from(encoding) - 1]],
    }
}

/// An opaque BC1 block (§7.3): neighbouring cameras show nearly the same, and some blocks have one colour.
fn block(slab: &Slab, [s, t]: [u32; 2], [x, y]: [u32; 2], paint: Paint) -> [u8; 8] {
    match paint {
        Paint::Black => return [0; 8],
        Paint::Red => return RED,
        Paint::Scene => {}
    }
    let seed = hash(&[x / 2, y]);
    let drift = if hash(&[s, t, x, y]).is_multiple_of(3) { (s + 32 * t) as u16 } else { 0 };
    let base = (seed as u16 & 0x7BCF).wrapping_add(drift);
    let ends = match seed % 5 {
        0 => [base, base],
        1 => [base | 0x8000, (seed >> 16) as u16 & 0x7FFF],
        _ => [base | 0x8410, base & 0x7BEF],
    };
    let [width, height] = slab.resolution();
    let index = |i: u32| {
        let (u, v) = ((4 * x + i % 4).min(width - 1), (4 * y + i / 4).min(height - 1));
        let index = hash(&[(u + s) / 2, (v + t) / 2]) % 4;
        if ends[0] == ends[1] { index % 3 } else { index }
    };
    let indices = (0..16).fold(0, |indices, i| indices | index(i) << (2 * i));
    let [[a, b], [c, d]] = ends.map(u16::to_le_bytes);
    let [e, f, g, h] = indices.to_le_bytes();
    [a, b, c, d, e, f, g, h]
}

/// A texel of RGBA8, without alpha.
fn rgb8([s, t]: [u32; 2], [u, v]: [u32; 2], paint: Paint) -> [u8; 3] {
    match paint {
        Paint::Black => [0; 3],
        Paint::Red => [255, 0, 0],
        Paint::Scene => [(40 * s + 9 * u) as u8, (30 * t + 7 * v) as u8, hash(&[s + u, t + v]) as u8],
    }
}

/// Bits of a texel of RGB16F: zero, the smallest and the largest value among many.
fn rgb16f([s, t]: [u32; 2], [u, v]: [u32; 2], paint: Paint) -> [u16; 3] {
    const ENDS: [u16; 4] = [0, 1, 0x3C00, 0x7BFF];
    match paint {
        Paint::Black => [0; 3],
        Paint::Red => [0x3C00, 0, 0],
        Paint::Scene => {
            [0x3000 + (64 * u + s) as u16, 0x3800 + (64 * v + t) as u16, ENDS[hash(&[s, t, u, v]) as usize % 4]]
        }
    }
}

/// The digest of a slab: XXH64 of all its texels by t, s, v, u, zero where none are stored.
pub(crate) fn digest(slab: &Slab, paint: Paint) -> String {
    let ([cameras_s, cameras_t], [width, height]) = (slab.cameras(), slab.resolution());
    let mut checksum = Xxh64::new(0);
    for camera in (0..cameras_t).flat_map(|t| (0..cameras_s).map(move |s| [s, t])) {
        let texels = (0..height).flat_map(|v| (0..width).map(move |u| [u, v]));
        texels.for_each(|at| checksum.update(&texel(slab, camera, at, paint)));
    }
    format!("{:016x}", checksum.digest())
}

/// Red, green and blue of a texel as a reader has them (§7.6).
fn texel(slab: &Slab, camera: [u32; 2], at: [u32; 2], paint: Paint) -> Vec<u8> {
    let inside = |axis: usize| {
        let [first, number] = slab.window(axis, camera[axis]);
        (4 * first..4 * (first + number)).contains(&at[axis])
    };
    if !(slab.stores(camera) && inside(0) && inside(1)) {
        return vec![0; if slab.encoding == 3 { 6 } else { 3 }];
    }
    match slab.encoding {
        1 => bc1_texel(&block(slab, camera, at.map(|x| x / 4), paint), at.map(|x| x % 4)).to_vec(),
        2 => rgb8(camera, at, paint).to_vec(),
        _ => rgb16f(camera, at, paint).into_iter().flat_map(u16::to_le_bytes).collect(),
    }
}

/// §7.3.
fn bc1_texel(&[a, b, c, d, e, f, g, h]: &[u8; 8], [x, y]: [u32; 2]) -> [u8; 3] {
    let (color0, color1) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
    let index = u32::from_le_bytes([e, f, g, h]) >> (2 * (4 * y + x)) & 3;
    let widened = |color: u16| {
        let (r, g, b) = (u32::from(color >> 11), u32::from(color >> 5 & 63), u32::from(color & 31));
        [r * 8 + r / 4, g * 4 + g / 16, b * 8 + b / 4]
    };
    let (c0, c1) = (widened(color0), widened(color1));
    [0, 1, 2].map(|i| match (index, color0 > color1) {
        (0, _) => c0[i],
        (1, _) => c1[i],
        (2, true) => (2 * c0[i] + c1[i]) / 3,
        (3, true) => (c0[i] + 2 * c1[i]) / 3,
        (2, false) => (c0[i] + c1[i]) / 2,
        _ => 0,
    } as u8)
}
