//! The node tree: transforms are applied, every node with a mesh becomes a primitive.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use gltf::mesh::Mode;
use gltf::scene::Transform;
use gltf::{Accessor, Document, Node, Semantic};

use super::super::error::{FileError, FileProblem};
use super::super::soup::{Expansion, Soup, too_many_vertices};
use super::super::text::counted;
use super::accessor;
use super::buffers::Buffers;
use super::checked::{self, Primitive};
use super::instancing::Instancing;
use super::material::Tint;
use super::texture::Looks;

/// The soup of the default scene, or of the first, or of every node, or of every mesh: whichever
/// is there.
pub(super) fn read(
    document: &Document,
    instancing: &Instancing,
    buffers: &Buffers<'_>,
    allowance: &mut Expansion,
    path: Option<&Path>,
) -> Result<Soup, FileError> {
    let mut reader = Reader::new(document, instancing, buffers, allowance, Looks::new(document, buffers, path));
    match tops(document)? {
        Some(tops) => reader.nodes(&tops)?,
        None => (0..document.meshes().len()).try_for_each(|mesh| reader.mesh(mesh, "", &DMat4::IDENTITY))?,
    }
    Ok(reader.finish())
}

/// The numbers of the nodes to start from; `None` when the file has no nodes.
pub(super) fn tops(document: &Document) -> Result<Option<Vec<usize>>, FileError> {
    if let Some(scene) = checked::scene(document)? {
        return Ok(Some(checked::tops(document, &scene)));
    }
    let mut is_child = vec![false; document.nodes().len()];
    if is_child.is_empty() {
        return Ok(None);
    }
    for child in document.nodes().flat_map(|node| checked::children(document, &node)) {
        if let Some(flag) = is_child.get_mut(child) {
            *flag = true;
        }
    }
    Ok(Some((0..is_child.len()).filter(|&node| !is_child[node]).collect()))
}

/// Walks the trees under `tops` depth first, and hands out each node with its transform. A node has one parent at most, so a node met
/// twice is an error; that also ends cycles.
pub(super) fn walk<'a>(
    document: &'a Document,
    tops: &[usize],
    mut visit: impl FnMut(usize, &Node<'a>, &DMat4) -> Result<(), FileError>,
) -> Result<(), FileError> {
    let mut met = vec![false; document.nodes().len()];
    let mut stack: Vec<_> = tops.iter().rev().map(|&top| (top, DMat4::IDENTITY)).collect();
    while let Some((i, parent)) = stack.pop() {
        let fail = |problem| FileError::item(format!("nodes[{i}]"), problem);
        let node = checked::node(document, i).map_err(fail)?;
        if std::mem::replace(&mut met[i], true) {
            return Err(fail(FileProblem::syntax("a tree of nodes", "a node that is reached twice")));
        }
        let place = parent * matrix(node.transform());
        visit(i, &node, &place)?;
        stack.extend(checked::children(document, &node).into_iter().rev().map(|child| (child, place)));
    }
    Ok(())
}

/// What is read of meshes.
pub(super) struct Reader<'a, 'b> {
    document: &'a Document,
    instancing: &'a Instancing,
    buffers: &'a Buffers<'a>,
    allowance: &'b mut Expansion,
    soup: Soup,
    used: Vec<bool>,
    other_primitives: usize,
    /// Primitives of points.
    points: usize,
    looks: Looks<'a>,
    posed: usize,
}

/// What primitives of one mesh share, by accessor.
#[derive(Default)]
struct Shared {
    /// The first vertex and how many.
    vertices: BTreeMap<usize, (u32, usize)>,
    /// Linear light and alpha.
    colours: BTreeMap<usize, Vec<[f32; 4]>>,
}

impl<'a, 'b> Reader<'a, 'b> {
    pub(super) fn new(
        document: &'a Document,
        instancing: &'a Instancing,
        buffers: &'a Buffers<'a>,
        allowance: &'b mut Expansion,
        looks: Looks<'a>,
    ) -> Self {
        Self {
            document,
            instancing,
            buffers,
            allowance,
            soup: Soup::new(),
            used: vec![false; document.meshes().len()],
            other_primitives: 0,
            points: 0,
            looks,
            posed: 0,
        }
    }

