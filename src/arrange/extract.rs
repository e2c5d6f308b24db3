//! The surface of a solid out of the pieces: those with the inside on one side alone.

use super::cells::Cells;
use super::facets::Cover;
use super::refine::Refined;

/// A triangle of an extracted surface.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Face {
    /// Numbers of points, counter-clockwise seen from outside.
    pub(crate) corners: [u32; 3],
    /// The facet whose plane it lies in.
    pub(crate) facet: u32,
    /// Whether the solid lies in front of that facet.
    pub(crate) over: bool,
    /// A triangle of the input that it lies on.
    pub(crate) cover: Cover,
}

/// The pieces between cells that are inside and cells that are not; `inside` has an entry a cell.
pub(crate) fn extract(refined: &Refined, cells: &Cells, inside: &[bool]) -> Vec<Face> {
    let face = |(piece, [front, back]): (&super::refine::Piece, &[u32; 2])| {
        let over = match (inside[*front as usize], inside[*back as usize]) {
            (false, true) => false,
            (true, false) => true,
            _ => return None,
        };
        let [a, b, c] = piece.corners;
        // A triangle that faces as the result does says best what lies there.
        let covers = refined.covers(piece);
        let cover = *covers.iter().find(|cover| cover.reversed == over).or(covers.first())?;
        Some(Face { corners: if over { [a, c, b] } else { [a, b, c] }, facet: piece.facet, over, cover })
    };
    refined.pieces.iter().zip(&cells.beside).filter_map(face).collect()
}
