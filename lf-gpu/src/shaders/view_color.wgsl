// What is seen along a ray: its light.

fn seen(ray: Indexed) -> vec3f {
    return displayed(answer(ray));
}
