//! glTF 2.0 scenes, by the `gltf` crate: geometry, node transforms, base colours with textures, emission, lights.

use std::collections::VecDeque;
use std::f32::consts::PI;
use std::path::Path;
use std::sync::Arc;

use glam::{Mat3, Mat4, Vec2, Vec3};
use gltf::buffer::Data as Buffer;
use gltf::image::{Data as Picture, Format};
use gltf::khr_lights_punctual::Kind;
use gltf::mesh::Mode;
use gltf::{Document, Gltf};
use lf_math::{GeometryError, Image, normalized};

use super::Imported;
use crate::SceneError;
use crate::environment::Environment;
use crate::light::{Light, Lighting};
use crate::material::{ColorEncoding, Material, Surface, Texture};
use crate::scene::{SceneBuilder, Vertex};

/// Reads a `.glb` or `.gltf` file.
///
/// Used are triangles with node transforms, base colour factors and textures, emission, point and directional lights,
/// the first camera, and a sun named in `asset.extras.emitters[].sun_direction_world`. Transmissive surfaces are left
/// out, so that windows let light and rays through. A scene without lights gets one at its camera. What else the file
/// holds is listed in the warnings.
///
/// # Errors
/// If the file cannot be read or parsed, refers outside its buffers, or has no triangles.
pub fn import_gltf(path: &Path) -> Result<Imported, SceneError> {
    let broken = |source| SceneError::Broken { path: path.to_owned(), source };
    let File { document, buffers, pictures } = read(path)?;
    let mut import = Import {
        buffers,
        builder: SceneBuilder::default(),
        lights: vec![],
        camera: None,
        left_out: 0,
        broken_triangles: 0,
    };
    let textures = pictures.iter().map(texture).collect::<Result<Vec<_>, _>>().map_err(broken)?;
    for material in document.materials() {
        import.builder.material(convert_material(&material, &textures));
    }
    import.builder.material(Material::diffuse(Vec3::splat(0.8)));
    if let Some(scene) = document.default_scene().or_else(|| document.scenes().next()) {
        import.nodes(&document, &scene);
    }
    let name = path.file_stem().map_or_else(|| "scene".into(), |stem| stem.to_string_lossy());
    let warnings = warnings(&document, &import);
    if import.builder.is_empty() {
        return Err(SceneError::NoTriangles { path: path.to_owned() });
    }
    let lighting = import.lighting(sun_direction(&document));
    let scene = import.builder.build(&name, lighting).map_err(broken)?;
    let copyright = document.as_json().asset.copyright.clone();
    Ok(Imported { scene, camera: import.camera, copyright, warnings })
}

/// A file taken apart and checked.
struct File {
    document: Document,
    buffers: Vec<Buffer>,
    pictures: Vec<Picture>,
}

/// Reads a file. The `gltf` crate panics on some numbers that point nowhere; they are looked for first.
fn read(path: &Path) -> Result<File, SceneError> {
    let unreadable = |source| SceneError::Gltf { path: path.to_owned(), source: Box::new(source) };
    let broken = |source| SceneError::Broken { path: path.to_owned(), source };
    let bytes = std::fs::read(path).map_err(|e| unreadable(gltf::Error::Io(e)))?;
    let unchecked = Gltf::from_slice_without_validation(&bytes).map_err(unreadable)?;
    check_attributes(unchecked.document.as_json()).map_err(broken)?;
    let Gltf { document, blob } = Gltf::from_slice(&bytes).map_err(unreadable)?;
    let base = Some(path.parent().unwrap_or_else(|| Path::new("./")));
    let buffers = gltf::import_buffers(&document, base, blob).map_err(unreadable)?;
    check_views(&document, &buffers).map_err(broken)?;
    let pictures = gltf::import_images(&document, base, &buffers).map_err(unreadable)?;
    Ok(File { document, buffers, pictures })
}

/// What is gathered while walking the node tree.
struct Import {
    buffers: Vec<Buffer>,
    builder: SceneBuilder,
    lights: Vec<Light>,
    camera: Option<(Vec3, Vec3)>,
    left_out: usize,
    broken_triangles: usize,
}

