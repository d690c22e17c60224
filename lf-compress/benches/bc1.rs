//! Speed of the BC1 encoder in texels per second, one thread, on a textured image made here.
//!
//! Every answer is checked with an independent decoder before anything is timed.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lf_compress::bc1::{Quality, Texel, encode_image};

const SIDE: u32 = 512;

/// Smooth shading, hard edges and fine grain: what rendered rooms are made of.
fn textured(x: u32, y: u32) -> Texel {
    let hash = x.wrapping_mul(0x9e37_79b1) ^ y.wrapping_mul(0x85eb_ca77);
    let grain = (hash.wrapping_mul(0xc2b2_ae3d) >> 28) as u8;
    let tile = ((x / 37 + y / 23) % 3) as u8;
    let wave = |period: f32| 0.5 + 0.5 * (x as f32 / period).sin() * (y as f32 / (0.7 * period)).cos();
    let shade = |period: f32, base: u8| base.saturating_add((wave(period) * 120.0) as u8).saturating_add(grain);
    [shade(90.0, 20 + 40 * tile), shade(61.0, 90 - 30 * tile), shade(33.0, 10 + 25 * tile), 255]
}

/// PSNR over R, G and B, of blocks as the independent decoder sees them.
fn psnr(blocks: &[u8], texels: &[Texel]) -> f64 {
    let mut bgra = vec![0; texels.len()];
    texture2ddecoder::decode_bc1a(blocks, SIDE as usize, SIDE as usize, &mut bgra).expect("the sizes agree");
    let rgba = |word: u32| {
        let [b, g, r, a] = word.to_le_bytes();
        [r, g, b, a]
    };
    let square = |a: u8, b: u8| f64::from(a.abs_diff(b)).powi(2);
    let error: f64 =
        bgra.into_iter().map(rgba).zip(texels).map(|(s, t)| (0..3).map(|c| square(s[c], t[c])).sum::<f64>()).sum();
    10.0 * (255.0 * 255.0 * 3.0 * texels.len() as f64 / error).log10()
}

fn encoder(criterion: &mut Criterion) {
    let texels: Vec<Texel> = (0..SIDE * SIDE).map(|i| textured(i % SIDE, i / SIDE)).collect();
    let encode = |quality| encode_image(SIDE, SIDE, &texels, quality).expect("the sizes agree");
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");

    let mut group = criterion.benchmark_group("bc1");
    group.throughput(Throughput::Elements(texels.len() as u64));
    for quality in Quality::ALL {
        let db = psnr(&encode(quality), &texels);
        assert!(db > 31.0, "{quality:?} reaches only {db:.2} dB");
        println!("bc1/encode_{quality:?}: {db:.3} dB");
        group.bench_function(format!("encode_{quality:?}"), |b| b.iter(|| encode(black_box(quality))));
    }
    group.finish();
}

criterion_group!(benches, encoder);
criterion_main!(benches);
