//! What is beyond the lattice is outside, and what reaches over its border is cut off there, closed.

use glam::{DVec3, IVec3};
use meshwright::contour::{ContourOptions, contour};
use meshwright::lattice::{BRICK, Grid, Lattice, Slot, brick_of, voxel_in_brick};
use meshwright::mesh::{TriMesh, ValidateOptions, validate};
use meshwright::progress::Progress;
use meshwright::sdf::{RobustOptions, robust};
use meshwright::survey::Survey;
use meshwright::vote::{VoteRule, Votes};

use crate::common::shapes;

/// Votes near the surface, and whether the contour of the robust field of these is a valid solid or nothing.
fn voted(mesh: &TriMesh, lattice: &Lattice) -> (Grid<Votes>, bool) {
    let progress = Progress::none();
    let survey = Survey::of_mesh(mesh, lattice, &progress).expect("not stopped");
    let winding = survey.winding(&progress);
    let votes = survey.votes(VoteRule::Winding, &winding, &progress).expect("not stopped");
    let options = RobustOptions::default();
    let field = robust(&survey.spans, &survey.planes(), (&votes, lattice), &options, &progress).expect("not stopped");
    let surface = contour(&field, &|_| None, &ContourOptions::default(), &progress).expect("not stopped");
    let check = ValidateOptions { self_intersections: true, weld: true };
    let is_valid = validate(&surface.mesh, &check, &progress).expect("not stopped").is_valid();
    (votes, is_valid || surface.mesh.triangles.is_empty())
}

/// Neighbours of which one is inside and the other is not lie in active bricks, and nothing beyond the lattice is inside.
fn check_bricks(votes: &Grid<Votes>, lattice: &Lattice) {
    let beyond = |voxel: IVec3| voxel.cmplt(IVec3::ZERO).any() || voxel.cmpge(lattice.dims).any();
    for (&brick, values) in votes.bricks.active().iter().zip(&votes.values) {
        for (n, value) in values.iter().enumerate() {
            let voxel = brick * BRICK + voxel_in_brick(n);
            assert!(!value.is_inside || !beyond(voxel), "{voxel} is beyond the lattice and inside");
            for step in [IVec3::X, IVec3::Y, IVec3::Z, IVec3::NEG_X, IVec3::NEG_Y, IVec3::NEG_Z] {
                let other = voxel + step;
                let is_active = matches!(votes.bricks.slot(brick_of(other)), Slot::Active(_));
                let differs = votes.get(other).is_inside != value.is_inside;
                assert!(is_active || !differs, "{voxel} and {other} differ");
            }
        }
    }
}

#[test]
fn sheets_that_wind_around_more_than_their_box_end_at_the_border() {
    // Behind eight sheets that face the same way the winding number is up to 4, and above one half far beyond their box.
    let mut stack = TriMesh::default();
    for k in 0..8 {
        let corner = |x: f64, y: f64| DVec3::new(x, y, 0.02 * f64::from(k));
        stack.append(&TriMesh {
            positions: vec![corner(0.0, 0.0), corner(1.0, 0.0), corner(1.0, 1.0), corner(0.0, 1.0)],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
        });
    }
    for resolution in [20, 29, 37, 64] {
        let lattice = crate::common::stages::lattice_of(&stack, resolution);
        let (votes, is_valid) = voted(&stack, &lattice);
        check_bricks(&votes, &lattice);
        let below = IVec3::new(lattice.dims.x / 2, lattice.dims.y / 2, 0);
        assert!(votes.get(below).is_inside && is_valid, "at {resolution}");
    }
}

#[test]
fn a_window_into_a_ball_is_the_part_of_the_ball_that_it_holds() {
    let ball = shapes::ball(5, |_| 1.0);
    let h = 0.02;
    // Across the surface, all inside, around a pole, and all outside.
    for (origin, dims) in [
        (DVec3::new(0.4123, 0.1371, 0.3311), IVec3::new(40, 33, 25)),
        (DVec3::new(-0.3123, -0.2871, -0.1311), IVec3::new(30, 24, 17)),
        (DVec3::new(-0.3123, -0.2871, 0.7311), IVec3::new(31, 30, 29)),
        (DVec3::new(0.8123, 0.7871, 0.7311), IVec3::new(9, 8, 7)),
    ] {
        let lattice = Lattice { origin, h, dims };
        let (votes, is_valid) = voted(&ball, &lattice);
        check_bricks(&votes, &lattice);
        assert!(is_valid, "at {origin}");
        let voxels =
            (0..dims.x * dims.y * dims.z).map(|n| IVec3::new(n % dims.x, n / dims.x % dims.y, n / dims.x / dims.y));
        for voxel in voxels {
            let depth = 1.0 - lattice.to_model(voxel.as_dvec3()).length();
            // The triangles are up to 0.005 inside of the ball.
            if !(-1e-3..0.006).contains(&depth) {
                assert_eq!(votes.get(voxel).is_inside, depth > 0.0, "{voxel} at {origin}");
            }
        }
    }
}
