// Depths of a distance cube. CPU twin: lf-math/src/distance_cube.rs. `stored_inverse` comes from depth_texture.wgsl or
// depth_blocks.wgsl.

fn depth_along_axis(away: vec3f) -> f32 {
    let size = abs(away);
    return max(size.x, max(size.y, size.z));
}

// How deep a place is, as a multiple of what the nearest texel shows.
fn relative_depth(away: vec3f) -> f32 {
    return depth_along_axis(away) * stored_inverse(away);
}

// The same by the nearest thing that any of the four texels around shows. They are sampled half a texel away, within the face: a
// gather goes on to the next face, where depths are along another axis.
fn largest_relative_depth(away: vec3f) -> f32 {
    let depth = depth_along_axis(away);
    let on_face = away / depth;
    let half_texel = 1.0 / f32(place.depth_size);
    // The tangents: across and along; of two equal axes the first is the face's.
    let size = abs(away);
    let is_x = size.x >= size.y && size.x >= size.z;
    let is_y = !is_x && size.y >= size.z;
    let across = select(vec3f(half_texel, 0.0, 0.0), vec3f(0.0, half_texel, 0.0), is_x);
    let along = select(vec3f(0.0, half_texel, 0.0), vec3f(0.0, 0.0, half_texel), is_x || is_y);
    let upper = max(inverse(on_face, along + across), inverse(on_face, along - across));
    let lower = max(inverse(on_face, across - along), inverse(on_face, -across - along));
    return depth * max(upper, lower);
}

// The inverse depth at an offset from a place of a cube of half size 1, kept within the outermost texels' middles.
fn inverse(on_face: vec3f, offset: vec3f) -> f32 {
    let last = vec3f(1.0 - 1.0 / f32(place.depth_size));
    let moved = clamp(on_face + offset, -last, last);
    return stored_inverse(select(moved, on_face, offset == vec3f(0.0)));
}
