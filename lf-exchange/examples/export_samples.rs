//! Writes a sample of every export to a folder, with what is in it as plain bytes, for `tests/third_party/exchange`:
//!
//! ```sh
//! cargo run -p lf-exchange --example export_samples -- FOLDER
//! ```
//!
//! `samples.json` lists the files and what a reader should find in them; `*.bin` are the expected bytes.

use std::error::Error;
use std::fs;
use std::path::Path;

use glam::{DVec3, Vec3};
use half::f16;
use lf_exchange::{
    GridNaming, HciScene, LightField, QuiltLayout, Volume, VolumeFormat, dds, face_folder, ktx2, write_grid, write_hci,
    write_quilt, write_transforms,
};
use lf_math::{Cell, Face, LightFieldGeometry, SampledAxis, Slab, SlabTexels};
use serde_json::{Value, json};

fn main() -> Result<(), Box<dyn Error>> {
    let folder = std::env::args_os().nth(1).ok_or("usage: export_samples FOLDER")?;
    let folder = Path::new(&folder);
    fs::create_dir_all(folder)?;
    let mut samples = volumes(folder)?;
    samples.extend(fields(folder)?);
    fs::write(folder.join("samples.json"), format!("{:#}\n", json!({ "samples": samples })))?;
    Ok(())
}

/// Bytes without a pattern that a mistake in order could keep.
fn noise(seed: u32) -> impl Iterator<Item = u8> {
    let mut state = seed;
    std::iter::repeat_with(move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    })
}

/// Opaque BC1 blocks: color0 is always the larger one, so that every reader decodes four colours.
fn bc1_blocks(count: usize, seed: u32) -> Vec<u8> {
    let bytes: Vec<u8> = noise(seed).take(8 * count).collect();
    let block = |block: &[u8]| {
        let (a, b) = (u16::from_le_bytes([block[0], block[1]]), u16::from_le_bytes([block[2], block[3]]));
        let (high, low) = (a.max(b).max(1), a.min(b).min(a.max(b).max(1) - 1));
        let mut out = [high.to_le_bytes(), low.to_le_bytes(), [block[4], block[5]], [block[6], block[7]]].concat();
        out.truncate(8);
        out
    };
    bytes.chunks_exact(8).flat_map(block).collect()
}

fn float_texels(count: usize) -> Vec<u8> {
    let value = |byte: u8| f16::from_f32(f32::from(byte) / 16.0);
    noise(3).take(4 * count).flat_map(|byte| value(byte).to_le_bytes()).collect()
}

/// KTX2 and DDS files of one volume in each format.
fn volumes(folder: &Path) -> Result<Vec<Value>, Box<dyn Error>> {
    let [width, height, depth] = [12u32, 8, 5];
    let texels = (width * height * depth) as usize;
    let formats = [
        ("bc1", VolumeFormat::Bc1, bc1_blocks(texels / 16, 1)),
        ("rgba8", VolumeFormat::Rgba8, noise(2).take(4 * texels).collect()),
        ("rgba16f", VolumeFormat::Rgba16Float, float_texels(texels)),
    ];
    let mut samples = Vec::new();
    for (name, format, bytes) in formats {
        let slices = bytes.chunks_exact(bytes.len() / depth as usize).collect();
        let volume = Volume::new([width, height, depth], format, slices)?;
        fs::write(folder.join(format!("{name}.bin")), &bytes)?;
        let files = [
            ("ktx2", format!("{name}.ktx2"), ktx2::encode(&volume, ktx2::Supercompression::None)?),
            ("ktx2", format!("{name}-zstd.ktx2"), ktx2::encode(&volume, ktx2::Supercompression::Zstd(9))?),
            ("dds-volume", format!("{name}-volume.dds"), dds::encode(&volume, dds::Shape::Volume)?),
            ("dds-array", format!("{name}-array.dds"), dds::encode(&volume, dds::Shape::Array)?),
        ];
        for (kind, file, content) in files {
            fs::write(folder.join(&file), content)?;
            samples.push(json!({
                "kind": kind, "file": file, "format": name, "expected": format!("{name}.bin"),
                "size": [width, height, depth], "zstd": file.contains("zstd"),
            }));
        }
    }
    Ok(samples)
}

