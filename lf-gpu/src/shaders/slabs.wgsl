// Light field slabs: Figs. 6 and 8 of Yu, Yang & McMillan in one pass. CPU twins: lf-math/src/slab.rs, lf-ibr/src/slabs.rs.
// `face_of` comes from faces.wgsl or one_face.wgsl, `fetch` from volume.wgsl or array.wgsl, `fetch_camera` and `make_up` from
// whole.wgsl or cropped.wgsl, `shifted` from focused.wgsl or unfocused.wgsl.

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
    pitch: vec2u,
    cameras_per_slice: vec2u,
    first_slice: u32,
    // Slices per row of camera groups.
    groups_s: u32,
    padding: vec2u,
    // For cropped slabs, rows of the window table: where those of the camera columns, of the camera rows and of the mask begin.
    table: vec4u,
}

struct Slabs {
    // One over the volume's size in texels.
    texel_scale: vec3f,
    padding: f32,
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
@group(0) @binding(2) var bilinear: sampler;

// The face of the component of largest magnitude; on a tie the first of x, y, z.
fn dominant_axis(direction: vec3f) -> u32 {
    let a = abs(direction);
    if a.x >= a.y && a.x >= a.z {
        return 0u;
    }
    return select(2u, 1u, a.y >= a.z);
}

// The components along s and t, in cyclic order after the axis.
fn tangential(v: vec3f, axis: u32) -> vec2f {
    return vec2f(v[(axis + 1u) % 3u], v[(axis + 2u) % 3u]);
}

fn index_ray(origin: vec3f, direction: vec3f) -> Indexed {
    let face = face_of(direction);
    if face == NO_FACE {
        return Indexed(NO_FACE, vec2f(0.0), vec2f(0.0));
    }
    let axis = face / 2u;
    let along = direction[axis];
    let slab = slabs.faces[face];
    // Eqs. 3 and 4: where the ray crosses the camera plane, and its slope.
    let slope = tangential(direction, axis) / abs(along);
    let run = sign(along) * (slab.plane - origin[axis]);
    let position = tangential(origin, axis) + run * slope;
    // Eq. 1.
    return Indexed(face, (position - slab.st_first) / slab.st_step, (slope - slab.uv_first) / slab.uv_step);
}

// The light along a ray, as its texels are stored.
fn answer(ray: Indexed) -> vec3f {
    if ray.face == NO_FACE {
        return vec3f(0.0);
    }
    let slab = slabs.faces[ray.face];
    let st = clamp(ray.st, vec2f(0.0), slab.st_last);
    // Eq. 5: the four cameras around it; the last is reached with weight 1 from the last but one.
    let base = min(floor(st), max(slab.st_last - 1.0, vec2f(0.0)));
    let fraction = st - base;
    var sum = vec4f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2f(f32(i & 1u), f32(i >> 1u));
        let shares = (1.0 - corner) + (2.0 * corner - 1.0) * fraction;
        let camera = min(base + corner, slab.st_last);
        // Eq. 6, and never past the image's own texels.
        let tap = clamp(shifted(ray, st - camera), vec2f(0.0), slab.uv_last);
        sum += shares.x * shares.y * fetch_camera(ray.face, vec2u(camera), tap);
    }
    return make_up(sum);
}

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    return answer(index_ray(origin, direction));
}
