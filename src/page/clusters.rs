//! The defects of a mesh, gathered: those of one kind that hang together are one.

use std::collections::BTreeMap;

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::section::Place;
use crate::mesh::edges::Union;
use crate::mesh::weld::first_of_equal;
use crate::mesh::{Bounds, Defects, TriMesh};

/// A kind of defect, the gravest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DefectKind {
    /// Edges with one triangle.
    OpenEdges,
    /// Triangles that cross others.
    Crossing,
    /// Edges with more than two triangles.
    NonManifoldEdges,
    /// Edges whose triangles face opposite ways.
    Inconsistent,
    /// Vertices at which surfaces touch.
    NonManifoldVertices,
    /// Triangles that repeat others.
    Repeated,
    /// Triangles without area.
    NoArea,
}

impl DefectKind {
    /// All of them, the gravest first.
    pub const ALL: [Self; 7] = [
        Self::OpenEdges,
        Self::Crossing,
        Self::NonManifoldEdges,
        Self::Inconsistent,
        Self::NonManifoldVertices,
        Self::Repeated,
        Self::NoArea,
    ];

    /// What one of them is called.
    pub fn word(self) -> &'static str {
        match self {
            Self::OpenEdges => "open edge",
            Self::Crossing => "crossing triangle",
            Self::NonManifoldEdges => "edge with more than two triangles",
            Self::Inconsistent => "edge between triangles that face opposite ways",
            Self::NonManifoldVertices => "vertex that joins surfaces",
            Self::Repeated => "repeated triangle",
            Self::NoArea => "triangle without area",
        }
    }

    /// The same of several.
    pub fn words(self) -> &'static str {
        match self {
            Self::OpenEdges => "open edges",
            Self::Crossing => "crossing triangles",
            Self::NonManifoldEdges => "edges with more than two triangles",
            Self::Inconsistent => "edges between triangles that face opposite ways",
            Self::NonManifoldVertices => "vertices that join surfaces",
            Self::Repeated => "repeated triangles",
            Self::NoArea => "triangles without area",
        }
    }

    /// Its colour, one that eyes without a kind of cones tell from the others.
    pub fn colour(self) -> [u8; 3] {
        match self {
            Self::OpenEdges => [213, 94, 0],
            Self::Crossing => [230, 159, 0],
            Self::NonManifoldEdges => [204, 121, 167],
            Self::Inconsistent => [0, 114, 178],
            Self::NonManifoldVertices => [86, 180, 233],
            Self::Repeated => [0, 158, 115],
            Self::NoArea => [90, 60, 150],
        }
    }
}

/// Defects of one kind that hang together.
#[derive(Debug, Clone, PartialEq)]
pub struct Cluster {
    /// Their kind.
    pub kind: DefectKind,
    /// How many there are.
    pub count: usize,
    /// The triangles that have them, ascending.
    pub triangles: Vec<u32>,
    /// The vertices that they are at, ascending; of welded ones the first stands for all.
    pub vertices: Vec<u32>,
    /// The length of their edges, together, model units; 0 of triangles and vertices.
    pub length: f64,
    /// Where they are.
    pub place: Place,
}

/// The defects of a mesh, gathered by kind, those of many parts first. `weld`: whether vertices of equal coordinates count as one.
pub fn clusters(mesh: &TriMesh, defects: &Defects, weld: bool) -> Vec<Cluster> {
    let first: Vec<u32> = match weld {
        true => first_of_equal(&mesh.positions),
        false => (0..mesh.positions.len() as u32).collect(),
    };
    let around = Around::new(mesh, &first, defects);
    let mut found: Vec<Cluster> = Vec::new();
    let mut edges = |kind, list: &[[u32; 2]]| {
        let items: Vec<Item> = list.iter().map(|&ends| Item { at: ends.to_vec(), of: around.edge(ends) }).collect();
        found.extend(gathered(mesh, kind, items));
    };
    edges(DefectKind::OpenEdges, &defects.open_edges);
    edges(DefectKind::NonManifoldEdges, &defects.nonmanifold_edges);
    edges(DefectKind::Inconsistent, &defects.inconsistent_edges);
    let mut triangles = |kind, list: &[u32]| {
        let at = |t: u32| mesh.triangles[t as usize].map(|v| first[v as usize]).to_vec();
        let items: Vec<Item> = list.iter().map(|&t| Item { at: at(t), of: vec![t] }).collect();
        found.extend(gathered(mesh, kind, items));
    };
    triangles(DefectKind::Crossing, &defects.self_intersecting);
    triangles(DefectKind::Repeated, &defects.duplicates);
    triangles(DefectKind::NoArea, &defects.degenerate);
    let vertices: Vec<Item> =
        defects.nonmanifold_vertices.iter().map(|&v| Item { at: vec![v], of: around.vertex(v) }).collect();
    found.extend(gathered(mesh, DefectKind::NonManifoldVertices, vertices));
    found.sort_by(|a, b| a.kind.cmp(&b.kind).then(b.count.cmp(&a.count)).then(b.length.total_cmp(&a.length)));
    found
}

/// One defect: its vertices, and the triangles that have it.
struct Item {
    at: Vec<u32>,
    of: Vec<u32>,
}

