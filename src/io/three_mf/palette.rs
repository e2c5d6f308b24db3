//! Writing: colours as the entries of a group.

use rustc_hash::FxHashMap;

use super::super::colour::{Colours, Rgba, WHITE};
use super::super::text::TextOut;
use crate::mesh::TriMesh;

/// The entries of a group of colours: each colour once, in order of first use.
pub(super) struct Palette<'a> {
    /// The number of the group.
    id: u32,
    mesh: &'a TriMesh,
    colours: Option<&'a Colours>,
    entries: Vec<Rgba>,
    numbers: FxHashMap<Rgba, u32>,
}

impl<'a> Palette<'a> {
    /// The colours of the triangles that are wanted.
    pub(super) fn new(
        id: u32,
        mesh: &'a TriMesh,
        colours: Option<&'a Colours>,
        wanted: impl Fn(usize) -> bool,
    ) -> Self {
        let mut palette = Self { id, mesh, colours, entries: Vec::new(), numbers: FxHashMap::default() };
        for triangle in (0..mesh.triangles.len()).filter(|t| wanted(*t)) {
            for colour in palette.corners(triangle) {
                // There are at most 2³² different colours.
                let next = palette.entries.len() as u32;
                if *palette.numbers.entry(colour).or_insert(next) == next {
                    palette.entries.push(colour);
                }
            }
        }
        palette
    }

    /// The colours of a triangle; white where there are none.
    fn corners(&self, triangle: usize) -> [Rgba; 3] {
        self.colours.map_or([WHITE; 3], |colours| colours.corners(self.mesh, triangle))
    }

    pub(super) fn write_group(&self, text: &mut TextOut<'_>) -> std::io::Result<()> {
        text.text(&format!("<m:colorgroup id=\"{}\">\n", self.id));
        for &[red, green, blue, alpha] in &self.entries {
            let alpha = if alpha == 255 { String::new() } else { format!("{alpha:02X}") };
            text.text(&format!("<m:color color=\"#{red:02X}{green:02X}{blue:02X}{alpha}\"/>\n"));
            text.pass_on()?;
        }
        text.text("</m:colorgroup>\n");
        Ok(())
    }

    /// The attributes of a triangle: its group, then one entry, or three where the corners differ.
    pub(super) fn write_entries(&self, triangle: usize, text: &mut TextOut<'_>) {
        let corners = self.corners(triangle);
        let same = corners.iter().all(|colour| *colour == corners[0]);
        text.text("\" pid=\"");
        text.integer(u64::from(self.id));
        for (start, colour) in
            ["\" p1=\"", "\" p2=\"", "\" p3=\""].into_iter().zip(corners).take(if same { 1 } else { 3 })
        {
            text.text(start);
            text.integer(u64::from(self.numbers.get(&colour).copied().unwrap_or_default()));
        }
    }
}
