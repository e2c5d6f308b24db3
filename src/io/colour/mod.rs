//! Colours of a mesh: what the files hold, at any place of the surface.

mod gather;
mod spread;
mod srgb;

use super::format::Format;
use crate::mesh::TriMesh;

pub(super) use gather::{Gathered, LEVELS_OF_WHITE, Levels};
pub(super) use spread::{Tails, by_vertex, vertex_means};
pub(crate) use srgb::linear_from_srgb;
pub(super) use srgb::srgb_from_linear;

/// Red, green and blue as sRGB, 0 to 255, then alpha: 0 clear, 255 opaque.
pub type Rgba = [u8; 4];

/// The colour of what has none, in a file where something else has one.
pub(super) const WHITE: Rgba = [255; 4];

/// The colours of a mesh. A list that is too short counts as continued in opaque white.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Colours {
    /// One for each triangle.
    Faces(Vec<Rgba>),
    /// One for each vertex.
    Vertices(Vec<Rgba>),
    /// One for each corner of each triangle, for a mesh with both seams and gradients of colour.
    Corners(Vec<[Rgba; 3]>),
}

/// How much of some colours a format holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Carried {
    /// Every triangle keeps the colours of its corners exactly.
    Wholly,
    /// Means: the format has no place for colours of this kind, or none for alpha.
    Roughly,
    /// Not at all.
    Not,
}

impl Colours {
    /// The colour of `triangle` of `mesh` at the place whose barycentric coordinates are `weights`; at the corners it is
    /// theirs. In between, the stored numbers are interpolated as they are, without a detour over linear light.
    pub fn at(&self, mesh: &TriMesh, triangle: usize, weights: [f64; 3]) -> Rgba {
        let [a, b, c] = self.corners(mesh, triangle);
        if a == b && b == c {
            return a;
        }
        // The cast ends at 0 and 255, for weights of places outside the triangle.
        let mix = |k: usize| [a, b, c].iter().zip(weights).map(|(corner, weight)| weight * f64::from(corner[k])).sum();
        [0, 1, 2, 3].map(|k| f64::round(mix(k)) as u8)
    }

    /// The colours of the corners of `triangle` of `mesh`.
    pub fn corners(&self, mesh: &TriMesh, triangle: usize) -> [Rgba; 3] {
        match self {
            Self::Faces(colours) => [colours.get(triangle).copied().unwrap_or(WHITE); 3],
            Self::Vertices(colours) => mesh
                .triangles
                .get(triangle)
                .map_or([WHITE; 3], |t| t.map(|v| colours.get(v as usize).copied().unwrap_or(WHITE))),
            Self::Corners(colours) => colours.get(triangle).copied().unwrap_or([WHITE; 3]),
        }
    }

    /// How much of these colours of `mesh` a file of `format` holds.
    pub fn carried_by(&self, format: Format, mesh: &TriMesh) -> Carried {
        let whole = match format {
            Format::Stl => return Carried::Not,
            Format::Glb | Format::Gltf | Format::ThreeMf => true,
            Format::Ply | Format::Off => self.is_flat() || matches!(self, Self::Vertices(_)),
            Format::Obj => self.is_opaque() && self.vertices(mesh).is_some(),
        };
        if whole { Carried::Wholly } else { Carried::Roughly }
    }

    /// Whether every triangle is known to have a single colour.
    fn is_flat(&self) -> bool {
        match self {
            Self::Faces(_) => true,
            Self::Vertices(_) => false,
            Self::Corners(colours) => colours.iter().all(|[a, b, c]| a == b && b == c),
        }
    }

    /// One colour for each vertex, if no two meet there. Vertices without a triangle are white.
    fn vertices(&self, mesh: &TriMesh) -> Option<Vec<Rgba>> {
        let mut vertices = vec![None; mesh.positions.len()];
        for (triangle, t) in mesh.triangles.iter().enumerate() {
            for (&v, colour) in t.iter().zip(self.corners(mesh, triangle)) {
                if *vertices.get_mut(v as usize)?.get_or_insert(colour) != colour {
                    return None;
                }
            }
        }
        Some(vertices.into_iter().map(|colour| colour.unwrap_or(WHITE)).collect())
    }

