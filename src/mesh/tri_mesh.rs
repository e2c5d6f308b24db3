//! The soup: triangles as read, nothing assumed.

use glam::DVec3;
use rayon::prelude::*;

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

/// Triangles over shared vertices, in model units. They are counter-clockwise seen from outside where the
/// orientation means anything. Nothing else is assumed of them: triangles may repeat, intersect or
/// degenerate; vertices may be unused or coincide.
///
/// # Indices and coordinates
///
/// Both fields are public, because meshes are put together and taken apart in many places. What must hold is that
/// every index is in range. [`TriMesh::new`] checks it, the readers of [`crate::io`] return nothing else, and the
/// pipelines and the writers refuse a mesh that fails [`TriMesh::check`] with a typed error. The single stages rely on it:
/// given a mesh that fails the check, they may panic.
///
/// A coordinate that is NaN or infinite is no error here. Readers leave out the faces at such vertices, with a warning;
/// [`validate`](crate::mesh::validate) finds that the mesh has no volume and so bounds no solid; [`repair`](crate::pipeline::repair) and the booleans end with an error that
/// names the triangle; the other pipelines never make a wrong solid of them; the writers refuse the mesh and name the vertex. Who makes meshes by hand should drop such vertices,
/// as the readers do.
///
/// ```
/// use glam::DVec3;
/// use meshwright::mesh::TriMesh;
///
/// let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mesh = TriMesh::new(corners.clone(), vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]])?;
/// assert_eq!(mesh.corners(0), [DVec3::ZERO, DVec3::Y, DVec3::X]);
///
/// let error = TriMesh::new(corners, vec![[0, 2, 1], [0, 1, 4]]).unwrap_err();
/// assert_eq!((error.triangle, error.index, error.vertices), (1, 4, 4));
/// # Ok::<(), meshwright::mesh::IndexError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct TriMesh {
    /// Vertex positions, model units.
    pub positions: Vec<DVec3>,
    /// Three indices into `positions` for each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// A triangle refers to a vertex that the mesh does not have.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error(
    "triangle {triangle} refers to vertex {index}, which is not there: the mesh has {vertices} vertices, numbered from 0"
)]
pub struct IndexError {
    /// The number of the first such triangle, from 0.
    pub triangle: usize,
    /// The index that is out of range.
    pub index: u32,
    /// How many vertices there are; every index must be below this.
    pub vertices: usize,
}

impl TriMesh {
    /// A mesh of these vertices and triangles, as they are. Nothing is merged, dropped or turned.
    ///
    /// # Errors
    /// [`IndexError`] when a triangle refers to a vertex that is not there.
    pub fn new(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Result<Self, IndexError> {
        let mesh = Self { positions, triangles };
        mesh.check()?;
        Ok(mesh)
    }

    /// Checks that every triangle refers to vertices that are there.
    ///
    /// # Errors
    /// [`IndexError`] for the first triangle that does not.
    pub fn check(&self) -> Result<(), IndexError> {
        let vertices = self.positions.len();
        let outside = |&index: &u32| index as usize >= vertices;
        let first = self.triangles.iter().enumerate().find_map(|(triangle, corners)| {
            let index = corners.iter().copied().find(outside)?;
            Some(IndexError { triangle, index, vertices })
        });
        first.map_or(Ok(()), Err)
    }

    /// The first triangle with a corner that is NaN or infinite.
    pub fn first_not_finite(&self) -> Option<usize> {
        (0..self.triangles.len()).find(|&t| !self.corners(t).iter().all(|p| p.is_finite()))
    }

    /// The corners of triangle `triangle`.
    #[inline]
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|v| self.positions[v as usize])
    }

    /// The box around the vertices that triangles use; `None` without triangles.
    pub fn bounds(&self) -> Option<Bounds> {
        let of = |triangles: &[[u32; 3]]| Bounds::of(triangles.iter().flatten().map(|&v| self.positions[v as usize]));
        self.triangles.par_chunks(1 << 16).filter_map(of).reduce_with(|a, b| a.union(&b))
    }

    /// Adds the triangles of `other` after its own; vertices are not merged.
    pub fn append(&mut self, other: &Self) {
        let first = self.positions.len() as u32;
        self.positions.extend_from_slice(&other.positions);
        self.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    }
}
