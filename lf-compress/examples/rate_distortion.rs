//! Bits per texel against PSNR of the tile codec, for a picture that holds a grid of camera images.
//!
//! ```text
//! cargo run --release -p lf-compress --example rate_distortion -- atlas.png [--cameras 8x8] [--quality best]
//! ```
//!
//! prints a table and writes `target/rate-distortion.svg`. PSNR is over R, G and B, as an independent
//! decoder shows the blocks; beside each size stands that of one zstd frame of the same blocks, the same position of all
//! cameras side by side. Times are those of one thread.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use lf_compress::bc1::{Quality, Texel, encode_image};
use lf_compress::tile::{LEVEL, RdoOptions, TileShape, decode, encode, optimise};

const LAMBDAS: [f32; 10] = [0.0, 1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0];

const PLOT: &str = "target/rate-distortion.svg";

/// One line of the table.
struct Point {
    lambda: f32,
    tile_bits: f64,
    zstd_bits: f64,
    db: f64,
    seconds: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let (path, cameras, quality) = arguments()?;
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let image = image::open(&path)?.to_rgba8();
    let (width, height) = image.dimensions();
    let texels: Vec<Texel> = image.pixels().map(|pixel| pixel.0).collect();
    let per_camera = [width / cameras[0], height / cameras[1]];
    if [0, 1].iter().any(|&i| per_camera[i] * cameras[i] != [width, height][i] || !per_camera[i].is_multiple_of(4)) {
        return Err(format!("{width}×{height} texels are not {cameras:?} images of whole 4×4 blocks").into());
    }
    let shape = TileShape::new(cameras, per_camera.map(|n| n / 4))?;

    let start = Instant::now();
    let blocks = encode_image(width, height, &texels, quality)?;
    let encoding = start.elapsed().as_secs_f64();
    println!("{path}: {width}×{height} texels, {quality:?}, {encoding:.2} s for the blocks\n");
    println!(
        "| λ | bits/texel | zstd {LEVEL} alone | dB | s: RDO and packing | × without |\n|--:|--:|--:|--:|--:|--:|"
    );
    let mut points: Vec<Point> = Vec::new();
    for lambda in LAMBDAS {
        let point = measure(&shape, &texels, &blocks, lambda)?;
        let without = encoding + points.first().map_or(point.seconds, |first: &Point| first.seconds);
        let times = (encoding + point.seconds) / without;
        let Point { tile_bits, zstd_bits, db, seconds, .. } = &point;
        println!("| {lambda} | {tile_bits:.3} | {zstd_bits:.3} | {db:.2} | {seconds:.2} | {times:.2} |");
        points.push(point);
    }
    std::fs::create_dir_all("target")?;
    std::fs::write(PLOT, svg(&points)?)?;
    println!("\n{PLOT}: the same as a plot");
    Ok(())
}

fn arguments() -> Result<(String, [u32; 2], Quality), Box<dyn Error>> {
    let (mut path, mut cameras, mut quality) = (None, [8, 8], Quality::Best);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--cameras" => {
                let value = arguments.next().unwrap_or_default();
                let (across, down) = value.split_once('x').ok_or("--cameras takes two numbers, as in 8x8")?;
                cameras = [across.parse()?, down.parse()?];
                if cameras.contains(&0) {
                    return Err("there must be a camera".into());
                }
            }
            "--quality" => {
                let value = arguments.next().unwrap_or_default().to_lowercase();
                let named = |quality: &Quality| format!("{quality:?}").to_lowercase() == value;
                quality = Quality::ALL.into_iter().find(named).ok_or("no such quality")?;
            }
            _ => path = Some(argument),
        }
    }
    Ok((path.ok_or("usage: rate_distortion atlas.png [--cameras 8x8] [--quality best]")?, cameras, quality))
}

fn measure(shape: &TileShape, texels: &[Texel], blocks: &[u8], lambda: f32) -> Result<Point, Box<dyn Error>> {
    let mut blocks = blocks.to_vec();
    let start = Instant::now();
    optimise(shape, texels, &mut blocks, &RdoOptions { lambda, ..RdoOptions::default() })?;
    let packed = encode(shape, &blocks, LEVEL)?;
    let seconds = start.elapsed().as_secs_f64();
    if decode(shape, &packed)? != blocks {
        return Err("what was packed did not come back".into());
    }
    let plain = zstd::bulk::compress(&position_major(shape, &blocks), LEVEL)?;
    let bits = |bytes: usize| 8.0 * bytes as f64 / texels.len() as f64;
    let db = psnr(shape, texels, &blocks)?;
    Ok(Point { lambda, tile_bits: bits(packed.len()), zstd_bits: bits(plain.len()), db, seconds })
}

