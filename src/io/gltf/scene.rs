//! The node tree: transforms are applied, every node with a mesh becomes a part.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use glam::{DMat4, DQuat, DVec3};
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::scene::Node;
use gltf_json::validation::Checked;
use gltf_json::{Index, Root};

use super::super::error::{FileError, FileProblem};
use super::super::soup::{Expansion, Soup, too_many_vertices};
use super::super::text::counted;
use super::accessor;
use super::buffers::{Buffers, missing};
use super::instancing::Instancing;
use super::material::Tint;
use super::texture::Looks;

/// The soup of the default scene, or of the first, or of every node, or of every mesh: whichever
/// is there.
pub(super) fn read(
    root: &Root,
    instancing: &Instancing,
    buffers: &Buffers<'_>,
    allowance: &mut Expansion,
    path: Option<&Path>,
) -> Result<Soup, FileError> {
    let mut reader = Reader {
        root,
        instancing,
        buffers,
        allowance,
        soup: Soup::new(),
        used: vec![false; root.meshes.len()],
        other_primitives: 0,
        points: 0,
        looks: Looks::new(root, buffers, path),
        posed: 0,
    };
    match tops(root)? {
        Some(tops) => reader.nodes(tops)?,
        None => {
            for mesh in 0..root.meshes.len() {
                reader.mesh(Index::new(mesh as u32), "", &DMat4::IDENTITY)?;
            }
        }
    }
    Ok(reader.finish())
}

/// The nodes to start from; `None` when the file has no nodes.
fn tops(root: &Root) -> Result<Option<Vec<Index<Node>>>, FileError> {
    if let Some(scene) = root.scene {
        let problem = || missing(scene.value(), root.scenes.len(), "scenes");
        let scene = root.get(scene).ok_or_else(|| FileError::item("scene", problem()))?;
        return Ok(Some(scene.nodes.clone()));
    }
    if let Some(scene) = root.scenes.first() {
        return Ok(Some(scene.nodes.clone()));
    }
    if root.nodes.is_empty() {
        return Ok(None);
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(flag) = is_child.get_mut(child.value()) {
            *flag = true;
        }
    }
    Ok(Some((0..root.nodes.len()).filter(|&i| !is_child[i]).map(|i| Index::new(i as u32)).collect()))
}

struct Reader<'a, 'b> {
    root: &'a Root,
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

impl Reader<'_, '_> {
    /// Walks the trees under `tops` depth first. A node has one parent at most, so a node met
    /// twice is an error; that also ends cycles.
    fn nodes(&mut self, tops: Vec<Index<Node>>) -> Result<(), FileError> {
        let mut met = vec![false; self.root.nodes.len()];
        let mut stack: Vec<_> = tops.into_iter().rev().map(|top| (top, DMat4::IDENTITY)).collect();
        while let Some((index, parent)) = stack.pop() {
            let i = index.value();
            let fail = |problem| FileError::item(format!("nodes[{i}]"), problem);
            let count = self.root.nodes.len();
            let node = self.root.get(index).ok_or_else(|| fail(missing(i, count, "nodes")))?;
            if std::mem::replace(&mut met[i], true) {
                return Err(fail(FileProblem::syntax("a tree of nodes", "a node that is reached twice")));
            }
            let place = parent * local_transform(node);
            if let Some(mesh) = node.mesh {
                self.posed += usize::from(node.skin.is_some());
                let name = node.name.as_deref().unwrap_or_default();
                match self.instancing.of(i, self.root, self.buffers, self.allowance)? {
                    Some(copies) => copies.places().try_for_each(|copy| self.mesh(mesh, name, &(place * copy)))?,
                    None => self.mesh(mesh, name, &place)?,
                }
            }
            stack.extend(node.children.iter().flatten().rev().map(|&child| (child, place)));
        }
        Ok(())
    }

    fn mesh(&mut self, index: Index<Mesh>, name: &str, place: &DMat4) -> Result<(), FileError> {
        let i = index.value();
        let fail = |problem| FileError::item(format!("meshes[{i}]"), problem);
        let mesh = self.root.get(index).ok_or_else(|| fail(missing(i, self.root.meshes.len(), "meshes")))?;
        self.used[i] = true;
        // Counted even when there is nothing in it, so that the work is bounded too.
        self.allowance.spend(1 + mesh.primitives.len() as u64).map_err(fail)?;
        let name = if name.is_empty() { mesh.name.as_deref().unwrap_or_default() } else { name };
        self.soup.begin_part(name.as_bytes());
        // Primitives of a mesh often share one accessor: its vertices are taken once.
        let mut shared = Shared::default();
        for primitive in &mesh.primitives {
            let Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) = primitive.mode
            else {
                self.passed_over(primitive);
                continue;
            };
            self.posed += usize::from(primitive.targets.as_ref().is_some_and(|targets| !targets.is_empty()));
            self.primitive(primitive, mode, place, &mut shared).map_err(|e| match e.location {
                Some(_) => e,
                None => fail(*e.problem),
            })?;
        }
        Ok(())
    }

