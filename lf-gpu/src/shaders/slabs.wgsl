// Light field slabs: Figs. 6 and 8 of Yu, Yang & McMillan in one pass. CPU twins: lf-math/src/slab.rs, lf-ibr/src/slabs.rs.
// `fetch` comes from volume.wgsl or array.wgsl.

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
}

struct Slabs {
    // One over the volume's size in texels.
    texel_scale: vec3f,
    padding: f32,
    // By face: +X -X +Y -Y +Z -Z.
    faces: array<Slab, 6>,
}

@group(0) @binding(1) var<uniform> slabs: Slabs;
@group(0) @binding(2) var bilinear: sampler;

// A bilinear fetch from one camera's image; `uv` in index units within 0 … last, so that all four texels are its own.
fn fetch_camera(face: u32, camera: vec2u, uv: vec2f) -> vec3f {
    let pitch = slabs.faces[face].pitch;
    let per_slice = slabs.faces[face].cameras_per_slice;
    let group = camera / per_slice;
    let corner = (camera - group * per_slice) * pitch;
    let slice = slabs.faces[face].first_slice + group.y * slabs.faces[face].groups_s + group.x;
    return fetch((vec2f(corner) + uv + 0.5) * slabs.texel_scale.xy, slice);
}

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

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    let axis = dominant_axis(direction);
    let along = direction[axis];
    let face = 2u * axis + select(0u, 1u, along < 0.0);
    let slab = slabs.faces[face];
    if slab.present == 0u || along == 0.0 {
        return vec3f(0.0);
    }
    // Eqs. 3 and 4: where the ray crosses the camera plane, and its slope.
    let slope = tangential(direction, axis) / abs(along);
    let run = sign(along) * (slab.plane - origin[axis]);
    let position = tangential(origin, axis) + run * slope;
    // Eq. 1.
    let st = clamp((position - slab.st_first) / slab.st_step, vec2f(0.0), slab.st_last);
    let uv = (slope - slab.uv_first) / slab.uv_step;
    // Eq. 5: the four cameras around it; the last is reached with weight 1 from the last but one.
    let base = min(floor(st), max(slab.st_last - 1.0, vec2f(0.0)));
    let fraction = st - base;
    var color = vec3f(0.0);
    for (var i = 0u; i < 4u; i++) {
        let corner = vec2f(f32(i & 1u), f32(i >> 1u));
        let shares = (1.0 - corner) + (2.0 * corner - 1.0) * fraction;
        let camera = min(base + corner, slab.st_last);
        // Eq. 6, and never past the image's own texels.
        let tap = clamp(uv + slab.disparity * (st - camera), vec2f(0.0), slab.uv_last);
        color += shares.x * shares.y * fetch_camera(face, vec2u(camera), tap);
    }
    return color;
}
