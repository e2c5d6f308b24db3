//! Reading the first level set of a file, or else its first grid of floats.

use glam::IVec3;

use super::super::numbers::Cap;
use super::super::{GridFile, GridFormat, GridValues, SparseValues};
use super::header::{self, Grid, is_level_set};
use super::values::Format;
use super::{LATTICE_DIMS, transform, tree};
use crate::io::error::{FileError, FileProblem};
use crate::io::text::quoted;

pub(in crate::io::grids) fn read(bytes: &[u8], cap: Cap) -> Result<GridFile, FileError> {
    let (mut grid, others) = header::grid(bytes)?;
    let mut cursor = grid.rest.clone();
    let (origin, spacing) = transform::read(&mut cursor)?;
    let format = Format { number: grid.number, stored: grid.stored, compression: grid.compression, background: 0.0 };
    let mut values = tree::read(&mut cursor, grid.buffers.take(), format, cap)?;
    let mut warnings = warnings(&grid, &others);
    if grid.metadata.text("sign").is_some_and(|sign| sign.starts_with("positive inside")) {
        values.turn();
        warnings.push("the file is positive inside; the values were turned".to_owned());
    }
    let ours = our_dims(&grid, &values);
    let band = match ours {
        Some(_) => grid.metadata.double("band"),
        None => is_level_set(&grid).then(|| f64::from(values.background.abs())),
    };
    let (origin, dims) = match ours {
        Some(dims) => (origin, dims),
        None => {
            let empty = || FileProblem::syntax("at least one value", "only a background").at_item("grid");
            let [low, high] = values.bounds().ok_or_else(empty)?;
            values.rebase(low);
            (origin + low.as_dvec3() * spacing, high - low)
        }
    };
    Ok(GridFile {
        format: GridFormat::Vdb,
        origin,
        spacing,
        dims: dims.to_array().map(|k| k as usize),
        unit: grid.metadata.text("unit").and_then(|unit| unit.parse().ok()),
        band: band.filter(|band| *band > 0.0 && band.is_finite()),
        values: GridValues::Sparse(values),
        warnings,
    })
}

fn warnings(grid: &Grid<'_>, others: &[String]) -> Vec<String> {
    let mut warnings = Vec::new();
    if !others.is_empty() {
        let others: Vec<String> = others.iter().take(8).map(|name| quoted(name.as_bytes())).collect();
        let name = quoted(grid.name.as_bytes());
        warnings.push(format!("the grid {name} was read; others were left out: {}", others.join(", ")));
    }
    match grid.metadata.text("class").as_deref() {
        Some("level set") => {}
        Some(other) => warnings
            .push(format!("the grid is no level set but a {}: are its values distances?", quoted(other.as_bytes()))),
        None => warnings.push("the grid does not say that it is a level set: are its values distances?".to_owned()),
    }
    warnings
}

/// The lattice that we wrote, if this is one and what is stored lies in it.
fn our_dims(grid: &Grid<'_>, values: &SparseValues) -> Option<IVec3> {
    let dims = IVec3::from(grid.metadata.voxel(LATTICE_DIMS)?);
    let blocks = values.blocks.iter().map(|block| block.corner);
    let mut corners = blocks.chain(values.tiles.iter().map(|tile| tile.corner));
    let sound = dims.min_element() >= 1 && dims.max_element() <= 1 << 29;
    (sound && corners.all(|corner| corner.min_element() >= 0 && corner.cmplt(dims).all())).then_some(dims)
}
