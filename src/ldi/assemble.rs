//! Layers from what another rasteriser has found: which triangles the rays cross.

use std::borrow::Cow;

use glam::IVec3;
use rayon::prelude::*;

use super::raster::{ShearedTriangle, ray_step};
use super::{Hit, Layers};
use crate::lattice::Direction;

/// Which triangles cross the rays of a rectangle of one direction's window, in any order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Crossed<'a> {
    /// Indices of the first ray, as in [`Layers::low`].
    pub low: [i32; 2],
    /// Rays along u and v.
    pub size: [u32; 2],
    /// Where the first ray's triangles begin: what `ends` count from.
    pub first: u32,
    /// Where each ray's triangles end (u runs fastest); the next ray's begin there.
    pub ends: Cow<'a, [u32]>,
    /// Numbers of triangles, from the one at `first` on.
    pub triangles: Cow<'a, [u32]>,
}

impl Crossed<'_> {
    /// Whether the lists fit together.
    fn is_sound(&self) -> bool {
        self.ends.len() as u64 == u64::from(self.size[0]) * u64::from(self.size[1])
            && self.ends.is_sorted()
            && self.ends.first().is_none_or(|&end| end >= self.first)
            && self.ends.last().is_none_or(|&end| (end - self.first) as usize == self.triangles.len())
    }

    /// The ends of the rays of row `v` that lie in this rectangle, and where the first ray begins.
    fn row(&self, v: i32) -> Option<(u32, &[u32])> {
        let row = usize::try_from(v.checked_sub(self.low[1])?).ok().filter(|&row| row < self.size[1] as usize)?;
        let width = self.size[0] as usize;
        let start = if row == 0 { self.first } else { *self.ends.get(row * width - 1)? };
        Some((start, self.ends.get(row * width..(row + 1) * width)?))
    }
}

