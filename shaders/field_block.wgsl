/// A block of voxels, and the features that can be nearest to one of them: `count` from `start` on in the lists of its level.
struct Block {
    /// First voxel.
    x: i32,
    y: i32,
    z: i32,
    start: u32,
    count: u32,
}
