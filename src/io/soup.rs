//! What the readers fill: vertices, faces and parts, checked on the way to a [`Loaded`].

use glam::DVec3;
use rustc_hash::FxHashMap;

use super::colour::Gathered;
use super::error::{FileError, FileProblem};
use super::format::Format;
use super::loaded::{Loaded, Negative, Part};
use super::polygon;
use super::text::counted;
use super::texture::Woven;
use super::unit::Unit;
use crate::mesh::TriMesh;

/// Bytes of a part's name that are kept.
pub(super) const LONGEST_NAME: usize = 256;

/// A mesh while it is read. Faces given to it refer to vertices it already has.
pub(super) struct Soup {
    /// Vertices in file order.
    pub(super) positions: Vec<DVec3>,
    /// Triangles in file order.
    pub(super) triangles: Vec<[u32; 3]>,
    /// Sentences about what was read otherwise than it stands.
    pub(super) warnings: Vec<String>,
    /// Points that are no vertices.
    pub(super) points: usize,
    /// Colours of what has some.
    pub(super) colours: Gathered,
    /// Textures of what has some.
    pub(super) texture: Woven,
    parts: Vec<Part>,
    narrow_faces: usize,
    /// Faces of more than three corners, one of which has no finite place.
    unplaced_faces: usize,
    folded_polygons: usize,
    allowance: u64,
}

impl Soup {
    pub(super) fn new() -> Self {
        Self {
            positions: Vec::new(),
            triangles: Vec::new(),
            warnings: Vec::new(),
            points: 0,
            colours: Gathered::default(),
            texture: Woven::default(),
            parts: Vec::new(),
            narrow_faces: 0,
            unplaced_faces: 0,
            folded_polygons: 0,
            allowance: polygon::ALLOWANCE,
        }
    }

    /// The triangles from here on belong to a part called `name`.
    pub(super) fn begin_part(&mut self, name: &[u8]) {
        self.end_part();
        let start = self.triangles.len();
        // Cut, because a name may be repeated for every copy of a part.
        let name = String::from_utf8_lossy(&name[..name.len().min(LONGEST_NAME)]).trim().to_owned();
        self.parts.push(Part { name, triangles: start..start });
    }

    fn end_part(&mut self) {
        let end = self.triangles.len();
        match self.parts.last_mut() {
            Some(part) if part.triangles.start == end => {
                self.parts.pop();
            }
            Some(part) => part.triangles.end = end,
            None if end > 0 => self.parts.push(Part { name: String::new(), triangles: 0..end }),
            None => {}
        }
    }

    /// Adds a face. Its corners must be in range.
    #[inline]
    pub(super) fn face(&mut self, corners: &[u32]) {
        match *corners {
            [a, b, c] => self.triangles.push([a, b, c]),
            [] | [_] | [_, _] => self.narrow_faces += 1,
            _ if corners.iter().any(|&v| !self.positions[v as usize].is_finite()) => self.unplaced_faces += 1,
            _ => {
                let whole = polygon::triangulate(&self.positions, corners, &mut self.allowance, &mut self.triangles);
                self.folded_polygons += usize::from(!whole);
            }
        }
    }

    /// [`Soup::face`] for corners that have something of their own: `own` gets, for each triangle that is added, the numbers of
    /// its corners among `corners`.
    pub(super) fn face_of_corners(&mut self, corners: &[u32], own: &mut Vec<[u32; 3]>) {
        own.clear();
        if corners.len() < 4 || corners.iter().any(|&v| !self.positions[v as usize].is_finite()) {
            let before = self.triangles.len();
            self.face(corners);
            own.extend((before..self.triangles.len()).map(|_| [0, 1, 2]));
            return;
        }
        let places: Vec<DVec3> = corners.iter().map(|&v| self.positions[v as usize]).collect();
        let numbers: Vec<u32> = (0..corners.len() as u32).collect();
        let whole = polygon::triangulate(&places, &numbers, &mut self.allowance, own);
        self.folded_polygons += usize::from(!whole);
        self.triangles.extend(own.iter().map(|t| t.map(|k| corners[k as usize])));
    }

