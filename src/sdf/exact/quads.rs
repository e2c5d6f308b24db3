//! The features in single precision, in coordinates about the centre of their tile, judged at eight
//! points at once: the eight children of a block, or its eight voxels.

use glam::{BVec4A, DVec3, Vec3, Vec4};

use super::feature::{EdgeFeature, FaceFeature, MOST_SIDES, VertexFeature};

/// Regions are larger by this, in h: more than rounding moves a point of a tile, and less than distances may err.
pub(super) const MARGIN: f32 = 2e-5;

/// Eight points at `centre` ± `step` along each axis: x changes fastest, then y, then z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Eight {
    centre: Vec3,
    step: f32,
    x: Vec4,
    y: Vec4,
}

/// A value at each of eight points: those at the smaller z, and those at the larger.
type Values = [Vec4; 2];

/// What a feature is to eight points, or to the boxes around them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Look {
    /// Square of the distance, or of a lower bound of it.
    pub square: Values,
    /// Whether the box around the point meets the region.
    pub meets: [BVec4A; 2],
    /// Whether the distance is that of a point of the surface.
    pub true_at: [BVec4A; 2],
}

/// The nearest surface whose outer side is seen, and the nearest whose inner side is, as squares.
#[derive(Debug, Clone, Copy)]
pub(super) struct NearestSides {
    pub outer: Values,
    pub inner: Values,
}

const INFINITY: Vec4 = Vec4::INFINITY;

impl Eight {
    pub(super) fn new(centre: Vec3, step: f32) -> Self {
        Self { centre, step, x: Vec4::new(-step, step, -step, step), y: Vec4::new(-step, -step, step, step) }
    }

    /// f.x · x + f.y · y + f.z · z + f.w.
    #[inline(always)]
    fn linear(&self, f: Vec4) -> Values {
        let [fx, fy, fz, fw] = f.to_array();
        let level = fx * self.centre.x + fy * self.centre.y + fz * self.centre.z + fw;
        let plane = Vec4::splat(fx) * self.x + Vec4::splat(fy) * self.y;
        let up = fz * self.step;
        [plane + Vec4::splat(level - up), plane + Vec4::splat(level + up)]
    }
}

impl Eight {
    /// Written out: the compiler does not inline `map` here, which costs a twentieth of all time.
    #[inline(always)]
    fn linear_2(&self, [f, g]: &[Vec4; 2]) -> [Values; 2] {
        [self.linear(*f), self.linear(*g)]
    }

    #[inline(always)]
    fn linear_3(&self, [f, g, h]: &[Vec4; 3]) -> [Values; 3] {
        [self.linear(*f), self.linear(*g), self.linear(*h)]
    }
}

impl NearestSides {
    pub(super) const NONE: Self = Self { outer: [INFINITY; 2], inner: [INFINITY; 2] };

    /// Takes a distance where `counts`; where `side` is within `doubt` of 0 it counts for both sides.
    #[inline(always)]
    fn offer(&mut self, half: usize, square: Vec4, counts: BVec4A, side: Vec4, doubt: f32) {
        let out = counts & side.cmpge(Vec4::splat(-doubt));
        let inn = counts & side.cmple(Vec4::splat(doubt));
        self.outer[half] = self.outer[half].min(Vec4::select(out, square, INFINITY));
        self.inner[half] = self.inner[half].min(Vec4::select(inn, square, INFINITY));
    }
}

/// `normal · p + offset` in the coordinates about `centre`, for the plane through `at`.
fn plane(normal: DVec3, at: DVec3, centre: DVec3) -> Vec4 {
    normal.extend(normal.dot(centre - at)).as_vec4()
}

/// How much a linear function grows over one step along each axis.
fn growth(f: Vec4) -> f32 {
    f.truncate().abs().element_sum()
}

/// A kind of feature.
pub(super) trait Local: Copy + Sync {
    /// What it is to the boxes of half-width `half` around eight points.
    fn look(&self, eight: &Eight, half: f32) -> Look;
    /// Offers its distances at eight points.
    fn measure(&self, eight: &Eight, doubt: f32, best: &mut NearestSides);
}

/// See [`FaceFeature`].
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalFace {
    level: Vec4,
    inner: [Vec4; 3],
    growth: [f32; 3],
}

impl LocalFace {
    pub(super) fn new(face: &FaceFeature, centre: DVec3) -> Self {
        let inner = [0, 1, 2].map(|k| plane(face.inner[k], face.corners[k], centre));
        Self { level: plane(face.normal, face.corners[0], centre), inner, growth: inner.map(growth) }
    }
}

impl Local for LocalFace {
    #[inline(always)]
    fn look(&self, eight: &Eight, half: f32) -> Look {
        let level = eight.linear(self.level);
        let inner = eight.linear_3(&self.inner);
        let [g0, g1, g2] = self.growth;
        let least = [-MARGIN - half * g0, -MARGIN - half * g1, -MARGIN - half * g2];
        let within = |k: usize, least: [f32; 3]| {
            inner[0][k].cmpge(Vec4::splat(least[0]))
                & inner[1][k].cmpge(Vec4::splat(least[1]))
                & inner[2][k].cmpge(Vec4::splat(least[2]))
        };
        Look {
            square: [level[0] * level[0], level[1] * level[1]],
            meets: [within(0, least), within(1, least)],
            true_at: [within(0, [-MARGIN; 3]), within(1, [-MARGIN; 3])],
        }
    }

