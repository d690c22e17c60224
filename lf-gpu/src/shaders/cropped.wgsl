// Slabs that store windows of their images, or not all cameras.

// See `WindowTable` in windows.rs.
@group(0) @binding(5) var<storage, read> windows: array<vec4i>;

const NO_MASK = 0xffffffffu;

// A bilinear fetch from one camera's image at the place of its window nearest to `uv` (index units). The fourth component is
// 0, as are the others, if the camera is not there.
fn fetch_camera(face: u32, camera: vec2u, uv: vec2f) -> vec4f {
    let column = windows[slabs.faces[face].table.x + camera.x];
    let row = windows[slabs.faces[face].table.y + camera.y];
    if column.w < 0 || row.w < 0 || !is_kept(face, camera) {
        return vec4f(0.0);
    }
    let tap = clamp(uv, vec2f(f32(column.y), f32(row.y)), vec2f(f32(column.z), f32(row.z)));
    let corner = vec2f(f32(column.x), f32(row.x));
    let slice = slabs.faces[face].first_slice + u32(column.w + row.w);
    return vec4f(fetch((corner + tap + 0.5) * slabs.texel_scale.xy, slice), 1.0);
}

fn is_kept(face: u32, camera: vec2u) -> bool {
    let mask = slabs.faces[face].table.z;
    if mask == NO_MASK {
        return true;
    }
    let bit = camera.y * (u32(slabs.faces[face].st_last.x) + 1u) + camera.x;
    let words = windows[mask + bit / 128u];
    return (u32(words[(bit / 32u) % 4u]) >> (bit % 32u) & 1u) == 1u;
}

// Cameras that are not there are made up for by the others.
fn make_up(sum: vec4f) -> vec3f {
    return select(sum.rgb, sum.rgb / sum.a, sum.a > 0.0 && sum.a < 0.999);
}
