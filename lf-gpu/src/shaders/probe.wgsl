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
    let camera = vec2f(probe.camera);
    let columns = lines(probe.face, 0u, camera.xx, probe.uv.xx);
    let rows = lines(probe.face, 1u, camera.yy, probe.uv.yy);
    let texel = tapped(probe.face, camera, columns, rows, 0u, 0u);
    return vec4f(displayed(texel.rgb), texel.a);
}
