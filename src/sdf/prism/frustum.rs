//! Prisms: what each triangle can be nearest to, one frustum on either side (Sigg et al. 2003, §3.4).
//!
//! The paper clips the space over a triangle by the half-angle planes with its neighbours, on both sides of the surface. On the
//! concave side that takes away points that are nearest to the triangle where a neighbour is small, a step for instance; so
//! there the frustum has the upright plane of Mauch's towers instead, and the minimum decides. On the convex side the half-angle
//! plane is leaned out as far as the vertex axes want, which the points nearest to a vertex lie around; a vertex has an axis
//! where such points exist at all, which at most saddles they do not.

use glam::DVec3;

use super::surface::PrismSurface;

/// Frusta are larger than they must be by this, h: more than hardware moves corners, and than slim cones at vertices are wide.
const MARGIN: f64 = 0.05;

/// Sides do not lean farther than this (tangent); beyond, they stand upright as far out as the band is wide, which is less.
const MOST_LEAN: f64 = 2.0;

/// Sides that turn by less than this (sine) go straight on.
const STRAIGHT: f64 = 1e-9;

/// Where a ray leans so far that its cosine to the normal is less, the triangle has a box around all its band.
const LEAST_RISE: f64 = 0.05;

/// A convex body with a hexagon at either end: the three sides of a triangle moved out, its corners cut off.
#[derive(Debug, Clone, PartialEq)]
pub struct Frustum {
    /// The triangle that it belongs to, by its number in [`super::Prisms::frames`].
    pub frame: u32,
    /// The corners, lattice coordinates: of the hexagon at the surface, then of that at the end of the band.
    pub corners: [DVec3; 12],
}

/// The pairs of corners of a frustum that its edges join.
pub const EDGES: [[u8; 2]; 18] = [
    [0, 1],
    [1, 2],
    [2, 3],
    [3, 4],
    [4, 5],
    [5, 0],
    [6, 7],
    [7, 8],
    [8, 9],
    [9, 10],
    [10, 11],
    [11, 6],
    [0, 6],
    [1, 7],
    [2, 8],
    [3, 9],
    [4, 10],
    [5, 11],
];

/// How far the sides of a triangle, and the cuts at its corners, lean out: tangents.
#[derive(Debug, Clone, Copy)]
struct Leans {
    sides: [f64; 3],
    cuts: [f64; 3],
}

/// The plan of one triangle.
struct Plan {
    corners: [DVec3; 3],
    /// Unit vectors along the sides, and outwards from them.
    along: [DVec3; 3],
    outwards: [DVec3; 3],
    /// Outwards at the corners.
    away: [DVec3; 3],
    up: DVec3,
}

/// The frusta of triangle `t`: one on either side, or one around all of its band.
pub(super) fn frusta(surface: &PrismSurface, t: usize, frame: u32, band: f64) -> Vec<Frustum> {
    let Some(plan) = Plan::new(surface, t) else { return Vec::new() };
    let half = |sign: f64| plan.leans(surface, t, sign).map(|leans| plan.frustum(frame, leans, sign, band));
    match [half(1.0), half(-1.0)] {
        [Some(above), Some(below)] => vec![above, below],
        _ => vec![plan.around(frame, band)],
    }
}

impl Plan {
    fn new(surface: &PrismSurface, t: usize) -> Option<Self> {
        let up = surface.normals[t]?;
        let corners = surface.corners(t);
        let along = [0, 1, 2].map(|k| (corners[(k + 1) % 3] - corners[k]).normalize_or_zero());
        let outwards = along.map(|side| side.cross(up));
        let away = [0, 1, 2].map(|k| {
            let (before, after) = ((k + 2) % 3, k);
            // The longer of two sums, since either vanishes for some angle.
            let (blunt, sharp) = (outwards[before] + outwards[after], along[before] - along[after]);
            if blunt.length_squared() > sharp.length_squared() { blunt.normalize() } else { sharp.normalize_or_zero() }
        });
        Some(Self { corners, along, outwards, away, up })
    }

