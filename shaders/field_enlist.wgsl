// Which features matter to which blocks of a region: one invocation a feature, first to count, then (after a scan) to write.

/// The voxels that a feature can be nearest to, within the band: low and high along x, y and z, two to a word.
@group(0) @binding(2) var<storage, read> boxes: array<array<u32, 3>>;
/// First pass: how many features each block has. Second pass: where its next one goes.
@group(0) @binding(3) var<storage, read_write> cursor: array<atomic<u32>>;
@group(0) @binding(4) var<storage, read_write> lists: array<u32>;

const WIDTH: u32 = 64u;

fn halves(word: u32) -> vec2<i32> {
    return vec2(bitcast<i32>(word << 16u) >> 16u, bitcast<i32>(word) >> 16u);
}

/// Blocks of the region that the box of feature `id` meets: the first, and the one after the last.
fn blocks_of(id: u32) -> array<vec3<i32>, 2> {
    let x = halves(boxes[id][0]);
    let y = halves(boxes[id][1]);
    let z = halves(boxes[id][2]);
    let low = max(vec3(x.x, y.x, z.x) - job.base.xyz, vec3(0)) / job.base.w;
    let high = vec3(x.y, y.y, z.y) - job.base.xyz;
    let last = select(high / job.base.w, vec3(-1), high < vec3(0));
    return array(low, min(last + 1, job.across.xyz));
}

/// Whether a feature can be within the band of a voxel of a block.
fn matters(id: u32, block: vec3<i32>) -> bool {
    let size = job.base.w;
    let centre = 2 * (job.base.xyz + size * block) + size - 1;
    let half = 0.5 * f32(size - 1);
    let seen = look(id, centre, 0.0, half);
    let most = 1.000001 * (job.band + 1.7320509 * half) + 1e-3;
    return (seen.meets & 1u) == 1u && seen.square.low.x <= most * most;
}

fn number(block: vec3<i32>) -> u32 {
    return u32((block.z * job.across.y + block.y) * job.across.x + block.x);
}

@compute @workgroup_size(WIDTH)
fn count(@builtin(global_invocation_id) at: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let id = at.y * groups.x * WIDTH + at.x;
    if id >= job.kinds.z {
        return;
    }
    let range = blocks_of(id);
    for (var z = range[0].z; z < range[1].z; z++) {
        for (var y = range[0].y; y < range[1].y; y++) {
            for (var x = range[0].x; x < range[1].x; x++) {
                if matters(id, vec3(x, y, z)) {
                    atomicAdd(&cursor[number(vec3(x, y, z))], 1u);
                }
            }
        }
    }
}

@compute @workgroup_size(WIDTH)
fn enlist(@builtin(global_invocation_id) at: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let id = at.y * groups.x * WIDTH + at.x;
    if id >= job.kinds.z {
        return;
    }
    let range = blocks_of(id);
    for (var z = range[0].z; z < range[1].z; z++) {
        for (var y = range[0].y; y < range[1].y; y++) {
            for (var x = range[0].x; x < range[1].x; x++) {
                if matters(id, vec3(x, y, z)) {
                    lists[atomicAdd(&cursor[number(vec3(x, y, z))], 1u)] = id;
                }
            }
        }
    }
}
