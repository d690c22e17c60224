// The mirrors' vertex stage passes position and normal on; `reflected` mirrors the view ray (Eq. 2 of Yu, Yang & McMillan).
// CPU twin: lf-ibr/src/scene.rs. `unit_normal` comes from smooth.wgsl or relief.wgsl.

// One mirror of a frame. Mirrors `InstanceUniform` in uniforms.rs.
struct Instance {
    // A similarity.
    cell_from_mesh: mat4x4f,
    // Shares of linear light.
    tint: vec3f,
    // The share reflected at perpendicular sight.
    f0: f32,
    // How many normal maps fit into a metre of the mesh's own space.
    repeats: f32,
    padding_x: f32,
    padding_y: f32,
    padding_z: f32,
}

@group(0) @binding(6) var<storage, read> instances: array<Instance>;

struct Surface {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
    @location(2) @interpolate(flat) instance: u32,
}

@vertex
fn mirror_vertex(
    @builtin(instance_index) instance: u32,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
) -> Surface {
    let place = instances[instance].cell_from_mesh * vec4f(position, 1.0);
    let turned = instances[instance].cell_from_mesh * vec4f(normal, 0.0);
    return Surface(frame.clip_from_cell * vec4f(place.xyz, 1.0), place.xyz, turned.xyz, instance);
}

// Interpolated normals may cancel out; then any unit vector will do.
fn smooth_normal(surface: Surface) -> vec3f {
    let length = length(surface.normal);
    return select(vec3f(0.0, 1.0, 0.0), surface.normal / length, length > 0.0);
}

fn reflected(surface: Surface, normal: vec3f) -> vec3f {
    let incident = surface.position - frame.eye;
    return incident - 2.0 * dot(incident, normal) * normal;
}
