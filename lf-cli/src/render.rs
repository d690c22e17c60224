//! `lfslab render`: a mirror in a stored light field.

use anyhow::Result;
use glam::Vec3;
use lf_gpu::{MirrorMesh, ReflectionPass, SlabTexture, Target};
use lf_ibr::SlabField;
use lf_math::{Image, Pinhole};

use crate::args::RenderArgs;
use crate::device::{CpuMethod, GpuMethod, Method, open_gpu};
use crate::frames::FOV_Y;
use crate::info::load;
use crate::output::{png, write};
use crate::pictures::over;
use crate::sources::reflector;

pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    let field = load(&args.file)?;
    let cell = *field.geometry().cell();
    let (_, mesh) = reflector(&args.reflector, &cell)?;
    let eye = args.eye.0 * 2.0 * cell.half_extent().min_element();
    let camera = Pinhole::look_at(eye, Vec3::ZERO, FOV_Y, args.size, args.size)?;
    let picture = match open_gpu(args.cpu) {
        Some(gpu) => {
            let texture = SlabTexture::new(&gpu, &field)?;
            eprintln!("slabs    {}", texture.storage());
            let pass = ReflectionPass::slabs(&gpu, &field, &texture)?;
            let target = Target::new(&gpu, args.size, args.size)?;
            let mesh = MirrorMesh::new(&gpu, &mesh)?;
            finish(GpuMethod { gpu: &gpu, pass: &pass, target: &target, mesh: &mesh, camera: &camera })?
        }
        None => {
            let environment = SlabField::new(field.geometry().clone(), field.decode()?)?;
            finish(CpuMethod::new(&environment, &mesh, &camera))?
        }
    };
    let grey = Image::filled(args.size, args.size, [40, 40, 44, 255]);
    write(&args.out, &png(&over(&picture, &grey))?)?;
    println!("{}", args.out.display());
    Ok(())
}

fn finish(mut method: impl Method) -> Result<Image<[u8; 4]>> {
    method.draw()?;
    method.picture()
}
