//! Layered depth images: every crossing of the lattice's own rays with the soup, in 13 directions.

mod expression;

pub use expression::Expression;
