//! From a checked tree to a field: what the rows of the table are made with.

use std::sync::Arc;

use glam::DVec3;

use super::site::{BuildError, Operands, Site};
use super::table::Reading;
use super::tree::{Call, Gives, Node, NodeKind, Place, Value};
use crate::field::algebra;
use crate::field::blob::BlobOptions;
use crate::field::filter::{Adaptive, Distances, FilterOptions, Kernel, Sampling, SmoothOptions, WIDEST, filtered};
use crate::field::{
    Body, Extent, Field, FillOptions, Placement, PointField, Sampled, Shared, Solid, blur_band, blurred, fill, placed,
    scattered,
};
use crate::lattice::DistanceField;
use crate::mesh::Bounds;

type Result<T> = std::result::Result<T, BuildError>;

/// The field that `tree` says, over `operands`.
///
/// # Errors
/// See [`BuildError`].
pub fn build(tree: &Node<Value>, operands: &Operands, site: &mut Site<'_>) -> Result<Shared> {
    site.progress.check()?;
    let read = |operand: usize, reading, name: &str| {
        operands.get(&(operand, reading)).cloned().ok_or_else(|| BuildError::Incomplete { name: name.into() })
    };
    let call = match &tree.kind {
        NodeKind::Name { operand, name } => return read(*operand, Reading::Usual, name),
        NodeKind::Call(call) => call,
    };
    let function = call.function;
    let whole = call.fields.len() >= function.fields.len() && call.arguments.len() == function.parameters.len();
    let incomplete = || BuildError::Incomplete { name: function.to_string() };
    match function.gives {
        _ if !whole => Err(incomplete()),
        Gives::Read(reading) => match &call.fields[0].kind {
            NodeKind::Name { operand, name } => read(*operand, reading, name),
            NodeKind::Call(_) => Err(incomplete()),
        },
        Gives::Made(make) => {
            let fields = call.fields.iter().map(|field| build(field, operands, site)).collect::<Result<Vec<_>>>()?;
            make(call, &fields, site)
        }
    }
}

/// The box that holds a shape, model units.
///
/// # Errors
/// [`BuildError::Endless`] and [`BuildError::Nothing`].
pub fn shape_extent(field: &Shared) -> Result<Bounds> {
    match field.extent() {
        Extent::Unbounded => Err(BuildError::Endless),
        extent => extent.bounds().ok_or(BuildError::Nothing),
    }
}

/// The middle of that box.
pub(super) fn middle(field: &Shared) -> Result<DVec3> {
    shape_extent(field).map(|bounds| (bounds.min + bounds.max) / 2.0)
}

/// The two fields of a function of two.
pub(super) fn pair(fields: &[Shared]) -> [Shared; 2] {
    [fields[0].clone(), fields[1].clone()]
}

pub(super) fn moved(field: &Shared, placement: Placement) -> Shared {
    placed(field.clone(), placement)
}

pub(super) fn aligned([a, b]: [Shared; 2]) -> Result<Shared> {
    let (from, to) = (shape_extent(&a)?, shape_extent(&b)?);
    if [from, to].iter().any(|bounds| bounds.size().max_element() <= 0.0) {
        return Err(BuildError::NoSize);
    }
    Ok(placed(a, Placement::fitted(&from, &to)))
}

pub(super) fn morphed_by_radii([a, b]: [Shared; 2], t: f64) -> Result<Shared> {
    let radii = [algebra::depth(&a), algebra::depth(&b)];
    if radii.iter().all(|radius| *radius > 0.0) {
        return Ok(algebra::morph_by_radii([a, b], radii, t));
    }
    let endless = [&a, &b].iter().any(|field| field.extent() == Extent::Unbounded);
    Err(if endless { BuildError::Endless } else { BuildError::NoRadius })
}

pub(super) fn ramp(call: &Call<Value>, [a, b]: [Shared; 2]) -> Result<Shared> {
    let axis = call.axis_or_z("axis");
    let extent = a.extent().or(b.extent()).bounds();
    let at = |name: &str| match (call.place(name), extent) {
        (Some(Place::At(at)), _) => Ok(at),
        (Some(Place::Share(share)), Some(extent)) => Ok(extent.min[axis] + share * extent.size()[axis]),
        _ => Err(BuildError::Endless),
    };
    let (from, to) = (at("from")?, at("to")?);
    if from == to {
        return Err(BuildError::Ramp { from, to });
    }
    Ok(algebra::ramp(a, b, axis, from, to))
}

