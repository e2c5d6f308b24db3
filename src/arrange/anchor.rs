//! What winds around one cell of each part of a surface: exact rays to infinity.

use glam::DVec2;
use rayon::prelude::*;

use super::facets::{Cover, Facets};
use super::point::Exact;
use super::refine::{Piece, Refined};
use super::wide::Wide;
use crate::progress::{Progress, Stopped};

/// The number of a cell.
pub(crate) type Cell = u32;

/// A triangle above a point.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossed {
    pub(crate) cover: Cover,
    /// 1 if the facet that it covers faces up.
    pub(crate) sign: i32,
}

/// A cell of a connected part and all triangles above a point of it.
#[derive(Debug)]
pub(crate) struct Anchor {
    pub(crate) cell: Cell,
    pub(crate) crossed: Vec<Crossed>,
}

/// An anchor for each connected part. A closed surface without a piece that can be seen from above encloses nothing: what winds around it
/// does not matter, and nothing is said to.
pub(crate) fn anchors(
    refined: &Refined,
    part_of: &[u32],
    beside: &[[Cell; 2]],
    progress: &Progress,
) -> Result<Vec<Anchor>, Stopped> {
    // For each part the piece that is largest from above, those between lattice points first: their middles have short coordinates.
    let mut best: Vec<Option<(bool, f64, u32)>> = vec![None; part_of.iter().max().map_or(0, |&part| part as usize + 1)];
    for (piece, n) in refined.pieces.iter().zip(0..) {
        let area = seen_from_above(refined, piece);
        let whole = piece.corners.iter().all(|&p| refined.points.vertex(p).is_some());
        let (part, is_flat) = (part_of[n as usize] as usize, refined.facets.plane(piece.facet).normal[2] == 0);
        if !is_flat && best[part].is_none_or(|(w, a, _)| (whole, area) > (w, a)) {
            best[part] = Some((whole, area, n));
        }
    }
    let chosen: Vec<u32> = best.iter().flatten().map(|best| best.2).collect();
    let mut upright: Vec<(u32, u32)> = part_of
        .iter()
        .zip(0..)
        .filter(|&(&part, _)| best[part as usize].is_none())
        .map(|(&part, n)| (part, n))
        .collect();
    upright.sort_unstable();
    upright.dedup_by_key(|&mut (part, _)| part);
    let upright = upright.into_iter().map(|(_, n)| Anchor { cell: beside[n as usize][0], crossed: Vec::new() });
    let columns = Columns::new(&refined.facets, chosen.len());
    let seen: Vec<Anchor> = chosen
        .par_iter()
        .map(|&n| {
            progress.check()?;
            let piece = &refined.pieces[n as usize];
            let faces_up = refined.facets.plane(piece.facet).normal[2] > 0;
            let middle = Middle::of(refined, piece);
            let above = columns.at(middle.near).flat_map(|f| crossed(&refined.facets, f, &middle));
            Ok(Anchor { cell: beside[n as usize][usize::from(!faces_up)], crossed: above.collect() })
        })
        .collect::<Result<_, _>>()?;
    Ok(seen.into_iter().chain(upright).collect())
}

fn seen_from_above(refined: &Refined, piece: &Piece) -> f64 {
    let [a, b, c] = piece.corners.map(|p| refined.points.approximate(p).truncate());
    (b - a).perp_dot(c - a).abs()
}

/// The middle of a piece, exact.
struct Middle {
    at: [Wide; 3],
    w: Wide,
    near: DVec2,
}

impl Middle {
    fn of(refined: &Refined, piece: &Piece) -> Self {
        let corners = piece.corners.map(|p| refined.points.exact(p));
        let near = piece.corners.map(|p| refined.points.approximate(p).truncate());
        Self::between(corners, (near[0] + near[1] + near[2]) / 3.0)
    }

    /// The middle of three points, and where it is nearly.
    fn between(corners: [Exact; 3], near: DVec2) -> Self {
        let weights = corners.map(|p: Exact| p.w.wide());
        let others = [weights[1].mul(&weights[2]), weights[2].mul(&weights[0]), weights[0].mul(&weights[1])];
        let along = |k: usize| (0..3).fold(Wide::ZERO, |sum, n| sum.add(&corners[n].at[k].wide().mul(&others[n])));
        Self { at: [along(0), along(1), along(2)], w: weights[0].mul(&others[0]).mul(&Wide::from(3i64)), near }
    }