/// The triangles at vertices that have a defect.
struct Around {
    at: FxHashMap<u32, Vec<u32>>,
}

impl Around {
    fn new(mesh: &TriMesh, first: &[u32], defects: &Defects) -> Self {
        let edges = [&defects.open_edges, &defects.nonmanifold_edges, &defects.inconsistent_edges];
        let ends = edges.into_iter().flatten().flatten().chain(&defects.nonmanifold_vertices);
        let mut at: FxHashMap<u32, Vec<u32>> = ends.map(|&v| (v, Vec::new())).collect();
        for (t, corners) in (0u32..).zip(&mesh.triangles) {
            for v in corners {
                if let Some(list) = at.get_mut(&first[*v as usize]) {
                    list.push(t);
                }
            }
        }
        Self { at }
    }

    fn vertex(&self, v: u32) -> Vec<u32> {
        self.at.get(&v).cloned().unwrap_or_default()
    }

    fn edge(&self, [a, b]: [u32; 2]) -> Vec<u32> {
        let other = self.vertex(b);
        self.vertex(a).into_iter().filter(|t| other.contains(t)).collect()
    }
}

/// Those that share vertices as one.
fn gathered(mesh: &TriMesh, kind: DefectKind, items: Vec<Item>) -> Vec<Cluster> {
    let mut numbers: FxHashMap<u32, u32> = FxHashMap::default();
    let mut union = Union::new(items.len());
    for (n, item) in (0u32..).zip(&items) {
        for &v in &item.at {
            let other = *numbers.entry(v).or_insert(n);
            union.join(n, other);
        }
    }
    let mut sets: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    (0..items.len()).for_each(|n| sets.entry(union.root(n as u32)).or_default().push(n));
    sets.into_values().filter_map(|set| cluster(mesh, kind, set.iter().map(|&n| &items[n]))).collect()
}

fn cluster<'a>(mesh: &TriMesh, kind: DefectKind, items: impl Iterator<Item = &'a Item>) -> Option<Cluster> {
    let (mut triangles, mut points, mut count, mut length) = (Vec::new(), Vec::new(), 0, 0.0);
    let mut rim: Vec<[DVec3; 2]> = Vec::new();
    let mut vertices = Vec::new();
    for item in items {
        vertices.extend(&item.at);
        count += 1;
        triangles.extend(&item.of);
        let at: Vec<DVec3> = item.at.iter().map(|&v| mesh.positions[v as usize]).collect();
        if let &[a, b] = at.as_slice() {
            length += a.distance(b);
            rim.extend(item.of.first().map(|&t| along(mesh.corners(t as usize), [a, b])));
        }
        points.extend(at);
    }
    triangles.sort_unstable();
    triangles.dedup();
    vertices.sort_unstable();
    vertices.dedup();
    let bounds = Bounds::of(points.iter().copied())?;
    let normal = |&t: &u32| {
        let [a, b, c] = mesh.corners(t as usize);
        (b - a).cross(c - a).normalize_or_zero()
    };
    let at = (bounds.min + bounds.max) / 2.0;
    // Where a rim has a plane, the missing surface faces that way; elsewhere what is beside the defect is seen best from its front.
    let swept: DVec3 = rim.iter().map(|[a, b]| (*a - at).cross(*b - at)).sum();
    let missing = if kind == DefectKind::OpenEdges { -swept } else { DVec3::ZERO };
    let from = match missing.length() > 0.02 * length * length {
        true => missing.normalize_or_zero(),
        false => triangles.iter().map(normal).sum::<DVec3>().normalize_or_zero(),
    };
    let place = Place { at, size: bounds.diagonal(), from };
    Some(Cluster { kind, count, triangles, vertices, length, place })
}

/// The ends of an edge in the order in which a triangle has them.
fn along(corners: [DVec3; 3], [a, b]: [DVec3; 2]) -> [DVec3; 2] {
    let runs_so = (0..3).any(|k| corners[k] == a && corners[(k + 1) % 3] == b);
    if runs_so { [a, b] } else { [b, a] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::{ValidateOptions, defects};
    use crate::progress::Progress;

    #[test]
    fn every_rim_is_one_cluster() {
        let mesh = crate::io::read("testdata/open_cube.off").expect("our own").mesh;
        let found = defects(&mesh, &ValidateOptions::default(), &Progress::none()).expect("nothing stops it");
        let list = clusters(&mesh, &found, false);
        assert_eq!(list.iter().map(|cluster| cluster.count).sum::<usize>(), found.open_edges.len());
        assert!(list.iter().all(|cluster| cluster.kind == DefectKind::OpenEdges && cluster.length > 0.0));
        // The missing side is seen from outside.
        let middle = mesh.bounds().map_or(DVec3::ZERO, |bounds| (bounds.min + bounds.max) / 2.0);
        assert!(list.iter().all(|cluster| cluster.place.from.dot(cluster.place.at - middle) > 0.0), "{list:?}");
        assert!(list.iter().all(|cluster| !cluster.triangles.is_empty() && cluster.place.size > 0.0), "{list:?}");
    }
}
