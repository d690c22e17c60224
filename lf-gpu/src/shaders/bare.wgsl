// A perfect mirror.

fn mirrored(origin: vec3f, direction: vec3f, normal: vec3f, instance: u32) -> vec3f {
    return displayed(look_up(origin, direction));
}
