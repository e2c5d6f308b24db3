//! Fields of real meshes.

use crate::common::proofs::{keeps_its_zero_level_when_filtered, packets_find_what_single_searches_find};
use crate::data;

#[test]
fn the_zero_level_is_unchanged_and_no_other_arises() {
    let Some(data) = data() else { return };
    for name in ["clean/fandisk.off", "clean/rocker-arm.obj", "clean/88566.stl", "clean/quadknot.obj"] {
        keeps_its_zero_level_when_filtered(name, &data.mesh(name));
    }
}

#[test]
fn packets_of_a_tree_find_what_single_searches_find() {
    let Some(data) = data() else { return };
    packets_find_what_single_searches_find(&data.mesh("broken/stanford-bunny.obj"), 1.0);
}
