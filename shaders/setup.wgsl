// Finds, once for each tile, the triangles that may cross its rays, and what fragments need of them. One invocation a triangle.

/// How much larger triangles are drawn than they are, in rays: more than hardware and f32 may be off.
override margin: f32;

/// Nine coordinates a triangle, snapped units.
@group(0) @binding(1) var<storage, read> corners: array<i32>;
/// The triangles found, in any order.
@group(0) @binding(2) var<storage, read_write> candidates: array<Candidate>;
/// Their numbers, in the same order.
@group(0) @binding(3) var<storage, read_write> numbers: array<u32>;
/// What draws them: vertices, instances, first vertex, first instance.
@group(0) @binding(4) var<storage, read_write> arguments: array<atomic<u32>, 4>;

/// Vertices drawn for each candidate: three triangles that make a pentagon.
const VERTICES: u32 = 9u;
const WIDTH: u32 = 64u;

fn corner(triangle: u32, k: u32) -> vec3<i32> {
    let at = 9u * triangle + 3u * k;
    let depth = corners[at + view.main_axis];
    let u = corners[at + (view.main_axis + 1u) % 3u] - view.shear.x * depth;
    let v = corners[at + (view.main_axis + 2u) % 3u] - view.shear.y * depth;
    return vec3(u, v, depth);
}

fn floor_div(a: i32, b: i32) -> i32 {
    return a / b - select(0, 1, a % b < 0);
}

/// Whether a ray of the tile lies in the rectangle around three corners.
fn rectangle_holds_rays(a: vec2<i32>, b: vec2<i32>, c: vec2<i32>) -> bool {
    let low = min(min(a, b), c);
    let high = max(max(a, b), c);
    let last = view.low + vec2<i32>(view.size) - 1;
    let u0 = max(-floor_div(-low.x, view.step), view.low.x);
    let v0 = max(-floor_div(-low.y, view.step), view.low.y);
    let u1 = min(floor_div(high.x, view.step), last.x);
    let v1 = min(floor_div(high.y, view.step), last.y);
    return u0 <= u1 && v0 <= v1;
}

/// Twice the area of a, b, c.
fn twice_area(a: vec2<i32>, b: vec2<i32>, c: vec2<i32>) -> vec2<u32> {
    return wide_difference(wide_product(b.x - a.x, c.y - a.y), wide_product(b.y - a.y, c.x - a.x));
}

/// A pentagon around the triangle of `points`, rays from `start`, which is a place in the tile: along the longest side, its ends cut off square,
/// so that acute corners stay near.
fn outline(points: array<vec2<f32>, 3>, start: vec2<f32>) -> array<vec2<f32>, 5> {
    let side_ab = points[1] - points[0];
    let side_bc = points[2] - points[1];
    let side_ca = points[0] - points[2];
    let ab = dot(side_ab, side_ab);
    let bc = dot(side_bc, side_bc);
    let ca = dot(side_ca, side_ca);
    var a = points[0];
    var b = points[1];
    var c = points[2];
    if bc >= ab && bc >= ca {
        a = points[1];
        b = points[2];
        c = points[0];
    } else if ca >= ab {
        a = points[2];
        b = points[0];
        c = points[1];
    }
    let along = normalize(b - a);
    let up = vec2(-along.y, along.x);
    let length = dot(b - a, along);
    let apex = vec2(dot(c - a, along), max(dot(c - a, up), 0.0));
    // Outward normals of the two short sides, in the frame of the longest.
    let left = normalize(vec2(-apex.y, max(apex.x, 0.0)) + vec2(0.0, 1e-20));
    let right = normalize(vec2(apex.y, max(length - apex.x, 0.0)) + vec2(0.0, 1e-20));
    let frame = array(
        vec2(-margin, -margin),
        vec2(length + margin, -margin),
        vec2(length + margin, margin * right.y / (1.0 + right.x)),
        apex + margin * (left + right) / max(1.0 + dot(left, right), 0.25),
        vec2(-margin, margin * left.y / (1.0 - left.x)),
    );
    var screen: array<vec2<f32>, 5>;
    for (var k = 0u; k < 5u; k++) {
        let p = (start + a + frame[k].x * along + frame[k].y * up) / vec2<f32>(view.size);
        screen[k] = vec2(2.0 * p.x - 1.0, 1.0 - 2.0 * p.y);
    }
    return screen;
}

@compute @workgroup_size(WIDTH)
fn set_up(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let triangle = id.y * groups.x * WIDTH + id.x;
    if triangle >= view.count {
        return;
    }
    let a = corner(triangle, 0u);
    var b = corner(triangle, 1u);
    var c = corner(triangle, 2u);
    if !rectangle_holds_rays(a.xy, b.xy, c.xy) {
        return;
    }
    var area = twice_area(a.xy, b.xy, c.xy);
    if wide_is_zero(area) {
        return;
    }
    if wide_is_negative(area) {
        let swapped = b;
        b = c;
        c = swapped;
        area = wide_difference(vec2(0u), area);
    }
    // From the first corner: sides are exact, however far away the triangle is.
    let per_step = 1.0 / f32(view.step);
    let points = array(vec2(0.0, 0.0), vec2<f32>(b.xy - a.xy) * per_step, vec2<f32>(c.xy - a.xy) * per_step);
    let start = vec2<f32>(a.xy - view.low * view.step) * per_step + 0.5;

    let slot = atomicAdd(&arguments[0], VERTICES) / VERTICES;
    numbers[slot] = view.first + triangle;
    candidates[slot] = Candidate(
        vec4(a.xy, b.xy),
        c.xy,
        view.first + triangle,
        vec4(f32(a.z), f32(b.z - a.z), f32(c.z - a.z), 1.0 / wide_to_float(area)),
        outline(points, start),
    );
}
