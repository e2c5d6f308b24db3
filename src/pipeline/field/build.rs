//! From the tree of an expression to a field.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::DVec3;

use super::sources::Sources;
use super::{FieldError, OperandReport};
use crate::field::algebra::{self, complement, difference, intersection, symmetric_difference, union};
use crate::field::blend::{blend_difference, blend_intersection, blend_union};
use crate::field::blob::{self, BlobOptions};
use crate::field::filter::{Adaptive, FilterOptions, Kernel, Sampling, SmoothOptions, WIDEST, filtered, smooth};
use crate::field::language::{Call, Function, Node, NodeKind, Place, Value};
use crate::field::{
    Body, Extent, Field, FillOptions, MeshField, Placement, PointField, Sampled, Shared, Solid, blur_band, blurred,
    fill, material, placed, scattered,
};
use crate::lattice::DistanceField;
use crate::mesh::{Bounds, ValidateOptions, validate};
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
    parts: Option<Bounds>,
    /// The operands that are valid solids.
    valid: BTreeSet<usize>,
    /// The operands that are fields already, by number and kind.
    made: BTreeMap<(usize, &'static str), Shared>,
    sources: Sources,
}

impl<'a> FieldBuilder<'a> {
    /// Ready to make fields of `operands`. A mesh that is no valid solid will be repaired first, as `options` say.
    pub fn new(operands: &'a [FieldOperand<'a>], options: &'a Options, progress: &'a Progress) -> Self {
        Self {
            operands,
            options,
            progress,
            parts: None,
            valid: BTreeSet::new(),
            made: BTreeMap::new(),
            sources: Sources::default(),
        }
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
        self.parts = self.operands.iter().filter_map(FieldOperand::bounds).reduce(|a, b| a.union(&b));
        let field = self.node(tree)?;
        let operands = self.made.keys().map(|&(operand, made)| OperandReport { operand, made }).collect();
        Ok(Built { field, parts: self.parts, operands, sources: self.sources.clone() })
    }

    fn node(&mut self, node: &Node<Value>) -> Result<Shared, FieldError> {
        self.progress.check()?;
        match &node.kind {
            NodeKind::Name { operand, .. } => self.usual(*operand),
            NodeKind::Call(call) => match call.function {
                Function::Exact | Function::Robust | Function::Levels => self.special(call),
                _ => {
                    let fields = call.fields.iter().map(|field| self.node(field)).collect::<Result<_, _>>()?;
                    self.call(call, fields)
                }
            },
        }
    }

    fn call(&mut self, call: &Call<Value>, fields: Vec<Shared>) -> Result<Shared, FieldError> {
        use Function as F;
        let length = |name: &str| call.length(name).unwrap_or_default();
        let number = |name: &str| call.number(name).unwrap_or_default();
        let several = |join: fn(Shared, Vec<Shared>) -> Shared| {
            let mut fields = fields.clone().into_iter();
            fields.next().map(|first| join(first, fields.collect()))
        };
        let pair = || fields.first().cloned().zip(fields.get(1).cloned());
        let first = || fields.first().cloned();
        let blobs = BlobOptions { radius: length("radius"), gain: number("gain") };
        let made = match call.function {
            F::Complement => first().map(complement),
            F::Union => Some(union(fields.clone())),
            F::Intersection => Some(intersection(fields.clone())),
            F::Difference => several(difference),
            F::SymmetricDifference => Some(symmetric_difference(fields.clone())),
            F::Offset => first().map(|a| algebra::offset(a, length("by"))),
            F::Shell => first().map(|a| algebra::shell(a, length("thickness"))),
            F::Blend => pair().map(|(a, b)| blend_union(a, b, length("radius"))),
            F::BlendIntersection => pair().map(|(a, b)| blend_intersection(a, b, length("radius"))),
            F::BlendDifference => pair().map(|(a, b)| blend_difference(a, b, length("radius"))),
            F::Average => Some(algebra::average(fields.clone(), &call.list)),
            F::Morph => pair().map(|(a, b)| algebra::morph(a, b, number("t"))),
            F::MorphRadii => pair().map(|pair| by_radii(pair, number("t"))).transpose()?,
            F::Ramp => pair().map(|pair| self.ramp(call, pair)).transpose()?,
            F::Texture => pair().map(|(a, b)| algebra::morph(a, b, number("amount"))),
            F::Material => Some(material(fields.clone(), call.list.clone())),
            F::Filter => first().map(|a| filter(call, a)).transpose()?,
            F::Smooth => pair().map(|(a, volume)| smooth(a, volume, &smoothing(call))),
            F::Blur => first().map(|a| self.blur(&a, length("sigma"))).transpose()?,
            F::Coarse => first().map(|a| self.coarse(&a, length("voxel"))).transpose()?,
            F::Blob => first().map(|a| blob::blob(a, blobs)),
            F::BlobUnion => Some(blob::blob_union(fields.clone(), blobs)),
            F::BlobIntersection => Some(blob::blob_intersection(fields.clone(), blobs)),
            F::BlobDifference => pair().map(|(a, b)| blob::blob_difference(a, vec![b], blobs)),
            F::Compare => pair().map(|(a, b)| blob::compare(a, b, blobs)),
            F::Move | F::Scale | F::Turn | F::Align => Some(moved(call, &fields)?),
            F::Points => Some(self.points(call)?),
            F::Sphere | F::Box | F::Cylinder | F::Torus | F::Plane => Some(self.body(call)),
            F::Exact | F::Robust | F::Levels => None,
        };
        // The parser gives each call as many fields as it takes.
        made.ok_or(FieldError::MissingField)
    }

    /// An operand by its name: a grid as it is, a mesh by its exact distance, repaired first where it is no solid.
    fn usual(&mut self, operand: usize) -> Result<Shared, FieldError> {
        let given = match &self.operands[operand] {
            FieldOperand::Grid(grid) => return Ok(self.remember(operand, "grid", grid.clone())),
            FieldOperand::Mesh(operand) => *operand,
        };
        if let Some(made) = self.made.get(&(operand, "repaired")) {
            return Ok(made.clone());
        }
        if self.valid.contains(&operand) {
            return self.exact(operand);
        }
        let options = ValidateOptions { self_intersections: true, weld: true };
        if validate(given.mesh, &options, self.progress)?.is_valid() {
            self.valid.insert(operand);
            return self.exact(operand);
        }
        let outcome = repair(given, self.options, self.progress)?;
        let origins = outcome.sources.iter().map(|source| match *source {
            TriangleSource::Operand { triangle, .. } => TriangleSource::Operand { operand: operand as u32, triangle },
            TriangleSource::Closed => TriangleSource::Closed,
        });
        let source = self.sources.add(&outcome.solid, origins);
        let field = MeshField::new(&outcome.solid, PointSign::Pseudonormal, source);
        Ok(self.remember(operand, "repaired", Arc::new(field)))
    }

    fn special(&mut self, call: &Call<Value>) -> Result<Shared, FieldError> {
        let Some(NodeKind::Name { operand, .. }) = call.fields.first().map(|field| &field.kind) else {
            return Err(FieldError::MissingField);
        };
        let operand = *operand;
        let FieldOperand::Mesh(Operand { mesh, .. }) = self.operands[operand] else {
            return self.usual(operand);
        };
        let (name, method, sign) = match call.function {
            Function::Robust => ("robust", DistanceMethod::Robust, DistanceSign::Votes),
            Function::Levels => ("levels", DistanceMethod::Exact, DistanceSign::Levels),
            _ => return self.exact(operand),
        };
        if let Some(made) = self.made.get(&(operand, name)) {
            return Ok(made.clone());
        }
        let known = KNOWN * mesh.bounds().map_or(0.0, |bounds| bounds.diagonal());
        let options = DistanceOptions {
            voxel: self.options.voxel,
            band: Some(known),
            method,
            sign,
            backend: self.options.backend,
            orient: self.options.orient,
            max_memory: self.options.max_memory,
        };
        let found = distance(mesh, &options, self.progress)?;
        Ok(self.remember(operand, name, Arc::new(Sampled::new(found.field))))
    }

    fn exact(&mut self, operand: usize) -> Result<Shared, FieldError> {
        if let Some(made) = self.made.get(&(operand, "exact")) {
            return Ok(made.clone());
        }
        let FieldOperand::Mesh(Operand { mesh, .. }) = self.operands[operand] else { return self.usual(operand) };
        let origin = |triangle| TriangleSource::Operand { operand: operand as u32, triangle };
        let source = self.sources.add(mesh, (0..mesh.triangles.len() as u32).map(origin));
        let field = MeshField::new(mesh, PointSign::Pseudonormal, source);
        Ok(self.remember(operand, "exact", Arc::new(field)))
    }

    fn remember(&mut self, operand: usize, made: &'static str, field: Shared) -> Shared {
        self.made.insert((operand, made), field.clone());
        field
    }

    fn ramp(&self, call: &Call<Value>, (a, b): (Shared, Shared)) -> Result<Shared, FieldError> {
        let axis = call.axis("axis").map_or(2, |axis| axis.number());
        let extent = a.extent().or(b.extent()).bounds();
        let at = |name: &str| match (call.place(name), extent) {
            (Some(Place::At(at)), _) => Ok(at),
            (Some(Place::Share(share)), Some(extent)) => Ok(extent.min[axis] + share * extent.size()[axis]),
            _ => Err(FieldError::Endless),
        };
        let (from, to) = (at("from")?, at("to")?);
        if from == to {
            return Err(FieldError::NoRamp { from, to });
        }
        Ok(algebra::ramp(a, b, axis, from, to))
    }

    /// The field over its own lattice, filled up to `band` from zero, or all of it.
    fn sampled(&self, field: &Shared, h: f64, band: f64) -> Result<DistanceField, FieldError> {
        let extent = super::shape_extent(field)?;
        let extent = Bounds { min: extent.min - band, max: extent.max + band };
        let lattice = sizing::lattice(&extent, VoxelSize::Length(h))?;
        let options = FillOptions { band: Some(band), max_memory: self.options.max_memory };
        Ok(fill(&**field, &lattice, &options, self.progress)?)
    }

    fn blur(&self, field: &Shared, sigma: f64) -> Result<Shared, FieldError> {
        let extent = super::shape_extent(field)?;
        let h = sizing::lattice(&extent, self.options.voxel)?.h;
        let sharp = self.sampled(field, h, blur_band(sigma) + 2.0 * h)?;
        Ok(Arc::new(Sampled::new(blurred(&sharp, sigma, self.progress)?)))
    }

    fn coarse(&self, field: &Shared, voxel: f64) -> Result<Shared, FieldError> {
        Ok(Arc::new(Sampled::new(self.sampled(field, voxel, 4.0 * voxel)?)))
    }

    fn body(&mut self, call: &Call<Value>) -> Shared {
        let field = body(call);
        let both = self.parts.iter().chain(&field.extent().bounds()).copied().reduce(|a, b| a.union(&b));
        self.parts = both;
        field
    }

    fn points(&self, call: &Call<Value>) -> Result<Shared, FieldError> {
        let bounds = self.parts.ok_or(FieldError::NoBox)?;
        let count = call.count("count").unwrap_or_default() as usize;
        Ok(Arc::new(PointField::new(&scattered(count, call.count("seed").unwrap_or_default(), &bounds))))
    }
}

