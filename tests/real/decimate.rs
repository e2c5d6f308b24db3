//! Decimation.

use crate::common::proofs::{state, stays_valid_when_decimated, stays_within_the_deviation};
use crate::data;

#[test]
fn valid_solids_stay_valid_with_their_bodies_and_tunnels_down_to_the_last_triangle() {
    let Some(data) = data() else { return };
    let meshes: Vec<_> = data.clean().into_iter().filter(|(_, mesh)| state(mesh, false).is_valid()).collect();
    assert!(meshes.len() > 8, "{} of the clean meshes are valid", meshes.len());
    // The large ones take as long as all others together.
    for (name, mesh) in meshes.into_iter().filter(|(_, mesh)| mesh.triangles.len() < 10_000) {
        stays_valid_when_decimated(&name, &mesh);
    }
}

#[test]
fn the_surface_stays_within_the_deviation_both_ways() {
    let Some(data) = data() else { return };
    let small = data.clean().into_iter().filter(|(_, mesh)| mesh.triangles.len() < 9000);
    for (name, mesh) in small.filter(|(_, mesh)| state(mesh, false).is_valid()) {
        stays_within_the_deviation(&name, &mesh);
    }
}