    /// On which side of the line from `a` to `b` the point moved by (ε, ε²) lies, seen from above: 1 left, -1 right.
    fn side_of_line(&self, a: [i32; 3], b: [i32; 3]) -> i32 {
        let [x, y] = [0, 1].map(|k| i64::from(b[k]) - i64::from(a[k]));
        let from = |k: usize| self.at[k].sub(&self.w.mul(&Wide::from(i64::from(a[k]))));
        let turn = Wide::from(x).mul(&from(1)).sub(&Wide::from(y).mul(&from(0)));
        match turn.sign() {
            0 if y != 0 => -y.signum() as i32,
            0 => x.signum() as i32,
            side => side,
        }
    }

    /// The side of a facet's plane: 1 where its normal points to.
    fn side_of_plane(&self, facets: &Facets, facet: u32) -> i32 {
        let plane = facets.plane(facet);
        let sum = (0..3).fold(Wide::ZERO, |sum, k| sum.add(&Wide::from(plane.normal[k]).mul(&self.at[k])));
        sum.sub(&Wide::from(plane.offset).mul(&self.w)).sign()
    }
}

/// What a ray up from a point, just above it, crosses of a facet.
fn crossed(facets: &Facets, facet: u32, middle: &Middle) -> impl Iterator<Item = Crossed> {
    let [a, b, c] = facets.places(facet);
    let sign = middle.side_of_line(a, b);
    let passes = sign != 0 && sign == middle.side_of_line(b, c) && sign == middle.side_of_line(c, a);
    let above = passes && middle.side_of_plane(facets, facet) == -sign;
    let covers = if above { facets.covers(facet) } else { &[] };
    covers.iter().map(move |&cover| Crossed { cover, sign })
}

/// The facets by where they are seen from above: all of them where few rays are cast, else by the cells of a square grid.
struct Columns<'a> {
    facets: &'a Facets,
    grid: Option<Grid>,
}

struct Grid {
    low: DVec2,
    size: f64,
    across: usize,
    starts: Vec<u32>,
    facets: Vec<u32>,
}

/// Fewer rays than this look at each facet.
const FEW: usize = 8;

impl<'a> Columns<'a> {
    fn new(facets: &'a Facets, rays: usize) -> Self {
        Self { facets, grid: (rays > FEW).then(|| Grid::new(facets)) }
    }

    /// The facets that lie above or below a point, ascending.
    fn at(&self, p: DVec2) -> Box<dyn Iterator<Item = u32> + '_> {
        let near = move |&f: &u32| {
            let (low, high) = seen(self.facets, f);
            (low - 1.0).cmple(p).all() && (high + 1.0).cmpge(p).all()
        };
        match &self.grid {
            None => Box::new((0..self.facets.len() as u32).filter(near)),
            Some(grid) => Box::new(grid.at(p).iter().copied().filter(near)),
        }
    }
}

/// The box of a facet, seen from above.
fn seen(facets: &Facets, facet: u32) -> (DVec2, DVec2) {
    let [a, b, c] = facets.places(facet).map(|[x, y, _]| DVec2::new(x.into(), y.into()));
    (a.min(b).min(c), a.max(b).max(c))
}

impl Grid {
    fn new(facets: &Facets) -> Self {
        let all = (0..facets.len() as u32).map(|f| seen(facets, f));
        let none = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let (low, high) = all.fold(none, |(low, high), (l, h)| (low.min(l), high.max(h)));
        let across = ((facets.len() as f64).sqrt() as usize).clamp(1, 1024);
        let size = (high - low).max_element().max(1.0) / across as f64;
        let mut grid = Self { low, size, across, starts: vec![0; across * across + 1], facets: Vec::new() };
        for f in 0..facets.len() as u32 {
            grid.over(facets, f).for_each(|cell| grid.starts[cell + 1] += 1);
        }
        for cell in 0..across * across {
            grid.starts[cell + 1] += grid.starts[cell];
        }
        grid.facets = vec![0; grid.starts[across * across] as usize];
        let mut next = grid.starts.clone();
        for f in 0..facets.len() as u32 {
            for cell in grid.over(facets, f) {
                grid.facets[next[cell] as usize] = f;
                next[cell] += 1;
            }
        }
        grid
    }

