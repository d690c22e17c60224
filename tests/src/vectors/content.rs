//! Files that break a rule of clauses 5, 6 or 8.

use super::packed::{cropped, masked, scene, uneven};
use super::{Vector, malformed, unsupported};
use crate::assemble::{Chunk, File};
use crate::layout::{Axis, Field, RED, Slab, metadata, smallest};

pub(crate) fn vectors() -> Vec<Vector> {
    [cells(), records(), axes(), sizes(), windows(), masks(), meta()].concat()
}

/// The smallest file with other bytes in its geometry.
fn geometry(at: usize, bytes: &[u8]) -> Vec<u8> {
    smallest().patch(0, at, bytes).to_bytes()
}

/// The smallest file with another number in its geometry.
fn number(at: usize, number: f32) -> Vec<u8> {
    geometry(at, &number.to_le_bytes())
}

/// The smallest file with a geometry that is shorter or longer.
fn geometry_of_len(len: usize) -> Vec<u8> {
    let mut payload = smallest().chunks.remove(0).payload;
    payload.resize(len, 0);
    let mut file = smallest();
    file.chunks[0] = Chunk::new(b"GEOM", 1, payload);
    file.to_bytes()
}

fn cells() -> Vec<Vector> {
    let nan = f64::NAN.to_le_bytes();
    vec![
        malformed("cell-centre-nan", "geom.cell", "§2.1 §5.1", "the cell's centre is not a number", geometry(8, &nan)),
        malformed("half-extent-0", "geom.cell", "§5.1", "a half extent is 0", number(24, 0.0)),
        malformed("half-extent-negative", "geom.cell", "§5.1", "a half extent is negative", number(32, -0.5)),
        malformed(
            "half-extent-infinite",
            "geom.cell",
            "§2.1 §5.1",
            "a half extent is infinite",
            number(28, f32::INFINITY),
        ),
        malformed("slab-count-0", "geom.slab-count", "§5.2", "no slab", geometry(36, &[0])),
        malformed("slab-count-7", "geom.slab-count", "§5.2", "seven slabs", geometry(36, &[7])),
        malformed(
            "geom-too-short",
            "geom.length",
            "§5.11",
            "the record of a second slab is missing",
            geometry(36, &[2]),
        ),
        malformed("geom-too-long", "geom.length", "§5.11", "a byte after the last record", geometry_of_len(109)),
        malformed("geom-cut-off", "geom.length", "§5.11", "the last record is a byte short", geometry_of_len(107)),
    ]
}

/// Two slabs of these faces.
fn faces(faces: [u8; 2]) -> Vec<u8> {
    let slabs = faces.map(|face| Slab { face, ..Slab::smallest() });
    Field::new(slabs.to_vec()).file(|_, _| (0, RED.to_vec())).to_bytes()
}

/// A slab of RGB16F that claims to be encoded with the sRGB transfer function.
fn srgb_half_floats() -> Vec<u8> {
    let field = Field::new(vec![Slab { encoding: 3, ..Slab::smallest() }]);
    field.file(|_, _| (0, vec![0; 96])).patch(0, 42, &[0]).to_bytes()
}

fn records() -> Vec<Vector> {
    vec![
        malformed("face-6", "geom.face", "§5.3", "a face that there is not", geometry(40, &[6])),
        malformed("faces-in-wrong-order", "geom.face-order", "§5.3", "+Z before −X", faces([4, 1])),
        malformed("face-twice", "geom.face-order", "§5.3", "two slabs of one face", faces([4, 4])),
        unsupported("encoding-0", "geom.encoding", "§5.4", "texel encoding 0", geometry(41, &[0])),
        unsupported("encoding-5", "geom.encoding", "§5.4", "a texel encoding that is not known", geometry(41, &[5])),
        unsupported("transfer-2", "geom.transfer", "§5.5", "a transfer function that is not known", geometry(42, &[2])),
        unsupported("transfer-linear-bc1", "geom.transfer", "§5.5", "BC1 with linear values", geometry(42, &[1])),
        unsupported(
            "transfer-srgb-rgb16f",
            "geom.transfer",
            "§5.5",
            "RGB16F with sRGB-encoded values",
            srgb_half_floats(),
        ),
        malformed("record-reserved", "geom.reserved", "§5.10", "byte 3 of a record is not zero", geometry(43, &[1])),
        malformed("plane-infinite", "geom.plane", "§2.1 §5.6", "an infinite plane", number(44, f32::NEG_INFINITY)),
        malformed("focal-depth-negative-zero", "geom.focal-depth", "§5.8", "a focal depth of −0", number(96, -0.0)),
        malformed("focal-depth-negative", "geom.focal-depth", "§5.8", "a negative focal depth", number(96, -1.0)),
        malformed(
            "focal-depth-nan",
            "geom.focal-depth",
            "§2.1 §5.8",
            "a focal depth that is not a number",
            number(96, f32::NAN),
        ),
        malformed("focal-depth-too-near", "geom.focal-depth", "§5.8", "a disparity that overflows", number(96, 4e-39)),
    ]
}