fn position_major(shape: &TileShape, blocks: &[u8]) -> Vec<u8> {
    let ([across, down], [columns, rows]) = (shape.cameras(), shape.blocks());
    let positions = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let cameras = positions.flat_map(|(x, y)| (0..down * across).map(move |i| (x, y, i % across, i / across)));
    let place = |(x, y, s, t): (u32, u32, u32, u32)| ((t * rows + y) * across + s) * columns + x;
    cameras.flat_map(|camera| blocks[8 * place(camera) as usize..][..8].to_vec()).collect()
}

fn psnr(shape: &TileShape, texels: &[Texel], blocks: &[u8]) -> Result<f64, Box<dyn Error>> {
    let [width, height] = [0, 1].map(|i| 4 * (shape.cameras()[i] * shape.blocks()[i]) as usize);
    let mut bgra = vec![0; texels.len()];
    texture2ddecoder::decode_bc1(blocks, width, height, &mut bgra)?;
    let square = |a: u8, b: u8| f64::from(a.abs_diff(b)).powi(2);
    let error = |(seen, texel): (&u32, &Texel)| {
        let [b, g, r, _] = seen.to_le_bytes();
        square(r, texel[0]) + square(g, texel[1]) + square(b, texel[2])
    };
    let sum: f64 = bgra.iter().zip(texels).map(error).sum();
    Ok(10.0 * (255.0 * 255.0 * 3.0 * texels.len() as f64 / sum).log10())
}

/// Two lines, the tile codec's and that of zstd alone, with their λ.
fn svg(points: &[Point]) -> Result<String, std::fmt::Error> {
    let most_bits = points.iter().map(|point| point.zstd_bits.max(point.tile_bits)).fold(0.5, f64::max).ceil();
    let (low, high) = points.iter().fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p.db), high.max(p.db)));
    let (low, high) = (low.floor(), high.ceil().max(low.floor() + 1.0));
    let x = |bits: f64| 60.0 + 640.0 * bits / most_bits;
    let y = |db: f64| 420.0 - 380.0 * (db - low) / (high - low);
    let mut out = String::from(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 480" font-family="sans-serif" font-size="13">
<rect width="720" height="480" fill="#fff"/>
<text x="380" y="465" text-anchor="middle">bits per texel</text>
<text x="60" y="24">PSNR, dB. Blue: tile codec, orange: zstd alone on the same blocks; numbers are λ</text>
"##,
    );
    for db in low as i32..=high as i32 {
        let y = y(f64::from(db));
        writeln!(out, r##"<path d="M60 {y:.1}H700" stroke="#e3e7ee"/><text x="34" y="{:.1}">{db}</text>"##, y + 4.0)?;
    }
    for tenths in (0..=(10.0 * most_bits) as u32).step_by(5) {
        let bits = f64::from(tenths) / 10.0;
        writeln!(out, r##"<text x="{:.1}" y="440" text-anchor="middle">{bits:.1}</text>"##, x(bits))?;
    }
    type Bits = fn(&Point) -> f64;
    let lines: [(&str, Bits); 2] = [("#d55e00", |p| p.zstd_bits), ("#0072b2", |p| p.tile_bits)];
    for (color, bits) in lines {
        let path: Vec<String> = points.iter().map(|p| format!("{:.1},{:.1}", x(bits(p)), y(p.db))).collect();
        writeln!(out, r#"<polyline points="{}" fill="none" stroke="{color}" stroke-width="2"/>"#, path.join(" "))?;
        for point in points {
            let (x, y) = (x(bits(point)), y(point.db));
            writeln!(out, r#"<circle cx="{x:.1}" cy="{y:.1}" r="4" fill="{color}"/>"#)?;
            writeln!(out, r#"<text x="{:.1}" y="{:.1}" font-size="11">{}</text>"#, x + 6.0, y + 12.0, point.lambda)?;
        }
    }
    out.push_str("</svg>\n");
    Ok(out)
}
