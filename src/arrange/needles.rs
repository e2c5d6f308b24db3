//! Needles and caps among triangles that cross: rounding turned them over, and cutting them would only make thinner ones.

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::draft::{Draft, Kind};
use super::fine::Fine;

impl Draft {
    /// Collapses edges of these triangles that are shorter than `reach`, and turns over the longest edge of those that are flatter than that; in the
    /// coarsest numbers along each axis. Vertices of the input stay where they are.
    pub(crate) fn mend_needles(&mut self, list: &[u32], fine: &Fine, reach: f64) {
        let mut used = vec![false; self.places.len()];
        let mut caps: Vec<(u32, usize)> = Vec::new();
        for &t in list {
            let corners = self.triangles[t as usize];
            let points = corners.map(|v| DVec3::from_array(self.places[v as usize].map(f64::from)) / fine.coarsest);
            let lengths = [0, 1, 2].map(|k| points[k].distance(points[(k + 1) % 3]));
            let by_length = |&a: &usize, &b: &usize| lengths[a].total_cmp(&lengths[b]);
            let shortest = (0..3).min_by(by_length).unwrap_or(0);
            let longest = (0..3).max_by(by_length).unwrap_or(0);
            let [a, b] = [corners[shortest], corners[(shortest + 1) % 3]];
            let height = (points[1] - points[0]).cross(points[2] - points[0]).length() / lengths[longest].max(1e-3);
            if lengths[shortest] <= reach {
                if !used[a as usize] && !used[b as usize] {
                    self.join(a, b);
                }
                (used[a as usize], used[b as usize]) = (true, true);
            } else if height <= reach {
                caps.push((t, longest));
            }
        }
        self.flip(&caps, &mut used);
    }

    /// Makes one place of two: that of a vertex of the input, if one of them is one.
    fn join(&mut self, a: u32, b: u32) {
        let rank = |v: u32| match self.kinds[v as usize] {
            Kind::Own(_) => 0,
            Kind::Placed => 1,
            Kind::Made(_) | Kind::Moved => 2,
        };
        let (stays, goes) =
            if (rank(a), self.places[a as usize]) <= (rank(b), self.places[b as usize]) { (a, b) } else { (b, a) };
        if rank(goes) == 2 {
            self.places[goes as usize] = self.places[stays as usize];
            self.kinds[goes as usize] = Kind::Moved;
        }
    }

    /// Turns edges over: each triangle with the number of its edge. Triangles of vertices in use are left.
    fn flip(&mut self, caps: &[(u32, usize)], used: &mut [bool]) {
        if caps.is_empty() {
            return;
        }
        let mut halves: FxHashMap<[u32; 2], Option<u32>> = FxHashMap::default();
        for (t, corners) in self.triangles.iter().enumerate() {
            for k in 0..3 {
                // An edge that several run along is no place to flip.
                let half = [corners[k], corners[(k + 1) % 3]];
                halves.entry(half).and_modify(|entry| *entry = None).or_insert(Some(t as u32));
            }
        }
        for &(t, k) in caps {
            let [a, b, c] = [0, 1, 2].map(|n| self.triangles[t as usize][(k + n) % 3]);
            let Some(&Some(other)) = halves.get(&[b, a]) else { continue };
            let Some(&d) = self.triangles[other as usize].iter().find(|&&v| v != a && v != b) else { continue };
            let free = [a, b, c, d].iter().all(|&v| !used[v as usize]);
            let is_edge = halves.contains_key(&[c, d]) || halves.contains_key(&[d, c]);
            if !free || c == d || is_edge {
                continue;
            }
            self.change(t as usize, [a, d, c]);
            self.change(other as usize, [d, b, c]);
            [a, b, c, d].iter().for_each(|&v| used[v as usize] = true);
        }
    }
}
