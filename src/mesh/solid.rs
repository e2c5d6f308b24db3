//! A solid: a mesh that has been checked to bound one.

use std::ops::Deref;

use super::{Defects, IndexError, TriMesh, ValidateOptions, Validity, defects, validate};
use crate::progress::{Progress, Stopped};

/// A mesh that bounds a solid: closed, oriented, 2-manifold, of positive volume, and free of degenerate, repeated and
/// intersecting triangles. A value of this type is a proof: only [`Solid::check`] and [`Solid::try_from`] make one, and every
/// pipeline ends in that check. What needs a solid takes `&Solid`; what reads a mesh takes it too, since it dereferences to
/// [`TriMesh`].
///
/// ```
/// use meshwright::glam::DVec3;
/// use meshwright::mesh::{Solid, SolidError, TriMesh};
///
/// let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
/// let mut mesh = TriMesh { positions: corners.into(), triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]] };
/// let solid = Solid::try_from(mesh.clone()).expect("a tetrahedron is a solid");
/// assert!((solid.validity().volume - 1.0 / 6.0).abs() < 1e-12);
///
/// mesh.triangles.pop();
/// let Err(SolidError::NotSolid(refused)) = Solid::try_from(mesh) else { panic!("one side is missing") };
/// assert_eq!(refused.defects.open_edges.len(), 3);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Solid {
    mesh: TriMesh,
    validity: Validity,
}

/// What is wrong with a mesh that is no [`Solid`]: how much of each kind, and where.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("the mesh does not bound a solid: {}", validity.problems().join("; "))]
pub struct NotSolid {
    /// The mesh, as it was given.
    pub mesh: TriMesh,
    /// How many defects of each kind there are; [`Validity::problems`] says them in sentences.
    pub validity: Validity,
    /// The edges, vertices and triangles that are wrong, by their numbers in `mesh`.
    pub defects: Defects,
}

/// Why there is no [`Solid`].
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolidError {
    /// The check was interrupted, or its deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
    /// A triangle refers to a vertex that is not there.
    #[error(transparent)]
    Index(#[from] IndexError),
    /// The mesh bounds none.
    #[error(transparent)]
    NotSolid(Box<NotSolid>),
}

impl Solid {
    /// The mesh as a solid, if it is one.
    ///
    /// # Errors
    /// [`SolidError::NotSolid`] says what is wrong, and gives the mesh back; [`SolidError::Index`] for an index out of range.
    pub fn check(mesh: TriMesh, progress: &Progress) -> Result<Self, SolidError> {
        mesh.check()?;
        let options = ValidateOptions { self_intersections: true, weld: false };
        let validity = validate(&mesh, &options, progress)?;
        if validity.is_valid() {
            return Ok(Self { mesh, validity });
        }
        let defects = defects(&mesh, &options, progress)?;
        Err(SolidError::NotSolid(Box::new(NotSolid { mesh, validity, defects })))
    }

    /// The mesh.
    pub fn mesh(&self) -> &TriMesh {
        &self.mesh
    }

    /// The mesh by itself, without the proof.
    pub fn into_mesh(self) -> TriMesh {
        self.mesh
    }

    /// What the check found: counts, volume (cubic model units), area, bounds.
    pub fn validity(&self) -> &Validity {
        &self.validity
    }
}

impl Deref for Solid {
    type Target = TriMesh;

    fn deref(&self) -> &TriMesh {
        &self.mesh
    }
}

impl PartialEq<TriMesh> for Solid {
    fn eq(&self, other: &TriMesh) -> bool {
        self.mesh == *other
    }
}

impl AsRef<TriMesh> for Solid {
    fn as_ref(&self) -> &TriMesh {
        &self.mesh
    }
}

impl TryFrom<TriMesh> for Solid {
    type Error = SolidError;

    fn try_from(mesh: TriMesh) -> Result<Self, SolidError> {
        Self::check(mesh, &Progress::none())
    }
}

impl From<Solid> for TriMesh {
    fn from(solid: Solid) -> Self {
        solid.mesh
    }
}
