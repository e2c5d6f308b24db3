// Layered depth images in two passes over the candidates: count the crossings of each ray, then (after a scan) write each
// crossing's triangle to a place of its own. The order on a ray is that of the atomics; whoever reads it sorts.

/// First pass: how many triangles cross each ray. Second pass: where the next one of each ray goes.
@group(0) @binding(2) var<storage, read_write> cursor: array<atomic<u32>>;
@group(0) @binding(3) var<storage, read_write> crossed: array<u32>;

fn is_covered(in: Proposal) -> bool {
    let ray = ray_of(in.position);
    let a = candidates[in.slot].ab.xy;
    let b = candidates[in.slot].ab.zw;
    let c = candidates[in.slot].c;
    return edge_covers(a, b, edge(a, b, ray)) && edge_covers(b, c, edge(b, c, ray)) && edge_covers(c, a, edge(c, a, ray));
}

fn place(in: Proposal) -> u32 {
    return u32(in.position.y) * view.size.x + u32(in.position.x);
}

@fragment
fn count(in: Proposal) {
    if is_covered(in) {
        atomicAdd(&cursor[place(in)], 1u);
    }
}

@fragment
fn scatter(in: Proposal) {
    if is_covered(in) {
        crossed[atomicAdd(&cursor[place(in)], 1u)] = candidates[in.slot].triangle;
    }
}
