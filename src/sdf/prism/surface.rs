//! A closed surface as the prisms see it: normals of neighbours, and axes of vertices.

use glam::DVec3;
use rayon::prelude::*;

use crate::lattice::Lattice;
use crate::mesh::edges::Edges;
use crate::mesh::weld::welded_triangles;
use crate::mesh::{Pseudonormals, TriMesh};

/// Triangles lower than this, h, have no prism: their sides are as near.
const LOWEST: f64 = 1e-5;

/// A direction whose cosine to an edge is at most this is against it.
const ROUNDING: f64 = 1e-9;

/// Of a vertex with more edges than this, only the rays between so many are looked at.
const MOST_EDGES: usize = 64;

/// The surface, lattice coordinates.
pub(super) struct PrismSurface {
    pub positions: Vec<DVec3>,
    /// The welded triangles.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals of the triangles; `None` for those without a plane.
    pub normals: Vec<Option<DVec3>>,
    pub pseudonormals: Pseudonormals,
    /// For each side of each triangle the one triangle on its other side.
    beyond: Vec<[Option<u32>; 3]>,
    /// For each vertex the direction that points nearest to it lie around, and the sign of their distance.
    axes: Vec<Option<(DVec3, f64)>>,
}

impl PrismSurface {
    pub(super) fn new(mesh: &TriMesh, lattice: &Lattice) -> Self {
        let triangles = welded_triangles(mesh);
        let positions: Vec<DVec3> = mesh.positions.par_iter().map(|&p| lattice.to_lattice(p)).collect();
        let edges = Edges::new(&triangles, positions.len());
        let pseudonormals = Pseudonormals::over(mesh, &triangles, &edges);
        let normals = triangles.par_iter().map(|t| normal(t.map(|v| positions[v as usize]))).collect();
        let mut beyond = vec![[None; 3]; triangles.len()];
        let mut around: Vec<Vec<DVec3>> = vec![Vec::new(); positions.len()];
        edges.each(|edge| {
            let halves: Vec<u32> = edge.halves().take(3).collect();
            if let &[a, b] = halves.as_slice() {
                beyond[a as usize / 3][a as usize % 3] = Some(b / 3);
                beyond[b as usize / 3][b as usize % 3] = Some(a / 3);
            }
            let [from, to] = edge.ends.map(|v| positions[v as usize]);
            let way = (to - from).normalize_or_zero();
            around[edge.ends[0] as usize].push(way);
            around[edge.ends[1] as usize].push(-way);
        });
        let mut corner_of = vec![None; positions.len()];
        for (t, triangle) in triangles.iter().enumerate() {
            (0..3).for_each(|k| corner_of[triangle[k] as usize] = Some((t, k)));
        }
        let axis_at = |(around, corner): (&Vec<DVec3>, &Option<(usize, usize)>)| {
            let (t, k) = (*corner)?;
            axis(around, pseudonormals.of_corner(t, k).normalize_or_zero())
        };
        let axes = around.par_iter().zip(&corner_of).map(axis_at).collect();
        Self { positions, triangles, normals, pseudonormals, beyond, axes }
    }

    pub(super) fn corners(&self, t: usize) -> [DVec3; 3] {
        self.triangles[t].map(|v| self.positions[v as usize])
    }

    /// The normal of the triangle beyond side `k` of triangle `t`, where there is just one and it has a plane.
    pub(super) fn neighbour(&self, t: usize, k: usize) -> Option<DVec3> {
        self.beyond[t][k].and_then(|other| self.normals[other as usize])
    }

    /// The direction from vertex `v` that points nearest to it lie around, if their distance has the sign.
    pub(super) fn axis(&self, v: u32, sign: f64) -> Option<DVec3> {
        self.axes[v as usize].filter(|axis| axis.1 * sign >= 0.0).map(|axis| axis.0)
    }
}

fn normal([a, b, c]: [DVec3; 3]) -> Option<DVec3> {
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    let double = (b - a).cross(c - a);
    double.try_normalize().filter(|_| double.length() > LOWEST * longest)
}

/// A direction that points nearest to a vertex with these `edges` lie around, with the side it is on; `None` where no
/// direction is against all edges. The pseudonormal, else the middle of the cone of such directions, whose rays are square to
/// two edges each.
fn axis(edges: &[DVec3], pseudonormal: DVec3) -> Option<(DVec3, f64)> {
    let against = |axis: DVec3| edges.iter().all(|edge| edge.dot(axis) <= ROUNDING);
    let flat = edges.iter().all(|edge| edge.dot(pseudonormal).abs() <= ROUNDING);
    for sign in [1.0, -1.0] {
        if against(pseudonormal * sign) {
            return Some((pseudonormal * sign, if flat { 0.0 } else { sign }));
        }
    }
    let some = &edges[..edges.len().min(MOST_EDGES)];
    let pairs = some.iter().enumerate().flat_map(|(n, a)| some[..n].iter().map(move |b| a.cross(*b)));
    let rays = pairs.filter_map(DVec3::try_normalize).flat_map(|ray| [ray, -ray]).filter(|&ray| against(ray));
    let axis = rays.sum::<DVec3>().try_normalize()?;
    Some((axis, axis.dot(pseudonormal)))
}
