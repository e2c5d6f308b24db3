//! The soup: triangles as read, nothing assumed.

use glam::DVec3;

/// An axis-aligned box, in the space of the points it was made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The smallest coordinates.
    pub min: DVec3,
    /// The largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The box around `points`; `None` for no points.
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        points.into_iter().fold(None, |bounds, p| match bounds {
            None => Some(Self { min: p, max: p }),
            Some(b) => Some(Self { min: b.min.min(p), max: b.max.max(p) }),
        })
    }

    /// Edge lengths.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Length of the diagonal.
    pub fn diagonal(&self) -> f64 {
        self.size().length()
    }

    /// The box around both.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }
}

/// Triangles over shared vertices, in model units. Counter-clockwise seen from outside where the
/// orientation means anything. Nothing else is assumed: triangles may repeat, intersect,
/// degenerate; vertices may be unused or coincide. Indices are always in range and coordinates
/// always finite: the readers see to that.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, model units.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` for each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl TriMesh {
    /// The corners of triangle `triangle`.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// The box around the vertices that triangles use; `None` without triangles.
    pub fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.triangles.iter().flatten().map(|&v| self.positions[v as usize]))
    }

    /// Adds the triangles of `other` after its own; vertices are not merged.
    pub fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }

    /// The same surface with vertices of equal coordinates merged (−0 equals 0) and unused ones
    /// dropped; triangles keep their order and number. Vertices are numbered by first use.
    pub fn welded(&self) -> Self {
        let mut ids = rustc_hash::FxHashMap::default();
        let mut positions = Vec::new();
        let mut weld = |v: u32| {
            let p = self.positions[v as usize];
            *ids.entry((p + 0.0).to_array().map(f64::to_bits)).or_insert_with(|| {
                positions.push(p);
                positions.len() as u32 - 1
            })
        };
        let triangles = self.triangles.iter().map(|t| t.map(&mut weld)).collect();
        Self { positions, triangles }
    }
}
