// How many crossings each ray has, four to a word, and the largest number of those that do not fit: a byte a ray is sent back instead of a word.

/// Number of rays.
@group(0) @binding(0) var<uniform> count: u32;
/// Where the crossings of each ray end.
@group(0) @binding(1) var<storage, read> ends: array<u32>;
@group(0) @binding(2) var<storage, read_write> packed: array<u32>;
@group(0) @binding(3) var<storage, read_write> largest: array<atomic<u32>, 1>;

const WIDTH: u32 = 64u;
const MOST: u32 = 255u;

@compute @workgroup_size(WIDTH)
fn pack(@builtin(global_invocation_id) at: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let first = 4u * (at.y * groups.x * WIDTH + at.x);
    if first >= count {
        return;
    }
    var start = 0u;
    if first > 0u {
        start = ends[first - 1u];
    }
    var word = 0u;
    for (var k = 0u; k < min(4u, count - first); k++) {
        let end = ends[first + k];
        word |= min(end - start, MOST) << (8u * k);
        if end - start > MOST {
            atomicMax(&largest[0], end - start);
        }
        start = end;
    }
    packed[first / 4u] = word;
}