fn axes() -> Vec<Vector> {
    let axis = |(first, step, count): Axis| {
        let bytes = [first.to_le_bytes(), step.to_le_bytes(), count.to_le_bytes()].concat();
        geometry(72, &bytes)
    };
    vec![
        malformed("first-nan", "geom.axis", "§2.1 §5.7", "a first sample that is not a number", number(48, f32::NAN)),
        malformed("step-0", "geom.axis", "§5.7", "a step of 0", number(52, 0.0)),
        malformed("step-negative", "geom.axis", "§5.7", "a negative step", number(64, -1.0)),
        malformed("step-infinite", "geom.axis", "§2.1 §5.7", "an infinite step", number(88, f32::INFINITY)),
        malformed("count-0", "geom.axis", "§5.7", "no sample", axis((-0.75, 0.5, 0))),
        malformed("count-65537", "geom.axis", "§5.7", "more samples than an axis may have", axis((-0.75, 0.5, 65_537))),
        malformed("last-sample-infinite", "geom.axis", "§5.7", "a last sample that overflows", axis((3e38, 1e38, 2))),
        malformed(
            "last-product-infinite",
            "geom.axis",
            "§5.7",
            "a last sample whose product overflows, its sum would not",
            axis((-3e38, 1e38, 5)),
        ),
    ]
}

/// The geometry of slabs with the tile of the smallest file.
fn with_geometry(slabs: Vec<Slab>) -> Vec<u8> {
    let mut file = smallest();
    file.chunks[0] = Field::new(slabs).heads().remove(0);
    file.to_bytes()
}

fn sizes() -> Vec<Vector> {
    let most = (0.0, 1e-9, 1 << 16);
    let slab = |per_tile| Slab { st: [most; 2], uv: [most; 2], per_tile, ..Slab::smallest() };
    let many = Slab { uv: Slab::smallest().uv, ..slab([1, 1]) };
    // 2^64 texels, four bytes each.
    let large = Slab { encoding: 2, ..slab([65_535, 65_535]) };
    vec![
        malformed("cameras-per-tile-0", "geom.tiling", "§5.9", "no camera in a tile", geometry(100, &[0])),
        malformed(
            "cameras-per-tile-2",
            "geom.tiling",
            "§5.9",
            "more cameras in a tile than there are",
            geometry(104, &[2]),
        ),
        malformed("too-many-tiles", "geom.tiling", "§5.9", "2^32 tiles", with_geometry(vec![many])),
        malformed(
            "picture-too-wide",
            "geom.tiling",
            "§5.9",
            "a tile 2^32 texels wide",
            with_geometry(vec![slab([1 << 16, 1])]),
        ),
        malformed("tiles-too-long", "geom.tiling", "§2.2 §5.9", "2^66 raw bytes", with_geometry(vec![large])),
    ]
}

/// A file with another payload in its second chunk.
fn second(mut file: File, payload: Vec<u8>) -> Vec<u8> {
    let old = &file.chunks[1];
    file.chunks[1] = Chunk::new(&old.tag, old.flags, payload);
    file.to_bytes()
}

/// The cropped file with another record.
fn window(record: usize, window: [u32; 2]) -> Vec<u8> {
    scene(cropped(1), 0).patch(1, 8 * record, window.map(u32::to_le_bytes).as_flattened()).to_bytes()
}

/// Two slabs, of which the first stores nothing.
fn nothing_of(slab: Slab) -> Vec<u8> {
    let other = Slab { face: 5, ..Slab::smallest() };
    Field::new(vec![slab, other]).file(|_, _| (0, RED.to_vec())).to_bytes()
}

fn windows() -> Vec<Vector> {
    let whole = Slab { crop: Some([vec![[0, 3]; 3], vec![[0, 2]; 2]]), ..uneven(1) };
    let empty = Slab { crop: Some([vec![[0, 0]; 3], vec![[0, 2]; 2]]), ..uneven(1) };
    vec![
        malformed(
            "crop-too-short",
            "crop.length",
            "§6.1",
            "a record is missing",
            second(scene(cropped(1), 0), vec![0; 32]),
        ),
        malformed(
            "crop-too-long",
            "crop.length",
            "§6.1",
            "a record too many",
            second(scene(cropped(1), 0), vec![0; 48]),
        ),
        malformed("window-beyond-image", "crop.window", "§6.1", "a window ends beyond the image", window(0, [2, 2])),
        malformed(
            "window-overflow",
            "crop.window",
            "§2.2 §6.1",
            "first and number together exceed 32 bits",
            window(3, [u32::MAX, 1]),
        ),
        malformed("window-empty-first", "crop.window", "§6.1", "an empty window that begins at 1", window(1, [1, 0])),
        malformed(
            "crop-leaves-nothing-out",
            "crop.nothing",
            "§6.1",
            "all windows are whole",
            scene(whole, 0).to_bytes(),
        ),
        malformed(
            "crop-leaves-no-camera",
            "slab.no-camera",
            "§6.3",
            "all windows of a slab are empty",
            nothing_of(empty),
        ),
    ]
}

