//! `lfslab render`: a mirror in a stored light field.

use std::path::Path;

use anyhow::Result;
use glam::Vec3;
use lf_compress::PackedLightField;
use lf_format::TexelEncoding;
use lf_gpu::{Gpu, MirrorMesh, ReflectionPass, SlabTexture, Target};
use lf_ibr::SlabField;
use lf_math::{Image, Pinhole, TriangleMesh};

use crate::args::RenderArgs;
use crate::device::{CpuMethod, GpuMethod, Method, open_gpu, or_cpu};
use crate::frames::FOV_Y;
use crate::input::{MAX_DECODED_BYTES, load};
use crate::output::{check_writable, megabytes, png, print, write};
use crate::pictures::over;
use crate::sources::{builtin, from_file};

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
    let grey = Image::filled(args.size, args.size, [40, 40, 44, 255]);
    write(&args.out, &png(&over(&picture, &grey))?)?;
    print(&args.out.display().to_string())
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