    /// Adds the meshes of the trees under `tops`.
    fn nodes(&mut self, tops: &[usize]) -> Result<(), FileError> {
        let document = self.document;
        walk(document, tops, |i, node, place| {
            let Some((mesh, is_posed)) = checked::mesh_of(document, node) else { return Ok(()) };
            self.posed += usize::from(is_posed);
            let name = node.name().unwrap_or_default();
            self.each_copy(i, place, |reader, place| reader.mesh(mesh, name, place))
        })
    }

    /// Hands out the places of the mesh of a node that has this transform itself, one by one: there may be any number.
    pub(super) fn each_copy(
        &mut self,
        node: usize,
        place: &DMat4,
        mut visit: impl FnMut(&mut Self, &DMat4) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        match self.instancing.of(node, self.document, self.buffers, self.allowance)? {
            Some(copies) => copies.places().try_for_each(|copy| visit(self, &(*place * copy))),
            None => visit(self, place),
        }
    }

    /// Counts a place of a mesh, which takes as much memory as a few vertices.
    pub(super) fn count_place(&mut self) -> Result<(), FileError> {
        Ok(self.allowance.spend(4)?)
    }

    pub(super) fn mesh(&mut self, i: usize, name: &str, place: &DMat4) -> Result<(), FileError> {
        let fail = |problem| FileError::item(format!("meshes[{i}]"), problem);
        let mesh = checked::mesh(self.document, i).map_err(fail)?;
        self.used[i] = true;
        // Counted even when there is nothing in it, so that the work is bounded too.
        self.allowance.spend(1 + mesh.primitives().len() as u64).map_err(fail)?;
        let name = if name.is_empty() { mesh.name().unwrap_or_default() } else { name };
        self.soup.begin_part(name.as_bytes());
        // Primitives of a mesh often share one accessor: its vertices are taken once.
        let mut shared = Shared::default();
        for primitive in checked::primitives(self.document, &mesh) {
            let Some(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = primitive.mode() else {
                self.passed_over(&primitive);
                continue;
            };
            self.posed += usize::from(primitive.has_morph_targets());
            self.primitive(&primitive, mode, place, &mut shared).map_err(|e| match e.location {
                Some(_) => e,
                None => fail(*e.problem),
            })?;
        }
        Ok(())
    }

    /// Counts a primitive of points or lines.
    fn passed_over(&mut self, primitive: &Primitive<'_>) {
        if primitive.mode() == Some(Mode::Points) && primitive.has(Semantic::Positions) {
            let count =
                primitive.attribute(Semantic::Positions).ok().flatten().map_or(0, |positions| positions.count());
            self.points += 1;
            self.soup.points = self.soup.points.saturating_add(count);
        } else {
            self.other_primitives += 1;
        }
    }

    fn primitive(
        &mut self,
        primitive: &Primitive<'a>,
        mode: Mode,
        place: &DMat4,
        shared: &mut Shared,
    ) -> Result<(), FileError> {
        let Some(positions) = primitive.attribute(Semantic::Positions)? else {
            self.other_primitives += 1;
            return Ok(());
        };
        let (first, count) = match shared.vertices.get(&positions.index()) {
            Some(&vertices) => vertices,
            None => {
                let vertices = self.vertices(&positions, place)?;
                shared.vertices.insert(positions.index(), vertices);
                vertices
            }
        };
        let order = primitive.indices()?;
        let indices = match &order {
            Some(order) => accessor::indices(self.document, self.buffers, order, self.allowance)?,
            None => {
                self.allowance.spend(count as u64)?;
                (0..count as u32).collect()
            }
        };
        if let Some(&index) = indices.iter().find(|&&v| v as usize >= count) {
            let item = order.map_or(0, |order| order.index());
            return Err(FileError::item(format!("accessors[{item}]"), FileProblem::vertex(i64::from(index), count)));
        }
        let corners: Vec<u32> = indices.into_iter().map(|v| v + first).collect();
        let start = self.soup.triangles.len();
        match mode {
            Mode::TriangleStrip => self.soup.strip(&corners),
            Mode::TriangleFan if corners.len() >= 3 => super::super::polygon::fan(&corners, &mut self.soup.triangles),
            Mode::TriangleFan => {}
            _ => self.soup.triangles.extend(corners.chunks_exact(3).map(|t| [t[0], t[1], t[2]])),
        }
        // A mirroring transform turns every triangle over; the specification asks to turn them back.
        if place.determinant() < 0.0 {
            self.soup.triangles[start..].iter_mut().for_each(|t| t.swap(1, 2));
        }
        self.paint(primitive, start, first, shared)
    }

    /// Colours the triangles from number `start` on, whose vertices are counted from `first`.
    fn paint(
        &mut self,
        primitive: &Primitive<'a>,
        start: usize,
        first: u32,
        shared: &mut Shared,
    ) -> Result<(), FileError> {
        let mut tint = primitive.material()?.map_or_else(Tint::plain, |material| Tint::of(self.document, &material));
        if self.looks.keeps_colours {
            // Colours of vertices are there only where materials go by their numbers.
            tint = Tint::raw();
        }
        if self.looks.is_textured {
            self.looks.hang(primitive, (start, first), &mut self.soup, self.allowance);
        }
        let vertices = primitive.attribute(Semantic::Colors(0))?;
        let (soup, odd) = (&mut self.soup, &mut 0);
        let triangles = &soup.triangles[start..];
        let Some(vertices) = vertices else {
            if !tint.is_plain() {
                let colour = tint.applied_to([1.0; 4], odd);
                soup.colours.paint(start, triangles.iter().map(|_| [colour; 3]));
                soup.colours.odd += *odd;
            }
            return Ok(());
        };
        let colours = match shared.colours.entry(vertices.index()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                new.insert(accessor::colours(self.document, self.buffers, &vertices, self.allowance)?)
            }
        };
        if let Some(v) = triangles.iter().flatten().map(|v| v - first).find(|&v| v as usize >= colours.len()) {
            let expected = format!("a colour for vertex {v}");
            let problem = FileProblem::truncated(expected, format!("there are {}", counted(colours.len(), "colour")));
            return Err(FileError::item(format!("accessors[{}]", vertices.index()), problem));
        }
        let corners = |t: &[u32; 3]| t.map(|v| tint.applied_to(colours[(v - first) as usize], odd));
        soup.colours.paint(start, triangles.iter().map(corners));
        soup.colours.odd += *odd;
        Ok(())
    }

