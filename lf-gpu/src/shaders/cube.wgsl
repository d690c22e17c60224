// What a cube map with a place of its own shows. Mirrors `CubeUniform` in cubes.rs.

struct Cube {
    // Where it was taken, cell space, metres.
    center: vec3f,
    // Of the sphere that it is projected on; of a distance cube, where the fixed point begins.
    radius: f32,
    // Corners of the box that it is projected on.
    low: vec3f,
    // Ways along a ray between which it ends.
    near: f32,
    high: vec3f,
    far: f32,
    steps: u32,
    halvings: u32,
    // Texels along the edge of a face of depths.
    depth_size: u32,
    padding: u32,
}

@group(0) @binding(1) var cube: texture_cube<f32>;
@group(0) @binding(2) var bilinear: sampler;
@group(0) @binding(3) var<uniform> place: Cube;

fn seen(away: vec3f) -> vec3f {
    return textureSampleLevel(cube, bilinear, away, 0.0).rgb;
}

// How far along a unit direction a line leaves the sphere around the origin; negative if it passes it by.
fn sphere_exit(origin: vec3f, direction: vec3f, radius: f32) -> f32 {
    let along = dot(origin, direction);
    let nearest = length(origin - along * direction);
    let half_chord = (radius + nearest) * (radius - nearest);
    return select(-1.0, sqrt(max(half_chord, 0.0)) - along, half_chord >= 0.0);
}
