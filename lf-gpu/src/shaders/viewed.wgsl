// A mirror whose rays are looked into.

fn mirrored(origin: vec3f, direction: vec3f, normal: vec3f, instance: u32) -> vec3f {
    return seen(index_ray(origin, direction));
}
