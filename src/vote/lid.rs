//! Where the surface over a hole crosses a lattice edge: the level ½ of the winding number, or another one between whole numbers of
//! which one is inside and the other is not.

use glam::{DVec3, IVec3};

use super::Winding;
use super::rim::View;
use crate::ldi::Expression;
use crate::progress::Stopped;

/// Passages of several operands closer together than this, in lengths of the edge, are one.
const TOGETHER: f64 = 1e-9;
/// Places are found to about this, in lengths of the edge.
const TOLERANCE: f64 = 1e-11;
/// The edge is searched in this many pieces: first whole; and if that finds nothing, because it passes
/// two rims and the phase is as before, in more.
const PIECES: [u32; 2] = [1, 16];
/// A piece is cut where its ends' slopes foretell a change of the winding number that is wrong by
/// more...
const CLEAR: f64 = 0.1;
/// ...down to so many halvings: it then passes a rim within a millionth of its length.
const MOST_HALVINGS: u32 = 20;
/// All cuts of an edge; one rim takes up to twenty.
const MOST_CUTS: u32 = 200;
/// Steps towards one passage; two or three suffice away from rims.
const MOST_STEPS: u32 = 100;

/// The crossing of a lattice edge with the surface that closes a hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lid {
    /// Place on the edge, 0 at its inside voxel, 1 at its outside one.
    pub t: f64,
    /// The unit normal of the closing surface there, out of the result. Model and lattice axes are the same.
    pub normal: DVec3,
}

impl Winding<'_> {
    /// Where the solid of `expression` ends on the lattice edge from voxel `inside` to voxel
    /// `outside` because the winding number of an operand passes ½ there, or another level that its rule has; of several such places the
    /// middle one. `None` where no operand does, where a triangle makes the change, and everywhere
    /// for closed operands; also, rarely, where the edge passes several rims closer than h/16 together.
    ///
    /// The place is exact to 1e-10 of the edge where the operand has up to 2048 boundary edges;
    /// beyond, winding numbers err by up to 0.001. Stops only while trees are made, at the first
    /// call. Jacobson et al. 2013.
    pub fn crossing(&self, inside: IVec3, outside: IVec3, expression: &Expression) -> Result<Option<Lid>, Stopped> {
        let start = self.to_model(inside.as_dvec3());
        let edge = Segment { start, way: self.to_model(outside.as_dvec3()) - start };
        let half = edge.way.length() / 2.0;
        let views: Vec<_> = self.rims()?.iter().map(|rim| rim.view(edge.at(0.5), half)).collect();
        for pieces in PIECES {
            let mut passages = Vec::new();
            for (operand, view) in views.iter().enumerate() {
                if let Some(view) = view {
                    Search { edge, view, operand }.run(pieces, &mut passages);
                }
            }
            passages.sort_by(|a, b| a.t.total_cmp(&b.t));
            let mut ends = Vec::new();
            for together in passages.chunk_by(|a, b| b.t - a.t < TOGETHER) {
                let (before, after) = self.sides(edge.at(together[0].t), together, &views)?;
                if expression.evaluate(&before) && !expression.evaluate(&after) {
                    ends.push(together[0]);
                }
            }
            if let Some(end) = ends.get(ends.len() / 2) {
                return Ok(end.lid());
            }
        }
        Ok(None)
    }

    /// For each operand whether it is inside before and after it passes `p` as `together` say.
    fn sides(
        &self,
        p: DVec3,
        together: &[Passage],
        views: &[Option<View<'_>>],
    ) -> Result<(Vec<bool>, Vec<bool>), Stopped> {
        let side = |(operand, tree): (usize, &super::WindingTree)| {
            let passing = together.iter().find(|passage| passage.operand == operand);
            // A passing number may also be 1½ or -½: it depends on the rule whether that changes anything.
            let above = match (passing, &views[operand]) {
                (Some(_), _) => 0.0,
                (None, Some(view)) => view.above(p),
                (None, None) => -0.5,
            };
            let w = tree.complete(above, p);
            match passing {
                Some(passage) => {
                    let [low, high] = [w - 0.25, w + 0.25].map(|w| self.rule().holds_near(w));
                    if passage.leaving { (high, low) } else { (low, high) }
                }
                None => (self.rule().holds_near(w), self.rule().holds_near(w)),
            }
        };
        Ok(self.trees()?.iter().enumerate().map(side).unzip())
    }
}

/// A lattice edge, model units.
#[derive(Debug, Clone, Copy)]
struct Segment {
    start: DVec3,
    way: DVec3,
}

impl Segment {
    fn at(&self, t: f64) -> DVec3 {
        self.start + self.way * t
    }
}

/// Where the winding number of an operand passes ½, or ½ and a whole number.
#[derive(Debug, Clone, Copy)]
struct Passage {
    t: f64,
    operand: usize,
    /// Whether it falls along the edge.
    leaving: bool,
    /// Of the winding number.
    gradient: DVec3,
}

impl Passage {
    /// `None` where there is no normal.
    fn lid(&self) -> Option<Lid> {
        let outwards = if self.leaving { -self.gradient } else { self.gradient };
        outwards.try_normalize().map(|normal| Lid { t: self.t, normal })
    }
}

