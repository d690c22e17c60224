// A few sharp distance cubes, and a guide that says where in them a ray ends. CPU twin: lf-ibr/src/guided.rs, with what its constants mean.
// Cubes come from surface.wgsl, the guide from guide.wgsl; `look_up` from mirrors.wgsl or no_mirrors.wgsl.

// Mirrors `GuidedUniform` in several_cubes.rs.
struct Guided {
    // Of the cell, metres.
    half_extent: vec3f,
    // The largest distance of a cube from where a ray may start.
    reach: f32,
    // How far what is infinitely far is taken to be.
    far: f32,
    padding_x: f32,
    padding_y: f32,
    padding_z: f32,
}

// The search for a ray's end.
struct Search {
    origin: vec3f,
    // Of unit length.
    direction: vec3f,
    // The cube that saw past the last point.
    seeing: u32,
    // How far from the cubes the ray starts, about, if not among them.
    ahead: f32,
}

// What cubes say of a place.
struct Witnesses {
    // How far the two that come nearest to agreeing that a ray ends there are from it; infinite if more see past it than see it.
    discord: f32,
    // How many see it.
    seeing: i32,
}

@group(0) @binding(8) var<uniform> guided: Guided;

const MARGIN = 0.06;
const SHORT = 0.35;
const WITNESSES = 3;
const STEP_TEXELS = 6.0;
const LEAST_STEPS = 2.0;
const MOST_STEPS = 64.0;
const BLIND_STEPS = 32u;
const HALVINGS = 5u;
const IN_FRONT = 3e-3;
const EXACT = 1e-3;
const SEEN = 0.01;
const ALONE = 0.02;
const DISCORD = ALONE + 5e-3;
const NOT_FOUND = -1.0;

fn place_at(search: ptr<function, Search>, t: f32) -> vec3f {
    return (*search).origin + t * (*search).direction;
}

// How far along a ray it leaves the cell. CPU twin: lf-math/src/cell.rs.
fn cell_exit(origin: vec3f, direction: vec3f) -> f32 {
    let extent = guided.half_extent;
    let towards = select(-extent, extent, direction >= vec3f(0.0));
    let is_parallel = abs(direction) < vec3f(PARALLEL);
    let beside = select(vec3f(-INFINITE), vec3f(INFINITE), abs(origin) <= extent);
    let exits = select((towards - origin) / select(direction, vec3f(1.0), is_parallel), beside, is_parallel);
    let axis = dominant_axis(direction);
    let enter = (-towards[axis] - origin[axis]) / direction[axis];
    return clamp(min(exits.x, min(exits.y, exits.z)), enter, exits[axis]);
}

// How far along a ray it ends.
fn end(search: ptr<function, Search>) -> f32 {
    let extent = guided.half_extent;
    let exit = cell_exit((*search).origin, (*search).direction);
    let leave = max(exit, 1e-3 * min(extent.x, min(extent.y, extent.z)));
    let far = max(guided.far, 2.0 * leave);
    var start = leave;
    let ends = guide_ends((*search).origin, (*search).direction);
    if ends.x <= ends.y {
        let margin = MARGIN * (ends + leave);
        let bracket = clamp(ends + vec2f(-margin.x, margin.y), vec2f(leave), vec2f(far));
        // If its near end is not free, what the guide saw is not the first thing on the way.
        if bracket.x < bracket.y && is_free(search, bracket.x) {
            let found = within(search, bracket.x, bracket.y);
            if found != NOT_FOUND {
                return found;
            }
            start = bracket.y;
        }
    }
    var found = NOT_FOUND;
    if start < far {
        found = steps(search, start, far, BLIND_STEPS);
    }
    return select(found, far, found == NOT_FOUND);
}

