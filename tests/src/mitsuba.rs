//! A scene written down for Mitsuba 3: `scene.json` with lists of materials and lights, and flat little-endian files beside it.
//!
//! `tests/third_party/mitsuba/scene.py` reads it. Meshes are one per material, three corners a triangle, each corner position,
//! normal and texture coordinate (8 floats).

use std::fs;
use std::io;
use std::path::Path;

use glam::Vec3;
use lf_scene::{ColorEncoding, Environment, Light, Material, Pattern, Scattering, Scene, Surface, Texture, Vertex};
use serde_json::{Value, json};

/// Rows and columns at which the environment is written; Mitsuba interpolates in between.
const ENVIRONMENT: [u32; 2] = [1025, 2048];

/// Writes `scene` into a folder that exists.
///
/// # Errors
/// If a file cannot be written.
pub fn write_scene(scene: &Scene, folder: &Path) -> io::Result<()> {
    let mut textures = Textures { folder, count: 0 };
    let materials: Vec<Value> =
        scene.materials().iter().map(|material| textures.material(material)).collect::<io::Result<_>>()?;
    let mut meshes = vec![Vec::new(); materials.len()];
    for (corners, material) in scene.triangles() {
        meshes[*material as usize].extend(corners.iter().flat_map(floats));
    }
    for (number, mesh) in meshes.iter().enumerate().filter(|(_, mesh)| !mesh.is_empty()) {
        write_floats(&folder.join(format!("mesh-{number}.f32")), mesh)?;
    }
    let lights: Vec<Value> = scene.lighting().lights.iter().map(light).collect();
    let environment = match &scene.lighting().environment {
        Environment::Sky(zenith) if *zenith == Vec3::ZERO => Value::Null,
        environment => write_environment(environment, folder)?,
    };
    let text = json!({ "materials": materials, "lights": lights, "environment": environment }).to_string();
    fs::write(folder.join("scene.json"), text)
}

/// Writes floats as their little-endian bytes.
///
/// # Errors
/// If the file cannot be written.
pub fn write_floats(path: &Path, values: &[f32]) -> io::Result<()> {
    fs::write(path, values.iter().flat_map(|value| value.to_le_bytes()).collect::<Vec<u8>>())
}

fn floats(vertex: &Vertex) -> [f32; 8] {
    let (p, n, uv) = (vertex.position, vertex.normal, vertex.uv);
    [p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y]
}

fn light(light: &Light) -> Value {
    match *light {
        Light::Point { position, intensity } => {
            json!({ "kind": "point", "position": position.to_array(), "intensity": intensity.to_array() })
        }
        Light::Sun { towards, irradiance } => {
            json!({ "kind": "sun", "towards": towards.to_array(), "irradiance": irradiance.to_array() })
        }
        Light::Spot { .. } => json!({ "kind": "spot" }),
    }
}

/// The environment where Mitsuba's `envmap` has its nodes: column i at (i + ½)/width of a turn from −Z over +X, row j at
/// j/(height − 1) of the way from +Y to −Y.
fn write_environment(environment: &Environment, folder: &Path) -> io::Result<Value> {
    use std::f32::consts::{PI, TAU};
    let [height, width] = ENVIRONMENT;
    let mut texels = Vec::new();
    for row in 0..height {
        let (sin_v, cos_v) = (PI * row as f32 / (height - 1) as f32).sin_cos();
        for column in 0..width {
            let (sin_u, cos_u) = (TAU * (column as f32 + 0.5) / width as f32).sin_cos();
            texels.extend(environment.towards(Vec3::new(sin_u * sin_v, cos_v, -cos_u * sin_v)).to_array());
        }
    }
    write_floats(&folder.join("environment.f32"), &texels)?;
    Ok(json!({ "width": width, "height": height }))
}

/// Numbers the texture files.
struct Textures<'a> {
    folder: &'a Path,
    count: usize,
}

impl Textures<'_> {
    fn material(&mut self, material: &Material) -> io::Result<Value> {
        let scattering = match &material.scattering {
            Scattering::Diffuse => json!({ "kind": "diffuse" }),
            Scattering::Mirror => json!({ "kind": "mirror" }),
            Scattering::Glass { ior, thin } => json!({ "kind": "glass", "ior": ior, "thin": thin }),
            Scattering::MetallicRoughness { metallic, roughness, texture } => {
                let texture = texture.as_ref().map(|texture| self.texture(texture, Vec3::ONE)).transpose()?;
                json!({ "kind": "metallic-roughness", "metallic": metallic, "roughness": roughness, "texture": texture })
            }
        };
        let glows = material.emission != Surface::Uniform(Vec3::ZERO);
        Ok(json!({
            "scattering": scattering,
            "base": self.surface(&material.base)?,
            "emission": if glows { self.surface(&material.emission)? } else { Value::Null },
        }))
    }

    fn surface(&mut self, surface: &Surface) -> io::Result<Value> {
        Ok(match surface {
            Surface::Uniform(color) => json!({ "kind": "uniform", "color": color.to_array() }),
            Surface::Procedural(pattern) => procedural(*pattern),
            Surface::Textured(texture, factor) => self.texture(texture, *factor)?,
        })
    }

    fn texture(&mut self, texture: &Texture, factor: Vec3) -> io::Result<Value> {
        let file = format!("texture-{}.rgba8", self.count);
        self.count += 1;
        fs::write(self.folder.join(&file), texture.image.texels().as_flattened())?;
        let srgb = texture.encoding == ColorEncoding::Srgb;
        let (width, height) = (texture.image.width(), texture.image.height());
        Ok(json!({
            "kind": "texture", "file": file, "width": width, "height": height, "srgb": srgb, "factor": factor.to_array(),
        }))
    }
}

fn procedural(pattern: Pattern) -> Value {
    let (name, colors, count) = match &pattern {
        Pattern::Checker(colors) => ("checker", colors.as_slice(), 1.0),
        Pattern::Stripes(colors, count) => ("stripes", colors.as_slice(), *count),
        Pattern::Rings(colors, count) => ("rings", colors.as_slice(), *count),
        Pattern::Fields(colors, count) => ("fields", colors.as_slice(), *count),
    };
    let colors: Vec<_> = colors.iter().map(Vec3::to_array).collect();
    json!({ "kind": name, "colors": colors, "count": count })
}
