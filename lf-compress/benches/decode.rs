//! Speed of BC1 decoding in texels per second, one thread, beside copying the output and two other decoders.
//!
//! Every answer is checked before anything is timed. Speed does not depend on the data where no decoder branches on
//! it, so the blocks are random, all with four colours as encoders of opaque images write them.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lf_compress::bc1::{
    BLOCK_BYTES, Texel, decode_image, decode_image_f32, decode_image_f32_into, decode_image_into, decode_texel,
};

const SIDE: usize = 1024;

/// Row-major 4-colour blocks of an image of `SIDE` × `SIDE` texels.
fn random_blocks() -> Vec<u8> {
    let mut state = 1_u64;
    let mut next = || {
        state = state.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
        (state >> 32) as u32
    };
    let block = |_| {
        let (a, b, indices) = ((next() >> 16) as u16, (next() >> 16) as u16, next());
        let [[c, d], [e, f]] = [a.max(b).max(1), a.min(b).min(a.max(b).max(1) - 1)].map(u16::to_le_bytes);
        let [g, h, i, j] = indices.to_le_bytes();
        [c, d, e, f, g, h, i, j]
    };
    (0..SIDE * SIDE / 16).flat_map(block).collect()
}

/// Decodes as bcdec does, a block at a time.
fn bcdec(blocks: &[u8], out: &mut [Texel]) {
    let across = SIDE / 4;
    for (i, block) in blocks.chunks_exact(BLOCK_BYTES).enumerate() {
        let first = i / across * 4 * SIDE + i % across * 4;
        bcdec_rs::bc1(block, out[first..].as_flattened_mut(), 4 * SIDE);
    }
}

fn texture2d(blocks: &[u8], out: &mut [u32]) {
    texture2ddecoder::decode_bc1a(blocks, SIDE, SIDE, out).expect("the sizes agree");
}

fn check(blocks: &[u8], texels: &[Texel]) {
    let mut bgra = vec![0; texels.len()];
    texture2d(blocks, &mut bgra);
    let agree = |word: u32, [r, g, b, a]: Texel| word.to_le_bytes() == [b, g, r, a];
    assert!(bgra.iter().zip(texels).all(|(word, texel)| agree(*word, *texel)), "texture2ddecoder disagrees");
    let mut rounded = vec![[0; 4]; texels.len()];
    bcdec(blocks, &mut rounded);
    let levels = rounded.as_flattened().iter().zip(texels.as_flattened());
    assert!(levels.into_iter().all(|(a, b)| a.abs_diff(*b) <= 1), "bcdec_rs disagrees");
    let floats = decode_image_f32(SIDE as u32, SIDE as u32, blocks).expect("the sizes agree");
    let levels = floats.as_flattened().iter().zip(texels.as_flattened());
    assert!(levels.into_iter().all(|(a, b)| *a == f32::from(*b) / 255.0), "the outputs disagree");
}

fn decoders(criterion: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");
    let side = SIDE as u32;
    let blocks = random_blocks();
    let texels = decode_image(side, side, &blocks).expect("the sizes agree");
    check(&blocks, &texels);

    let mut group = criterion.benchmark_group("bc1_decode");
    group.throughput(Throughput::Elements(texels.len() as u64));
    let mut out = vec![[0; 4]; texels.len()];
    group.bench_function("copy_rgba8", |b| b.iter(|| out.copy_from_slice(black_box(&texels))));
    group
        .bench_function("rgba8_into", |b| b.iter(|| decode_image_into(side, side, black_box(&blocks), &mut out, SIDE)));
    assert_eq!(out, texels);
    group.bench_function("bcdec_rs", |b| b.iter(|| bcdec(black_box(&blocks), &mut out)));
    let mut bgra = vec![0; texels.len()];
    group.bench_function("texture2ddecoder", |b| b.iter(|| texture2d(black_box(&blocks), &mut bgra)));
    group.bench_function("rgba8_vec", |b| b.iter(|| decode_image(side, side, black_box(&blocks))));
    let mut floats = vec![[0.0; 4]; texels.len()];
    group.bench_function("f32_into", |b| {
        b.iter(|| decode_image_f32_into(side, side, black_box(&blocks), &mut floats, SIDE));
    });
    group.finish();

    texel_by_texel(criterion, &blocks);
}

/// Texels in an order that defeats prefetching, as a renderer's look-ups are.
fn texel_by_texel(criterion: &mut Criterion, blocks: &[u8]) {
    let blocks = blocks.as_chunks::<BLOCK_BYTES>().0;
    let places: Vec<(usize, usize)> = (0..4096).map(|i| (i * 7919 % SIDE, i * 104_729 % SIDE)).collect();
    let texel = |&(x, y): &(usize, usize)| decode_texel(&blocks[y / 4 * (SIDE / 4) + x / 4], x, y);
    let mut group = criterion.benchmark_group("bc1_decode");
    group.throughput(Throughput::Elements(places.len() as u64));
    group.bench_function("single_texels", |b| {
        b.iter(|| black_box(&places).iter().map(|place| u32::from_le_bytes(texel(place))).fold(0, u32::wrapping_add));
    });
    group.finish();
}

criterion_group!(benches, decoders);
criterion_main!(benches);
