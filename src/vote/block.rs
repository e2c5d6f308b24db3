//! Whether the winding number counts as inside on a block of voxels: by the dipoles, which are rough;
//! near ½, or ½ and a whole number, by the boundary; very near by the boundary exactly.

use std::cell::OnceCell;

use glam::DVec3;

use super::dipoles::{Dipoles, WindingTree, complete};
use super::loop_tree::Nearby;
use super::rim::Rim;
use crate::ldi::Inside;

/// Groups of boundary edges are far from this many radii on, their own and the block's together.
const FAR: f64 = 3.0;
/// Nearer to ½ than this, what is far does not decide: it errs by up to 0.0015 on lion, beetle and
/// camelhead.
const UNSURE: f64 = 0.005;

/// One operand near a block.
pub(super) struct Block<'w> {
    tree: &'w WindingTree,
    rim: &'w Rim,
    centre: DVec3,
    radius: f64,
    dipoles: Dipoles<'w>,
    /// Made when it is first needed; `None` for a closed operand.
    boundary: OnceCell<Option<Nearby>>,
}

impl<'w> Block<'w> {
    /// For points within `radius` of `centre`, model units.
    pub(super) fn new(tree: &'w WindingTree, rim: &'w Rim, centre: DVec3, radius: f64) -> Self {
        Self { tree, rim, centre, radius, dipoles: tree.around(centre, radius), boundary: OnceCell::new() }
    }

    /// Whether the winding number at `p` counts as inside.
    pub(super) fn is_inside(&self, p: DVec3, inside: Inside) -> bool {
        let (rough, error) = (self.dipoles.winding(p), self.dipoles.error());
        if let Some(sure) = inside.holds_within(rough, error) {
            return sure;
        }
        // Only many shells at once make so large an error.
        let rough = if error < 0.4 { rough } else { self.tree.winding(p) };
        inside.holds_near(complete(self.above(p), rough))
    }

    /// The winding number over ½ but for a whole number.
    fn above(&self, p: DVec3) -> f64 {
        let near = || self.rim.loops().map(|loops| loops.around(self.centre, self.radius, FAR));
        let Some(boundary) = self.boundary.get_or_init(near) else { return -0.5 };
        let above = boundary.above(p);
        if above.abs() > UNSURE {
            return above;
        }
        self.rim.view(p, 0.0).map_or(above, |view| view.above(p))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Progress;
    use crate::vote::dipoles::tests::{places, sphere, sum_of_all};

    #[test]
    fn a_block_knows_the_side_of_points_that_are_almost_on_the_lid() {
        // With three spheres in one the winding number passes 1½ and 2½ too, and errors grow.
        for (missing, shells) in [(0, 1), (1, 1), (300, 1), (300, 3)] {
            knows_the_sides(missing, shells, Inside::Positive);
        }
        knows_the_sides(300, 3, Inside::Odd);
        knows_the_sides(300, -2, Inside::Nonzero);
    }

    /// Checks points on both sides of a lid over so many missing triangles, of so many shells that face inwards where they are negative.
    fn knows_the_sides(missing: usize, shells: i32, rule: Inside) {
        let mut mesh = sphere(40, missing);
        (1..shells.abs()).for_each(|_| mesh.append(&sphere(40, missing)));
        mesh.triangles.iter_mut().filter(|_| shells < 0).for_each(|t| t.swap(1, 2));
        let holds = |p: DVec3| rule.holds_near(sum_of_all(&mesh, p));
        let all = 0..mesh.triangles.len();
        let tree = WindingTree::new(&mesh, all.clone(), &Progress::none()).expect("not stopped");
        let rim = Rim::new(&mesh, all, &Progress::none()).expect("not stopped");
        let is_inside = |p: DVec3| Block::new(&tree, &rim, p + DVec3::splat(0.01), 0.02).is_inside(p, rule);
        let places: Vec<DVec3> = places(120).collect();
        for (p, q) in places.iter().zip(&places[60..]) {
            let [from, to] = [*p, *q].map(holds);
            assert_eq!((is_inside(*p), is_inside(*q)), (from, to), "{p} {q}");
            if from == to {
                continue;
            }
            let (mut low, mut high) = (0.0, 1.0);
            while high - low > 1e-8 {
                let middle = (low + high) / 2.0;
                let same = holds(p.lerp(*q, middle)) == from;
                *(if same { &mut low } else { &mut high }) = middle;
            }
            assert_eq!((is_inside(p.lerp(*q, low)), is_inside(p.lerp(*q, high))), (from, to), "{p} {q}");
        }
    }
}
