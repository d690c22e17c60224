// Reads single samples by their indices: one pixel each. For tests and tools.

struct Probe {
    // Real-valued texel indices (u, v).
    uv: vec2f,
    camera: vec2u,
    face: u32,
    padding: u32,
}

@group(0) @binding(4) var<storage, read> probes: array<Probe>;

@fragment
fn probe_fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let index = u32(pixel.y) * PROBES_PER_ROW + u32(pixel.x);
    if index >= arrayLength(&probes) {
        return vec4f(0.0);
    }
    let probe = probes[index];
    let texel = fetch_camera(probe.face, probe.camera, probe.uv);
    return vec4f(displayed(texel.rgb), texel.a);
}
