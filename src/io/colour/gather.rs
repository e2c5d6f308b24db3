//! What the readers fill: colours as they come, made one [`Colours`] at the end.

use std::ops::Range;

use super::super::text::counted;
use super::{Colours, Rgba, WHITE};
use crate::mesh::TriMesh;

/// Channels above this count to 255. Files of channels that count to 1 hold a little more by sloppy rounding or lighting;
/// files that count to 255 and hold no more than 2 would be black.
const BRIGHTEST_OF_ONE: f32 = 2.0;

/// The channels of white, or of an alpha that the file does not state: full, whatever full is.
pub(in crate::io) const LEVELS_OF_WHITE: [f32; 4] = [f32::INFINITY; 4];

/// Channels as they stand in a file, by vertex or by triangle, before it is known what they count to.
#[derive(Debug, Default)]
pub(in crate::io) struct Levels {
    values: Vec<[f32; 4]>,
    /// What stands for full light; told from the values when not known.
    full: Option<f32>,
}

impl Levels {
    /// States what stands for full light: 1, 255 or 65535.
    pub(in crate::io) fn count_to(&mut self, full: f32) {
        self.full = Some(full);
    }

    /// Sets the colour of `which`, none of which must have one yet. What is passed over stays white.
    #[inline]
    pub(in crate::io) fn put(&mut self, which: Range<usize>, levels: [f32; 4]) {
        self.values.resize(which.start.max(self.values.len()), LEVELS_OF_WHITE);
        self.values.resize(which.end.max(self.values.len()), levels);
    }

    /// Forgets the colours of what is not kept.
    fn keep<T>(&mut self, kept: &[Option<T>]) {
        keep(&mut self.values, kept);
    }

    /// `count` colours, if there are any. Channels out of range become the nearest in range, and are counted in `odd`.
    fn finish(self, count: usize, odd: &mut usize) -> Option<Vec<Rgba>> {
        if self.values.is_empty() {
            return None;
        }
        let full = self.full.unwrap_or_else(|| {
            let large = |level: &f32| level.is_finite() && *level > BRIGHTEST_OF_ONE;
            if self.values.iter().flatten().any(large) { 255.0 } else { 1.0 }
        });
        let mut colours: Vec<Rgba> = self.values.iter().map(|levels| rgba(*levels, full, odd)).collect();
        colours.resize(count, WHITE);
        Some(colours)
    }
}

/// The entries of `list`, which may be too short or too long, that are kept.
fn keep<C, T>(list: &mut Vec<C>, kept: &[Option<T>]) {
    let mut kept = kept.iter().map(Option::is_some);
    list.retain(|_| kept.next().unwrap_or(false));
}

fn rgba(levels: [f32; 4], full: f32, odd: &mut usize) -> Rgba {
    let mut all_in_range = true;
    let colour = levels.map(|level| {
        let level = if level == f32::INFINITY { full } else { level };
        let scaled = (f64::from(level) / f64::from(full) * 255.0).round();
        all_in_range &= (0.0..=255.0).contains(&scaled);
        // The cast ends at 0 and 255, and makes NaN 0.
        scaled as u8
    });
    *odd += usize::from(!all_in_range);
    colour
}

/// The colours of a mesh while it is read. A reader fills the corners, or the vertices and faces.
#[derive(Debug, Default)]
pub(in crate::io) struct Gathered {
    corners: Vec<[Rgba; 3]>,
    /// By vertex.
    pub(in crate::io) vertices: Levels,
    /// By triangle.
    pub(in crate::io) faces: Levels,
    /// Colours that were out of range.
    pub(in crate::io) odd: usize,
}

impl Gathered {
    /// Sets the colours of the triangles from number `first` on; triangles passed over are white.
    pub(in crate::io) fn paint(&mut self, first: usize, corners: impl IntoIterator<Item = [Rgba; 3]>) {
        self.corners.resize(first.max(self.corners.len()), [WHITE; 3]);
        self.corners.extend(corners);
    }

    /// Forgets the colours of vertices and triangles that are not kept.
    pub(in crate::io) fn keep<V, T>(&mut self, vertices: &[Option<V>], triangles: &[Option<T>]) {
        self.vertices.keep(vertices);
        self.faces.keep(triangles);
        keep(&mut self.corners, triangles);
    }

