//! What the encoder and the decoder know about a block: endpoints and indices, the prediction of indices from a
//! neighbour's, and the small steps between endpoints.

use crate::bc1::BLOCK_BYTES;

/// A BC1 block as it is stored.
pub(super) type RawBlock = [u8; BLOCK_BYTES];

/// The even bits of 16 two-bit lanes.
pub(super) const EVEN: u32 = 0x5555_5555;

/// A BC1 block, taken apart.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Block {
    /// `color0` in the low, `color1` in the high 16 bits.
    pub(super) ends: u32,
    /// Two bits a texel, the first lowest.
    pub(super) indices: u32,
}

impl Block {
    #[inline(always)]
    pub(super) fn from_raw([a, b, c, d, e, f, g, h]: RawBlock) -> Self {
        Self { ends: u32::from_le_bytes([a, b, c, d]), indices: u32::from_le_bytes([e, f, g, h]) }
    }

    #[inline(always)]
    pub(super) fn to_raw(self) -> RawBlock {
        let ([a, b, c, d], [e, f, g, h]) = (self.ends.to_le_bytes(), self.indices.to_le_bytes());
        [a, b, c, d, e, f, g, h]
    }
}

/// The two endpoints as stored.
#[inline(always)]
pub(super) fn split(ends: u32) -> [u16; 2] {
    [ends as u16, (ends >> 16) as u16]
}

#[inline(always)]
pub(super) fn join([color0, color1]: [u16; 2]) -> u32 {
    u32::from(color0) | u32::from(color1) << 16
}

/// Red, green and blue of an endpoint, each about 0 to 63.
#[inline(always)]
fn levels(color: u32) -> [i32; 3] {
    [(color >> 10 & 0x3e) as i32, (color >> 5 & 0x3f) as i32, (color << 1 & 0x3e) as i32]
}

/// Indices that paint, with the endpoints `ends`, about what `neighbour` shows.
///
/// The neighbour's four colours are projected on the line through `ends`; each goes to the nearest of the four palette
/// places there. Both blocks count as 4-colour blocks, whatever the order of their endpoints: this is a guess, which
/// the decoder corrects. Integers only; nothing exceeds 2¹⁸.
#[inline(always)]
pub(super) fn transfer(ends: u32, neighbour: Block) -> u32 {
    if ends == neighbour.ends {
        return neighbour.indices;
    }
    let (a, b) = (levels(ends & 0xffff), levels(ends >> 16));
    let axis = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let dot = |v: [i32; 3]| v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2];
    let (origin, length) = (dot(b), dot(axis));
    let near = dot(levels(neighbour.ends & 0xffff)) - origin;
    let far = dot(levels(neighbour.ends >> 16)) - origin;
    // Six times the place of each palette entry along the axis, where color1 is at 0 and color0 at `length`.
    let places = [6 * near, 6 * far, 4 * near + 2 * far, 2 * near + 4 * far];
    let (low, high) = (neighbour.indices & EVEN, neighbour.indices >> 1 & EVEN);
    let lanes = [EVEN & !(low | high), low & !high, high & !low, low & high];
    let (mut low, mut high) = (0, 0);
    for (lane, place) in lanes.into_iter().zip(places) {
        // All ones where the place is beyond ⅙, ½, ⅚ of the way. The indices of 0, ⅓, ⅔ and 1 are 1, 3, 2 and 0.
        let beyond = |sixths: i32| ((sixths * length - place) >> 31) as u32;
        low |= lane & !beyond(3);
        high |= lane & (beyond(1) ^ beyond(5));
    }
    low | high << 1
}

/// Endpoint steps that one byte can say: red and blue by −2 to 2 levels, green by −4 to 4.
pub(super) const STEPS: usize = 5 * 9 * 5;
/// Stands for an endpoint that is stored as it is.
pub(super) const ESCAPE: u8 = 255;

/// What a step adds to a 565 colour as a 16-bit integer, wrapping; nothing for bytes that are no step. No channel
/// overflows where the result is a colour whose channels differ from the first one's by the step.
pub(super) const STEP_SUM: [u16; 256] = {
    let mut sums = [0; 256];
    let mut symbol = 0;
    while symbol < STEPS {
        let (red, green, blue) = (symbol as i32 / 45 - 2, symbol as i32 / 5 % 9 - 4, symbol as i32 % 5 - 2);
        sums[symbol] = (red * 2048 + green * 32 + blue) as u16;
        symbol += 1;
    }
    sums
};

/// The byte that leads from one 565 colour to another, if there is one.
pub(super) fn step(from: u16, to: u16) -> Option<u8> {
    let difference = |shift: u32, mask: u16| i32::from(to >> shift & mask) - i32::from(from >> shift & mask);
    let (red, green, blue) = (difference(11, 31), difference(5, 63), difference(0, 31));
    let small = red.abs() <= 2 && green.abs() <= 4 && blue.abs() <= 2;
    small.then_some((45 * (red + 2) + 5 * (green + 4) + blue + 2) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_lead_where_they_should() {
        for (symbol, sum) in STEP_SUM.into_iter().enumerate().take(STEPS) {
            let from = 16_u16 << 11 | 32 << 5 | 16;
            let to = from.wrapping_add(sum);
            assert_eq!(step(from, to), Some(symbol as u8));
        }
        assert_eq!(step(0, 3), None);
        assert_eq!(step(0x1f, 0x20), None, "blue 31 to 0 is no small step");
        assert_eq!(step(7, 7), Some(112));
    }

    #[test]
    fn equal_and_mirrored_endpoints_transfer_exactly() {
        let neighbour = Block { ends: join([0xf81f, 0x07e0]), indices: 0xe4e4_1b27 };
        assert_eq!(transfer(neighbour.ends, neighbour), neighbour.indices);
        // With the endpoints exchanged, every index has its lowest bit flipped.
        assert_eq!(transfer(join([0x07e0, 0xf81f]), neighbour), neighbour.indices ^ EVEN);
        assert_eq!(transfer(0, neighbour), EVEN, "endpoints without extent: all at the place of color1");
    }
}
