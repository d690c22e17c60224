//! BC1 blocks whose endpoint fits are singular or nearly so.

use std::ops::RangeInclusive;

use lf_compress::bc1::{BLOCK_BYTES, Bc1Error, Pixels, Quality, Texel, decode_block, encode_image, encode_pixels};

use super::draws::{Draws, ODD};
use super::{DRAWS, Row, Tally};

/// Blocks that are encoded together, side by side.
const AT_ONCE: usize = 4096;

/// A block: of one colour; of two, near each other or not; all but one texel alike; on a line of colours, exactly or nearly; or noise.
fn block(draws: &mut Draws) -> [Texel; 16] {
    let mut color = || [0, 1, 2].map(|_| draws.bits() as u8);
    let (base, far) = (color(), color());
    let kind = draws.below(7);
    let few = 1 + draws.below(3) as i32;
    std::array::from_fn(|i| {
        let moved = |draws: &mut Draws, by: RangeInclusive<i32>| {
            let by = *by.start() + draws.below((by.end() - by.start() + 1) as usize) as i32;
            base.map(|c| (i32::from(c) + by).clamp(0, 255) as u8)
        };
        let along = draws.unit();
        let between = [0, 1, 2].map(|c| (f64::from(base[c]) + along * (f64::from(far[c]) - f64::from(base[c]))) as u8);
        let [r, g, b] = match kind {
            0 => base,
            1 => [base, far][draws.below(2)],
            2 => moved(draws, 0..=1),
            3 => [base, far][usize::from(i == 5)],
            4 => between,
            5 => moved(draws, -few..=few),
            _ => [0, 1, 2].map(|_| draws.bits() as u8),
        };
        [r, g, b, 255]
    })
}

/// Blocks encoded as one row of an image.
fn encoded(blocks: &[[Texel; 16]], quality: Quality) -> Result<Vec<[u8; BLOCK_BYTES]>, Bc1Error> {
    let row = |y: usize| blocks.iter().flat_map(move |block| &block[4 * y..4 * y + 4]).copied();
    let texels: Vec<Texel> = (0..4).flat_map(row).collect();
    let bytes = encode_image(4 * blocks.len() as u32, 4, &texels, quality)?;
    Ok(bytes.as_chunks().0.to_vec())
}

fn error(texels: &[Texel; 16], block: &[u8; BLOCK_BYTES]) -> f64 {
    let square = |a: &Texel, b: &Texel| (0..3).map(|c| f64::from(a[c].abs_diff(b[c])).powi(2)).sum::<f64>();
    texels.iter().zip(&decode_block(block)).map(|(a, b)| square(a, b)).sum()
}

/// Opaque, and in 4-colour mode: the first endpoint greater, or both alike and every index 0.
fn is_four_color(block: &[u8; BLOCK_BYTES]) -> bool {
    let [a, b, c, d, indices @ ..] = *block;
    let (first, second) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
    (first > second || (first == second && indices == [0; 4]))
        && decode_block(block).iter().all(|texel| texel[3] == 255)
}

/// The block of its own mean.
fn mean(texels: &[Texel; 16]) -> [Texel; 16] {
    let sum = |c: usize| texels.iter().map(|texel| u32::from(texel[c])).sum::<u32>();
    [[((sum(0) + 8) / 16) as u8, ((sum(1) + 8) / 16) as u8, ((sum(2) + 8) / 16) as u8, 255]; 16]
}

/// Rules: never the 3-colour mode, and a block of one colour, for which endpoints have no unique best, is one of the best pairs for
/// it. Notes the squared error of the second encoding over that of the first.
fn compare(tally: &mut Tally, texels: &[[Texel; 16]], [plain, refined]: [&[[u8; BLOCK_BYTES]]; 2]) {
    for ((texels, plain), refined) in texels.iter().zip(plain).zip(refined) {
        let [plain_error, refined_error] = [plain, refined].map(|block| error(texels, block));
        let even = texels.iter().all(|texel| *texel == texels[0]);
        let fallen_back = !even || refined_error <= 16.0 * even_error(texels[0]);
        tally.rule(is_four_color(plain) && is_four_color(refined) && fallen_back);
        tally.ratio(refined_error, plain_error);
    }
}

