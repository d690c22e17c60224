//! From texels to blocks: groups, the choice of mode, and the packing of the winner.

use std::cmp::Ordering;

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch};

use super::fit::Fit;
use super::lanes::{I, M, MAX_LANES, Packed, Rows, U, lanes, load};
use super::options::{Alpha, EncodeOptions, Modes, Quality};
use super::palette::Metric;
use super::quick::{box_fit, refined_box_fit};
use super::search::{Plan, four_color};
use super::seeds::Seeds;
use super::solid::solid_endpoints;
use super::three_color::three_color;
use super::{BLOCK_BYTES, Texel};

/// Encodes 4×4 texels, given in row-major order, as one block.
///
/// A [`Quality`] will do for the options. With the defaults the block is an opaque 4-colour block: the first endpoint is
/// the greater of the two, except that a block whose best fit is a single 565 colour has equal endpoints and all
/// indices 0, which every decoder reads as that colour. A block of one colour gets the best endpoints there are. The
/// same texels give the same bytes on every machine. [`Alpha::Refuse`] is only heeded by [`encode_image`].
///
/// Blocks are searched in groups, so one at a time takes as long as a group: encode rows or images where you can.
///
/// [`encode_image`]: super::encode_image
pub fn encode_block(texels: &[Texel; 16], options: impl Into<EncodeOptions>) -> [u8; BLOCK_BYTES] {
    let mut block = [[0; BLOCK_BYTES]];
    let [a, b, c, d] = std::array::from_fn(|y| &texels[4 * y..4 * y + 4]);
    encode_rows([a, b, c, d], &options.into(), &mut block);
    block[0]
}

/// Encodes a row of blocks from four equally long rows of texels; past their end the last texel repeats.
pub(super) fn encode_rows(rows: Rows<'_>, options: &EncodeOptions, blocks: &mut [[u8; BLOCK_BYTES]]) {
    encode_rows_at(Level::new(), rows, options, blocks);
}

fn encode_rows_at(level: Level, rows: Rows<'_>, options: &EncodeOptions, blocks: &mut [[u8; BLOCK_BYTES]]) {
    dispatch!(level, simd => encode_groups(simd, rows, options, blocks));
}

#[inline(always)]
fn encode_groups<S: Simd>(simd: S, rows: Rows<'_>, options: &EncodeOptions, blocks: &mut [[u8; BLOCK_BYTES]]) {
    let width = 4 * lanes::<S>();
    let repeat = options.repeat().filter(|&repeat| options.quality >= Quality::Standard && repeat < blocks.len());
    let mut seeds = repeat.map(|repeat| Seeds::new(repeat, blocks.len()));
    let mut padded = [[[0; 4]; 4 * MAX_LANES]; 4];
    for (number, blocks) in blocks.chunks_mut(lanes::<S>()).enumerate() {
        let left = number * width;
        let inside = blocks.len() == lanes::<S>() && rows[0].len() >= left + width;
        if !inside {
            for (padded, row) in padded.iter_mut().zip(rows) {
                for (x, texel) in padded[..width].iter_mut().enumerate() {
                    *texel = row[(left + x).min(row.len() - 1)];
                }
            }
        }
        // No iterator or `map` here: their closures would not be inlined, at a tenth of the fastest quality's time.
        let mut group = [&padded[0][..width], &padded[1][..width], &padded[2][..width], &padded[3][..width]];
        if inside {
            for y in 0..4 {
                group[y] = &rows[y][left..left + width];
            }
        }
        encode_group(simd, group, options, seeds.as_mut().map(|seeds| (seeds, number * lanes::<S>())), blocks);
    }
}

/// Endpoints and indices of a group, ready to be stored, and their error where it was measured.
struct Coded<S: Simd> {
    /// The first endpoint in the low half.
    colors: U<S>,
    indices: U<S>,
    error: I<S>,
}

#[inline(always)]
fn encode_group<S: Simd>(
    simd: S,
    rows: Rows<'_>,
    options: &EncodeOptions,
    seeds: Option<(&mut Seeds, usize)>,
    blocks: &mut [[u8; BLOCK_BYTES]],
) {
    simd.vectorize(
        #[inline(always)]
        || {
            let texels = load(simd, rows);
            match options.quality {
                Quality::Realtime if options.is_plain() => code_quick(simd, &texels, false).store(blocks),
                Quality::VeryFast if options.is_plain() => code_quick(simd, &texels, true).store(blocks),
                _ => code_searched(simd, &texels, options, seeds).store(blocks),
            }
            patch_solid::<S>(&texels, options, blocks);
        },
    );
}

#[inline(always)]
fn code_quick<S: Simd>(simd: S, texels: &Packed<S>, refined: bool) -> Coded<S> {
    let fit = if refined { refined_box_fit(simd, texels) } else { box_fit(simd, texels) };
    Coded::four_color(simd, fit.colors, fit.shares, I::<S>::splat(simd, 0))
}

