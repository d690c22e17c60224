// Texels are linear; the target takes them sRGB-encoded.

fn displayed(color: vec3f) -> vec3f {
    return encoded(color);
}

fn radiance(color: vec3f) -> vec3f {
    return color;
}
