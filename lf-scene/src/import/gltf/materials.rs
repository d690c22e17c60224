//! Materials of a glTF file.

use std::ops::RangeInclusive;

use glam::{Affine2, Mat2, Vec2, Vec3};
use gltf::material::AlphaMode;
use gltf::texture::Info;

use super::super::budget::Budget;
use super::super::notes::Notes;
use super::textures::{Textures, repeats};
use crate::ImportError;
use crate::light::MAX_RADIANCE;
use crate::material::{ColorEncoding, Material, Scattering, Surface, Texture};

/// A material, and where its primitives find their texture coordinates.
pub(super) struct Converted {
    pub(super) material: Material,
    pub(super) mapping: Mapping,
}

/// Which texture coordinates a material uses. The scene's vertices have one pair each: all textures of a material share it.
#[derive(Clone, Copy, PartialEq)]
pub(super) struct Mapping {
    pub(super) set: u32,
    pub(super) transform: Affine2,
    /// Whether a texture is not to repeat.
    pub(super) ends: bool,
    /// Whether there are textures.
    pub(super) textured: bool,
}

impl Mapping {
    /// Of a material without textures.
    pub(super) const NONE: Self = Self { set: 0, transform: Affine2::IDENTITY, ends: false, textured: false };
}

const FACTOR: RangeInclusive<f32> = 0.0..=1.0;
const RADIANCE: RangeInclusive<f32> = 0.0..=MAX_RADIANCE;
/// glTF's ior 0 means total reflection; below and at 1 nothing would be refracted.
const IOR: RangeInclusive<f32> = 1.0001..=100.0;
/// glTF's index of refraction where the file gives none.
const DEFAULT_IOR: f32 = 1.5;
/// Cuts off blended materials, which are not blended here.
const BLEND_CUTOFF: f32 = 0.5;

/// Converts the materials of one file.
pub(super) struct Materials<'a> {
    pub(super) textures: Textures<'a>,
    pub(super) notes: &'a mut Notes,
    pub(super) budget: &'a mut Budget,
}

