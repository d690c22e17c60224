//! BC1 against an independent decoder, brute force and its own promises.

use lf_compress::bc1::{
    BLOCK_BYTES, Bc1Error, Quality, Texel, decode_block, decode_image, decode_texel, encode_block, encode_image,
};
use proptest::prelude::*;

const QUALITIES: [Quality; 2] = [Quality::Fast, Quality::Standard];

/// SplitMix64: enough randomness for tests, the same on every machine.
struct Rng(u64);

impl Rng {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn texel(&mut self) -> Texel {
        let bytes = self.next().to_le_bytes();
        [bytes[0], bytes[1], bytes[2], bytes[3]]
    }

    fn noise(&mut self) -> [Texel; 16] {
        std::array::from_fn(|_| self.texel())
    }
}

/// The independent decoder's view of one block, as RGBA.
fn oracle_block(block: &[u8; 8]) -> [Texel; 16] {
    let mut bgra = [0; 16];
    texture2ddecoder::decode_bc1a_block(block, &mut bgra);
    bgra.map(rgba_from_bgra)
}

fn rgba_from_bgra(word: u32) -> Texel {
    let [b, g, r, a] = word.to_le_bytes();
    [r, g, b, a]
}

fn error(a: &[Texel; 16], b: &[Texel; 16]) -> u64 {
    let square = |x: u8, y: u8| u64::from(x.abs_diff(y)).pow(2);
    a.iter().zip(b).map(|(x, y)| (0..3).map(|c| square(x[c], y[c])).sum::<u64>()).sum()
}

fn endpoints(block: &[u8; 8]) -> (u16, u16) {
    (u16::from_le_bytes([block[0], block[1]]), u16::from_le_bytes([block[2], block[3]]))
}

fn indices(block: &[u8; 8]) -> [u32; 16] {
    let bits = u32::from_le_bytes([block[4], block[5], block[6], block[7]]);
    std::array::from_fn(|i| bits >> (2 * i) & 3)
}

fn lerp(a: u8, b: u8, t: usize, of: usize) -> u8 {
    ((usize::from(a) * (of - t) + usize::from(b) * t) / of) as u8
}

/// Blocks of the kinds that break encoders, one after another.
fn structured(rng: &mut Rng, kind: u64) -> [Texel; 16] {
    let (a, b) = (rng.texel(), rng.texel());
    let bits = rng.next();
    let bit = |i: usize| bits >> i & 1 == 1;
    let mix = |t: usize, of: usize| -> Texel { std::array::from_fn(|c| lerp(a[c], b[c], t, of)) };
    match kind % 10 {
        0 => rng.noise(),
        1 => std::array::from_fn(|i| mix(i % 4, 3)),
        2 => std::array::from_fn(|i| mix(i % 4 + i / 4, 6)),
        3 => std::array::from_fn(|i| if bit(i) { a } else { b }),
        4 => [a; 16],
        5 => std::array::from_fn(|i| a.map(|v| v.saturating_add(u8::from(bit(i))))),
        6 => std::array::from_fn(|i| std::array::from_fn(|c| if bit(3 * i + c) { 255 } else { 0 })),
        7 => std::array::from_fn(|i| if i == (bits % 16) as usize { b } else { a }),
        8 => std::array::from_fn(|i| [mix(i, 15)[0], a[1], b[2], 255]),
        _ => std::array::from_fn(|i| mix(i, 15).map(|v| v.saturating_sub((rng.next() % 12) as u8))),
    }
}

#[test]
fn decoding_matches_the_independent_decoder_on_random_blocks() {
    let mut rng = Rng(1);
    let mut three_colour = 0;
    for i in 0..100_000_u32 {
        let mut block = rng.next().to_le_bytes();
        if i % 16 == 0 {
            block[2] = block[0];
            block[3] = block[1];
        }
        let (color0, color1) = endpoints(&block);
        three_colour += u32::from(color0 <= color1);
        let decoded = decode_block(&block);
        assert_eq!(decoded, oracle_block(&block), "block {block:02x?}");
        for (i, texel) in decoded.iter().enumerate() {
            assert_eq!(decode_texel(&block, i % 4, i / 4), *texel);
        }
    }
    assert!(three_colour > 10_000, "the random blocks must cover the 3-colour mode");
}