    fn cell(&self, p: DVec2) -> [usize; 2] {
        let at = ((p - self.low) / self.size).max(DVec2::ZERO);
        [at.x, at.y].map(|x| (x as usize).min(self.across - 1))
    }

    /// The cells that a facet lies over, with a step to spare.
    fn over(&self, facets: &Facets, facet: u32) -> impl Iterator<Item = usize> + use<> {
        let (low, high) = seen(facets, facet);
        let ([x0, y0], [x1, y1], across) = (self.cell(low - 1.0), self.cell(high + 1.0), self.across);
        (y0..=y1).flat_map(move |y| (x0..=x1).map(move |x| y * across + x))
    }

    fn at(&self, p: DVec2) -> &[u32] {
        let [x, y] = self.cell(p);
        let cell = y * self.across + x;
        &self.facets[self.starts[cell] as usize..self.starts[cell + 1] as usize]
    }
}

#[cfg(test)]
mod tests {
    use num_bigint::BigInt;
    use proptest::prelude::*;

    use super::super::plane::Plane;
    use super::super::tests::{Ratio, place, sign, triangle};
    use super::*;

    /// The middle of three points.
    fn middle([a, b, c]: [&Ratio; 3]) -> Ratio {
        let others = [&b.w * &c.w, &c.w * &a.w, &a.w * &b.w];
        let at = [0, 1, 2].map(|k| &a.at[k] * &others[0] + &b.at[k] * &others[1] + &c.at[k] * &others[2]);
        Ratio { at, w: &a.w * &others[0] * 3 }
    }

    /// The side of a line, seen from above, of the point moved by (e, e²): with a number for e that is less than all that matters.
    fn side(p: &Ratio, a: [i32; 3], b: [i32; 3]) -> i32 {
        let unit = BigInt::from(1) << 4000;
        let w = &p.w * &unit * &unit;
        let (x, y) = ((&p.at[0] * &unit + &p.w) * &unit, &p.at[1] * &unit * &unit + &p.w);
        let [u, v] = [0, 1].map(|k| i64::from(b[k]) - i64::from(a[k]));
        sign(&((y - &w * a[1]) * u - (x - &w * a[0]) * v))
    }

    /// A point of the lattice, or one of three planes.
    fn point() -> impl Strategy<Value = Exact> {
        let planes = prop::array::uniform3(triangle()).prop_filter_map("no point", |planes| {
            let planes: [Plane; 3] = planes.map(|(_, plane)| plane);
            Exact::of_planes(planes.each_ref()).filter(|exact| exact.approximate().abs().max_element() < 2f64.powi(30))
        });
        prop_oneof![place().prop_map(Exact::lattice), planes]
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn sides_of_the_middle_of_a_piece(
            corners in prop::array::uniform3(point()), a in place(), b in place(), (other, _) in triangle(),
        ) {
            let exact = Middle::between(corners, DVec2::ZERO);
            let ratios = corners.each_ref().map(Ratio::of);
            let truth = middle(ratios.each_ref());
            prop_assert_eq!(exact.side_of_line(a, b), side(&truth, a, b));
            let (facets, _) = Facets::new(&other, &[[0, 1, 2]]);
            prop_assert_eq!(exact.side_of_plane(&facets, 0), sign(&truth.volume(other)));
        }

        /// The middle lies on the line or at its end: then the small move decides.
        #[test]
        fn a_middle_on_the_line(p in place(), way in prop::array::uniform2(-3i32..=3), high in place()) {
            let p = p.map(|x| x / 2);
            let at = |n: i32| [p[0] + n * way[0], p[1] + n * way[1], high[2]];
            let exact = Middle::between([Exact::lattice(p); 3], DVec2::ZERO);
            for (from, to) in [(-2, 5), (5, -2), (0, 1), (1, 0), (2, 3)] {
                let truth = side(&Ratio::lattice(p), at(from), at(to));
                prop_assert_eq!(exact.side_of_line(at(from), at(to)), truth);
                prop_assert!(truth != 0 || way == [0, 0]);
            }
        }
    }
}
