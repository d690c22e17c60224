//! The uniform blocks, laid out as the shaders declare them. A test compares every offset with what naga reflects.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec2, Vec3};
use lf_compress::volume::SlabLayout;
use lf_compress::{DepthGuide, PackedLightField};
use lf_math::{Pinhole, Placement, Reflectance, Slab};

use crate::layers::Layers;
use crate::windows::{NO_MASK, TablePlace, WindowTable};

/// `Frame` of frame.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct FrameUniform {
    pub(crate) clip_from_cell: Mat4,
    pub(crate) eye: Vec3,
    pub(crate) padding: f32,
}

/// `Instance` of mirror.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct InstanceUniform {
    pub(crate) cell_from_mesh: Mat4,
    pub(crate) tint: Vec3,
    pub(crate) f0: f32,
    pub(crate) repeats: f32,
    pub(crate) padding_x: f32,
    pub(crate) padding_y: f32,
    pub(crate) padding_z: f32,
}

/// `Sight` of sight.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct SightUniform {
    pub(crate) eye: Vec3,
    pub(crate) padding: f32,
    pub(crate) corner: Vec3,
    pub(crate) padding_2: f32,
    pub(crate) right: Vec3,
    pub(crate) padding_3: f32,
    pub(crate) down: Vec3,
    pub(crate) padding_4: f32,
}

/// `Slab` of slabs.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct SlabUniform {
    pub(crate) st_first: Vec2,
    pub(crate) st_step: Vec2,
    pub(crate) uv_first: Vec2,
    pub(crate) uv_step: Vec2,
    pub(crate) st_last: Vec2,
    pub(crate) uv_last: Vec2,
    pub(crate) disparity: Vec2,
    pub(crate) plane: f32,
    pub(crate) present: u32,
    pub(crate) pitch: Vec2,
    pub(crate) cameras_per_slice: Vec2,
    pub(crate) slices_per_group: Vec2,
    pub(crate) first_slice: f32,
    pub(crate) padding: f32,
    pub(crate) table: [u32; 4],
}

/// `Slabs` of slabs.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct SlabsUniform {
    pub(crate) texel_scale: Vec3,
    pub(crate) padding: f32,
    pub(crate) grid: [u32; 2],
    pub(crate) more_padding: [u32; 2],
    pub(crate) faces: [SlabUniform; 6],
}

/// `Probe` of probe.wgsl.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(crate) struct ProbeUniform {
    pub(crate) uv: Vec2,
    pub(crate) camera: [u32; 2],
    pub(crate) face: u32,
    pub(crate) padding: u32,
}

impl FrameUniform {
    pub(crate) fn new(camera: &Pinhole, near: f32) -> Self {
        Self { clip_from_cell: camera.clip_from_cell(near), eye: camera.eye(), padding: 0.0 }
    }
}

impl InstanceUniform {
    pub(crate) fn new(placement: &Placement, reflectance: &Reflectance, repeats: f32) -> Self {
        let f0 = reflectance.f0().unwrap_or(1.0);
        Self { cell_from_mesh: placement.cell_from_mesh(), tint: reflectance.tint(), f0, repeats, ..Self::zeroed() }
    }
}

impl SightUniform {
    pub(crate) fn new(camera: &Pinhole) -> Self {
        let [corner, right, down] = camera.ray_grid();
        Self { eye: camera.eye(), corner, right, down, ..Self::zeroed() }
    }
}

impl SlabsUniform {
    pub(crate) fn new(field: &PackedLightField, layers: &Layers, table: Option<&WindowTable>) -> Self {
        let mut uniform = Self::zeroed();
        uniform.texel_scale = Vec3::from(layers.size().map(|n| 1.0 / n as f32));
        uniform.grid = layers.grid();
        for (number, (slab, layout)) in field.geometry().slabs().iter().zip(field.layout().slabs()).enumerate() {
            let place = table.map_or(TablePlace { columns: 0, rows: 0, mask: NO_MASK }, |table| table.place(number));
            uniform.faces[usize::from(slab.face().index())] = SlabUniform::new(slab, layout, place);
        }
        uniform
    }

    /// Where the slabs of a guide lie, and their texels in guide.wgsl.
    pub(crate) fn of_guide(guide: &DepthGuide) -> Self {
        let (mut uniform, mut first) = (Self::zeroed(), 0);
        for (number, slab) in guide.geometry().slabs().iter().enumerate() {
            let place = SlabUniform { table: [first, 0, 0, 0], ..SlabUniform::of(slab) };
            uniform.faces[usize::from(slab.face().index())] = place;
            first += guide.inverse_depths(number).len() as u32;
        }
        uniform
    }
}

impl SlabUniform {
    /// Its geometry.
    fn of(slab: &Slab) -> Self {
        let ([s, t], [u, v]) = (slab.st(), slab.uv());
        Self {
            st_first: Vec2::new(s.first(), t.first()),
            st_step: Vec2::new(s.step(), t.step()),
            uv_first: Vec2::new(u.first(), v.first()),
            uv_step: Vec2::new(u.step(), v.step()),
            st_last: Vec2::new(s.last_index(), t.last_index()),
            uv_last: Vec2::new(u.last_index(), v.last_index()),
            disparity: slab.disparity(),
            plane: slab.plane(),
            present: 1,
            ..Self::zeroed()
        }
    }

