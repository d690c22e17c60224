// Texels are sRGB-encoded and interpolated so; the target takes them as they are.

fn displayed(color: vec3f) -> vec3f {
    return color;
}