#[test]
fn transparent_black_only_at_index_3_of_three_colour_blocks() {
    let block = [0, 0, 0xff, 0xff, 0b11_10_01_00, 0, 0, 0];
    let decoded = decode_block(&block);
    assert_eq!(decoded[..4], [[0, 0, 0, 255], [255; 4], [127, 127, 127, 255], [0; 4]]);
}

/// Opaque, in 4-colour order, and Standard no worse than Fast, as an independent decoder sees it.
fn check_block(texels: &[Texel; 16]) {
    let [fast, standard] = QUALITIES.map(|quality| {
        let block = encode_block(texels, quality);
        let (color0, color1) = endpoints(&block);
        let equal_and_plain = color0 == color1 && indices(&block) == [0; 16];
        assert!(color0 > color1 || equal_and_plain, "{quality:?} gave {block:02x?} for {texels:?}");
        let seen = oracle_block(&block);
        assert!(seen.iter().all(|t| t[3] == 255), "opaque must mean opaque: {block:02x?}");
        assert_eq!(seen, decode_block(&block));
        assert!(indices_are_nearest(&block, texels), "{quality:?} {block:02x?} for {texels:?}");
        error(texels, &seen)
    });
    assert!(standard <= fast, "Standard {standard} > Fast {fast} for {texels:?}");
}

/// No texel would do better with another index: the error the encoder minimised is the one a decoder sees.
fn indices_are_nearest(block: &[u8; 8], texels: &[Texel; 16]) -> bool {
    let with_all = |index: u8| {
        let mut all = *block;
        all[4..].fill(index * 0b0101_0101);
        oracle_block(&all)
    };
    let chosen = oracle_block(block);
    let distance = |x: Texel, p: Texel| error(&[x; 16], &[p; 16]);
    (0..4)
        .map(with_all)
        .filter(|entry| entry[0][3] == 255)
        .all(|entry| (0..16).all(|i| distance(texels[i], chosen[i]) <= distance(texels[i], entry[i])))
}

#[test]
fn structured_blocks_keep_every_promise() {
    let mut rng = Rng(2);
    for kind in 0..40_000 {
        check_block(&structured(&mut rng, kind));
    }
}

proptest! {
    #[test]
    fn arbitrary_blocks_keep_every_promise(texels: [Texel; 16]) {
        check_block(&texels);
    }

    #[test]
    fn alpha_is_ignored(texels: [Texel; 16], alpha: u8) {
        let other = texels.map(|[r, g, b, _]| [r, g, b, alpha]);
        for quality in QUALITIES {
            prop_assert_eq!(encode_block(&texels, quality), encode_block(&other, quality));
        }
    }

    #[test]
    fn images_of_any_size_match_their_padded_blocks(width in 1_u32..23, height in 1_u32..19, seed: u64) {
        let mut rng = Rng(seed);
        let texels: Vec<Texel> = (0..width * height).map(|_| rng.texel()).collect();
        let blocks = encode_image(width, height, &texels, Quality::Standard).unwrap();
        let (w, h) = (width as usize, height as usize);
        let across = w.div_ceil(4);
        prop_assert_eq!(blocks.len(), across * h.div_ceil(4) * BLOCK_BYTES);
        for (n, block) in blocks.as_chunks::<8>().0.iter().enumerate() {
            let padded = std::array::from_fn(|i| {
                let (x, y) = (4 * (n % across) + i % 4, 4 * (n / across) + i / 4);
                texels[y.min(h - 1) * w + x.min(w - 1)]
            });
            prop_assert_eq!(*block, encode_block(&padded, Quality::Standard));
        }
        let mut bgra = vec![0; w * h];
        texture2ddecoder::decode_bc1a(&blocks, w, h, &mut bgra).unwrap();
        let seen: Vec<Texel> = bgra.into_iter().map(rgba_from_bgra).collect();
        prop_assert_eq!(decode_image(width, height, &blocks).unwrap(), seen);
    }
}

/// Least error that any pair of `bits`-bit levels reaches for a channel value, at any palette entry.
fn best_channel_error(value: u8, bits: u32) -> u8 {
    let expand = |level: u32| (level << (8 - bits) | level >> (2 * bits - 8)) as u16;
    let levels = 0..1_u32 << bits;
    let pairs = levels.clone().flat_map(|a| levels.clone().map(move |b| (expand(a), expand(b))));
    pairs.map(|(a, b)| u16::from(value).abs_diff((2 * a + b) / 3).min(u16::from(value).abs_diff(a))).min().unwrap()
        as u8
}

