//! Which triangle lies across each edge of a triangle.

use super::edges::Edges;

/// No triangle, or not the only one.
const NONE: u32 = u32::MAX;

/// A triangle that shares an edge with another one, and with no third.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Across {
    /// Its number.
    pub(crate) triangle: u32,
    /// Whether both run along the edge the same way, so that one of them is turned over against the other.
    pub(crate) turned: bool,
}

/// The neighbours of triangles over edges that two of them share and no other.
pub(crate) struct Neighbours {
    /// For each edge, corner k to the next, twice the number of the triangle across, and one more where it is turned.
    across: Vec<[u32; 3]>,
}

impl Neighbours {
    /// Of triangles whose indices are below `vertices`.
    pub(crate) fn new(triangles: &[[u32; 3]], vertices: usize) -> Self {
        let mut across = vec![[NONE; 3]; triangles.len()];
        let edges = Edges::new(triangles, vertices);
        edges.each(|edge| {
            let mut halves = edge.halves();
            let (2, Some(a), Some(b)) = (edge.count(), halves.next(), halves.next()) else { return };
            let turned = u32::from(edges.runs_up(a) == edges.runs_up(b));
            across[a as usize / 3][a as usize % 3] = b / 3 * 2 + turned;
            across[b as usize / 3][b as usize % 3] = a / 3 * 2 + turned;
        });
        Self { across }
    }

    /// Number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.across.len()
    }

    /// The triangle across an edge (corner `edge` to the next) of a triangle; `None` where there is none, or several.
    #[inline]
    pub(crate) fn across(&self, triangle: u32, edge: usize) -> Option<Across> {
        let packed = self.across[triangle as usize][edge];
        (packed != NONE).then_some(Across { triangle: packed >> 1, turned: packed & 1 == 1 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_seen_from_both_sides_and_only_where_there_are_two() {
        // Two triangles over 1-2, a third one turned over against the second at 1-3, and three over 4-5.
        let triangles = [[0, 1, 2], [2, 1, 3], [4, 1, 3], [4, 5, 6], [5, 4, 7], [4, 5, 8]];
        let found = Neighbours::new(&triangles, 9);
        assert_eq!(found.len(), 6);
        assert_eq!(found.across(0, 1), Some(Across { triangle: 1, turned: false }));
        assert_eq!(found.across(1, 0), Some(Across { triangle: 0, turned: false }));
        assert_eq!(found.across(1, 1), Some(Across { triangle: 2, turned: true }));
        assert_eq!(found.across(2, 1), Some(Across { triangle: 1, turned: true }));
        assert_eq!([0, 3, 4, 5].map(|t| found.across(t, 0)), [None; 4]);
    }
}
