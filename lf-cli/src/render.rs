//! `lfslab render`: a mirror in a stored light field.

use std::path::Path;

use anyhow::{Context, Result};
use glam::Vec3;
use lf_compress::PackedLightField;
use lf_format::TexelEncoding;
use lf_gpu::{Gpu, MirrorMesh, ReflectionPass, SlabTexture, Target};
use lf_ibr::SlabField;
use lf_math::{Cell, Image, Pinhole, TriangleMesh, image_error};
use lf_scene::reference::{self, Mirror};
use lf_scene::{Scene, Tracer};

use crate::args::RenderArgs;
use crate::device::{CpuMethod, GpuMethod, Method, open_gpu, or_cpu};
use crate::frames::FOV_Y;
use crate::input::{MAX_DECODED_BYTES, load};
use crate::output::{check_writable, megabytes, png, print, write};
use crate::pictures::{ERROR_GAIN, difference, display, masked, noise, over, strip};
use crate::sources::{Loaded, builtin, from_file};

pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    check_writable(&args.out)?;
    let field = load(&args.input)?;
    let cell = *field.geometry().cell();
    let (_, mesh) = match args.reflector.as_str() {
        name @ ("sphere" | "teapot") => builtin(name, &cell)?,
        file => from_file(Path::new(file), &cell)?,
    };
    let eye = args.eye.0 * 2.0 * cell.half_extent().min_element();
    let camera = Pinhole::look_at(eye, Vec3::ZERO, FOV_Y, args.size, args.size)?;
    let on_gpu = open_gpu(args.cpu).map(|gpu| draw_on_gpu(&gpu, &field, &mesh, &camera));
    let picture = match or_cpu(on_gpu) {
        Some(picture) => picture,
        None => draw_on_cpu(&field, &mesh, &camera)?,
    };
    let (picture, note) = match &args.against {
        None => (over(&picture, &Image::filled(args.size, args.size, [40, 40, 44, 255])), String::new()),
        Some(scene) => against(&Loaded::open(scene, &args.light)?.scene, args, &cell, mesh, &camera, &picture)?,
    };
    write(&args.out, &png(&picture)?)?;
    print(&(args.out.display().to_string() + &note))
}

/// The picture beside the traced one and their difference, and what the error is.
fn against(
    scene: &Scene,
    args: &RenderArgs,
    cell: &Cell,
    mesh: TriangleMesh,
    camera: &Pinhole,
    picture: &Image<[u8; 4]>,
) -> Result<(Image<[u8; 4]>, String)> {
    let quality = args.light.quality();
    eprintln!("trace    {}: {} triangles, samples a pixel: {}", scene.name(), scene.triangles().len(), quality.samples);
    let tracer = Tracer::new(scene.clone()).with_quality(quality);
    let background = display(&reference::background(&tracer, cell, camera));
    let traced = reference::render(&tracer, cell, &Mirror::new(mesh), camera);
    let truth = masked(&display(&traced.radiance), &traced.mask, &background);
    let ours = over(picture, &background);
    let error = image_error(&truth, &ours, &traced.mask).context("the mirror is out of sight")?;
    let apart = difference(&truth, &ours);
    let title = format!("difference x{ERROR_GAIN}");
    let panels = strip(&[("ray traced", truth), ("slabs", ours), (&title, apart)]);
    let noise = match noise(traced.radiance.texels().iter().zip(traced.standard_error.texels())) {
        Some(share) if share > 0.0 => format!("; the traced picture's standard error is {:.2} %", 100.0 * share),
        _ => String::new(),
    };
    Ok((panels, format!(": {:.2} dB PSNR over the mirror's pixels{noise}", error.psnr_db())))
}

fn draw_on_gpu(gpu: &Gpu, field: &PackedLightField, mesh: &TriangleMesh, camera: &Pinhole) -> Result<Image<[u8; 4]>> {
    let texture = SlabTexture::new(gpu, field)?;
    eprintln!("slabs    {}, {}", texture.storage(), megabytes(texture.bytes()));
    let pass = ReflectionPass::slabs(gpu, &texture)?;
    let target = Target::new(gpu, camera.width(), camera.height())?;
    let mesh = MirrorMesh::new(gpu, mesh)?;
    finish(GpuMethod { gpu, pass: &pass, target: &target, mesh: &mesh, camera })
}

fn draw_on_cpu(field: &PackedLightField, mesh: &TriangleMesh, camera: &Pinhole) -> Result<Image<[u8; 4]>> {
    let geometry = field.geometry().clone();
    if field.tilings().iter().all(|tiling| tiling.encoding() == TexelEncoding::Rgb16F) {
        let environment = SlabField::new(geometry, field.decode_linear(MAX_DECODED_BYTES)?)?;
        return finish(CpuMethod::new(&environment, mesh, camera));
    }
    let environment = SlabField::new(geometry, field.decode(MAX_DECODED_BYTES)?)?;
    finish(CpuMethod::new(&environment, mesh, camera))
}

fn finish(mut method: impl Method) -> Result<Image<[u8; 4]>> {
    method.draw()?;
    method.picture()
}
