// The scene's own triangles around the mirrors (§7 of Yu, Yang & McMillan: "regular geometries"). Linear light is interpolated
// between corners, then encoded. CPU twin: lf-ibr/src/scene.rs.

struct Lit {
    @builtin(position) clip: vec4f,
    @location(0) light: vec3f,
}

@vertex
fn scene_vertex(@location(0) position: vec3f, @location(1) light: vec3f) -> Lit {
    return Lit(frame.clip_from_cell * vec4f(position, 1.0), light);
}

@fragment
fn scene_fragment(lit: Lit) -> @location(0) vec4f {
    return vec4f(encoded(lit.light), 1.0);
}
