//! `lfslab export` and `lfslab import`: other people's formats.

use std::path::Path;

use anyhow::{Context, Result, bail};
use half::f16;
use lf_compress::PackedLightField;
use lf_exchange::dds::Shape;
use lf_exchange::ktx2::Supercompression;
use lf_exchange::{
    GridNaming, HciScene, ImportOptions, Imported, Lens, LightField, QuiltLayout, SlabPictures, Texel, Texels, Volume,
    VolumeFormat, dds, import, ktx2, write_grid, write_hci, write_quilt, write_transforms,
};
use lf_format::{Metadata, TexelEncoding};
use lf_math::{Cell, Coverage, Face, LightFieldGeometry, SlabTexels};

use crate::exchange_args::{ExportArgs, ExportFormat, ImportArgs};
use crate::input::{MAX_DECODED_BYTES, load, open};
use crate::output::{check_writable, megabytes, print, write};
use crate::plan;

/// zstd's level in KTX2 files.
const KTX2_LEVEL: i32 = 19;

pub(crate) fn run_export(args: &ExportArgs) -> Result<()> {
    let field = load(&args.input)?;
    let linear = field.tilings().iter().all(|tiling| tiling.encoding() == TexelEncoding::Rgb16F);
    match args.to {
        ExportFormat::Ktx2 | ExportFormat::Dds | ExportFormat::DdsArray => export_volume(args, &field)?,
        _ if linear => export_linear(args, &field, &field.decode_linear(MAX_DECODED_BYTES)?)?,
        _ => export_srgb(args, &field, &field.decode(MAX_DECODED_BYTES)?)?,
    }
    print(&args.out.display().to_string())
}

/// The volume texture of whole images: others cannot know of windows.
fn export_volume(args: &ExportArgs, field: &PackedLightField) -> Result<()> {
    check_writable(&args.out)?;
    let whole = field.whole(MAX_DECODED_BYTES)?;
    let format = match whole.tilings()[0].encoding() {
        TexelEncoding::Bc1 => VolumeFormat::Bc1,
        TexelEncoding::Rgba8 => VolumeFormat::Rgba8,
        _ => VolumeFormat::Rgba16Float,
    };
    let slices = whole.volume_slices(MAX_DECODED_BYTES)?;
    let volume = Volume::new(whole.layout().size(), format, slices.iter().map(Vec::as_slice).collect())?;
    let bytes = match args.to {
        ExportFormat::Ktx2 => ktx2::encode(&volume, Supercompression::Zstd(KTX2_LEVEL))?,
        ExportFormat::Dds => dds::encode(&volume, Shape::Volume)?,
        _ => dds::encode(&volume, Shape::Array)?,
    };
    write(&args.out, &bytes)
}

fn export_linear(args: &ExportArgs, field: &PackedLightField, texels: &[SlabTexels<[f16; 3]>]) -> Result<()> {
    let field = LightField::new(field.geometry(), texels)?;
    match args.to {
        ExportFormat::Hci | ExportFormat::Quilt => {
            bail!("this format has 8 bits a channel, the light field has half floats")
        }
        _ => export_pictures(args, &field),
    }
}

fn export_srgb(args: &ExportArgs, field: &PackedLightField, texels: &[SlabTexels]) -> Result<()> {
    let field = LightField::new(field.geometry(), texels)?;
    match args.to {
        ExportFormat::Hci => {
            let metadata = open(&args.input)?.metadata().clone();
            let name = metadata.get("scene").unwrap_or("light field").to_owned();
            Ok(write_hci(&args.out, &one_slab(args, &field)?, &HciScene { name, depth_range: args.depth_range })?)
        }
        ExportFormat::Quilt => {
            let pictures = one_slab(args, &field)?;
            let [views, rows] = pictures.grid();
            let layout = args.quilt.map_or(QuiltLayout::for_views(views), |quilt| quilt.0);
            let name = args.input.file.file_stem().unwrap_or_default().to_string_lossy();
            write_quilt(&args.out, &name, &pictures, args.row.unwrap_or(rows / 2), layout)?;
            Ok(())
        }
        _ => export_pictures(args, &field),
    }
}

fn export_pictures<T: Texel>(args: &ExportArgs, field: &LightField<'_, T>) -> Result<()> {
    match args.to {
        ExportFormat::Transforms => write_transforms(&args.out, field)?,
        ExportFormat::PlainGrid => write_grid(&args.out, field, GridNaming::RowColumn)?,
        _ => write_grid(&args.out, field, GridNaming::Stanford)?,
    }
    Ok(())
}

