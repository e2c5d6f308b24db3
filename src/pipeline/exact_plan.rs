//! What the exact way costs.

use super::Plan;

/// Bytes at the peak of what is cut exactly: per triangle of the operands, and besides per triangle that touches others. Of the closed meshes of the data
/// set and pairs made of them none needs more than a fifth more, and those of which few triangles cross need a fifth less.
const EXACT_BYTES: [f64; 3] = [13e6, 650.0, 4600.0];
/// Seconds on two cores, to start, and per triangle of either sort. The same runs take between half and one and a half times of that.
const EXACT_SECONDS: [f64; 3] = [0.008, 6e-6, 120e-6];
/// Triangles of the result besides those of the input, per triangle that touches others.
const TRIANGLES_PER_CUT: f64 = 1.5;

impl Plan {
    /// For operands that are cut exactly, `touching` of their triangles, beside shells that stand: all of `triangles`.
    pub(super) fn of_exact(h: f64, triangles: usize, touching: usize) -> Self {
        let standing = Self::of_standing(h, triangles);
        let sum = |[whole, each, cut]: [f64; 3]| whole + each * triangles as f64 + cut * touching as f64;
        Self {
            exact: true,
            touching: touching as u64,
            triangles: (triangles as f64 + TRIANGLES_PER_CUT * touching as f64) as u64,
            memory: sum(EXACT_BYTES) as u64,
            seconds: sum(EXACT_SECONDS),
            ..standing
        }
    }

    /// For operands of which some are made whole first, each of which costs one of `parts`, and are then cut with the others like `cut`.
    pub(super) fn of_sealed(parts: impl Iterator<Item = Self>, cut: Self) -> Self {
        let sealed = parts.reduce(|one, next| Self { triangles: one.triangles + next.triangles, ..one.then(next) });
        let Some(sealed) = sealed else { return cut };
        Self {
            exact: true,
            touching: cut.touching,
            triangles: cut.triangles.max(sealed.triangles),
            memory: sealed.memory.max(cut.memory),
            seconds: sealed.seconds + cut.seconds,
            ..sealed
        }
    }
}
