// The second of two passes: asks the slabs.

@group(0) @binding(7) var stuv: texture_2d<f32>;
@group(0) @binding(8) var faces: texture_2d<u32>;

@fragment
fn resolve_fragment(@builtin(position) pixel: vec4f) -> @location(0) vec4f {
    let place = vec2u(pixel.xy);
    let face = textureLoad(faces, place, 0).x;
    let asked = textureLoad(stuv, place, 0);
    if face == 0u {
        return vec4f(0.0);
    }
    return vec4f(seen(Indexed(face - 1u, asked.xy, asked.zw)), 1.0);
}
