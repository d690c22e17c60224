//! `lfslab render`: a mirror in a stored light field.

use std::path::Path;

use anyhow::{Context, Result, bail};
use glam::Vec3;
use image::ImageReader;
use lf_compress::PackedLightField;
use lf_format::TexelEncoding;
use lf_gpu::{Frame, Gpu, MirrorMesh, NormalMapTexture, SceneMesh, SlabRenderer, SlabTexture, Target};
use lf_ibr::{Behind, SlabField, Texel, draw_frame};
use lf_math::{Cell, Image, LitMesh, NormalMap, Pinhole, Placement, Reflectance, TriangleMesh, View, image_error};
use lf_scene::reference::{self, Mirror};
use lf_scene::{Scene, rasterised};

use crate::args::{BackgroundArg, ReflectorArg, RenderArgs, ViewArg};
use crate::device::{open_gpu, or_cpu};
use crate::frames::FOV_Y;
use crate::input::{MAX_DECODED_BYTES, load};
use crate::output::{check_writable, megabytes, png, print, write};
use crate::pictures::{ERROR_GAIN, difference, display, masked, noise, over, strip};
use crate::sources::{Loaded, placed};

/// A reflector, ready to be drawn.
struct Placed {
    mesh: TriangleMesh,
    placement: Placement,
}

/// What is drawn of a light field.
struct Request<'a> {
    field: &'a PackedLightField,
    placed: &'a [Placed],
    reflectance: Reflectance,
    normal_map: Option<&'a NormalMap>,
    behind: Behind<'a>,
    view: View,
    camera: &'a Pinhole,
}

pub(crate) fn run(args: &RenderArgs) -> Result<()> {
    check_writable(&args.out)?;
    let field = load(&args.input)?;
    let cell = *field.geometry().cell();
    let placed = args.reflector.iter().map(|arg| place(arg, &cell)).collect::<Result<Vec<_>>>()?;
    let edge = 2.0 * cell.half_extent().min_element();
    let camera = Pinhole::look_at(args.eye.0 * edge, Vec3::ZERO, FOV_Y, args.size, args.size)?;
    let normal_map =
        args.normal_map.as_ref().map(|path| read_normal_map(path, args.normal_repeats / edge)).transpose()?;
    let scene = scene_behind(args, &cell)?;
    let request = Request {
        field: &field,
        placed: &placed,
        reflectance: Reflectance::new(args.tint.0, args.fresnel)?,
        normal_map: normal_map.as_ref(),
        behind: match (&scene, args.background) {
            (Some(scene), _) => Behind::Scene(scene),
            (None, BackgroundArg::Slabs) => Behind::Environment,
            (None, _) => Behind::Nothing,
        },
        view: args.view.view(),
        camera: &camera,
    };
    let on_gpu = open_gpu(args.cpu).map(|gpu| draw_on_gpu(&gpu, &request));
    let picture = match or_cpu(on_gpu) {
        Some(picture) => picture,
        None => draw_on_cpu(&request)?,
    };
    let (picture, note) = match &args.against {
        None => {
            let note = if request.view == View::Range { range_note(&picture) } else { String::new() };
            (over(&picture, &Image::filled(args.size, args.size, [40, 40, 44, 255])), note)
        }
        Some(scene) => {
            let [Placed { mesh, placement }] = &placed[..] else { bail!("--against takes one --reflector") };
            let mesh = mesh.placed(placement)?;
            against(&Loaded::open(scene, &args.light)?.scene, args, &cell, mesh, &camera, &picture)?
        }
    };
    write(&args.out, &png(&picture)?)?;
    print(&(args.out.display().to_string() + &note))
}

fn place(arg: &ReflectorArg, cell: &Cell) -> Result<Placed> {
    placed(arg, cell).map(|(mesh, placement)| Placed { mesh, placement })
}

/// The scene's triangles with their light, if they are asked for.
fn scene_behind(args: &RenderArgs, cell: &Cell) -> Result<Option<LitMesh>> {
    let Some(scene) = args.scene.as_ref().filter(|_| args.background == BackgroundArg::Scene) else {
        if args.scene.is_some() {
            bail!("--scene is for --background scene");
        }
        return Ok(None);
    };
    let tracer = args.light.tracer(Loaded::open(scene, &args.light)?.scene);
    let edge = args.scene_edge * 2.0 * cell.half_extent().min_element();
    let mesh = rasterised(&tracer, cell, edge).context("--scene-edge")?;
    let [triangles, corners] = [mesh.triangles().len(), mesh.positions().len()];
    eprintln!("scene    {scene}: {triangles} triangles with edges of at most {edge:.3} m, {corners} corners traced");
    Ok(Some(mesh))
}

/// A picture of normals.
fn read_normal_map(path: &Path, repeats: f32) -> Result<NormalMap> {
    let read = || Ok::<_, image::ImageError>(ImageReader::open(path)?.with_guessed_format()?.decode()?.to_rgba8());
    let picture = read().with_context(|| path.display().to_string())?;
    let texels = picture.pixels().map(|texel| texel.0).collect();
    Ok(NormalMap::new(Image::new(picture.width(), picture.height(), texels)?, repeats)?)
}

