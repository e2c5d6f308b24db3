// Depth peeling: each pass keeps, for every ray, the nearest crossing behind the one of the pass before. Crossings are
// ordered by depth and then by slot, and candidates are drawn in the order of their slots, in all passes alike; so crossings
// at the same depth are not lost. Depths only order: they are found again, exactly, from the triangles.

/// The farthest a depth may be from 0, snapped units.
override depth_range: f32;

@group(0) @binding(2) var depth_before: texture_depth_2d;
/// One more than the slot, those of the chunks before counted; 0 where there was none.
@group(0) @binding(3) var slot_before: texture_2d<u32>;

struct Kept {
    @builtin(frag_depth) depth: f32,
    @location(0) slot: u32,
}

@fragment
fn peel(in: Proposal) -> Kept {
    let ray = ray_of(in.position);
    let a = candidates[in.slot].ab.xy;
    let b = candidates[in.slot].ab.zw;
    let c = candidates[in.slot].c;
    let second = edge(c, a, ray);
    let third = edge(a, b, ray);
    if !(edge_covers(b, c, edge(b, c, ray)) && edge_covers(c, a, second) && edge_covers(a, b, third)) {
        discard;
    }
    let plane = candidates[in.slot].plane;
    let weights = vec2(wide_to_float(second), wide_to_float(third)) * plane.w;
    let depth = plane.x + dot(weights, plane.yz);
    // Never quite the ends of the range, which stand for "before all" and "no crossing".
    let kept = Kept(clamp(0.5 + 0.25 * depth / depth_range, 0.125, 0.875), view.first + in.slot + 1u);
    let pixel = vec2<i32>(floor(in.position.xy));
    let at = textureLoad(depth_before, pixel, 0);
    let before = textureLoad(slot_before, pixel, 0).x;
    if kept.depth < at || (kept.depth == at && kept.slot <= before) {
        discard;
    }
    return kept;
}
