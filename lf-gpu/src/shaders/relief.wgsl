// Normals bent by a map that is laid on from all three axes (Mikkelsen 2020). CPU twin: lf-math/src/normal_map.rs.

@group(0) @binding(9) var normal_map: texture_2d<f32>;

const LEAST_Z = 0.05;

fn unit_normal(surface: Surface) -> vec3f {
    let mesh = instances[surface.instance];
    let turn = mat3x3f(mesh.cell_from_mesh[0].xyz, mesh.cell_from_mesh[1].xyz, mesh.cell_from_mesh[2].xyz);
    let squared_scale = dot(turn[0], turn[0]);
    // A vector times a matrix is the transposed matrix times the vector: the inverse but for the scale.
    let position = (surface.position - mesh.cell_from_mesh[3].xyz) * turn / squared_scale;
    let scale = sqrt(squared_scale);
    return turn * bent(mesh.repeats * position, smooth_normal(surface) * turn / scale) / scale;
}

// Both in the mesh's own space, the place in maps.
fn bent(place: vec3f, normal: vec3f) -> vec3f {
    let squared = normal * normal;
    let weights = squared * squared / dot(squared, squared);
    let x = weights.x * slope(place.yz);
    let y = weights.y * slope(place.zx);
    let z = weights.z * slope(place.xy);
    let gradient = vec3f(y.y + z.x, x.x + z.y, x.y + y.x);
    // What the gradient has along the normal does not turn it.
    return normalize(normal + gradient - dot(normal, gradient) * normal);
}

// Interpolated here: a mirror shows the steps of a device's own filter, whose results may have 8 bits.
fn slope(place: vec2f) -> vec2f {
    let position = fract(place) * vec2f(textureDimensions(normal_map)) - 0.5;
    let low = vec2i(floor(position));
    let fraction = position - floor(position);
    let upper = mix(texel(low), texel(low + vec2i(1, 0)), fraction.x);
    let lower = mix(texel(low + vec2i(0, 1)), texel(low + vec2i(1, 1)), fraction.x);
    let normal = 2.0 * mix(upper, lower, fraction.y) - 1.0;
    return normal.xy / max(normal.z, LEAST_Z);
}

// The map repeats; a place is at most one texel beside it.
fn texel(place: vec2i) -> vec3f {
    let size = vec2i(textureDimensions(normal_map));
    return textureLoad(normal_map, (place + size) % size, 0).xyz;
}