impl Import {
    /// Walks the node tree. Each node is visited once, so that a file whose nodes form a ring comes to an end.
    fn nodes(&mut self, document: &Document, scene: &gltf::Scene<'_>) {
        let plain = document.materials().len() as u32;
        let mut visited = vec![false; document.nodes().len()];
        let mut open: VecDeque<_> = scene.nodes().map(|node| (node, Mat4::IDENTITY)).collect();
        while let Some((node, world_from_parent)) = open.pop_front() {
            if std::mem::replace(&mut visited[node.index()], true) {
                continue;
            }
            let world_from_node = world_from_parent * Mat4::from_cols_array_2d(&node.transform().matrix());
            self.node(&node, world_from_node, plain);
            open.extend(node.children().map(|child| (child, world_from_node)));
        }
    }

    fn node(&mut self, node: &gltf::Node<'_>, world_from_node: Mat4, plain: u32) {
        let (position, forward) = (world_from_node.w_axis.truncate(), -world_from_node.z_axis.truncate());
        if node.camera().is_some() {
            self.camera.get_or_insert((position, forward));
        }
        if let Some(light) = node.light() {
            self.lights.extend(convert_light(&light, position, forward));
        }
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            self.primitive(&primitive, world_from_node, plain);
        }
    }

    fn primitive(&mut self, primitive: &gltf::Primitive<'_>, world_from_node: Mat4, plain: u32) {
        let material = primitive.material();
        let clear = material.transmission().is_some_and(|t| t.transmission_factor() > 0.5);
        if clear || primitive.mode() != Mode::Triangles || !is_readable(primitive) {
            self.left_out += 1;
            return;
        }
        let reader = primitive.reader(|buffer| self.buffers.get(buffer.index()).map(|data| data.0.as_slice()));
        let Some(positions) = reader.read_positions() else { return };
        let positions: Vec<_> = positions.map(|p| world_from_node.transform_point3(Vec3::from(p))).collect();
        // Normals go by the inverse transpose; a singular transform leaves the computed ones.
        let turn = Mat3::from_mat4(world_from_node).inverse().transpose();
        let normals: Vec<_> = reader.read_normals().into_iter().flatten().map(|n| turn * Vec3::from(n)).collect();
        let set = material.pbr_metallic_roughness().base_color_texture().map_or(0, |info| info.tex_coord());
        let uvs: Vec<_> = reader
            .read_tex_coords(set)
            .into_iter()
            .flat_map(gltf::mesh::util::ReadTexCoords::into_f32)
            .map(Vec2::from)
            .collect();
        let indices: Vec<u32> = match reader.read_indices() {
            Some(indices) => indices.into_u32().collect(),
            None => (0..positions.len() as u32).collect(),
        };
        let number = material.index().map_or(plain, |index| index as u32);
        for triangle in indices.chunks_exact(3) {
            let corner = |i: u32| positions.get(i as usize).copied();
            let [Some(a), Some(b), Some(c)] = [corner(triangle[0]), corner(triangle[1]), corner(triangle[2])] else {
                self.broken_triangles += 1;
                continue;
            };
            let flat = (b - a).cross(c - a);
            let vertex = |index: u32, position: Vec3| Vertex {
                position,
                normal: normals.get(index as usize).copied().and_then(normalized).unwrap_or(flat),
                uv: uvs.get(index as usize).copied().unwrap_or(Vec2::ZERO),
            };
            self.builder.triangle([vertex(triangle[0], a), vertex(triangle[1], b), vertex(triangle[2], c)], number);
        }
    }

    /// The file's lights; a sun if it names one; else a lamp at the camera. Ambient light fills in for indirect light.
    fn lighting(&mut self, sun: Option<Vec3>) -> Lighting {
        let mut lights = std::mem::take(&mut self.lights);
        lights.extend(sun.map(|towards| Light::Sun { towards, irradiance: PI * Vec3::new(1.6, 1.5, 1.3) }));
        if lights.is_empty() {
            let (min, max) = self.builder.bounds();
            let position = self.camera.map_or(0.5 * (min + max), |(eye, _)| eye + Vec3::Y * 0.3);
            // Makes a white wall a quarter of the scene's diagonal away as bright as white can be shown.
            let reach = 0.25 * (max - min).length();
            lights.push(Light::Point { position, intensity: Vec3::splat(PI * reach * reach) });
        }
        Lighting { lights, ambient: Vec3::splat(0.45), environment: Environment::Sky(Vec3::new(0.75, 0.85, 1.0)) }
    }
}

