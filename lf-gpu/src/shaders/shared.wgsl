// The slices in a 2D array texture, a grid of them to a layer. Places as `Layers` in layers.rs gives them.

@group(0) @binding(3) var layers: texture_2d_array<f32>;

fn fetch(position: vec2f, slice: u32) -> vec3f {
    let per_layer = slabs.grid.x * slabs.grid.y;
    let within = slice % per_layer;
    let cell = vec2f(f32(within % slabs.grid.x), f32(within / slabs.grid.x));
    let place = position + cell / vec2f(slabs.grid);
    return textureSampleLevel(layers, bilinear, place, slice / per_layer, 0.0).rgb;
}
