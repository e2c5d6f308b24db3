//! The loops of open edges of a mesh, with their measures.

use glam::DVec3;
use nalgebra::{Matrix3, SymmetricEigen};
use rustc_hash::FxHashMap;

use crate::mesh::edges::Edges;
use crate::mesh::weld::has_repeated_index;
use crate::mesh::{Plane, TriMesh};

/// No half-edge.
const NONE: u32 = u32::MAX;

/// Loops of up to so many vertices have their diameter measured over all pairs of points.
const ALL_PAIRS: usize = 2000;

/// Directions in which longer loops are measured.
const DIRECTIONS: usize = 256;

/// One loop of open edges: the rim of a hole, or of a sheet.
#[derive(Debug, Clone, PartialEq)]
pub struct Rim {
    /// The vertices in the order in which the triangles of a lid run along the rim: opposite to the triangles beside it. No vertex
    /// stands twice. The first is the one with the smallest coordinates (x, then y, then z), so that it does not depend on numbers.
    pub vertices: Vec<u32>,
    /// Length of the loop, model units.
    pub perimeter: f64,
    /// Area that the loop encloses when seen along the direction where that is largest (half the length of the sum of the
    /// cross products), square model units.
    pub area: f64,
    /// Largest distance between two vertices. For loops of more than 2,000 vertices it is the largest width in 256 directions, which
    /// is at most 1 % less.
    pub diameter: f64,
    /// The plane that fits the loop best, by least squares along its edges. Its normal points to the outside of a lid.
    pub plane: Plane,
    /// Largest distance of a vertex from the plane.
    pub flatness: f64,
    /// The mean of the points of the loop, along its length.
    pub centre: DVec3,
}

/// The rims of a mesh, the longest first; those of one length by the place of their vertices.
///
/// An edge is open as often as more triangles run along it in one direction than in the other. The vertices of the mesh have to be merged, and the triangles
/// should agree in direction; triangles with a repeated vertex take no part.
///
/// Open edges always form closed loops: the boundary of every triangle is a loop, and where two triangles run along an edge in opposite directions
/// it cancels out, so that as many open edges arrive at each vertex as leave it. Where several loops meet in a vertex, the way leaves by the other end of the fan of triangles
/// that it came along, and a loop that comes to a vertex again is divided there. So every loop visits a vertex once.
pub fn rims(mesh: &TriMesh) -> Vec<Rim> {
    let twin = twins(mesh);
    let end = |half: u32| mesh.triangles[half as usize / 3][(half as usize % 3 + 1) % 3];
    let mut seen = vec![false; twin.len()];
    let mut rims = Vec::new();
    for first in (0..twin.len() as u32).filter(|&half| is_open(mesh, &twin, half)) {
        if seen[first as usize] {
            continue;
        }
        let mut around = Vec::new();
        let mut at = first;
        while !seen[at as usize] {
            seen[at as usize] = true;
            around.push(end(at));
            at = next_open(&twin, at);
        }
        rims.extend(simple_loops(&around).into_iter().map(|vertices| Rim::new(mesh, vertices)));
    }
    rims.sort_by(|a, b| {
        let places =
            |rim: &Rim| rim.vertices.iter().map(|&v| mesh.positions[v as usize].to_array()).collect::<Vec<_>>();
        let by_length = b.perimeter.total_cmp(&a.perimeter);
        by_length.then_with(|| places(a).partial_cmp(&places(b)).unwrap_or(std::cmp::Ordering::Equal))
    });
    rims
}

/// For each half-edge the one that runs the other way. Where more than two triangles meet they are paired in order, and those left over have none.
fn twins(mesh: &TriMesh) -> Vec<u32> {
    let mut twin = vec![NONE; 3 * mesh.triangles.len()];
    let edges = Edges::new(&mesh.triangles, mesh.positions.len());
    edges.each(|edge| {
        let up = edge.halves().filter(|&half| edges.runs_up(half));
        let down = edge.halves().filter(|&half| !edges.runs_up(half));
        for (a, b) in up.zip(down) {
            twin[a as usize] = b;
            twin[b as usize] = a;
        }
    });
    twin
}

fn is_open(mesh: &TriMesh, twin: &[u32], half: u32) -> bool {
    twin[half as usize] == NONE && !has_repeated_index(mesh.triangles[half as usize / 3])
}

/// The open half-edge that ends where `half` starts, at the other end of the fan of triangles around that vertex.
fn next_open(twin: &[u32], half: u32) -> u32 {
    let mut at = half;
    loop {
        let before = if at.is_multiple_of(3) { at + 2 } else { at - 1 };
        if twin[before as usize] == NONE {
            return before;
        }
        at = twin[before as usize];
    }
}

