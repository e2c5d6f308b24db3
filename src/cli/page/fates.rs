//! What became of the triangles of the inputs.

use crate::cli::words;
use crate::pipeline::{TriangleKind, TriangleSource};

/// For each triangle of each operand the least changed kind of what is left of it.
pub(super) struct Fates {
    of: Vec<Vec<Option<TriangleKind>>>,
}

impl Fates {
    /// `counts`: the triangles of each operand.
    pub(super) fn new(counts: &[usize], sources: &[TriangleSource], kinds: &[TriangleKind]) -> Self {
        let mut of: Vec<Vec<Option<TriangleKind>>> = counts.iter().map(|&count| vec![None; count]).collect();
        let rank = |kind: TriangleKind| TriangleKind::BY_CHANGE.iter().position(|k| *k == kind);
        for (source, &kind) in sources.iter().zip(kinds) {
            let TriangleSource::Operand { operand, triangle } = *source else { continue };
            let held = of.get_mut(operand as usize).and_then(|list| list.get_mut(triangle as usize));
            if let Some(held) = held.filter(|held| held.is_none_or(|held| rank(kind) < rank(held))) {
                *held = Some(kind);
            }
        }
        Self { of }
    }

    /// What became of some triangles of an operand, in words.
    pub(super) fn words(&self, operand: usize, triangles: &[u32]) -> String {
        self.words_of(std::iter::once((operand, triangles)))
    }

    /// The same of triangles of several.
    pub(super) fn words_of<'a>(&self, places: impl Iterator<Item = (usize, &'a [u32])>) -> String {
        let mut counts = [0; TriangleKind::BY_CHANGE.len() + 1];
        for (operand, triangles) in places {
            let Some(of) = self.of.get(operand) else { continue };
            for fate in triangles.iter().filter_map(|&t| of.get(t as usize)) {
                let place = fate.and_then(|fate| TriangleKind::BY_CHANGE.iter().position(|kind| *kind == fate));
                counts[place.unwrap_or(TriangleKind::BY_CHANGE.len())] += 1;
            }
        }
        let names =
            TriangleKind::BY_CHANGE.map(TriangleKind::word).into_iter().chain(["left out or merged with others"]);
        let parts: Vec<(usize, &str)> = counts.into_iter().zip(names).filter(|(n, _)| *n > 0).collect();
        match parts.as_slice() {
            [] => String::new(),
            &[(1, what)] => format!("its triangle: {what}"),
            &[(n, what)] => format!("all {} triangles: {what}", words::count(n)),
            parts => {
                let each: Vec<String> = parts.iter().map(|(n, what)| format!("{} {what}", words::count(*n))).collect();
                format!("of {}: {}", words::plural(counts.iter().sum(), "triangle"), words::list(&each))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_change_counts() {
        let source = |triangle| TriangleSource::Operand { operand: 0, triangle };
        let kinds = [TriangleKind::Rebuilt, TriangleKind::Cut, TriangleKind::Kept];
        let fates = Fates::new(&[4], &[source(0), source(0), source(1)], &kinds);
        assert_eq!(fates.words(0, &[1]), "its triangle: kept");
        assert_eq!(fates.words(0, &[2, 3]), "all 2 triangles: left out or merged with others");
        assert_eq!(fates.words(0, &[0, 1, 2]), "of 3 triangles: 1 kept, 1 cut and 1 left out or merged with others");
        assert_eq!(fates.words(7, &[0]), "");
    }
}
