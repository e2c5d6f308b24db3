//! The zero level of a field as a contour with its tangent planes.

use glam::DVec3;
use rayon::prelude::*;

use super::fill::touches_border;
use super::passages::Passages;
use super::{Field, FillError, FillOptions, Sample, SourceTriangle, fill};
use crate::contour::{Contour, ContourOptions, Crossing, Ground, LatticeEdge, contour};
use crate::lattice::Lattice;
use crate::mesh::Plane;
use crate::progress::{Progress, Stopped};

/// Values are found this far from the zero level, h: beyond the ends of the lattice edges that it crosses, where the field is
/// a distance.
const BAND: f64 = 1.2;
/// Tangent planes found in one packet.
const PACKET: usize = 64;
/// A gradient shorter than this is none.
const FLAT: f64 = 1e-6;
/// A vertex lies on a triangle of a source if it is not farther from it than this, h.
const ON_SOURCE: f64 = 1e-5;

/// The zero level of a field.
pub struct Level {
    /// The surface; each vertex lies on the plane with its own number.
    pub contour: Contour,
    /// For each vertex of the contour the tangent plane, model units, normal outwards.
    pub planes: Vec<Plane>,
    /// For each vertex of the contour the triangle that the level lies on there.
    pub sources: Vec<Option<SourceTriangle>>,
    /// Whether the level goes on beyond the lattice, where it was cut off.
    pub cut_off: bool,
}

/// Why there is no level.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LevelError {
    /// The field cannot be filled.
    #[error(transparent)]
    Fill(#[from] FillError),
    /// Interrupted, or the deadline passed.
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// The surface where `field` is zero, on `lattice`. Vertices lie on it to 1e-6 h along their lattice edges. It is empty where
/// no voxel is negative.
///
/// # Errors
/// See [`LevelError`].
pub fn level(
    field: &dyn Field,
    lattice: &Lattice,
    max_memory: Option<u64>,
    progress: &Progress,
) -> Result<Level, LevelError> {
    let options = FillOptions { band: Some(BAND * lattice.h), max_memory };
    let values = fill(field, lattice, &options, progress)?.into_voxels();
    let cut_off = touches_border(&values);
    let passages = Passages::of(field, &values, progress)?;
    progress.share(0.8);
    let crossing = |edge: LatticeEdge| Some(Crossing { t: passages.at(edge)?, triangle: None });
    let mut contour = contour(&values, &crossing, &ContourOptions::default(), progress)?;
    drop(values);
    progress.share(0.9);
    let positions = &contour.mesh.positions;
    let planes: Vec<Plane> = positions.par_chunks(PACKET).flat_map_iter(|points| tangents(field, points)).collect();
    progress.check()?;
    let sources = positions.par_iter().map(|&p| field.source_triangle(p, ON_SOURCE * lattice.h)).collect();
    progress.check()?;
    contour.vertices.iter_mut().zip(0..).for_each(|(vertex, n)| vertex.ground = Ground::Plane(n));
    Ok(Level { contour, planes, sources, cut_off })
}

/// The planes through the points of the level nearest to `points`, by one step along the gradient; without a normal where
/// there is no gradient.
fn tangents(field: &dyn Field, points: &[DVec3]) -> Vec<Plane> {
    let mut samples = vec![Sample::default(); points.len()];
    field.samples(points, &mut samples);
    let plane = |(&p, sample): (&DVec3, Sample)| {
        let steep = sample.gradient.length();
        if !(steep > FLAT && steep.is_finite()) {
            return Plane { normal: DVec3::ZERO, offset: 0.0 };
        }
        let normal = sample.gradient / steep;
        Plane { normal, offset: normal.dot(p) - sample.value / steep }
    };
    points.iter().zip(samples).map(plane).collect()
}
