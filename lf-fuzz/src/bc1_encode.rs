//! Any texels and options: no panic, opaque means opaque, transparent means transparent, and refinement never hurts.

use arbitrary::{Arbitrary, Unstructured};
use lf_compress::bc1::{Alpha, EncodeOptions, Modes, Quality, Weights, decode_block, encode_block};

#[derive(Arbitrary, Debug)]
struct Input {
    texels: [[u8; 4]; 16],
    quality: u8,
    modes: u8,
    threshold: Option<u8>,
    weights: [u8; 3],
}

/// See the module.
pub fn run(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let modes = [Modes::FourColor, Modes::ThreeColor, Modes::ThreeColorBlack][usize::from(input.modes % 3)];
    let alpha = input.threshold.map_or(Alpha::Ignore, Alpha::Threshold);
    let [r, g, b] = input.weights.map(|w| w % 6);
    let weights = Weights::new(r, g, b).unwrap_or_default();
    let options = |quality| EncodeOptions::new(quality).modes(modes).alpha(alpha).weights(weights);
    let quality = Quality::ALL[usize::from(input.quality) % Quality::ALL.len()];
    let block = encode_block(&input.texels, options(quality));
    let decoded = decode_block(&block);
    let three_color = u16::from_le_bytes([block[0], block[1]]) <= u16::from_le_bytes([block[2], block[3]]);
    for (texel, seen) in input.texels.iter().zip(decoded) {
        let transparent = input.threshold.is_some_and(|threshold| texel[3] < threshold);
        let may_be_black = three_color && modes == Modes::ThreeColorBlack && alpha == Alpha::Ignore;
        assert!(seen[3] == if transparent { 0 } else { 255 } || may_be_black, "{texel:?} became {seen:?}");
    }
    let weights = if weights == Weights::UNIFORM { [1, 1, 1] } else { [r, g, b] };
    let error = |block: &[u8; 8]| -> u64 {
        let pairs =
            input.texels.iter().zip(decode_block(block)).filter(|(_, seen)| seen[3] == 255 || alpha == Alpha::Ignore);
        pairs
            .map(|(x, p)| (0..3).map(|c| u64::from(weights[c]) * u64::from(x[c].abs_diff(p[c])).pow(2)).sum::<u64>())
            .sum()
    };
    let standard = encode_block(&input.texels, options(Quality::Standard));
    assert!(quality < Quality::Standard || error(&block) <= error(&standard), "{quality:?} is worse than Standard");
}
