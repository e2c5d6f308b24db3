//! Closings.

use meshwright::morphology::Operation;
use meshwright::pipeline::{MorphologyOptions, SurfaceOptions, VoxelSize};

use crate::common::repaired::morphed;
use crate::data;

#[test]
fn eight_plates_with_gaps_wider_than_the_ball_come_back_as_they_are() {
    let Some(data) = data() else { return };
    let mesh = data.mesh("clean/88566.stl");
    let surface = SurfaceOptions::new(VoxelSize::Along(96));
    let options = MorphologyOptions { operation: Operation::Close, radius: 1.5, sharp: None, surface };
    let outcome = morphed(&mesh, &options).expect("a solid");
    assert_eq!(outcome.report.morphology.expect("morphology was done").made, 0);
    assert_eq!(outcome.solid.triangles.len(), mesh.triangles.len());
}
