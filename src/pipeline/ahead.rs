//! What is known of a run before it is run: what has to be made, and which way that will go.

use super::apart::Apart;
use super::holes::{self, planned};
use super::{BooleanError, Method, Options, StandingReport};
use crate::ldi::Expression;
use crate::mesh::edges::Edges;
use crate::mesh::weld::{has_repeated_index, welded_triangles};
use crate::mesh::{TriMesh, intersecting_triangles};
use crate::progress::Progress;
use crate::survey::Soup;
use crate::zip::{ZipReport, Zipped, zip};

/// Which way a run will go.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Way {
    /// What touches is cut exactly, with lids over what has only holes.
    Exact,
    /// The operands with these numbers are made whole by themselves, from voxels, and all are cut exactly after that.
    Sealed(Vec<usize>),
    /// What touches, or has holes, is made from voxels.
    Voxel,
}

/// What a look at operands tells of a run over them.
pub(super) struct Ahead {
    /// What has to be made of the operands: all but the shells that stand as they are, or are left out.
    pub rest: TriMesh,
    /// How many of its triangles touch others.
    pub touching: usize,
    pub way: Way,
    /// What becomes of the holes of one operand, where it has some once its cracks are closed; else none.
    pub holes: holes::Plan,
    /// What is done to close cracks.
    pub zip: Option<ZipReport>,
    /// What stands as it is.
    pub standing: StandingReport,
}

impl Ahead {
    /// Looks at operands.
    pub(super) fn of(operands: &[&TriMesh], options: &Options, progress: &Progress) -> Result<Self, BooleanError> {
        let soup = Soup::of(operands, options.orient, progress)?.with_inside(options.inside);
        // Which shells stand does not depend on the expression, only what becomes of them does.
        let apart = Apart::find(&soup, &Expression::union(operands.len()), options, progress)?;
        let rest = apart.rest(&soup);
        let mut holes = holes::Plan::default();
        let way = match options.method {
            _ if rest.mesh.triangles.is_empty() || !options.keeps() => Way::Voxel,
            Method::Voxel => Way::Voxel,
            // There is no other way.
            Method::Exact => Way::Exact,
            Method::Auto => match unbalanced(operands, &apart) {
                open if !open.is_empty() && options.tolerance != Some(0.0) => {
                    return Self::after_cracks(operands, options, progress);
                }
                open if open.is_empty() || apart.open_balances() => Way::Exact,
                open if operands.len() > 1 => Way::Sealed(open),
                _ => {
                    holes = planned(&rest, options, progress)?;
                    if holes.is_whole() { Way::Exact } else { Way::Voxel }
                }
            },
        };
        let touching = match apart.touching() {
            // Nothing has been looked for where no surface could have stood.
            0 if way != Way::Voxel => intersecting_triangles(&rest.mesh, progress)?.len(),
            touching => touching,
        };
        Ok(Self { rest: rest.mesh, touching, way, holes, zip: None, standing: apart.report() })
    }

    /// The same of operands whose cracks are closed first.
    fn after_cracks(operands: &[&TriMesh], options: &Options, progress: &Progress) -> Result<Self, BooleanError> {
        let zipped = operands.iter().map(|mesh| zip(mesh, options.tolerance, progress));
        let zipped: Vec<Option<Zipped>> = zipped.collect::<Result<_, _>>()?;
        let meshes = zipped.iter().zip(operands).map(|(zipped, mesh)| zipped.as_ref().map_or(*mesh, |z| &z.mesh));
        let done = zipped.iter().flatten().map(|zipped| zipped.report).reduce(ZipReport::with);
        let options = Options { tolerance: Some(0.0), ..*options };
        Ok(Self { zip: done, ..Self::of(&meshes.collect::<Vec<_>>(), &options, progress)? })
    }
}

