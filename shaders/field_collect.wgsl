// The lists of the blocks that have voxels in doubt, one behind the other.

@group(0) @binding(0) var<uniform> count: u32;
@group(0) @binding(1) var<storage, read> blocks: array<Block>;
@group(0) @binding(2) var<storage, read> lists: array<u32>;
/// Where the list of each block goes, and where the one after the last would.
@group(0) @binding(3) var<storage, read> starts: array<u32>;
@group(0) @binding(4) var<storage, read_write> collected: array<u32>;

const WIDTH: u32 = 64u;

@compute @workgroup_size(WIDTH)
fn collect(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let n = group.y * groups.x + group.x;
    if n >= count {
        return;
    }
    let start = starts[n];
    for (var i = lane; i < starts[n + 1u] - start; i += WIDTH) {
        collected[start + i] = lists[blocks[n].start + i];
    }
}
