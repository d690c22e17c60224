// The first of two passes: where each ray asks (§7 and Fig. 5c of the paper).

struct Asked {
    // (s′, t′, u′, v′), not clamped.
    @location(0) stuv: vec4f,
    // The slab's face plus 1; 0 is no ray, NO_FACE plus 1 one without a slab.
    @location(1) face: u32,
}

fn asked(ray: Indexed) -> Asked {
    return Asked(vec4f(ray.st, ray.uv), ray.face + 1u);
}
