// Which features of a block matter to which of its eight children: a workgroup a block. The nearest is found first; whatever is nearest to a
// voxel of a child is no farther from the child's centre than that and the way across the child.

@group(0) @binding(2) var<storage, read> blocks: array<Block>;
@group(0) @binding(3) var<storage, read> lists: array<u32>;
/// For each feature of the lists, bit by bit the children that it matters to.
@group(0) @binding(4) var<storage, read_write> masks: array<u32>;
/// How many features matter to each child.
@group(0) @binding(5) var<storage, read_write> counts: array<u32>;

const WIDTH: u32 = 64u;
const ROOT_3: f32 = 1.7320509;
/// Features are passed over when they are farther than the nearest by more than this, h, and a share of the distance.
const SLACK: f32 = 1e-3;
const SLACK_SHARE: f32 = 1e-6;

/// Bits of the squares: those of numbers that are not negative have the numbers' order.
var<workgroup> nearest: array<atomic<u32>, 8>;
var<workgroup> found: array<atomic<u32>, 8>;

/// The square of how far a feature may be from the centres of children whose nearest squares these are.
fn most(squares: vec4<f32>, radius: f32) -> vec4<f32> {
    let distance = sqrt(squares);
    let reach = min(distance + radius, vec4(job.band)) + radius + SLACK + SLACK_SHARE * min(distance, vec4(job.band));
    return reach * reach;
}

fn is_within(block: vec3<i32>, size: i32) -> u32 {
    var within = 0u;
    for (var n = 0u; n < 8u; n++) {
        let child = block + size * vec3<i32>(vec3(n & 1u, n >> 1u & 1u, n >> 2u));
        within |= select(0u, 1u << n, all(child < job.end.xyz));
    }
    return within;
}

@compute @workgroup_size(WIDTH)
fn judge(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let n = group.y * groups.x + group.x;
    if n >= job.kinds.w {
        return;
    }
    let block = blocks[n];
    let size = job.base.w / 2;
    let base = vec3(block.x, block.y, block.z);
    let centre = 2 * base + job.base.w - 1;
    let step = 0.5 * f32(size);
    let half = 0.5 * f32(size - 1);
    if lane < 8u {
        atomicStore(&nearest[lane], bitcast<u32>(FAR));
        atomicStore(&found[lane], 0u);
    }
    workgroupBarrier();

    var low = vec4(FAR);
    var high = vec4(FAR);
    for (var i = lane; i < block.count; i += WIDTH) {
        let seen = look(lists[block.start + i], centre, step, half);
        let here = vec4(seen.true_at) & vec4(1u, 2u, 4u, 8u);
        let above = vec4(seen.true_at) & vec4(16u, 32u, 64u, 128u);
        low = min(low, select(vec4(FAR), seen.square.low, here != vec4(0u)));
        high = min(high, select(vec4(FAR), seen.square.high, above != vec4(0u)));
    }
    for (var k = 0u; k < 4u; k++) {
        atomicMin(&nearest[k], bitcast<u32>(low[k]));
        atomicMin(&nearest[k + 4u], bitcast<u32>(high[k]));
    }
    workgroupBarrier();

    for (var k = 0u; k < 4u; k++) {
        low[k] = bitcast<f32>(atomicLoad(&nearest[k]));
        high[k] = bitcast<f32>(atomicLoad(&nearest[k + 4u]));
    }
    let radius = ROOT_3 * half;
    low = most(low, radius);
    high = most(high, radius);
    let within = is_within(base, size);
    var own_low = vec4(0u);
    var own_high = vec4(0u);
    for (var i = lane; i < block.count; i += WIDTH) {
        let seen = look(lists[block.start + i], centre, step, half);
        let near = at_least(Eight(low - seen.square.low, high - seen.square.high), 0.0);
        let mask = seen.meets & near & within;
        masks[block.start + i] = mask;
        own_low += (vec4(mask) >> vec4(0u, 1u, 2u, 3u)) & vec4(1u);
        own_high += (vec4(mask) >> vec4(4u, 5u, 6u, 7u)) & vec4(1u);
    }
    for (var k = 0u; k < 4u; k++) {
        atomicAdd(&found[k], own_low[k]);
        atomicAdd(&found[k + 4u], own_high[k]);
    }
    workgroupBarrier();
    if lane < 8u {
        counts[8u * n + lane] = atomicLoad(&found[lane]);
    }
}