    /// Adds a triangle strip: every second triangle is turned.
    pub(super) fn strip(&mut self, corners: &[u32]) {
        self.triangles.extend(
            corners.windows(3).enumerate().map(
                |(i, t)| {
                    if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] }
                },
            ),
        );
    }

    /// The finished mesh. All corners are in range by now.
    pub(super) fn finish(mut self, format: Format, unit: Option<Unit>) -> Result<Loaded, FileError> {
        self.end_part();
        if self.narrow_faces > 0 {
            self.warnings
                .push(format!("{} with fewer than three corners left out", counted(self.narrow_faces, "face")));
        }
        self.drop_unplaced();
        if self.triangles.is_empty() {
            return Err(self.nothing().into());
        }
        if self.folded_polygons > 0 {
            self.warnings.push(format!(
                "{} too large or tangled to be cut well; cut as fans, which may fold over",
                counted(self.folded_polygons, "concave polygon")
            ));
        }
        self.positions.shrink_to_fit();
        self.triangles.shrink_to_fit();
        let mesh = TriMesh { positions: self.positions, triangles: self.triangles };
        let colours = self.colours.finish(&mesh, &mut self.warnings);
        let texture = self.texture.finish(mesh.triangles.len(), &mut self.warnings);
        // Beside a texture white says nothing.
        let colours = colours.filter(|colours| texture.is_none() || !colours.is_white());
        Ok(Loaded {
            mesh,
            colours,
            texture,
            legend: Vec::new(),
            scale: None,
            format,
            unit,
            parts: self.parts,
            negative: None,
            warnings: self.warnings,
        })
    }

    /// The finished mesh of what is taken away from another; `None` when there is nothing of it.
    pub(super) fn finish_negative(mut self) -> Option<Negative> {
        self.end_part();
        self.drop_unplaced();
        let mesh = TriMesh { positions: self.positions, triangles: self.triangles };
        (!mesh.triangles.is_empty()).then_some(Negative { mesh, parts: self.parts })
    }

    /// Why there is no triangle.
    fn nothing(self) -> FileProblem {
        match (self.warnings.is_empty(), self.positions.len() + self.points) {
            (false, _) => FileProblem::NothingLeft(self.warnings.join("; ")),
            (true, 0) => FileProblem::NoTriangles,
            (true, points) => FileProblem::PointCloud { points },
        }
    }

    /// Drops vertices with a coordinate that is no finite number, and the triangles at them.
    fn drop_unplaced(&mut self) {
        let mut left = 0;
        let number = |p: &DVec3| {
            let finite = p.is_finite();
            left += u32::from(finite);
            finite.then(|| left - 1)
        };
        let numbers: Vec<Option<u32>> = match self.positions.iter().all(|p| p.is_finite()) {
            true => return,
            false => self.positions.iter().map(number).collect(),
        };
        let renumbered = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| numbers[v as usize]);
            Some([a?, b?, c?])
        };
        let triangles: Vec<Option<[u32; 3]>> = self.triangles.iter().map(renumbered).collect();
        self.colours.keep(&numbers, &triangles);
        self.texture.keep(&triangles);
        let (points, faces) = (self.positions.len() - left as usize, triangles.iter().filter(|t| t.is_none()).count());
        self.warnings.push(format!(
            "{} with a coordinate that is no finite number left out, and {} there",
            counted(points, "vertex"),
            counted(faces + self.unplaced_faces, "face"),
        ));
        let mut kept = 0;
        for part in &mut self.parts {
            let start = kept;
            kept += triangles[part.triangles.clone()].iter().flatten().count();
            part.triangles = start..kept;
        }
        self.parts.retain(|part| !part.triangles.is_empty());
        self.triangles = triangles.into_iter().flatten().collect();
        self.positions.retain(|p| p.is_finite());
    }
}

/// Vertices of formats that repeat them for every face, merged where the coordinates are equal
/// (−0 equals 0) as they come, so that the repeated ones never take memory. The result is that of
/// [`TriMesh::welded`].
pub(super) struct Welder {
    ids: FxHashMap<[u64; 3], u32>,
}

impl Welder {
    /// A welder for about `triangles` triangles of a closed mesh.
    pub(super) fn for_triangles(triangles: usize) -> Self {
        Self { ids: FxHashMap::with_capacity_and_hasher(triangles / 2 + 2, Default::default()) }
    }

    /// The number of the vertex at `p`, new or known.
    #[inline]
    pub(super) fn vertex(&mut self, p: DVec3, positions: &mut Vec<DVec3>) -> Result<u32, FileError> {
        // Adding zero turns −0 into 0.
        let key = (p + 0.0).to_array().map(f64::to_bits);
        let next = positions.len();
        let id = *self.ids.entry(key).or_insert(u32::try_from(next).map_err(|_| too_many_vertices())?);
        if id as usize == next {
            positions.push(p);
        }
        Ok(id)
    }
}

/// The error for more vertices than 32 bits can number.
pub(super) fn too_many_vertices() -> FileError {
    FileProblem::TooLarge { what: "vertices", limit: u64::from(u32::MAX) }.into()
}

/// Vertices and triangles that instances (components, nodes) may unfold into.
pub(super) struct Expansion {
    left: u64,
    limit: u64,
}

impl Expansion {
    /// The allowance for an input of `bytes` bytes: as many as a file of that length could hold
    /// without any instance, but at least four million, since a small file with many copies of a
    /// screw is an honest file.
    pub(super) fn for_input(bytes: u64) -> Self {
        let limit = bytes.max(1 << 22);
        Self { left: limit, limit }
    }

    /// Takes `count` vertices or triangles from the allowance.
    pub(super) fn spend(&mut self, count: u64) -> Result<(), FileProblem> {
        self.left = self
            .left
            .checked_sub(count)
            .ok_or(FileProblem::TooLarge { what: "vertices and triangles of instances", limit: self.limit })?;
        Ok(())
    }
}
