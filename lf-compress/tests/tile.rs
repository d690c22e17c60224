//! The tile codec and its optimiser: round trips, hostile bytes, bounds, and the sizes they are there for.

#![expect(clippy::single_range_in_vec_init, reason = "one window is meant, not the numbers in it")]

use std::ops::Range;

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
    let whole = |i: usize| vec![0..shape.blocks()[i]; shape.cameras()[i] as usize];
    windowed_picture(&whole(0), &whole(1))
}

/// The same, of windows of the images.
fn windowed_picture(columns: &[Range<u32>], rows: &[Range<u32>]) -> Vec<Texel> {
    let texel = |[s, u]: [u32; 2], [t, v]: [u32; 2]| {
        let (u, v) = (3 * u + s, 3 * v + t);
        let stripe = if (u / 11 + v / 17) % 2 == 0 { 60 } else { 0 };
        let grain = (u.wrapping_mul(0x9e37_79b1) ^ v.wrapping_mul(0x85eb_ca77)) >> 29;
        [40 + stripe + u % 64, 90 + v % 96, 200 - stripe + grain].map(|v| v.min(255) as u8)
    };
    let along = |windows: &[Range<u32>]| -> Vec<[u32; 2]> {
        let camera = |(s, window): (u32, &Range<u32>)| (4 * window.start..4 * window.end).map(move |u| [s, u]);
        (0..).zip(windows).flat_map(camera).collect()
    };
    let (across, down) = (along(columns), along(rows));
    let all = down.iter().flat_map(|y| across.iter().map(move |x| (*x, *y)));
    all.map(|(x, y)| texel(x, y)).map(|[r, g, b]| [r, g, b, 255]).collect()
}

/// A tile of whole images and a cropped one, with their pictures.
fn whole_and_cropped() -> [(TileShape, Vec<Texel>); 2] {
    let whole = shape([4, 4], [6, 6]);
    let (columns, rows) = ([0..6, 1..5, 3..3, 2..8, 0..1, 9..12], [2..7, 0..4, 1..7, 9..11]);
    let cropped = TileShape::windowed(&columns, &rows).unwrap();
    let texels = picture(&whole);
    [(whole, texels), (cropped, windowed_picture(&columns, &rows))]
}

fn blocks_of(shape: &TileShape, texels: &[Texel]) -> Vec<u8> {
    let [width, height] = size(shape);
    encode_image(width, height, texels, Quality::Standard).unwrap()
}

