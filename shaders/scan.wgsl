// Sums of all elements before each, in place. Blocks of a workgroup are summed by themselves, then the sums of the blocks
// in the same way, and then each block is raised by what comes before it.

/// Elements that one invocation sums.
const RUN: u32 = 4u;
/// Invocations of a workgroup.
const WIDTH: u32 = 256u;

@group(0) @binding(0) var<storage, read_write> values: array<u32>;
@group(0) @binding(1) var<storage, read_write> sums: array<u32>;
/// Number of values.
@group(0) @binding(2) var<uniform> count: u32;

var<workgroup> partial: array<u32, WIDTH>;

@compute @workgroup_size(WIDTH)
fn sum_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let start = (group.x * WIDTH + lane) * RUN;
    var own: array<u32, RUN>;
    var total = 0u;
    for (var k = 0u; k < RUN; k++) {
        own[k] = total;
        if start + k < count {
            total += values[start + k];
        }
    }
    partial[lane] = total;
    workgroupBarrier();
    for (var reach = 1u; reach < WIDTH; reach *= 2u) {
        var before = 0u;
        if lane >= reach {
            before = partial[lane - reach];
        }
        workgroupBarrier();
        partial[lane] += before;
        workgroupBarrier();
    }
    let before = partial[lane] - total;
    for (var k = 0u; k < RUN; k++) {
        if start + k < count {
            values[start + k] = before + own[k];
        }
    }
    if lane == WIDTH - 1u {
        sums[group.x] = partial[lane];
    }
}

@compute @workgroup_size(WIDTH)
fn raise_blocks(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    let start = (group.x * WIDTH + lane) * RUN;
    for (var k = 0u; k < RUN; k++) {
        if start + k < count {
            values[start + k] += sums[group.x];
        }
    }
}
