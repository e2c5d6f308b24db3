//! What a verb makes for a caller.

use glam::DVec3;

use crate::io::{Colours, DistanceSamples, TextureMap, Unit};
use crate::mesh::{TriMesh, Validity};
use crate::picture::Image;
use crate::pipeline::{TriangleKind, TriangleSource};

/// What a verb has made.
#[derive(Debug, Clone)]
pub enum Product {
    /// A mesh.
    Mesh(Box<MeshProduct>),
    /// Values over a lattice.
    Grid(GridProduct),
    /// A picture.
    Picture(Image),
}

/// A mesh that a verb has made.
#[derive(Debug, Clone)]
pub struct MeshProduct {
    /// The triangles.
    pub mesh: TriMesh,
    /// What is known of it.
    pub validity: Validity,
    /// Where each triangle comes from; `None` where the verb does not tell.
    pub sources: Option<Vec<TriangleSource>>,
    /// What each triangle is; `None` where the verb does not tell.
    pub kinds: Option<Vec<TriangleKind>>,
    /// Its colours.
    pub colours: Option<Colours>,
    /// Its textures.
    pub texture: Option<TextureMap>,
    /// The unit of its coordinates.
    pub unit: Option<Unit>,
}

/// Values over a lattice.
#[derive(Debug, Clone, PartialEq)]
pub struct GridProduct {
    /// The values, model units, negative inside; x runs fastest, z slowest.
    pub values: Vec<f32>,
    /// Voxels along x, y, z.
    pub dims: [usize; 3],
    /// The place of the first voxel, model units.
    pub origin: DVec3,
    /// The distance between neighbouring voxels, model units.
    pub spacing: f64,
    /// How far from the surface values are distances; beyond they are this. `None`: everywhere.
    pub band: Option<f64>,
    /// The unit of all lengths.
    pub unit: Option<Unit>,
}

impl GridProduct {
    pub(super) fn of(samples: &DistanceSamples<'_>) -> Self {
        let [x, y, z] = samples.dims;
        let mut values = Vec::with_capacity(x * y * z);
        (0..z).for_each(|level| (samples.plane)(level, &mut values));
        let DistanceSamples { dims, origin, spacing, band, unit, .. } = *samples;
        Self { values, dims, origin, spacing, band, unit }
    }
}