/// How many of the rays drawn lie outside the slabs.
fn range_note(picture: &Image<[u8; 4]>) -> String {
    let [r, g, b] = View::OUTSIDE.to_array().map(|c| (255.0 * c) as u8);
    let count = |test: &dyn Fn(&&[u8; 4]) -> bool| picture.texels().iter().filter(test).count();
    let (outside, all) = (count(&|texel| **texel == [r, g, b, 255]), count(&|texel| texel[3] != 0));
    format!(": {outside} of {all} rays lie outside the slabs")
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
    let tracer = args.light.tracer(scene.clone());
    let (triangles, samples) = (scene.triangles().len(), tracer.quality().samples);
    eprintln!("trace    {}: {triangles} triangles, samples a pixel: {samples}", scene.name());
    let background = display(&reference::background(&tracer, cell, camera));
    let traced = reference::render(&tracer, cell, &Mirror::new(mesh), camera);
    let truth = masked(&display(&traced.radiance), &traced.mask, &background);
    let ours = over(picture, &background);
    let error = image_error(&truth, &ours, &traced.mask).context("the mirror is out of sight")?;
    let apart = difference(&truth, &ours);
    let title = format!("difference x{ERROR_GAIN}");
    let panels = strip(&[("ray traced", truth), ("slabs", ours), (&title, apart)]);
    let noise = match noise(traced.radiance.texels().iter().zip(traced.standard_error.texels())) {
        Some(share) if share > 0.0 => {
            format!("; the traced picture's standard error is at most {:.2} %", 100.0 * share)
        }
        _ => String::new(),
    };
    Ok((panels, format!(": {:.2} dB PSNR over the mirror's pixels{noise}", error.psnr_db())))
}

fn draw_on_gpu(gpu: &Gpu, request: &Request<'_>) -> Result<Image<[u8; 4]>> {
    let texture = SlabTexture::new(gpu, request.field)?;
    eprintln!("slabs    {}, {}", texture.storage(), megabytes(texture.bytes()));
    let target = Target::new(gpu, request.camera.width(), request.camera.height())?;
    let meshes =
        request.placed.iter().map(|placed| MirrorMesh::new(gpu, &placed.mesh)).collect::<Result<Vec<_>, _>>()?;
    let normal_map = request.normal_map.map(|map| NormalMapTexture::new(gpu, map)).transpose()?;
    let reflector = |(mesh, placed): (_, &Placed)| lf_gpu::Reflector {
        mesh,
        placement: placed.placement,
        reflectance: request.reflectance,
        normal_map: normal_map.as_ref(),
    };
    let reflectors: Vec<_> = meshes.iter().zip(request.placed).map(reflector).collect();
    let scene = if let Behind::Scene(scene) = request.behind { Some(SceneMesh::new(gpu, scene)?) } else { None };
    let behind = match (&scene, request.behind) {
        (Some(scene), _) => lf_gpu::Behind::Scene(scene),
        (None, Behind::Environment) => lf_gpu::Behind::Slabs,
        (None, _) => lf_gpu::Behind::Nothing,
    };
    let Request { camera, view, .. } = *request;
    let frame = Frame { camera, reflectors: &reflectors, behind, view };
    SlabRenderer::new(gpu, &texture)?.draw(&target, &frame)?;
    Ok(target.read(gpu)?)
}

fn draw_on_cpu(request: &Request<'_>) -> Result<Image<[u8; 4]>> {
    let (field, geometry) = (request.field, request.field.geometry().clone());
    if field.tilings().iter().all(|tiling| tiling.encoding() == TexelEncoding::Rgb16F) {
        return draw_field(&SlabField::new(geometry, field.decode_linear(MAX_DECODED_BYTES)?)?, request);
    }
    draw_field(&SlabField::new(geometry, field.decode(MAX_DECODED_BYTES)?)?, request)
}

fn draw_field<T: Texel>(field: &SlabField<T>, request: &Request<'_>) -> Result<Image<[u8; 4]>> {
    // Views do not heed reflectances.
    let reflectance = if request.view == View::Color { request.reflectance } else { Reflectance::MIRROR };
    let reflectors: Vec<_> = request
        .placed
        .iter()
        .map(|Placed { mesh, placement }| lf_ibr::Reflector {
            mesh,
            placement: *placement,
            reflectance,
            normal_map: request.normal_map,
        })
        .collect();
    Ok(draw_frame(&reflectors, request.behind, &field.viewed(request.view), request.camera)?)
}

impl ViewArg {
    fn view(self) -> View {
        match self {
            Self::Color => View::Color,
            Self::Slabs => View::Slabs,
            Self::Range => View::Range,
            Self::Stuv => View::Stuv,
        }
    }
}
