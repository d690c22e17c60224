//! Speed of the tile codec in texels per second, one thread, beside zstd on the same blocks in the same order.
//!
//! Every answer is checked before anything is timed.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use lf_compress::bc1::{Quality, Texel, encode_image};
use lf_compress::tile::{LEVEL, RdoOptions, TileShape, decode, encode, optimise};

const CAMERAS: usize = 8;
const BLOCKS: usize = 32;
const SIDE: usize = 4 * CAMERAS * BLOCKS;

/// A room's worth of shades, edges and grain, seen by cameras a third of a texel apart.
fn texel(x: usize, y: usize) -> Texel {
    let (s, t) = (x / (4 * BLOCKS), y / (4 * BLOCKS));
    let (u, v) = (3 * (x % (4 * BLOCKS)) + s, 3 * (y % (4 * BLOCKS)) + t);
    let hash = (u as u32 / 3).wrapping_mul(0x9e37_79b1) ^ (v as u32 / 3).wrapping_mul(0x85eb_ca77);
    let grain = (hash.wrapping_mul(0xc2b2_ae3d) >> 28) as u8;
    let wave = |period: f32| 0.5 + 0.5 * (u as f32 / period).sin() * (v as f32 / (0.7 * period)).cos();
    let tile = ((u / 111 + v / 69) % 3) as u8;
    let shade = |period: f32, base: u8| base.saturating_add((wave(period) * 120.0) as u8).saturating_add(grain);
    [shade(270.0, 20 + 40 * tile), shade(183.0, 90 - 30 * tile), shade(99.0, 10 + 25 * tile), 255]
}

/// Raster places of all blocks, the same position of all cameras side by side.
fn position_major() -> Vec<usize> {
    let positions = (0..BLOCKS).flat_map(|y| (0..BLOCKS).map(move |x| (x, y)));
    let cameras = |(x, y): (usize, usize)| {
        (0..CAMERAS * CAMERAS).map(move |i| (i / CAMERAS * BLOCKS + y) * CAMERAS * BLOCKS + i % CAMERAS * BLOCKS + x)
    };
    positions.flat_map(cameras).collect()
}

/// What is left of a tile when each camera's window begins one and a half blocks after that of the one before.
fn cropped(blocks: &[u8]) -> (TileShape, Vec<u8>) {
    let start = |camera: usize| 3 * camera / 2;
    let windows: Vec<_> = (0..CAMERAS).map(|camera| start(camera) as u32..BLOCKS as u32).collect();
    let kept = |n: usize| n % BLOCKS >= start(n / BLOCKS);
    let across = CAMERAS * BLOCKS;
    let blocks = blocks.as_chunks::<8>().0.iter().enumerate().filter(|(n, _)| kept(n % across) && kept(n / across));
    let shape = TileShape::windowed(&windows, &windows).expect("not empty");
    (shape, blocks.flat_map(|(_, block)| *block).collect())
}

fn codec(criterion: &mut Criterion) {
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global().expect("no pool was made before");
    let shape = TileShape::new([CAMERAS as u32; 2], [BLOCKS as u32; 2]).expect("not empty");
    let texels: Vec<Texel> = (0..SIDE * SIDE).map(|i| texel(i % SIDE, i / SIDE)).collect();
    let blocks = encode_image(SIDE as u32, SIDE as u32, &texels, Quality::Standard).expect("the sizes agree");
    let optimised = |lambda| {
        let mut blocks = blocks.clone();
        let options = RdoOptions { lambda, ..RdoOptions::default() };
        optimise(&shape, &texels, &mut blocks, &options).expect("the sizes agree");
        blocks
    };

    let mut group = criterion.benchmark_group("tile");
    group.throughput(Throughput::Elements(texels.len() as u64)).sample_size(10);
    group.bench_function("optimise", |b| b.iter(|| optimised(black_box(10.0))));
    let places = position_major();
    for (name, blocks) in [("lossless", blocks.clone()), ("lambda_10", optimised(10.0))] {
        let pack = || encode(&shape, black_box(&blocks), LEVEL).expect("the sizes agree");
        let ordered: Vec<u8> = places.iter().flat_map(|place| blocks.as_chunks::<8>().0[*place]).collect();
        let plain_pack = || zstd::bulk::compress(black_box(&ordered), LEVEL).expect("zstd packs");
        let (packed, plain) = (pack(), plain_pack());
        let unpack = || decode(&shape, black_box(&packed)).expect("it was packed just now");
        let plain_unpack = || {
            let ordered = zstd::bulk::decompress(black_box(&plain), blocks.len()).expect("it was packed just now");
            let mut raster = vec![[0; 8]; places.len()];
            for (place, block) in places.iter().zip(ordered.as_chunks().0) {
                raster[*place] = *block;
            }
            raster.into_flattened()
        };
        assert!(unpack() == blocks && plain_unpack() == blocks, "what was packed must come back");
        let bits = |bytes: &[u8]| 8.0 * bytes.len() as f64 / texels.len() as f64;
        println!("tile/{name}: {:.3} bits a texel, zstd {:.3}", bits(&packed), bits(&plain));
        group.bench_function(format!("encode_{name}"), |b| b.iter(pack));
        group.bench_function(format!("encode_{name}_zstd"), |b| b.iter(plain_pack));
        group.bench_function(format!("decode_{name}"), |b| b.iter(unpack));
        group.bench_function(format!("decode_{name}_zstd"), |b| b.iter(plain_unpack));
    }
    let (shape, blocks) = cropped(&blocks);
    let packed = encode(&shape, &blocks, LEVEL).expect("the sizes agree");
    let unpack = || decode(&shape, black_box(&packed)).expect("it was packed just now");
    assert!(unpack() == blocks, "what was packed must come back");
    println!("tile/cropped: {:.3} bits a texel", packed.len() as f64 / blocks.len() as f64 * 4.0);
    group.throughput(Throughput::Elements(2 * blocks.len() as u64));
    group.bench_function("decode_cropped", |b| b.iter(unpack));
    group.finish();
}

criterion_group!(benches, codec);
criterion_main!(benches);
