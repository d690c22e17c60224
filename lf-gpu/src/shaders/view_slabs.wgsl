// What is seen along a ray: half its light, half the colour of its slab (Fig. 7d). CPU twin: lf-math/src/view.rs.

fn seen(ray: Indexed) -> vec3f {
    if ray.face == NO_FACE {
        return vec3f(0.0);
    }
    var towards = vec3f(0.0);
    towards[ray.face / 2u] = 1.0;
    return 0.5 * (displayed(answer(ray)) + select(towards, 1.0 - towards, ray.face % 2u == 1u));
}