#[inline(always)]
fn code_searched<S: Simd>(
    simd: S,
    texels: &Packed<S>,
    options: &EncodeOptions,
    seeds: Option<(&mut Seeds, usize)>,
) -> Coded<S> {
    let (metric, plan) = (Metric { weights: options.weights.to_f32() }, Plan::of(options.quality));
    let seed = if let Some((seeds, first)) = &seeds { Some(seeds.load(simd, *first)) } else { None };
    let four = four_color(simd, texels, &metric, &plan, seed.as_ref());
    if let Some((seeds, first)) = seeds {
        seeds.store(first, &four.ends);
    }
    let four = Coded::four_color(simd, [four.ends.color(0), four.ends.color(1)], four.shares, four.error);
    if options.modes == Modes::FourColor && !matches!(options.alpha, Alpha::Threshold(_)) {
        return four;
    }
    let (threshold, black) = match options.alpha {
        Alpha::Threshold(threshold) => (u32::from(threshold), false),
        Alpha::Ignore | Alpha::Refuse => (0, options.modes == Modes::ThreeColorBlack),
    };
    let mut transparent = [M::<S>::splat(simd, false); 16];
    let mut any = transparent[0];
    for (transparent, texel) in transparent.iter_mut().zip(texels) {
        *transparent = (*texel >> 24).simd_lt(threshold);
        any |= *transparent;
    }
    if options.modes == Modes::FourColor && any.all_false() {
        return four;
    }
    let fit: Fit<S> = three_color(simd, texels, &transparent, black, &metric, &plan);
    let three = Coded::three_color(&fit);
    let allowed = M::<S>::splat(simd, options.modes != Modes::FourColor);
    Coded::select(any | (allowed & three.error.simd_lt(four.error)), &three, &four)
}

impl<S: Simd> Coded<S> {
    /// Orders the endpoints as 4-colour mode asks and names the entries as it does.
    #[inline(always)]
    fn four_color(simd: S, [a, b]: [U<S>; 2], shares: U<S>, error: I<S>) -> Self {
        // The shares 3, 0, 2, 1 are the indices 0, 1, 2, 3: the high bit of an index is the exclusive or of the share's
        // bits, the low bit the inverse of its high bit.
        let (high, low) = (shares & 0xaaaa_aaaa, shares & 0x5555_5555);
        let indices = (high ^ (low << 1)) | ((high >> 1) ^ 0x5555_5555);
        // Exchanged endpoints exchange the indices 0 with 1 and 2 with 3.
        let indices = a.simd_lt(b).select(indices ^ 0x5555_5555, indices);
        let indices = a.simd_eq(b).select(U::<S>::splat(simd, 0), indices);
        Self { colors: a.max(b) | (a.min(b) << 16), indices, error }
    }

    /// Orders the endpoints as 3-colour mode asks and names the entries as it does.
    #[inline(always)]
    fn three_color(fit: &Fit<S>) -> Self {
        let (a, b) = (fit.ends.color(0), fit.ends.color(1));
        // The shares 2, 0, 1, 3 are the indices 0, 1, 2, 3, or 1, 0, 2, 3 where the first endpoint is stored second.
        let (high, low) = ((fit.shares >> 1) & 0x5555_5555, fit.shares & 0x5555_5555);
        let stored_first = (high ^ low) ^ 0x5555_5555;
        let indices = (low << 1) | a.simd_gt(b).select(high, stored_first);
        Self { colors: a.min(b) | (a.max(b) << 16), indices, error: fit.error }
    }

    #[inline(always)]
    fn select(mask: M<S>, a: &Self, b: &Self) -> Self {
        Self {
            colors: mask.select(a.colors, b.colors),
            indices: mask.select(a.indices, b.indices),
            error: mask.select(a.error, b.error),
        }
    }

    #[inline(always)]
    fn store(&self, blocks: &mut [[u8; BLOCK_BYTES]]) {
        if cfg!(target_endian = "little") && blocks.len() == lanes::<S>() {
            let (first, second) = blocks.as_flattened_mut().split_at_mut(4 * lanes::<S>());
            self.colors.zip_low(self.indices).bitcast::<S::u8s>().store_slice(first);
            self.colors.zip_high(self.indices).bitcast::<S::u8s>().store_slice(second);
            return;
        }
        for (lane, block) in blocks.iter_mut().enumerate() {
            *block = join(self.colors.as_slice()[lane], self.indices.as_slice()[lane]);
        }
    }
}

fn join(colors: u32, indices: u32) -> [u8; BLOCK_BYTES] {
    (u64::from(colors) | u64::from(indices) << 32).to_le_bytes()
}

