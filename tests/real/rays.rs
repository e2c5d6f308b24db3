//! Closed meshes give balanced rays.

use crate::common::proofs::assert_balanced;
use crate::data;

#[test]
fn clean_meshes_balance() {
    let Some(data) = data() else { return };
    for (name, mesh) in data.clean() {
        for resolution in [64, 512] {
            assert_balanced(&name, &mesh, resolution, 1);
        }
        assert_balanced(&name, &mesh, 64, 2);
    }
}
