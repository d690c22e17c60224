//! Block encoding: which fits are tried at which quality, and the packing of the winner.

use std::cmp::Ordering;

use super::block::Block;
use super::decode::decode_block;
use super::fit::{Fit, bounding_fit, principal_fit, refit};
use super::solid::solid_endpoints;
use super::{BLOCK_BYTES, Quality, Texel};

/// Least-squares rounds at most. Most blocks stop earlier, for lack of gain; the third adds little, a fourth nothing.
const ROUNDS: usize = 3;

/// Encodes 4×4 texels, given in row-major order, as one opaque 4-colour block.
///
/// Alpha is ignored. The first endpoint is the greater of the two, except that a block whose best fit is a single
/// 565 colour has equal endpoints and all indices 0, which every decoder reads as that colour. A block of one colour
/// gets the best endpoints there are; other blocks get a good fit, at [`Quality::Standard`] never a worse one than at
/// [`Quality::Fast`]. The same texels give the same bytes on every machine.
pub fn encode_block(texels: &[Texel; 16], quality: Quality) -> [u8; BLOCK_BYTES] {
    let [r, g, b, _] = texels[0];
    if texels.iter().all(|t| t[0] == r && t[1] == g && t[2] == b) {
        return solid([r, g, b]);
    }
    let block = Block::new(texels);
    let fast = bounding_fit(&block);
    let fit = match quality {
        Quality::Realtime | Quality::Fast => fast,
        Quality::Standard | Quality::High | Quality::Best | Quality::Exhaustive => {
            refine(&block, fast.or_better(principal_fit(&block)))
        }
    };
    let packed = pack(&fit);
    debug_assert_eq!(fit.error, squared_error(texels, &packed), "the fit and the decoder disagree");
    packed
}

/// Squared error over R, G and B of a block as a decoder sees it.
fn squared_error(texels: &[Texel; 16], block: &[u8; BLOCK_BYTES]) -> f32 {
    let square = |a: u8, b: u8| f32::from(a.abs_diff(b)) * f32::from(a.abs_diff(b));
    let decoded = decode_block(block);
    texels.iter().zip(&decoded).map(|(t, d)| (0..3).map(|c| square(t[c], d[c])).sum::<f32>()).sum()
}

/// Refits until the error stops falling.
fn refine(block: &Block, seed: Fit) -> Fit {
    let mut best = seed;
    for _ in 0..ROUNDS {
        match refit(block, &best.thirds) {
            Some(next) if next.error < best.error => best = next,
            _ => break,
        }
    }
    best
}

fn solid(rgb: [u8; 3]) -> [u8; BLOCK_BYTES] {
    const ALL_INDEX_2: u32 = 0xaaaa_aaaa;
    const ALL_INDEX_3: u32 = 0xffff_ffff;
    let (a, b) = solid_endpoints(rgb);
    match a.cmp(&b) {
        Ordering::Greater => assemble(a, b, ALL_INDEX_2),
        Ordering::Less => assemble(b, a, ALL_INDEX_3),
        Ordering::Equal => assemble(a, b, 0),
    }
}

fn pack(fit: &Fit) -> [u8; BLOCK_BYTES] {
    const INDEX_OF_THIRDS: [u32; 4] = [1, 3, 2, 0];
    let index = |i: usize| INDEX_OF_THIRDS[fit.thirds[i] as usize & 3];
    assemble(fit.color0, fit.color1, (0..16).fold(0, |bits, i| bits | index(i) << (2 * i)))
}

fn assemble(color0: u16, color1: u16, indices: u32) -> [u8; BLOCK_BYTES] {
    debug_assert!(color0 > color1 || color0 == color1 && indices == 0, "not an opaque 4-colour block");
    let ([a, b], [c, d]) = (color0.to_le_bytes(), color1.to_le_bytes());
    let [e, f, g, h] = indices.to_le_bytes();
    [a, b, c, d, e, f, g, h]
}
