//! From the tree of an expression to a field.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::sources::Sources;
use super::{FieldError, OperandReport};
use crate::field::language::{self, BuildError, Node, Reading, Site, Value};
use crate::field::{Field, MeshField, Sampled, Shared};
use crate::mesh::{Bounds, TriMesh, ValidateOptions, validate};
use crate::pipeline::{
    DistanceMethod, DistanceOptions, DistanceSign, Operand, Options, TriangleSource, VoxelSize, distance, repair,
    sizing,
};
use crate::progress::Progress;
use crate::sdf::exact::PointSign;

/// `robust` and `levels` know distances up to this part of the diagonal; beyond they stay the same.
const KNOWN: f64 = 0.1;

/// What a name of an expression stands for.
pub enum FieldOperand<'a> {
    /// A mesh, which may be broken.
    Mesh(Operand<'a>),
    /// A field from a file.
    Grid(Arc<Sampled>),
}

/// A field, and what it was made of.
pub struct Built {
    /// The field.
    pub field: Shared,
    /// The box around all operands and bodies with an end, model units; `None` without any.
    pub parts: Option<Bounds>,
    /// How each operand became a field.
    pub operands: Vec<OperandReport>,
    pub(super) sources: Sources,
}

impl FieldOperand<'_> {
    /// Bytes of memory that its lattice takes; none for a mesh.
    pub fn memory(&self) -> u64 {
        match self {
            Self::Mesh(_) => 0,
            Self::Grid(grid) => grid.memory(),
        }
    }

    /// The box around it, model units.
    pub fn bounds(&self) -> Option<Bounds> {
        match self {
            Self::Mesh(operand) => operand.mesh.bounds(),
            Self::Grid(grid) => grid.extent().bounds(),
        }
    }
}

/// Makes fields of trees over the same operands; what it has made of an operand it keeps.
pub struct FieldBuilder<'a> {
    operands: &'a [FieldOperand<'a>],
    options: &'a Options,
    progress: &'a Progress,
    /// The operands that are valid solids.
    valid: BTreeSet<usize>,
    /// The operands that are fields already, by number and kind.
    made: BTreeMap<(usize, &'static str), Shared>,
    sources: Sources,
}

impl<'a> FieldBuilder<'a> {
    /// Ready to make fields of `operands`. A mesh that is no valid solid will be repaired first, as `options` say.
    pub fn new(operands: &'a [FieldOperand<'a>], options: &'a Options, progress: &'a Progress) -> Self {
        Self { operands, options, progress, valid: BTreeSet::new(), made: BTreeMap::new(), sources: Sources::default() }
    }

    /// The field that `tree` says.
    ///
    /// # Errors
    /// See [`FieldError`].
    pub fn build(&mut self, tree: &Node<Value>) -> Result<Built, FieldError> {
        for operand in self.operands {
            if let FieldOperand::Mesh(operand) = operand {
                operand.mesh.check()?;
            }
        }
        let mut read = language::Operands::new();
        for (operand, reading) in tree.readings() {
            self.progress.check()?;
            read.insert((operand, reading), self.read(operand, reading)?);
        }
        let voxel = |h: Option<f64>| h.map_or(self.options.voxel, VoxelSize::Length);
        let lattice = |bounds: &Bounds, h| sizing::lattice(bounds, voxel(h)).map_err(|error| error.to_string());
        let parts = self.operands.iter().filter_map(FieldOperand::bounds).reduce(|a, b| a.union(&b));
        let max_memory = self.options.max_memory;
        let mut site = Site { parts, lattice: &lattice, max_memory, progress: self.progress };
        let field = language::build(tree, &read, &mut site)?;
        let operands = self.made.keys().map(|&(operand, made)| OperandReport { operand, made }).collect();
        Ok(Built { field, parts: site.parts, operands, sources: self.sources.clone() })
    }

    fn read(&mut self, operand: usize, reading: Reading) -> Result<Shared, FieldError> {
        let given = self.operands.get(operand);
        let given = given.ok_or_else(|| BuildError::Incomplete { name: format!("operand {operand}") })?;
        match (given, reading) {
            (FieldOperand::Grid(grid), _) => Ok(self.remember(operand, "grid", grid.clone())),
            (FieldOperand::Mesh(given), Reading::Usual) => self.usual(operand, *given),
            (FieldOperand::Mesh(given), Reading::Exact) => Ok(self.exact(operand, given.mesh)),
            (FieldOperand::Mesh(given), Reading::Robust) => {
                self.sampled((operand, "robust"), given.mesh, DistanceMethod::Robust, DistanceSign::Votes)
            }
            (FieldOperand::Mesh(given), Reading::Levels) => {
                self.sampled((operand, "levels"), given.mesh, DistanceMethod::Exact, DistanceSign::Levels)
            }
        }
    }

    /// A mesh by its exact distance, repaired first where it is no solid.
    fn usual(&mut self, operand: usize, given: Operand<'_>) -> Result<Shared, FieldError> {
        if let Some(made) = self.made.get(&(operand, "repaired")) {
            return Ok(made.clone());
        }
        if self.valid.contains(&operand) {
            return Ok(self.exact(operand, given.mesh));
        }
        let options = ValidateOptions { self_intersections: true, weld: true };
        let validity = validate(given.mesh, &options, self.progress)?;
        // Of one body all rules say the same; of several they may not.
        if validity.is_valid() && (self.options.inside.needs_outward() || validity.bodies == 1) {
            self.valid.insert(operand);
            return Ok(self.exact(operand, given.mesh));
        }
        let outcome = repair(given, self.options, self.progress)?;
        let origins = outcome.sources.iter().map(|source| source.of_operand(operand as u32));
        let source = self.sources.add(&outcome.solid, origins);
        let field = MeshField::new(&outcome.solid, PointSign::Pseudonormal, source);
        Ok(self.remember(operand, "repaired", Arc::new(field)))
    }

    /// A mesh by its distances over a lattice.
    fn sampled(
        &mut self,
        (operand, name): (usize, &'static str),
        mesh: &TriMesh,
        method: DistanceMethod,
        sign: DistanceSign,
    ) -> Result<Shared, FieldError> {
        if let Some(made) = self.made.get(&(operand, name)) {
            return Ok(made.clone());
        }
        let known = KNOWN * mesh.bounds().map_or(0.0, |bounds| bounds.diagonal());
        let options = DistanceOptions {
            voxel: self.options.voxel,
            band: Some(known),
            method,
            sign,
            planes: None,
            backend: self.options.backend,
            orient: self.options.orient,
            inside: self.options.inside,
            max_memory: self.options.max_memory,
        };
        let found = distance(mesh, &options, self.progress)?;
        Ok(self.remember(operand, name, Arc::new(Sampled::new(found.field))))
    }

    fn exact(&mut self, operand: usize, mesh: &TriMesh) -> Shared {
        if let Some(made) = self.made.get(&(operand, "exact")) {
            return made.clone();
        }
        let origin = |triangle| TriangleSource::Operand { operand: operand as u32, triangle };
        let source = self.sources.add(mesh, (0..mesh.triangles.len() as u32).map(origin));
        let field = MeshField::new(mesh, PointSign::Pseudonormal, source);
        self.remember(operand, "exact", Arc::new(field))
    }

    fn remember(&mut self, operand: usize, made: &'static str, field: Shared) -> Shared {
        self.made.insert((operand, made), field.clone());
        field
    }
}
