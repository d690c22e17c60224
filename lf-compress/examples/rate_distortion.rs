//! Bits per texel against PSNR of the tile codec, for a picture that holds a grid of camera images or for a light field.
//!
//! ```text
//! cargo run --release -p lf-compress --example rate_distortion -- atlas.png [--cameras 8x8] [--quality best]
//! cargo run --release -p lf-compress --example rate_distortion -- field.lfslab [--every 8] [--quality best]
//! ```
//!
//! prints a table and writes `target/rate-distortion.svg`. The light field must be stored as RGBA8 and whole (`lfslab
//! capture --encoding rgba8 --whole`), and every so many of its tiles are taken. PSNR is over R, G and B, as an independent decoder shows
//! the blocks; beside each size stands that of one zstd frame a tile of the same blocks, the same position of all cameras
//! side by side. Times are those of one thread.

use std::error::Error;
use std::fmt::Write;
use std::time::Instant;

use lf_compress::PackedLightField;
use lf_compress::bc1::{EncodeOptions, Quality, Texel, encode_image};
use lf_compress::format::{Container, Limits, TexelEncoding};
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

/// Texels of a grid of cameras, and their blocks at the quality asked for.
struct Tile {
    shape: TileShape,
    texels: Vec<Texel>,
    blocks: Vec<u8>,
}

/// What the command line asks for.
struct Arguments {
    path: String,
    cameras: [u32; 2],
    every: usize,
    quality: Quality,
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments = arguments()?;
    rayon::ThreadPoolBuilder::new().num_threads(1).build_global()?;
    let path = &arguments.path;
    let mut tiles = if path.ends_with(".lfslab") { light_field(&arguments)? } else { atlas(&arguments)? };
    let start = Instant::now();
    for tile in &mut tiles {
        let [width, height] = size(&tile.shape);
        let options = EncodeOptions::new(arguments.quality).repeat_blocks(tile.shape.blocks()[0]);
        tile.blocks = encode_image(width, height, &tile.texels, options)?;
    }
    let encoding = start.elapsed().as_secs_f64();
    let texels: usize = tiles.iter().map(|tile| tile.texels.len()).sum();
    println!("{path}: {texels} texels, {}, {encoding:.2} s for the blocks\n", arguments.quality.name());
    println!(
        "| λ | bits/texel | zstd {LEVEL} alone | dB | s: RDO and packing | × without |\n|--:|--:|--:|--:|--:|--:|"
    );
    let mut points: Vec<Point> = Vec::new();
    for lambda in LAMBDAS {
        let point = measure(&tiles, texels, lambda)?;
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

/// A picture as one tile.
fn atlas(arguments: &Arguments) -> Result<Vec<Tile>, Box<dyn Error>> {
    let image = image::open(&arguments.path)?.to_rgba8();
    let ((width, height), cameras) = (image.dimensions(), arguments.cameras);
    let per_camera = [width / cameras[0], height / cameras[1]];
    if [0, 1].iter().any(|&i| per_camera[i] * cameras[i] != [width, height][i] || !per_camera[i].is_multiple_of(4)) {
        return Err(format!("{width}×{height} texels are not {cameras:?} images of whole 4×4 blocks").into());
    }
    let shape = TileShape::new(cameras, per_camera.map(|n| n / 4))?;
    Ok(vec![Tile { shape, texels: image.pixels().map(|pixel| pixel.0).collect(), blocks: Vec::new() }])
}

/// Some tiles of a light field.
fn light_field(arguments: &Arguments) -> Result<Vec<Tile>, Box<dyn Error>> {
    let bytes = std::fs::read(&arguments.path)?;
    let field = PackedLightField::read(&Container::parse(&bytes, &Limits::default())?)?;
    let mut tiles = Vec::new();
    for (slab, tiling) in field.tilings().iter().enumerate() {
        if tiling.encoding() != TexelEncoding::Rgba8 {
            return Err("the light field must be stored as RGBA8: lfslab capture --encoding rgba8".into());
        }
        if !tiling.coverage().is_whole() {
            return Err("the light field must hold whole images: lfslab capture --whole".into());
        }
        for (number, raw) in tiling.stored_tiles().zip(field.tiles(slab)).step_by(arguments.every) {
            let [columns, rows] = tiling.block_windows(number);
            let shape = TileShape::windowed(&columns, &rows)?;
            let texels = raw.as_chunks::<4>().0.iter().map(|&[r, g, b, _]| [r, g, b, 255]).collect();
            tiles.push(Tile { shape, texels, blocks: Vec::new() });
        }
    }
    Ok(tiles)
}

fn arguments() -> Result<Arguments, Box<dyn Error>> {
    let mut parsed = Arguments { path: String::new(), cameras: [8, 8], every: 8, quality: Quality::Best };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} takes a value"));
        match argument.as_str() {
            "--cameras" => {
                let value = value()?;
                let (across, down) = value.split_once('x').ok_or("--cameras takes two numbers, as in 8x8")?;
                parsed.cameras = [across.parse()?, down.parse()?];
                if parsed.cameras.contains(&0) {
                    return Err("there must be a camera".into());
                }
            }
            "--every" => parsed.every = value()?.parse::<usize>()?.max(1),
            "--quality" => {
                let value = value()?.to_lowercase();
                let named = |quality: &Quality| quality.name() == value;
                parsed.quality = Quality::ALL.into_iter().find(named).ok_or("no such quality")?;
            }
            _ => parsed.path = argument,
        }
    }
    if parsed.path.is_empty() {
        return Err("usage: rate_distortion FILE.png|FILE.lfslab [--cameras 8x8] [--every 8] [--quality best]".into());
    }
    Ok(parsed)
}

