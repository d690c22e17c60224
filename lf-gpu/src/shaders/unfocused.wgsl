// Slabs focused at infinity: all cameras look along the ray.

fn shifted(ray: Indexed, offset: vec2f) -> vec2f {
    return ray.uv;
}
