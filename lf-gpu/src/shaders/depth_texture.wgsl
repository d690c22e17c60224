// Inverse depths as texels.

@group(0) @binding(4) var inverse_depths: texture_cube<f32>;
@group(0) @binding(5) var nearest: sampler;

fn stored_inverse(away: vec3f) -> f32 {
    return textureSampleLevel(inverse_depths, nearest, away, 0.0).r;
}
