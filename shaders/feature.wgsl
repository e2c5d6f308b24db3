// Faces, edges and vertices of a mesh, as the blocks of a lattice see them. The CPU twin is src/sdf/exact: the same regions, the same
// margins. Coordinates about a block's centre are made with integers, so that a feature is as exact a million voxels from where it begins as
// beside it; all that follows is in single precision over the few voxels of the block.

/// Features, and the blocks of one level.
struct Job {
    /// Numbers of the first edge and of the first vertex, the number of features, and of blocks to work on.
    kinds: vec4<u32>,
    /// Rows where edges and vertices begin.
    rows: vec4<u32>,
    /// First voxel of the region, and voxels along a side of its blocks.
    base: vec4<i32>,
    /// Blocks of the region along each axis.
    across: vec4<i32>,
    /// The voxels after the last.
    end: vec4<i32>,
    /// Width of the band, h.
    band: f32,
}

@group(0) @binding(0) var<uniform> job: Job;
/// Five rows a face, seven an edge, eleven a vertex, as src/gpu/field/rows.rs writes them.
@group(0) @binding(1) var<storage, read> rows: array<vec4<i32>>;

const FACE_ROWS: u32 = 5u;
const EDGE_ROWS: u32 = 7u;
const VERTEX_ROWS: u32 = 11u;
/// Components of normals, and heights, are counted in this.
const UNIT: f32 = 1.0 / 1073741824.0;
/// Regions are larger by this, h.
const MARGIN: f32 = 2e-5;
/// The square of a distance beyond any.
const FAR: f32 = 1e30;

/// Where the rows of a feature begin.
fn rows_of(id: u32) -> u32 {
    if id < job.kinds.x {
        return FACE_ROWS * id;
    }
    if id < job.kinds.y {
        return job.rows.x + EDGE_ROWS * (id - job.kinds.x);
    }
    return job.rows.y + VERTEX_ROWS * (id - job.kinds.y);
}

/// Twice normal · centre, in UNIT.
fn twice_height(normal: vec3<i32>, twice: vec3<i32>) -> vec2<u32> {
    let xy = wide_sum(wide_product(normal.x, twice.x), wide_product(normal.y, twice.y));
    return wide_sum(xy, wide_product(normal.z, twice.z));
}

fn twice_word(low: i32, high: i32) -> vec2<u32> {
    let word = bitcast<vec2<u32>>(vec2(low, high));
    return wide_sum(word, word);
}

/// A plane about a centre, whose double is `twice`: the normal, and the height of the centre. The plane's own height above the first voxel is in two
/// words, the higher one elsewhere.
fn about(plane: vec4<i32>, high: i32, twice: vec3<i32>) -> vec4<f32> {
    let height = wide_difference(twice_height(plane.xyz, twice), twice_word(plane.w, high));
    return vec4(vec3<f32>(plane.xyz), 0.5 * wide_to_float(height)) * UNIT;
}

/// The same where the plane's height is in one word, and `twice` the way from a voxel beside it.
fn about_near(plane: vec4<i32>, twice: vec3<i32>) -> vec4<f32> {
    return about(plane, select(0, -1, plane.w < 0), twice);
}

/// How far the other end of an edge is from the centre, along the edge. `ends`: the last row of the edge.
fn to_end(along: vec4<i32>, high: i32, ends: vec4<i32>, twice: vec3<i32>) -> f32 {
    let height = wide_difference(twice_height(along.xyz, twice), twice_word(along.w, high));
    return 0.5 * wide_to_float(wide_difference(twice_word(ends.y, ends.z), height)) * UNIT;
}

/// Values at eight points around a centre, x first, then y: those at the smaller z, and those at the larger.
struct Eight {
    low: vec4<f32>,
    high: vec4<f32>,
}

