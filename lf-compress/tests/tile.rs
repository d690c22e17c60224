//! The tile codec and its optimiser: round trips, hostile bytes, bounds, and the sizes they are there for.

use lf_compress::bc1::{Quality, Texel, decode_image, encode_image};
use lf_compress::tile::{LEVEL, RdoOptions, TileError, TileShape, decode, encode, optimise};
use proptest::prelude::*;

fn shape(cameras: [u32; 2], blocks: [u32; 2]) -> TileShape {
    TileShape::new(cameras, blocks).unwrap()
}

/// SplitMix64: enough randomness for tests, the same on every machine.
fn random(seed: u64) -> impl Iterator<Item = u8> {
    (0..).flat_map(move |i: u64| {
        let z = seed.wrapping_add(i.wrapping_mul(0x9e37_79b9_7f4a_7c15));
        let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (z ^ (z >> 31)).to_le_bytes()
    })
}

/// A small scene of stripes and shades that shifts from camera to camera, with some grain; raster order.
fn picture(shape: &TileShape) -> Vec<Texel> {
    let ([across, down], [columns, rows]) = (shape.cameras(), shape.blocks());
    let (width, height) = (4 * columns, 4 * rows);
    let texel = |x: u32, y: u32| {
        let (s, t, u, v) = (x / width, y / height, x % width, y % height);
        let (u, v) = (3 * u + s, 3 * v + t);
        let stripe = if (u / 11 + v / 17) % 2 == 0 { 60 } else { 0 };
        let grain = (u.wrapping_mul(0x9e37_79b1) ^ v.wrapping_mul(0x85eb_ca77)) >> 29;
        [40 + stripe + u % 64, 90 + v % 96, 200 - stripe + grain].map(|v| v.min(255) as u8)
    };
    let all = (0..down * height).flat_map(|y| (0..across * width).map(move |x| (x, y)));
    all.map(|(x, y)| texel(x, y)).map(|[r, g, b]| [r, g, b, 255]).collect()
}

fn blocks_of(shape: &TileShape, texels: &[Texel]) -> Vec<u8> {
    let [width, height] = size(shape);
    encode_image(width, height, texels, Quality::Standard).unwrap()
}

fn size(shape: &TileShape) -> [u32; 2] {
    [0, 1].map(|i| 4 * shape.cameras()[i] * shape.blocks()[i])
}

/// Squared error over R, G and B of each block, in raster order.
fn block_errors(shape: &TileShape, texels: &[Texel], blocks: &[u8]) -> Vec<u64> {
    let [width, height] = size(shape);
    let mut errors = vec![0; blocks.len() / 8];
    for (i, (a, b)) in decode_image(width, height, blocks).unwrap().iter().zip(texels).enumerate() {
        let (x, y) = (i % width as usize, i / width as usize);
        errors[y / 4 * (width as usize / 4) + x / 4] +=
            (0..3).map(|c| u64::from(a[c].abs_diff(b[c])).pow(2)).sum::<u64>();
    }
    errors
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_bytes_of_any_shape_come_back(
        cameras in [1_u32..6, 1..6],
        blocks in [1_u32..5, 1..5],
        seed: u64,
        sameness in 0_usize..4,
        level in prop::sample::select(vec![1, 9, 19]),
    ) {
        let shape = shape(cameras, blocks);
        // From noise to blocks that are mostly the same.
        let noise: Vec<u8> = random(seed).take(shape.raw_len()).collect();
        let raw: Vec<u8> = noise.iter().enumerate().map(|(i, &byte)| {
            if sameness > 0 && !usize::from(noise[i / 8 % 97]).is_multiple_of(sameness + 1) { noise[i % 8] } else { byte }
        }).collect();
        let packed = encode(&shape, &raw, level).unwrap();
        prop_assert_eq!(decode(&shape, &packed).unwrap(), raw);
    }

    #[test]
    fn arbitrary_streams_never_panic(
        cameras in [1_u32..4, 1..4],
        blocks in [1_u32..4, 1..4],
        content: Vec<u8>,
        lengths: [u8; 7],
    ) {
        let shape = shape(cameras, blocks);
        let header = lengths.iter().flat_map(|&n| u32::from(n).to_le_bytes());
        let frame = zstd_frame(&header.chain(content).collect::<Vec<_>>());
        if let Ok(raw) = decode(&shape, &frame) {
            prop_assert_eq!(raw.len(), shape.raw_len());
        }
    }
}

/// An uncompressed zstd frame that states its size (RFC 8878): one raw block.
fn zstd_frame(content: &[u8]) -> Vec<u8> {
    let mut frame = vec![0x28, 0xb5, 0x2f, 0xfd, 0xa0];
    frame.extend((content.len() as u32).to_le_bytes());
    frame.extend(&((content.len() as u32) << 3 | 1).to_le_bytes()[..3]);
    frame.extend(content);
    frame
}