impl Materials<'_> {
    pub(super) fn convert(&mut self, material: &gltf::Material<'_>) -> Result<Converted, ImportError> {
        let place = material.index().map_or_else(|| "default material".to_owned(), |i| format!("material {i}"));
        self.note_unused(material);
        let pbr = material.pbr_metallic_roughness();
        let [r, g, b, alpha] = pbr.base_color_factor();
        let color = self.color(&place, [r, g, b], FACTOR)?;
        let strength = self.notes.within(&place, material.emissive_strength().unwrap_or(1.0), RADIANCE)?;
        let factor = self.color(&place, material.emissive_factor(), RADIANCE)?;
        let emission = (factor * strength).min(Vec3::splat(MAX_RADIANCE));
        let scattering = self.scattering(&place, material)?;
        // A black factor makes any picture black; its alpha still cuts holes.
        let cut = material.alpha_mode() != AlphaMode::Opaque;
        let base_texture = pbr.base_color_texture().filter(|_| cut || color != Vec3::ZERO);
        let emission_texture = material.emissive_texture().filter(|_| emission != Vec3::ZERO);
        let is_glass = matches!(scattering, Scattering::Glass { .. });
        let scattering_texture = pbr.metallic_roughness_texture().filter(|_| !is_glass);
        let material_of = Material {
            base: self.surface(color, base_texture.as_ref())?,
            scattering,
            emission: self.surface(emission, emission_texture.as_ref())?,
            double_sided: material.double_sided(),
            alpha_cutoff: self.cutoff(&place, material, alpha)?,
        };
        let mapping = self.mapping(&place, [base_texture, scattering_texture, emission_texture])?;
        Ok(Converted { material: material_of, mapping })
    }

    fn color(&mut self, place: &str, rgb: [f32; 3], range: RangeInclusive<f32>) -> Result<Vec3, ImportError> {
        let [r, g, b] = rgb.map(|value| self.notes.within(place, value, range.clone()));
        Ok(Vec3::new(r?, g?, b?))
    }

    fn surface(&mut self, factor: Vec3, info: Option<&Info<'_>>) -> Result<Surface, ImportError> {
        let Some(info) = info else { return Ok(Surface::Uniform(factor)) };
        let texture = self.textures.get(info, ColorEncoding::Srgb, self.notes, self.budget)?;
        Ok(texture.map_or(Surface::Uniform(factor), |texture| Surface::Textured(texture, factor)))
    }

    fn scattering(&mut self, place: &str, material: &gltf::Material<'_>) -> Result<Scattering, ImportError> {
        let pbr = material.pbr_metallic_roughness();
        let metallic = self.notes.within(place, pbr.metallic_factor(), FACTOR)?;
        let roughness = self.notes.within(place, pbr.roughness_factor(), FACTOR)?;
        let transmission = match material.transmission() {
            Some(transmission) => self.notes.within(place, transmission.transmission_factor(), FACTOR)?,
            None => 0.0,
        };
        let texture = match pbr.metallic_roughness_texture() {
            Some(info) => self.textures.get(&info, ColorEncoding::Linear, self.notes, self.budget)?,
            None => None,
        };
        if transmission > 0.0 && self.is_glass(transmission, metallic, texture.as_deref()) {
            self.notes.count("rough glass is shown clear", usize::from(roughness > 0.0));
            return self.glass(place, material);
        }
        let other_ior = material.ior().is_some_and(|ior| ior != DEFAULT_IOR);
        self.notes
            .count("opaque materials have an index of refraction, which is taken for 1.5", usize::from(other_ior));
        Ok(Scattering::MetallicRoughness { metallic, roughness, texture })
    }

    /// Whether more than half of the light passes: of a transmissive material only the part that is not metal transmits
    /// (KHR_materials_transmission). A texture counts by its mean.
    fn is_glass(&mut self, transmission: f32, metallic: f32, texture: Option<&Texture>) -> bool {
        let metal = metallic * texture.map_or(1.0, |texture| texture.mean().z);
        let is_glass = transmission * (1.0 - metal) > 0.5;
        let mut note = |there: bool, what: &str| self.notes.count(what, usize::from(there));
        note(
            metal >= 1.0,
            "transmissive materials are metals, which let nothing through (metallicFactor is 1 if not given)",
        );
        note(
            metal > 0.0 && metal < 1.0,
            "transmissive materials are metals in part; here they are clear glass or opaque",
        );
        note(metal < 1.0 && !is_glass, "weakly transmissive materials are shown opaque");
        is_glass
    }

    fn glass(&mut self, place: &str, material: &gltf::Material<'_>) -> Result<Scattering, ImportError> {
        let ior = self.notes.within(place, material.ior().unwrap_or(DEFAULT_IOR), IOR)?;
        let textured = material.transmission().is_some_and(|t| t.transmission_texture().is_some());
        self.notes.count("textures of transmission are not used", usize::from(textured));
        let uneven = material.volume().is_some_and(|volume| volume.thickness_texture().is_some());
        self.notes.count("textures of thickness are not used", usize::from(uneven));
        let absorbs = material.volume().is_some_and(|v| v.attenuation_distance().is_finite());
        self.notes.count("solid glass absorbs light on its way, which is not used", usize::from(absorbs));
        let thin = material.volume().is_none_or(|volume| volume.thickness_factor() <= 0.0);
        Ok(Scattering::Glass { ior, thin })
    }

    /// The cutoff of the texture's alpha alone: the factor is constant and moves to the other side of the comparison.
    fn cutoff(&mut self, place: &str, material: &gltf::Material<'_>, factor: f32) -> Result<Option<f32>, ImportError> {
        let factor = self.notes.within(place, factor, FACTOR)?;
        let cutoff = match material.alpha_mode() {
            AlphaMode::Opaque => return Ok(None),
            AlphaMode::Mask => material.alpha_cutoff().unwrap_or(0.5),
            AlphaMode::Blend => {
                self.notes.add("materials are blended; here they are cut out where alpha is less than a half");
                BLEND_CUTOFF
            }
        };
        // Alpha is at most 1: a cutoff of 2 leaves nothing.
        let cutoff = self.notes.within(place, cutoff, 0.0..=2.0)?;
        Ok((cutoff > 0.0).then(|| (cutoff / factor).min(2.0)))
    }

    /// The texture coordinates of the first texture that shows; the others are noted if theirs differ.
    fn mapping(&mut self, place: &str, infos: [Option<Info<'_>>; 3]) -> Result<Mapping, ImportError> {
        let mut all = Vec::new();
        for info in infos.into_iter().flatten() {
            all.push(self.mapping_of(place, &info)?);
        }
        let first = all.first().copied().unwrap_or(Mapping::NONE);
        let others = all.iter().filter(|m| (m.set, m.transform) != (first.set, first.transform)).count();
        self.notes
            .count("textures use the texture coordinates of their material's first one instead of their own", others);
        Ok(Mapping { ends: all.iter().any(|mapping| mapping.ends), ..first })
    }

    /// KHR_texture_transform. Positive rotations are counter-clockwise in a picture whose v points down, as the renderers
    /// of Khronos and three.js have it.
    fn mapping_of(&mut self, place: &str, info: &Info<'_>) -> Result<Mapping, ImportError> {
        let ends = !repeats(info);
        let Some(given) = info.texture_transform() else {
            return Ok(Mapping { set: info.tex_coord(), ends, textured: true, ..Mapping::NONE });
        };
        let mut finite = |value: f32| self.notes.within(place, value, -1e6..=1e6);
        let (scale, offset) = (given.scale().map(&mut finite), given.offset().map(&mut finite));
        let ([sx, sy], [ox, oy]) = (scale, offset);
        let (sin, cos) = finite(given.rotation())?.sin_cos();
        let rotation = Mat2::from_cols(Vec2::new(cos, -sin), Vec2::new(sin, cos));
        let matrix = rotation * Mat2::from_diagonal(Vec2::new(sx?, sy?));
        let transform = Affine2::from_mat2_translation(matrix, Vec2::new(ox?, oy?));
        Ok(Mapping { set: given.tex_coord().unwrap_or(info.tex_coord()), transform, ends, textured: true })
    }

    fn note_unused(&mut self, material: &gltf::Material<'_>) {
        let mut unused = |there: bool, what: &str| self.notes.count(what, usize::from(there));
        unused(material.normal_texture().is_some(), "normal maps are not used");
        unused(material.occlusion_texture().is_some(), "occlusion maps are not used");
    }
}
