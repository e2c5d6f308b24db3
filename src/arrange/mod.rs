//! The exact arrangement: what crosses is cut where it crosses, and each piece is decided by winding numbers.
//!
//! ```text
//! triangles ─► facets ─► meet ─► sheets ─► refine ─► cells ─► winding ─► extract ─► merge ─► round
//!  (fine lattice)                  (planar)            (anchor)  (turn)                      (fans)
//! ```
//!
//! All triangles come onto a lattice of 30 bits a coordinate (`fine`). Where two of them touch, what they have in common is a point or a
//! segment, by signs of integers (`meet`). Triangles of one plane that touch are one sheet, which is triangulated once, with all that cuts
//! it; so copies cannot disagree. Pieces then meet only at common edges and vertices, and around each edge they are sorted by the normals of
//! their triangles: that joins the two sides of all pieces to `cells` of space. How often each operand winds around one cell of each connected
//! part is counted along a ray, and from there through all others, piece by piece. The pieces between a cell inside of the result and one outside are
//! its surface. Nothing up to here is approximate.
//!
//! The vertices are then rounded to numbers that a file holds (`round`), and what crosses for that is united with itself again, with the triangles around it
//! (`again`).

mod again;
mod anchor;
mod cells;
mod draft;
mod error;
mod extract;
mod facets;
mod fans;
mod fine;
mod flat;
mod layout;
mod meet;
mod merge;
mod near;
mod needles;
mod options;
mod planar;
mod plane;
mod point;
mod refine;
mod report;
mod round;
mod sheets;
mod solve;
mod surface;
#[cfg(test)]
mod tests;
mod turn;
mod wide;

pub use error::{ArrangeError, Opening};
pub use options::ArrangeOptions;
pub use report::ArrangeReport;
pub use solve::{Arranged, Cut, arrange, crossing_curves, cut};