fn size(shape: &TileShape) -> [u32; 2] {
    shape.picture_blocks().map(|blocks| 4 * blocks)
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

/// Windows of an axis, not all empty: in any order, with and without gaps between them.
fn windows() -> impl Strategy<Value = Vec<Range<u32>>> {
    let window = (0_u32..8, 0_u32..5).prop_map(|(start, length)| start..start + length);
    prop::collection::vec(window, 1..6).prop_filter("empty", |windows| !windows.iter().all(Range::is_empty))
}

/// Blocks that resemble each other: of a few endpoints, some of them close to each other, and of a few indices.
fn alike(shape: &TileShape, seed: u64, variety: usize) -> Vec<u8> {
    let noise: Vec<u8> = random(seed).take(shape.raw_len() + 4096).collect();
    let (noise, choices) = noise.split_at(4096);
    let ends = |k: usize| {
        let near = u16::from(noise[k] % 3) << 11 | u16::from(noise[k + 1] % 3);
        let color = u16::from_le_bytes([noise[k % 2], noise[2 + k % 3]]).wrapping_add(near);
        [color.to_le_bytes(), [noise[k + 2], noise[3]]].concat()
    };
    let block = |chosen: &[u8]| {
        let [ends_of, indices_of] = [chosen[0], chosen[1]].map(|byte| usize::from(byte) % variety);
        let mut block = [ends(4 * ends_of), noise[2048 + 4 * indices_of..][..4].to_vec()].concat();
        if chosen[2] < 50 {
            block[4 + usize::from(chosen[3] % 4)] = chosen[4];
        }
        block
    };
    choices.chunks(8).flat_map(block).collect()
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
    fn windows_come_back_as_specified(
        columns in windows(),
        rows in windows(),
        seed: u64,
        variety in prop::sample::select(vec![1, 2, 5, 30, 200]),
    ) {
        let shape = TileShape::windowed(&columns, &rows).unwrap();
        let raw = alike(&shape, seed, variety);
        let packed = encode(&shape, &raw, 1).unwrap();
        prop_assert_eq!(&decode(&shape, &packed).unwrap(), &raw);
        let content = zstd::bulk::decompress(&packed, 28 + 11 * raw.len()).unwrap();
        let mut streams = reference::Streams::of(&content);
        prop_assert_eq!(reference::decode(&columns, &rows, &mut streams), raw);
        prop_assert_eq!(streams.used, streams.bytes.each_ref().map(Vec::len));
    }

    #[test]
    fn all_that_a_writer_may_say_is_read_as_specified(columns in windows(), rows in windows(), seed: u64) {
        let shape = TileShape::windowed(&columns, &rows).unwrap();
        let blocks = shape.raw_len() / 8;
        let mut noise = random(seed);
        let mut streams = reference::Streams {
            bytes: [1, 1, 1, 1, 2, 4, 4].map(|most| noise.by_ref().take(most * blocks).collect()),
            used: [0; 7],
        };
        streams.bytes[4].iter_mut().filter(|step| **step >= 225).for_each(|step| *step = 255);
        let raw = reference::decode(&columns, &rows, &mut streams);
        for (bytes, used) in streams.bytes.iter_mut().zip(streams.used) {
            bytes.truncate(used);
        }
        prop_assert_eq!(decode(&shape, &zstd_frame(&streams.content())).unwrap(), raw);
    }

    #[test]
    fn blocks_are_placed_by_their_distance(columns in windows(), rows in windows(), seed: u64) {
        let shape = TileShape::windowed(&columns, &rows).unwrap();
        let far = |windows: &[Range<u32>]| -> Vec<Range<u32>> {
            windows.iter().map(|window| window.start + (u32::MAX - 12)..window.end + (u32::MAX - 12)).collect()
        };
        let far = TileShape::windowed(&far(&columns), &far(&rows)).unwrap();
        let raw = alike(&shape, seed, 5);
        prop_assert_eq!(encode(&shape, &raw, 1).unwrap(), encode(&far, &raw, 1).unwrap());
    }

    #[test]
    fn arbitrary_streams_never_panic(
        columns in windows(),
        rows in windows(),
        content: Vec<u8>,
        lengths: [u8; 7],
    ) {
        let shape = TileShape::windowed(&columns, &rows).unwrap();
        let header = lengths.iter().flat_map(|&n| u32::from(n).to_le_bytes());
        let frame = zstd_frame(&header.chain(content).collect::<Vec<_>>());
        if let Ok(raw) = decode(&shape, &frame) {
            prop_assert_eq!(raw.len(), shape.raw_len());
        }
    }
}

/// The decoder once more, written from the text of `spec/codecs.md` alone: slow, with blocks by camera and position.
mod reference {
    use std::collections::HashMap;
    use std::ops::Range;

    /// T.1.
    pub(crate) struct Streams {
        pub(crate) bytes: [Vec<u8>; 7],
        pub(crate) used: [usize; 7],
    }

    impl Streams {
        pub(crate) fn of(content: &[u8]) -> Self {
            let (header, mut rest) = content.split_at(28);
            let bytes = std::array::from_fn(|i| {
                let length = u32::from_le_bytes(header[4 * i..][..4].try_into().unwrap());
                let (stream, after) = rest.split_at(length as usize);
                rest = after;
                stream.to_vec()
            });
            assert!(rest.is_empty());
            Self { bytes, used: [0; 7] }
        }

        pub(crate) fn content(&self) -> Vec<u8> {
            let lengths = self.bytes.iter().flat_map(|stream| (stream.len() as u32).to_le_bytes());
            lengths.chain(self.bytes.concat()).collect()
        }

        fn next(&mut self, stream: usize) -> u8 {
            self.used[stream] += 1;
            self.bytes[stream][self.used[stream] - 1]
        }
    }

    #[derive(Clone, Copy, Default)]
    struct Block {
        ends: [u16; 2],
        indices: u32,
    }

    struct Tile<'a> {
        columns: &'a [Range<u32>],
        rows: &'a [Range<u32>],
        /// By column, row, X and Y.
        blocks: HashMap<(usize, usize, u32, u32), Block>,
    }

    fn before(window: &Range<u32>, position: u32) -> bool {
        position > 0 && window.contains(&(position - 1))
    }

    /// T.2, neighbours.
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

        /// C(s, t) at a position, where `across` and `down` are the columns and rows of its grid.
        fn c(&self, s: isize, t: isize, across: &[usize], down: &[usize], at: [u32; 2]) -> Block {
            let column = across[s.clamp(0, across.len() as isize - 1) as usize];
            let row = down[t.max(0) as usize];
            let inside = (0..across.len() as isize).contains(&s);
            match (inside, t) {
                (true, -1) => self.north(column, row, at),
                (true, _) => self.blocks[&(column, row, at[0], at[1])],
                (false, _) => self.west(column, row, at),
            }
        }
    }

    /// Blocks in raster order of the picture.
    pub(crate) fn decode(columns: &[Range<u32>], rows: &[Range<u32>], streams: &mut Streams) -> Vec<u8> {
        let mut tile = Tile { columns, rows, blocks: HashMap::new() };
        let mut contexts = vec![3; columns.len()];
        let end = |windows: &[Range<u32>]| windows.iter().map(|window| window.end).max().unwrap();
        let holding = |windows: &[Range<u32>], position: u32| -> Vec<usize> {
            (0..windows.len()).filter(|&i| windows[i].contains(&position)).collect()
        };
        for at @ [x, y] in (0..end(rows)).flat_map(|y| (0..end(columns)).map(move |x| [x, y])) {
            let (across, down) = (holding(columns, x), holding(rows, y));
            for (t, &row) in (0..).zip(&down) {
                for (s, &column) in (0..).zip(&across) {
                    let c = |s, t| tile.c(s, t, &across, &down, at);
                    let (up, left) = (c(s, t - 1), c(s - 1, t));
                    let (west, north) = (tile.west(column, row, at), tile.north(column, row, at));
                    let kinds = [up, left, c(s + 1, t - 1), c(s - 1, t - 1), west, north, up, left];
                    let mode = streams.next(contexts[column]);
                    let block = block(mode, kinds.map(|block| block.ends), [up, left], streams);
                    contexts[column] = (mode & 15).count_ones().min(3) as usize;
                    tile.blocks.insert((column, row, x, y), block);
                }
            }
        }
        let mut raw = Vec::new();
        for (t, y) in rows.iter().enumerate().flat_map(|(t, window)| window.clone().map(move |y| (t, y))) {
            for (s, x) in columns.iter().enumerate().flat_map(|(s, window)| window.clone().map(move |x| (s, x))) {
                let Block { ends: [color0, color1], indices } = tile.blocks[&(s, t, x, y)];
                raw.extend([color0.to_le_bytes(), color1.to_le_bytes()].as_flattened());
                raw.extend(indices.to_le_bytes());
            }
        }
        raw
    }

    /// T.4 to T.6.
    fn block(mode: u8, kinds: [[u16; 2]; 8], sources: [Block; 2], streams: &mut Streams) -> Block {
        let (kind, source) = (usize::from(mode >> 5), sources[usize::from(mode >> 4 & 1)]);
        let mut ends = kinds[kind];
        if kind >= 6 {
            let steps = [0, 1].map(|_| i32::from(streams.next(4)));
            for (color, b) in ends.iter_mut().zip(steps) {
                *color = match b {
                    255 => u16::from_le_bytes([0, 1].map(|_| streams.next(5))),
                    _ => (i32::from(*color) + (b / 45 - 2) * 2048 + (b / 5 % 9 - 4) * 32 + b % 5 - 2) as u16,
                };
            }
        }
        let correction = [0, 1, 2, 3].map(|r| if mode >> r & 1 == 1 { streams.next(6) } else { 0 });
        Block { ends, indices: predict(ends, source) ^ u32::from_le_bytes(correction) }
    }

    /// T.7.
    fn predict(ends: [u16; 2], source: Block) -> u32 {
        if ends == source.ends {
            return source.indices;
        }
        let rho = |c: u16| [c >> 11 << 1, c >> 5 & 63, (c & 31) << 1].map(i32::from);
        let minus = |a: [i32; 3], b: [i32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let dot = |a: [i32; 3], b: [i32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let ([c0, c1], [n0, n1]) = (ends.map(rho), source.ends.map(rho));
        let a = minus(c0, c1);
        let (l, n, f) = (dot(a, a), dot(a, minus(n0, c1)), dot(a, minus(n1, c1)));
        let m = [6 * n, 6 * f, 4 * n + 2 * f, 2 * n + 4 * f].map(|q| match q {
            q if q <= l => 1,
            q if q <= 3 * l => 3,
            q if q <= 5 * l => 2,
            _ => 0_u32,
        });
        (0..16).map(|texel| m[(source.indices >> (2 * texel) & 3) as usize] << (2 * texel)).sum()
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
    let (columns, rows) = ([0..3, 1..4, 5..6, 2..2], [1..3, 0..2]);
    let cropped = (TileShape::windowed(&columns, &rows).unwrap(), windowed_picture(&columns, &rows));
    let whole = shape([3, 2], [3, 2]);
    let texels = picture(&whole);
    let tiles = [(whole, texels), cropped];
    for (shape, texels) in &tiles {
        let raw = blocks_of(shape, texels);
        let packed = encode(shape, &raw, LEVEL).unwrap();
        for len in 0..packed.len() {
            assert!(decode(shape, &packed[..len]).is_err(), "{len} bytes");
        }
        for bit in 0..8 * packed.len() {
            let mut damaged = packed.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            if let Ok(other) = decode(shape, &damaged) {
                assert_eq!(other.len(), raw.len());
            }
        }
        assert!(decode(shape, &[packed.as_slice(), &[0]].concat()).is_err());
        let others = [[[2, 3], [3, 2]], [[3, 2], [3, 3]], [[1, 1], [1, 1]]];
        let others = others.map(|[cameras, blocks]| TileShape::new(cameras, blocks).unwrap());
        for other in others.iter().chain(tiles.iter().map(|(shape, _)| shape)) {
            if let Ok(raw) = decode(other, &packed) {
                assert_eq!(raw.len(), other.raw_len());
            }
        }
    }
}

#[test]
fn wrong_sizes_are_refused() {
    assert!(matches!(TileShape::new([0, 1], [1, 1]), Err(TileError::Shape { .. })));
    assert!(matches!(TileShape::new([1 << 16, 1 << 16], [1 << 16, 1 << 16]), Err(TileError::Shape { .. })));
    let refused = |columns: &[Range<u32>], rows: &[Range<u32>]| {
        matches!(TileShape::windowed(columns, rows), Err(TileError::Shape { .. }))
    };
    assert!(refused(&[], &[0..1]) && refused(&[3..3, 0..0], &[0..1]), "no column of blocks");
    #[expect(clippy::reversed_empty_ranges, reason = "a file may say so")]
    let reversed = 5..2;
    assert!(refused(&[0..1], &[reversed]));
    assert!(refused(&[0..1 << 14], &[0..(1 << 14) + 1]), "more than 2^28 blocks");
    assert!(refused(&vec![0..u32::MAX; 1 << 16], &vec![0..u32::MAX; 1 << 16]), "a count that overflows");
    let idle = vec![0..0; (1 << 16) - 1];
    let with = |more: &[Range<u32>]| [idle.as_slice(), more].concat();
    let most = TileShape::windowed(&with(&[0..1]), &with(&[7..9])).unwrap();
    assert_eq!((most.raw_len(), most.cameras(), most.blocks()), (16, [1 << 16; 2], [1, 2]));
    assert_eq!(decode(&most, &encode(&most, &[7; 16], 1).unwrap()).unwrap(), [7; 16]);
    assert!(refused(&with(&[0..1, 0..1]), &[0..1]), "more than 65,536 columns");
    let shape = shape([2, 1], [1, 1]);
    assert!(matches!(encode(&shape, &[0; 15], 19), Err(TileError::BlockBytes { expected: 16, found: 15 })));
    let options = RdoOptions { lambda: 1.0, ..RdoOptions::default() };
    let few = optimise(&shape, &[[0; 4]; 31], &mut [0; 16], &options);
    assert!(matches!(few, Err(TileError::TexelCount { expected: 32, found: 31 })));
}

#[test]
fn a_shape_knows_its_sizes() {
    let whole = shape([3, 2], [5, 4]);
    assert_eq!((whole.cameras(), whole.blocks(), whole.picture_blocks()), ([3, 2], [5, 4], [15, 8]));
    assert_eq!(TileShape::windowed(&[0..5, 0..5, 0..5], &[0..4, 0..4]).unwrap(), whole);
    let cropped = TileShape::windowed(&[3..5, 0..0, 7..8], &[9..12]).unwrap();
    assert_eq!((cropped.cameras(), cropped.blocks(), cropped.picture_blocks()), ([3, 1], [5, 3], [3, 3]));
    assert_eq!(cropped.raw_len(), 72);
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

/// Pins the packed bytes of whole images: they may change only together with the codec or with zstd.
#[test]
fn the_packed_bytes_are_pinned() {
    let shapes = [[[4, 3], [5, 4]], [[1, 1], [3, 3]], [[3, 1], [1, 4]], [[1, 5], [6, 1]], [[6, 6], [8, 8]]];
    let packed = shapes.map(|[cameras, blocks]| {
        let shape = shape(cameras, blocks);
        encode(&shape, &pinned_blocks(&shape, &picture(&shape)), LEVEL).unwrap()
    });
    assert_eq!(
        packed.map(|bytes| fnv(&bytes)),
        [
            14_718_132_068_930_952_451,
            3_719_775_100_205_177_281,
            7_845_160_145_747_963_133,
            3_841_440_814_273_216_706,
            7_256_129_880_852_138_721
        ]
    );
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
    for (shape, texels) in whole_and_cropped() {
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
}

#[test]
fn bits_fall_and_error_grows_with_lambda() {
    let (columns, rows) = ([0..8, 1..8, 2..8, 4..9, 3..8, 5..9], [0..7, 0..8, 2..2, 1..8, 1..9, 2..9]);
    let whole = shape([6, 6], [8, 8]);
    let texels = picture(&whole);
    falls_and_grows(&whole, &texels);
    falls_and_grows(&TileShape::windowed(&columns, &rows).unwrap(), &windowed_picture(&columns, &rows));
}

fn falls_and_grows(shape: &TileShape, texels: &[Texel]) {
    let blocks = blocks_of(shape, texels);
    let mut last = (encode(shape, &blocks, LEVEL).unwrap().len(), 0);
    for lambda in [0.0, 2.0, 8.0, 32.0, 128.0] {
        let mut changed = blocks.clone();
        optimise(shape, texels, &mut changed, &RdoOptions { lambda, ..RdoOptions::default() }).unwrap();
        let bytes = encode(shape, &changed, LEVEL).unwrap().len();
        let error: u64 = block_errors(shape, texels, &changed).iter().sum();
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
    for (shape, mut texels) in whole_and_cropped() {
        let width = size(&shape)[0] as usize;
        // The last columns of blocks are not there: cameras in the whole tile, columns of positions in the other.
        for row in texels.chunks_mut(width) {
            row[width - 24..].fill([0; 4]);
        }
        let mut blocks = blocks_of(&shape, &texels);
        for row in blocks.chunks_mut(8 * width / 4) {
            row[8 * (width / 4 - 6)..].fill(0);
        }
        optimise(&shape, &texels, &mut blocks, &RdoOptions { lambda: 500.0, ..RdoOptions::default() }).unwrap();
        for row in blocks.chunks(8 * width / 4) {
            assert!(row[8 * (width / 4 - 6)..].iter().all(|&byte| byte == 0));
        }
        let [width, height] = size(&shape);
        assert!(decode_image(width, height, &blocks).unwrap().iter().all(|texel| texel[3] == 255));
    }
}

/// An atlas of 8×8 cameras of 128×128 texels that is not part of this repository.
fn real_light_field() -> Option<Vec<Texel>> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data/bc1/lf_c8.png");
    let Ok(image) = image::open(path) else {
        eprintln!("SKIPPED: {path} is not there, the sizes on a real light field are not checked");
        return None;
    };
    Some(image.to_rgba8().pixels().map(|pixel| pixel.0).collect())
}

/// Bits per texel and dB.
#[test]
fn real_light_fields_pack_as_promised() {
    let Some(texels) = real_light_field() else { return };
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

/// Windows that move from camera to camera, as those of cameras beside the cell do, against as many blocks of windows
/// that do not, from the same side of the images.
#[test]
fn moving_windows_take_as_many_bits_a_texel() {
    let Some(texels) = real_light_field() else { return };
    let blocks = encode_image(1024, 1024, &texels, Quality::Best).unwrap();
    let bits = |windows: [Range<u32>; 8]| {
        let kept = |n: usize| windows[n / 32].contains(&(n as u32 % 32));
        let blocks = blocks.as_chunks::<8>().0.iter().enumerate().filter(|(n, _)| kept(n % 256) && kept(n / 256));
        let blocks: Vec<u8> = blocks.flat_map(|(_, block)| *block).collect();
        let shape = TileShape::windowed(&windows, &windows).unwrap();
        assert_eq!(shape.raw_len(), 8 * 216 * 216);
        encode(&shape, &blocks, LEVEL).unwrap().len() as f64 * 8.0 / f64::from(16 * 216 * 216)
    };
    let moving = bits(std::array::from_fn(|s| s as u32 * 155 / 100..32));
    let fixed = bits([const { 5..32 }; 8]);
    eprintln!("{moving:.4} bits a texel where windows move, {fixed:.4} where they do not");
    assert!(moving < 1.02 * fixed, "{moving:.4} bits a texel where windows move, {fixed:.4} where they do not");
}
