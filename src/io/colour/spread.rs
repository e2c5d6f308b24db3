//! Colours in the forms that the writers need.

use std::borrow::Cow;

use rustc_hash::FxHashMap;

use super::{Colours, Rgba, WHITE};
use crate::mesh::TriMesh;

/// The colours that the rows of vertices or of faces end in, where a format has one for each vertex or each face. A face
/// whose corners differ gets their mean.
pub(in crate::io) struct Tails<'a> {
    vertices: Option<&'a [Rgba]>,
    faces: Option<Cow<'a, [Rgba]>>,
    channels: usize,
}

impl<'a> Tails<'a> {
    /// The tails of `colours`, without alpha when all are opaque.
    pub(in crate::io) fn of(colours: Option<&'a Colours>) -> Self {
        let (vertices, faces) = match colours {
            None => (None, None),
            Some(Colours::Vertices(colours)) => (Some(colours.as_slice()), None),
            Some(Colours::Faces(colours)) => (None, Some(Cow::Borrowed(colours.as_slice()))),
            Some(Colours::Corners(colours)) => (None, Some(colours.iter().map(|corners| mean(corners)).collect())),
        };
        Self { vertices, faces, channels: if colours.is_some_and(|c| !c.is_opaque()) { 4 } else { 3 } }
    }

    /// The same with alpha, needed or not.
    pub(in crate::io) fn with_alpha(self) -> Self {
        Self { channels: 4, ..self }
    }

    /// How many channels end the row of a vertex.
    pub(in crate::io) fn vertex_channels(&self) -> usize {
        self.vertices.map_or(0, |_| self.channels)
    }

    /// How many channels end the row of a face.
    pub(in crate::io) fn face_channels(&self) -> usize {
        self.faces.as_ref().map_or(0, |_| self.channels)
    }

    /// The channels of a vertex.
    #[inline]
    pub(in crate::io) fn vertex(&self, vertex: usize) -> &[u8] {
        self.vertices.and_then(|colours| colours.get(vertex)).map_or(&[], |colour| &colour[..self.channels])
    }

    /// The channels of a face.
    #[inline]
    pub(in crate::io) fn face(&self, face: usize) -> &[u8] {
        self.faces.as_ref().and_then(|colours| colours.get(face)).map_or(&[], |colour| &colour[..self.channels])
    }
}

fn mean(colours: &[Rgba]) -> Rgba {
    let count = colours.len().max(1);
    [0, 1, 2, 3].map(|k| ((colours.iter().map(|c| usize::from(c[k])).sum::<usize>() + count / 2) / count) as u8)
}

/// A colour for each vertex, for a format that has no other: the mean over the corners of triangles that meet there.
pub(in crate::io) fn vertex_means<'a>(mesh: &TriMesh, colours: &'a Colours) -> Cow<'a, [Rgba]> {
    if let Colours::Vertices(colours) = colours {
        return Cow::Borrowed(colours);
    }
    let mut sums = vec![[0u64; 5]; mesh.positions.len()];
    for (triangle, t) in mesh.triangles.iter().enumerate() {
        for (&v, colour) in t.iter().zip(colours.corners(mesh, triangle)) {
            let sum = &mut sums[v as usize];
            (0..4).for_each(|k| sum[k] += u64::from(colour[k]));
            sum[4] += 1;
        }
    }
    let mean = |sum: &[u64; 5]| match sum[4] {
        0 => WHITE,
        count => [0, 1, 2, 3].map(|k| ((sum[k] + count / 2) / count) as u8),
    };
    sums.iter().map(mean).collect()
}

/// A mesh with one colour for each vertex.
pub(in crate::io) type ByVertex<'a> = (Cow<'a, TriMesh>, Cow<'a, [Rgba]>);

/// The same triangles, with as many vertices at a place as colours meet there: the first keeps its number, the others
/// follow after the last. `None` when that is more than 32 bits can number.
pub(in crate::io) fn by_vertex<'a>(mesh: &'a TriMesh, colours: &'a Colours) -> Option<ByVertex<'a>> {
    if let Colours::Vertices(colours) = colours {
        return Some((Cow::Borrowed(mesh), Cow::Borrowed(colours)));
    }
    let mut first = vec![None; mesh.positions.len()];
    let mut further: FxHashMap<(u32, Rgba), u32> = FxHashMap::default();
    let mut split = mesh.clone();
    let mut added = Vec::new();
    for (triangle, t) in split.triangles.iter_mut().enumerate() {
        for (v, colour) in t.iter_mut().zip(colours.corners(mesh, triangle)) {
            if *first[*v as usize].get_or_insert(colour) == colour {
                continue;
            }
            let next = u32::try_from(split.positions.len()).ok()?;
            let own = *further.entry((*v, colour)).or_insert(next);
            if own == next {
                split.positions.push(mesh.positions[*v as usize]);
                added.push(colour);
            }
            *v = own;
        }
    }
    let kept = first.into_iter().map(|colour| colour.unwrap_or(WHITE));
    Some((Cow::Owned(split), Cow::Owned(kept.chain(added).collect())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn fan() -> TriMesh {
        let positions = (0..6).map(|i| DVec3::splat(f64::from(i))).collect();
        TriMesh { positions, triangles: vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]] }
    }

    #[test]
    fn vertices_are_split_only_where_colours_meet() {
        let (red, blue) = ([255, 0, 0, 255], [0, 0, 255, 255]);
        let colours = Colours::Faces(vec![red, red, blue]);
        let (mesh, by) = by_vertex(&fan(), &colours).map(|(m, c)| (m.into_owned(), c.into_owned())).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [6, 7, 4]]);
        assert_eq!(mesh.positions.len(), 8);
        assert_eq!((mesh.positions[6], mesh.positions[7]), (DVec3::ZERO, DVec3::splat(3.0)));
        assert_eq!(by, [red, red, red, red, blue, WHITE, blue, blue]);
    }

    #[test]
    fn means_are_of_what_meets() {
        let colours = Colours::Faces(vec![[0, 0, 0, 255], [10, 0, 1, 255], [200, 0, 1, 0]]);
        let means = vertex_means(&fan(), &colours);
        assert_eq!(
            means[..],
            [[70, 0, 1, 170], [0, 0, 0, 255], [5, 0, 1, 255], [105, 0, 1, 128], [200, 0, 1, 0], WHITE]
        );
        let corners = Colours::Corners(vec![[[0; 4], [1; 4], [8; 4]]]);
        assert_eq!(Tails::of(Some(&corners)).face(0), [3; 4]);
    }
}