    /// The transformed vertices of an accessor: the number of the first and how many.
    fn vertices(&mut self, accessor: &Accessor<'_>, place: &DMat4) -> Result<(u32, usize), FileError> {
        let points = accessor::positions(self.document, self.buffers, accessor, self.allowance)?;
        let first = self.soup.positions.len();
        if first + points.len() > u32::MAX as usize {
            return Err(too_many_vertices());
        }
        self.soup.positions.reserve(points.len());
        // Multiplied by one, −0 would become 0.
        let in_place = *place == DMat4::IDENTITY;
        for &point in &points {
            let point = DVec3::from(point);
            self.soup.positions.push(if in_place { point } else { place.transform_point3(point) });
        }
        Ok((first as u32, points.len()))
    }

    /// What was read where all else is told by name.
    pub(super) fn finish_apart(mut self) -> Soup {
        (self.other_primitives, self.points, self.posed) = (0, 0, 0);
        self.used.fill(true);
        self.finish()
    }

    /// What was read, with sentences on what was not.
    pub(super) fn finish(mut self) -> Soup {
        // A file of points alone is named as such.
        let points = if self.soup.triangles.is_empty() { 0 } else { self.points };
        let mut warn = |count: usize, what: &str, rest: &str| {
            if count > 0 {
                self.soup.warnings.push(format!("{} {rest}", counted(count, what)));
            }
        };
        warn(self.other_primitives + points, "primitive", "without triangles left out");
        warn(self.posed, "mesh", "with a skin or morph targets read in the pose they are stored in");
        warn(self.used.iter().filter(|used| !**used).count(), "mesh", "not part of the scene left out");
        self.looks.finish(&mut self.soup);
        self.soup
    }
}

/// The decimal number that a file has for a scale, which is held in 24 bits: 0.001 and not 0.001000000047, so that millimetres stay
/// what they are.
fn as_written(scale: f32) -> f64 {
    scale.to_string().parse().unwrap_or_else(|_| f64::from(scale))
}

fn matrix(transform: Transform) -> DMat4 {
    let (translation, rotation, scale) = match transform {
        Transform::Matrix { matrix } => return DMat4::from_cols_array_2d(&matrix.map(|column| column.map(f64::from))),
        Transform::Decomposed { translation, rotation, scale } => (translation, rotation, scale),
    };
    let rotation = DQuat::from_array(rotation.map(f64::from));
    // A quaternion is stored in 24 bits: made a unit again, the transform keeps lengths.
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(
        DVec3::from(scale.map(as_written)),
        rotation,
        DVec3::from(translation.map(f64::from)),
    )
}
