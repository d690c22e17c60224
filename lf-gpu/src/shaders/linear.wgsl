// Texels are linear; the target takes them sRGB-encoded, what is brighter than 1 clipped. CPU twin: lf-math/src/color.rs.

fn displayed(color: vec3f) -> vec3f {
    let x = clamp(color, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}