/// The operands whose triangles, those of shells that are decided left out, run along some edge one way more often than the other: they have holes, unless
/// edges meet once all is cut. What balances still does after that.
fn unbalanced(operands: &[&TriMesh], apart: &Apart) -> Vec<usize> {
    let balances = |operand: u32, mesh: &TriMesh| {
        let welded = welded_triangles(mesh).into_iter().zip(0u32..);
        let open = welded.filter(|&(corners, t)| !has_repeated_index(corners) && apart.is_open(operand, t));
        let triangles: Vec<[u32; 3]> = open.map(|(corners, _)| corners).collect();
        let edges = Edges::new(&triangles, mesh.positions.len());
        let mut balanced = true;
        edges.each(|edge| {
            let up = edge.halves().filter(|&half| edges.runs_up(half)).count();
            balanced &= 2 * up == edge.count();
        });
        balanced
    };
    (0u32..).zip(operands).filter(|(n, mesh)| !balances(*n, mesh)).map(|(n, _)| n as usize).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::mesh::shapes::cuboid;
    use crate::pipeline::VoxelSize;

    fn ahead(operands: &[&TriMesh], method: Method) -> Ahead {
        let options = Options { method, ..Options::new(VoxelSize::Along(32)) };
        Ahead::of(operands, &options, &Progress::none()).expect("a look")
    }

    #[test]
    fn what_is_closed_and_crosses_goes_the_exact_way_and_what_is_open_does_not() {
        let (one, two) = (cuboid(DVec3::ZERO, DVec3::ONE), cuboid(DVec3::splat(0.5), DVec3::splat(1.5)));
        let both = ahead(&[&one, &two], Method::Auto);
        assert!(both.way == Way::Exact && both.touching > 6, "{}", both.touching);
        // As one file, too, and torn apart at its vertices.
        let mut joined = one.clone();
        joined.append(&two);
        assert_eq!(ahead(&[&joined], Method::Auto).way, Way::Exact);
        let soup = TriMesh {
            positions: joined.triangles.iter().flatten().map(|&v| joined.positions[v as usize]).collect(),
            triangles: (0..24).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
        };
        assert_eq!(ahead(&[&soup], Method::Auto).way, Way::Exact);
        assert_eq!(ahead(&[&one, &two], Method::Voxel).way, Way::Voxel);
        let mut open = two.clone();
        open.triangles.pop();
        assert_eq!(ahead(&[&open], Method::Auto).way, Way::Exact);
        let sheet = TriMesh { triangles: two.triangles[..2].to_vec(), ..two.clone() };
        assert_eq!(ahead(&[&sheet], Method::Auto).way, Way::Voxel);
        // Beside others it is made whole first.
        assert_eq!(ahead(&[&one, &open], Method::Auto).way, Way::Sealed(vec![1]));
        // Neighbours that face opposite ways are turned first.
        let mut mixed = two.clone();
        mixed.triangles[3].swap(0, 1);
        assert_eq!(ahead(&[&one, &mixed], Method::Auto).way, Way::Exact);
        // What stands is not cut.
        let apart = ahead(&[&one, &cuboid(DVec3::splat(2.0), DVec3::splat(3.0))], Method::Auto);
        assert!(apart.way == Way::Voxel && apart.rest.triangles.is_empty());
    }

    #[test]
    fn triangles_of_one_torn_shell_that_touch_are_counted() {
        // Two boxes with an edge in common, and a tetrahedron at an edge of the second that reaches into the first.
        let mut torn = cuboid(DVec3::ZERO, DVec3::ONE);
        torn.append(&cuboid(DVec3::new(1.0, 1.0, 0.0), DVec3::new(2.0, 2.0, 1.0)));
        let corners = [[1.0, 1.0, 0.0], [1.0, 2.0, 0.0], [0.5, 0.5, 0.5], [0.25, 0.5, 0.5]];
        torn.append(&TriMesh {
            positions: corners.map(DVec3::from_array).to_vec(),
            triangles: vec![[0, 1, 2], [0, 3, 1], [1, 3, 2], [0, 2, 3]],
        });
        let found = ahead(&[&torn], Method::Auto);
        assert!(found.way == Way::Exact && found.touching == 4, "{}", found.touching);
    }
}
