//! What is asked of an arrangement.

use crate::ldi::Expression;
use crate::orient::OrientMode;

/// Options of [`arrange`](super::arrange).
#[derive(Debug, Clone, Copy)]
pub struct ArrangeOptions<'a> {
    /// The result in terms of the operands.
    pub expression: &'a Expression,
    /// Whether shells that face the wrong way are turned over.
    pub orient: OrientMode,
    /// Whether all coordinates of the result are to be `f32` numbers.
    pub single: bool,
    /// For each triangle whether it may touch another one, if that has been found out for the coordinates of the result (see
    /// [`contacts`](crate::shells::contacts)); empty: any may.
    pub suspects: &'a [bool],
    /// A number for each triangle, or none at all: triangles with different numbers are not merged where they lie in one plane.
    pub classes: &'a [u32],
}