/// A field elsewhere, larger or turned.
fn moved(call: &Call<Value>, fields: &[Shared]) -> Result<Shared, FieldError> {
    let extent = |k: usize| super::shape_extent(&fields[k]);
    let middle = || extent(0).map(|bounds| (bounds.min + bounds.max) / 2.0);
    let length = |name: &str| call.length(name).unwrap_or_default();
    let number = |name: &str| call.number(name).unwrap_or(1.0);
    let placement = match call.function {
        Function::Scale => Placement::scaled(number("factor"), middle()?),
        Function::Turn => {
            let axis = call.axis("axis").map_or(2, |axis| axis.number());
            Placement::turned(axis, number("degrees").to_radians(), middle()?)
        }
        Function::Align => {
            let (from, to) = (extent(0)?, extent(1)?);
            if [from, to].iter().any(|bounds| bounds.size().max_element() <= 0.0) {
                return Err(FieldError::NoSize);
            }
            Placement::fitted(&from, &to)
        }
        _ => Placement::moved(DVec3::new(length("x"), length("y"), length("z"))),
    };
    Ok(placed(fields[0].clone(), placement))
}

fn by_radii((a, b): (Shared, Shared), t: f64) -> Result<Shared, FieldError> {
    let radii = [algebra::depth(&a), algebra::depth(&b)];
    if radii.iter().all(|radius| *radius > 0.0) {
        return Ok(algebra::morph_by_radii([a, b], radii, t));
    }
    let endless = [&a, &b].iter().any(|field| field.extent() == Extent::Unbounded);
    Err(if endless { FieldError::Endless } else { FieldError::NoRadius })
}

