// Triangles as the rays of one direction see them, and which rays they cover. The CPU twin is src/ldi/raster.rs: the same
// integers and the same rule for ties, so that both cover the same rays.

/// A tile of the rays of one direction, and a chunk of triangles.
struct View {
    /// Indices of the tile's first ray.
    low: vec2<i32>,
    /// Rays along u and v.
    size: vec2<u32>,
    /// The direction's components along the axes of u and v.
    shear: vec2<i32>,
    /// Axis of depth.
    main_axis: u32,
    /// Distance of rays, snapped units.
    step: i32,
    /// Number of the chunk's first triangle, and how many there are.
    first: u32,
    count: u32,
    /// Number of the tile's first ray among those of all tiles that are worked on together.
    offset: u32,
}

@group(0) @binding(0) var<uniform> view: View;

/// A triangle that may cross rays of the tile.
struct Candidate {
    /// (u, v) of the corners, turned so that the area is positive, snapped units.
    ab: vec4<i32>,
    c: vec2<i32>,
    triangle: u32,
    /// Depth of the first corner, the rises to the others, and 1 / area; snapped units.
    plane: vec4<f32>,
    /// A pentagon around the triangle, in the coordinates of the screen.
    outline: array<vec2<f32>, 5>,
}
/// The edge function from `a` to `b` at `p`: positive to its left.
fn edge(a: vec2<i32>, b: vec2<i32>, p: vec2<i32>) -> vec2<u32> {
    return wide_difference(wide_product(b.x - a.x, p.y - a.y), wide_product(b.y - a.y, p.x - a.x));
}

/// Whether an edge with this value covers the ray; on the edge itself the ray counts as moved by (ε, ε²).
fn edge_covers(a: vec2<i32>, b: vec2<i32>, value: vec2<u32>) -> bool {
    let across = b.y - a.y;
    let tie = across < 0 || (across == 0 && b.x > a.x);
    return !wide_is_negative(value) && (tie || !wide_is_zero(value));
}
