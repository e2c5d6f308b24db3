//! The exact signed distance over a lattice by characteristics and scan conversion (Mauch 2003, as Sigg et al. 2003
//! tell it in §3.2): the reference that other ways to the same field are compared with.
//!
//! Every face has a tower over both of its sides, every edge a wedge and every vertex a cone where the surface bends
//! away: convex polyhedra that hold all points within the band that can have it as their nearest. Each is scan converted on
//! its own, and each voxel keeps the least distance. Saddle edges and vertices are no cases: a vertex has the
//! half-spaces square to its edges, whatever is left between them.
//!
//! The same field as [`exact()`](crate::sdf::exact::exact) makes, from the same features and with the same rules for
//! ties and for what is beyond the band, by a search that shares nothing with it.

mod polyhedron;
mod scan;

use rayon::current_num_threads;

use crate::lattice::{BRICK, DistanceField, Lattice};
use crate::mesh::TriMesh;
use crate::progress::Progress;
use crate::sdf::exact::{self, Band, Cost, ExactError, ExactOptions, Features, Sign};

/// Bytes per voxel of the slabs that are in work, beside what is finished.
const SLAB_BYTES: f64 = 8.0;
/// Seconds on one core per voxel, per triangle, and per triangle and h of the band.
const SECONDS_PER_VOXEL: f64 = 50e-9;
const SECONDS_PER_TRIANGLE: f64 = 8e-6;
const SECONDS_PER_SLICE: f64 = 0.4e-6;
/// So many h of band add one polyhedron to those that a voxel is in.
const OVERLAP: f64 = 50.0;

/// The signed distance to `mesh` at the voxels of `lattice`, counted in voxels.
///
/// `mesh` is closed and oriented, without self-intersections. The result means the same as that of
/// [`exact()`](crate::sdf::exact::exact) with [`Sign::Pseudonormal`]: voxels within the band are as far from it as `f32` tells,
/// those beyond it in active bricks have ± the band's width, and other bricks have their side. It does not depend on
/// the number of threads. Time grows with the volumes of all towers, wedges and cones together: fast for narrow bands,
/// and ever slower than `exact` as they get wider and overlap.
///
/// # Errors
/// See [`ExactError`]; memory is that of [`cost()`].
pub fn characteristics(
    mesh: &TriMesh,
    lattice: &Lattice,
    options: &ExactOptions,
    progress: &Progress,
) -> Result<DistanceField, ExactError> {
    let needed = cost(mesh, lattice, options.band).memory;
    exact::whole(mesh, lattice, Sign::Pseudonormal, options, needed, progress, |scope| {
        let features = Features::of(mesh, lattice, scope.band);
        progress.check()?;
        Ok(scan::bricks(&features, scope, progress)?)
    })
}

/// What [`characteristics()`] would cost, estimated from area and extent alone.
pub fn cost(mesh: &TriMesh, lattice: &Lattice, band: Band) -> Cost {
    let exact = exact::cost(mesh, lattice, band);
    let voxels = exact.voxels as f64;
    let slabs = f64::from(lattice.dims.z.max(1)) / f64::from(BRICK);
    let in_work = (current_num_threads() as f64 / slabs).min(1.0);
    let width = match band {
        Band::Within(h) => h.max(1.0),
        Band::Full => lattice.dims.as_dvec3().length(),
    };
    Cost {
        memory: exact.memory + (SLAB_BYTES * voxels * in_work) as u64,
        seconds: SECONDS_PER_VOXEL * voxels * (1.0 + width / OVERLAP)
            + (SECONDS_PER_TRIANGLE + SECONDS_PER_SLICE * width) * mesh.triangles.len() as f64,
        ..exact
    }
}
