// The slices as layers of a 2D array texture.

@group(0) @binding(3) var layers: texture_2d_array<f32>;

fn fetch(position: vec2f, slice: u32) -> vec3f {
    return textureSampleLevel(layers, bilinear, position, slice, 0.0).rgb;
}