/// Gives blocks of one opaque colour the endpoints of the table.
#[inline(always)]
fn patch_solid<S: Simd>(texels: &Packed<S>, options: &EncodeOptions, blocks: &mut [[u8; BLOCK_BYTES]]) {
    let compared = if matches!(options.alpha, Alpha::Threshold(_)) { u32::MAX } else { 0xff_ffff };
    let mut differ = texels[0] ^ texels[1];
    for texel in &texels[2..] {
        differ |= texels[0] ^ *texel;
    }
    let solid = (differ & compared).simd_eq(0);
    if solid.all_false() {
        return;
    }
    for (lane, block) in blocks.iter_mut().enumerate() {
        let [r, g, b, a] = texels[0].as_slice()[lane].to_le_bytes();
        let opaque = !matches!(options.alpha, Alpha::Threshold(threshold) if a < threshold);
        if solid.test(lane) && opaque {
            *block = solid_block([r, g, b]);
        }
    }
}

fn solid_block(rgb: [u8; 3]) -> [u8; BLOCK_BYTES] {
    const ALL_INDEX_2: u32 = 0xaaaa_aaaa;
    const ALL_INDEX_3: u32 = 0xffff_ffff;
    let (a, b) = solid_endpoints(rgb);
    let colors = |first: u16, second: u16| u32::from(first) | u32::from(second) << 16;
    match a.cmp(&b) {
        Ordering::Greater => join(colors(a, b), ALL_INDEX_2),
        Ordering::Less => join(colors(b, a), ALL_INDEX_3),
        Ordering::Equal => join(colors(a, b), 0),
    }
}

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use proptest::prelude::*;

    use super::super::Weights;
    use super::super::decode_block;
    use super::super::levels::levels;
    use super::*;

    fn options() -> impl Strategy<Value = EncodeOptions> {
        let weights = prop::sample::select(vec![Weights::UNIFORM, Weights::PERCEPTUAL]);
        let modes = prop::sample::select(vec![Modes::FourColor, Modes::ThreeColor, Modes::ThreeColorBlack]);
        let alpha = prop::sample::select(vec![Alpha::Ignore, Alpha::Threshold(1), Alpha::Threshold(128)]);
        let repeat = prop::sample::select(vec![None, NonZeroU32::new(1), NonZeroU32::new(5), NonZeroU32::new(16)]);
        (prop::sample::select(&Quality::ALL[..]), weights, modes, alpha, repeat).prop_map(
            |(quality, weights, modes, alpha, repeat_blocks)| EncodeOptions {
                quality,
                weights,
                modes,
                alpha,
                repeat_blocks,
            },
        )
    }

    /// Texels of the usual kinds: noise, few colours, small differences.
    fn texels() -> impl Strategy<Value = Texel> {
        let near = (0_u8..6, 0_u8..6, 0_u8..6, any::<u8>()).prop_map(|(r, g, b, a)| [90 + r, 120 + g, 30 + b, a]);
        let few = prop::sample::select(vec![[0, 0, 0, 255], [255; 4], [200, 30, 30, 255], [8, 8, 8, 0]]);
        prop_oneof![any::<Texel>(), near, few]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// One code for all machines: neither the vectors' width nor fused multiplication may show.
        #[test]
        fn all_levels_agree(texels in prop::collection::vec(texels(), 4..4 * 160), options in options()) {
            let width = texels.len() / 4;
            let rows = std::array::from_fn(|y| &texels[y * width..(y + 1) * width]);
            let encode = |level| {
                let mut blocks = vec![[0; BLOCK_BYTES]; width.div_ceil(4)];
                encode_rows_at(level, rows, &options, &mut blocks);
                blocks
            };
            let expected = encode(Level::fallback());
            for level in levels() {
                prop_assert_eq!(encode(level), expected.clone(), "{:?}", level);
            }
        }

        /// What the searches make small is what a decoder sees.
        #[test]
        fn the_measured_error_is_the_decoders(texels: [Texel; 16], options in options()) {
            let (error, block) = dispatch!(Level::new(), simd => code_one(simd, &texels, &options));
            let weights = options.weights.to_f32();
            let (mut expected, decoded) = (0.0, decode_block(&block));
            for (x, p) in texels.iter().zip(&decoded) {
                // Transparent texels count −1, and nothing is known of their colour.
                let transparent = matches!(options.alpha, Alpha::Threshold(least) if x[3] < least);
                let term = |c: usize| weights[c] * f32::from(p[c]) * (f32::from(p[c]) - 2.0 * f32::from(x[c]));
                expected += if transparent { -1.0 } else { term(0) + term(1) + term(2) };
            }
            prop_assert_eq!(error as f32, expected);
        }
    }

    #[inline(always)]
    fn code_one<S: Simd>(simd: S, texels: &[Texel; 16], options: &EncodeOptions) -> (i32, [u8; BLOCK_BYTES]) {
        let row = |y: usize| texels[4 * y..4 * y + 4].repeat(lanes::<S>());
        let coded = code_searched(simd, &load(simd, [&row(0), &row(1), &row(2), &row(3)]), options, None);
        (coded.error.as_slice()[0], join(coded.colors.as_slice()[0], coded.indices.as_slice()[0]))
    }
}