    /// How far the frustum on the side of `sign` leans out; `None` where it cannot.
    fn leans(&self, surface: &PrismSurface, t: usize, sign: f64) -> Option<Leans> {
        let up = self.up * sign;
        // The half-angle direction over each side where the surface is convex.
        let mut over = [None; 3];
        for (k, over) in over.iter_mut().enumerate() {
            let neighbour = surface.neighbour(t, k)? * sign;
            *over = (neighbour.dot(self.outwards[k]) > 0.0).then(|| (up + neighbour).normalize_or_zero());
        }
        let axes = surface.triangles[t].map(|v| surface.axis(v, sign));
        // What leans over a side may begin at any side or corner, across the triangle too.
        let rays = || over.iter().chain(&axes).flatten();
        rays().all(|ray| ray.dot(up) > LEAST_RISE).then(|| {
            let most = |out: DVec3| rays().map(|ray| ray.dot(out) / ray.dot(up)).fold(0.0, f64::max);
            Leans { sides: self.outwards.map(most), cuts: self.away.map(most) }
        })
    }

    fn frustum(&self, frame: u32, leans: Leans, sign: f64, band: f64) -> Frustum {
        let high = band + MARGIN;
        let slanted = |lean: f64| [MARGIN, lean * high + MARGIN];
        let cuts = leans.cuts.map(slanted);
        let made = |leans: [f64; 3]| {
            let sides = leans.map(|lean| if lean > MOST_LEAN { [high, high] } else { slanted(lean) });
            let ends = [0, 1].map(|n| self.hexagon(sides.map(|side| side[n]), cuts.map(|cut| cut[n])));
            self.joined(frame, ends, [-MARGIN * sign, high * sign])
        };
        let frustum = made(leans.sides);
        // A side that leans out far may pass over one that does not, and turn the hexagon inside out.
        let most = leans.sides.into_iter().fold(0.0, f64::max);
        if self.is_turned(&frustum) { made([most; 3]) } else { frustum }
    }

    /// Whether one of the sides of a frustum runs backwards.
    fn is_turned(&self, frustum: &Frustum) -> bool {
        let side = |n: usize| {
            let (end, k) = (6 * (n / 3), n % 3);
            let [from, to] = [2 * k + 1, (2 * k + 2) % 6].map(|corner| frustum.corners[end + corner]);
            (to - from).dot(self.along[k])
        };
        (0..6).any(|n| side(n) < 0.0)
    }

    /// The box around all that is within the band.
    fn around(&self, frame: u32, band: f64) -> Frustum {
        let wide = band + MARGIN;
        let hexagon = || self.hexagon([wide; 3], [wide; 3]);
        self.joined(frame, [hexagon(), hexagon()], [-wide, wide])
    }

    /// The body between two hexagons at two heights. Where the sides meet before the cut at one end, nothing is cut off at
    /// either: the cut would lean in.
    fn joined(&self, frame: u32, ends: [[Corner; 3]; 2], heights: [f64; 2]) -> Frustum {
        let whole = [0, 1, 2].map(|k| ends.iter().any(|end| end[k].cut.is_none()));
        let corners = std::array::from_fn(|n| {
            let (end, k) = (n / 6, n % 6 / 2);
            let corner = &ends[end][k];
            let off = match corner.cut {
                Some(cut) if !whole[k] => cut[n % 2],
                _ => corner.meet,
            };
            self.corners[k] + off + self.up * heights[end]
        });
        Frustum { frame, corners }
    }

    /// The triangle with its sides moved out and its corners cut off, both h, in its plane. Cuts lie outside of the feet of the
    /// corners on the sides.
    fn hexagon(&self, sides: [f64; 3], cuts: [f64; 3]) -> [Corner; 3] {
        std::array::from_fn(|k| {
            let before = (k + 2) % 3;
            let away = self.away[k];
            let (first, second) = (self.outwards[before] * sides[before], self.outwards[k] * sides[k]);
            let (back, on) = (-self.along[before], self.along[k]);
            // From the foot of the corner on the second side along it, to the first.
            let turn = on.dot(self.outwards[before]);
            if turn.abs() < STRAIGHT {
                return Corner { meet: if sides[before] > sides[k] { first } else { second }, cut: None };
            }
            let meet = second + on * ((sides[before] - second.dot(self.outwards[before])) / turn);
            let cut = cuts[k].max(away.dot(first)).max(away.dot(second));
            let ends = || {
                [
                    first + back * ((cut - away.dot(first)) / away.dot(back)),
                    second + on * ((cut - away.dot(second)) / away.dot(on)),
                ]
            };
            Corner { meet, cut: (cut < away.dot(meet)).then(ends) }
        })
    }
}

/// A corner of a triangle whose sides were moved out, from where it was.
struct Corner {
    /// Where the sides meet.
    meet: DVec3,
    /// The ends of the cut, on the side before and on the side after; `None` where the sides meet before it.
    cut: Option<[DVec3; 2]>,
}