// Whether some cube sees past a point of the ray.
fn is_free(search: ptr<function, Search>, t: f32) -> bool {
    let place = place_at(search, t);
    let seeing = (*search).seeing;
    if largest_relative_depth(seeing, place) < 1.0 - IN_FRONT {
        return true;
    }
    for (var cube = 0u; cube < arrayLength(&cubes); cube++) {
        if cube != seeing && largest_relative_depth(cube, place) < 1.0 - IN_FRONT {
            (*search).seeing = cube;
            return true;
        }
    }
    return false;
}

// The first end in a bracket whose near end is free.
fn within(search: ptr<function, Search>, near: f32, far: f32) -> f32 {
    let parallax = guided.reach * (1.0 / near - 1.0 / far);
    if parallax < SHORT {
        let met = meets((*search).seeing, (*search).origin, (*search).direction, place_at(search, near));
        if met > near && met < far {
            let said = witnesses(place_at(search, met));
            if said.discord < EXACT && said.seeing >= WITNESSES {
                return met;
            }
        }
    }
    let count = ceil(parallax * 0.5 * f32(cubes[0].size) / STEP_TEXELS);
    return steps(search, near, far, u32(clamp(count, LEAST_STEPS, MOST_STEPS)));
}

// Steps even in the inverse of the distance from the cubes, as the pictures are (Umenhoffer, Patow & Szirmay-Kalos 2007).
fn steps(search: ptr<function, Search>, near: f32, far: f32, count: u32) -> f32 {
    let ahead = (*search).ahead;
    let first = 1.0 / (near + ahead);
    let end = 1.0 / (far + ahead);
    let step = (first - end) / f32(count);
    var last = near;
    for (var i = 1u; i <= count; i++) {
        let next = 1.0 / max(first - f32(i) * step, end) - ahead;
        if !is_free(search, next) {
            let found = agreed(search, last, next);
            if found != NOT_FOUND {
                return found;
            }
        }
        last = next;
    }
    return NOT_FOUND;
}

// The place in a step on which the cubes agree best.
fn agreed(search: ptr<function, Search>, last: f32, next: f32) -> f32 {
    let slack = 0.5 * (next - last);
    let span = vec2f(max(last - slack, 0.0), next + slack);
    var free = last;
    var hidden = next;
    var best = next;
    var least = INFINITE;
    // The same planes are seen from a point that has been tried.
    var is_new = true;
    for (var i = 0u; i < HALVINGS; i++) {
        for (var cube = 0u; cube < arrayLength(&cubes) && is_new; cube++) {
            let met = meets(cube, (*search).origin, (*search).direction, place_at(search, hidden));
            if met >= span.x && met <= span.y {
                let apart = witnesses(place_at(search, met)).discord;
                if apart < EXACT {
                    return met;
                }
                if apart < least {
                    best = met;
                    least = apart;
                }
            }
        }
        let middle = 2.0 / (1.0 / free + 1.0 / hidden);
        is_new = !is_free(search, middle);
        if is_new {
            hidden = middle;
        } else {
            free = middle;
        }
    }
    return select(NOT_FOUND, best, least < DISCORD);
}

// What the cubes say of a place: whether a ray ends there.
fn witnesses(place: vec3f) -> Witnesses {
    var first = INFINITE;
    var second = INFINITE;
    var seeing = 0;
    var past = 0;
    for (var cube = 0u; cube < arrayLength(&cubes); cube++) {
        let off = relative_depth(cube, place) - 1.0;
        seeing += i32(abs(off) < SEEN);
        past += i32(off <= -SEEN);
        second = min(second, max(first, abs(off)));
        first = min(first, abs(off));
    }
    return Witnesses(select(first + min(second, ALONE), INFINITE, past > seeing), seeing);
}

// The colour of a place by all cubes.
fn color(place: vec3f) -> vec3f {
    let away = abs(place - cubes[0].position);
    let unit = max(max(away.x, max(away.y, away.z)), 1e-10);
    var sum = vec4f(0.0);
    for (var cube = 0u; cube < arrayLength(&cubes); cube++) {
        sum += samples(cube, place, guided.far, unit);
    }
    return sum.rgb / sum.a;
}