    fn new(slab: &Slab, layout: &SlabLayout, place: TablePlace) -> Self {
        Self {
            // Whole numbers far below 2²⁴, which floats hold exactly; vector units have no integer division.
            pitch: slab.resolution().map(|texels| texels.next_multiple_of(4) as f32).into(),
            cameras_per_slice: layout.tiling().cameras_per_tile().map(|cameras| cameras as f32).into(),
            slices_per_group: Vec2::new(1.0, layout.groups()[0] as f32),
            first_slice: layout.first_slice() as f32,
            table: [place.columns, place.rows, place.mask, 0],
            ..Self::of(slab)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::{offset_of, size_of};

    use crate::cubes::{CubeShader, CubeUniform, Depths};
    use crate::plane_blocks::CubeEntry;
    use crate::several_cubes::{GuidedUniform, MarchUniform};
    use crate::shader::{Finish, Part, Relief, Shader, SlabShader, shader_source};
    use lf_compress::planes::PlaneBlock;
    use lf_math::View;

    /// Offsets of a WGSL struct's members and its size, as naga lays it out.
    fn reflected(module: &wgpu::naga::Module, name: &str) -> (Vec<(String, u32)>, u32) {
        let (_, found) = module.types.iter().find(|(_, t)| t.name.as_deref() == Some(name)).expect("declared");
        let wgpu::naga::TypeInner::Struct { members, span } = &found.inner else { panic!("{name} is a struct") };
        (members.iter().map(|m| (m.name.clone().unwrap_or_default(), m.offset)).collect(), *span)
    }

    fn parsed(source: &str) -> wgpu::naga::Module {
        wgpu::naga::front::wgsl::parse_str(source).unwrap_or_else(|e| panic!("{}", e.emit_to_string(source)))
    }

    #[test]
    fn every_shader_is_valid() {
        use wgpu::naga::valid::{Capabilities, ValidationFlags, Validator};
        /// `unpack2x16float`, which only old OpenGL lacks, and arrays of cube textures, which WebGPU promises.
        const NEEDED: Capabilities = Capabilities::SHADER_FLOAT16_IN_FLOAT32.union(Capabilities::CUBE_ARRAY_TEXTURES);
        let validate = |shader, part| {
            let module = parsed(&shader_source(shader, part));
            Validator::new(ValidationFlags::all(), NEEDED).validate(&module).expect("valid");
        };
        for (slabs, part) in
            SlabShader::all().into_iter().flat_map(|slabs| Part::all().into_iter().map(move |p| (slabs, p)))
        {
            validate(Shader::Slabs(slabs), part);
        }
        validate(Shader::Flat, Part::Mirror(Finish::Bare, Relief::Smooth));
        let cubes = CubeShader::ALL.map(Shader::Cube);
        for shader in cubes.into_iter().chain([
            Shader::Probes,
            Shader::Guided { mirrors: false },
            Shader::Guided { mirrors: true },
        ]) {
            for finish in [Finish::Bare, Finish::Tint, Finish::Fresnel] {
                validate(shader, Part::Mirror(finish, Relief::Smooth));
            }
        }
    }

    macro_rules! same_layout {
        ($module:expr, $name:literal, $rust:ty, $($field:ident),+) => {{
            let expected = vec![$((stringify!($field).to_owned(), offset_of!($rust, $field) as u32)),+];
            assert_eq!(reflected($module, $name), (expected, size_of::<$rust>() as u32), $name);
        }};
    }

    #[test]
    fn rust_and_wgsl_agree_on_every_offset() {
        let source = |part| shader_source(Shader::Slabs(SlabShader::all()[0]), part);
        let module = parsed(&source(Part::Mirror(Finish::Fresnel, Relief::Mapped)));
        same_layout!(&module, "Frame", FrameUniform, clip_from_cell, eye, padding);
        same_layout!(
            &module,
            "Instance",
            InstanceUniform,
            cell_from_mesh,
            tint,
            f0,
            repeats,
            padding_x,
            padding_y,
            padding_z
        );
        let module = parsed(&source(Part::Background(View::Color)));
        same_layout!(
            &module,
            "Sight",
            SightUniform,
            eye,
            padding,
            corner,
            padding_2,
            right,
            padding_3,
            down,
            padding_4
        );
        let module = parsed(&source(Part::Probe));
        same_layout!(
            &module,
            "Slab",
            SlabUniform,
            st_first,
            st_step,
            uv_first,
            uv_step,
            st_last,
            uv_last,
            disparity,
            plane,
            present,
            pitch,
            cameras_per_slice,
            slices_per_group,
            first_slice,
            padding,
            table
        );
        same_layout!(&module, "Slabs", SlabsUniform, texel_scale, padding, grid, more_padding, faces);
        same_layout!(&module, "Probe", ProbeUniform, uv, camera, face, padding);
        let module = parsed(&shader_source(
            Shader::Cube(CubeShader::March(Depths::Texture)),
            Part::Mirror(Finish::Bare, Relief::Smooth),
        ));
        same_layout!(
            &module,
            "Cube",
            CubeUniform,
            center,
            radius,
            low,
            near,
            high,
            far,
            steps,
            halvings,
            depth_size,
            padding
        );
        let bare = Part::Mirror(Finish::Bare, Relief::Smooth);
        let module = parsed(&shader_source(Shader::Probes, bare));
        same_layout!(&module, "March", MarchUniform, near, far, steps, halvings);
        same_layout!(&module, "DistanceCube", CubeEntry, position, size, scales, first_block, padding);
        assert_eq!(reflected(&module, "PlaneBlock").1 as usize, PlaneBlock::BYTES);
        let module = parsed(&shader_source(Shader::Guided { mirrors: true }, bare));
        same_layout!(&module, "Guided", GuidedUniform, half_extent, reach, far, padding_x, padding_y, padding_z);
    }
}
