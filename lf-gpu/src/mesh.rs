//! Meshes on the device.

use glam::Vec3;
use lf_math::{LitMesh, TriangleMesh};

use crate::error::GpuError;
use crate::gpu::Gpu;
use crate::upload::large_buffer;

/// A reflective mesh on the device.
pub struct MirrorMesh(Buffers);

/// A scene's triangles on the device, with light at their corners: 24 bytes a vertex, 12 a triangle.
pub struct SceneMesh(Buffers);

/// Positions with another vector each, and the triangles between them.
struct Buffers {
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    /// The smallest box around the positions.
    bounds: (Vec3, Vec3),
}

impl MirrorMesh {
    /// Uploads a mesh: given in cell space, or placed there by each frame.
    ///
    /// # Errors
    /// If the mesh is too large for the device.
    pub fn new(gpu: &Gpu, mesh: &TriangleMesh) -> Result<Self, GpuError> {
        let attributes = [mesh.positions(), mesh.normals()];
        Buffers::new(gpu, "the mirror's buffers", attributes, mesh.triangles(), mesh.bounds()).map(Self)
    }

    /// Its bounding box, in its own space.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        self.0.bounds
    }

    /// Draws it as the instance of a number.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>, instance: u32) {
        self.0.draw(pass, instance);
    }
}

impl SceneMesh {
    /// Uploads a scene.
    ///
    /// # Errors
    /// If it is too large for the device.
    pub fn new(gpu: &Gpu, mesh: &LitMesh) -> Result<Self, GpuError> {
        let attributes = [mesh.positions(), mesh.light()];
        Buffers::new(gpu, "the scene's buffers", attributes, mesh.triangles(), mesh.bounds()).map(Self)
    }

    /// Its bounding box, cell space.
    pub(crate) fn bounds(&self) -> (Vec3, Vec3) {
        self.0.bounds
    }

    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.0.draw(pass, 0);
    }
}

impl Buffers {
    fn new(
        gpu: &Gpu,
        what: &'static str,
        attributes: [&[Vec3]; 2],
        triangles: &[[u32; 3]],
        bounds: (Vec3, Vec3),
    ) -> Result<Self, GpuError> {
        let [positions, others] = attributes;
        let vertices: Vec<[Vec3; 2]> =
            positions.iter().zip(others).map(|(&position, &other)| [position, other]).collect();
        Ok(Self {
            vertices: large_buffer(gpu, what, bytemuck::cast_slice(&vertices), wgpu::BufferUsages::VERTEX)?,
            indices: large_buffer(gpu, what, bytemuck::cast_slice(triangles), wgpu::BufferUsages::INDEX)?,
            index_count: 3 * triangles.len() as u32,
            bounds,
        })
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, instance: u32) {
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.index_count, 0, instance..instance + 1);
    }
}
