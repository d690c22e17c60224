// Where rays lie in light field slabs. CPU twin: lf-math/src/slab.rs. `dominant_axis` comes from dominant_axis.wgsl, `face_of` from faces.wgsl or
// one_face.wgsl.

// One slab; pairs are along (s, t) or (u, v). Mirrors `SlabUniform` in uniforms.rs.
struct Slab {
    st_first: vec2f,
    st_step: vec2f,
    uv_first: vec2f,
    uv_step: vec2f,
    // Largest camera and texel index.
    st_last: vec2f,
    uv_last: vec2f,
    // Texels that a point of the focal plane moves per camera.
    disparity: vec2f,
    // Coordinate of the camera plane along the face's axis.
    plane: f32,
    // 1, or 0 if the light field has no slab for this face.
    present: u32,
    // Texels between neighbouring images in a slice.
    pitch: vec2f,
    cameras_per_slice: vec2f,
    // Slices from one group of cameras to the next.
    slices_per_group: vec2f,
    first_slice: f32,
    padding: f32,
    // For cropped slabs, rows of the window table: where those of the camera columns, of the camera rows and of the mask begin. For
    // slabs of a guide, the number of the first texel.
    table: vec4u,
}

struct Slabs {
    // One over the texture's size in texels.
    texel_scale: vec3f,
    padding: f32,
    // Slices along the rows and columns of a layer.
    grid: vec2u,
    more_padding: vec2u,
    // By face: +X -X +Y -Y +Z -Z.
    faces: array<Slab, 6>,
}

// A ray in the real-valued sample indices of the slab that answers it; its face is NO_FACE if there is none.
struct Indexed {
    face: u32,
    st: vec2f,
    uv: vec2f,
}

const NO_FACE = 6u;

@group(0) @binding(1) var<uniform> slabs: Slabs;

// The component along an axis, then those along s and t, in cyclic order.
fn axis_first(v: vec3f, axis: u32) -> vec3f {
    return select(select(v.zxy, v.yzx, axis == 1u), v, axis == 0u);
}

fn index_ray(origin: vec3f, direction: vec3f) -> Indexed {
    let face = face_of(direction);
    if face == NO_FACE {
        return Indexed(NO_FACE, vec2f(0.0), vec2f(0.0));
    }
    let d = axis_first(direction, face / 2u);
    let o = axis_first(origin, face / 2u);
    let slab = slabs.faces[face];
    // Eqs. 3 and 4: where the ray crosses the camera plane, and its slope.
    let slope = d.yz / abs(d.x);
    let position = o.yz + sign(d.x) * (slab.plane - o.x) * slope;
    // Eq. 1.
    return Indexed(face, (position - slab.st_first) / slab.st_step, (slope - slab.uv_first) / slab.uv_step);
}
