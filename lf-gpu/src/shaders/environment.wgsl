// An environment map: by direction alone. CPU twin: lf-ibr/src/cube.rs.

@group(0) @binding(1) var cube: texture_cube<f32>;
@group(0) @binding(2) var bilinear: sampler;

fn look_up(origin: vec3f, direction: vec3f) -> vec3f {
    return textureSampleLevel(cube, bilinear, direction, 0.0).rgb;
}
