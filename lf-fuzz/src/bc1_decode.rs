//! Any blocks, any size, any stride: no panic, and the same texels block by block, by image and in `f32`.

use arbitrary::{Arbitrary, Unstructured};
use lf_compress::bc1::{decode_block, decode_image, decode_image_f32_into, decode_image_into, decode_texel};

#[derive(Arbitrary, Debug)]
struct Input {
    width: u8,
    height: u8,
    gap: u8,
    blocks: Vec<u8>,
}

/// See the module.
pub fn run(data: &[u8]) {
    let Ok(input) = Input::arbitrary_take_rest(Unstructured::new(data)) else { return };
    let (width, height) = (usize::from(input.width), usize::from(input.height));
    let stride = width + usize::from(input.gap);
    let decoded = decode_image(u32::from(input.width), u32::from(input.height), &input.blocks);
    let mut into = vec![[7; 4]; stride * height];
    let mut floats = vec![[7.0; 4]; stride * height];
    let size = (u32::from(input.width), u32::from(input.height));
    let result = decode_image_into(size.0, size.1, &input.blocks, &mut into, stride);
    assert_eq!(result.is_ok(), decoded.is_ok());
    assert_eq!(decode_image_f32_into(size.0, size.1, &input.blocks, &mut floats, stride).is_ok(), decoded.is_ok());
    let Ok(decoded) = decoded else { return };
    for (i, texel) in decoded.iter().enumerate() {
        let (x, y) = (i % width, i / width);
        let (block, _) = input.blocks[8 * (y / 4 * width.div_ceil(4) + x / 4)..].split_first_chunk().expect("checked");
        assert_eq!(decode_texel(block, x, y), *texel);
        assert_eq!(decode_block(block)[4 * (y % 4) + x % 4], *texel);
        assert_eq!(into[y * stride + x], *texel);
        assert_eq!(floats[y * stride + x], texel.map(|v| f32::from(v) / 255.0));
    }
}
