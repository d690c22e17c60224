//! Our FLIP against NVIDIA's own.

use lf_math::{Image, flip};
use nv_flip::{DEFAULT_PIXELS_PER_DEGREE, FlipImageRgb8};

fn nvidias(reference: &Image<[u8; 4]>, test: &Image<[u8; 4]>) -> Vec<f32> {
    let image = |picture: &Image<[u8; 4]>| {
        let rgb: Vec<u8> = picture.texels().iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        FlipImageRgb8::with_data(picture.width(), picture.height(), &rgb)
    };
    nv_flip::flip(image(reference), image(test), DEFAULT_PIXELS_PER_DEGREE).to_vec()
}

/// Discs and waves of colour, another picture for another number; taller than wide, so that rows and columns cannot be mixed up.
fn picture(number: u32) -> Image<[u8; 4]> {
    let mut place = 0;
    Image::filled(96, 128, ()).map(|()| {
        let (x, y) = ((place % 96) as f32, (place / 96) as f32);
        place += 1;
        let turn = number as f32;
        let wave = |step: f32, phase: f32| 127.5 + 127.5 * (x * step + y * step * 0.7 + phase * (1.0 + turn)).sin();
        let disc = (x - 40.0 - 3.0 * turn).hypot(y - 60.0) < 20.0;
        let color = [wave(0.05, 0.3), wave(0.4, 1.0), wave(1.9, 2.0)];
        let [r, g, b] = color.map(|value| if disc { 255.0 - 0.3 * value } else { value } as u8);
        [r, g, b, 255]
    })
}

/// Single pixels of every colour.
fn noise(mut state: u64) -> Image<[u8; 4]> {
    Image::filled(96, 128, ()).map(|()| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let [_, _, _, _, r, g, b, _] = state.to_le_bytes();
        [r, g, b, 255]
    })
}

#[test]
fn every_pixel_is_as_nvidia_has_it() {
    let black = Image::filled(96, 128, [0, 0, 0, 255]);
    let pairs = [
        (picture(0), picture(1)),
        (picture(1), picture(4)),
        (noise(1), noise(2)),
        (picture(2), noise(3)),
        (black.clone(), picture(3)),
        (noise(4), black),
    ];
    for (number, (reference, test)) in pairs.iter().enumerate() {
        let (ours, theirs) = (flip(reference, test).unwrap(), nvidias(reference, test));
        let apart = ours.texels().iter().zip(&theirs).map(|(a, b)| (a - b).abs());
        let largest = apart.fold(0.0, f32::max);
        let mean = theirs.iter().sum::<f32>() / theirs.len() as f32;
        assert!(mean > 0.05, "pair {number} is too much alike: {mean}");
        assert!(largest < 2e-5, "pair {number}: {largest}");
    }
}
