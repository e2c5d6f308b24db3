//! The 13 directions of Bærentzen §3, taken as the lattice's own lines.
//!
//! Each direction has components in {-1, 0, 1}. On its *main* axis `c` it is +1; the other two
//! coordinates are sheared by 0 or ±1 times `p_c`, so that the lattice points that lie on one line
//! of the direction share the two sheared coordinates (u, v), and consecutive ones differ by 1 in
//! depth. Every voxel therefore lies exactly on one ray of every direction, at integer depth.

use glam::{DVec3, IVec3};

/// One of the 13 directions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Direction {
    /// Main axis: 0, 1 or 2; depth is the coordinate along it.
    pub main: usize,
    /// Component along axis `main + 1` (cyclic): -1, 0 or 1.
    pub shear_u: i32,
    /// Component along axis `main + 2` (cyclic): -1, 0 or 1.
    pub shear_v: i32,
}

const fn direction(main: usize, shear_u: i32, shear_v: i32) -> Direction {
    Direction { main, shear_u, shear_v }
}

/// The 13 directions: 3 through the faces of the cube (number = axis), 6 through its edges, 4
/// through its corners.
pub const DIRECTIONS: [Direction; 13] = [
    direction(0, 0, 0),
    direction(1, 0, 0),
    direction(2, 0, 0),
    direction(1, 0, 1),
    direction(1, 0, -1),
    direction(1, 1, 0),
    direction(1, -1, 0),
    direction(2, 1, 0),
    direction(2, -1, 0),
    direction(2, 1, 1),
    direction(2, 1, -1),
    direction(2, -1, 1),
    direction(2, -1, -1),
];

impl Direction {
    /// The coordinate axes of u, v and depth.
    #[inline]
    pub fn axes(&self) -> [usize; 3] {
        [(self.main + 1) % 3, (self.main + 2) % 3, self.main]
    }

    /// Sheared coordinates (u, v, depth) of a lattice point.
    #[inline]
    pub fn shear(&self, p: IVec3) -> IVec3 {
        let [a, b, c] = self.axes();
        IVec3::new(p[a] - self.shear_u * p[c], p[b] - self.shear_v * p[c], p[c])
    }

    /// The point, lattice coordinates, at depth `depth` of ray (u, v), both in voxels.
    #[inline]
    pub fn unshear(&self, u: f64, v: f64, depth: f64) -> DVec3 {
        let [a, b, c] = self.axes();
        let mut p = DVec3::ZERO;
        p[a] = u + self.shear_u as f64 * depth;
        p[b] = v + self.shear_v as f64 * depth;
        p[c] = depth;
        p
    }

    /// The lattice point at sheared coordinates (u, v, depth).
    #[inline]
    pub fn unshear_voxel(&self, u: i32, v: i32, depth: i32) -> IVec3 {
        let [a, b, c] = self.axes();
        let mut p = IVec3::ZERO;
        p[a] = u + self.shear_u * depth;
        p[b] = v + self.shear_v * depth;
        p[c] = depth;
        p
    }

    /// The direction as a vector, lattice coordinates.
    pub fn vector(&self) -> IVec3 {
        let [a, b, c] = self.axes();
        let mut d = IVec3::ZERO;
        d[a] = self.shear_u;
        d[b] = self.shear_v;
        d[c] = 1;
        d
    }

    /// Smallest (u, v) of the rays through a lattice of `dims` voxels, and the number of rays along
    /// u and v.
    pub fn ray_window(&self, dims: IVec3) -> ([i32; 2], [i32; 2]) {
        let [a, b, c] = self.axes();
        let depth = dims[c] - 1;
        let low = [-self.shear_u.max(0) * depth, -self.shear_v.max(0) * depth];
        (low, [dims[a] + self.shear_u.abs() * depth, dims[b] + self.shear_v.abs() * depth])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_directions_are_the_lines_through_the_26_neighbours() {
        let mut seen: Vec<IVec3> = DIRECTIONS.iter().flat_map(|d| [d.vector(), -d.vector()]).collect();
        seen.sort_unstable_by_key(|d| d.to_array());
        seen.dedup();
        assert_eq!(seen.len(), 26);
    }

    #[test]
    fn every_voxel_lies_on_one_ray_of_the_window_at_integer_depth() {
        let dims = IVec3::new(3, 4, 5);
        for d in DIRECTIONS {
            let (low, size) = d.ray_window(dims);
            for (x, y, z) in (0..3).flat_map(|x| (0..4).flat_map(move |y| (0..5).map(move |z| (x, y, z)))) {
                let p = IVec3::new(x, y, z);
                let s = d.shear(p);
                assert!(s.x >= low[0] && s.x < low[0] + size[0] && s.y >= low[1] && s.y < low[1] + size[1]);
                assert_eq!(d.unshear(s.x as f64, s.y as f64, s.z as f64), p.as_dvec3());
                assert_eq!(d.unshear_voxel(s.x, s.y, s.z), p);
                assert_eq!(d.shear(p + d.vector()), s + IVec3::Z);
            }
        }
    }
}
