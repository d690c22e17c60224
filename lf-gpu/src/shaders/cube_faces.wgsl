// Cube map addressing. CPU twin: lf-math/src/cube.rs. `dominant_axis` comes from dominant_axis.wgsl.

// A place seen from a cube: the face that shows it, and how far it lies to the right, down and forward as that face's image has them.
struct Spot {
    face: u32,
    away: vec3f,
}

// Unit vectors to the right and down of a face's image and to its middle.
fn face_axes(face: u32) -> mat3x3f {
    let facing = 1.0 - 2.0 * f32(face % 2u);
    let is_x = face / 2u == 0u;
    let is_y = face / 2u == 1u;
    return mat3x3f(
        select(vec3f(select(facing, 1.0, is_y), 0.0, 0.0), vec3f(0.0, 0.0, -facing), is_x),
        select(vec3f(0.0, -1.0, 0.0), vec3f(0.0, 0.0, facing), is_y),
        select(select(vec3f(0.0, 0.0, facing), vec3f(0.0, facing, 0.0), is_y), vec3f(facing, 0.0, 0.0), is_x),
    );
}

fn spot_of(away: vec3f) -> Spot {
    let axis = dominant_axis(away);
    let face = 2u * axis + u32(away[axis] < 0.0);
    // A vector times a matrix: its dot products with the columns.
    return Spot(face, away * face_axes(face));
}

// Its place among so many texels along an edge, index units, from -1/2 to half a texel past the last; the middle for the cube's own position.
fn index_of(spot: Spot, size: u32) -> vec2f {
    return (0.5 * spot.away.xy / max(spot.away.z, 1e-30) + 0.5) * f32(size) - 0.5;
}

fn nearest_texel(spot: Spot, size: u32) -> vec2u {
    return min(vec2u(index_of(spot, size) + 0.5), vec2u(size - 1u));
}
