// The sRGB transfer function and its inverse. CPU twin: lf-math/src/color.rs.

// What is brighter than 1 is clipped.
fn encoded(linear: vec3f) -> vec3f {
    let x = clamp(linear, vec3f(0.0), vec3f(1.0));
    return select(1.055 * pow(x, vec3f(1.0 / 2.4)) - 0.055, 12.92 * x, x <= vec3f(0.0031308));
}

fn decoded(color: vec3f) -> vec3f {
    let x = clamp(color, vec3f(0.0), vec3f(1.0));
    return select(pow((x + 0.055) / 1.055, vec3f(2.4)), x / 12.92, x <= vec3f(0.04045));
}
