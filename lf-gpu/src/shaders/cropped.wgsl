// Slabs that store windows of their images. `is_kept` comes from unmasked.wgsl or masked.wgsl.

// See `WindowTable` in windows.rs.
@group(0) @binding(5) var<storage, read> windows: array<vec4i>;

// Taps at the places of their windows that are nearest.
fn lines(face: u32, axis: u32, cameras: vec2f, taps: vec2f) -> Lines {
    let begin = slabs.faces[face].table[axis];
    let first = windows[begin + u32(cameras.x)];
    let second = windows[begin + u32(cameras.y)];
    let low = vec2f(f32(first.y), f32(second.y));
    let high = vec2f(f32(first.z), f32(second.z));
    let corner = vec2f(f32(first.x), f32(second.x));
    let slices = vec2f(f32(first.w), f32(second.w));
    return Lines(corner + clamp(taps, low, high), slices, select(vec2f(0.0), vec2f(1.0), slices >= vec2f(0.0)));
}

// Cameras that are not there are made up for by the others.
fn make_up(sum: vec4f) -> vec3f {
    return select(sum.rgb, sum.rgb / sum.a, sum.a > 0.0 && sum.a < 0.999);
}