fn sampling(call: &Call<Value>) -> Sampling {
    Sampling::Drawn { count: call.count("samples").unwrap_or(64) as usize, seed: 0, mirrored: true }
}

fn filter(call: &Call<Value>, field: Shared) -> Result<Shared, FieldError> {
    let cap = call.length("cap").unwrap_or_default();
    let sigma = call.length("sigma");
    let kernel = match sigma {
        Some(sigma) => Kernel::gaussian(sigma),
        None => Kernel::Bump { width: call.length("width").unwrap_or(WIDEST * cap) },
    };
    let adaptive = call.count("least").map(|least| Adaptive { least: least as usize });
    // A Gaussian has no end: its sign is put back.
    let options = FilterOptions { cap, kernel, sampling: sampling(call), adaptive, sign_safe: sigma.is_some() };
    Ok(filtered(field, &options)?)
}

fn smoothing(call: &Call<Value>) -> SmoothOptions {
    let length = |name: &str| call.length(name).unwrap_or_default();
    SmoothOptions { depth: length("depth"), radius: length("radius"), sampling: sampling(call) }
}

fn body(call: &Call<Value>) -> Shared {
    let length = |name: &str| call.length(name).unwrap_or_default();
    let axis = call.axis("axis").map_or(2, |axis| axis.number());
    let mut centre = DVec3::new(length("x"), length("y"), length("z"));
    let solid = match call.function {
        Function::Sphere => Solid::Sphere { radius: length("radius") },
        Function::Box => Solid::Box { size: DVec3::new(length("sx"), length("sy"), length("sz")) },
        Function::Cylinder => Solid::Cylinder { radius: length("radius"), height: length("height") },
        Function::Torus => Solid::Torus { major: length("major"), minor: length("minor") },
        _ => {
            centre = DVec3::AXES[axis] * length("at");
            Solid::HalfSpace
        }
    };
    Arc::new(Body { solid, centre, axis })
}
