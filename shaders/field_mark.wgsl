// 1 for every count that is not 0.

@group(0) @binding(0) var<uniform> count: u32;
@group(0) @binding(1) var<storage, read> counts: array<u32>;
@group(0) @binding(2) var<storage, read_write> marks: array<u32>;

const WIDTH: u32 = 64u;

@compute @workgroup_size(WIDTH)
fn mark(@builtin(global_invocation_id) at: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let n = at.y * groups.x * WIDTH + at.x;
    if n < count {
        marks[n] = min(counts[n], 1u);
    }
}
