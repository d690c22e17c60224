// The paper's storage: all slabs in one volume texture. Sampled at a slice's centre, where its neighbours weigh 0.

@group(0) @binding(3) var volume: texture_3d<f32>;

fn fetch(position: vec2f, slice: u32) -> vec3f {
    let z = (f32(slice) + 0.5) * slabs.texel_scale.z;
    return textureSampleLevel(volume, bilinear, vec3f(position, z), 0.0).rgb;
}