fn masks() -> Vec<Vector> {
    let mask = |slab: Slab, stored: [u8; 6]| Slab { mask: Some(stored.map(|bit| bit == 1).to_vec()), ..slab };
    // The second column of the cropped slab has no windows.
    let same = mask(cropped(1), [1, 0, 1, 1, 0, 1]);
    let stray = mask(cropped(1), [0, 1, 1, 1, 0, 1]);
    let all = mask(uneven(1), [1; 6]);
    let beyond = scene(masked(1), 0).patch(1, 0, &[0x80 | 0b01_1101]).to_bytes();
    vec![
        malformed("mask-too-short", "mask.length", "§6.2", "9 bits are needed, 8 are there", nine_cameras(1)),
        malformed("mask-too-long", "mask.length", "§6.2", "a byte too many", nine_cameras(3)),
        malformed("mask-beyond-last", "mask.bits", "§6.2", "a bit beyond the last camera", beyond),
        malformed(
            "mask-of-empty-window",
            "mask.bits",
            "§6.2",
            "a bit of a camera with an empty window",
            scene(stray, 0).to_bytes(),
        ),
        malformed("mask-leaves-nothing-out", "mask.nothing", "§6.2", "all bits are 1", scene(all, 0).to_bytes()),
        malformed(
            "mask-leaves-windows-out",
            "mask.nothing",
            "§6.2",
            "bits are 0 for empty windows only",
            scene(same, 0).to_bytes(),
        ),
        malformed(
            "mask-leaves-no-camera",
            "slab.no-camera",
            "§6.3",
            "all bits are 0",
            nothing_of(mask(uneven(1), [0; 6])),
        ),
    ]
}

/// 3 × 3 cameras, all but the last stored, with a mask of another length.
fn nine_cameras(len: usize) -> Vec<u8> {
    let slab = Slab {
        st: [(0.0, 1.0, 3); 2],
        per_tile: [3, 3],
        mask: Some((0..9).map(|i| i < 8).collect()),
        ..Slab::smallest()
    };
    second(scene(slab, 0), [&[0xFF][..], &vec![0; len - 1]].concat())
}

fn meta() -> Vec<Vector> {
    let payload = |payload: Vec<u8>| smallest().with(1, Chunk::new(b"META", 2, payload)).to_bytes();
    let pairs = |pairs: &[(&[u8], &[u8])]| payload(metadata(pairs));
    let (key, value) = (|key: &[u8]| pairs(&[(key, b"")]), |value: &[u8]| pairs(&[(b"a", value)]));
    let more = [metadata(&[(b"a", b"")]), vec![0]].concat();
    let fewer = [&2u32.to_le_bytes()[..], &metadata(&[(b"a", b"")])[4..]].concat();
    let cut = metadata(&[(b"a", b"bc")]);
    vec![
        malformed("meta-count-0", "meta.count", "§8.1", "metadata without entries", pairs(&[])),
        malformed("meta-entry-missing", "meta.order", "§8.2", "fewer entries than the count says", payload(fewer)),
        malformed(
            "meta-cut-off",
            "meta.order",
            "§8.2",
            "the last value is a byte short",
            payload(cut[..cut.len() - 1].to_vec()),
        ),
        malformed("meta-too-long", "meta.order", "§8.2", "a byte after the last entry", payload(more)),
        malformed(
            "meta-keys-in-wrong-order",
            "meta.order",
            "§8.2",
            "keys in descending order",
            pairs(&[(b"b", b""), (b"a", b"")]),
        ),
        malformed("meta-key-twice", "meta.order", "§8.2", "a key twice", pairs(&[(b"a", b""), (b"a", b"")])),
        malformed("meta-key-empty", "meta.key", "§8.3", "an empty key", key(b"")),
        malformed("meta-key-long", "meta.key", "§8.3", "a key of 65 characters", key(&[b'k'; 65])),
        malformed("meta-key-upper-case", "meta.key", "§8.3", "a key in upper case", key(b"Scene")),
        malformed("meta-value-long", "meta.value", "§8.4", "a value of 65,537 bytes", value(&[b'v'; 65_537])),
        malformed("meta-value-latin-1", "meta.value", "§8.4", "a value that is not UTF-8", value(b"\xE9")),
        malformed("meta-value-surrogate", "meta.value", "§8.4", "a surrogate in UTF-8", value(b"\xED\xA0\x80")),
        malformed("meta-value-escape", "meta.value", "§8.4", "a value with ESC", value(b"\x1B[2J")),
        malformed("meta-value-carriage-return", "meta.value", "§8.4", "a value with CR", value(b"a\r\n")),
        malformed("meta-value-delete", "meta.value", "§8.4", "a value with DEL", value(b"\x7F")),
    ]
}
