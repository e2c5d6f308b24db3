//! Files in and out: every real mesh reads, every format round-trips, and no file, however
//! hostile, does more than return an error.

mod colours;
mod formats;
mod found;
mod front;
mod grid_forms;
mod grid_lies;
mod grid_vdb;
mod grids;
mod hostile;
mod lying_documents;
mod memory;
mod mutants;
mod real;
mod roles;
mod round_trip;
mod saving;
mod support;
mod textures;
