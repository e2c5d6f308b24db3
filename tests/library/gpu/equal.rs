//! Real meshes.

use meshwright::gpu::GpuMethod;
use meshwright::ldi::{Operands, balance};

use super::{BOTH, by, compare};
use crate::common::{data, data_folder, read, stages};

/// Both methods at 64 voxels, and the default one at 128; half a voxel apart, too.
#[test]
fn all_clean_meshes_have_the_same_crossings_in_all_directions() {
    for (name, mesh) in data("clean") {
        let operands = Operands::new([mesh.triangles.len()]);
        for (resolution, factor, methods) in [(64, 1, &BOTH[..]), (128, 1, &BOTH[..1]), (64, 2, &BOTH[..1])] {
            let lattice = stages::lattice_of(&mesh, resolution);
            let methods: Vec<_> = methods.iter().copied().map(by).collect();
            let layers = compare(&format!("{name} at {resolution}"), &mesh, &lattice, factor, &methods);
            for layers in layers {
                let balance = balance(&layers, &operands);
                assert!(balance.occupied > 0 && balance.unbalanced == 0, "{name}: {balance:?}");
            }
        }
    }
}

#[test]
fn the_open_bunny_has_the_same_crossings() {
    let bunny = read(&data_folder().join("broken/stanford-bunny.obj"));
    for (resolution, methods) in [(64, &BOTH[..]), (128, &BOTH[..])] {
        let lattice = stages::lattice_of(&bunny, resolution);
        let methods: Vec<_> = methods.iter().copied().map(by).collect();
        compare(&format!("bunny at {resolution}"), &bunny, &lattice, 1, &methods);
    }
    let lattice = stages::lattice_of(&bunny, 64);
    compare("bunny, twice", &bunny, &lattice, 2, &[by(GpuMethod::Peel)]);
}
