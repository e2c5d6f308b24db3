// Layered depth images in two passes over the triangles: count the crossings of each ray, then (after a scan) write each crossing's triangle
// to a place of its own. An invocation takes every so-manieth row of rays of one triangle; single precision proposes the rays of a row, one more at either end,
// and integers decide. The order on a ray is that of the atomics; whoever reads it sorts.

/// Nine coordinates a triangle, snapped units.
@group(0) @binding(1) var<storage, read> corners: array<i32>;
/// First pass: how many triangles cross each ray. Second pass: where the next one of each ray goes.
@group(0) @binding(2) var<storage, read_write> cursor: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> crossed: array<u32>;

const WIDTH: u32 = 64u;

/// A side of a triangle: its ends, and 1 where a ray on it is not covered.
struct Side {
    a: vec2<i32>,
    b: vec2<i32>,
    open: u32,
}

/// The sides of a triangle, turned so that its area is positive, and the rectangle of rays around it; none where the triangle crosses no ray.
struct Seen {
    sides: array<Side, 3>,
    low: vec2<i32>,
    high: vec2<i32>,
}

fn side(a: vec2<i32>, b: vec2<i32>) -> Side {
    let across = b.y - a.y;
    return Side(a, b, select(1u, 0u, across < 0 || (across == 0 && b.x > a.x)));
}

fn corner(triangle: u32, k: u32) -> vec2<i32> {
    let at = 9u * triangle + 3u * k;
    let depth = corners[at + view.main_axis];
    let u = corners[at + (view.main_axis + 1u) % 3u] - view.shear.x * depth;
    let v = corners[at + (view.main_axis + 2u) % 3u] - view.shear.y * depth;
    return vec2(u, v);
}

fn floor_div(a: i32, b: i32) -> i32 {
    return a / b - select(0, 1, a % b < 0);
}

fn seen(triangle: u32) -> Seen {
    let a = corner(triangle, 0u);
    var b = corner(triangle, 1u);
    var c = corner(triangle, 2u);
    let least = min(min(a, b), c);
    let most = max(max(a, b), c);
    let last = view.low + vec2<i32>(view.size) - 1;
    let low = max(vec2(-floor_div(-least.x, view.step), -floor_div(-least.y, view.step)), view.low);
    var high = min(vec2(floor_div(most.x, view.step), floor_div(most.y, view.step)), last);
    if all(low <= high) {
        let area = wide_difference(wide_product(b.x - a.x, c.y - a.y), wide_product(b.y - a.y, c.x - a.x));
        if wide_is_negative(area) {
            let swapped = b;
            b = c;
            c = swapped;
        }
        if wide_is_zero(area) {
            high = low - 1;
        }
    }
    return Seen(array(side(a, b), side(b, c), side(c, a)), low, high);
}

/// The rays of row `j` that the triangle may cover: the first and the last.
fn proposed(triangle: Seen, j: i32) -> vec2<i32> {
    var low = f32(triangle.low.x);
    var high = f32(triangle.high.x);
    for (var k = 0u; k < 3u; k++) {
        let a = triangle.sides[k].a;
        let along = f32(triangle.sides[k].b.x - a.x);
        let across = f32(triangle.sides[k].b.y - a.y);
        let up = f32(j * view.step - a.y);
        if across != 0.0 {
            // From the rectangle's first ray, so that little is rounded where it matters.
            let start = f32(a.x - triangle.low.x * view.step);
            let at = f32(triangle.low.x) + (start + along * up / across) / f32(view.step);
            if across > 0.0 {
                high = min(high, floor(at) + 1.0);
            } else {
                low = max(low, ceil(at) - 1.0);
            }
        }
    }
    // Where a row is empty the ends are the wrong way round, and may be far away.
    low = min(low, f32(triangle.high.x) + 1.0);
    high = max(high, f32(triangle.low.x) - 1.0);
    return vec2(i32(low), i32(high));
}

/// Whether a triangle covers a ray.
fn covers(triangle: Seen, ray: vec2<i32>) -> bool {
    var outside = false;
    for (var k = 0u; k < 3u; k++) {
        let value = edge(triangle.sides[k].a, triangle.sides[k].b, ray);
        outside = outside || wide_is_negative(wide_difference(value, vec2(triangle.sides[k].open, 0u)));
    }
    return !outside;
}

fn place(i: i32, j: i32) -> u32 {
    return view.offset + u32(j - view.low.y) * view.size.x + u32(i - view.low.x);
}

@compute @workgroup_size(WIDTH)
fn count(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let n = id.y * groups.x * WIDTH + id.x;
    if n >= view.count {
        return;
    }
    let triangle = seen(n);
    if any(triangle.low > triangle.high) {
        return;
    }
    for (var j = triangle.low.y + i32(id.z); j <= triangle.high.y; j += i32(groups.z)) {
        let rays = proposed(triangle, j);
        for (var i = rays.x; i <= rays.y; i++) {
            if covers(triangle, vec2(i, j) * view.step) {
                atomicAdd(&cursor[place(i, j)], 1u);
            }
        }
    }
}

@compute @workgroup_size(WIDTH)
fn scatter(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let n = id.y * groups.x * WIDTH + id.x;
    if n >= view.count {
        return;
    }
    let triangle = seen(n);
    if any(triangle.low > triangle.high) {
        return;
    }
    for (var j = triangle.low.y + i32(id.z); j <= triangle.high.y; j += i32(groups.z)) {
        let rays = proposed(triangle, j);
        for (var i = rays.x; i <= rays.y; i++) {
            if covers(triangle, vec2(i, j) * view.step) {
                crossed[atomicAdd(&cursor[place(i, j)], 1u)] = view.first + n;
            }
        }
    }
}
