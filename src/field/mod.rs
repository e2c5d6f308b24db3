//! Scalar fields in space, and what is made of them: a mesh's distance, analytic bodies, offsets, booleans, averages,
//! blends, filters (Payne and Toga 1992, Sanchez et al. 2015).
//!
//! One convention of sign: negative inside, positive outside, zero on the surface. Both papers use the opposite; where
//! that changes a formula, the item says so. Values are lengths in model units unless an item says otherwise. Most are
//! distances only near the surface or not even there: what counts is where they are zero, and that they are smooth.
//!
//! A [`Field`] is asked for packets of points, and for the range of its values within a ball. By ranges [`fill`] finds the
//! bricks that hold a level without looking at the others, whatever the field is made of.
//!
//! ```
//! use std::sync::Arc;
//! use glam::DVec3;
//! use meshwright::field::{Body, Field, Shared, Solid, algebra, blend};
//!
//! let ball = |x| -> Shared {
//!     Arc::new(Body { solid: Solid::Sphere { radius: 1.0 }, centre: DVec3::new(x, 0.0, 0.0), axis: 2 })
//! };
//! let pair = blend::blend_union(ball(-0.8), algebra::offset(ball(0.8), 0.1), 0.5);
//! assert!(pair.value(DVec3::ZERO) < 0.0);
//! ```

pub mod algebra;
pub mod blend;
pub mod blob;
mod combined;
mod cubes;
mod fill;
pub mod filter;
pub mod language;
mod level;
mod material;
mod mesh;
mod passages;
mod placed;
mod points;
mod range;
mod sampled;
mod solids;

use std::sync::Arc;

pub use combined::{Combined, Rule, Slope};
pub use cubes::Cubes;
pub use fill::{FillError, FillOptions, fill};
use glam::DVec3;
pub use level::{Level, LevelError, level};
pub use material::material;
pub use mesh::MeshField;
pub use placed::{Placement, placed};
pub use points::{PointField, scattered};
pub use range::{Ball, Extent, Range};
pub use sampled::{Sampled, blur_band, blurred};
pub use solids::{Body, Solid};

/// A field that others can be made of.
pub type Shared = Arc<dyn Field>;

/// A value and how it grows.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// The value, model units, negative inside.
    pub value: f64,
    /// Its gradient; at creases that of one side.
    pub gradient: DVec3,
}

/// A triangle of a mesh that a field was made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct SourceTriangle {
    /// Number of the mesh: see [`MeshField::new`].
    pub source: u32,
    /// Triangle of that mesh.
    pub triangle: u32,
}

/// A function of space.
pub trait Field: Send + Sync {
    /// The values at `points` (model units), in their order, into `values`, which is as long. Points are best near each
    /// other: a packet costs less than its points one by one.
    fn values(&self, points: &[DVec3], values: &mut [f64]);

    /// Values and gradients at `points`, into `samples`, which is as long.
    fn samples(&self, points: &[DVec3], samples: &mut [Sample]);

    /// Bounds of the values within a ball. They may be wide; the narrower, the less is looked at.
    fn range(&self, ball: &Ball) -> Range;

    /// A Lipschitz bound: no two values differ by more than this times the distance of their points. It is infinite where
    /// none is known.
    fn lipschitz(&self) -> f64;

    /// Where values may be zero or less.
    fn extent(&self) -> Extent;

    /// The triangle that the zero level lies on at `p` (model units), if it lies on one: not farther than `within`,
    /// model units, and unchanged by what was done to the mesh.
    fn source_triangle(&self, p: DVec3, within: f64) -> Option<SourceTriangle> {
        let _ = (p, within);
        None
    }

    /// A way to tell the values at the points `origin + h v`, model units, cube by cube, if there is one that is much quicker than [`Self::values`].
    fn over(&self, origin: DVec3, h: f64) -> Option<Arc<dyn Cubes>> {
        let _ = (origin, h);
        None
    }

    /// The value at one point.
    fn value(&self, p: DVec3) -> f64 {
        let mut value = [0.0];
        self.values(&[p], &mut value);
        value[0]
    }

    /// Value and gradient at one point.
    fn sample(&self, p: DVec3) -> Sample {
        let mut sample = [Sample::default()];
        self.samples(&[p], &mut sample);
        sample[0]
    }
}