fn convert_light(light: &gltf::khr_lights_punctual::Light<'_>, position: Vec3, forward: Vec3) -> Option<Light> {
    // glTF gives candela and lux; 683 lm/W turns them into radiometric units, as Blender's exporter assumes.
    let strength = Vec3::from(light.color()) * light.intensity() / 683.0;
    match light.kind() {
        Kind::Directional => normalized(-forward).map(|towards| Light::Sun { towards, irradiance: strength }),
        Kind::Point | Kind::Spot { .. } => Some(Light::Point { position, intensity: strength }),
    }
}

fn convert_material(material: &gltf::Material<'_>, textures: &[Option<Arc<Texture>>]) -> Material {
    let pbr = material.pbr_metallic_roughness();
    let [r, g, b, _] = pbr.base_color_factor();
    let factor = Vec3::new(r, g, b);
    let picture = pbr.base_color_texture().and_then(|info| textures.get(info.texture().source().index())?.as_ref());
    let base = picture.map_or(Surface::Uniform(factor), |texture| Surface::Textured(Arc::clone(texture), factor));
    let emission = Vec3::from(material.emissive_factor()) * material.emissive_strength().unwrap_or(1.0);
    Material { emission: Surface::Uniform(emission), double_sided: material.double_sided(), ..Material::of(base) }
}

/// A decoded picture in colour; of 16-bit values the high byte counts, grey stands for all channels.
///
/// Float pictures give `None`: PNG and JPEG, which glTF allows, have none.
fn texture(picture: &Picture) -> Result<Option<Arc<Texture>>, GeometryError> {
    let (channels, bytes) = match picture.format {
        Format::R8 => (1, 1),
        Format::R8G8 => (2, 1),
        Format::R8G8B8 => (3, 1),
        Format::R8G8B8A8 => (4, 1),
        Format::R16 => (1, 2),
        Format::R16G16 => (2, 2),
        Format::R16G16B16 => (3, 2),
        Format::R16G16B16A16 => (4, 2),
        Format::R32G32B32FLOAT | Format::R32G32B32A32FLOAT => return Ok(None),
    };
    // Two channels are grey and alpha. The decoder gives values in this machine's byte order.
    let high = if cfg!(target_endian = "little") { bytes - 1 } else { 0 };
    let channel = |pixel: &[u8], c: usize| {
        let c = if channels < 3 { 0 } else { c };
        pixel[c * bytes + high]
    };
    let texels =
        picture.pixels.chunks_exact(channels * bytes).map(|p| [channel(p, 0), channel(p, 1), channel(p, 2), 255]);
    Ok(Some(Arc::new(Texture {
        image: Image::new(picture.width, picture.height, texels.collect())?,
        encoding: ColorEncoding::Srgb,
    })))
}

/// Refuses attributes that name no accessor.
fn check_attributes(json: &gltf::json::Root) -> Result<(), GeometryError> {
    let primitives = json.meshes.iter().flat_map(|mesh| &mesh.primitives);
    for index in primitives.flat_map(|primitive| primitive.attributes.values()) {
        if index.value() >= json.accessors.len() {
            return Err(GeometryError::VertexIndex { index: index.value() as u32, vertices: json.accessors.len() });
        }
    }
    Ok(())
}

/// Refuses views and accessors that reach outside their buffers.
fn check_views(document: &Document, buffers: &[Buffer]) -> Result<(), GeometryError> {
    for view in document.views() {
        let len = buffers.get(view.buffer().index()).map_or(0, |data| data.0.len());
        let expected = view.offset().saturating_add(view.length());
        if expected > len {
            return Err(GeometryError::Length { what: "a buffer", len, expected });
        }
    }
    for accessor in document.accessors() {
        let Some(view) = accessor.view() else { continue };
        let stride = view.stride().unwrap_or(accessor.size());
        if stride < accessor.size() {
            return Err(GeometryError::Length { what: "a stride", len: stride, expected: accessor.size() });
        }
        let last = accessor.count().saturating_sub(1).saturating_mul(stride);
        let expected = accessor.offset().saturating_add(last).saturating_add(accessor.size());
        if expected > view.length() {
            return Err(GeometryError::Length { what: "a buffer view", len: view.length(), expected });
        }
    }
    Ok(())
}

