//! What can be seen on a mesh: colours of triangles, values, lines, marks.

use glam::DVec3;

/// What each triangle is, one of a few things.
#[derive(Debug, Clone, Default)]
pub struct Classes {
    /// What is told: the same name in several panes is one choice.
    pub name: String,
    /// For each triangle the number of its entry in the legend.
    pub of: Vec<u8>,
    /// The colours, and what they mean.
    pub legend: Vec<([u8; 3], String)>,
}

/// A number for each vertex or triangle.
#[derive(Debug, Clone, Default)]
pub struct Values {
    /// What is told: the same name in several panes is one choice, with one scale.
    pub name: String,
    /// The numbers; what is not finite is drawn grey.
    pub of: Vec<f64>,
    /// Whether there is one for each triangle; else for each vertex.
    pub by_triangle: bool,
    /// The ends of the scale; from -x to x, zero is white.
    pub range: [f64; 2],
    /// The ends of the scale in words, with the unit.
    pub ends: [String; 2],
    /// A sentence on what is measured.
    pub meaning: String,
}

/// Lines over the mesh.
#[derive(Debug, Clone, Default)]
pub struct Lines {
    /// What they are.
    pub name: String,
    /// Their colour.
    pub colour: [u8; 3],
    /// Their ends.
    pub segments: Vec<[DVec3; 2]>,
}

/// Places with a short text.
#[derive(Debug, Clone, Default)]
pub struct Marks {
    /// What they are.
    pub name: String,
    /// Their colour.
    pub colour: [u8; 3],
    /// Where they are, and what is written there.
    pub marks: Vec<(DVec3, String)>,
}

/// The twelve edges of a box.
pub fn box_edges(min: DVec3, max: DVec3) -> impl Iterator<Item = [DVec3; 2]> {
    let corner = move |k: usize| {
        DVec3::new(
            if k & 1 == 0 { min.x } else { max.x },
            if k & 2 == 0 { min.y } else { max.y },
            if k & 4 == 0 { min.z } else { max.z },
        )
    };
    (0..8).flat_map(move |k| {
        [1, 2, 4].into_iter().filter(move |bit| k & bit == 0).map(move |bit| [corner(k), corner(k | bit)])
    })
}