fn channel_bounds() -> [[u8; 256]; 3] {
    let [five, six] = [5, 6].map(|bits| std::array::from_fn(|v| best_channel_error(v as u8, bits)));
    [five, six, five]
}

#[test]
fn solid_blocks_reach_the_brute_force_optimum() {
    let bounds = channel_bounds();
    let mut rng = Rng(3);
    let greys = (0..=255).map(|v| [v, v, v, 255]);
    let random = (0..20_000).map(|_| rng.texel());
    for texel in greys.chain(random).collect::<Vec<_>>() {
        for quality in QUALITIES {
            check_block(&[texel; 16]);
            let seen = oracle_block(&encode_block(&[texel; 16], quality))[7];
            for c in 0..3 {
                let bound = bounds[c][usize::from(texel[c])];
                assert_eq!(seen[c].abs_diff(texel[c]), bound, "channel {c} of {texel:?} became {seen:?}");
            }
        }
    }
}

#[test]
fn exactly_representable_blocks_come_back_exactly() {
    // Black and white, and a ramp whose four colours are one palette.
    let two: [Texel; 16] = std::array::from_fn(|i| if i % 3 == 0 { [0, 0, 0, 255] } else { [255; 4] });
    let ramp: [Texel; 16] = std::array::from_fn(|i| [0, 85, 170, 255].map(|v: u8| [v, v, v, 255])[i % 4]);
    for texels in [two, ramp] {
        assert_eq!(decode_block(&encode_block(&texels, Quality::Standard)), texels);
    }
}

fn test_image(width: u32, height: u32) -> Vec<Texel> {
    let mut rng = Rng(4);
    let texel = |i: u32, noise: u64| {
        let (x, y) = (i % width, i / width);
        [x as u8, (y * 2) as u8, (x ^ y) as u8, 255].map(|v| v.saturating_add((noise % 9) as u8))
    };
    (0..width * height).map(|i| texel(i, rng.next())).collect()
}

#[test]
fn the_number_of_threads_does_not_change_the_bytes() {
    let texels = test_image(203, 77);
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let blocks = encode_image(203, 77, &texels, Quality::Standard).unwrap();
            let decoded = decode_image(203, 77, &blocks).unwrap();
            (blocks, decoded)
        })
    };
    assert_eq!(with_threads(1), with_threads(2));
}

/// Pins the bytes: they may change only together with the encoder, never with machine or compiler.
#[test]
fn the_bytes_are_pinned() {
    let digest = |quality| {
        let bytes = encode_image(64, 64, &test_image(64, 64), quality).unwrap();
        bytes.iter().fold(0xcbf2_9ce4_8422_2325_u64, |hash, &b| (hash ^ u64::from(b)).wrapping_mul(0x0100_0000_01b3))
    };
    assert_eq!(QUALITIES.map(digest), [3_623_048_732_742_870_449, 12_829_980_741_607_148_143]);
}

#[test]
fn wrong_sizes_are_refused() {
    let texels = [[0; 4]; 16];
    let quality = Quality::default();
    assert_eq!(encode_image(0, 4, &texels, quality), Err(Bc1Error::EmptyImage { width: 0, height: 4 }));
    assert_eq!(encode_image(5, 4, &texels, quality), Err(Bc1Error::TexelCount { expected: 20, found: 16 }));
    assert_eq!(encode_image(4, 3, &texels, quality), Err(Bc1Error::TexelCount { expected: 12, found: 16 }));
    assert_eq!(decode_image(4, 0, &[]), Err(Bc1Error::EmptyImage { width: 4, height: 0 }));
    for found in [0, 15, 17, 24] {
        let error = Bc1Error::BlockBytes { expected: 16, found };
        assert_eq!(decode_image(5, 4, &vec![0; found]), Err(error));
    }
    let too_large = Bc1Error::TooLarge { width: u32::MAX, height: u32::MAX };
    assert_eq!(encode_image(u32::MAX, u32::MAX, &texels, quality), Err(too_large.clone()));
    assert_eq!(decode_image(u32::MAX, u32::MAX, &[]), Err(too_large));
}