#[test]
fn a_frame_made_by_hand_is_read_as_specified() {
    // Two cameras of one block. The first takes a step from zero endpoints, one of them escaped, with indices corrected in
    // its rows 0 and 2; the second is a copy of the first, made by the mode 0x30.
    let modes = [0xc0 | 0b0101, 0x30];
    let steps = [2 * 45 + 8 * 5 + 2, 255];
    let streams: [&[u8]; 7] = [&[], &[], &[], &modes, &steps, &[0x34, 0x12], &[0x1b, 0xe4]];
    let header = streams.iter().flat_map(|stream| (stream.len() as u32).to_le_bytes());
    let content: Vec<u8> = header.chain(streams.concat()).collect();
    let shape = shape([2, 1], [1, 1]);
    // Prediction: zero endpoints seen from 0x0080 and 0x1234 all lie nearest to one end, whose index fills the block.
    let first = decode(&shape, &zstd_frame(&content)).unwrap();
    assert_eq!(first[..4], [0x80, 0x00, 0x34, 0x12]);
    assert_eq!(first[4] ^ first[5], 0x1b);
    assert_eq!(first[6] ^ first[7], 0xe4);
    assert_eq!(first[5], first[7]);
    assert_eq!(first[..8], first[8..]);
}

#[test]
fn every_truncation_and_bit_flip_is_survived() {
    let shape = shape([3, 2], [3, 2]);
    let raw = blocks_of(&shape, &picture(&shape));
    let packed = encode(&shape, &raw, LEVEL).unwrap();
    for len in 0..packed.len() {
        assert!(decode(&shape, &packed[..len]).is_err(), "{len} bytes");
    }
    for bit in 0..8 * packed.len() {
        let mut damaged = packed.clone();
        damaged[bit / 8] ^= 1 << (bit % 8);
        if let Ok(other) = decode(&shape, &damaged) {
            assert_eq!(other.len(), raw.len());
        }
    }
    assert!(decode(&shape, &[packed.as_slice(), &[0]].concat()).is_err());
    for other in [[[2, 3], [3, 2]], [[3, 2], [3, 3]], [[1, 1], [1, 1]]] {
        let other = TileShape::new(other[0], other[1]).unwrap();
        if let Ok(raw) = decode(&other, &packed) {
            assert_eq!(raw.len(), other.raw_len());
        }
    }
}

#[test]
fn wrong_sizes_are_refused() {
    assert!(matches!(TileShape::new([0, 1], [1, 1]), Err(TileError::Shape { .. })));
    assert!(matches!(TileShape::new([1 << 16, 1 << 16], [1 << 16, 1 << 16]), Err(TileError::Shape { .. })));
    let shape = shape([2, 1], [1, 1]);
    assert!(matches!(encode(&shape, &[0; 15], 19), Err(TileError::BlockBytes { expected: 16, found: 15 })));
    let options = RdoOptions { lambda: 1.0, ..RdoOptions::default() };
    let few = optimise(&shape, &[[0; 4]; 31], &mut [0; 16], &options);
    assert!(matches!(few, Err(TileError::TexelCount { expected: 32, found: 31 })));
}

/// Pins the bytes: they may change only together with the codec or with zstd, never with machine or compiler.
#[test]
fn the_choices_are_pinned() {
    let shape = shape([4, 3], [5, 4]);
    let texels = picture(&shape);
    let mut blocks = pinned_blocks(&shape, &texels);
    optimise(&shape, &texels, &mut blocks, &RdoOptions { lambda: 8.0, max_loss: 4000.0 }).unwrap();
    assert_eq!(fnv(&blocks), 15_690_018_326_791_524_752);
}

/// Blocks that do not depend on the block encoder: endpoints from the corners, indices from the grain.
fn pinned_blocks(shape: &TileShape, texels: &[Texel]) -> Vec<u8> {
    let width = size(shape)[0] as usize;
    let pack = |[r, g, b, _]: Texel| u16::from(r >> 3) << 11 | u16::from(g >> 2) << 5 | u16::from(b >> 3);
    let block = |n: usize| {
        let corner = n / (width / 4) * 4 * width + n % (width / 4) * 4;
        let ends = [pack(texels[corner]), pack(texels[corner + 3 * width + 3])];
        let (high, low) = (ends[0].max(ends[1]), ends[0].min(ends[1]));
        let indices = if high == low { 0 } else { 0x1b1b_e4e4_u32.rotate_left(2 * (n as u32 % 16)) };
        [high.to_le_bytes().to_vec(), low.to_le_bytes().to_vec(), indices.to_le_bytes().to_vec()].concat()
    };
    (0..texels.len() / 16).flat_map(block).collect()
}

