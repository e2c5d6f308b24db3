//! Files in and out: every real mesh reads, every format round-trips, and no file, however
//! hostile, does more than return an error.

mod common;

#[path = "io/colours.rs"]
mod colours;
#[path = "io/formats.rs"]
mod formats;
#[path = "io/found.rs"]
mod found;
#[path = "io/grid_forms.rs"]
mod grid_forms;
#[path = "io/grid_lies.rs"]
mod grid_lies;
#[path = "io/grid_vdb.rs"]
mod grid_vdb;
#[path = "io/grids.rs"]
mod grids;
#[path = "io/hostile.rs"]
mod hostile;
#[path = "io/memory.rs"]
mod memory;
#[path = "io/mutants.rs"]
mod mutants;
#[path = "io/real.rs"]
mod real;
#[path = "io/roles.rs"]
mod roles;
#[path = "io/round_trip.rs"]
mod round_trip;
#[path = "io/saving.rs"]
mod saving;
#[path = "io/support.rs"]
mod support;
#[path = "io/textures.rs"]
mod textures;