    /// Whether no colour lets anything through.
    pub(super) fn is_opaque(&self) -> bool {
        match self {
            Self::Faces(colours) | Self::Vertices(colours) => colours.iter().all(|c| c[3] == 255),
            Self::Corners(colours) => colours.iter().flatten().all(|c| c[3] == 255),
        }
    }

    /// Whether all are opaque white.
    pub(super) fn is_white(&self) -> bool {
        match self {
            Self::Faces(colours) | Self::Vertices(colours) => colours.iter().all(|c| *c == WHITE),
            Self::Corners(colours) => colours.iter().flatten().all(|c| *c == WHITE),
        }
    }

    /// How many colours there are, and how many there should be for `mesh`.
    pub(super) fn counts(&self, mesh: &TriMesh) -> [usize; 2] {
        match self {
            Self::Faces(colours) => [colours.len(), mesh.triangles.len()],
            Self::Vertices(colours) => [colours.len(), mesh.positions.len()],
            Self::Corners(colours) => [colours.len(), mesh.triangles.len()],
        }
    }

    /// The same colours in the smallest form: by triangle, else by vertex, else as they are. Vertices without a triangle
    /// become white.
    pub(super) fn of_corners(corners: Vec<[Rgba; 3]>, mesh: &TriMesh) -> Self {
        let corners = Self::Corners(corners);
        if corners.is_flat() {
            return Self::Faces((0..mesh.triangles.len()).map(|triangle| corners.corners(mesh, triangle)[0]).collect());
        }
        corners.vertices(mesh).map_or(corners, Self::Vertices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use proptest::prelude::*;

    fn two_triangles() -> TriMesh {
        TriMesh { positions: vec![DVec3::ZERO; 5], triangles: vec![[0, 1, 2], [2, 1, 3]] }
    }

    #[test]
    fn corners_have_their_colours_and_places_between_a_mixture() {
        let mesh = two_triangles();
        let four = vec![[0, 0, 0, 255], [200, 0, 0, 255], [0, 100, 0, 55], [9; 4], [1; 4]];
        let vertices = Colours::Vertices(four.clone());
        assert_eq!(vertices.at(&mesh, 1, [1.0, 0.0, 0.0]), four[2]);
        assert_eq!(vertices.at(&mesh, 1, [0.0, 0.0, 1.0]), four[3]);
        assert_eq!(vertices.at(&mesh, 0, [0.5, 0.25, 0.25]), [50, 25, 0, 205]);
        assert_eq!(vertices.at(&mesh, 0, [-9.0, 10.0, 0.0]), [255, 0, 0, 255]);
        assert_eq!(vertices.at(&mesh, 0, [f64::NAN; 3]), [0; 4]);
        let faces = Colours::Faces(vec![[1, 2, 3, 4]]);
        assert_eq!(faces.at(&mesh, 0, [0.2, 0.3, 0.5]), [1, 2, 3, 4]);
        assert_eq!(faces.at(&mesh, 1, [0.2, 0.3, 0.5]), WHITE);
        assert_eq!(vertices.at(&mesh, 9, [1.0, 0.0, 0.0]), WHITE);
    }

    proptest! {
        #[test]
        fn the_smallest_form_says_the_same(corners in prop::collection::vec(prop::array::uniform3(0u8..2), 2)) {
            let mesh = two_triangles();
            let corners: Vec<_> = corners.into_iter().map(|t| t.map(|level| [level; 4])).collect();
            let small = Colours::of_corners(corners.clone(), &mesh);
            prop_assert_eq!(&vec![small.corners(&mesh, 0), small.corners(&mesh, 1)], &corners);
            let flat = corners.iter().all(|[a, b, c]| a == b && b == c);
            let seamless = corners[0][1] == corners[1][1] && corners[0][2] == corners[1][0];
            match small {
                Colours::Faces(_) => prop_assert!(flat),
                Colours::Vertices(_) => prop_assert!(!flat && seamless),
                Colours::Corners(_) => prop_assert!(!flat && !seamless),
            }
        }
    }
}