/// Width and height in texels.
fn size(shape: &TileShape) -> [u32; 2] {
    [0, 1].map(|i| 4 * shape.cameras()[i] * shape.blocks()[i])
}

fn measure(tiles: &[Tile], texels: usize, lambda: f32) -> Result<Point, Box<dyn Error>> {
    let (mut packed_len, mut plain_len, mut error, mut seconds) = (0, 0, 0.0, 0.0);
    for Tile { shape, texels, blocks } in tiles {
        let mut blocks = blocks.clone();
        let start = Instant::now();
        optimise(shape, texels, &mut blocks, &RdoOptions { lambda, ..RdoOptions::default() })?;
        let packed = encode(shape, &blocks, LEVEL)?;
        seconds += start.elapsed().as_secs_f64();
        if decode(shape, &packed)? != blocks {
            return Err("what was packed did not come back".into());
        }
        packed_len += packed.len();
        plain_len += zstd::bulk::compress(&position_major(shape, &blocks), LEVEL)?.len();
        error += squared_error(shape, texels, &blocks)?;
    }
    let bits = |bytes: usize| 8.0 * bytes as f64 / texels as f64;
    let db = 10.0 * (255.0 * 255.0 * 3.0 * texels as f64 / error).log10();
    Ok(Point { lambda, tile_bits: bits(packed_len), zstd_bits: bits(plain_len), db, seconds })
}

fn position_major(shape: &TileShape, blocks: &[u8]) -> Vec<u8> {
    let ([across, down], [columns, rows]) = (shape.cameras(), shape.blocks());
    let positions = (0..rows).flat_map(|y| (0..columns).map(move |x| (x, y)));
    let cameras = positions.flat_map(|(x, y)| (0..down * across).map(move |i| (x, y, i % across, i / across)));
    let place = |(x, y, s, t): (u32, u32, u32, u32)| ((t * rows + y) * across + s) * columns + x;
    cameras.flat_map(|camera| blocks[8 * place(camera) as usize..][..8].to_vec()).collect()
}

/// Over R, G and B, as the independent decoder sees the blocks.
fn squared_error(shape: &TileShape, texels: &[Texel], blocks: &[u8]) -> Result<f64, Box<dyn Error>> {
    let [width, height] = size(shape).map(|n| n as usize);
    let mut bgra = vec![0; texels.len()];
    texture2ddecoder::decode_bc1(blocks, width, height, &mut bgra)?;
    let square = |a: u8, b: u8| f64::from(a.abs_diff(b)).powi(2);
    let error = |(seen, texel): (&u32, &Texel)| {
        let [b, g, r, _] = seen.to_le_bytes();
        square(r, texel[0]) + square(g, texel[1]) + square(b, texel[2])
    };
    Ok(bgra.iter().zip(texels).map(error).sum())
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
