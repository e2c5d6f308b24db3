//! The exact arrangement against oracles that share nothing with it: unit cubes that are counted, volumes that add up, and winding numbers along
//! rays in floating point.

mod boxes;
mod chain;
mod order;
mod referee;
mod soups;
mod support;
mod touching;