/// A linear function `step` from the centre along each axis.
fn linear(f: vec4<f32>, step: f32) -> Eight {
    let plane = f.x * step * vec4(-1.0, 1.0, -1.0, 1.0) + f.y * step * vec4(-1.0, -1.0, 1.0, 1.0) + f.w;
    let up = f.z * step;
    return Eight(plane - up, plane + up);
}

fn squares(a: Eight) -> Eight {
    return Eight(a.low * a.low, a.high * a.high);
}

/// Bit by bit which of the eight values are at least `least`.
fn at_least(a: Eight, least: f32) -> u32 {
    let low = select(vec4(0u), vec4(1u, 2u, 4u, 8u), a.low >= vec4(least));
    let high = select(vec4(0u), vec4(16u, 32u, 64u, 128u), a.high >= vec4(least));
    let both = low | high;
    return both.x | both.y | both.z | both.w;
}

/// Bit by bit which of the boxes of half-width `half` around eight points `step` from the centre reach the inner side of a plane, or come as near as
/// single precision tells.
fn reaching(f: vec4<f32>, step: f32, half: f32) -> u32 {
    let growth = abs(f.x) + abs(f.y) + abs(f.z);
    return at_least(linear(f, step), -MARGIN - 1e-6 * (step + half) - half * growth);
}

/// What a feature is to eight points, and to the boxes around them.
struct Look {
    /// Square of the distance, or of a lower bound of it.
    square: Eight,
    /// Bit by bit which boxes meet the region.
    meets: u32,
    /// Bit by bit where the distance is that of a point of the surface.
    true_at: u32,
}

/// What feature `id` is to the boxes of half-width `half` around the eight points `step` from a centre; `centre` is twice its place.
fn look(id: u32, centre: vec3<i32>, step: f32, half: f32) -> Look {
    let at = rows_of(id);
    if id < job.kinds.x {
        let high = rows[at + 4u];
        let level = linear(about(rows[at], high.x, centre), step);
        let f0 = about(rows[at + 1u], high.y, centre);
        let f1 = about(rows[at + 2u], high.z, centre);
        let f2 = about(rows[at + 3u], high.w, centre);
        let meets = reaching(f0, step, half) & reaching(f1, step, half) & reaching(f2, step, half);
        let over = at_least(linear(f0, step), -MARGIN) & at_least(linear(f1, step), -MARGIN) & at_least(linear(f2, step), -MARGIN);
        return Look(squares(level), meets, over);
    }
    if id < job.kinds.y {
        let high = rows[at + 5u];
        let ends = rows[at + 6u];
        let a = squares(linear(about(rows[at], high.x, centre), step));
        let b = squares(linear(about(rows[at + 1u], high.y, centre), step));
        let along = about(rows[at + 2u], high.z, centre);
        let rest = vec4(-along.xyz, to_end(rows[at + 2u], high.z, ends, centre));
        let f0 = about(rows[at + 3u], high.w, centre);
        let f1 = about(rows[at + 4u], ends.x, centre);
        let meets = reaching(along, step, half) & reaching(rest, step, half) & reaching(f0, step, half) & reaching(f1, step, half);
        let between = at_least(linear(along, step), -MARGIN) & at_least(linear(rest, step), -MARGIN);
        return Look(Eight(a.low + b.low, a.high + b.high), meets, between);
    }
    let first = rows[at];
    let twice = centre - 2 * first.xyz;
    let way = 0.5 * vec3<f32>(twice) - bitcast<vec3<f32>>(rows[at + 1u].xyz);
    let x = linear(vec4(1.0, 0.0, 0.0, way.x), step).low;
    let y = linear(vec4(0.0, 1.0, 0.0, way.y), step).low;
    let flat = x * x + y * y;
    let z = vec2(way.z - step, way.z + step);
    var meets = 255u;
    for (var k = 0u; k < u32(first.w); k++) {
        meets &= reaching(about_near(rows[at + 3u + k], twice), step, half);
    }
    return Look(Eight(flat + z.x * z.x, flat + z.y * z.y), meets, 255u);
}
