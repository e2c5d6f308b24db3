//! A mesh file as read.

use std::borrow::Cow;
use std::ops::Range;

use super::colour::Colours;
use super::colour_scale::ColourScale;
use super::format::Format;
use super::legend::LegendEntry;
use super::paint::Paint;
use super::texture::{TextureMap, shown_colours};
use super::unit::Unit;
use crate::mesh::{TriMesh, ValidateOptions};

/// A named piece of a file: an object, a solid, a node.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Part {
    /// The name in the file; empty where it has none.
    pub name: String,
    /// The numbers of its triangles in the mesh.
    pub triangles: Range<usize>,
}

/// Solids that a file takes away from its mesh: negative volumes of slicers in 3MF.
#[derive(Debug, Clone, PartialEq)]
pub struct Negative {
    /// The triangles. There is at least one; every coordinate is finite and every index in range.
    pub mesh: TriMesh,
    /// The pieces, in order and without gaps. There is at least one, and none is empty.
    pub parts: Vec<Part>,
}

/// A mesh file as read.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The triangles. There is at least one; every coordinate is finite and every index in range.
    pub mesh: TriMesh,
    /// The colours of `mesh`, one for each triangle, vertex or corner; `None` where the file has none. Colours of materials are in
    /// `texture`; [`Loaded::shown_colours`] has both.
    pub colours: Option<Colours>,
    /// The textures of `mesh`: coordinates, materials with their colours, images; `None` where the file has none.
    pub texture: Option<TextureMap>,
    /// What the file says that its colours mean: the legend of a map in PLY.
    pub legend: Vec<LegendEntry>,
    /// What the file says of measured values that its colours stand for: the scale of a map of distances in PLY.
    pub scale: Option<ColourScale>,
    /// The format that was found.
    pub format: Format,
    /// The unit of length that the file states.
    pub unit: Option<Unit>,
    /// The pieces of the file, in order and without gaps. There is at least one, and none is empty.
    pub parts: Vec<Part>,
    /// What the file says is to be taken away from `mesh`. The readers leave that to the caller:
    /// [`boolean`](crate::pipeline::boolean) with [`Expression::less`](crate::ldi::Expression::less) does it.
    pub negative: Option<Negative>,
    /// Sentences about what was left out or read otherwise than it stands.
    pub warnings: Vec<String>,
}

impl Loaded {
    /// The colours that the surface shows: those of its triangles, vertices or corners, else those of its materials, as OBJ
    /// has them in its `.mtl` file; `None` where there are neither.
    pub fn shown_colours(&self) -> Option<Cow<'_, Colours>> {
        shown_colours(self.colours.as_ref(), self.texture.as_ref())
    }

    /// The colours and textures in the form that the writers take.
    pub fn paint(&self) -> Paint<'_> {
        Paint { colours: self.colours.as_ref(), texture: self.texture.as_ref(), beside: None }
    }

    /// How [`validate`](crate::mesh::validate) should look at the mesh: with vertices of equal positions taken for one where the format
    /// cannot say that they are (see [`Format::repeats_vertices`]). Without that, a sound solid in glTF would count as open along
    /// every edge at which its normals or colours change.
    pub fn validate_options(&self) -> ValidateOptions {
        ValidateOptions { self_intersections: true, weld: self.format.repeats_vertices() }
    }

    /// Merges the vertices at equal positions ([`TriMesh::welded`]), as algorithms that go along edges need it for formats that repeat them
    /// ([`Format::repeats_vertices`]). Colours of vertices become colours of corners, since several may meet in one
    /// place then.
    pub fn weld(&mut self) {
        if let Some(colours @ Colours::Vertices(_)) = &self.colours {
            let corners = |triangle| colours.corners(&self.mesh, triangle);
            self.colours = Some(Colours::Corners((0..self.mesh.triangles.len()).map(corners).collect()));
        }
        self.mesh = self.mesh.welded();
    }

    /// Brings the mesh, and what is to be taken away from it, from the unit `own` to `unit`, and states that unit. Returns the
    /// factor by which the coordinates were multiplied.
    pub fn rescale(&mut self, own: Unit, unit: Unit) -> f64 {
        let factor = own.metres() / unit.metres();
        self.unit = Some(unit);
        if own == unit {
            return 1.0;
        }
        let negative = self.negative.iter_mut().map(|negative| &mut negative.mesh);
        for p in std::iter::once(&mut self.mesh).chain(negative).flat_map(|mesh| &mut mesh.positions) {
            *p *= factor;
        }
        factor
    }
}
