// Who looks. Mirrors `FrameUniform` in uniforms.rs.

struct Frame {
    clip_from_cell: mat4x4f,
    // Cell space, metres.
    eye: vec3f,
    padding: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;