    /// The colours of the finished mesh, `None` when the file has none.
    pub(in crate::io) fn finish(mut self, mesh: &TriMesh, warnings: &mut Vec<String>) -> Option<Colours> {
        let vertices = self.vertices.finish(mesh.positions.len(), &mut self.odd);
        let faces = self.faces.finish(mesh.triangles.len(), &mut self.odd);
        if self.odd > 0 {
            warnings.push(format!("{} out of range taken as the nearest in range", counted(self.odd, "colour")));
        }
        if !self.corners.is_empty() {
            self.corners.resize(mesh.triangles.len(), [WHITE; 3]);
            return Some(Colours::of_corners(self.corners, mesh));
        }
        match (vertices, faces) {
            (Some(vertices), Some(faces)) => Some(more_telling(vertices, faces, warnings)),
            (Some(vertices), None) => Some(Colours::Vertices(vertices)),
            (None, Some(faces)) => Some(Colours::Faces(faces)),
            (None, None) => None,
        }
    }
}

/// Of a file with both: the colours of the vertices, unless they are all the same. Programs that keep both write the ones
/// that were never set as well, in one colour.
fn more_telling(vertices: Vec<Rgba>, faces: Vec<Rgba>, warnings: &mut Vec<String>) -> Colours {
    let plain = |colours: &[Rgba]| colours.windows(2).all(|pair| pair[0] == pair[1]);
    if plain(&vertices) && !(plain(&faces) && faces.first() == Some(&WHITE)) {
        return Colours::Faces(faces);
    }
    if !plain(&faces) {
        warnings.push("the colours of the faces left out; the vertices have colours too".into());
    }
    Colours::Vertices(vertices)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn resolved(values: &[[f32; 4]], full: Option<f32>) -> (Vec<Rgba>, usize) {
        let mut levels = Levels { full, ..Levels::default() };
        values.iter().enumerate().for_each(|(i, v)| levels.put(i..i + 1, *v));
        let mut odd = 0;
        (levels.finish(values.len(), &mut odd).unwrap(), odd)
    }

    #[test]
    fn channels_count_to_one_or_to_255() {
        let inf = f32::INFINITY;
        assert_eq!(resolved(&[[0.0, 0.5, 1.0, inf]], None), (vec![[0, 128, 255, 255]], 0));
        assert_eq!(resolved(&[[0.0, 0.5, 2.5, inf]], None), (vec![[0, 1, 3, 255]], 0));
        assert_eq!(resolved(&[[0.0, 257.0, 65535.0, 514.0]], Some(65535.0)), (vec![[0, 1, 255, 2]], 0));
        // Slightly above by rounding is no fault; far above and NaN are.
        assert_eq!(resolved(&[[1.0001, 0.0, 0.0, inf]], None), (vec![[255, 0, 0, 255]], 0));
        assert_eq!(resolved(&[[1.5, -1.0, f32::NAN, inf], [0.0; 4]], None), (vec![[255, 0, 0, 255], [0; 4]], 1));
    }

    #[test]
    fn gaps_are_white() {
        let mut levels = Levels::default();
        levels.put(2..4, [0.0; 4]);
        assert_eq!(levels.finish(5, &mut 0), Some(vec![WHITE, WHITE, [0; 4], [0; 4], WHITE]));
        assert_eq!(Levels::default().finish(5, &mut 0), None);
    }

    #[test]
    fn of_two_the_one_that_says_more_is_taken() {
        let (red, blue) = ([255, 0, 0, 255], [0, 0, 255, 255]);
        let take = |vertices: [Rgba; 2], faces: [Rgba; 2]| {
            let mut warnings = Vec::new();
            let taken = more_telling(vertices.to_vec(), faces.to_vec(), &mut warnings);
            (matches!(taken, Colours::Faces(_)), warnings.len())
        };
        assert_eq!(take([red, blue], [red, blue]), (false, 1));
        assert_eq!(take([red, blue], [red, red]), (false, 0));
        assert_eq!(take([WHITE, WHITE], [red, blue]), (true, 0));
        assert_eq!(take([WHITE, WHITE], [red, red]), (true, 0));
        assert_eq!(take([red, red], [WHITE, WHITE]), (false, 0));
    }
}