fn fnv(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &b| (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
}

#[test]
fn no_block_loses_more_than_allowed() {
    let shape = shape([4, 4], [6, 6]);
    let texels = picture(&shape);
    let blocks = blocks_of(&shape, &texels);
    let before = block_errors(&shape, &texels, &blocks);
    for max_loss in [0, 100, 2000] {
        let mut changed = blocks.clone();
        let options = RdoOptions { lambda: 200.0, max_loss: max_loss as f32 };
        optimise(&shape, &texels, &mut changed, &options).unwrap();
        assert_ne!(changed, blocks);
        for (before, after) in before.iter().zip(block_errors(&shape, &texels, &changed)) {
            assert!(after <= before + max_loss, "{before} became {after}");
        }
    }
}

#[test]
fn bits_fall_and_error_grows_with_lambda() {
    let shape = shape([6, 6], [8, 8]);
    let texels = picture(&shape);
    let blocks = blocks_of(&shape, &texels);
    let mut last = (encode(&shape, &blocks, LEVEL).unwrap().len(), 0);
    for lambda in [0.0, 2.0, 8.0, 32.0, 128.0] {
        let mut changed = blocks.clone();
        optimise(&shape, &texels, &mut changed, &RdoOptions { lambda, ..RdoOptions::default() }).unwrap();
        let bytes = encode(&shape, &changed, LEVEL).unwrap().len();
        let error: u64 = block_errors(&shape, &texels, &changed).iter().sum();
        // The least λ may also find better blocks than the encoder did at this quality.
        let worse = error >= last.1 || lambda == 2.0;
        assert!(bytes <= last.0 && worse, "λ {lambda}: {bytes} bytes, error {error} after {last:?}");
        if lambda == 0.0 {
            assert_eq!(changed, blocks, "λ = 0 changes nothing");
        }
        last = (bytes, error);
    }
}

#[test]
fn blocks_stay_opaque_and_absent_cameras_stay_zero() {
    let shape = shape([3, 3], [4, 4]);
    let (mut texels, width) = (picture(&shape), size(&shape)[0] as usize);
    // The last column of cameras is not there.
    for row in texels.chunks_mut(width) {
        row[width - 16..].fill([0; 4]);
    }
    let mut blocks = blocks_of(&shape, &texels);
    for row in blocks.chunks_mut(8 * width / 4) {
        row[8 * (width / 4 - 4)..].fill(0);
    }
    optimise(&shape, &texels, &mut blocks, &RdoOptions { lambda: 500.0, ..RdoOptions::default() }).unwrap();
    for row in blocks.chunks(8 * width / 4) {
        assert!(row[8 * (width / 4 - 4)..].iter().all(|&byte| byte == 0));
    }
    let [width, height] = size(&shape);
    assert!(decode_image(width, height, &blocks).unwrap().iter().all(|texel| texel[3] == 255));
}

/// Bits per texel and dB on an atlas of 8×8 cameras of 128×128 texels that is not part of this repository.
#[test]
fn real_light_fields_pack_as_promised() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/bc1/lf_c8.png");
    let Ok(image) = image::open(path) else {
        eprintln!("SKIPPED: {path} is not there, the sizes on a real light field are not checked");
        return;
    };
    let texels: Vec<Texel> = image.to_rgba8().pixels().map(|pixel| pixel.0).collect();
    let shape = shape([8, 8], [32, 32]);
    let blocks = encode_image(1024, 1024, &texels, Quality::Best).unwrap();
    let bits = |blocks: &[u8]| encode(&shape, blocks, LEVEL).unwrap().len() as f64 * 8.0 / texels.len() as f64;
    let db = |blocks: &[u8]| {
        let error: u64 = block_errors(&shape, &texels, blocks).iter().sum();
        10.0 * (255.0 * 255.0 * 3.0 * texels.len() as f64 / error as f64).log10()
    };
    assert!(bits(&blocks) <= 1.45, "{:.4} bits a texel at {:.3} dB", bits(&blocks), db(&blocks));
    for (lambda, most_bits, least_db) in
        [(8.0, 1.093, 35.42), (16.0, 0.95, 35.06), (30.0, 0.793, 34.36), (60.0, 0.638, 33.16)]
    {
        let mut changed = blocks.clone();
        optimise(&shape, &texels, &mut changed, &RdoOptions { lambda, ..RdoOptions::default() }).unwrap();
        let (bits, db) = (bits(&changed), db(&changed));
        eprintln!("λ {lambda}: {bits:.4} bits a texel at {db:.3} dB");
        assert!(bits <= most_bits && db >= least_db, "λ {lambda}: {bits:.4} bits a texel at {db:.3} dB");
    }
}