/// Whether a primitive's accessors have the types that glTF allows and no sparse parts.
fn is_readable(primitive: &gltf::Primitive<'_>) -> bool {
    use gltf::Semantic::{Normals, Positions, TexCoords};
    use gltf::accessor::{DataType, Dimensions};
    let integer = |t| matches!(t, DataType::U8 | DataType::U16 | DataType::U32);
    let plain = |a: &gltf::Accessor<'_>| a.view().is_some() && a.sparse().is_none();
    let indices =
        primitive.indices().is_none_or(|a| plain(&a) && a.dimensions() == Dimensions::Scalar && integer(a.data_type()));
    let attribute = |(semantic, a): (gltf::Semantic, gltf::Accessor<'_>)| match semantic {
        Positions | Normals => plain(&a) && a.dimensions() == Dimensions::Vec3 && a.data_type() == DataType::F32,
        TexCoords(_) => {
            let small = matches!(a.data_type(), DataType::U8 | DataType::U16 | DataType::F32);
            plain(&a) && a.dimensions() == Dimensions::Vec2 && small
        }
        _ => true,
    };
    indices && primitive.attributes().all(attribute)
}

fn sun_direction(document: &Document) -> Option<Vec3> {
    let extras = document.as_json().asset.extras.as_ref()?;
    let json: serde_json::Value = serde_json::from_str(extras.get()).ok()?;
    let emitters = json.get("emitters")?.as_array()?;
    let sun = emitters.iter().find_map(|emitter| emitter.get("sun_direction_world")?.as_array())?;
    let number = |i: usize| Some(sun.get(i)?.as_f64()? as f32);
    normalized(Vec3::new(number(0)?, number(1)?, number(2)?))
}

fn warnings(document: &Document, import: &Import) -> Vec<String> {
    let mut list = Vec::new();
    let mut warn = |count: usize, what: &str| {
        if count > 0 {
            list.push(format!("{count} {what}"));
        }
    };
    let materials = || document.materials();
    warn(
        import.left_out,
        "primitives are left out: transmissive, not triangles, or of types this program does not read",
    );
    warn(materials().filter(|m| m.normal_texture().is_some()).count(), "normal maps are not used");
    let metallic = |m: &gltf::Material<'_>| m.pbr_metallic_roughness().metallic_factor() > 0.5;
    warn(materials().filter(metallic).count(), "metallic materials are shaded as diffuse");
    let see_through = |m: &gltf::Material<'_>| m.alpha_mode() != gltf::material::AlphaMode::Opaque;
    warn(materials().filter(see_through).count(), "materials with alpha are shaded as opaque");
    warn(materials().filter(|m| m.emissive_texture().is_some()).count(), "emission textures are not used");
    warn(import.broken_triangles, "triangles name vertices that do not exist and are left out");
    let spots = document.lights().into_iter().flatten().filter(|l| matches!(l.kind(), Kind::Spot { .. }));
    warn(spots.count(), "spot lights shine in all directions");
    let primitives = document.meshes().flat_map(|mesh| mesh.primitives().collect::<Vec<_>>());
    let colored = primitives.filter(|p| p.get(&gltf::Semantic::Colors(0)).is_some());
    warn(colored.count(), "primitives have vertex colours, which are not used");
    let repeats = |s: &gltf::texture::Sampler<'_>| {
        [s.wrap_s(), s.wrap_t()].iter().all(|mode| *mode == gltf::texture::WrappingMode::Repeat)
    };
    warn(document.samplers().filter(|s| !repeats(s)).count(), "texture samplers do not repeat; here they do");
    let transforms = document.extensions_used().filter(|name| *name == "KHR_texture_transform");
    warn(transforms.count(), "extension (KHR_texture_transform) is not used");
    warn(document.skins().count() + document.animations().count(), "skins and animations are not used");
    list
}