/// Divides a closed way into loops that visit each vertex once. The parts between two visits are split off first.
fn simple_loops(around: &[u32]) -> Vec<Vec<u32>> {
    let mut place: FxHashMap<u32, usize> = FxHashMap::default();
    let mut way: Vec<u32> = Vec::new();
    let mut loops = Vec::new();
    for &v in around {
        if let Some(&start) = place.get(&v) {
            let part = way.split_off(start);
            part.iter().for_each(|v| _ = place.remove(v));
            loops.push(part);
        }
        place.insert(v, way.len());
        way.push(v);
    }
    loops.push(way);
    loops.retain(|part| part.len() > 2);
    loops
}

impl Rim {
    /// Measures a loop of vertices.
    fn new(mesh: &TriMesh, mut vertices: Vec<u32>) -> Self {
        let at = |v: u32| mesh.positions[v as usize];
        let first = (0..vertices.len()).min_by(|&a, &b| {
            let places = [a, b].map(|k| at(vertices[k]).to_array());
            places[0].partial_cmp(&places[1]).unwrap_or(std::cmp::Ordering::Equal)
        });
        vertices.rotate_left(first.unwrap_or(0));
        let points: Vec<DVec3> = vertices.iter().map(|&v| at(v)).collect();
        let lengths: Vec<f64> = each_edge(&points).map(|[a, b]| a.distance(b)).collect();
        let perimeter: f64 = lengths.iter().sum();
        let middle = |[a, b]: [DVec3; 2]| (a - points[0] + (b - points[0])) / 2.0;
        let weighted = each_edge(&points).zip(&lengths).map(|(edge, &length)| middle(edge) * length).sum::<DVec3>();
        let centre = if perimeter > 0.0 { points[0] + weighted / perimeter } else { points[0] };
        let twice: DVec3 = each_edge(&points).map(|[a, b]| (a - centre).cross(b - centre)).sum();
        let normal = normal_of(&points, &lengths, centre, twice);
        let plane = Plane { normal, offset: normal.dot(centre) };
        let flatness = points.iter().fold(0.0, |most: f64, &p| most.max(normal.dot(p - centre).abs()));
        Self { perimeter, area: twice.length() / 2.0, diameter: diameter(&points), plane, flatness, centre, vertices }
    }
}

/// The edges of a closed loop, each from its start to its end.
pub(super) fn each_edge(points: &[DVec3]) -> impl Iterator<Item = [DVec3; 2]> + '_ {
    (0..points.len()).map(|k| [points[k], points[(k + 1) % points.len()]])
}

/// The normal of the plane of least squares, on the side of `twice`, the sum of the cross products.
fn normal_of(points: &[DVec3], lengths: &[f64], centre: DVec3, twice: DVec3) -> DVec3 {
    let size = points.iter().fold(0.0, |most: f64, p| most.max((*p - centre).abs().max_element()));
    if size == 0.0 || !size.is_finite() {
        return DVec3::ZERO;
    }
    let mut matrix = Matrix3::zeros();
    let mut add = |p: DVec3, weight: f64| {
        let v = nalgebra::Vector3::new(p.x, p.y, p.z);
        matrix += v * v.transpose() * weight;
    };
    for ([a, b], &length) in each_edge(points).zip(lengths) {
        let [a, b] = [(a - centre) / size, (b - centre) / size];
        // Simpson's rule, which is exact for squares.
        add(a, length / size / 6.0);
        add((a + b) / 2.0, length / size * 4.0 / 6.0);
        add(b, length / size / 6.0);
    }
    let eigen = SymmetricEigen::new(matrix);
    let least = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    let normal = DVec3::new(least[0], least[1], least[2]).normalize_or_zero();
    let flat = twice.normalize_or_zero();
    // A loop in one plane has its normal exactly from its cross products; for one that encloses little they say only the side.
    let normal = if flat.dot(normal).abs() > 0.9999 { flat } else { normal };
    if normal.dot(twice) < 0.0 { -normal } else { normal }
}

fn diameter(points: &[DVec3]) -> f64 {
    if points.len() <= ALL_PAIRS {
        let farthest = |k: usize| points[k + 1..].iter().fold(0.0, |most: f64, p| most.max(p.distance(points[k])));
        return (0..points.len()).map(farthest).fold(0.0, f64::max);
    }
    // Directions spread evenly over half a sphere, on a spiral.
    let turn = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let width = |k: usize| {
        let z = (k as f64 + 0.5) / DIRECTIONS as f64;
        let (sin, cos) = (turn * k as f64).sin_cos();
        let direction = DVec3::new(cos, sin, 0.0) * (1.0 - z * z).sqrt() + DVec3::Z * z;
        let ends = points.iter().map(|p| direction.dot(*p));
        ends.clone().fold(f64::MIN, f64::max) - ends.fold(f64::MAX, f64::min)
    };
    (0..DIRECTIONS).map(width).fold(0.0, f64::max)
}
