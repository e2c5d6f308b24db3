// Gives the children of blocks their lists, and the places that they have close together.

/// Number of blocks, voxels along a side of them, and whether all children are kept, whatever they have.
struct Parents {
    count: u32,
    size: i32,
    all: u32,
}

@group(0) @binding(0) var<uniform> parents: Parents;
@group(0) @binding(1) var<storage, read> blocks: array<Block>;
@group(0) @binding(2) var<storage, read> lists: array<u32>;
@group(0) @binding(3) var<storage, read> masks: array<u32>;
/// Where the list of each child begins, and that of the one after the last.
@group(0) @binding(4) var<storage, read> starts: array<u32>;
/// Numbers of the children among those that have any feature.
@group(0) @binding(5) var<storage, read> places: array<u32>;
@group(0) @binding(6) var<storage, read_write> child_lists: array<u32>;
@group(0) @binding(7) var<storage, read_write> children: array<Block>;

const WIDTH: u32 = 64u;

var<workgroup> cursor: array<atomic<u32>, 8>;

@compute @workgroup_size(WIDTH)
fn share(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(num_workgroups) groups: vec3<u32>,
    @builtin(local_invocation_index) lane: u32,
) {
    let n = group.y * groups.x + group.x;
    if n >= parents.count {
        return;
    }
    let block = blocks[n];
    if lane < 8u {
        let start = starts[8u * n + lane];
        let count = starts[8u * n + lane + 1u] - start;
        atomicStore(&cursor[lane], start);
        let place = select(places[8u * n + lane], 8u * n + lane, parents.all != 0u);
        if count > 0u || parents.all != 0u {
            let size = parents.size / 2;
            let voxel = vec3(block.x, block.y, block.z) + size * vec3<i32>(vec3(lane & 1u, lane >> 1u & 1u, lane >> 2u));
            children[place] = Block(voxel.x, voxel.y, voxel.z, start, count);
        }
    }
    workgroupBarrier();
    for (var i = lane; i < block.count; i += WIDTH) {
        var mask = masks[block.start + i];
        while mask != 0u {
            let child = firstTrailingBit(mask);
            mask &= mask - 1u;
            child_lists[atomicAdd(&cursor[child], 1u)] = lists[block.start + i];
        }
    }
}
