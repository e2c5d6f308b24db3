//! Inputs that may be meshes or lattices of values.

use std::path::Path;

use super::exit::Failure;
use super::input::{self, Input};
use super::report::RunReport;
use super::session::Session;
use super::shared_args::InputArgs;
use super::slice::{self, GridInput};
use super::streams::{is_stream, label};
use crate::io::{Format, GridFormat, Unit};
use crate::mesh::TriMesh;
use crate::pipeline::Operand;
use crate::progress::Stage;

/// Files as read.
pub struct Given {
    /// The meshes.
    pub meshes: Vec<Input>,
    /// The lattices.
    pub grids: Vec<GridInput>,
    /// What was given, in the order given.
    pub order: Vec<Which>,
}

/// A mesh or a grid, by number.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// A mesh.
    Mesh(usize),
    /// A grid.
    Grid(usize),
}

impl Given {
    /// Reads every path; a grid is known by its content.
    pub fn read(
        paths: &[&Path],
        args: &InputArgs,
        max_memory: Option<u64>,
        session: &Session,
        notes: &mut Vec<String>,
    ) -> Result<Self, Failure> {
        input::check_streams(paths, session)?;
        session.progress.stage(Stage::Read)?;
        let mut inputs = Self { meshes: Vec::new(), grids: Vec::new(), order: Vec::new() };
        for path in paths {
            if let Some(loaded) = session.laid(path) {
                inputs.order.push(Which::Mesh(inputs.meshes.len()));
                inputs.meshes.push(input::described(label(path), loaded, notes));
                continue;
            }
            let bytes = input::bytes_of(path, &session.progress)?;
            if is_grid(&bytes, path, args) {
                inputs.order.push(Which::Grid(inputs.grids.len()));
                let left = max_memory.map(|cap| cap.saturating_sub(inputs.held()));
                inputs.grids.push(slice::grid_of(path, &bytes, left, notes)?);
            } else {
                inputs.order.push(Which::Mesh(inputs.meshes.len()));
                let mut mesh = input::mesh_of(path, &bytes, args, &session.progress, notes)?;
                input::leave_out(&mut mesh, notes);
                inputs.meshes.push(mesh);
            }
        }
        Ok(inputs)
    }

    /// Brings everything to one unit, as [`input::common_unit`] does, and says so. Grids keep their numbers; [`GridInput::factor`] is
    /// what brings them there.
    pub fn common_unit(&mut self, args: &InputArgs, notes: &mut Vec<String>) -> Option<Unit> {
        let own = |which: &Which| match *which {
            Which::Mesh(n) => self.meshes[n].loaded.unit,
            Which::Grid(n) => self.grids[n].file.unit,
        };
        let unit = self.order.iter().find_map(own).or(args.unit)?;
        input::bring_to(unit, &mut self.meshes, args, notes);
        for grid in &mut self.grids {
            let label = &grid.entry.path;
            let own = grid.file.unit.or(args.unit).unwrap_or_else(|| {
                notes.push(input::without_unit(label, unit));
                unit
            });
            if own != unit {
                grid.factor = own.metres() / unit.metres();
                notes.push(input::rescaled(label, own, unit));
            }
            grid.file.unit = Some(unit);
        }
        Some(unit)
    }

    /// Memory that the values of the grids take, bytes.
    pub fn held(&self) -> u64 {
        self.grids.iter().map(|grid| grid.file.values.memory()).sum()
    }

    /// Fills in what the report says of the inputs.
    pub fn describe(&self, report: &mut RunReport) {
        let entry = |which: &Which| match *which {
            Which::Mesh(n) => self.meshes[n].entry.clone(),
            Which::Grid(n) => self.grids[n].entry.clone(),
        };
        report.inputs = self.order.iter().map(entry).collect();
        let nowhere = self.grids.iter().filter(|grid| !grid.file.format.says_where());
        report.warnings.extend(nowhere.map(|grid| {
            let (path, format) = (&grid.entry.path, &grid.entry.format);
            format!("{path}: {format} does not say where the voxels lie; their spacing was taken as 1")
        }));
    }

    /// Each input's mesh and what it looks like; a grid has neither.
    pub fn operands(&self) -> Vec<Operand<'_>> {
        const NOTHING: &TriMesh = &TriMesh { positions: Vec::new(), triangles: Vec::new() };
        let operand = |which: &Which| match *which {
            Which::Mesh(n) => (&self.meshes[n].loaded).into(),
            Which::Grid(_) => NOTHING.into(),
        };
        self.order.iter().map(operand).collect()
    }

    /// What the inputs are called.
    pub fn labels(&self) -> Vec<String> {
        let label = |which: &Which| match *which {
            Which::Mesh(n) => self.meshes[n].label.clone(),
            Which::Grid(n) => self.grids[n].entry.path.clone(),
        };
        self.order.iter().map(label).collect()
    }

    /// The unit of the input of this name.
    pub fn unit_of(&self, path: &str) -> Option<String> {
        let grids = self.grids.iter().map(|grid| (&grid.entry.path, grid.file.unit));
        let mut all = grids.chain(self.meshes.iter().map(|mesh| (&mesh.label, mesh.loaded.unit)));
        all.find(|(label, _)| *label == path).and_then(|(_, unit)| unit).map(|unit| unit.to_string())
    }
}

/// A grid by what its bytes begin as, or by its name where they are no mesh either.
fn is_grid(bytes: &[u8], path: &Path, args: &InputArgs) -> bool {
    let named = || !is_stream(path) && GridFormat::from_path(path).is_some() && Format::detect(bytes, None).is_none();
    args.in_format.is_none() && (GridFormat::from_content(bytes).is_some() || named())
}
