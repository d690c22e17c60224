// Normals as they are.

fn unit_normal(surface: Surface) -> vec3f {
    return smooth_normal(surface);
}