    /// Counts a primitive of points or lines.
    fn passed_over(&mut self, primitive: &Primitive) {
        match (primitive.mode, primitive.attributes.get(&Checked::Valid(Semantic::Positions))) {
            (Checked::Valid(Mode::Points), Some(&positions)) => {
                self.points += 1;
                self.soup.points = self.soup.points.saturating_add(accessor::count(self.root, positions));
            }
            _ => self.other_primitives += 1,
        }
    }

    fn primitive(
        &mut self,
        primitive: &Primitive,
        mode: Mode,
        place: &DMat4,
        shared: &mut Shared,
    ) -> Result<(), FileError> {
        let Some(&positions) = primitive.attributes.get(&Checked::Valid(Semantic::Positions)) else {
            self.other_primitives += 1;
            return Ok(());
        };
        let (first, count) = match shared.vertices.get(&positions.value()) {
            Some(&vertices) => vertices,
            None => {
                let vertices = self.vertices(positions, place)?;
                shared.vertices.insert(positions.value(), vertices);
                vertices
            }
        };
        let indices = match primitive.indices {
            Some(indices) => accessor::indices(self.root, self.buffers, indices, self.allowance)?,
            None => {
                self.allowance.spend(count as u64)?;
                (0..count as u32).collect()
            }
        };
        if let Some(&index) = indices.iter().find(|&&v| v as usize >= count) {
            let item = primitive.indices.map_or(0, |indices| indices.value());
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
    fn paint(&mut self, primitive: &Primitive, start: usize, first: u32, shared: &mut Shared) -> Result<(), FileError> {
        let mut tint = Tint::of(self.root, primitive)?;
        if self.looks.keeps_colours {
            tint = Tint::plain();
        }
        if self.looks.is_textured {
            self.looks.hang(primitive, (start, first), &mut self.soup, self.allowance);
        }
        let (soup, odd) = (&mut self.soup, &mut 0);
        let triangles = &soup.triangles[start..];
        let Some(&index) = primitive.attributes.get(&Checked::Valid(Semantic::Colors(0))) else {
            if !tint.is_plain() {
                let colour = tint.applied_to([1.0; 4], odd);
                soup.colours.paint(start, triangles.iter().map(|_| [colour; 3]));
                soup.colours.odd += *odd;
            }
            return Ok(());
        };
        let colours = match shared.colours.entry(index.value()) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => new.insert(accessor::colours(self.root, self.buffers, index, self.allowance)?),
        };
        if let Some(v) = triangles.iter().flatten().map(|v| v - first).find(|&v| v as usize >= colours.len()) {
            let expected = format!("a colour for vertex {v}");
            let problem = FileProblem::truncated(expected, format!("there are {}", counted(colours.len(), "colour")));
            return Err(FileError::item(format!("accessors[{}]", index.value()), problem));
        }
        let corners = |t: &[u32; 3]| t.map(|v| tint.applied_to(colours[(v - first) as usize], odd));
        soup.colours.paint(start, triangles.iter().map(corners));
        soup.colours.odd += *odd;
        Ok(())
    }

    /// The transformed vertices of an accessor: the number of the first and how many.
    fn vertices(&mut self, index: Index<gltf_json::Accessor>, place: &DMat4) -> Result<(u32, usize), FileError> {
        let points = accessor::positions(self.root, self.buffers, index, self.allowance)?;
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

    fn finish(mut self) -> Soup {
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

fn local_transform(node: &Node) -> DMat4 {
    if let Some(matrix) = &node.matrix {
        return DMat4::from_cols_array(&matrix.map(f64::from));
    }
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let rotation = node.rotation.map_or(DQuat::IDENTITY, |q| DQuat::from_array(q.0.map(f64::from)));
    // A quaternion is stored in 24 bits: made a unit again, the transform keeps lengths.
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    DMat4::from_scale_rotation_translation(
        node.scale.map_or(DVec3::ONE, |scale| DVec3::from(scale.map(as_written))),
        rotation,
        node.translation.map_or(DVec3::ZERO, vector),
    )
}