pub(super) fn blobs(call: &Call<Value>) -> BlobOptions {
    BlobOptions { radius: call.length_or_zero("radius"), gain: call.number("gain").unwrap_or_default() }
}

fn sampling(call: &Call<Value>) -> Sampling {
    Sampling::Drawn { count: call.count("samples").unwrap_or(64) as usize, seed: 0, mirrored: true }
}

/// Of the memory that is allowed, tiles of a filter take no more than one part in so many.
const FOR_TILES: u64 = 4;

pub(super) fn filter(call: &Call<Value>, field: &Shared, max_memory: Option<u64>) -> Result<Shared> {
    let cap = call.length_or_zero("cap");
    let sigma = call.length("sigma");
    let kernel = match sigma {
        Some(sigma) => Kernel::gaussian(sigma),
        None => Kernel::Bump { width: call.length("width").unwrap_or(WIDEST * cap) },
    };
    let adaptive = call.count("least").map(|least| Adaptive { least: least as usize });
    let cells = call.count("cells").map_or_else(Distances::default, |cells| Distances::interpolated(cells as u32));
    let most = max_memory.map_or(u64::MAX, |allowed| allowed / FOR_TILES);
    let distances = match cells {
        Distances::Interpolated { cells, memory } => Distances::Interpolated { cells, memory: memory.min(most) },
        Distances::Asked => Distances::Asked,
    };
    // A Gaussian has no end: its sign is put back.
    let options =
        FilterOptions { cap, kernel, sampling: sampling(call), adaptive, sign_safe: sigma.is_some(), distances };
    Ok(filtered(field.clone(), &options)?)
}

pub(super) fn smoothing(call: &Call<Value>) -> SmoothOptions {
    let [depth, radius] = ["depth", "radius"].map(|name| call.length_or_zero(name));
    SmoothOptions { depth, radius, sampling: sampling(call) }
}

/// The field over its own lattice, filled up to `band` from zero, or all of it.
fn sampled(field: &Shared, h: f64, band: f64, site: &Site<'_>) -> Result<DistanceField> {
    let extent = shape_extent(field)?;
    let extent = Bounds { min: extent.min - band, max: extent.max + band };
    let lattice = (site.lattice)(&extent, Some(h)).map_err(|reason| BuildError::Lattice { reason })?;
    let options = FillOptions { band: Some(band), max_memory: site.max_memory };
    Ok(fill(&**field, &lattice, &options, site.progress)?)
}

pub(super) fn blur(field: &Shared, sigma: f64, site: &Site<'_>) -> Result<Shared> {
    let extent = shape_extent(field)?;
    let h = (site.lattice)(&extent, None).map_err(|reason| BuildError::Lattice { reason })?.h;
    let sharp = sampled(field, h, blur_band(sigma) + 2.0 * h, site)?;
    Ok(Arc::new(Sampled::new(blurred(&sharp, sigma, site.progress)?)))
}

pub(super) fn coarse(field: &Shared, voxel: f64, site: &Site<'_>) -> Result<Shared> {
    Ok(Arc::new(Sampled::new(sampled(field, voxel, 4.0 * voxel, site)?)))
}

pub(super) fn scattered_points(call: &Call<Value>, site: &Site<'_>) -> Result<Shared> {
    let bounds = site.parts.ok_or(BuildError::NoBox)?;
    let [count, seed] = ["count", "seed"].map(|name| call.count(name).unwrap_or_default());
    Ok(Arc::new(PointField::new(&scattered(count as usize, seed, &bounds))))
}

/// A body about the centre that the call says. Points that come after it are scattered around it too.
pub(super) fn body(solid: Solid, call: &Call<Value>, site: &mut Site<'_>) -> Shared {
    let centre = DVec3::from_array(["x", "y", "z"].map(|name| call.length_or_zero(name)));
    standing(Body { solid, centre, axis: call.axis_or_z("axis") }, site)
}

pub(super) fn half_space(call: &Call<Value>, site: &mut Site<'_>) -> Shared {
    let axis = call.axis_or_z("axis");
    standing(Body { solid: Solid::HalfSpace, centre: DVec3::AXES[axis] * call.length_or_zero("at"), axis }, site)
}

fn standing(body: Body, site: &mut Site<'_>) -> Shared {
    site.parts = site.parts.iter().chain(&body.extent().bounds()).copied().reduce(|a, b| a.union(&b));
    Arc::new(body)
}
