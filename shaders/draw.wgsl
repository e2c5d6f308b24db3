// Draws candidates. Hardware rasterisation only proposes rays, since outlines are a little larger than triangles; every fragment
// decides for itself, in integers.

@group(0) @binding(1) var<storage, read> candidates: array<Candidate>;

/// Vertices drawn for each candidate, and the pentagon's corners they are.
const VERTICES: u32 = 9u;

struct Proposal {
    @builtin(position) position: vec4<f32>,
    /// Place in `candidates`.
    @location(0) @interpolate(flat) slot: u32,
}

@vertex
fn vertex(@builtin(vertex_index) index: u32) -> Proposal {
    var fan = array(0u, 1u, 2u, 0u, 2u, 3u, 0u, 3u, 4u);
    let slot = index / VERTICES;
    return Proposal(vec4(candidates[slot].outline[fan[index % VERTICES]], 0.5, 1.0), slot);
}

/// (u, v) of the ray of a fragment, snapped units.
fn ray_of(position: vec4<f32>) -> vec2<i32> {
    return (view.low + vec2<i32>(floor(position.xy))) * view.step;
}

