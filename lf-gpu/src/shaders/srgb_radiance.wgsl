// The linear light that a texel stands for.

fn radiance(color: vec3f) -> vec3f {
    return decoded(color);
}
