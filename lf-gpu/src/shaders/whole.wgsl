// Slabs whose images are all there and whole.

// A bilinear fetch from one camera's image; `uv` in index units within 0 … last, so that all four texels are its own. The
// fourth component says that the camera is there.
fn fetch_camera(face: u32, camera: vec2u, uv: vec2f) -> vec4f {
    let pitch = slabs.faces[face].pitch;
    let per_slice = slabs.faces[face].cameras_per_slice;
    let group = camera / per_slice;
    let corner = (camera - group * per_slice) * pitch;
    let slice = slabs.faces[face].first_slice + group.y * slabs.faces[face].groups_s + group.x;
    return vec4f(fetch((vec2f(corner) + uv + 0.5) * slabs.texel_scale.xy, slice), 1.0);
}

fn make_up(sum: vec4f) -> vec3f {
    return sum.rgb;
}
