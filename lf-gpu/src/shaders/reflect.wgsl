// Draws a mirror: the vertex stage passes position and normal, the fragment stage mirrors the view ray (Eq. 2 of
// Yu, Yang & McMillan) and asks `look_up` of the environment's own file for the colour. CPU twin: lf-ibr/src/frame.rs.

struct Frame {
    clip_from_cell: mat4x4f,
    // Cell space, metres.
    eye: vec3f,
    padding: f32,
}

@group(0) @binding(0) var<uniform> frame: Frame;

struct Surface {
    @builtin(position) clip: vec4f,
    @location(0) position: vec3f,
    @location(1) normal: vec3f,
}

@vertex
fn mirror_vertex(@location(0) position: vec3f, @location(1) normal: vec3f) -> Surface {
    return Surface(frame.clip_from_cell * vec4f(position, 1.0), position, normal);
}

@fragment
fn mirror_fragment(surface: Surface) -> @location(0) vec4f {
    // Interpolated normals may cancel out; then any unit vector will do.
    let length = length(surface.normal);
    let normal = select(vec3f(0.0, 1.0, 0.0), surface.normal / length, length > 0.0);
    let incident = surface.position - frame.eye;
    let direction = incident - 2.0 * dot(incident, normal) * normal;
    return vec4f(look_up(surface.position, direction), 1.0);
}