/// The least squared error that an entry between two levels leaves of a colour: by trying all.
fn even_error(color: Texel) -> f64 {
    let widened = |level: u32, bits: u32| level << (8 - bits) | level >> (2 * bits - 8);
    let of_channel = |c: usize| {
        let bits = [5, 6, 5][c];
        let levels = 1u32 << bits;
        let pairs = (0..levels).flat_map(|a| (0..levels).map(move |b| [a, b].map(|level| widened(level, bits))));
        let apart = pairs.map(|[a, b]| ((2 * a + b) / 3).abs_diff(u32::from(color[c])));
        f64::from(apart.min().unwrap_or(0))
    };
    (0..3).map(|c| of_channel(c).powi(2)).sum()
}

fn blocks(draws: &mut Draws) -> Vec<[Texel; 16]> {
    (0..AT_ONCE).map(|_| block(draws)).collect()
}

/// The descent of `High` begins with what `Standard` finds: the number is the squared error of one over that of the other.
///
/// # Panics
/// If a block cannot be encoded.
#[must_use]
pub fn fits() -> Row {
    let (mut draws, mut tally) = (Draws::new(60), Tally::default());
    for _ in 0..DRAWS.div_ceil(AT_ONCE) {
        let texels = blocks(&mut draws);
        let [plain, refined] = [Quality::Standard, Quality::High].map(|q| encoded(&texels, q).expect("encodes"));
        compare(&mut tally, &texels, [&plain, &refined]);
    }
    tally.row("BC1: refined against unrefined", "squared error", [1.0, 1.0])
}

/// `VeryFast` refines what `Realtime` finds, but neither measures its error: that is what makes them fast, and the number has nothing to
/// pass.
///
/// # Panics
/// If a block cannot be encoded.
#[must_use]
pub fn quick_fits() -> Row {
    let (mut draws, mut tally) = (Draws::new(62), Tally::default());
    for _ in 0..DRAWS.div_ceil(AT_ONCE) {
        let texels = blocks(&mut draws);
        let [plain, refined] = [Quality::Realtime, Quality::VeryFast].map(|q| encoded(&texels, q).expect("encodes"));
        compare(&mut tally, &texels, [&plain, &refined]);
    }
    tally.row("BC1: very fast against realtime, for comparison", "squared error", [f64::INFINITY; 2])
}

/// Blocks that are nearly of one colour might do better as if they were: `Standard` against the block of the mean. A limit of the
/// method, with nothing to pass.
///
/// # Panics
/// If a block cannot be encoded.
#[must_use]
pub fn nearly_even() -> Row {
    let (mut draws, mut tally) = (Draws::new(63), Tally::default());
    for _ in 0..DRAWS.div_ceil(AT_ONCE) {
        let texels = blocks(&mut draws);
        let means: Vec<_> = texels.iter().map(mean).collect();
        let [fitted, even] = [&texels, &means].map(|texels| encoded(texels, Quality::Standard).expect("encodes"));
        compare(&mut tally, &texels, [&even, &fitted]);
    }
    tally.row("BC1: fitted against the mean colour, for comparison", "squared error", [f64::INFINITY; 2])
}

/// Numbers that are none, infinite or beyond 0 … 1 become bytes before anything is fitted.
///
/// # Panics
/// If a block cannot be encoded.
#[must_use]
pub fn odd_numbers() -> Row {
    let (mut draws, mut tally) = (Draws::new(61), Tally::default());
    let byte = |value: f32| match value {
        v if v.is_nan() || v <= 0.0 => 0,
        v if v >= 1.0 => 255,
        v => (f64::from(v) * 255.0).round() as u8,
    };
    for _ in 0..DRAWS.div_ceil(AT_ONCE) {
        let mut value = || if draws.below(3) == 0 { ODD[draws.below(ODD.len())] } else { draws.unit() as f32 };
        let values: Vec<f32> = (0..AT_ONCE * 16 * 3).map(|_| value()).collect();
        let bytes: Vec<u8> = values.iter().map(|&v| byte(v)).collect();
        let size = [4 * AT_ONCE as u32, 4];
        let encode =
            |pixels| encode_pixels(size[0], size[1], pixels, size[0] as usize, Quality::Realtime).expect("encodes");
        let (found, expected) = (encode(Pixels::RgbF32(&values)), encode(Pixels::Rgb8(&bytes)));
        for (found, expected) in found.chunks(BLOCK_BYTES).zip(expected.chunks(BLOCK_BYTES)) {
            tally.rule(found == expected);
        }
    }
    tally.row("BC1: what is no number is sanitised first", "", [0.0, 0.0])
}
