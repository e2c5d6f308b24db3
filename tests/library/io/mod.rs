//! Files in and out: every mesh of ours reads, every format round-trips, and no file, however
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
mod roles;
mod round_trip;
mod samples;
mod scenes;
mod saving;
mod support;
mod textures;