/// A slab of each face, with axes that differ in every number.
fn geometry() -> Result<LightFieldGeometry, Box<dyn Error>> {
    let slab = |face: Face| {
        let st = [SampledAxis::new(-0.25, 0.125, 4)?, SampledAxis::new(-0.125, 0.125, 3)?];
        let uv = [SampledAxis::spanning(-0.875, 0.875, 8)?, SampledAxis::spanning(-0.625, 0.625, 6)?];
        Slab::new(face, 0.5 * face.sign(), st, uv, Some(2.0))
    };
    let cell = Cell::new(DVec3::new(1.0, 2.0, -3.0), Vec3::splat(0.5))?;
    Ok(LightFieldGeometry::new(cell, Face::ALL.into_iter().map(slab).collect::<Result<_, _>>()?)?)
}

/// Grids of PNG and OpenEXR, an HCI folder, a quilt and a `transforms.json`.
fn fields(folder: &Path) -> Result<Vec<Value>, Box<dyn Error>> {
    let geometry = geometry()?;
    let count = 4 * 3 * 8 * 6;
    let encoded = geometry.slabs().iter().zip(10..).map(|(slab, seed)| {
        let bytes: Vec<u8> = noise(seed).take(3 * count).collect();
        SlabTexels::new(slab, bytes.chunks_exact(3).map(|c| [c[0], c[1], c[2], 255]).collect())
    });
    let encoded: Vec<SlabTexels> = encoded.collect::<Result<_, _>>()?;
    let linear = encoded.iter().zip(geometry.slabs()).map(|(texels, slab)| {
        let value = |byte: u8| f16::from_f32(f32::from(byte) / 16.0);
        SlabTexels::new(slab, texels.texels().iter().map(|&[r, g, b, _]| [r, g, b].map(value)).collect())
    });
    let linear: Vec<SlabTexels<[f16; 3]>> = linear.collect::<Result<_, _>>()?;
    let field = LightField::new(&geometry, &encoded)?;
    write_grid(&folder.join("png"), &field, GridNaming::Stanford)?;
    write_grid(&folder.join("exr"), &LightField::new(&geometry, &linear)?, GridNaming::RowColumn)?;
    write_transforms(&folder.join("nerf"), &field)?;
    let mut samples =
        vec![json!({ "kind": "transforms", "file": "nerf/transforms.json", "slabs": slab_facts(&geometry) })];
    for (i, pictures) in field.all_pictures().enumerate() {
        let name = face_folder(pictures.slab().face());
        let expected = format!("texels-{name}.bin");
        fs::write(folder.join(&expected), geometry_order(&encoded[i]))?;
        let facts =
            json!({ "face": pictures.slab().face().name(), "expected": expected, "slab": slab_facts(&geometry)[i] });
        write_hci(
            &folder.join("hci").join(name),
            &pictures,
            &HciScene { name: format!("100 % {name}"), depth_range: Some([1.0, 8.0]) },
        )?;
        let row = pictures.grid()[1] - 1;
        let layout = QuiltLayout::for_views(pictures.grid()[0]);
        let quilt = write_quilt(&folder.join("quilt"), name, &pictures, row, layout)?;
        for (kind, file) in
            [("png", format!("png/{name}")), ("exr", format!("exr/{name}")), ("hci", format!("hci/{name}"))]
        {
            samples.push(json!({ "kind": kind, "file": file, "of": facts }));
        }
        let quilt = quilt.strip_prefix(folder)?.to_string_lossy().replace('\\', "/");
        samples.push(
            json!({ "kind": "quilt", "file": quilt, "of": facts, "row": row, "tiles": [layout.columns, layout.rows] }),
        );
    }
    Ok(samples)
}

/// RGB bytes in the order of the slab: t, s, v, u.
fn geometry_order(texels: &SlabTexels) -> Vec<u8> {
    texels.texels().iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
}

/// The numbers from which a script can work out every ray by itself.
fn slab_facts(geometry: &LightFieldGeometry) -> Vec<Value> {
    let axis = |axis: SampledAxis| json!({ "first": axis.first(), "step": axis.step(), "count": axis.count() });
    let facts = |slab: &Slab| {
        let ([s, t], [u, v]) = (slab.st(), slab.uv());
        json!({
            "face": slab.face().name(), "plane": slab.plane(), "center": geometry.cell().center().to_array(),
            "s": axis(s), "t": axis(t), "u": axis(u), "v": axis(v),
        })
    };
    geometry.slabs().iter().map(facts).collect()
}