/// The winding number at a place of an edge.
#[derive(Debug, Clone, Copy)]
struct EdgeSample {
    t: f64,
    /// Over ½, but for a whole number.
    above: f64,
    gradient: DVec3,
    /// Its change along the edge.
    slope: f64,
}

impl EdgeSample {
    /// Whether the tangent passes ½ at most `length` (negative: backwards) from here.
    fn heads_for_zero_within(&self, length: f64) -> bool {
        let change = self.slope * length;
        self.above * change < 0.0 && self.above.abs() < change.abs()
    }
}

/// What is to be known of a piece of the edge from the samples at its ends.
struct Piece {
    /// Whether there is a passage, an odd number of them if not clear.
    passes: bool,
    /// Whether the slopes agree that there is one or none.
    clear: bool,
}

impl Piece {
    fn between(a: EdgeSample, b: EdgeSample) -> Self {
        let length = b.t - a.t;
        let change = b.above - a.above;
        let passes = (a.above > 0.0) != (b.above > 0.0) && change.abs() < 0.5;
        // The phase knows the change but for a whole number; the slopes tell which, or that more
        // happens in between.
        let expected = (a.slope + b.slope) * length / 2.0;
        let turned = change + (expected - change).round();
        let agrees = turned.abs() < 0.5 && (turned - expected).abs() < CLEAR;
        let returns = !passes && a.heads_for_zero_within(length) && b.heads_for_zero_within(-length);
        Self { passes, clear: agrees && !returns }
    }
}

/// Looks for the passages of one operand.
struct Search<'a> {
    edge: Segment,
    view: &'a View<'a>,
    operand: usize,
}

impl Search<'_> {
    /// Adds the passages of the edge, cutting it where it is unclear which way the phase turns and
    /// where it may pass and come back.
    fn run(&self, pieces: u32, found: &mut Vec<Passage>) {
        let samples: Vec<EdgeSample> = (0..=pieces).map(|k| self.sample(f64::from(k) / f64::from(pieces))).collect();
        let mut stack: Vec<_> = samples.windows(2).rev().map(|ends| ([ends[0], ends[1]], MOST_HALVINGS)).collect();
        let mut cuts = MOST_CUTS;
        while let Some(([a, b], halvings)) = stack.pop() {
            let piece = Piece::between(a, b);
            if halvings > 0 && cuts > 0 && !piece.clear {
                cuts -= 1;
                let middle = self.sample((a.t + b.t) / 2.0);
                stack.extend([([middle, b], halvings - 1), ([a, middle], halvings - 1)]);
            } else if piece.passes {
                found.extend(self.passage(a, b));
            }
        }
    }

    fn sample(&self, t: f64) -> EdgeSample {
        let phase = self.view.at(self.edge.at(t));
        EdgeSample { t, above: phase.above, gradient: phase.gradient, slope: phase.gradient.dot(self.edge.way) }
    }

    /// The passage between two samples on different sides of it: Newton's method, kept between
    /// them.
    fn passage(&self, a: EdgeSample, b: EdgeSample) -> Option<Passage> {
        let leaving = a.above > 0.0;
        let (length, change) = (b.t - a.t, b.gradient - a.gradient);
        let (mut low, mut high) = (a.t, b.t);
        let mut t = a.t + length * zero_of_cubic(a, b);
        for step in 1..=MOST_STEPS {
            let here = self.sample(t);
            *(if (here.above > 0.0) == leaving { &mut low } else { &mut high }) = t;
            let newton = t - here.above / here.slope;
            // Now and then a halving, lest steps from ever the same side crawl.
            let halve = step % 4 == 0 || !(newton >= low && newton <= high);
            let next = if halve { (low + high) / 2.0 } else { newton };
            let share = (next - t) / length;
            let bends = here.gradient.distance(a.gradient) + here.gradient.distance(b.gradient);
            let bend = bends * self.edge.way.length() / here.slope.abs();
            // Newton's place errs as the square of the step; the gradient, taken to change evenly, as
            // the step where it changes much, and less by as much as it changes less.
            let close = share.abs() * bend * (share.abs() + bend) < TOLERANCE;
            if high - low < TOLERANCE || (close && !halve) {
                // Halving may end where the phase jumps from ½ to -½: a whole winding number.
                let passes = here.above.abs() < 0.25;
                let gradient = here.gradient + change * share;
                return passes.then_some(Passage { t: next, operand: self.operand, leaving, gradient });
            }
            t = next;
        }
        None
    }
}

/// Where, between 0 and 1, the cubic through two samples of different sign with their slopes is 0.
fn zero_of_cubic(a: EdgeSample, b: EdgeSample) -> f64 {
    let length = b.t - a.t;
    let (rise, first, last) = (b.above - a.above, a.slope * length, b.slope * length);
    let (square, cube) = (3.0 * rise - 2.0 * first - last, first + last - 2.0 * rise);
    let secant = -a.above / rise;
    let mut t = secant;
    for _ in 0..4 {
        let value = a.above + t * (first + t * (square + t * cube));
        let slope = first + t * (2.0 * square + t * 3.0 * cube);
        t -= value / slope;
    }
    if (0.0..=1.0).contains(&t) { t } else { secant }
}