fn one_slab<'a, T: Texel>(args: &ExportArgs, field: &LightField<'a, T>) -> Result<SlabPictures<'a, T>> {
    let position = slab_of(field.geometry(), args.face).context("this format holds one slab")?;
    Ok(field.pictures(position)?)
}

/// The position of the slab that was asked for, or of the only one.
pub(crate) fn slab_of(geometry: &LightFieldGeometry, face: Option<Face>) -> Result<usize> {
    let slabs = geometry.slabs();
    let names: Vec<&str> = slabs.iter().map(|slab| slab.face().name()).collect();
    let position = match face {
        None if slabs.len() == 1 => Some(0),
        None => None,
        Some(face) => slabs.iter().position(|slab| slab.face() == face),
    };
    position.with_context(|| format!("choose a slab by --face: {}", names.join(", ")))
}

pub(crate) fn run_import(args: &ImportArgs) -> Result<()> {
    check_writable(&args.out)?;
    if let Some(plan) = plan::plan_file(args) {
        return plan::import(args, &plan);
    }
    if args.from_plan.srgb {
        bail!("--srgb is for pictures of a plan; give it by --plan");
    }
    let imported = import(&args.path, &options(args)?)?;
    for note in &imported.notes {
        eprintln!("note: {note}");
    }
    if imported.missing_count() > 0 {
        eprintln!("note: {} cameras have no picture", imported.missing_count());
    }
    let slab = &imported.geometry.slabs()[0];
    let ([s, t], [u, v], depth) = (slab.cameras(), slab.resolution(), slab.focal_depth());
    let focus = depth.map_or("infinity".to_owned(), |depth| format!("{depth:.3} m"));
    eprintln!("import   {}: {s}×{t} cameras of {u}×{v} texels, focus {focus}", slab.face().name());
    let field = encode(args, &imported)?;
    let bytes = field.save(&args.out, metadata(args)?)?;
    print(&format!("{}: {}", args.out.display(), megabytes(bytes)))
}

fn options(args: &ImportArgs) -> Result<ImportOptions> {
    let mut options = ImportOptions::default();
    options.face = args.face;
    let lens = args.fov.map(|degrees| Lens::FieldOfView(degrees.to_radians()));
    options.lens = lens.or(args.focal_length.map(Lens::FocalLength));
    options.aspect = args.aspect;
    options.spacing = args.spacing;
    options.focal_plane = args.focal_plane;
    options.plane = args.plane;
    options.cell = args.cell.map(|cell| Cell::cube(cell.center, cell.size)).transpose().context("--cell")?;
    options.quilt = args.quilt.map(|quilt| quilt.0);
    options.series.clone_from(&args.series);
    options.rows_upwards = args.rows_upwards;
    options.columns_leftwards = args.columns_leftwards;
    options.max_bytes = args.max_memory.saturating_mul(1 << 20);
    Ok(options)
}

/// Encodes the pictures that there are.
fn encode(args: &ImportArgs, imported: &Imported) -> Result<PackedLightField> {
    let geometry = imported.geometry.clone();
    let kept = imported.missing.iter().map(|missing| !missing).collect();
    let coverage = Coverage::whole(&geometry.slabs()[0]).with_cameras(kept)?;
    match &imported.texels {
        Texels::Srgb8(texels) => {
            let texels = [texels.crop(coverage)?];
            let (encoding, options) = args.encoding.options();
            Ok(PackedLightField::encode_with(geometry, &texels, encoding, &options)?)
        }
        Texels::Linear16(texels) => {
            eprintln!("note: the pictures are linear; they are stored as half floats");
            Ok(PackedLightField::encode_linear(geometry, &[texels.crop(coverage)?])?)
        }
    }
}

/// What is said about the file, and by whom.
pub(crate) fn metadata(args: &ImportArgs) -> Result<Metadata> {
    let mut metadata = Metadata::new();
    metadata.insert("generator", concat!("lfslab ", env!("CARGO_PKG_VERSION")))?;
    metadata.insert("scene", name(&args.path))?;
    let given = [("license", &args.license), ("attribution", &args.attribution)];
    for (key, value) in given.into_iter().filter_map(|(key, value)| Some((key, value.as_deref()?))) {
        metadata.insert(key, value).with_context(|| format!("--{key}"))?;
    }
    Ok(metadata)
}

/// The last part of a path, without what metadata may not hold.
fn name(path: &Path) -> String {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
    name.chars().filter(|c| !c.is_control()).collect()
}
