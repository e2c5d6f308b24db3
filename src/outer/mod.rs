//! What a ball that rolls around a surface sees of it.
//!
//! The ball's centres are where the exact distance to the surface is at least its radius. On a lattice of an eighth of its diameter, those that are joined to the far outside are
//! where the ball can come to ([`Reach`]); the others are chambers. Each triangle is then tried from both sides ([`sights`]): is there room for the ball where it would
//! touch the triangle, and is it the outside or a chamber that it stands in? From that follows, patch by patch, which triangles are the outer
//! surface ([`judge()`]).

mod judge;
mod reach;
mod sight;

pub use judge::{Part, Parts, judge};
pub use reach::{Reach, ReachError, Sight};
pub use sight::{Sights, sights};
