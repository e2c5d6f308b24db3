// The blocks of a region that have any feature, close together.

/// Number of blocks, blocks along x and y, voxels along a side; then the first voxel.
struct Grid {
    count: u32,
    across: vec2<i32>,
    size: i32,
    base: vec4<i32>,
}

@group(0) @binding(0) var<uniform> grid: Grid;
/// Where the list of each block ends.
@group(0) @binding(1) var<storage, read> ends: array<u32>;
/// Numbers among the blocks that have any feature.
@group(0) @binding(2) var<storage, read> places: array<u32>;
@group(0) @binding(3) var<storage, read_write> blocks: array<Block>;

const WIDTH: u32 = 64u;

@compute @workgroup_size(WIDTH)
fn open(@builtin(global_invocation_id) at: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let n = at.y * groups.x * WIDTH + at.x;
    if n >= grid.count {
        return;
    }
    var start = 0u;
    if n > 0u {
        start = ends[n - 1u];
    }
    if ends[n] > start {
        let k = i32(n);
        let block = vec3(k % grid.across.x, k / grid.across.x % grid.across.y, k / (grid.across.x * grid.across.y));
        let voxel = grid.base.xyz + grid.size * block;
        blocks[places[n]] = Block(voxel.x, voxel.y, voxel.z, start, ends[n] - start);
    }
}
