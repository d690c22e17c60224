// The view rays. Mirrors `SightUniform` in uniforms.rs. CPU twin: lf-math/src/pinhole.rs.

struct Sight {
    // All in cell space.
    eye: vec3f,
    padding: f32,
    // Direction through the picture's upper left corner, and what it changes by for a pixel to the right and down.
    corner: vec3f,
    padding_2: f32,
    right: vec3f,
    padding_3: f32,
    down: vec3f,
    padding_4: f32,
}

@group(0) @binding(7) var<uniform> sight: Sight;

fn view_direction(pixel: vec4f) -> vec3f {
    return sight.corner + pixel.x * sight.right + pixel.y * sight.down;
}
