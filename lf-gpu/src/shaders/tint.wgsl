// A mirror that tints linear light. CPU twin: lf-math/src/reflectance.rs.

fn mirrored(origin: vec3f, direction: vec3f, normal: vec3f, instance: u32) -> vec3f {
    return encoded(instances[instance].tint * radiance(look_up(origin, direction)));
}
