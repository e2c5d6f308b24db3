//! Bytes at the peak of a run for each of what they depend on.

/// Bytes at the peak for each of what it depends on. Fitted by `tools/plan.py` to all of the data set (see
/// `docs/benchmarks.md`), and an eighth more, so that few runs need more than is planned.
pub(super) struct Rates {
    /// Whatever the input.
    pub base: f64,
    /// Per h² of surface.
    pub cell: f64,
    /// Per triangle of the input.
    pub triangle: f64,
    /// Per h² of what closes holes, besides.
    pub lid: f64,
    /// Per h² of surface beside bends, besides.
    pub bend: f64,
    /// Per h² of three sides of the box, one of each pair: rays.
    pub side: f64,
    /// Per voxel of the band around the surface.
    pub voxel: f64,
}

/// Most triangles stay as they are.
pub(super) const KEPT: Rates =
    Rates { base: 11.5e6, cell: 1110.0, triangle: 600.0, lid: 2100.0, bend: 0.0, side: 85.0, voxel: 0.0 };
/// Of that what rays and their spans take, before anything is voted on. Bunny with its five holes: 330 MB at 512 voxels, 1,000 MB at 1,024.
pub(super) const SURVEYED: Rates = Rates { cell: 300.0, lid: 0.0, ..KEPT };
/// The same as for those that are kept of several operands, parts of which lie within one another.
pub(super) const COMBINED: Rates = Rates { cell: 1000.0, ..KEPT };
/// The surface is built anew, and what is flat is simplified.
pub(super) const REBUILT: Rates =
    Rates { base: 12.5e6, cell: 1080.0, triangle: 500.0, lid: 3180.0, bend: 2720.0, side: 270.0, voxel: 0.0 };
/// The contour stays as it is.
pub(super) const UNFITTED: Rates =
    Rates { base: 11e6, cell: 1160.0, triangle: 265.0, lid: 1300.0, bend: 320.0, side: 150.0, voxel: 0.0 };
/// One offset of the solid, after it.
pub(super) const OFFSET: Rates =
    Rates { base: 27e6, cell: 0.0, triangle: 219.0, lid: 4570.0, bend: 3572.0, side: 0.0, voxel: 87.0 };
/// Two, the second from the first.
pub(super) const OFFSET_AND_BACK: Rates =
    Rates { base: 75e6, cell: 0.0, triangle: 30.0, lid: 9000.0, bend: 5500.0, side: 0.0, voxel: 215.0 };
/// One, where walls are thin.
pub(super) const THICKENED: Rates =
    Rates { base: 22e6, cell: 1100.0, triangle: 0.0, lid: 5000.0, bend: 2000.0, side: 0.0, voxel: 0.0 };
