//! BC1 against an independent decoder, brute force and its own promises.

use lf_compress::bc1::{
    Alpha, BLOCK_BYTES, Bc1Error, EncodeOptions, Modes, Pixels, Quality, StreamEncoder, Texel, Weights, decode_block,
    decode_image, decode_texel, encode_block, encode_image, encode_pixels, encode_pixels_into,
};
use proptest::prelude::*;

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

/// Opaque, in 4-colour order, nearest entries, and no refinement worse than what it refines, as an independent decoder
/// sees it.
fn check_block(texels: &[Texel; 16]) {
    let errors = Quality::ALL.map(|quality| {
        let block = encode_block(texels, quality);
        let (color0, color1) = endpoints(&block);
        let equal_and_plain = color0 == color1 && indices(&block) == [0; 16];
        assert!(color0 > color1 || equal_and_plain, "{quality:?} gave {block:02x?} for {texels:?}");
        let seen = oracle_block(&block);
        assert!(seen.iter().all(|t| t[3] == 255), "opaque must mean opaque: {block:02x?}");
        assert_eq!(seen, decode_block(&block));
        // The two fastest choose entries by projection.
        let nearest = quality < Quality::Fast || indices_are_nearest(&block, texels);
        assert!(nearest, "{quality:?} {block:02x?} for {texels:?}");
        error(texels, &seen)
    });
    let [.., standard, high, best, exhaustive] = errors;
    assert!(high.max(best).max(exhaustive) <= standard, "{errors:?} for {texels:?}");
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
    for kind in 0..8_000 {
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
        for quality in Quality::ALL {
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
    let random = (0..4_000).map(|_| rng.texel());
    for texel in greys.chain(random).collect::<Vec<_>>() {
        for quality in Quality::ALL {
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
        for quality in &Quality::ALL[2..] {
            assert_eq!(decode_block(&encode_block(&texels, *quality)), texels, "{quality:?}");
        }
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
    let pinned = [
        6_186_109_955_185_365_794,
        7_955_440_923_267_267_875,
        12_537_064_690_328_157_673,
        17_249_107_076_517_744_827,
        4_929_016_298_638_000_209,
        14_520_716_560_731_407_506,
        1_390_764_427_151_856_848,
    ];
    assert_eq!(Quality::ALL.map(digest), pinned);
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

/// Mean squared error of the test image at every quality.
#[test]
fn each_quality_is_better_than_the_one_before() {
    let texels = test_image(128, 128);
    let errors = Quality::ALL.map(|quality| {
        let decoded = decode_image(128, 128, &encode_image(128, 128, &texels, quality).unwrap()).unwrap();
        let blocks = texels.as_chunks::<16>().0.iter().zip(decoded.as_chunks::<16>().0);
        blocks.map(|(a, b)| error(a, b)).sum::<u64>()
    });
    assert!(errors.is_sorted_by(|slower, faster| slower > faster), "{errors:?}");
}

/// Texels on a line through colour space have few sensible palettes; brute force over one channel's levels finds the
/// best of all there are.
#[test]
fn one_channel_blocks_come_near_the_brute_force_optimum() {
    let expand = |level: u16| i32::from(level << 3 | level >> 2);
    let mut rng = Rng(5);
    let (mut found, mut optimum) = ([0; 2], 0);
    for round in 0..300 {
        let span = [255, 60, 12][round % 3];
        let start = rng.next() % (256 - span);
        let values: [i32; 16] = std::array::from_fn(|_| (start + rng.next() % (span + 1)) as i32);
        let least = |a: i32, b: i32| {
            let entries = [a, b, (2 * a + b) / 3, (a + 2 * b) / 3];
            values.iter().map(|v| entries.iter().map(|e| (v - e).pow(2)).min().unwrap()).sum::<i32>()
        };
        let pairs = (0..32).flat_map(|a| (0..=a).map(move |b| (expand(a), expand(b))));
        let best = pairs.map(|(a, b)| least(a, b)).min().unwrap();
        let texels = values.map(|v| [v as u8, 0, 0, 255]);
        let errors = [Quality::Best, Quality::Exhaustive]
            .map(|quality| error(&texels, &oracle_block(&encode_block(&texels, quality))) as i32);
        assert!(errors[0] >= best && errors[1] >= best, "{errors:?} < {best}: the bound is wrong");
        optimum += best;
        found = [found[0] + errors[0], found[1] + errors[1]];
    }
    println!("optimum {optimum}, best {}, exhaustive {}", found[0], found[1]);
    assert!(f64::from(found[0]) <= 1.03 * f64::from(optimum), "Best: {found:?} against {optimum}");
    assert!(f64::from(found[1]) <= 1.005 * f64::from(optimum), "Exhaustive: {found:?} against {optimum}");
}

/// Endpoints 0 and 255 can be hit exactly, so nothing may overflow or wrap there.
#[test]
fn extreme_and_near_singular_blocks_keep_every_promise() {
    let extremes: [Texel; 4] = [[0, 0, 0, 255], [255, 255, 255, 255], [255, 0, 255, 255], [0, 255, 0, 255]];
    for a in extremes {
        for b in extremes {
            for at in 0..16 {
                check_block(&std::array::from_fn(|i| if i == at { b } else { a }));
                check_block(&std::array::from_fn(|i| if i <= at { b } else { a }));
                // One texel off by one in one channel: a covariance that is almost nothing.
                check_block(&std::array::from_fn(|i| if i == at { a.map(|v| v ^ 1) } else { a }));
            }
        }
    }
}

/// Five cameras side by side that see the same with a little parallax: what one found serves the next.
#[test]
fn repeated_pictures_start_from_each_other() {
    const SIDE: usize = 64;
    let picture = test_image(2 * SIDE as u32, SIDE as u32);
    let atlas: Vec<Texel> =
        (0..SIDE * 5 * SIDE).map(|i| picture[i / (5 * SIDE) * 2 * SIDE + i % SIDE + i / SIDE % 5]).collect();
    let squared_error = |options: EncodeOptions| {
        let blocks = encode_image(5 * SIDE as u32, SIDE as u32, &atlas, options).unwrap();
        let decoded = decode_image(5 * SIDE as u32, SIDE as u32, &blocks).unwrap();
        let pairs = atlas.as_chunks::<16>().0.iter().zip(decoded.as_chunks::<16>().0);
        pairs.map(|(a, b)| error(a, b)).sum::<u64>()
    };
    for quality in [Quality::Standard, Quality::High] {
        let [alone, seeded] = [0, SIDE as u32 / 4].map(|n| squared_error(EncodeOptions::new(quality).repeat_blocks(n)));
        assert!(1000 * seeded < 997 * alone, "{quality:?}: {seeded} against {alone}");
    }
    let fast = EncodeOptions::new(Quality::Fast);
    assert_eq!(squared_error(fast), squared_error(fast.repeat_blocks(16)), "only from Standard on");
}

#[test]
fn three_colour_modes_are_used_only_where_allowed_and_help() {
    let mut rng = Rng(6);
    let mut total = [0; 3];
    for kind in 0..3_000 {
        let mut texels = structured(&mut rng, kind);
        if kind % 4 == 0 {
            texels[..6].fill([0, 0, 0, 255]);
        }
        let modes = [Modes::FourColor, Modes::ThreeColor, Modes::ThreeColorBlack];
        let errors = modes.map(|modes| {
            let block = encode_block(&texels, EncodeOptions::new(Quality::High).modes(modes));
            let (color0, color1) = endpoints(&block);
            let three = color0 <= color1 && indices(&block) != [0; 16];
            assert!(!three || modes != Modes::FourColor);
            let black = three && indices(&block).contains(&3);
            assert!(!black || modes == Modes::ThreeColorBlack, "{block:02x?}");
            error(&texels, &oracle_block(&block))
        });
        assert!(errors.is_sorted_by(|fewer, more| fewer >= more), "{errors:?} for {texels:?}");
        total = std::array::from_fn(|i| total[i] + errors[i]);
    }
    assert!(total[1] * 1000 < total[0] * 997 && total[2] * 100 < total[1] * 99, "{total:?}");
}

proptest! {
    /// Alpha below the threshold becomes transparent black, everything else stays opaque.
    #[test]
    fn thresholded_alpha_comes_back(texels: [Texel; 16], threshold: u8) {
        for quality in Quality::ALL {
            for modes in [Modes::FourColor, Modes::ThreeColorBlack] {
                let options = EncodeOptions::new(quality).alpha(Alpha::Threshold(threshold)).modes(modes);
                let seen = oracle_block(&encode_block(&texels, options));
                for (texel, seen) in texels.iter().zip(seen) {
                    prop_assert_eq!(seen[3], if texel[3] < threshold { 0 } else { 255 });
                }
            }
        }
    }

    /// The weighted error is never larger than what ignoring the weights leaves.
    #[test]
    fn weights_serve_the_weighted_error(seed: u64) {
        let mut rng = Rng(seed);
        let weighted = |x: Texel, p: Texel| {
            let square = |c: usize| u64::from(x[c].abs_diff(p[c])).pow(2);
            5 * square(0) + 9 * square(1) + 2 * square(2)
        };
        let mut total = [0, 0];
        for _ in 0..64 {
            let texels = rng.noise();
            for (total, weights) in total.iter_mut().zip([Weights::UNIFORM, Weights::PERCEPTUAL]) {
                let block = encode_block(&texels, EncodeOptions::new(Quality::High).weights(weights));
                *total += texels.iter().zip(oracle_block(&block)).map(|(x, p)| weighted(*x, p)).sum::<u64>();
            }
        }
        prop_assert!(total[1] < total[0], "{:?}", total);
    }

    /// All pixel layouts, strides and ways to feed rows give the blocks of the plain image.
    #[test]
    fn layouts_strides_and_streams_agree(width in 1_usize..40, height in 1_usize..11, gap in 0_usize..5, seed: u64) {
        let mut rng = Rng(seed);
        let stride = width + gap;
        let wide: Vec<Texel> = (0..stride * height).map(|_| rng.texel().map(|v| v | 0x0f)).collect();
        let opaque: Vec<Texel> = wide.iter().map(|t| [t[0], t[1], t[2], 255]).collect();
        let plain: Vec<Texel> = opaque.chunks(stride).flat_map(|row| &row[..width]).copied().collect();
        let (w, h) = (width as u32, height as u32);
        let options = EncodeOptions::new(Quality::Fast).alpha(Alpha::Refuse);
        let expected = encode_image(w, h, &plain, options).unwrap();
        let rgb: Vec<u8> = opaque.iter().flat_map(|t| [t[0], t[1], t[2]]).collect();
        let rgba_f32: Vec<f32> = opaque.iter().flatten().map(|v| f32::from(*v) / 255.0).collect();
        let rgb_f32: Vec<f32> = rgb.iter().map(|v| f32::from(*v) / 255.0).collect();
        let layouts = [
            Pixels::Rgba8(opaque.as_flattened()), Pixels::Rgb8(&rgb), Pixels::RgbaF32(&rgba_f32), Pixels::RgbF32(&rgb_f32),
        ];
        for pixels in layouts {
            prop_assert_eq!(&encode_pixels(w, h, pixels, stride, options).unwrap(), &expected);
            let mut into = vec![0; expected.len()];
            encode_pixels_into(w, h, pixels, stride, options, &mut into).unwrap();
            prop_assert_eq!(&into, &expected);
            into.push(0);
            prop_assert!(encode_pixels_into(w, h, pixels, stride, options, &mut into).is_err());
        }
        let (mut stream, mut blocks) = (StreamEncoder::new(w, options).unwrap(), Vec::new());
        for rows in plain.chunks(width * (1 + seed as usize % 5)) {
            stream.push(Pixels::Rgba8(rows.as_flattened()), &mut blocks).unwrap();
        }
        stream.finish(&mut blocks).unwrap();
        prop_assert_eq!(blocks, expected);
    }
}

#[test]
fn what_is_not_a_colour_is_clamped() {
    let wild = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -3.0, 1e30, f32::MIN_POSITIVE, -0.0, 1.0];
    let tame = [0, 255, 0, 0, 255, 0, 0, 255];
    let floats: Vec<f32> = (0..48).map(|i| wild[i * 5 % 8]).collect();
    let bytes: Vec<u8> = (0..48).map(|i| tame[i * 5 % 8]).collect();
    for quality in Quality::ALL {
        let from_floats = encode_pixels(4, 4, Pixels::RgbF32(&floats), 4, quality);
        assert_eq!(from_floats, encode_pixels(4, 4, Pixels::Rgb8(&bytes), 4, quality));
    }
}

#[test]
fn what_cannot_be_encoded_is_refused() {
    let mut texels = vec![[9, 9, 9, 255]; 30];
    let options = EncodeOptions::new(Quality::Fast).alpha(Alpha::Refuse);
    assert!(encode_image(6, 5, &texels, options).is_ok());
    texels[4 * 6 + 2][3] = 254;
    let refused = Err(Bc1Error::NotOpaque { x: 2, y: 4, alpha: 254 });
    assert_eq!(encode_image(6, 5, &texels, options), refused);
    assert_eq!(Weights::new(0, 1, 1), Err(Bc1Error::Weights { weights: [0, 1, 1] }));
    assert_eq!(Weights::new(1, 15, 1), Err(Bc1Error::Weights { weights: [1, 15, 1] }));
    assert_eq!(Weights::new(5, 9, 2), Ok(Weights::PERCEPTUAL));
    let pixels = Pixels::Rgba8(texels.as_flattened());
    assert_eq!(encode_pixels(6, 5, pixels, 5, options), Err(Bc1Error::Stride { width: 6, stride: 5 }));
    let short = Err(Bc1Error::BufferTexels { expected: 34, found: 30 });
    assert_eq!(encode_pixels(6, 5, pixels, 7, options), short);
    let mut stream = StreamEncoder::new(4, options).unwrap();
    let ragged = Err(Bc1Error::TexelCount { expected: 32, found: 30 });
    assert_eq!(stream.push(pixels, &mut Vec::new()), ragged);
}