/// The layers of one direction, as [`super::rasterise`] makes them, from rectangles that together hold each ray of the window
/// once. `None` when they do not, or when a triangle is named that does not cover its ray.
pub fn assemble(
    vertices: &[IVec3],
    triangles: &[[u32; 3]],
    dims: IVec3,
    direction: Direction,
    factor: u32,
    crossed: &[Crossed<'_>],
) -> Option<Layers> {
    let mut layers = Layers::empty(direction, dims, factor);
    let rays: usize = crossed.iter().map(|part| part.ends.len()).sum();
    if rays != layers.ray_count() || !crossed.iter().all(|part| part.is_sound()) {
        return None;
    }
    let mut parts: Vec<&Crossed<'_>> = crossed.iter().collect();
    parts.sort_unstable_by_key(|part| part.low);
    layers.offsets = offsets(&layers, &parts)?;
    layers.hits = vec![Hit::new(0.0, 0, false); *layers.offsets.last()? as usize];
    let step = i64::from(ray_step(factor));
    let low = layers.low[1];
    let complete = layers.rows().into_par_iter().enumerate().with_min_len(8).map(|(row, (_, hits))| {
        let (mut out, row) = (hits.iter_mut(), low + row as i32);
        let v = i64::from(row);
        for part in &parts {
            let Some((start, ends)) = part.row(row) else { continue };
            let mut start = start as usize;
            for (i, &end) in ends.iter().enumerate() {
                let u = i64::from(part.low[0]) + i as i64;
                let of_ray = start - part.first as usize..(end - part.first) as usize;
                for &number in part.triangles.get(of_ray)? {
                    let corners = triangles.get(number as usize)?.map(|v| direction.shear(vertices[v as usize]));
                    let seen = ShearedTriangle::new(corners)?;
                    let depth = seen.crossing(u * step, v * step)?;
                    *out.next()? = Hit::new(depth, number, seen.entering());
                }
                start = end as usize;
            }
        }
        out.next().is_none().then_some(())
    });
    complete.collect::<Option<()>>()?;
    layers.sort();
    Some(layers)
}

/// Where each ray's crossings will begin; `None` unless each ray of the window comes once.
fn offsets(layers: &Layers, parts: &[&Crossed<'_>]) -> Option<Vec<u32>> {
    let mut offsets = Vec::with_capacity(layers.ray_count() + 1);
    let mut total = 0u32;
    offsets.push(0);
    for v in layers.low[1]..layers.low[1] + layers.size[1] {
        let mut next = layers.low[0];
        for part in parts {
            let Some((mut start, ends)) = part.row(v) else { continue };
            if part.low[0] != next {
                return None;
            }
            next += part.size[0] as i32;
            for &end in ends {
                total = total.checked_add(end - start)?;
                offsets.push(total);
                start = end;
            }
        }
    }
    (offsets.len() == layers.ray_count() + 1).then_some(offsets)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lattice::DIRECTIONS;
    use crate::ldi::rasterise;
    use crate::progress::Progress;

    const VERTICES: [IVec3; 4] = [
        IVec3::new(0, 0, 0),
        IVec3::new(6 << 16, 0, 1 << 16),
        IVec3::new(0, 6 << 16, 2 << 16),
        IVec3::new(9, 9, 1 << 18),
    ];
    const TRIANGLES: [[u32; 3]; 3] = [[0, 1, 2], [1, 2, 3], [0, 2, 1]];
    const DIMS: IVec3 = IVec3::new(5, 6, 7);

    fn rasterised(n: usize) -> Layers {
        rasterise(&VERTICES, &TRIANGLES, DIMS, DIRECTIONS[n], 2, &Progress::none()).expect("not stopped")
    }

    /// The crossings in two parts side by side, those of each ray backwards.
    fn parts(layers: &Layers) -> Vec<Crossed<'static>> {
        let split = layers.size[0] / 3;
        let ranges = [(0, split), (split, layers.size[0])];
        let part = |(from, to): (i32, i32)| {
            let (mut ends, mut triangles) = (Vec::new(), Vec::new());
            // Lists of several rectangles may be one behind the other.
            let first = 7 * from as u32;
            for (j, i) in (0..layers.size[1]).flat_map(|j| (from..to).map(move |i| (j, i))) {
                let ray = (j * layers.size[0] + i) as usize;
                triangles.extend(layers.of(ray).iter().rev().map(|hit| hit.triangle()));
                ends.push(first + triangles.len() as u32);
            }
            Crossed {
                low: [layers.low[0] + from, layers.low[1]],
                size: [(to - from) as u32, layers.size[1] as u32],
                first,
                ends: ends.into(),
                triangles: triangles.into(),
            }
        };
        ranges.map(part).to_vec()
    }

    fn assembled(n: usize, crossed: &[Crossed<'_>]) -> Option<Layers> {
        assemble(&VERTICES, &TRIANGLES, DIMS, DIRECTIONS[n], 2, crossed)
    }

    #[test]
    fn parts_in_any_order_become_what_the_rasteriser_makes() {
        for n in 0..13 {
            let wanted = rasterised(n);
            let mut parts = parts(&wanted);
            for _ in 0..2 {
                let layers = assembled(n, &parts).expect("sound parts");
                assert_eq!((&layers.offsets, &layers.hits), (&wanted.offsets, &wanted.hits));
                parts.reverse();
            }
        }
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let sound = parts(&rasterised(0));
        let spoilt = |spoil: fn(&mut Vec<Crossed<'_>>)| {
            let mut parts = sound.clone();
            spoil(&mut parts);
            assembled(0, &parts).is_none()
        };
        assert!(assembled(0, &sound).is_some());
        assert!(spoilt(|parts| parts.truncate(1)), "a part is missing");
        assert!(spoilt(|parts| parts[1] = parts[0].clone()), "a part comes twice");
        assert!(spoilt(|parts| parts[0].low[0] += 1), "a part lies elsewhere");
        assert!(spoilt(|parts| parts[1].triangles.to_mut()[0] = 7), "there is no such triangle");
        assert!(spoilt(|parts| parts[1].triangles.to_mut().truncate(1)), "a triangle is missing");
        assert!(spoilt(|parts| parts[1].ends.to_mut().reverse()), "rays end before they begin");
        assert!(
            spoilt(|parts| {
                let corner = parts[1].ends.len() - 1;
                let first = parts[1].first;
                parts[1].ends.to_mut()[..corner].iter_mut().for_each(|end| *end = first);
            }),
            "triangles lie on rays that they do not cover"
        );
        assert!(
            spoilt(|parts| parts[1].first += 1),
            "the first ray begins after it has ended, or a triangle is too many"
        );
    }
}
