//! Closings.

use meshwright::morphology::Operation;
use meshwright::pipeline::{MorphologyOptions, Options, VoxelSize, morphology};
use meshwright::progress::Progress;

use crate::data;

#[test]
fn eight_plates_with_gaps_wider_than_the_ball_come_back_as_they_are() {
    let Some(data) = data() else { return };
    let mesh = data.mesh("clean/88566.stl");
    let solid = Options::new(VoxelSize::Along(128));
    let options = MorphologyOptions { operation: Operation::Close, radius: 1.5, mitre: None, solid };
    let outcome = morphology(&mesh, &options, &Progress::none()).expect("a solid");
    assert_eq!(outcome.report.morphology.expect("morphology was done").made, 0);
    assert_eq!(outcome.mesh.triangles.len(), mesh.triangles.len());
}