    #[inline(always)]
    fn measure(&self, eight: &Eight, doubt: f32, best: &mut NearestSides) {
        let level = eight.linear(self.level);
        let inner = eight.linear_3(&self.inner);
        for half in 0..2 {
            let nearest_side = inner[0][half].min(inner[1][half]).min(inner[2][half]);
            let within = nearest_side.cmpge(Vec4::splat(-MARGIN));
            best.offer(half, level[half] * level[half], within, level[half], doubt);
        }
    }
}

/// See [`EdgeFeature`].
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalEdge {
    /// Square to the edge, the first along the pseudonormal.
    across: [Vec4; 2],
    /// 0 at one end, `length` at the other.
    along: Vec4,
    length: f32,
    sides: [Vec4; 2],
    growth: [f32; 3],
    /// Whether the pseudonormal says nothing.
    blind: f32,
}

impl LocalEdge {
    pub(super) fn new(edge: &EdgeFeature, centre: DVec3) -> Self {
        let across = edge.across().map(|v| plane(v, edge.start, centre));
        let along = plane(edge.along, edge.start, centre);
        let sides = edge.sides.map(|side| plane(-side, edge.start, centre));
        Self {
            across,
            along,
            length: edge.length as f32,
            sides,
            growth: [growth(along), growth(sides[0]), growth(sides[1])],
            blind: if edge.is_blind() { f32::INFINITY } else { 0.0 },
        }
    }
}

impl Local for LocalEdge {
    #[inline(always)]
    fn look(&self, eight: &Eight, half: f32) -> Look {
        let across = eight.linear_2(&self.across);
        let along = eight.linear(self.along);
        let sides = eight.linear_2(&self.sides);
        let [g0, g1, g2] = self.growth;
        let reach = [MARGIN + half * g0, MARGIN + half * g1, MARGIN + half * g2];
        let between = |k: usize, reach: f32| {
            along[k].cmpge(Vec4::splat(-reach)) & along[k].cmple(Vec4::splat(self.length + reach))
        };
        let meets = |k: usize| {
            between(k, reach[0]) & sides[0][k].cmpge(Vec4::splat(-reach[1])) & sides[1][k].cmpge(Vec4::splat(-reach[2]))
        };
        let square = |k: usize| across[0][k] * across[0][k] + across[1][k] * across[1][k];
        Look {
            square: [square(0), square(1)],
            meets: [meets(0), meets(1)],
            true_at: [between(0, MARGIN), between(1, MARGIN)],
        }
    }

    #[inline(always)]
    fn measure(&self, eight: &Eight, doubt: f32, best: &mut NearestSides) {
        let across = eight.linear_2(&self.across);
        let along = eight.linear(self.along);
        for half in 0..2 {
            let between =
                along[half].cmpge(Vec4::splat(-MARGIN)) & along[half].cmple(Vec4::splat(self.length + MARGIN));
            let square = across[0][half] * across[0][half] + across[1][half] * across[1][half];
            best.offer(half, square, between, across[0][half], doubt + self.blind);
        }
    }
}

/// See [`VertexFeature`].
#[derive(Debug, Clone, Copy)]
pub(super) struct LocalVertex {
    at: Vec3,
    normal: Vec4,
    sides: [Vec4; MOST_SIDES],
    growth: [f32; MOST_SIDES],
    /// As many of the sides say something.
    count: usize,
    blind: f32,
}

impl LocalVertex {
    pub(super) fn new(vertex: &VertexFeature, centre: DVec3) -> Self {
        let sides = vertex.sides.map(|side| plane(-side, vertex.at, centre));
        Self {
            at: (vertex.at - centre).as_vec3(),
            normal: plane(vertex.normal, vertex.at, centre),
            sides,
            growth: sides.map(growth),
            count: vertex.sides.iter().take_while(|&&side| side != DVec3::ZERO).count(),
            blind: if vertex.normal == DVec3::ZERO { f32::INFINITY } else { 0.0 },
        }
    }

    #[inline(always)]
    fn squares(&self, eight: &Eight) -> Values {
        let to = eight.centre - self.at;
        let (x, y) = (eight.x + Vec4::splat(to.x), eight.y + Vec4::splat(to.y));
        let flat = x * x + y * y;
        let (low, high) = (to.z - eight.step, to.z + eight.step);
        [flat + Vec4::splat(low * low), flat + Vec4::splat(high * high)]
    }
}

impl Local for LocalVertex {
    #[inline(always)]
    fn look(&self, eight: &Eight, half: f32) -> Look {
        let all = Vec4::ZERO.cmpge(Vec4::ZERO);
        let mut meets = [all; 2];
        for (side, growth) in self.sides.iter().zip(&self.growth).take(self.count) {
            let value = eight.linear(*side);
            let least = Vec4::splat(-MARGIN - half * growth);
            meets = [meets[0] & value[0].cmpge(least), meets[1] & value[1].cmpge(least)];
        }
        Look { square: self.squares(eight), meets, true_at: [all; 2] }
    }

    #[inline(always)]
    fn measure(&self, eight: &Eight, doubt: f32, best: &mut NearestSides) {
        let square = self.squares(eight);
        let side = eight.linear(self.normal);
        for half in 0..2 {
            best.offer(half, square[half], BVec4A::new(true, true, true, true), side[half], doubt + self.blind);
        }
    }
}
